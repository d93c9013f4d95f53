"""The report on a whole solver: verdict, sections, JSON; in an isolated process, and from the public door."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from unittest.mock import Mock

import numpy as np
import pytest

from driftproof import assert_verified_solver, identify_solver
from driftproof.blackbox.findings import NoAnswer
from driftproof.methods.catalogue import METHODS
from tests.blackbox.solvers.planted_solvers import adaptive, fixed
from tests.blackbox.solvers.test_attempts import EXCHANGED, OF_FEW_LENGTHS, TO_AND_FRO
from tests.blackbox.solvers.test_multistep import PECE, RIGHT, adams_bashforth2, by_number
from tests.blackbox.transcripts import checksum, shortened

SOLVERS = {
    "as planted": adaptive(), "right": adaptive("dormand_prince54", exponent=0.2),
    "of another order": adaptive("cash_karp54", exponent=0.25),
    "stale": adaptive(stale=True, on_nan="silent"),
    "deaf to the error": adaptive(estimate=lambda e: [0.0] * len(e)),
    "of one length": fixed(), "of two steps": fixed(2), "without an answer": lambda *_: 7,
}  # fmt: skip
IN_WORDS = ("as planted", "stale", "of one length", "without an answer")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", SOLVERS)
def test_all_that_is_reported_is_as_before(name, as_before):
    report = identify_solver(SOLVERS[name], isolate=False)
    said = report.text(everything=True).splitlines()[1:]
    as_before(*said[:3], *shortened(said[3:], name in IN_WORDS), checksum(report.json()))


def test_one_that_takes_its_start_and_its_end_apart_is_shown_how_to_be_called():
    apart = lambda f, begin, until, y0: adaptive()(f, (begin, until), y0, 1e-6, 1e-9)
    (line,) = identify_solver(apart, isolate=False).section("What to do").lines
    assert "def wrapped(f, t_span, y0): return solve(f, *t_span, y0)" in line
    wrapped = lambda f, t_span, y0: apart(f, *t_span, y0)
    assert identify_solver(wrapped, isolate=False).section("What to do") is None


def of_pairs(f, x0, y0, x_end, n):
    yield x0, y0
    for i in range(n):
        y0 = y0 + (x_end - x0) / n * f(x0 + i * (x_end - x0) / n, y0)
        yield x0 + (i + 1) * (x_end - x0) / n, y0


@pytest.mark.parametrize("solve", [
    of_pairs,
    lambda f, t0, y0, t1, n: [*of_pairs(f, t0, y0, t1, n)],
    lambda y0, t0, t1, N, rhs: fixed(N, order="euler")(rhs, (t0, t1), y0, 0, 0),
    lambda f, t0, y0, h, n: fixed(n, order="euler")(f, (t0, t0 + n * h), y0, 0, 0),
    lambda f, u0, tspan, p=None, steps=9: fixed(steps, order="euler")(lambda t, u: f(u, p, t), tspan, u0, 0, 0),
], ids=["a generator", "pairs", "two times", "h and n", "as in Julia"])  # fmt: skip
def test_a_solver_is_called_by_the_names_of_its_parameters_and_f_as_it_calls_it(solve):
    assert identify_solver(solve, isolate=False).verdict.startswith("it advances forward_euler, of order 1")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("apart", [1e-8, 0.0])
def test_what_is_not_read_as_a_solver_is_to_be_given_as_a_step(apart):
    """Differences for a Jacobian, as a Rosenbrock method forms them in every step."""
    asking = lambda f: lambda t, y: np.array(f(t, y)) + 0 * np.array(f(t, np.array(y) + apart))
    solve = lambda f, t_span, y0, rtol, atol: adaptive()(asking(f), t_span, y0, rtol, atol)
    advice = identify_solver(solve, isolate=False).section("What to do")
    assert (advice is not None and "as step(f, t, y, h), or" in advice.lines[0]) is (apart > 0)


@pytest.mark.parametrize("times", ["one less", "all"])
def test_the_order_of_steps_that_are_shorter_than_their_times_is_the_one_observed(times):
    """Steps of 1/n of the span, at n times: h is off by a share of its own for each n."""

    def solve(f, t_span, y0, n):
        h, states = (t_span[1] - t_span[0]) / n, [np.array(y0)]
        grid = np.linspace(*t_span, n + (times == "all"))
        for t in grid[:-1]:
            states.append(states[-1] + h * f(t + h / 2, states[-1] + h / 2 * f(t, states[-1])))
        return grid, states

    report = identify_solver(solve, isolate=False)
    if times == "all":
        assert (report.data["steps"]["order"], report.data["faults"]) == (2, [])
        return
    assert report.data["steps"]["order"] == 1
    said = "it advances midpoint2, with the step 15/16 h in place of h in one run; order 1 is observed; "
    assert report.verdict.startswith(said)
    assert "the time that it integrates over and the time that it returns differ" in report.data["faults"][-1]


@pytest.mark.slow
def test_numbers_that_differ_are_shown_to_differ():
    """Slopes in binary32 inside: the step ends 1e-10 beside the one that the stages read make."""
    narrow = lambda f: lambda t, y: np.float32(f(t, y)).astype(float)
    leaks = lambda f, t_span, y0, rtol, atol: adaptive()(narrow(f), t_span, y0, rtol, atol)
    verdict = identify_solver(leaks, isolate=False).verdict
    seen, said = re.search(r"a step ends at (\S+) where the explicit stages read give (\S+):", verdict).groups()
    assert 0 < abs(float(seen) - float(said)) < 1e-8


@pytest.mark.slow
def test_a_run_for_the_step_size_control_that_does_not_end_is_a_fault():
    def solve(f, t_span, y0, rtol, atol):
        while t_span == (0.0, 8.0) and len(y0) == 1:  # that of the bumps
            f(0.0, np.array(y0))
        return adaptive()(f, t_span, y0, rtol, atol)

    (fault,) = identify_solver(solve, isolate=False).data["faults"]
    assert fault.startswith("step size control: does not end: after 30000 calls of f")


@pytest.mark.slow
def test_a_hang_and_a_refusal_are_told():
    def hangs(f, t_span, y0, rtol, atol):
        while True:
            pass

    assert identify_solver(hangs, time_limit=1.0).verdict.startswith("undecided: no answer within")
    assert identify_solver(lambda *_: 7, isolate=False).verdict.startswith("gives no answer: it returns int")
    with pytest.raises(ValueError, match="cannot be imported"):
        identify_solver("no.such:solver")


def before_its_time(f, t_span, y0, rtol, atol):
    """The solver returns the time at which each step begins, so that its steps are not read."""
    times, states, *_ = adaptive()(f, t_span, y0, rtol, atol)
    return [times[0], *times[:-1]], states


def between_its_times(f, t_span, y0, rtol, atol):
    """The solver with a state between each two, which its right-hand side gives."""
    times, states, *_ = adaptive()(f, t_span, y0, rtol, atol)
    pairs = [(t, y, (after - t) / 2) for t, after, y in zip(times, times[1:], states, strict=False)]
    found = [each for t, y, h in pairs for each in ((t, y), (t + h, y + h * f(t + h / 2, y + h / 2 * f(t, y))))]
    return [*(t for t, _ in found), times[-1]], [*(y for _, y in found), states[-1]]


def with_a_rest(f, t_span, y0, rtol, atol):
    """The solver whose sum of steps misses the end of the run for its clock by a rounding."""
    times, states, *_ = adaptive()(f, t_span, y0, rtol, atol)
    if t_span[0] != 0.1 or len(y0) != 2:
        return times, states
    return [*times[:-1], times[-1] - 2.0**-52, times[-1]], [*states, states[-1]]


def with_jacobian(f, df, t_span, y0, n):
    """A solver that needs a Jacobian of f, of as many rows as numbers."""
    return by_number(adams_bashforth2)(lambda t, y: f(t, y) + 0 * (df(t, y) @ y), t_span, y0, n)


def test_a_solver_whose_runs_are_not_seen_is_undecided(monkeypatch):
    slow = Mock(side_effect=NoAnswer("no answer within 1 s"))
    monkeypatch.setattr("driftproof.blackbox.solvers.identify_solver.read_runs", slow)
    report = identify_solver(adaptive(), "bogacki_shampine32", isolate=False)
    assert (report.passed, report.verdict.partition(":")[2]) == (None, " its clock and its tolerances are not seen")


HELD = {
    "right": (adaptive("dormand_prince54", exponent=0.2), "dormand_prince54", True, "is dormand_prince54 in "),
    "another": (adaptive("dormand_prince54", exponent=0.2), "cash_karp54", False, "is not cash_karp54; it advances"),
    "its other row": (
        adaptive("dormand_prince54_embedded", exponent=1 / 6),
        "dormand_prince54",
        False,
        "is not dormand_prince54; it advances",
    ),
    "of a smaller exponent": (adaptive("dormand_prince54", exponent=1 / 6), "dormand_prince54", True, "is dormand_pr"),
    "stale": (adaptive(stale=True), "bogacki_shampine32", False, "is bogacki_shampine32, but "),
    "of a stage": (
        adaptive(carried=-2),
        "bogacki_shampine32",
        False,
        "is not bogacki_shampine32: with five components",
    ),
    "with another estimate": (EXCHANGED, "bogacki_shampine32", False, "is bogacki_shampine32, but it makes "),
    "another row, alone": (EXCHANGED, "ralston3", True, "is ralston3 in "),  # it may have been meant
    "to and fro": (
        TO_AND_FRO,
        "heun_euler21",
        False,
        "is heun_euler21, but where the estimate of heun_euler21 is one of",
    ),
    "of few lengths": (OF_FEW_LENGTHS, "bogacki_shampine32", None, "undecided whether it is bogacki_shampine32 in"),
    "with a rest of a rounding": (with_a_rest, "bogacki_shampine32", True, "is bogacki_shampine32 in"),
    "between": (between_its_times, "bogacki_shampine32", None, "undecided whether it is bogacki_shampine32: its steps"),
    "silent": (adaptive(on_nan="silent"), "bogacki_shampine32", True, "is bogacki_shampine32 in "),
    "of two steps": (by_number(adams_bashforth2), "adams_bashforth2", True, "is adams_bashforth2"),
    "with a Jacobian": (with_jacobian, "adams_bashforth2", True, "is adams_bashforth2"),
    "of three": (by_number(adams_bashforth2), "adams_bashforth3", False, "is not adams_bashforth3; it advances"),
    # Its own solution of the corrector, which is compared with, is singular where f is stiff.
    "corrected": (RIGHT[PECE][0], "abm4", False, "is adams_moulton3, corrected once from"),
    "corrected, of another order": (RIGHT[PECE][0], "abm3", False, "is not adams_moulton2, corrected once from"),
    "late": (before_its_time, "bogacki_shampine32", False, "u' = 1 ends at u"),
    "without an answer": (lambda *_: 7, "rk4", False, "gives no answer"),
}


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("name", HELD)
def test_a_solver_is_held_to_the_method_that_it_should_advance(name):
    solve, method, passed, words = HELD[name]
    report = identify_solver(solve, method, isolate=False)
    assert report.passed is passed, report.verdict
    assert report.verdict.startswith(words)
    assert ("; if that row of the pair is meant: --method dormand_prince54_emb" in report.verdict) == (
        name == "its other row"
    )
    with pytest.raises(ValueError, match="one method is needed"):
        identify_solver(solve, "sdirk_order_2")


def heun(f, t_span, y0, n, bent=0.0):
    h, y = (t_span[1] - t_span[0]) / n, [np.array(y0)]
    t = [t_span[0] + k * h for k in range(n + 1)]
    for each in t[:-1]:
        slope = f(each, y[-1])
        y.append(y[-1] + h / 2 * (slope + f(each + h, y[-1] + h * slope + bent * h**3 * np.sin(slope))))
    return t, y


def test_a_test_of_a_solver_fails_with_the_whole_report_unless_it_passes():
    assert_verified_solver(heun, "heun2", isolate=False)
    with pytest.raises(AssertionError, match="heun\n  is not midpoint2; it advances heun2, of order 2") as failure:
        assert_verified_solver(heun, "midpoint2", isolate=False)
    assert f"\n{identify_solver(heun, 'midpoint2', isolate=False)}".endswith(str(failure.value).partition("\n")[2])
    with pytest.raises(AssertionError, match="undecided whether it is backward_euler: its steps are not read: "):
        assert_verified_solver(unread, "backward_euler", isolate=False)
    assert_verified_solver(unread, "backward_euler", allow_undecided=True, isolate=False)


def unread(f, t_span, y0, n):
    """Steps of order 2 that no linear stages make."""
    return heun(f, t_span, y0, n, bent=1.0)


def own_pair():
    """A pair of no catalogue, whose last stage is the first of the next step."""
    tenths = lambda *row: tuple(Fraction(x, 30) for x in row)
    rows = (tenths(0, 0, 0, 0), tenths(12, 0, 0, 0), (-Fraction(1, 5), Fraction(1), Fraction(0), Fraction(0)))
    last = tuple(Fraction(x, 12) for x in (2, 5, 5, 0))
    known = METHODS["bogacki_shampine32"]
    return replace(known, key="own32", a=(*rows, last), b=last, b_embedded=tenths(7, 10, 10, 3))


def test_the_estimate_of_a_pair_of_ones_own_is_held_to_it():
    pair = own_pair()
    right = identify_solver(adaptive(pair), pair, isolate=False)
    assert right.passed, right.verdict
    assert "r is the estimate of own32 over the tolerance" in right.data["controller"]
    wrong = adaptive(pair, estimate=lambda e: [e[0] + 0.02, *e[1:-1], e[-1] - 0.02])
    found = identify_solver(wrong, pair, isolate=False)
    assert found.passed is False
    assert "where the estimate of own32 is 0" in found.verdict


def one_more(f, t_span, y0, h):
    """Steps that no linear stages make, and one more than there is room for."""
    n = round((t_span[1] - t_span[0]) / h) + 1
    return unread(f, (t_span[0], t_span[0] + n * h), y0, n)


def test_what_runs_show_is_said_of_a_solver_whose_steps_are_not_read():
    report = identify_solver(one_more, isolate=False)
    assert report.verdict.startswith("its steps are not read: ")
    assert "one step too many" in report.verdict
