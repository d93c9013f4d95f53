"""Polynomials over Q and over a field, and the rationals next to irrational numbers."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import Algebraic, cube_root, square_root
from driftproof.symbolic.rounding.polynomials import (
    GUARD_BITS,
    ONE,
    H,
    V,
    absolute_value,
    constant_polynomial,
    majorant,
    middle_and_radius,
    near_rational,
    rational_above,
    rational_ends,
    terms,
)

ROOT = square_root(2)
elements = st.builds(lambda a, b: a + b * ROOT, *[st.fractions(max_denominator=10**6)] * 2)


@given(elements, st.integers(-300, 300))
def test_ends_enclose_as_tightly_as_promised_and_a_rational_is_itself(x: Algebraic, scale: int):
    x = x * Q(2) ** scale
    low, high = rational_ends(x)
    assert low <= x <= high
    assert (high - low) * 2**GUARD_BITS <= absolute_value(x)
    assert (low == high) == x.is_rational
    assert rational_above(x) == high
    middle, radius = middle_and_radius(x)
    assert absolute_value(x - middle) <= radius <= (high - low) / 2


def test_a_number_that_cancels_to_almost_nothing_is_enclosed_relative_to_what_is_left():
    """(sqrt(2) - 1)^400 is 10^-153, a difference of two numbers of 153 digits."""
    left = (ROOT - 1) ** 400
    low, high = rational_ends(left)
    assert 0 < low < left < high
    widths = [high - low for low, high in map(rational_ends, (ROOT, 3 * ROOT, -ROOT / 2))]
    assert widths == [Q(1, 2**130), Q(1, 2**128), Q(1, 2**131)]
    assert (high - low) * 2**GUARD_BITS <= left < Q(1, 10**153)


def value(p, h: Q, v: Q):
    return sum((k * h**in_h * v**in_v for (_, _, in_h, _, in_v), k in terms(p)), Q(0))


@given(elements, elements, elements)
def test_polynomials_over_a_field_multiply_as_their_values_do(a: Algebraic, b: Algebraic, c: Algebraic):
    h, v = Q(3, 7), Q(-5, 2)
    p, q = constant_polynomial(a) * H + constant_polynomial(b) * V - 2, 3 - constant_polynomial(c) * V * H
    at_p, at_q = a * h + b * v - 2, 3 - c * v * h
    found = [value(x, h, v) for x in (p, q, p * q, p - q, H - p, H * p, ONE + p)]
    assert found == [at_p, at_q, at_p * at_q, at_p - at_q, h - at_p, h * at_p, 1 + at_p]
    assert bool(p - p) is False
    assert absolute_value(at_p) <= value(majorant(p), abs(h), abs(v))
    middle, radius = near_rational(p)
    assert absolute_value(at_p - value(middle, h, v)) <= value(radius, abs(h), abs(v))


def test_powers_of_a_generator_of_degree_three_are_reduced():
    """A field where alpha² is no rational: products of two of degree 2 reach alpha⁴."""
    root = cube_root(2)
    a, b = 1 + root - root * root / 3, 2 - root * root
    assert terms(constant_polynomial(a) * constant_polynomial(b)) == [((0,) * 5, a * b)]
    assert terms(constant_polynomial(root) * constant_polynomial(root * root)) == [((0,) * 5, Q(2))]


def test_two_fields_do_not_mix():
    with pytest.raises(TypeError, match=r"between sqrt\(2\) and 3\*\*\(1/3\)"):
        constant_polynomial(ROOT) * constant_polynomial(cube_root(3))
