"""Runs of marked slopes: as many steps as asked for, of one copy, and marks that tell the places in a step apart."""

import re
from itertools import accumulate, pairwise

import numpy as np
import pytest

from driftproof.blackbox.families.multistep_runs import MarkedRuns, later_steps, remembers
from driftproof.blackbox.families.reports import GOES_ON
from driftproof.blackbox.findings import StepRaised, UnsupportedCall, WrongShape
from driftproof.blackbox.identify import identify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from driftproof.blackbox.verify import verify
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Remembering, Stormer
from tests.blackbox.handwritten_steppers import euler

STEPS = [
    (euler, False), (Remembering("adams_bashforth2", euler).step, True), (planted.in_a_closure(), True),
    (planted.run_of_adams_bashforth3, True), (Stormer().step, True),
    (lambda force, q, v, h: (q + h * (v - h * q), v - h * q), False),
    (lambda q, v, h: (q + h * v, v - h * q), False),
]  # fmt: skip


@pytest.mark.parametrize(("step", "does"), STEPS, ids=range(len(STEPS)))
def test_a_stepper_remembers_or_not(step, does):
    assert remembers(opened(step)) is does


def test_marks_are_by_the_time_by_a_clock_or_by_the_place():
    def of_two(y, f, h):
        assert len(y) == 2
        return y + h * f(y)

    for step, told, start in (
        (euler, (3, False, False, 1), [0.25, 0.5, 0.75]),
        (lambda y, f, h: y + h * f(y), (2, True, False, 1), [0.25, 0.5, 2.0]),
        (of_two, (1, True, False, 1), [0.25, 2.0]),
        (Stormer().step, (1, False, True, 2), [0.25, 0.5]),
        (lambda force, t, q, v, h: (q + h * v, v + h * force(t, q)), (1, False, False, 2), [0.25, 0.5]),
    ):
        runs = MarkedRuns.of(opened(step))
        assert (runs.size, runs.clock, runs.by_place, runs.derivative) == told
        assert runs.start(2.0) == start


def test_a_code_of_one_number_is_run_on_one():
    """With marks in time, or by the place where it has none."""
    alone = lambda f, t, y, h: y + h * f(t, float(y))
    for step, by_place in ((alone, False), (lambda y, f, h: y + h * f(float(y)), True)):
        runs = MarkedRuns.of(opened(step))
        assert (runs.size, runs.clock, runs.by_place) == (1, False, by_place)
        run = runs.run(5)
        assert np.array_equal(run.states[1:], run.states[:-1] + run.slopes[:-1])


def test_single_steps_and_built_in_systems_are_no_runs():
    assert later_steps(opened(euler)) == (None, "it makes single steps, not runs", "")
    another = "a step in a run differs from the same step taken alone: it remembers, or varies"
    assert later_steps(opened(planted.run_of_adams_bashforth2)) == (False, another, "")

    def run(f, y0, ts):
        return list(accumulate(pairwise(ts), lambda y, pair: y + (pair[1] - pair[0]) * f(pair[0], y), initial=y0))

    assert later_steps(opened(run)) == (True, "40 steps of a run, each the same as taken alone", "")
    late = lambda f, y0, ts: run(lambda t, y: f(t - (ts[1] - ts[0]) * (t > ts[0]), y), y0, ts)
    assert later_steps(opened(late)).words.endswith("taken alone: later ones call f at t - 1 h instead of t")
    with pytest.raises(UnsupportedCall, match="its steps cannot be marked by a given right-hand side"):
        MarkedRuns.of(opened(lambda q, v, h: (q + h * v, v - h * q)))


def test_a_run_that_cannot_go_on_is_not_said_to_go_on_as_it_begins():
    def once(f, y0, ts):
        if len(ts) > 2:
            raise RuntimeError("one step only")
        return [y0, y0 + (ts[1] - ts[0]) * f(ts[0], y0)]

    assert later_steps(opened(once))[0] is None
    assert "no run of 40 steps was obtained" in later_steps(opened(once))[1]
    subject = opened(planted.generated_adams_bashforth2)
    whole = planted.generated_adams_bashforth2
    subject.pristine = lambda *given: (y[: 1 if n == 2 else 3] for n, y in enumerate(whole(*given)))
    with pytest.raises(WrongShape, match="1 numbers came back for 3 given"):
        MarkedRuns(subject, 3, clock=False, by_place=False).run(5)
    subject = opened(euler)
    subject.pristine = lambda f, t, y, h: 1 // 0
    with pytest.raises(StepRaised, match="ZeroDivisionError"):
        MarkedRuns.of(subject)


class KeepsSlope:
    """The midpoint method that begins with a slope from its last step, kept and used in a way that is given."""

    def __init__(self, kept, used):
        self.kept, self.used, self.last = kept, used, None

    def step(self, f, t, y, h):
        k = f(t, y) if self.last is None else self.used(self.last, h)
        y1 = y + h * f(t + h / 2, y + h / 2 * k)
        self.last = self.kept(f, t, y1, h)
        return y1


ALONE = "a step in a run differs from the same step taken alone"
KEPT = [
    (KeepsSlope(lambda f, t, y, h: f(t + h, y), lambda k, h: k), ""),
    (KeepsSlope(lambda f, t, y, h: (h * f(t + h, y), h), lambda k, h: k[0] / k[1]), ""),
    (KeepsSlope(lambda f, t, y, h: h * f(t + h, y), lambda k, h: k / h), f"where h changes, {ALONE}"),
    (KeepsSlope(lambda f, t, y, h: f(t, y), lambda k, h: k), f"{ALONE}: it remembers, or varies"),
    (KeepsSlope(lambda f, t, y, h: f(t + h / 2, y), lambda k, h: k), f"{ALONE}: it remembers, or varies"),
]


@pytest.mark.parametrize(("made", "wrong"), KEPT, ids=range(len(KEPT)))
def test_an_object_that_keeps_a_slope_for_its_next_step_is_judged_by_copies_and_by_runs_of_changing_steps(made, wrong):
    right = f"midpoint2 to roundoff: 40 steps within the derived bound.*; {GOES_ON}"
    told = f"is {right}$" if not wrong else f"is midpoint2 for its first step only: {wrong}$"
    report = verify(made.step, "midpoint2", examples=40, isolate=False)
    assert re.match(told, report.verdict)
    assert report.data["remarks"] == [GOES_ON] * (not wrong)
    found = identify(made.step, isolate=False).verdict
    assert re.match(f"it is midpoint2; {'this holds for its first step only: ' if wrong else GOES_ON}", found)


def test_a_run_of_one_step_in_place_of_a_run_whose_later_times_are_wrong_is_not_shown():
    def rk2(f, a, b, alpha, n):
        h, t, ys = (b - a) / n, a, [alpha]
        for i in range(n):
            ys.append(ys[-1] + h * f(t + h / 2, ys[-1] + h / 2 * f(t, ys[-1])))
            t = a + i * h
        return np.array(ys)

    line = wrapper_line(rk2)
    exec(line[2:], names := {"rk2": rk2})
    assert verify(names["wrapped"], "midpoint2", examples=40, isolate=False).verdict.endswith(
        "call f at t - 1 h instead of t"
    )
