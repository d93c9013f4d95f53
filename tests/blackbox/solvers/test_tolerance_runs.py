"""What ignores its tolerances, or compares its errors with something else, is told; what only hides them is not."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from driftproof.blackbox.solvers.foreign_solver import ForeignSolver, SolverTarget
from driftproof.blackbox.solvers.identify_solver import identify_solver
from driftproof.blackbox.solvers.runs import read_runs
from driftproof.blackbox.solvers.tolerance_runs import _of_growth
from tests.blackbox.solvers.planted_solvers import Answer, adaptive, refusing


def read(solve):
    return read_runs(ForeignSolver(solve))


def test_a_tolerance_that_is_refused_is_not_said_to_be_ignored():
    assert read(refusing(lambda t_span, y0, rtol: rtol < 1e-9, "too much accuracy")).faults == ()


def capped(floor=0.0):
    """Steps of 1/8 at most, whose errors are far below large tolerances."""
    solve = adaptive(tolerances=lambda rtol, atol: (max(rtol, floor), max(atol, floor)))

    def shortened(f, t_span, y0, rtol, atol):
        parts = np.linspace(*t_span, 2 + int(8 * abs(t_span[1] - t_span[0])))
        times, states = [t_span[0]], [np.array(y0)]
        for part in pairwise(parts):
            run = solve(f, part, states[-1], rtol, atol)
            times += [*run.t[1:]]
            states += [*np.reshape(run.y, (len(run.t), -1))[1:]]
        return Answer(np.array(times), np.array(states), True, "")

    return shortened


@pytest.mark.slow
def test_a_largest_step_that_hides_some_tolerances_is_no_fault():
    assert not [each for each in read(capped()).faults if "10 times smaller" in each]
    assert [each for each in read(capped(floor=1e-4)).faults if "10 times smaller" in each or "is ignored" in each]


def only_first(name):
    """A solver whose first step alone depends on the tolerance of that name."""
    heard = {"rtol": lambda rtol, atol: (0.0, atol), "atol": lambda rtol, atol: (rtol, 1e-12)}[name]

    def solve(f, t_span, y0, rtol, atol):
        first = (rtol if name == "rtol" else atol) ** 0.2 / 100
        return adaptive("dormand_prince54", exponent=0.2, tolerances=heard, first_step=first)(f, t_span, y0, rtol, atol)

    return solve


def of_the_start(f, t_span, y0, rtol, atol):
    """A solver that compares its errors with y at the start, for ever."""
    return adaptive(size=lambda y: abs(np.array(y0)))(f, t_span, y0, rtol, atol)


@pytest.mark.slow
def test_errors_that_are_compared_with_the_start_are_told_though_its_tolerances_take_too_many_calls():
    found = read(of_the_start)
    assert found.seen["Tolerance"][0].startswith("not seen: after 30000 calls of f")
    (fault,) = found.faults
    assert fault.startswith("errors are not compared with atol + rtol |y| alone, as if y were that at the start")
    named = identify_solver(of_the_start, "bogacki_shampine32", isolate=False)
    assert "is bogacki_shampine32, but errors" in named.verdict


@pytest.mark.parametrize(("key", "power"), [("heun_euler21", 2), ("dormand_prince54", 5), ("verner87", 8)])
def test_a_solution_that_grows_takes_no_more_steps_of_a_right_one_and_more_of_a_wrong_one(key, power):
    right = adaptive(key, exponent=1 / power)
    wrong = lambda f, t_span, y0, *given: adaptive(key, exponent=1 / power, size=lambda y: abs(np.array(y0)))(
        f, t_span, y0, *given
    )
    told = [_of_growth(SolverTarget(solve).open()) for solve in (right, wrong)]
    assert [len(faults) for faults in told] == [0, 1]


@pytest.mark.slow
def test_what_is_not_seen_is_remarked_on():
    """A solver of low order, right, which takes too many calls at small tolerances."""
    slow = adaptive("heun_euler21", exponent=1, safety=0.9, per_unit=True)
    report = identify_solver(slow, "heun_euler21", isolate=False)
    assert report.passed
    assert "; remark: tolerance not seen: after 30000 calls" in report.verdict


@pytest.mark.slow
def test_where_a_largest_step_size_makes_the_errors_no_tolerance_is_said_to_be_ignored():
    solve = lambda *given: adaptive(most=1.0, first_step=0.02 * (1 + sum(given[3:])))(*given)
    (fault,) = read(solve).faults  # as steps never grow
    assert fault.startswith("at a jump of f it has not ended")


@pytest.mark.slow
def test_a_largest_step_size_hides_a_tolerance_that_is_not_ignored():
    found = read(adaptive(longest=0.002, first_step=0.002))
    assert found.seen["Tolerance"][4].startswith("q'' = -q to t = 6: a largest step size hides these tolerances")
    assert found.faults == ()
    ignored = read(adaptive(longest=0.002, first_step=0.002, tolerances=lambda rtol, atol: (1e-6, 1e-9)))
    assert "rtol is ignored: the steps are the same at every tolerance" in ignored.faults


def scaled(tolerances):
    return adaptive("dormand_prince54", exponent=0.2, tolerances=tolerances)


def of_what_changes(f, t_span, y0, rtol, atol):
    """Heun's method whose errors are compared with atol + rtol times what y changes in the step."""
    t, y, h = [t_span[0]], [np.array(y0, float)], 1e-3
    while t[-1] < t_span[1]:
        h = min(h, t_span[1] - t[-1])
        k1 = np.array(f(t[-1], y[-1]))
        k2 = np.array(f(t[-1] + h, y[-1] + h * k1))
        new = y[-1] + h / 2 * (k1 + k2)
        r = np.max(abs(h / 2 * (k2 - k1)) / (atol + rtol * abs(new - y[-1]) + 1e-300))
        if r <= 1:
            t.append(t_span[1] if t_span[1] - t[-1] <= h else t[-1] + h)
            y.append(new)
        h *= min(4.0, max(0.25, 0.8 * (r + 1e-300) ** -0.5))
    return t, y


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize(("solve", "fault"), [
    (only_first("rtol"), "rtol is ignored"), (only_first("atol"), "atol is ignored"),
    (scaled(lambda rtol, atol: (atol, rtol)), "rtol and atol are exchanged"),
    (scaled(lambda rtol, atol: (0.0, rtol)), "atol is ignored; rtol is taken as an absolute tolerance"),
    (scaled(lambda rtol, atol: (0.0, max(rtol, atol))), "errors are not compared with atol + rtol |y| alone"),
    (of_what_changes, "errors are not compared with atol + rtol |y| alone"),
    (scaled(lambda rtol, atol: (rtol, atol)), ""), (scaled(lambda rtol, atol: (rtol / 2, atol / 2)), ""),
], ids=range(8))  # fmt: skip
def test_tolerances_that_only_set_the_first_step_and_scales_that_do_not_grow_with_numbers_are_told(solve, fault):
    assert [each.partition(":")[0] for each in read(solve).faults] == fault.split("; ") * bool(fault)
