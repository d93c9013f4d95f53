"""Rational numbers go to FLINT and back exactly, and so do the ends of balls."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, ctx

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction, dyadic, ends_of
from driftproof.methods.numbers.number_field import square_root


def test_rationals_go_to_flint_and_back() -> None:
    for x in (Q(-3, 7), Q(0), Q(10**40)):
        assert as_fraction(as_fmpq(x)) == x
    assert as_fmpq(as_fmpq(2)) == as_fmpq(2)
    for foreign in (0.5, True, "1", square_root(2)):
        with pytest.raises(TypeError, match="is not rational"):
            as_fmpq(foreign)


def test_the_ends_of_a_ball_are_exact_in_any_precision() -> None:
    ball = arb(3) + arb(0, 1) * arb(2) ** -80
    with ctx.workprec(10):
        low, high = ends_of(ball)
        assert dyadic(ball.mid()) == 3
    assert 3 - Q(2, 2**80) < low <= 3 - Q(1, 2**80)
    assert low + high == 6
