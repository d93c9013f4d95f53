"""Polynomials in x and a parameter: arithmetic against values, factors, and where common roots may change."""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.bivariate import (
    ParametricPair,
    add_rows,
    at_parameter,
    bivariate_text,
    common_divisor,
    critical_polynomial,
    divide_rows,
    inflate,
    irreducible_factors,
    merging_values,
    multiply_rows,
    rows_modulus_squared,
    slope_in_x,
    subtract_rows,
    trimmed,
    without_root_zero,
)
from driftproof.symbolic.algebra.polynomials import X as T
from driftproof.symbolic.algebra.polynomials import modulus_squared_on_imaginary_axis

COEFFICIENTS = st.lists(st.integers(-4, 4), max_size=3).map(fmpq_poly)
ROWS = st.lists(COEFFICIENTS, max_size=4).map(trimmed)


@given(ROWS, ROWS, st.integers(-7, 7))
def test_arithmetic_is_that_of_the_values_at_a_parameter(a: Any, b: Any, t: int) -> None:
    p, q = at_parameter(a, fmpq(t)), at_parameter(b, fmpq(t))
    assert at_parameter(add_rows(a, b), fmpq(t)) == p + q
    assert at_parameter(subtract_rows(a, b), fmpq(t)) == p - q
    assert at_parameter(multiply_rows(a, b), fmpq(t)) == p * q
    assert at_parameter(slope_in_x(a), fmpq(t)) == p.derivative()
    assert at_parameter(inflate(a), fmpq(t)) == p(fmpq_poly([0, 0, 1]))
    assert at_parameter(rows_modulus_squared(a), fmpq(t)) == modulus_squared_on_imaginary_axis(p)


@given(ROWS.filter(bool), ROWS.filter(bool))
def test_common_divisor_divides_both_and_quotient_undoes_a_product(a: Any, b: Any) -> None:
    shared = common_divisor(a, b)
    for rows in (a, b):
        assert multiply_rows(divide_rows(rows, shared), shared) == rows
    assert divide_rows(multiply_rows(a, b), b) == a


def test_irreducible_factors_come_once_and_constants_in_x_not_at_all() -> None:
    line, conic = [T, fmpq_poly([1])], [-T, fmpq_poly([0]), fmpq_poly([1])]  # x + t and x**2 - t
    product = multiply_rows(multiply_rows(line, line), multiply_rows(conic, [T]))
    assert sorted(irreducible_factors(product), key=len) == [line, conic]
    assert irreducible_factors([]) == []
    assert without_root_zero([fmpq_poly(), *line]) == line


def test_common_roots_change_only_where_the_critical_polynomial_vanishes() -> None:
    """x**2 - t and x - 1 have a common root at t = 1 only; x**2 - t and its slope at t = 0 only."""
    conic, line = [-T, fmpq_poly(), fmpq_poly([1])], [fmpq_poly([-1]), fmpq_poly([1])]
    assert merging_values(conic, line) == 1 - T
    merging = merging_values(conic, slope_in_x(conic))
    assert merging is not None
    assert [merging(fmpq(t)) == 0 for t in (-1, 0, 1)] == [False, True, False]
    assert merging_values(conic, []) is None
    constants = ParametricPair(lambda t: (fmpq_poly([t]), fmpq_poly([1])), (0, 0), (1, 0))
    assert critical_polynomial(constants) == 1


def test_polynomials_print_with_the_highest_power_first() -> None:
    assert bivariate_text([fmpq_poly([-2]), fmpq_poly([1, -2])], "x", "gamma") == "(1 - 2*gamma)*x - 2"
    assert bivariate_text([fmpq_poly([0, 1]), fmpq_poly([-1]), fmpq_poly([1])], "x", "t") == "x**2 - x + t"
    assert bivariate_text([], "x", "t") == "0"
