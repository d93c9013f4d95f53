"""Polynomials in x and a parameter: arithmetic against values, factors, and where common roots may change."""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.bivariate import T_OF_TWO as T
from driftproof.symbolic.algebra.bivariate import X_OF_TWO as X
from driftproof.symbolic.algebra.bivariate import (
    ParametricPair,
    at_parameter,
    bivariate_text,
    critical_polynomial,
    degree_in_t,
    degree_in_x,
    from_rows,
    in_square_of_x,
    irreducible_factors,
    merging_values,
    modulus_squared_in_x,
    reflected_in_x,
    rows_in_x,
    without_root_zero,
)
from driftproof.symbolic.algebra.polynomials import modulus_squared_on_imaginary_axis

ROWS = st.lists(st.lists(st.integers(-4, 4), max_size=3).map(fmpq_poly), max_size=4)


@given(ROWS, st.integers(-7, 7))
def test_what_is_done_in_x_is_done_to_the_values_at_a_parameter(rows: Any, t: int) -> None:
    a = from_rows(rows)
    p = at_parameter(a, fmpq(t))
    assert from_rows(rows_in_x(a)) == a
    assert (len(rows_in_x(a)), max((c.degree() for c in rows), default=-1)) == (degree_in_x(a) + 1, degree_in_t(a))
    assert at_parameter(in_square_of_x(a), fmpq(t)) == p(fmpq_poly([0, 0, 1]))
    assert at_parameter(reflected_in_x(a), fmpq(t)) == p(fmpq_poly([0, -1]))
    assert at_parameter(modulus_squared_in_x(a), fmpq(t)) == modulus_squared_on_imaginary_axis(p)


def test_irreducible_factors_come_once_and_constants_in_x_not_at_all() -> None:
    line, conic = X + T, X**2 - T
    assert sorted(irreducible_factors(line * line * conic * T), key=degree_in_x) == [line, conic]
    assert irreducible_factors(0 * X) == []
    assert without_root_zero(X * X * line) == line
    assert without_root_zero(0 * X) == 0


def test_common_roots_change_only_where_the_critical_polynomial_vanishes() -> None:
    """x**2 - t and x - 1 have a common root at t = 1 only; x**2 - t and its slope at t = 0 only."""
    assert merging_values(X**2 - T, X - 1) == fmpq_poly([1, -1])
    merging = merging_values(X**2 - T, (X**2 - T).derivative(0))
    assert merging is not None
    assert [merging(fmpq(t)) == 0 for t in (-1, 0, 1)] == [False, True, False]
    assert [merging_values(X**2 - T, c + 0 * X) is None for c in (0, 1, -1)] == [True, False, False]
    assert [merging_values(c + 0 * X, X**2 - T) is None for c in (0, 1, -1)] == [True, False, False]
    shared = merging_values((X - T) ** 2 * (X * T + 1), (X - T) * (X**2 + 3 * T**3))
    assert shared == fmpq_poly([0, 0, 1, 3, 0, 0, 0, 3, 9]), "the factor x - t is common for all t"
    assert merging_values(X**2 * T - X - 3 * T**2, X**3 - T * X + 1) == fmpq_poly([1, 0, 0, 12, 0, 0, -12])
    constants = ParametricPair(lambda t: (fmpq_poly([t]), fmpq_poly([1])), (0, 0), (1, 0))
    assert critical_polynomial(constants) == 1


def test_polynomials_print_with_the_highest_power_first() -> None:
    assert bivariate_text((1 - 2 * T) * X - 2, "x", "gamma") == "(1 - 2*gamma)*x - 2"
    assert bivariate_text(X**2 - X + T, "x", "t") == "x**2 - x + t"
    assert bivariate_text(X * T + T - 1, "x", "t") == "t*x + (-1 + t)"
    assert bivariate_text(0 * X, "x", "t") == "0"
