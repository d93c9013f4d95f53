"""`driftproof facts` of systems, families, tolerances, boundaries: answers, renderings, one line for bad input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import driftproof
from driftproof.methods.families import FAMILIES
from driftproof.methods.systems import parse_system
from driftproof.symbolic.linear.systems import SYSTEM_FACTS

Run = Callable[..., tuple[int, str, str]]
Answer = Callable[..., str]

DAMPED = "0 1; -1 -1/10"


@pytest.fixture
def facts(answer: Answer) -> Callable[..., dict[str, Any]]:
    def ask(*arguments: str) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(answer("facts", *arguments, "--format", "json"))
        return found

    return ask


Facts = Callable[..., dict[str, Any]]


def test_facts_on_a_system_are_those_of_python(facts: Facts) -> None:
    found = facts("rk4", "--system", DAMPED)
    assert list(found) == sorted(SYSTEM_FACTS)
    assert found == driftproof.system_facts(driftproof.METHODS["rk4"], parse_system(DAMPED))
    assert found["system"] == [["0", "1"], ["-1", "-1/10"]]
    assert found["one_step_matrix"][0][0] == {"num": ["1", "0", "-1/2", "1/60", "33/800"], "den": ["1"]}
    assert found["step_limit"]["decimal"] == "2.909799685490394332749367463504"
    assert found["eigenvalues"][0]["value"]["exact"] == "-1/20 + sqrt(399)/20*I"
    assert facts("rk4", "--system", "0 1; -1 0")["step_limit"]["exact"] == "2*sqrt(2)"


def test_a_family_is_answered_as_functions_and_sets(facts: Facts, answer: Answer) -> None:
    found = facts("sdirk_order_2")
    assert found == driftproof.family_facts(FAMILIES["sdirk_order_2"])
    assert found["stability_function"]["num"] == ["1", "1 - 2*gamma", "1/2 - 2*gamma + gamma**2"]
    assert found["l_stable"]["set"] == "{1 - sqrt(2)/2} U {1 + sqrt(2)/2}"
    text = answer("facts", "sdirk_order_2", "--only", "real_limit,order_sets,error_constant")
    assert text.splitlines() == [
        "real limit      2/(1 - 4*gamma) on (-oo, 1/4)",
        "                oo on [1/4, oo)",
        "order sets      1 on (-oo, oo)",
        "                2 on (-oo, oo)",
        "                3 on {1/2 - sqrt(3)/6} U {1/2 + sqrt(3)/6}",
        "                4 nowhere",
        "error constant  (-1/6 + gamma - gamma**2) h^3",
    ]


def test_a_member_of_a_family_is_a_method(facts: Facts) -> None:
    found = facts("sdirk_order_2", "--at", "1 - sqrt(2)/2")
    assert (found["order"], found["l_stable"], found["real_limit"]) == (2, True, "oo")
    assert found["field"]["generator"] == "sqrt(2)"
    assert facts("sdirk_order_2", "--at", "1/5", "--only", "real_limit")["real_limit"]["exact"] == "10"
    assert facts("explicit_order_2", "--at", "2/3", "--system", "-3")["step_limit"]["exact"] == "2/3"


def test_a_family_of_your_own(facts: Facts, tmp_path: Path) -> None:
    theta = tmp_path / "theta.toml"
    theta.write_text(
        'family = "runge_kutta"\nparameter = "theta"\n'
        'A = [[0, 0], ["1 - theta", "theta"]]\nb = ["1 - theta", "theta"]\n',
        encoding="utf-8",
    )
    assert facts(str(theta), "--only", "a_stable")["a_stable"]["set"] == "[1/2, oo)"
    assert facts(str(theta), "--at", "1/2", "--only", "order") == {"order": 2}


def test_families_are_listed_with_the_methods(answer: Answer) -> None:
    listed = {line.split()[0]: line for line in answer("methods").splitlines()}
    assert set(FAMILIES) <= set(listed)
    assert "Runge-Kutta in gamma" in listed["sdirk_order_2"]


def test_order_to_a_tolerance_stands_beside_the_order(facts: Facts) -> None:
    found = facts("tsitouras54", "--only", "order,order_fails", "--order-tolerance", "1e-12")
    assert found["order"] == 0
    assert found["order_fails"] == {"tree": "τ", "residual": "-17/100000000000000000"}
    assert (found["order_to_tolerance"]["order"], found["order_to_tolerance"]["tolerance"]) == (5, "1/1000000000000")
    assert "order_to_tolerance" not in facts("tsitouras54", "--only", "order")


def test_points_of_the_boundary_are_there_when_named(facts: Facts, answer: Answer) -> None:
    record = facts("rk4", "--only", "region_boundary")["region_boundary"]
    assert len(record["points"]) > 50
    assert "region_boundary" not in facts("rk4", "--only", "order,method")
    text = answer("facts", "rk4", "--only", "region_boundary")
    assert text.startswith("region boundary  -2.785293563405282 + 0.000000000000000*I, ")
    assert text.endswith("|error| < 1e-15, and the conjugates\n")


TEX = {
    ("forward_euler", "--only", "imaginary_limit"): "imaginary limit & $0$ ",
    ("gauss2", "--only", "real_limit"): r"real limit & $\infty$ ",
    ("rk4", "--only", "imaginary_limit"): r"$2 \sqrt{2} \approx 2.82842712$",
    ("rk4", "--only", "real_limit"): r"the root of $x^{3}-4 x^{2}+12 x-24$ in $(2, 3)$, $\approx 2.78529356$",
    ("gauss2", "--only", "field"): r"$\sqrt{3}$, the root of $x^{2}-3$ in $(1, 2)$, $\approx 1.73205080$",
    ("ssprk22", "--only", "real_limit"): "real limit & $2$ ",
    ("mclachlan_atela5", "--only", "dispersion"): r"$\approx -5.0000000 \cdot 10^{-20}$ $h$",
    ("sdirk_order_2", "--only", "a_stable"): r"$[\frac{1}{4}, \infty)$",
    ("sdirk_order_2", "--only", "l_stable"): r"$\{1-\frac{\sqrt{2}}{2}\} \cup \{1+\frac{\sqrt{2}}{2}\}$",
    ("explicit_order_2", "--only", "a_stable"): r"$\emptyset$",
    ("sdirk_order_2", "--only", "real_limit"): r"$\frac{2}{1-4 \gamma}$ on $(-\infty, \frac{1}{4})$; $\infty$ on $[",
    ("sdirk_order_2", "--only", "stability_function"): r"}{1-2 \gamma z+\gamma^{2} z^{2}}$",
    ("rk4", "--system", "0 1; -3 0", "--only", "system"): r"$\begin{pmatrix}0 & 1 \\ -3 & 0\end{pmatrix}$",
    ("rk4", "--system", "0 1; -3 0", "--only", "eigenvalues"): r"$\sqrt{3} I$",
    (
        "rk4",
        "--system",
        "0 1 0; 0 0 1; -5 -1 -1/2",
        "--only",
        "eigenvalues",
    ): r"near $0.58932965 + 1.62211528 I$: limit $0$",
}


@pytest.mark.parametrize("arguments", TEX)
def test_tex_of(arguments: tuple[str, ...], answer: Answer) -> None:
    shown = answer("facts", *arguments, "--format", "tex")
    assert TEX[arguments] in shown
    assert shown.count("$") % 2 == 0


TEXT = {
    ("gauss2", "--only", "field"): "sqrt(3), the root of x**2 - 3 in (1, 2) = 1.732050807568877293527446341506",
    (
        "rk4",
        "--system",
        "-1 1; 0 -1",
        "--only",
        "eigenvalues",
    ): ", 2 times, Jordan block of size 2: h < ",
    ("rk4", "--system", "0 0; 0 0", "--only", "eigenvalues"): "0, 2 times: every h > 0",
    ("rk4", "--system", "1", "--only", "eigenvalues"): "no h, however small",
    ("rk4", "--system", "0 1; -3 0", "--only", "eigenvalues"): "sqrt(3)*I: h <= 2*sqrt(6)/3 = ",
    ("velocity_verlet", "--system", "0 1; -3 0", "--only", "eigenvalues"): "sqrt(3)*I: h < 2*sqrt(3)/3 = ",
    ("rk4", "--system", "0 1; -3 0", "--only", "one_step_matrix"): "[-3 h + 3/2 h^3, 1 - 3/2 h^2 + 3/8 h^4]",
    ("mclachlan_atela5", "--only", "dispersion_series"): "dispersion series  none",
    ("implicit_midpoint", "--only", "modified_rate", "--terms", "4"): "modified rate  z + 1/12 z^3 + O(z^4)",
    ("backward_euler", "--only", "order_reduction"): "power: 2, function: (-1/2)/(1 - z), at_infinity",
    ("midpoint2", "--only", "conserved_quadratics"): "conserved quadratics  none",
}


@pytest.mark.parametrize("arguments", TEXT)
def test_text_of(arguments: tuple[str, ...], answer: Answer) -> None:
    assert TEXT[arguments] in answer("facts", *arguments)


WRONG = [
    (("rk4", "--system", "0 1; 2"), "the system is not square: row 2 of 2 has 1 entries"),
    (("rk4", "--system", ""), "the system is not square: row 1 of 1 has 0 entries"),
    (("rk4", "--system", "0 x; 1 0"), "row 1, entry 2: 'x' is no expression: 'x' is a name"),
    (("rk4", "--system", "__import__('os').system('true')"), "row 1, entry 1: "),
    (("rk4", "--system", "sqrt(2)"), "row 1, entry 1: sqrt(2) is irrational; the entries of a system are rational"),
    (("rk4", "--system", "1/0"), "it divides by zero"),
    (("rk4", "--system", "1;" * 13), "the system has 13 rows; at most 12 are read"),
    (("rk4", "--system", "1e999999999"), "row 1, entry 1: '1e999999999' is too long"),
    (("velocity_verlet", "--system", DAMPED), "velocity_verlet needs a system q' = v, v' = Kq"),
    (("rk4", "--system", "1", "--only", "order"), "unknown fact 'order'; choose from method, system"),
    (("rk4", "--system", "1", "--order-tolerance", "1"), "--system is about one problem"),
    (("rk4", "--system", "1", "--plot", "x.svg"), "--system is about one problem"),
    (("rk4", "--at", "1"), "rk4 has no parameter; --at is for families"),
    (("explicit_order_2", "--at", "0"), "explicit_order_2: no method at alpha = 0, a pole of its coefficients"),
    (("explicit_order_2", "--at", "alpha"), "value: 'alpha' is no expression: 'alpha' is a name"),
    (("sdirk_order_2", "--at", "sqrt(2) + sqrt(3)"), "numbers of two fields"),
    (("sdirk_order_2", "--system", "1"), "sdirk_order_2 is a family; choose one method with --at, a value of gamma"),
    (("sdirk_order_2", "--order-tolerance", "1"), "sdirk_order_2 is a family; choose one method"),
    (("sdirk_order_2", "--plot", "x.svg"), "sdirk_order_2 is a family; choose one method"),
    (("sdirk_order_2", "--only", "ssp_coefficient"), "unknown fact 'ssp_coefficient'; choose from method, title"),
    (("rk5",), "unknown method 'rk5'"),
    (("rk4", "--order-tolerance", "-1"), "tolerance -1 is below zero"),
    (("rk4", "--order-tolerance", "small"), "order tolerance: 'small' is not a rational number"),
]


@pytest.mark.parametrize(("arguments", "reason"), WRONG, ids=range(len(WRONG)))
def test_bad_input_gets_one_line_and_status_two(arguments: tuple[str, ...], reason: str, run: Run) -> None:
    status, out, err = run("facts", *arguments)
    assert (status, out) == (2, "")
    assert reason in err
    assert err.count("\n") == 1
    assert len(err) < 500


def test_user_s_own_tableau_and_bad_files(facts: Facts, run: Run, tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")
    assert facts(str(mine), "--only", "order,stability_function")["order"] == 2
    bad = {
        "ragged.toml": 'family = "runge_kutta"\nA = [[0, 0], ["2/3"]]\nb = ["1/4", "3/4"]\n',
        "code.toml": 'family = "runge_kutta"\nA = [["__import__(1)"]]\nb = [1]\n',
        "root.toml": 'family = "runge_kutta"\nA = [["s3"]]\nb = [1]\n',
        "missing.toml": None,
    }
    for name, text in bad.items():
        if text is not None:
            (tmp_path / name).write_text(text, encoding="utf-8")
        status, out, err = run("facts", str(tmp_path / name))
        assert (status, out, err.count("\n")) == (2, "", 1)
        assert name in err


def test_picture_of_the_region_is_drawn_and_a_splitting_has_none(run: Run, tmp_path: Path) -> None:
    picture = tmp_path / "region.svg"
    for kind in ("region", "order-star", "phase"):
        assert run("facts", "rk4", "--only", "order", "--plot", str(picture), "--picture", kind)[0] == 0
        assert picture.read_text(encoding="utf-8").count("<svg") == 1
        picture.unlink()
    assert run("facts", "symplectic_euler", "--plot", str(picture))[0] == 2
    assert not picture.exists()


def test_a_family_is_no_single_method() -> None:
    from driftproof.methods.families import method_of

    with pytest.raises(ValueError, match="sdirk_order_2 is a family of methods, with gamma free; one method is needed"):
        method_of("sdirk_order_2")
    assert method_of("rk4").key == "rk4"


def test_python_has_what_the_command_line_has() -> None:
    r = driftproof.stability_function_of(driftproof.METHODS["rk4"])
    assert len(driftproof.boundary_points(r, 2)) > 8
    assert driftproof.order_within(driftproof.METHODS["rk4"], 0).order == 4
    assert driftproof.facts_of(driftproof.METHODS["rk4"], ("order",)) == {"order": 4}
    assert set(driftproof.FAMILIES) == {"sdirk_order_2", "sdirk_stiffly_accurate", "explicit_order_2"}
