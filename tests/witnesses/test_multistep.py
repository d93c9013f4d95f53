"""The witness of multistep methods knows the first of them, and sees a wrong coefficient."""

from dataclasses import replace
from fractions import Fraction as Q
from math import log2

from tests.witnesses.multistep import adams, bdf, error_at_one, lagrange, largest


def test_the_first_methods_are_made():
    assert lagrange([0, 1]) == [(1, -1), (0, 1)]
    assert adams(2, implicit=False).sigma == (Q(-1, 2), Q(3, 2), 0)
    assert bdf(1).rho == (-1, 1)


def test_a_run_sees_a_wrong_coefficient_and_a_root_outside():
    right = adams(3, implicit=False)
    wrong = replace(right, sigma=(right.sigma[0] + Q(1, 100), *right.sigma[1:]))
    rates = [log2(error_at_one(method, 32) / error_at_one(method, 64)) for method in (right, wrong)]
    assert abs(rates[0] - 3) < 0.5
    assert rates[1] < 0.5
    assert largest(bdf(7), 0) > 1.02 > 1.001 > largest(bdf(6), 0)
