"""Rational functions in lowest terms and in print, and power series that satisfy their equations."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import fmpq, fmpq_poly

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.algebra.polynomials import coefficients, exact, polynomial
from driftproof.symbolic.algebra.rational_functions import (
    exponential_series,
    fraction,
    polynomial_text,
    rational_function_text,
    series_logarithm,
    series_product,
    series_quotient,
    series_root,
    taylor,
)

ROOT_2, ROOT_3 = square_root(2), square_root(3)
X = fmpq_poly([0, 1])


def test_fraction_is_in_lowest_terms_and_normalised() -> None:
    f = fraction((X - 2) * (X + 3), (X - 2) * (2 * X + 4))
    assert f.data() == {"num": ["3/4", "1/4"], "den": ["1", "1/2"]}
    assert fraction(X, X * X).data() == {"num": ["1"], "den": ["0", "1"]}
    assert fraction(X * 0, X).data() == {"num": ["0"], "den": ["1"]}
    assert f.at_infinity() == Q(1, 2)
    assert fraction(X).at_infinity() is None
    assert fraction(X, X**2 + 1).at_infinity() == 0
    with pytest.raises(ZeroDivisionError):
        fraction(X, X * 0)


def test_fraction_cancels_an_irrational_factor() -> None:
    root = polynomial([-ROOT_3, 1])
    f = fraction(root * (X + 1), polynomial([-3, 0, 1]))
    assert f.num.degree() == 1
    assert [str(c) for c in coefficients(f.den)] == ["1", "1/3*sqrt(3)"]


def test_series_satisfy_their_equations() -> None:
    f = fraction(1 + X / 3 + X**2, 1 - X / 5 + polynomial([0, 0, ROOT_2]))
    terms = taylor(f, 12)
    assert series_product(series_quotient(terms, exponential_series(12)), exponential_series(12)) == terms
    root = series_root(terms)
    assert series_product(root, root) == terms
    slope = [k * c for k, c in enumerate(series_logarithm(terms))]
    assert series_product(terms, slope) == [k * c for k, c in enumerate(terms)]
    assert [exact(c) for c in series_logarithm(exponential_series(9))] == [0, 1, 0, 0, 0, 0, 0, 0, 0]
    for of_series in (series_logarithm, series_root):
        with pytest.raises(ValueError, match="constant term"):
            of_series([fmpq(2)])


def test_functions_print_in_sympys_syntax() -> None:
    assert polynomial_text(polynomial([Q(1, 2), 0, Q(-1, 8)]), "h") == "1/2 - h**2/8"
    assert polynomial_text(polynomial([0, Q(-1, 2)]), "h") == "-h/2"
    assert polynomial_text(polynomial([0, 2 - ROOT_2]), "h") == "(2 - sqrt(2))*h"
    assert polynomial_text(polynomial([2 - ROOT_2, Q(3, 4), -3]), "h") == "(2 - sqrt(2)) + 3*h/4 - 3*h**2"
    over = [(X**0, X), (X**0, X**2), (1 + X, 3 * X - 3), (X**0, 1 + X)]
    texts = [rational_function_text(fraction(*parts), "h") for parts in over]
    assert texts == ["1/h", "1/h**2", "(-1/3 - h/3)/(1 - h)", "1/(1 + h)"]
    assert rational_function_text(fraction(1 - X**2 / 4, 1 + X**2 / 4), "h") == "(1 - h**2/4)/(1 + h**2/4)"
