"""Each formula solves its equation: it starts where it says, and its series has the derivative that f gives."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from flint import arb

from tests.looping import some
from tests.witnesses.closed_solutions import FAMILIES, kepler, rates_by_series


@pytest.mark.parametrize("name", FAMILIES)
def test_formula_solves_its_equation(name):
    random = Random(7)
    for _ in range(5):
        problem = FAMILIES[name](*(random.uniform(*ends) for ends in ((0.1, 2), (0.2, 3), (0.1, 2), (0.1, 1.5))))
        begun = rates_by_series(problem, problem.t0)
        assert all(float(abs(y - y0)) < 1e-14 for (_, y), y0 in some(zip(begun, problem.start, strict=True)))
        t = (problem.t0 + problem.end) / 2
        found = rates_by_series(problem, t)
        wanted = np.ravel(problem.f(t, np.array([float(y) for _, y in found])))
        # f is run on doubles: 1e-12 leaves room for a few thousand roundings.
        assert all(
            float(abs(rate - arb(w))) < 1e-12 * (1 + abs(w)) for (rate, _), w in some(zip(found, wanted, strict=True))
        )


def test_kepler_keeps_energy_and_angular_momentum():
    x, y, u, v = kepler(arb(1) / 2, arb(3))
    assert (x * v - y * u - (arb(3) / 4).sqrt()).contains(0)
    assert ((u * u + v * v) / 2 - 1 / (x * x + y * y).sqrt() + arb(1) / 2).contains(0)
    assert float(x.rad()) < 1e-12
