"""Roots in print: radicals are the numbers, decimals are correctly rounded, polynomials are in SymPy's syntax."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy

from driftproof.methods.numbers.number_field import NumberField
from driftproof.symbolic.algebra.radicals import (
    integer_polynomial_text,
    is_readable,
    perfect_part,
    radical_form,
    root_decimal,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, every_real_root, rational_root

RADICALS = {
    (0, 1): "0", (-2, 1): "2", (-1, 3): "1/3", (-8, 0, 1): "2*sqrt(2)", (-8, 0, 3): "2*sqrt(6)/3",
    (-8, 0, 0, 3): "2*9**(1/3)/3", (-1, -1, 1): "1/2 + sqrt(5)/2", (1, -3, 1): "3/2 + sqrt(5)/2",
    (-3, 0, -6, 0, 1): "sqrt(3 + 2*sqrt(3))", (-1, 0, 0, -2, 0, 0, 1): "(1 + sqrt(2))**(1/3)", (-24, 12, -4, 1): None,
}  # fmt: skip


@pytest.mark.parametrize("minimal", RADICALS)
def test_radical_form_is_the_number(minimal: tuple[int, ...]) -> None:
    largest = every_real_root(minimal)[-1]
    text = radical_form(largest)
    assert text == RADICALS[minimal]
    if text is not None:
        x = sympy.Symbol("x")
        value = sympy.parse_expr(text)
        assert sympy.minimal_polynomial(value, x) == sympy.Poly(list(reversed(minimal)), x).as_expr()
        assert value >= 0


def test_radical_form_of_the_smaller_and_of_a_negative_root() -> None:
    assert radical_form(RealRoot((1, -3, 1), 0)) == "3/2 - sqrt(5)/2"
    assert radical_form(RealRoot((-8, 0, 1), 0)) == "-2*sqrt(2)"
    assert radical_form(RealRoot((-1, -1, 1), 0)) == "1/2 - sqrt(5)/2"
    assert radical_form(RealRoot((-1, 0, 2), 0)) == "-sqrt(2)/2"
    assert radical_form(RealRoot((-1, 0, 0, -2, 0, 0, 1), 0)) == "-(-1 + sqrt(2))**(1/3)"


def test_radicals_that_nobody_can_read_are_left_out() -> None:
    assert radical_form(RealRoot((-(10**40 + 7), 0, 1), 1)) is None
    assert (perfect_part(10**30, 2), perfect_part(10**30 + 1, 2)) == ((10**15, 1), None)
    longest, longer = (NumberField("x", (-n, *[0] * 6, 1), Q(10**4), Q(10**5)) for n in (10**30, 10**30 + 1))
    assert [is_readable(x) for x in (longest.generator, longer.generator, Q(10**31))] == [True, False, True]


def test_decimals_are_correctly_rounded() -> None:
    assert root_decimal(RealRoot((-8, 0, 1), 1)) == "2.828427124746190097603377448419"
    assert root_decimal(ZERO_ROOT) == "0"
    assert root_decimal(rational_root(Q(2, 3)), 4) == "0.6667"


def test_integer_polynomials_print_in_sympys_syntax() -> None:
    assert integer_polynomial_text((-8, 0, 1)) == "x**2 - 8"
    assert integer_polynomial_text((1, -1)) == "-x + 1"
