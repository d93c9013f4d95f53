"""Facts as text and as TeX: the same words around forms that are written in two ways, for every type of fact."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.families import FAMILIES
from driftproof.methods.formulas.expressions import parse_system
from driftproof.methods.numbers.number_field import NumberField, square_root
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.facts import Facts
from driftproof.symbolic.family_facts import FamilyFacts, LimitPiece
from driftproof.symbolic.linear.a_stability import sector_tangent
from driftproof.symbolic.linear.fact_values import ExactFunction, Formula, TruncatedSeries
from driftproof.symbolic.linear.families import Interval, ParameterSet
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.stability_limits import INFINITY
from driftproof.symbolic.linear.systems import EigenvalueLimit, SystemFacts
from driftproof.texts.writing.facts import fact_tex, fact_text, facts_tex, facts_text
from driftproof.texts.writing.records import is_long, record
from tests.symbolic.linear.family_examples import SDIRK_3
from tests.symbolic.linear.linear_examples import pade

RK4, GAUSS, SDIRK = Facts(METHODS["rk4"]), Facts(METHODS["gauss2"]), FamilyFacts(FAMILIES["sdirk_order_2"])


def eigenvalue(key, text, i=0):
    return SystemFacts(METHODS[key], parse_system(text)).bounds[i]


TURNED = NumberField("r", (-1, -3, 0, 1), Q(1), Q(2))  # 2 cos(pi/9)
EVERYWHERE = Interval(None, None, False, False)
HALVES = Interval(None, ZERO_ROOT, False, False), Interval(ZERO_ROOT, None, False, False)
LONG = "the root of a polynomial of 4312 characters"
RESTING = eigenvalue("forward_euler", "-1 0; 0 -1").eigenvalue
# A fact, as text, as TeX.
WRITTEN = [
    (None, "none", "none"), (True, "yes", "yes"), ("runge_kutta", "runge_kutta", r"runge\_kutta"),
    (Q(-1, 120), "-1/120", r"$-\frac{1}{120}$"),
    (1 - square_root(2) / 2, "1 - 1/2*sqrt(2)", r"$1-\frac{\sqrt{2}}{2}$"),
    (TURNED.generator**2 - 1, "-1 + (r)**2 = 2.5320888862379561", "$-1+r^{2}$"),
    (INFINITY, "oo", r"$\infty$"), ([], "none", "none"),
    ((Q(0), Q(1, 2)), "[0, 1/2]", r"[$0$, $\frac{1}{2}$]"),
    (RK4.imaginary_limit, "2*sqrt(2) = 2.828427124746190097603377448419", r"$2 \sqrt{2} \approx 2.82842712$"),
    (GAUSS.stability_function, "(1 + 1/2 z + 1/12 z^2)/(1 - 1/2 z + 1/12", r"$\frac{1+\frac{z}{2}+\frac{z^{2}}{12}}"),
    (RK4.energy_multiplier, "1 - 1/72 h^6 + 1/576 h^8", r"$1-\frac{h^{6}}{72}+\frac{h^{8}}{576}$"),
    (RK4.error_constant, "-1/120 h^5", r"$-\frac{h^{5}}{120}$"),
    (TruncatedSeries((Q(0), Q(1), Q(1, 12)), "z"), "z + 1/12 z^2 + O(z^3)", r"$z+\frac{z^{2}}{12}+O(z^{3})$"),
    (RK4.order_fails, "tree: [τ,τ,τ,τ], residual: 1/120", r"residual: $\frac{1}{120}$"),
    (SDIRK.stability_function, "(1 + (1 - 2*gamma) z + ", r"$\frac{1+(1-2 \gamma) z+"),
    (SDIRK.error_constant, "(-1/6 + gamma - gamma**2) h^3", r"$\left(-\frac{1}{6}+\gamma-\gamma^{2}\right) h^{3}$"),
    (SDIRK.l_stable, "{1 - sqrt(2)/2} U {1 + sqrt(2)/2}", r"$\{1-\frac{\sqrt{2}}{2}\} \cup \{1+\frac{\sqrt{2}}{2}\}$"),
    (ParameterSet(()), "empty", r"$\emptyset$"), (SDIRK.order_sets[-1], "4 nowhere", "4 nowhere"),
    (eigenvalue("forward_euler", "-1 0; 0 -1"), "-1, 2 times: h <= 2", r"$-1$, 2 times: $h \leq$ $2$"),
    (eigenvalue("forward_euler", "-1 1; 0 -1"), "-1, 2 times, Jordan block of size 2: h < 2", r"size 2: $h <$ $2$"),
    (eigenvalue("rk4", "1"), "1: no h, however small", "$1$: no h, however small"),
    (eigenvalue("backward_euler", "-1"), "-1: every h > 0", "$-1$: every $h > 0$"),
    (EigenvalueLimit(RESTING, UndecidedLimitError("a_b")), "-1, 2 times: a_b", r"$-1$, 2 times: a\_b"),
    (ArithmeticError("too_long: h**2"), "not decided: too_long: h**2", r"not decided: too\_long: h\^{}2"),
    (RK4.real_limit, "the root of x**3 - 4*x**2 + 12*x - 24 in (2, 3) = 2.785", r"-24$ in $(2, 3)$, $\approx 2.785293"),
    (eigenvalue("rk4", "0 1 0; 0 0 1; -1 -1 -2", 1), "a root of x**3 + 2*x**2 + x + 1 = -0.12256", "0.74486176 I$: $h"),
    (sector_tangent(pade(2, 8)), f"{LONG} in (11, 12) = 11.16750764", rf"{LONG} in $(11, 12)$, $\approx 11.1675076$"),
    (FamilyFacts(SDIRK_3).order_sets[3].values.intervals[-1], "{~1.06857902130}", r"$\{\approx 1.06857902130\}$"),
    (LimitPiece(EVERYWHERE, INFINITY), "oo on (-oo, oo)", r"$\infty$ on $(-\infty, \infty)$"),
    ([LimitPiece(x, INFINITY) for x in HALVES], "oo on (-oo, 0) U (0, oo)", r"on $(-\infty, 0) \cup (0, \infty)$"),
    (LimitPiece(EVERYWHERE, None, "a*x**3 - 2", 1), "positive root 1 of a*x**3 - 2 on (", r"root 1 of $a x^{3}-2$ on"),
    (LimitPiece(EVERYWHERE, None, "a*x - 2", 1, "2/a"), "2/a on (-oo, oo)", r"$\frac{2}{a}$ on $(-\infty, \infty)$"),
]  # fmt: skip


@pytest.mark.parametrize(("fact", "text", "tex"), WRITTEN, ids=range(len(WRITTEN)))
def test_fact_in_text_and_in_tex(fact, text, tex):
    assert fact_text(fact).startswith(text)
    assert tex in fact_tex(fact)
    assert fact_tex(fact).count("$") % 2 == 0


def test_whole_number_stands_once():
    two = Facts(METHODS["forward_euler"]).real_limit
    assert (fact_text(two), fact_tex(two)) == ("2", "$2$")


def test_a_list_takes_a_line_for_each_row_in_text_and_a_matrix_is_one_in_tex():
    h = ExactFunction(Facts(METHODS["forward_euler"]).one_step_matrix[0][1], "h")
    facts = {"one_step_matrix": Facts(METHODS["forward_euler"]).one_step_matrix, "entry": h}
    assert facts_text(facts).splitlines() == [
        "one step matrix  [1, h]",
        "                 [-h, 1]",
        "entry            h",
    ]
    assert r"one step matrix & $\begin{pmatrix}1 & h \\ -h & 1\end{pmatrix}$ \\" in facts_tex(facts)


def hostile(stages):
    """An implicit table whose numbers have forty digits each, as different as can be."""
    a = tuple(
        tuple(Q(10**20 * (i**j % 11 + 1) + i, 10**20 + 7 ** (i * j % 13)) for j in range(stages)) for i in range(stages)
    )
    b = tuple(Q(10**20, 10**21 + 3**j) for j in range(stages))
    return RungeKutta("hostile", "hostile", 0, "", a, b, tuple(sum(row) for row in a))


def test_text_and_tex_of_long_numbers_are_bounded_and_json_is_exact_with_decimals():
    """Exact also beyond the 4300 digits after which Python refuses to write an integer."""
    facts = Facts(hostile(12))
    names = ("stability_function", "modified_rate", "order_fails", "order_reduction")
    shown = {name: getattr(facts, name) for name in names}
    for value in (facts_text(shown), facts_tex(shown)):
        assert 1000 < len(value) < 20_000
    assert r"\ldots" in facts_tex(shown)
    known = record(shown)
    residual = known["order_fails"]["residual"]
    assert set(residual) == {"exact", "decimal"}
    assert abs(Q(residual["exact"]) - Q(residual["decimal"])) < Q(1, 10**20)
    assert f"a number of {len(residual['exact'])} characters = {residual['decimal']}" in facts_text(shown)
    numbers = known["stability_function"]["num"]
    assert max(map(len, numbers)) > 100
    assert all(isinstance(n, str) for n in numbers), "a list of coefficients stays one"
    assert len(record(TruncatedSeries((Q(10**5000, 3),)))[0]) == 5003


def test_number_of_thousands_of_characters_is_its_decimal_alone():
    number = Q(10**900 + 1, 3**1500)
    assert fact_text(number).startswith("a number of 1618 characters = 2.0802")
    assert fact_text(Q(1, 3)) == "1/3"
    assert fact_text((Q(1, 3), number)).startswith("[1/3, 2.0802")
    assert fact_text(Formula("x" * 500)) == "a formula of 500 characters"


def test_twelve_items_400_characters_and_17_digits_are_shown():
    for count, last in ((12, "12"), (13, "and 1 more (JSON has all)")):
        assert facts_text({"x": [str(i) for i in range(1, count + 1)]}).splitlines()[-1].strip() == last
        shown = fact_text({f"k{i}": i for i in range(1, count + 1)})
        assert shown.endswith("k12: 12" if count == 12 else "k12: 12, and 1 more (JSON has all)")
    assert fact_tex({str(n): n for n in range(12)}).endswith("11: 11")
    assert fact_text(Formula("x" * 400)) == "x" * 400
    assert fact_text(Formula("x" * 401)) == "a formula of 401 characters"
    assert not is_long(Q(1, 10**57))
    assert is_long(Q(1, 10**58))
    for size, exact in ((395, True), (396, False)):  # with "/" and the denominator 401 characters
        text = fact_text(Q(10**size + 1, 10**2))
        assert text.startswith(f"{10**size + 1}/100" if exact else f"a number of {size + 5} characters")
    long = [Q(1, 3), Q(10**395, 3)]
    assert fact_text(long) == f"[1/3, {'3' * 1}.{'3' * 16}e394...]"
    assert fact_text([Q(1, 3), Q(10**97, 3)]) == f"[1/3, {10**97}/3]"
    assert fact_text([Q(1, 3), Q(10**98, 3)]) == f"[1/3, 3.{'3' * 16}e97...]", "one of 101 characters"
    assert "..." not in fact_text(4 * [Q(10**97, 3)])
    assert fact_text([*4 * [Q(10**97, 3)], Q(1)]).count("...") == 4, "401 characters together"


def test_the_decimal_comes_before_a_long_polynomial():
    short, long = (
        Facts(RungeKutta("m", "m", 0, "", ((0, 0, 0), (x, 0, 0), (0, x, 0)), (0, 0, 1), (0, x, x)))
        for x in (Q(2, 5), Q(10**40 + 1, 2 * 10**40 + 7))
    )
    assert fact_text(short.real_limit).startswith(("the root of ", "a number in "))
    assert fact_text(long.real_limit).split(", ")[1].startswith("the root of ")
    assert float(fact_text(long.real_limit).split(", ")[0]) == float(long.real_limit)
