"""The controller alone, over attempts that say what their error is: repeated, lengthened, kept, and given up."""

from __future__ import annotations

from itertools import pairwise
from math import inf, sqrt

import pytest

from driftproof.numeric.steps.loops import FieldWriters
from driftproof.numeric.steps.step_control import (
    DONE,
    EVALUATIONS,
    GIVEN_UP,
    REJECTED,
    STATE,
    STEPS,
    TOO_SHORT,
    StepControl,
    Tolerances,
    controlled_steps,
    error_size,
)

HUNDREDTH = Tolerances(0.0, 1e-2, 2.0)


def run_of(error, end=1.0, given=HUNDREDTH, slope=lambda t, y: 1.0, start=0.0):
    """The attempts (t, h, moved) of a run of y' = f whose step from t by h has the error that is told; the report."""
    seen, report, y = [], [0.0] * 5, [start]

    def attempt(writers, t, y, h, moved, new, control):
        seen.append((t, h, moved))
        report[0] += 1
        new[0] = y[0] + h
        return error(t, h)

    def rate(t, y, f):
        f[0] = slope(t, y[0])

    controlled_steps(FieldWriters(rate, None), attempt, y, end, StepControl(given, None, None, report))
    assert report[STATE] != DONE or y[0] == pytest.approx(start + end, rel=1e-15)
    assert report[STEPS] + report[REJECTED] == len(seen) == report[EVALUATIONS] - 2
    return seen, report


def test_a_step_is_repeated_shorter_until_its_error_is_right_and_the_last_ends_at_the_end():
    seen, report = run_of(lambda t, h: (h / 0.3) ** 2)
    assert (report[STATE], seen[0][2]) == (DONE, True)
    for (t, h, _), (after, _, moved) in pairwise(seen):
        assert moved == (h <= 0.3)
        assert after == (t + h if moved else t)
    assert seen[-1][0] + seen[-1][1] == 1.0
    assert max(h for t, h, _ in seen if t > 0) == pytest.approx(0.27, rel=1e-14)  # SAFETY of what is right


def test_steps_change_by_no_more_than_the_limits_and_small_changes_may_be_kept():
    sizes = [h for _, h, _ in run_of(lambda t, h: 0.0)[0]]
    assert sizes[1] == 5 * sizes[0]
    wrong, report = run_of(lambda t, h: inf)
    assert wrong[1][1] == 0.2 * wrong[0][1]
    assert (report[STATE], report[STEPS], wrong[-1][1] > 1e-30) == (TOO_SHORT, 0, True)
    kept = [h for _, h, _ in run_of(lambda t, h: 0.7, given=Tolerances(0.0, 1e-2, 2.0, steady=1.2))[0]]
    assert len(set(kept[:-1])) == 1  # 0.9/sqrt(0.7) = 1.08
    other = [h for _, h, _ in run_of(lambda t, h: 0.7)[0]]
    assert other[1] == pytest.approx(1.0757 * other[0], rel=1e-4)


# With |y|/0.01, |f|/0.01 and (f(y + h0 f) - f)/(0.01 h0), h0 = 0.01 |y|/|f|, or 1e-6 where that tells nothing.
FIRST = [
    (1.0, lambda t, y: y * y, 1.0, sqrt(0.01 / 201)),  # h0 = 0.01: 100, 100 and 201
    (1.0, lambda t, y: -3 * y, 1.0, sqrt(0.01 / 900)),
    (1.0, lambda t, y: y * y, 0.005, 0.005),
    (2.0, lambda t, y: 0.001, 40.0, sqrt(0.1)),  # h0 = 20: 200, 0.1 and 0
    (0.0, lambda t, y: 1 + y, 1.0, 1e-4),  # 100 h0
    (0.0, lambda t, y: 0.0, 1.0, 1e-4),
    (1.0, lambda t, y: 0.0, 1.0, 1e-4),
    (1.0, lambda t, y: 1 + 3 * t, 1.0, sqrt(0.01 / 300)),
    (1e-3, lambda t, y: 1.0, 1.0, 1e-3),  # h0 = 1e-5, and the error would allow 0.01
    (1.0, lambda t, y: inf, 1.0, 1e-4),
]


@pytest.mark.parametrize(("start", "slope", "end", "first"), FIRST, ids=range(len(FIRST)))
def test_the_first_step_is_that_of_hairer_norsett_and_wanner(start, slope, end, first):
    """II.4, with h^2 for the error: 0.01 = h^2 max(|f|, |f'|)."""
    assert run_of(lambda t, h: 0.5, end, slope=slope, start=start)[0][0][1] == pytest.approx(first, rel=1e-9, abs=0)


def test_a_run_is_given_up_after_so_many_evaluations_and_where_no_step_is_right():
    assert run_of(lambda t, h: (h / 0.01) ** 2, given=Tolerances(0.0, 1e-2, 2.0, most=30))[1][STATE] == GIVEN_UP
    assert run_of(lambda t, h: 0.0 if t < 0.1 else inf)[1][STATE] == TOO_SHORT
    made = run_of(lambda t, h: 0.0)[1][EVALUATIONS]
    for most, state in ((made - 1, DONE), (made - 2, GIVEN_UP)):  # the last step ends the run, whatever it took
        assert run_of(lambda t, h: 0.0, given=Tolerances(0.0, 1e-2, 2.0, most=most))[1][STATE] == state


def test_the_size_of_an_error_is_its_largest_part_of_what_is_right():
    given = Tolerances(0.5, 1.0, 1.0)
    assert error_size([3.0, -4.0], [2.0, 0.0], [-4.0, 2.0], given) == 2.0
    for y in ([0.0], [0.0, 1.0]):
        assert error_size([0.0] * len(y), y, y, Tolerances(1.0, 0.0, 1.0)) == 0
    assert error_size([1e-300], [0.0], [0.0], Tolerances(1.0, 0.0, 1.0)) == inf
    assert error_size([0.0], [0.0], [inf], given) == error_size([float("nan")], [0.0], [0.0], given) == inf
