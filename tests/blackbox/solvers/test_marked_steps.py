"""The one step that marks show: its stages, also those beyond its end, or why it has none."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver
from driftproof.blackbox.solvers.marked_steps import MarkedStep
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.solvers.planted_solvers import run


def twenty(make):
    """Twenty steps of a stepper."""
    return lambda f, t_span, y0, rtol, atol: run(make, f, t_span, y0, 20)


def heun_at(*nodes):
    return twenty(lambda: codes.tableau([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], nodes))


def with_a_last_stage(part):
    """Heun's method, whose first slope is that at the end of the step before, called at a part of that step."""
    kept = []

    def step(f, t, y, h):
        first = kept.pop() if kept else f(t, y)
        y1 = y + h / 2 * (first + f(t + h, y + h * first))
        kept.append(f(t + part * h, y1))
        return y1

    return step


def adams_bashforth():
    """Of order 2, with an Euler step first."""
    kept = []

    def step(f, t, y, h):
        kept.append(f(t, y))
        return y + h * (kept[0] if len(kept) == 1 else 1.5 * kept[-1] - 0.5 * kept[-2])

    return step


def with_a_jacobian(f, t, y, h):
    return y + h * (f(t, y) + 0 * np.asarray(f(t, y + 1e-8)))


@pytest.mark.parametrize("solve", [heun_at(0.0, 1.0), twenty(lambda: with_a_last_stage(1))], ids=range(2))
def test_the_stages_of_a_step_are_read_and_a_last_one_may_be_the_first_of_the_next(solve):
    reading = MarkedStep(ForeignSolver(solve)).reading()
    assert (reading.a, reading.b, reading.c) == (((0.0, 0.0), (1.0, 0.0)), (0.5, 0.5), (0.0, 1.0))


@pytest.mark.parametrize("nodes", [(0.0, 2.0), (1.0, 2.0)])
def test_stages_beyond_the_end_are_read_if_they_are_looked_for(nodes):
    marked = MarkedStep(ForeignSolver(heun_at(*nodes)))
    with pytest.raises(NotReadable):
        marked.reading()
    assert marked.reaches_beyond()
    reading = marked.reading()
    assert (reading.b, reading.c) == ((0.5, 0.5), pytest.approx(nodes, abs=2.0**-50))
    assert not MarkedStep(ForeignSolver(heun_at(0.0, 1.0))).reaches_beyond()


@pytest.mark.parametrize(("solve", "words"), [
    (twenty(adams_bashforth), "a slope that enters one step enters the next as well, by -0.5 h: it is a multi"),
    (twenty(lambda: with_a_last_stage(0.75)), "its first slope is that of a call at c = 3/4 of the step before"),
    (twenty(lambda: with_a_jacobian), "with all slopes 0, from y = 0, it calls f at y = 1e-08: differences for a Jac"),
    (lambda f, t_span, y0, *_: ([t_span[0]] * 3, [y0] * 3), "its times do not increase"),
], ids=range(4))  # fmt: skip
def test_what_is_no_step_of_stages_says_what_was_seen(solve, words):
    with pytest.raises(NotReadable, match=words):
        MarkedStep(ForeignSolver(solve)).reading()
