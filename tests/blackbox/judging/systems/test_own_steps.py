"""The slopes of a built-in system, its own time and its words, seen in short steps; a method's steps on it."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.judging.systems.own_steps import OwnSteps, table_step
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from tests.blackbox.judging.systems.test_own_system import on
from tests.looping import some

KEYS = ["rk4", "dormand_prince54", "backward_euler"]
STATES = [(1.0, 0.5), (-0.75, 1.25)]


def test_slopes_come_out_of_short_steps_to_more_than_half_of_their_digits():
    rate = lambda t, x, v: (v, -15 * np.sin(x) - 0.1 * v + np.cos(2 * t))
    seen = OwnSteps(opened(on(rate)), STATES, 0.25)
    for t, (x, v) in some([(t, y) for t in (0.0, 1.5) for y in STATES]):
        assert seen.slopes(t, (x, v)) == pytest.approx(rate(t, x, v), rel=2.0**-30)


def test_what_answers_nowhere_oscillates_nowhere():
    def silent(q, v, h):
        raise ValueError("no")

    steps = OwnSteps(opened(on(lambda t, x, v: (v, -x))), STATES)
    assert steps.oscillates(2.0**-13)
    steps.subject.function = silent
    assert not OwnSteps(steps.subject, STATES).oscillates(2.0**-13)


def test_the_step_of_a_table_is_that_of_the_method():
    """On q'' = -q: explicit stages as the engine takes them, and backward Euler's as its equation is solved by hand."""
    q, v, h = 0.5, -0.25, 0.125
    found = [table_step(METHODS[key], lambda t, y: [y[1], -y[0]], 0.0, (q, v), h, 2.0**-50) for key in KEYS]
    told = [stepper(METHODS[key], float)(lambda q: -q, q, v, h) for key in KEYS[:-1]]
    told.append(((q + h * v) / (1 + h * h), (v - h * q) / (1 + h * h)))
    assert found == [pytest.approx(each, rel=1e-13) for each in told]


@pytest.mark.parametrize(("late", "passed"), [(False, None), (True, False)])
def test_a_place_where_bodies_nearly_touch_does_not_hide_the_system(late, passed):
    """One of the three states that are looked at has slopes some thousand times those of the others."""
    force = lambda x: 1e-3 * (2 / abs(x - 0.8) ** 13 - 1 / abs(x - 0.8) ** 7)

    def step(x, v, dt):
        moved = x + dt * v + dt**2 / 2 * force(x)
        return moved, v + dt * (force(moved) if late else (force(x) + force(moved)) / 2)

    assert verify(step, "velocity_verlet", examples=20, isolate=False).passed is passed


def test_a_damping_that_is_small_beside_a_stiff_spring_is_part_of_the_system():
    found = verify(on(lambda t, x, v: (v, -1e6 * x - 10 * v)), "rk4", examples=30, isolate=False)
    assert "is rk4 on its own system (q' = v, v' = -1e+06 q - 10 v)" in found.verdict


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("last", "passed", "words"), [(1, None, "v' = -1e+06 q), to "), (2, False, "ends in")])
def test_the_own_time_of_a_stiff_spring_is_that_of_its_swing(last, passed, words):
    def step(x, v, dt):
        x, v = x + dt * (v - dt / 2 * 1e6 * x), v - dt / 2 * 1e6 * x
        return x, v - last * dt / 2 * 1e6 * x

    found = verify(step, "velocity_verlet", examples=30, isolate=False)
    assert found.passed is passed, found.verdict
    assert words in found.verdict
    held = verify(step, "velocity_verlet", system=lambda t, y: [y[1], -1e6 * y[0]], isolate=False)
    assert held.passed is (passed is None), held.verdict


def test_a_friction_as_small_as_rounding_is_not_said_to_be_one():
    step = lambda x, v, dt: (x + dt * (v - dt * (x**3 + 1e-7 * v)), v - dt * (x**3 + 1e-7 * v))
    assert "rounding leaves open whether it is" in verify(step, "symplectic_euler", examples=20, isolate=False).verdict


@pytest.mark.parametrize(("force", "law"), [
    (lambda q, v: -q - 0.5 * abs(v), "another one"), (lambda q, v: -max(q, 0.0), "another one"),
    (lambda q, v: -2 * q - 0.5 * v, "q' = v, v' = -2 q - 0.5 v"),
], ids=["a drag", "a contact", "a spring"])  # fmt: skip
def test_a_law_that_has_a_kink_at_0_is_not_told_as_a_linear_one(force, law):
    step = lambda q, v, h: (q + h * v, v + h * force(q, v))
    steps = OwnSteps.of(opened(step), [(1.0, 0.75), (0.375, 0.5), (-1.0, 0.1875)])
    assert steps.law == law
