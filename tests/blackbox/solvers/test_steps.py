"""The pair that a whole solver advances is read from its run, whatever its steps; what has no table says so."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver, SolverTarget
from driftproof.blackbox.solvers.steps import read_steps
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.solvers.planted_solvers import adaptive, fixed, of_scipy, run
from tests.blackbox.transcripts import Asked

PAIRS = ["bogacki_shampine32", "fehlberg45", "dormand_prince54", "dop853"]


def only_the_end(f, t_span, y0, rtol, atol):
    found = fixed(300)(f, t_span, y0, rtol, atol)
    return [found[0][0], found[0][-1]], [found[1][0], found[1][-1]]


def limited(f, t_span, y0, rtol, atol):
    """Small slopes are taken as they are, so that marks are; larger ones are cut."""
    return adaptive()(lambda t, y: np.clip(f(t, y), -0.5, 0.5), t_span, y0, rtol, atol)


def of_slopes(change):
    """Heun's method with twenty steps, its slopes changed."""
    return lambda f, t_span, y0, rtol, atol: fixed(20)(lambda t, y: change(f, t, y), t_span, y0, rtol, atol)


def with_calls_around(f, t_span, y0, rtol, atol):
    f(t_span[0], y0), f(t_span[0] + 1e-3, y0)
    found = fixed(20)(f, t_span, y0, rtol, atol)
    f(t_span[1], y0)
    return found


def implicit(f, t, y, h):
    """Backward Euler by fixed-point iteration until it has converged."""
    y1, old = y, np.inf
    while max(abs(y1 - old)) > 1e-12 * max(abs(y1)):
        old, y1 = y1, y + h * f(t + h, y1)
    return y1


def shu_osher(f, t, y, h):
    """The method ssprk33 as sums of Euler steps, which return y up to rounding where all slopes are 0."""
    u1 = y + h * f(t, y)
    u2 = 3 / 4 * y + 1 / 4 * (u1 + h * f(t + h, u1))
    return 1 / 3 * y + 2 / 3 * (u2 + h * f(t + h / 2, u2))


def twenty(make):
    """Twenty steps of a stepper."""
    return lambda f, t_span, y0, rtol, atol: run(make, f, t_span, y0, 20)


def of_stages(a, b, c):
    return twenty(lambda: codes.tableau(a, b, c))


RK4 = codes.floats(METHODS["rk4"])
TEN_TIMES = [[float(i == j + 1) for j in range(10)] for i in range(10)], [0.0] * 9 + [1.0], [0.0, *[1.0] * 9]
OTHERS = {
    **{key: adaptive(key) for key in (*PAIRS, "fehlberg45_embedded", "dormand_prince54_embedded")},
    "at rest elsewhere": lambda f, t_span, y0, *_: ([*t_span], [y0, y0 + 1.0]),
    "of no calls": lambda f, t_span, y0, *_: ([*np.linspace(*t_span, 5)], [y0] * 5),
    "only the start": lambda f, t_span, y0, *_: ([t_span[0]], [y0]),
    "from elsewhere": lambda f, t_span, y0, *_: ([0.5, *t_span], [y0] * 3),
    "of rk4, without the last stage of a pair": of_stages(*RK4),
    "at the floats before": of_slopes(lambda f, t, y: f(np.nextafter(t, -1.0), y)),
    "at those before these": of_slopes(lambda f, t, y: f(np.nextafter(np.nextafter(t, -1.0), -1.0), y)),
    "no times": lambda f, t_span, y0, *_: ([1.0], [y0]),
    "only the end": only_the_end, "implicit": twenty(lambda: implicit),
    "as sums of Euler steps": twenty(lambda: shu_osher),
    "of a stage beyond the end": of_stages([[0, 0], [1, 0]], [0.5, 0.5], [0, 2]),
    "of stages called a step later": of_stages(*RK4[:2], [1 + x for x in RK4[2]]),
    "with pieces of a dense output": lambda f, t_span, y0, *given: {
        **dict(zip(("t", "y"), fixed(20)(f, t_span, y0, *given), strict=False)), "sol": [np.sin]},
    "iterated": of_stages(*TEN_TIMES), "clipped": limited,
    "limited": of_slopes(lambda f, t, y: np.clip(f(t, y), -1.5, 1.5)),
    "bent": of_slopes(lambda f, t, y: np.asarray(f(t, y)) ** 3),
    "of nobody's weights": of_stages([[0, 0], [0.5, 0]], [0.25, 0.75], [0, 0.5]),
    "in binary32": fixed(20, clock=np.float32), "one step": fixed(1), "Euler": fixed(order="euler"),
    "two steps": fixed(2), "three": fixed(3, order="euler"), "beyond": adaptive("cash_karp54", ending="beyond"),
    "tiny": adaptive(ending="tiny"), "with calls around": with_calls_around,
}  # fmt: skip


@pytest.mark.slow(keep=6)
@pytest.mark.parametrize("name", OTHERS)
def test_a_step_is_named_or_what_was_seen_instead(name, as_before):
    asked = Asked(OTHERS[name])
    try:
        found = read_steps(ForeignSolver(asked.code))
        said = [found.name, *found.lines, found.reading, found.nodes, [pair.key for pair in found.pairs]]
        assert name not in METHODS or found.order.order == METHODS[name].claimed_order
    except NotReadable as refusal:
        said = [str(refusal)]
    as_before(*said, asked)


@pytest.mark.parametrize(("method", "name", "extension", "order"), [
    ("RK23", "bogacki_shampine32", "hermite", 3), ("RK45", "dormand_prince54", "shampine", 4),
    ("DOP853", "dop853", "dense", 7),
])  # fmt: skip
def test_scipy_advances_and_interpolates_what_it_says(method, name, extension, order):
    found = read_steps(SolverTarget(of_scipy(method, dense_output=True)).open())
    seen = found.name, found.dense.extension, found.dense.order, found.dense.faults
    assert seen == (name, f"{name}_{extension}", order, ())


def test_a_dense_output_of_straight_lines_is_a_fault():
    def solve(f, t_span, y0, rtol, atol):
        t, y, *_ = adaptive()(f, t_span, y0, rtol, atol)
        return t, y, lambda at: np.array([np.interp(at, t, column) for column in np.array(y).T])

    assert "the dense output has order 1 only, the steps have order 3" in read_steps(ForeignSolver(solve)).dense.faults


def searched(where):
    """The cubic through the ends of each step, of which `where(times, t)` is the number."""

    def solve(f, t_span, y0, rtol, atol):
        kept = {}  # by time, of which the last stage of each step is the last
        keeping = lambda t, y: kept.update({float(t): np.array(f(t, y))}) or kept[float(t)]
        times, states, *_ = adaptive()(keeping, t_span, y0, rtol, atol)
        slopes = [kept[t] for t in times]

        def dense(t):
            n = min(max(where(times, t), 0), len(times) - 2)
            (u, v), (k, m), h = states[n : n + 2], slopes[n : n + 2], times[n + 1] - times[n]
            x = (t - times[n]) / h
            return (1 - x) * u + x * v + x * (x - 1) * ((1 - 2 * x) * (v - u) + h * ((x - 1) * k + x * m))

        return times, states, dense

    return solve


# In falling times, as in rising ones; wrongly, the steps are counted from the other end or none is found.
@pytest.mark.parametrize(("where", "fault"), [
    (lambda times, t: np.sum((times - t) * (times[-1] - times[0]) <= 0) - 1, []),
    (lambda times, t: np.sum(times <= t) - 1, ["backward in time, the dense output differs from the one read"]),
    (lambda times, t: np.flatnonzero((times[:-1] <= t) & (t <= times[1:]))[0],
        ["backward in time, the dense output at t = 1.4995 raises IndexError"]),
])  # fmt: skip
def test_a_dense_output_that_looks_for_its_step_forward_in_time_alone_is_at_fault(where, fault):
    found = read_steps(ForeignSolver(searched(where)))
    assert (found.dense.extension, found.dense.faults) == ("bogacki_shampine32_hermite", ())
    assert [each.partition(":")[0] for each in found.faults] == fault


@pytest.mark.slow
def test_steps_that_become_too_small_for_a_run_are_read_all_the_same():
    slow = adaptive("dormand_prince54", exponent=0.2, estimate=lambda e: [*e[:-1], -e[-1]])
    found = read_steps(ForeignSolver(slow))
    assert (found.name, found.faults) == ("dormand_prince54", ())


def spoiled(when):
    """A solver that is right but for its slopes where `when(t, y, backward)`."""

    def solve(f, t_span, y0, rtol, atol):
        back = t_span[1] < t_span[0]
        slopes = lambda t, y: np.array(f(t, y)) * (1 + 1e-4 * when(t, np.array(y), back))
        return adaptive("dormand_prince54")(slopes, t_span, y0, rtol, atol)

    return solve


ELSEWHERE = {
    "backward": lambda t, y, back: back, "late": lambda t, y, back: t > 20, "before 0": lambda t, y, back: t < -5,
    "of five": lambda t, y, back: len(y) > 4, "never": lambda t, y, back: 0,
    "of five not at all": lambda t, y, back: back // (len(y) < 5),
}  # fmt: skip


@pytest.mark.parametrize("when", ELSEWHERE.values(), ids=ELSEWHERE)
def test_steps_that_are_others_elsewhere_are_at_fault(when, as_before):
    found = read_steps(ForeignSolver(spoiled(when)))
    assert found.name == "dormand_prince54"
    as_before(*found.faults)


def test_a_coefficient_is_shown_as_the_fraction_that_four_roundings_make_of_it():
    shown = read_steps(ForeignSolver(fixed(20)))._shown
    # In units of 2**-54, half a spacing and four roundings of 1 are 8.5, and 1/3 is 0.33 above its float.
    assert [shown(1 / 3 + k * 2.0**-54) == "1/3" for k in (-9, -8, 8, 9)] == [False, True, True, False]


# Of one number, by that of the number and of h times its three weights, 1, 1/2 and 1/2.
@pytest.mark.parametrize(
    ("share", "of_one", "faults"),
    [(0.95, 0.95, []), (1.05, 0.95, ["with five components"]), (0.95, 1.05, ["on a nonlinear"])],
)
def test_a_step_may_be_off_by_what_rounding_explains_of_slopes_16_times_the_numbers(share, of_one, faults):
    def solve(f, t_span, y0, rtol, atol):
        times, states = fixed(20)(f, t_span, y0, rtol, atol)
        if len(y0) > 4:
            more = np.array([off * (1 + times[8]) * max(1.0, abs(states[9][0])), 0, 0, 0, 0])
            states[9:] = [y + more for y in states[9:]]
        elif y0[0] == 0.25:
            more = of_one * rounding.of(abs(states[8][0]) + 2 * (times[9] - times[8]))
            states[9:] = [y + more for y in states[9:]]
        return times, states

    rounding = read_steps(ForeignSolver(fixed(20))).reading.rounding
    off = share * 64 * rounding.of(1.0)
    try:
        found = read_steps(ForeignSolver(solve)).faults
    except NotReadable as refusal:
        found = [str(refusal)]
    assert [fault[: len(said)] for fault, said in zip(found, faults, strict=True)] == faults
