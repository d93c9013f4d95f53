"""Curves of error against steps: orders as claimed, a wrong coefficient flagged, ends that say why."""

from __future__ import annotations

import dataclasses
from fractions import Fraction as Q
from math import inf

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.problems.problem import EXACT, Reference
from driftproof.numeric.reference_errors import STATE, Size
from driftproof.numeric.work_precision import curves as curves_module
from driftproof.numeric.work_precision.curves import (
    FLOOR_POINTS,
    Curve,
    Point,
    counts,
    curve_of,
    for_goal,
    lasting,
    measure_curve,
    measured,
    step_counts,
)
from driftproof.numeric.work_precision.integrators import CountedRun, Integrator, integrator
from tests.numeric.problems.runs_on_problems import DECAY

T = Q(10)
RUNGS = (64, 128, 256, 512)
# Multiples of it, as numbers of steps, end at all times at which the oscillator's solution is known.
LANDS = step_counts(HARMONIC)[0]


def test_ladder_lands_on_the_references_times_and_only_on_the_last_where_that_would_cost_too_much() -> None:
    assert step_counts(HARMONIC, 100) == (8, 16, 32, 64)
    times = (Q(1, 997), Q(1))
    awkward = dataclasses.replace(DECAY, reference=Reference(times, (("1",), ("1",)), EXACT, ""))
    assert step_counts(awkward, 64) == (8, 16, 32, 64)
    thirds = dataclasses.replace(DECAY, reference=Reference((Q(1, 3), Q(1)), (("1",), ("1",)), EXACT, ""))
    assert step_counts(thirds, 64) == (9, 18, 36)
    for unit, first in ((64, 64), (65, 8)):
        times = Reference((Q(1, unit), Q(1)), (("1",), ("1",)), EXACT, "")
        found = step_counts(dataclasses.replace(DECAY, reference=times))
        assert (found[0], found[-1]) == (first, 2**20)
    assert set(integrator(METHODS["rk4"], HARMONIC).run(8).states) == set(HARMONIC.reference.times)
    assert set(integrator(METHODS["rk4"], HARMONIC).run(9).states) == {T}


@pytest.mark.parametrize("key", ["forward_euler", "symplectic_euler", "velocity_verlet", "rk4", "nystrom5", "gauss2"])
def test_measured_order_is_the_claimed_one(key: str) -> None:
    curve = curve_of(METHODS[key], HARMONIC, RUNGS)
    assert curve.order is not None
    assert curve.order.least <= curve.order.median <= curve.order.largest
    assert curve.verdict == ""


def test_a_method_with_one_coefficient_wrong_is_flagged() -> None:
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    wrong = dataclasses.replace(rk4, b=(rk4.b[0] + Q(1, 24), rk4.b[1] - Q(1, 24), *rk4.b[2:]))
    assert curve_of(wrong, HARMONIC, RUNGS).verdict == "below the claimed order 4"
    modest = dataclasses.replace(rk4, claimed_order=3)
    assert curve_of(modest, HARMONIC, RUNGS).verdict == "above the claimed order 3"


# Orders of neighbouring points; where one is None, the finer point does not count.
@pytest.mark.parametrize(
    ("orders", "verdict", "slopes"),
    [
        ((2, 0.3, 7.6), "not settled", 3), ((2, 1), "not settled", 2), ((1.5, 2.25), "", 2), ((9, 9, 2, 2, 2), "", 3),
        ((3, 3, 3), "above the claimed order 2", 3), ((3, 3), "not settled", 2), ((2, 2, None), "", 2),
        ((2, None, 7), "", 1), ((None,), "", 0),
        ((2, 2, 0.2, 0.2, 0.1), "not settled", 3), ((2, 2, 1, 1, 1), "below the claimed order 2", 3),
        ((0.2, 0.2, 0.2, 0.2, 0.1), "below the claimed order 2", 3),
    ],
)  # fmt: skip
def test_order_is_of_the_three_finest_slopes_unless_they_lie_a_whole_order_apart(
    orders: tuple[float | None, ...], verdict: str, slopes: int
) -> None:
    points = [_point(8, 1.0)]
    for order in orders:
        finer = _point(2 * (points[-1].steps or 0), points[-1].error * 2.0 ** -(order or 0))
        points.append(finer if order else dataclasses.replace(finer, scale=0.0))
    curve = Curve("a", "A", 2, points)
    assert (curve.verdict, curve.order.slopes if curve.order else 0) == (verdict, slopes)
    why = {(2, 0.3, 7.6): "order or more apart", (3, 3): "only 2 slopes", (2, 2, 0.2, 0.2, 0.1): "and then stays"}
    assert why.get(orders, "") in curve.unsettled
    assert bool(curve.unsettled) == (verdict == "not settled")
    if verdict == "not settled" and slopes == len(orders) - 2:  # the same curve of weights that do not add up to 1
        assert dataclasses.replace(curve, consistent=False).verdict == "below the claimed order 2"
    assert Curve("a", "A", 2, [dataclasses.replace(point, steps=None) for point in points]).order is None


def test_points_as_large_as_the_solution_or_near_the_floor_tell_no_order() -> None:
    assert counts(_point(8, 0.5))
    assert not counts(dataclasses.replace(_point(8, 0.5), scale=0.5))
    assert not counts(dataclasses.replace(_point(8, 0.5), doubt=0.5 / 32))
    assert counts(dataclasses.replace(_point(8, 0.5), scale=0.51, doubt=0.49 / 32))
    assert not counts(Point("8", None, remark="not finite", steps=8))
    assert curve_of(METHODS["rk4"], problem_named("stiff_pair"), [8, 16, 32, 64]).order is None


def _point(steps: int, error: float) -> Point:
    return Point(str(steps), steps, {STATE: Size(error, error)}, steps=steps)


def test_a_splitting_on_a_first_order_problem_is_refused_with_the_reason() -> None:
    refused, runs = (curve_of(METHODS[key], problem_named("dahlquist_1"), [8]) for key in ("velocity_verlet", "rk4"))
    assert "second-order" in refused.refused
    assert not refused.points
    assert runs.points
    assert not runs.refused


def test_a_run_that_overflows_is_a_point_that_says_so() -> None:
    first, *_ = curve_of(METHODS["rk4"], problem_named("dahlquist_1e6"), [64, 128]).points
    assert first.error == inf
    assert "finite" in first.remark or "range" in first.remark


def test_climb_ends_at_the_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    curve = curve_of(METHODS["dop853"], HARMONIC)
    at_floor = [point for point in curve.points if point.error <= point.doubt]
    assert len(at_floor) == FLOOR_POINTS == 3
    assert curve.points[-1] is at_floor[-1]
    on_it = lambda problem, runs, steps: dataclasses.replace(_point(steps, 1.0), doubt=1.0)
    monkeypatch.setattr(curves_module, "measured", on_it)
    assert len(measure_curve(HARMONIC, Integrator({}, {}, {}), RUNGS)) == FLOOR_POINTS


def test_an_implicit_method_climbs_to_1024_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curves_module, "measure_curve", lambda problem, runs, steps, most: steps)
    ends = [curve_of(METHODS[key], HARMONIC).points[-1] for key in ("implicit_midpoint", "rk4")]
    assert ends == [2**10, 2**20]


def test_climb_marks_a_run_of_too_many_evaluations_and_makes_none_after_it() -> None:
    made = []

    def run(steps: int) -> CountedRun:
        made.append(steps)
        return CountedRun({T: (1.0, 0.0)}, 4 * steps)

    found = measure_curve(HARMONIC, Integrator(run, {}, {}), (8, 16, 32), most=64)
    assert [(p.setting, p.evaluations, p.steps) for p in found] == [("8", 32, 8), ("16", 64, 16), ("32", None, 32)]
    assert found[-1].remark == "not run: about 1.3e+02 evaluations, but the limit is 64"
    assert made == [8, 16]
    assert measure_curve(HARMONIC, Integrator(run, {}, {}), (), most=1) == []
    assert [point.remark for point in measure_curve(HARMONIC, Integrator(run, {}, {}), (8,), most=1)] == [""]

    def failing(steps: int) -> CountedRun:
        raise ArithmeticError("not finite")

    ended = measure_curve(HARMONIC, Integrator(failing, {}, {}), (8, 16, 32), most=1)
    assert [(p.setting, p.evaluations, p.remark) for p in ended] == [(n, None, "not finite") for n in ("8", "16", "32")]


@pytest.mark.parametrize(("key", "goal"), [("rk4", 1e-4), ("heun2", 3e-3), ("gauss2", 2e-6)])
def test_the_fewest_steps_for_a_goal_are_found_to_a_sixteenth_and_the_order_is_read_from_doublings(
    key: str, goal: float
) -> None:
    """Beside the errors of all numbers of steps from half of it on, one after another."""
    method, runs = METHODS[key], integrator(METHODS[key], HARMONIC)
    curve = curve_of(method, HARMONIC, [8 << i for i in range(9)])
    points = for_goal(curve, method, HARMONIC, goal)
    for which, unit in (("final", 1), ("largest", LANDS)):
        found = lasting(points, goal, which)[-1]
        assert found.between
        fewer = range((found.steps or 0) * 15 // 16 // unit * unit, found.steps or 0, unit)
        assert any(getattr(measured(HARMONIC, runs, n).errors[STATE], which) > goal for n in fewer)
        assert {(found.steps or 0) + n * unit for n in (0, 1, 2)} <= {point.steps for point in points}
    assert [point.steps for point in points] == sorted(point.steps or 0 for point in points)
    better = dataclasses.replace(curve, points=points)
    assert (better.order, better.verdict) == (curve.order, curve.verdict)
    assert for_goal(better, method, HARMONIC, goal) == points
    assert not method.explicit or for_goal(curve, method, HARMONIC, 1e-30) == list(curve.points)


def test_a_run_that_is_good_because_its_steps_end_at_a_jump_is_not_the_one_of_fewest_steps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An error as forward Euler's where f jumps at a third of the time; every number of steps from 18801 on is right.

    Of doublings and numbers between, 7680 was named, which 3 divides; 7681 and 15361, but not 15362, tell of it.
    """
    made = lambda steps: _point(steps, (1e-3, 0.95, 1.88)[steps % 3] / steps)
    monkeypatch.setattr(curves_module, "measured", lambda problem, runs, steps: made(steps))
    for first in (10, 15, 16):
        curve = Curve("a", "A", 1, [made(first << i) for i in range(14)])
        steps = lasting(for_goal(curve, METHODS["rk4"], HARMONIC, 1e-4), 1e-4)[-1].steps
        assert 18800 <= (steps or 0) <= 18800 * 17 / 16


@pytest.mark.parametrize(("part", "period", "most"), [(Q(2, 5), 5, 1.0), (Q(3, 80), 80, 4.0)])
def test_where_f_changes_at_a_time_a_run_is_named_only_if_it_is_good_for_other_remainders_too(
    part: Q, period: int, most: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The errors of a fifth of the remainders are ten times as large; of a long period some are tried."""
    changes = dataclasses.replace(HARMONIC.reference, changes=(part * HARMONIC.t,))
    problem = dataclasses.replace(HARMONIC, field=field_of_text("y1; -y0 + 0*abs(y1)"), reference=changes)
    made = lambda steps: _point(steps, (10 if 2 * period <= 5 * (steps % period) < 3 * period else 1) / steps)
    monkeypatch.setattr(curves_module, "measured", lambda problem, runs, steps: made(steps))
    curve = Curve("a", "A", 1, [made(16 << i) for i in range(14)])
    steps = lasting(for_goal(curve, METHODS["rk4"], problem, 1e-3), 1e-3)[-1].steps or 0
    assert 10_000 / most <= steps <= 10_000 * 17 / 16


def test_an_implicit_method_goes_on_for_a_goal_where_it_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    method = METHODS["implicit_midpoint"]
    curve = curve_of(method, HARMONIC, [8, 16, 32])
    for fast, most, last in ((True, 128, 128), (True, 64, 64), (False, 128, 32)):
        monkeypatch.setattr(curves_module, "has_numba", lambda fast=fast: fast)
        monkeypatch.setattr(curves_module, "MOST_FOR_GOAL", most)
        points = for_goal(curve, method, HARMONIC, 0.01)
        assert max(point.steps or 0 for point in points if not point.between) == last
        assert bool(lasting(points, 0.01)) is (last == 128)
    monkeypatch.setattr(curves_module, "has_numba", lambda: True)
    for remark, last in (("overflows binary64", 128), ("not run: about 99 evaluations", 32)):
        failed = dataclasses.replace(curve, points=[*curve.points[:2], Point("32", None, remark=remark, steps=32)])
        assert for_goal(failed, method, HARMONIC, 1e-30)[-1].steps == last
