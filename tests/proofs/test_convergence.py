"""Local and global error coefficients, against what exact runs do as h goes to 0, in balls."""

from __future__ import annotations

from fractions import Fraction as Q
from math import factorial
from typing import Any

import pytest
import sympy
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.derivation.expression_balls import enclose_expression
from driftproof.symbolic.derivation.one_step import H, entries, matrix, matrix_at, one_step_matrix, rational
from driftproof.symbolic.runs import as_balls, power
from proofs.derivations.convergence import (
    FINAL_TIME,
    J,
    LocalError,
    exact_flow_series,
    global_error_coefficient,
    local_error,
    rotation,
)
from tests.nine import NINE

PRECISION = 400


def flow(t: Q) -> list[arb]:
    c, s = enclose(t).cos(), enclose(t).sin()
    return [c, s, -s, c]


def distance(a: Any, b: Any) -> arb:
    """The largest difference of corresponding entries."""
    return max((abs(x - y) for x, y in zip(a, b, strict=True)), key=lambda ball: ball.mid())


def numbers(m: sympy.Matrix) -> list[arb]:
    return [enclose_expression(entry) for entry in m]


@pytest.mark.parametrize("key", NINE)
def test_local_error_divided_by_its_power_tends_to_the_coefficient(key: str) -> None:
    m = one_step_matrix(NINE[key])
    local = local_error(m)
    assert local.linear_order == NINE[key].claimed_order
    left = []
    for h in (Q(1, 10**3), Q(1, 10**4)):
        with ctx.workprec(PRECISION):
            error = [a - b for a, b in zip(as_balls(matrix_at(m, h)), flow(h), strict=True)]
            scaled = [e / enclose(h) ** local.power for e in error]
            left.append(distance(scaled, numbers(local.coefficient)))
    assert left[0] < arb(1) / 1000  # the next coefficient of every catalogue method is below 1
    assert left[1] < left[0] / 5  # it goes to 0 with h


@pytest.mark.parametrize("end", [Q(1), Q(10)])
@pytest.mark.parametrize("key", NINE)
def test_global_error_divided_by_its_power_tends_to_the_coefficient(key: str, end: Q) -> None:
    m = one_step_matrix(NINE[key])
    local = local_error(m)
    left = [_left_over(m, local, end, n) for n in (10**4, 10**5)]
    assert left[1] < left[0] / 9  # ten times smaller steps leave a tenth, or a hundredth
    assert left[1] < arb(1) / 100


def _left_over(m: Any, local: LocalError, end: Q, n: int) -> arb:
    h = end / n
    with ctx.workprec(PRECISION):
        error = [a - b for a, b in zip(power(as_balls(matrix_at(m, h)), n), flow(end), strict=True)]
        coefficient = global_error_coefficient(local).subs(FINAL_TIME, sympy.Rational(end.numerator, end.denominator))
        return distance([e / enclose(h) ** local.linear_order for e in error], numbers(coefficient))


def test_wrong_coefficient_does_not_pass_for_a_limit() -> None:
    m = one_step_matrix(NINE["forward_euler"])
    local = local_error(m)
    doubled = LocalError(local.power, 2 * local.coefficient)
    left = [_left_over(m, doubled, Q(1), n) for n in (10**4, 10**5)]
    assert not left[1] < left[0] / 9


@given(st.integers(2, 12))
def test_truncated_exact_flow_has_an_order_one_below_its_first_missing_power(terms: int) -> None:
    local = local_error(exact_flow_series(terms))
    assert local.power == terms
    assert local.coefficient != sympy.zeros(2, 2)


def test_inconsistent_step_has_an_error_of_order_zero() -> None:
    assert local_error(matrix([[2, 0], [0, 1]])).power == 0
    assert local_error(matrix([[1, 2 * H], [-H, 1]])).linear_order == 0


def test_exact_flow_series_is_a_rotation_to_its_last_power() -> None:
    c, s, minus_s, c_again = entries(exact_flow_series(9))
    assert (minus_s, c_again) == (-s, c)
    assert all(power_ >= 9 for (power_,) in (c**2 + s**2 - 1).monoms())
    assert rotation(sympy.Integer(0)) == sympy.eye(2)
    assert rotation(FINAL_TIME).diff(FINAL_TIME) == J * rotation(FINAL_TIME)  # J = [[0, 1], [-1, 0]]: q' = v, v' = -q


def test_global_coefficient_satisfies_the_variational_equation() -> None:
    """G' = J G + C exp(TJ), G(0) = 0, for a C with all four kinds of entry."""
    c = sympy.ImmutableMatrix([[1, 2], [5, 11]])
    coefficient = global_error_coefficient(LocalError(3, c))
    residual = coefficient.diff(FINAL_TIME) - J * coefficient - c * rotation(FINAL_TIME)
    assert residual.applyfunc(sympy.expand) == sympy.zeros(2, 2)
    assert coefficient.subs(FINAL_TIME, 0) == sympy.zeros(2, 2)
    assert coefficient.diff(FINAL_TIME) - J * coefficient - rotation(FINAL_TIME) * c != sympy.zeros(
        2, 2
    )  # C does not commute with J


@given(st.integers(1, 20))
def test_sine_and_cosine_of_the_exact_flow_have_their_factorials_and_stop_in_time(terms: int) -> None:
    c, s = entries(exact_flow_series(terms))[:2]
    for k in range(terms):
        sign, series = (-1) ** (k // 2), (s if k % 2 else c)
        assert series.coeff(H**k) == rational(Q(sign, factorial(k)))
    assert max(s.degree(), c.degree()) <= max(terms - 1, 0)
