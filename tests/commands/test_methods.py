"""`driftproof methods` and `facts`: nothing left out of the list; systems, families, tolerances, every form."""

import json

import pytest

import driftproof
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.formulas.expressions import parse_system
from driftproof.methods.given_methods import method_of
from driftproof.symbolic.linear.systems import SYSTEM_FACTS

DAMPED = "0 1; -1 -1/10"
METHODS, FAMILIES = driftproof.METHODS, driftproof.FAMILIES


@pytest.fixture
def facts(answer):
    return lambda *words: json.loads(answer("facts", *words, "--format", "json"))


def test_list_names_every_method_and_every_family(answer):
    head, *rows = answer("methods").splitlines()
    assert head.split() == ["method", "family", "order", "title", "source"]
    assert [row.split()[0] for row in rows] == [*METHODS, *FURTHER_METHODS, *FAMILIES]
    assert rows[0][: head.index("order") + 5].endswith("    1"), "numbers to the right"
    assert "Runge-Kutta in gamma" in next(row for row in rows if row.startswith("sdirk_order_2"))
    listed = json.loads(answer("methods", "--format", "json"))
    assert (len(listed), listed["rk4"]["order"], listed["rk4"]["title"]) == (len(rows), "4", "Classical RK4")


def test_facts_on_a_system_are_those_of_python(facts):
    found = facts("rk4", "--system", DAMPED)
    assert list(found) == sorted(SYSTEM_FACTS)
    assert found == driftproof.facts(METHODS["rk4"], system=parse_system(DAMPED)).data
    assert found["system"] == [["0", "1"], ["-1", "-1/10"]]
    assert found["one_step_matrix"][0][0] == {"num": ["1", "0", "-1/2", "1/60", "33/800"], "den": ["1"]}
    assert found["step_limit"]["decimal"] == "2.909799685490394332749367463504"
    assert found["eigenvalues"][0]["value"]["exact"] == "-1/20 + sqrt(399)/20*I"
    assert facts("rk4", "--system", "0 1; -1 0")["step_limit"]["exact"] == "2*sqrt(2)"


def test_a_family_is_answered_as_functions_and_sets(facts, answer):
    found = facts("sdirk_order_2")
    assert found == driftproof.facts(FAMILIES["sdirk_order_2"]).data
    assert found["stability_function"]["num"] == ["1", "1 - 2*gamma", "1/2 - 2*gamma + gamma**2"]
    assert found["l_stable"]["set"] == "{1 - sqrt(2)/2} U {1 + sqrt(2)/2}"
    text = answer("facts", "sdirk_order_2", "--only", "real_limit,order_sets,error_constant")
    assert text.splitlines() == [
        "real limit      2/(1 - 4*gamma) on (-oo, 1/4)", "                oo on [1/4, oo)",
        "order sets      1 on (-oo, oo)", "                2 on (-oo, oo)",
        "                3 on {1/2 - sqrt(3)/6} U {1/2 + sqrt(3)/6}",
        "                4 nowhere", "error constant  (-1/6 + gamma - gamma**2) h^3",
    ]  # fmt: skip


def test_a_member_of_a_family_is_a_method_and_the_family_no_single_one(facts):
    found = facts("sdirk_order_2", "--at", "1 - sqrt(2)/2")
    assert (found["order"], found["l_stable"], found["real_limit"]) == (2, True, "oo")
    assert found["field"]["generator"] == "sqrt(2)"
    assert facts("sdirk_order_2", "--at", "1/5", "--only", "real_limit")["real_limit"]["exact"] == "10"
    assert facts("explicit_order_2", "--at", "2/3", "--system", "-3")["step_limit"]["exact"] == "2/3"
    with pytest.raises(ValueError, match=r"is a family of methods, with gamma free; one method is needed"):
        method_of("sdirk_order_2")


def test_a_multistep_method_is_answered_and_options_that_are_not_for_it_refused(facts, answer, refusal):
    assert facts("BDF2") == driftproof.facts(FURTHER_METHODS["bdf2"]).data
    text = answer("facts", "adams_bashforth2", "--only", "rho,sigma,order,error_constant,real_limit")
    assert text.splitlines() == [
        "rho             -zeta + zeta^2", "sigma           -1/2 + 3/2 zeta", "order           2",
        "error constant  5/12", "real limit      1",
    ]  # fmt: skip
    words = "bdf2 is a linear multistep method; `system` does not work with it"
    assert words in refusal("facts", "bdf2", "--system", DAMPED)


def test_an_order_to_a_tolerance_stands_among_what_is_shown(answer):
    for key in ("tsitouras54", "ark324"):
        assert "  order, ignoring residuals up to the tolerance" in answer("facts", key, "--order-tolerance", "1e-12")


def test_a_tableau_or_a_family_of_your_own(facts, tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")
    assert facts(str(mine), "--only", "order,stability_function")["order"] == 2
    theta = tmp_path / "theta.toml"
    theta.write_text(
        'family = "runge_kutta"\nparameter = "theta"\n'
        'A = [[0, 0], ["1 - theta", "theta"]]\nb = ["1 - theta", "theta"]\n',
        encoding="utf-8",
    )
    assert facts(str(theta), "--only", "a_stable")["a_stable"]["set"] == "[1/2, oo)"
    assert facts(str(theta), "--at", "1/2", "--only", "order") == {"order": 2}


def test_order_to_a_tolerance_stands_beside_the_order(facts):
    found = facts("tsitouras54", "--only", "order,order_fails", "--order-tolerance", "1e-12")
    assert found["order"] == 0
    assert found["order_fails"] == {"tree": "τ", "residual": "-17/100000000000000000"}
    assert (found["order_to_tolerance"]["order"], found["order_to_tolerance"]["tolerance"]) == (5, "1/1000000000000")
    assert "order_to_tolerance" not in facts("tsitouras54", "--only", "order")
    assert driftproof.order_within(METHODS["rk4"], 0).order == 4


def test_points_of_the_boundary_are_there_when_named(facts, answer):
    assert len(facts("rk4", "--only", "region_boundary")["region_boundary"]["points"]) > 50
    assert "region_boundary" not in facts("rk4", "--only", "order,method")
    text = answer("facts", "rk4", "--only", "region_boundary")
    assert text.startswith("region boundary  -2.785293563405282 + 0.000000000000000*I, ")
    assert text.endswith("|error| < 1e-15, and the conjugates\n")
    assert len(driftproof.boundary_points(driftproof.stability_function_of(METHODS["rk4"]), 2)) > 8


CUBIC = "0 1 0; 0 0 1; -5 -1 -1/2"
# Method, what is asked, and what the TeX then holds.
TEX = [
    ("forward_euler", "imaginary_limit", "imaginary limit & $0$ "),
    ("gauss2", "real_limit", r"real limit & $\infty$ "),
    ("gauss2", "field", r"$\sqrt{3}$, the root of $x^{2}-3$ in $(1, 2)$, $\approx 1.73205080$"),
    ("mclachlan_atela5", "dispersion", r"$\approx -5.0000000 \cdot 10^{-20}$ $h$"),
    ("sdirk_order_2", "a_stable", r"$[\frac{1}{4}, \infty)$"),
    ("sdirk_order_2", "real_limit", r"$\frac{2}{1-4 \gamma}$ on $(-\infty, \frac{1}{4})$; $\infty$ on $["),
    ("sdirk_order_2", "stability_function", r"}{1-2 \gamma z+\gamma^{2} z^{2}}$"),
    ("rk4 --system 0_1;-3_0", "system", r"$\begin{pmatrix}0 & 1 \\ -3 & 0\end{pmatrix}$"),
    ("rk4 --system 0_1;-3_0", "eigenvalues", r"$\sqrt{3} I$"),
    (f"rk4 --system {CUBIC.replace(' ', '_')}", "eigenvalues", r"$\approx 0.58932965 + 1.62211528 I$: no h"),
]
TEXT = [
    ("gauss2", "field", "sqrt(3), the root of x**2 - 3 in (1, 2) = 1.732050807568877293527446341506"),
    ("rk4 --system 0_0;0_0", "eigenvalues", "0, 2 times: every h > 0"),
    ("rk4 --system 0_1;-3_0", "eigenvalues", "sqrt(3)*I: h <= 2*sqrt(6)/3 = "),
    ("velocity_verlet --system 0_1;-3_0", "eigenvalues", "sqrt(3)*I: h < 2*sqrt(3)/3 = "),
    ("rk4 --system 0_1;-3_0", "one_step_matrix", "[-3 h + 3/2 h^3, 1 - 3/2 h^2 + 3/8 h^4]"),
    ("mclachlan_atela5", "dispersion_series", "dispersion series  none"),
    ("implicit_midpoint --terms 4", "modified_rate", "modified rate  z + 1/12 z^3 + O(z^4)"),
    ("backward_euler", "order_reduction", "power: 2, function: (-1/2)/(1 - z), at_infinity"),
    ("midpoint2", "conserved_quadratics", "conserved quadratics  none"),
]


@pytest.mark.parametrize(
    ("form", "of", "fact", "words"),
    [*(("tex", *row) for row in TEX), *(("text", *row) for row in TEXT)],
    ids=range(len(TEX) + len(TEXT)),
)
def test_fact_is_written_as(form, of, fact, words, answer):
    method, *more = (word.replace("_", " ") if ";" in word else word for word in of.split())
    shown = answer("facts", method, *more, "--only", fact, "--format", form)
    assert words in shown
    assert form == "text" or shown.count("$") % 2 == 0


REFUSED = {
    ("rk4", "--json"): "unrecognized arguments: --json; did you mean --format json? (",
    (".",): "unknown method '.' (`driftproof methods` lists all)",
    ("rk4", "--terms", "0"): "'0' is not allowed: the number of terms must be from 1 to 1000",
    ("rk4", "--system", "0 1; 2"): "the system is not square: row 2 of 2 has 1 entries",
    ("rk4", "--system", "0 x; 1 0"): "row 1, entry 2: 'x', column 1: 'x' is a name",
    ("rk4", "--system", "sqrt(2)"): "row 1, entry 1: sqrt(2) is irrational; the entries of a system are rational",
    ("rk4", "--system", "1;" * 13): "the system has 13 rows; at most 12 are read",
    ("rk4", "--system", "1", "--only", "order"): "unknown fact 'order'; choose from method, system",
    ("rk4", "--system", "1", "--order-tolerance", "1"): "`system` cannot be combined with an order tolerance",
    ("rk4", "--system", "1", "--plot", "x.svg"): "--plot takes one method",
    ("rk4", "--picture", "phase"): "--picture has no effect without --plot",
    ("rk4", "--at", "1"): "rk4 has no parameter; `at` works only with families",
    ("explicit_order_2", "--at", "0"): "explicit_order_2 is not defined at alpha = 0, a pole of its coefficients",
    ("explicit_order_2", "--at", "alpha"): "value: 'alpha', column 1: 'alpha' is a name",
    ("sdirk_order_2", "--system", "1"): "sdirk_order_2 is a family; choose one method with `at`, a value of gamma",
    ("sdirk_order_2", "--order-tolerance", "1"): "sdirk_order_2 is a family; choose one method",
    ("sdirk_order_2", "--plot", "x.svg"): "--plot takes one method",
    (
        "sdirk_order_2",
        "--only",
        "ssp_coefficient",
    ): "is a fact of single methods; choose one with `at`, a value of gamma",
    ("rk4", "--order-tolerance", "-1"): "tolerance -1 is negative; it must be >= 0",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal("facts", *words)


BAD_FILES = {
    "ragged.toml": 'family = "runge_kutta"\nA = [[0, 0], ["2/3"]]\nb = ["1/4", "3/4"]\n',
    "code.toml": 'family = "runge_kutta"\nA = [["__import__(1)"]]\nb = [1]\n',
    "root.toml": 'family = "runge_kutta"\nA = [["s3"]]\nb = [1]\n',
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_file_that_makes_no_sense_is_named(name, refusal, tmp_path):
    (tmp_path / name).write_text(BAD_FILES[name], encoding="utf-8")
    assert name in refusal("facts", str(tmp_path / name))


@pytest.mark.parametrize("name", ["region", "region.bogus"])
def test_picture_of_no_kind_is_refused_and_leaves_nothing(name, refusal, tmp_path):
    words = refusal("facts", "rk4", "--only", "order", "--plot", str(tmp_path / name))
    assert "a picture must be a .svg file" in words
    assert list(tmp_path.iterdir()) == []


def test_of_a_reducible_table_it_is_said_which_facts_are_of_the_table_and_which_of_the_method(facts, answer, tmp_path):
    """Backward Euler with a second stage that nothing uses: not stiffly accurate as written, and of one stage."""
    mine = tmp_path / "mine.toml"
    mine.write_text('family = "runge_kutta"\nA = [[1, 0], ["1/2", 0]]\nb = [1, 0]\n', encoding="utf-8")
    found = facts(str(mine), "--only", "stages,stiffly_accurate,symplectic")
    assert (found["stages"], found["stiffly_accurate"]) == (2, False)
    assert found["reduction"]["irreducible_stages"] == 1
    assert found["reduction"]["of_the_table"] == ["stages", "stiffly_accurate"]
    assert found["reduction"]["of_the_irreducible_method"] == ["symplectic"]
    for only in (("--all",), ("--only", "stages")):
        assert "stages that count: 1; of the table as written: stages" in answer("facts", str(mine), *only)
    assert "1 of them; which facts that concerns: --all\n" in answer("facts", str(mine))
    assert "irreducible" not in answer("facts", "rk4")
    assert set(facts(str(mine), "--only", "order")) == {"order"}, "the same of both"
    assert facts("rk4", "--only", "reduction") == {"reduction": None}
    assert set(facts("rk4", "--only", "stages")) == {"stages"}
