"""Quotients of algebraic numbers, and numbers of a field as roots: against SymPy and radicals."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy
from flint import ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import Algebraic, square_root
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.radicals import radical_form
from driftproof.symbolic.algebra.real_roots import every_real_root, root_as_number, root_of, root_ratio


@pytest.mark.parametrize(
    ("x", "y", "text"),
    [
        ((-8, 0, 1), (-3, 0, 1), "2*sqrt(6)/3"), ((-8, 0, 1), (-8, 0, 1), "1"), ((-3, 0, 1), (-3, 2), "2*sqrt(3)/3"),
        ((-2, 0, 0, 1), (-2, 0, 0, 1), "1"), ((-2, 0, 0, 1), (-5, 3), "3*2**(1/3)/5"),
    ],
)  # fmt: skip
def test_ratio_of_roots(x: tuple[int, ...], y: tuple[int, ...], text: str) -> None:
    largest = [every_real_root(m)[-1] for m in (x, y)]
    assert radical_form(root_ratio(*largest)) == text


@settings(max_examples=25)
@given(st.fractions(-3, 3, max_denominator=9), st.fractions(-3, 3, max_denominator=9))
def test_a_number_is_the_root_of_its_polynomial_and_comes_back(a: Q, b: Q) -> None:
    x = a + b * square_root(5)
    root = root_of(x if b else a)
    assert root.degree == (2 if b else 1)
    wanted = sympy.minimal_polynomial(sympy.Rational(a) + sympy.Rational(b) * sympy.sqrt(5), polys=True)
    assert root.minimal == tuple(int(c) for c in reversed(wanted.all_coeffs()))
    with ctx.workprec(200):
        assert root.ball().overlaps(enclose(x if b else a))
        assert not root.ball().overlaps(enclose(x + 1))
    back = root_as_number(root)
    assert back == a if not b else isinstance(back, Algebraic)
