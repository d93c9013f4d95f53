"""The leapfrog of VerifiedLeapfrog is velocity Verlet as a polynomial, and another program in floats."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from tests.witnesses.leapfrog import leapfrog

VERLET = METHODS["velocity_verlet"]


def test_the_polynomial_is_the_generic_one_and_the_order_of_operations_is_not():
    at = Q(1, 3), Q(-2, 7), Q(5, 11)
    assert leapfrog(oscillator, *at) == stepper(VERLET, lambda c: c)(oscillator, *at)
    starts = [(k / 3, -2 / (k + 6), 5 / 11) for k in range(1, 20)]
    assert any(leapfrog(oscillator, *z) != stepper(VERLET, float)(oscillator, *z) for z in starts)
