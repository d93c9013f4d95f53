"""States of more numbers than q and v: what moves by another law is judged on it, and oscillators are counted."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
import pytest

from driftproof import identify, stepper_of, verify

# Slopes of x, v, a, b, of which the first two are an oscillator; what a wrong step takes for the last: new numbers.
LAWS = {
    "another oscillator": lambda t, x, v, a, b: (v, -x, b, -a),
    "of another frequency": lambda t, x, v, a, b: (v, -x, b, -4 * a - 0.2 * b),
    "driven by the first": lambda t, x, v, a, b: (v, -x, x - a, a - b),
    "not linear": lambda t, x, v, a, b: (v, -x, b, -sin(a) - v * v),
}


@dataclass
class Ring:
    x: float
    v: float
    y: float
    w: float


@dataclass
class Started:
    x: float
    v: float
    y: float = 0.0
    w: float = 0.0


class Kept:
    def __init__(self, advance: Any) -> None:
        self.x, self.v, self.y, self.w, self.t, self.count, self.advance = 1.0, 0.0, 0.0, 0.0, 0.0, 0, advance
        self.energy = self.numbers = 0.0

    def step(self, h: float) -> None:
        self.x, self.v, self.y, self.w = self.advance(self.x, self.v, self.y, self.w, h)
        self.energy = self.x**2 + self.v**2
        self.t, self.count = self.t + h, self.count + 1

    def step_of_arrays(self, h: float) -> None:
        self.numbers = np.array(self.advance(*self.numbers, h))


class Numbers(Kept):
    def __init__(self, advance: Any) -> None:
        self.numbers, self.advance = np.array([1.0, 0.0, 0.5, 0.25]), advance


def euler(law: Any, wrong: bool) -> Any:
    """Forward Euler of a law in floats; a wrong one moves the last two numbers one after the other."""

    def step(x: float, v: float, a: float, b: float, h: float) -> tuple[float, ...]:
        dx, dv, da, db = law(0.0, x, v, a, b)
        db = law(0.0, x, v, a + h * da, b)[3] if wrong else db
        return x + h * dx, v + h * dv, a + h * da, b + h * db

    return step


FORMS = {
    "an array": lambda step: lambda y, h: np.array(step(y[0], y[1], y[2], y[3], h)),
    "names": lambda step: lambda x, vx, y, vy, dt: step(x, vx, y, vy, dt),
    "a dict": lambda step: lambda s, dt: dict(zip("xvyw", step(s["x"], s["v"], s["y"], s["w"], dt), strict=True)),
    "a record": lambda step: _of_record(Ring, step),
    "a record with defaults": lambda step: _of_record(Started, step),
    "an object": lambda step: stepper_of(lambda: Kept(step), position="x", velocity="v"),
    "an array of an object": lambda step: stepper_of(lambda: Numbers(step), state="numbers", advance="step_of_arrays"),
}


def _of_record(record: Any, step: Any) -> Any:
    def moved(s, dt):
        return record(*step(s.x, s.v, s.y, s.w, dt))

    moved.__annotations__ = {"s": record}
    return moved


@pytest.mark.slow(keep=7)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("form", FORMS)
def test_further_numbers_of_a_state_are_judged_by_their_own_law(form, law):
    right, wrong = (
        verify(FORMS[form](euler(LAWS[law], x)), "forward_euler", examples=20, isolate=False) for x in (0, 1)
    )
    assert right.passed is (True if law == "another oscillator" else None), right.verdict
    said = "q'' = -q, 2 oscillators in one state" if right.passed else "on its own system (one of 4 numbers)"
    assert right.verdict.startswith(f"is forward_euler on {said.removeprefix('on ')}"), right.verdict
    assert wrong.passed is False
    assert "a step of" in wrong.verdict


def springs(stiff, wrong=0.0, together=0.0):
    """Symplectic Euler of springs of these stiffnesses, which their mean may move; a wrong one moves some late."""

    def step(pos, vel, dt):
        pos, vel = np.asarray(pos, float), np.asarray(vel, float)
        new = vel - dt * np.asarray(stiff) * pos - dt * together * (pos - pos.mean())
        return pos + dt * (new + wrong * (vel - new) * (np.arange(pos.size) > 0)), new

    return step


def timed(force, late=1.0):
    """The midpoint method with a force of the time, whose second slope may be late."""

    def step(x, v, t, h):
        v1 = v + h / 2 * (-x + force(t))
        return x + h * v1, v + h * (-(x + h / 2 * v) + force(t + late * h / 2))

    return step


@pytest.mark.parametrize(
    ("step", "method", "passed", "words"),
    [
        (springs((1.0, 4.0)), "symplectic_euler", None, "on its own system (one of 4 numbers)"),
        (springs((1.0, 4.0), 1.0), "symplectic_euler", False, "one of 4 numbers: a step of"),
        (springs(1.0, 0.0, 0.5), "symplectic_euler", None, "on its own system (one of 6 numbers)"),
        (springs(1.0, 1.0, 0.5), "symplectic_euler", False, "one of 6 numbers: a step of"),
        (springs(1.0, 1.0), "symplectic_euler", False, "but not of several oscillators at once"),
        (timed(lambda t: sin(2 * t)), "midpoint2", None, "on its own system ("),
        (timed(lambda t: sin(2 * t), 0.0), "midpoint2", False, "a step of"),
        (lambda x, v, t, h: (x + h * v, v - h * x + h * sin(t * h)), "forward_euler", False, "1 oscillator q'' = -q"),
        (lambda x, T, v, t, h: (x + h * v, T + h * cos(t), v - h * x), "forward_euler", None, "one of 3 numbers"),
        (lambda y, h: np.array([y[0] + h * y[1], y[1] - h * y[0], y[2] + h]), "forward_euler", True, "on q'' = -q"),
    ],
)
def test_a_law_of_several_positions_or_of_the_time_is_no_fault_of_a_step_and_hides_none(step, method, passed, words):
    report = verify(step, method, examples=20, isolate=False)
    assert (report.passed, words in report.verdict) == (passed, True), report.verdict


def test_identify_names_no_method_by_two_numbers_of_a_state_whose_others_move_otherwise():
    laws = ["another oscillator", *["of another frequency"] * 2]
    steps = [FORMS["an array"](euler(LAWS[law], wrong)) for law, wrong in zip(laws, (0, 0, 1), strict=True)]
    alike, right, wrong = (identify(step, isolate=False).verdict for step in steps)
    assert alike == "judging by linear steps only, it is forward_euler"
    assert "one of 4 numbers: on it its steps are those of forward_euler" in right
    assert "one of 4 numbers, and on it" in wrong or "verify shows more" in wrong
