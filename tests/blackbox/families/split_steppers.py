"""IMEX methods as people write them, with Newton's method for the implicit part; right ones, and wrong twins."""

from __future__ import annotations

import numpy as np

from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.families.linearised_steppers import floats
from tests.blackbox.implicit_steppers import newton


def imex(key, *, implicit_times=None, most=50, other=None, **changed):
    """The step of a method of the catalogue; `changed` gives entries of its tables other values, `most` iterations.

    With the weights of an `other` result, the same in both parts, it returns that as well.
    """
    method = FURTHER_METHODS[key]
    table = {name: floats(getattr(method, name)) for name in ("a_explicit", "a_implicit")}
    table |= {name: floats([getattr(method, name)])[0] for name in ("b_explicit", "b_implicit")}
    c = table["a_explicit"].sum(axis=1)
    for name, (place, value) in changed.items():
        table[name][place] = value
    a, a_implicit, b, b_implicit = table.values()
    times = c if implicit_times is None else np.array(implicit_times)

    def step(f_explicit, f_implicit, t, y, h):
        k, m = [], []
        for i in range(len(b)):
            pairs = zip(a[i], a_implicit[i], k, m, strict=False)
            known = y + h * sum((x * p + z * q for x, z, p, q in pairs), 0 * y)
            place, at, diagonal = known, t + times[i] * h, a_implicit[i, i]
            if diagonal:
                place = newton(
                    lambda x, w=h * diagonal, at=at, known=known: x - known - w * f_implicit(at, x), known, most=most
                )
            k.append(f_explicit(t + c[i] * h, place))
            m.append(f_implicit(at, place))
        y1 = y + h * sum(x * p + z * q for x, z, p, q in zip(b, b_implicit, k, m, strict=True))
        return y1 if other is None else (y1, y + h * sum(x * (p + q) for x, p, q in zip(other, k, m, strict=True)))

    return step


def euler_pair(y, f, g, h):
    """Forward Euler for f, then backward Euler for g, without times."""
    known = y + h * f(y)
    return newton(lambda x: x - known - h * g(x), known)


def split_in_turn(f, g, t, y, h):
    """Backward Euler for g, then Euler for f at its end: a splitting, of other places than the pair."""
    first = newton(lambda x: x - y - h * g(t + h, x), y)
    return first + h * f(t, first)


def unsolved(f, g, t, y, h):
    """One iteration towards the implicit stage, and no more."""
    known = y + h * f(t, y)
    return known + h * g(t + h, known + h * g(t + h, known))
