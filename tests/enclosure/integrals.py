"""Integrals of piecewise cubics of the time, exactly: what a run of y' = f(t) has to enclose."""

from fractions import Fraction
from itertools import pairwise

from flint import ctx

from driftproof.symbolic.algebra.certified import enclose

END = Fraction(5)


def integral(f, cuts):
    """The integral of a piecewise cubic from 0 to the end, by Simpson's rule, which is exact for it."""
    total = Fraction(0)
    for a, b in pairwise([Fraction(0), *map(Fraction, cuts), END]):
        near, middle = (b - a) * Fraction(1, 10**30), (a + b) / 2
        total += (b - a) * (4 * f(middle) + f(a + near) + f(b - near)) / 6
    return total


def off(found, exact):
    """How far the last value is from a Fraction."""
    with ctx.workprec(160):
        return abs(found.states[-1][0] - enclose(exact))


def widest(found):
    """The largest radius of any ball."""
    return max(x.rad() for state in found.states for x in state)
