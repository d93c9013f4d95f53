"""Waves are integrated exactly, and sparse matrices multiply as full ones do."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx
from scipy import signal, sparse, special
from scipy.signal import square

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.problem_tables import problem_table
from driftproof.enclosure.solution.solutions import enclose_solution
from tests.enclosure.integrals import END, integral, off
from tests.enclosure.values_in_balls import STATE, in_balls
from tests.looping import exactly

PERIOD = 2 * Fraction(np.pi)
FULL = np.array([[0.5, 0.0, -1.0], [0.0, 0.1, 0.0], [2.0, 0.0, 0.3]])
A, B = sparse.csr_matrix(FULL), sparse.csc_array(FULL)


def phase(t):
    return 3 * t % PERIOD / PERIOD


# The wave, the part of the period where it changes, and its values there by the phase.
WAVES = {
    "square": (lambda t: signal.square(3 * t), [Fraction(1, 2)], lambda p: 1 if p < 0.5 else -1),
    "by name": (lambda t: square(3 * t, 0.25), [Fraction(1, 4)], lambda p: 1 if p < 0.25 else -1),
}


@pytest.mark.parametrize("name", WAVES)
def test_integral_of_a_wave_is_enclosed(name):
    f, changes, value = WAVES[name]
    cuts = sorted(c for k in range(4) for p in (0, *changes) if 0 < (c := (k + p) * PERIOD / 3) < END)
    found = enclose_solution(lambda t, y: [f(t)], [Fraction(0)], [Fraction(0), END])
    assert off(found, integral(lambda t: value(phase(t)), cuts)) < 1e-28


@pytest.mark.parametrize("name", WAVES)
def test_wave_is_text_of_a_problem(name):
    f = WAVES[name][0]
    field = problem_table({"function": lambda t, y: [f(t) - y[0]], "start": ["1"], "end": "4"}).field
    for t in exactly(9, np.linspace(0.1, 6, 9)):
        assert abs(field_function(field)(t, [0.0])[0] - f(t)) < 1e-14


PRODUCTS = {
    "@": lambda t, y: A @ y + B @ y - A.dot(y),
    "scaled": lambda t, y: A * y + (2 * A) @ y - (B * t) @ y + (y[0] * A) @ y,
    "of columns": lambda t, y: (A @ np.outer(y, y))[:, 0] + A @ np.ones(3),
    "functions": lambda t, y: (
        special.erf(y)
        + special.erfc(2 * y[0])
        + math.erf(y[1])
        + math.erfc(y[0])
        + special.expit(y)
        + special.expit(y[0])
    ),
    "waves": lambda t, y: signal.square(y, 0.25) + signal.square(np.array([0.5, 1.0, 2.0])),
}


@pytest.mark.parametrize("name", PRODUCTS)
def test_function_means_in_balls_what_it_means_in_floats(name):
    f = PRODUCTS[name]
    for ball, wanted in exactly(3, zip(in_balls(f), np.ravel(f(0.75, np.array(STATE))), strict=True)):
        assert abs(float(ball.mid()) - wanted) < 1e-13 * (1 + abs(wanted))


def test_product_has_many_digits():
    """By Fractions of the doubles."""
    with ctx.workprec(128):
        found = in_balls(lambda t, y: A @ np.array([y[0], 0.1, 0.7]))
        for row, ball in exactly(3, zip(FULL, found, strict=True)):
            exact = sum(Fraction(a) * Fraction(x) for a, x in zip(row.tolist(), (STATE[0], 0.1, 0.7), strict=True))
            assert abs(ball - arb(exact.numerator) / exact.denominator) < 1e-36


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (lambda t, y: B * y, "entry by entry"),
        (lambda t, y: A @ y[:2], "3 columns times 2 rows"),
        (lambda t, y: A.power(2) @ y, "f uses power of a sparse matrix"),
        (lambda t, y: signal.square(t, y[0]) * y, "no constant from 0 to 1"),
        (lambda t, y: (A + B) @ y, "unsupported operand"),
        (lambda t, y: y * A, "from the left"),
    ],
)
def test_what_has_no_enclosure_is_refused(f, said):
    with pytest.raises(Refused, match=said):
        in_balls(f)
