"""Functions of NumPy whose answers or arrays are ours mean what NumPy's mean, and systems are solved exactly."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.symbolic.algebra.certified import enclose
from tests.enclosure.values_in_balls import STATE, in_balls
from tests.looping import exactly

MASSES = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 0.3]])


def moving(y):
    return np.array([[0 * y[0], 1 + y[1] ** 2, 0.5], [y[1], y[0], 2.0], [0.0, y[2], 3.0]])


FIELDS = {
    "hypot": lambda t, y: np.hypot(1, y[0]) + np.hypot([1.0, 2.0, 3.0], y) + np.hypot(y, 2.0),
    "angles": lambda t, y: np.arctan2(1.0, y[0]) + np.arctan2(np.ones(3), y) + np.arctan2(y, 2),
    "sinc": lambda t, y: np.sinc(y) + np.sinc(y[0]) + np.sinc(0.5),
    "interp": lambda t, y: np.interp(y, [-9.0, 9.0], [1.0, 0.5]) - 0.1 * np.interp(y[0], [-9.0, 9.0], [1.0, 0.5]),
    "solve": lambda t, y: np.linalg.solve(MASSES, -y) + np.linalg.solve(MASSES, np.eye(3)) @ y,
    "solve with y": lambda t, y: np.linalg.solve(moving(y), y) + np.linalg.inv(moving(y)) @ y,
    "solve for columns": lambda t, y: np.linalg.solve(moving(y), np.outer(y, y))[:, 1],
    "float": lambda t, y: [float(y[0]) * float("0.5"), float(np.array(y[1])), isinstance(y[2] * 0 == 0, float)],
    "types": lambda t, y: np.asarray(y, dtype=float) + np.zeros(3, float) + isinstance(0.5, int | float),
}


@pytest.mark.parametrize("name", FIELDS)
def test_function_means_in_balls_what_it_means_in_floats(name):
    f = FIELDS[name]
    for ball, wanted in exactly(3, zip(in_balls(f), f(0.75, np.array(STATE)), strict=True)):
        assert abs(float(ball.mid()) - wanted) < 1e-13 * (1 + abs(wanted))


@pytest.mark.parametrize("matrix", [lambda y: MASSES, moving], ids=["constant", "of the state"])
def test_solution_of_a_system_satisfies_it_to_many_digits(matrix):
    """In Fractions, of the doubles in the matrix and the right side."""
    exact = [[Fraction(float(x)) for x in row] for row in np.asarray(matrix(np.array(STATE)), dtype=float)]
    with ctx.workprec(128):
        found = in_balls(lambda t, y: np.linalg.solve(matrix(y), np.array([y[0], 0.1, 0.7])))
        for row, right in exactly(3, zip(exact, (STATE[0], 0.1, 0.7), strict=True)):
            left = sum((enclose(a) * x for a, x in zip(row, found, strict=True)), arb(0))
            assert left.overlaps(arb(right))
            assert left.rad() < 1e-33


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (lambda t, y: np.linalg.solve(np.ones((3, 3)), y), "a matrix that has no inverse"),
        (lambda t, y: np.linalg.solve(np.outer(y, y), y), "a number that may be 0"),
        (lambda t, y: np.linalg.solve(np.ones((2, 3, 3)), y), "several matrices"),
    ],
)
def test_what_has_no_enclosure_is_refused(f, said):
    with pytest.raises(Refused, match=said):
        in_balls(f)
