"""Limits, order and R of a family as functions of its parameter, against members and against SymPy."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from functools import cache
from typing import Any

import pytest
import sympy
from flint import fmpq_poly

from driftproof.methods.families import FAMILIES
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.algebra.bivariate import T_OF_TWO, X_OF_TWO
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.real_roots import positive_roots
from driftproof.symbolic.family_facts import Branch, FamilyFacts, _at_point, family_residuals
from driftproof.symbolic.trees.order_conditions import order, runge_kutta_conditions
from driftproof.texts.writing.records import record
from tests.symbolic.linear.family_examples import CUBIC, SDIRK_3, SECOND, THETA, family
from tests.symbolic.trees.residuals import residuals

EVERY = {**FAMILIES, "theta": THETA, "cubic": CUBIC, "second": SECOND, "sdirk_3": SDIRK_3}
NAMES = ("real_limit", "imaginary_limit")


def value_of(expression: str, number: Any, **names: Any) -> Any:
    """The expression's value by Python's own arithmetic, every numeral being read by `number`."""
    return eval(re.sub(r"\d+(?:\.\d+)?", lambda m: f"number('{m[0]}')", expression), {"number": number, **names})


def inside(value: Q, interval: dict[str, Any]) -> bool:
    """Does the value lie in the interval, by the decimals of its ends?"""
    low, high = (
        end if isinstance(end, str) and end.endswith("oo") else Q(end if isinstance(end, str) else end["decimal"])
        for end in (interval["low"], interval["high"])
    )
    above = low == "-oo" or low < value or (low == value and interval["low_closed"])
    return above and (high == "oo" or value < high or (value == high and interval["high_closed"]))


def agrees(key: str, name: str, value: Q, pieces: list[dict[str, Any]]) -> bool:
    """Is the limit by pieces that of the member, to 29 digits? SymPy counts the roots of the curve below it."""
    of_member = facts(EVERY[key].member(value), only=(name,)).data[name]
    (piece,) = (piece for piece in pieces if inside(value, piece["interval"]))
    if piece["curve"] is None:
        return bool(piece["limit"] == of_member)
    if isinstance(of_member, str):
        return False
    wanted = sympy.Rational(of_member["decimal"])
    names = {"x": sympy.Symbol("x"), "sqrt": sympy.sqrt, EVERY[key].parameter: sympy.Rational(value)}
    curve = sympy.Poly(value_of(piece["curve"], sympy.Rational, **names), names["x"])
    slack = wanted * sympy.Rational(1, 10**29)
    if piece["formula"] is not None:
        assert abs(value_of(piece["formula"], sympy.Rational, **names).evalf(40) - wanted) <= slack
    return [curve.count_roots(0, wanted + side * slack) for side in (-1, 1)] == [piece["root"] - 1, piece["root"]]


@cache
def pieces_of(key: str, name: str) -> list[dict[str, Any]]:
    pieces: list[dict[str, Any]] = facts(EVERY[key], only=(name,)).data[name]
    return pieces


@pytest.mark.parametrize("key", EVERY)
@pytest.mark.parametrize("name", NAMES)
def test_limit_by_pieces_is_that_of_members(key: str, name: str) -> None:
    pieces = pieces_of(key, name)
    ends = [Q(end["decimal"]) for piece in pieces for end in piece["interval"].values() if isinstance(end, dict)]
    near = [end + side for end in ends for side in (Q(-1, 10**12), Q(1, 10**12))]
    for value in [*near, Q(-7, 3), Q(1, 5), Q(2, 3), Q(9, 4)]:
        assert agrees(key, name, value, pieces), value


def test_a_piece_with_another_root_another_end_or_another_curve_is_noticed() -> None:
    (first, *rest) = pieces_of("sdirk_3", "real_limit")
    value = Q(-7, 3)
    assert agrees("sdirk_3", "real_limit", value, [first, *rest])
    moved = {**first, "curve": first["curve"].replace("-12", "-13")}
    assert moved != first
    assert not agrees("sdirk_3", "real_limit", value, [moved, *rest])
    theta = pieces_of("theta", "real_limit")
    shifted = [{**piece, "interval": {**piece["interval"]}} for piece in theta]
    for piece, end in zip(shifted, ("high", "low"), strict=True):
        piece["interval"][end] = "3/5"
    assert agrees("theta", "real_limit", Q(11, 20), theta)
    assert not agrees("theta", "real_limit", Q(11, 20), shifted)


def test_limits_that_are_known_formulas() -> None:
    """On the imaginary axis 1 + z + z²/2 + az³ has |R|² - 1 = y⁴ (1/4 - 2a + a²y²)."""
    imaginary = [(p["where"], p["formula"]) for p in pieces_of("second", "imaginary_limit")]
    assert imaginary == [("(-oo, 1/8]", None), ("(1/8, oo)", "sqrt((-1/4 + 2*a)/a**2)")]
    real = pieces_of("theta", "real_limit")
    assert [(p["where"], p["formula"], p["limit"]) for p in real] == [
        ("(-oo, 1/2)", "2/(1 - 2*theta)", None),
        ("[1/2, oo)", None, "oo"),
    ]


def test_the_point_where_two_curves_meet_is_a_piece_of_its_own() -> None:
    pieces = pieces_of("cubic", "real_limit")
    assert [p["where"] for p in pieces] == ["(-oo, -1/2)", "{-1/2}", "(-1/2, 2]", "(2, oo)"]
    assert pieces[1]["limit"]["exact"] == "1 + sqrt(5)"


def test_a_limit_at_a_point_continues_the_branch_whose_root_it_is_there() -> None:
    """At t = 2 the roots of (x - 1)(x - t) are 1 and 2."""
    curves, (one, two) = [(X_OF_TWO - 1) * (X_OF_TWO - T_OF_TWO)], positive_roots([fmpq_poly([2, -3, 1])])
    first, second = Branch(0, 1), Branch(0, 2)
    assert [_at_point(curves, Q(2), limit, [first, second]) for limit in (one, two)] == [first, second]
    assert _at_point(curves, Q(2), two, [first]) == two


# --- order


@pytest.mark.parametrize("key", EVERY)
@pytest.mark.parametrize("vertices", [1, 2, 3, 4])
def test_residuals_as_functions_are_those_of_members(key: str, vertices: int) -> None:
    for value in (Q(2, 7), Q(-5, 3)):
        member = residuals(runge_kutta_conditions(EVERY[key].member(value)), vertices)
        functions = family_residuals(EVERY[key], vertices)
        assert [tree for tree, _ in functions] == [tree for tree, _ in member]
        assert [exact(f(scalar(value))) for _, f in functions] == [x for _, x in member]


ORDERS = {
    "sdirk_order_2": (2, ["(-oo, oo)", "(-oo, oo)", "{1/2 - sqrt(3)/6} U {1/2 + sqrt(3)/6}", "empty"]),
    "sdirk_stiffly_accurate": (1, ["(-oo, oo)", "{1 - sqrt(2)/2} U {1 + sqrt(2)/2}", "empty"]),
    "explicit_order_2": (2, ["(-oo, 0) U (0, oo)", "(-oo, 0) U (0, oo)", "empty"]),
    "theta": (1, ["(-oo, oo)", "{1/2}", "empty"]),
}


@pytest.mark.parametrize("key", ORDERS)
def test_order_and_the_values_where_it_is_higher(key: str) -> None:
    found = FamilyFacts(EVERY[key])
    assert (found.order, [str(where.values) for where in found.order_sets]) == ORDERS[key]
    assert [where.order for where in found.order_sets] == list(range(1, len(found.order_sets) + 1))
    assert found.order_fails.residual.function.f.num != 0


@pytest.mark.parametrize("key", FAMILIES)
def test_claimed_order_of_a_family_is_its_order_for_all_values(key: str) -> None:
    assert FamilyFacts(FAMILIES[key]).order == FAMILIES[key].claimed_order
    assert facts(FAMILIES[key], only=("method", "order")).data == {"method": key, "order": FAMILIES[key].claimed_order}


def test_order_four_is_reached_at_the_three_values_of_crouzeix() -> None:
    """The roots of 24g³ - 36g² + 12g - 1, of which 1.0685790213016288 is the known one (hairer-wanner-1996, IV.6)."""
    sets = [where.values.intervals for where in FamilyFacts(SDIRK_3).order_sets]
    assert [len(where) for where in sets] == [2, 2, 3, 3, 0]
    low = sets[3][2].low
    assert low is not None
    assert low.minimal == (-1, 12, -36, 24)
    assert record(low)["decimal"].startswith("1.0685790213016288")
    assert order(SDIRK_3.member(Q(1068579021, 10**9))).order == 2


def test_a_critical_value_of_high_degree_is_refused_and_said_so() -> None:
    """R = (1 + z)/(1 - p(t)z): A-stability turns where p(t) = -1 or 0, irreducible of degree 13."""
    twisted = family("t", "t**13 - 3", "t**13 - 2", "t**13 - 3")
    found = facts(twisted, only=("a_stable", "real_limit", "order")).data
    assert "degree 13" in found["a_stable"]["refused"]
    assert "at a critical value of t: degree 13" in found["real_limit"]["refused"]
    assert found["order"] == 0
