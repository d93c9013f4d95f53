"""How the truncation of a method's exact run falls with its steps, against the enclosure of a nonlinear problem."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache

import numpy as np
from flint import ctx

from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.runs.exact_runs import StepPlan
from driftproof.enclosure.solution.solutions import enclose_solution

BITS = 256


def swing(t, y):
    """q'' = -sin q + t/2: nonlinear, and with the time in it."""
    return [y[1], t / 2 - np.sin(y[0])]


@cache
def swung():
    return enclose_solution(swing, [Fraction(1), Fraction(1, 2)], [Fraction(0), Fraction(1)], BITS).states[-1]


def slope_of_truncation(method, n):
    """log2 of the fall of the truncation at t = 1 from n steps to 2n: the order, no rounding hiding it."""
    errors = []
    for steps in (n, 2 * n):
        times = tuple(Fraction(k, steps) for k in range(steps + 1))
        plan = StepPlan(enclosable(swing), method, times, (1,) * steps, (Fraction(1, steps),) * steps)
        with ctx.workprec(BITS):
            pairs = zip(plan.states([1.0, 0.5], BITS)[-1], swung(), strict=True)
            distances = [abs(z - x) for z, x in pairs]
        # Both are known to a thousandth, so that the slope is to 0.003.
        worst = max(distances, key=lambda x: float(x.mid()))
        assert worst.rad() < worst.mid() / 1000
        errors.append(float(worst.mid()))
    return math.log2(errors[0] / errors[1])
