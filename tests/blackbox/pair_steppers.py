"""Steps (f, t, y, h) of the catalogue's explicit pairs that return their error estimates in ways right and wrong."""

from __future__ import annotations

import numpy as np

from driftproof.methods.catalogue import METHODS
from tests.plain_algebra import product


def pair_step(key, answer=lambda y1, error, h, y: (y1, error), *, estimate=lambda e: e, order=None):
    """The step of the pair `key`, which may be KEY_embedded; `estimate` may spoil its row b - b_hat.

    Its stages are called in their order, or in another `order` in which none uses a later one.
    """
    method = METHODS[key]
    a, c = [[float(x) for x in row] for row in method.a], [float(x) for x in method.c]
    b, row = np.array([*map(float, method.b)]), [x - y for x, y in zip(method.b, method.b_embedded, strict=True)]
    e = np.array(estimate([float(x) for x in row]))

    def step(f, t, y, h):
        k = [0 * y] * len(c)
        for i in order or range(len(c)):
            k[i] = f(t + c[i] * h, y + h * sum((a[i][j] * k[j] for j in range(i)), 0 * y))
        return answer(y + h * product(b, k), h * product(e, k), h, y)

    return step


def but_one(place, value):
    """The row with another weight in this place."""
    return lambda e: [*e[:place], value, *e[place + 1 :]]
