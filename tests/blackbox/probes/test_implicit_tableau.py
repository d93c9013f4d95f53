"""Implicit stages are read, whatever solves them; what is no implicit Runge-Kutta step is refused."""

import random
from functools import partial

import numpy as np
import pytest

from driftproof.blackbox.findings import NoAnswer
from driftproof.blackbox.matching.match import match_method, match_tableau
from driftproof.blackbox.probes.implicit_tableau import read_implicit_tableau
from driftproof.blackbox.probes.marked_stages import MarkedSteps
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.stage_chains import StageChains
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.implicit_steppers import (
    SOLVERS,
    G,
    all_at_once,
    broyden,
    fixed_point,
    newton,
    one_by_one,
    table,
    untimed,
    with_entry,
)
from tests.blackbox.transcripts import Asked
from tests.looping import some
from tests.plain_algebra import solved

# Of few stages and of every family: irrational, with an explicit stage, without an entry in a row, with A singular.
FAMILIES = ("trapezoid", "gauss2", "radau_iia2", "lobatto_iiib2", "lobatto_iiic3", "sdirk2", "tr_bdf2")
FEW_STAGES = (
    *(*FAMILIES, "backward_euler", "implicit_midpoint", "gauss3", "radau_ia2", "radau_ia3", "radau_iia3"),
    *("lobatto_iiia3", "lobatto_iiib3", "lobatto_iiic2", "qin_zhang2", "crouzeix3", "alexander3", "crouzeix4"),
    *("radau_i2", "radau_i3"),
)
MANY_STAGES = (
    *("sdirk4", "esdirk43", "gauss4", "gauss6"),
    *("radau_iia4", "lobatto_iiia5", "lobatto_iiic4", "lobatto_iiib4"),
)
OTHERS = [pytest.param(key, marks=pytest.mark.long) for key in (*FEW_STAGES[len(FAMILIES) :], *MANY_STAGES)]
# Kvaerno's pair of order 3 and 2: two stages at t + h, one for each row of weights.
_G3 = 0.4358665215084589994160194511935568
_PAIR = [
    [0.0, 0.0, 0.0, 0.0], [_G3, _G3, 0.0, 0.0], [0.490563388419108, 0.073570090080892, _G3, 0.0],
    [0.308809969973036, 1.490563388254106, -1.235239879727145, _G3],
]  # fmt: skip
TWO_AT_ONE_TIME = (_PAIR, _PAIR[3], [0.0, 2 * _G3, 1.0, 1.0])
# The trapezoidal rule with f(t, y1): on linear problems the midpoint rule at t.
BOTH_AT_START = (table("trapezoid")[0], [0.5, 0.5], [0.0, 0.0])


def read(step):
    return read_implicit_tableau(opened(step))


def the_same(reading, coefficients, error):
    a, b, c = coefficients
    apart = [np.abs(np.array(x) - np.array(y)).max() for x, y in ((reading.a, a), (reading.b, b), (reading.c, c))]
    return max(apart) <= error


@pytest.mark.slow(keep=6)
@pytest.mark.parametrize("key", [*FAMILIES, *OTHERS])
def test_every_coefficient_of_an_implicit_method_is_read_to_rounding(key):
    reading = read(all_at_once(table(key)))
    # Elimination in a dozen unknowns, then a quotient of two numbers that were read.
    assert the_same(reading, table(key), 8 * 2.0**-53)
    assert key in match_tableau(reading).keys


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
def test_the_coefficients_do_not_depend_on_what_solves_the_stages(solver):
    for way in some((all_at_once, one_by_one)):
        reading = read(way(table("sdirk2"), solver))
        assert the_same(reading, table("sdirk2"), 4 * reading.stage_error)
        assert reading.stage_error < 1e-9
        assert match_tableau(reading).keys[0] == "sdirk2"


def test_the_solver_leaves_what_two_readings_differ_by():
    seen = read(all_at_once(table("gauss2"), lambda residual, x: np.round(newton(residual, x), 9)))
    assert 1e-10 < seen.stage_error < 1e-8
    assert the_same(seen, table("gauss2"), 4 * seen.stage_error)
    (match,) = match_tableau(seen).matches
    assert match.key == "gauss2"
    assert "the accuracy of its stage solver" in match.closeness
    assert not read(all_at_once(table("gauss2"))).rounding.besides > 1e-13


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("solver", [newton, fixed_point, broyden])
def test_stages_at_one_time_are_told_apart_by_a_clock_in_y(solver):
    for way in some((all_at_once, one_by_one)):
        assert the_same(read(way(TWO_AT_ONE_TIME, solver)), TWO_AT_ONE_TIME, 1e-9)
    late = ([[G, 0], [1 - G, G]], [1 - G, G], [0, 0])
    assert the_same(read(one_by_one(late, solver)), late, 1e-9)


@pytest.mark.parametrize("solver", [newton, broyden, partial(newton, most=8, tolerance=0)])
def test_stages_that_only_a_nonlinear_step_tells_apart_are_not_read_as_one(solver):
    assert the_same(read(one_by_one(BOTH_AT_START, solver)), BOTH_AT_START, 1e-9)


def ending_at_a_slope_of_0(key, node, solver=newton):
    """The method, but for a state that stays where the first guess of a stage has the slope 0."""
    step = all_at_once(table(key), solver)
    return lambda f, t, y, h: step(f, t, y, h) if np.any(f(t + node * h, y)) else y


# Where the only stage of a method is asked for, a slope of 0 means that the state stays.
RIGHT_SHORTCUTS = {"backward_euler": 1.0, "implicit_midpoint": 0.5}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("key", ["trapezoid", "gauss2", "radau_iia2", *RIGHT_SHORTCUTS])
def test_a_step_that_ends_where_the_slope_of_one_stage_is_0_is_told(key):
    for node in some(table(key)[2]):
        reading = read(ending_at_a_slope_of_0(key, node))
        assert key in match_tableau(reading).keys
        assert reading.solved.skipped == (key not in RIGHT_SHORTCUTS)
    assert read(ending_at_a_slope_of_0(key, 0.0)).solved.skipped


def to_a_part_of_the_slope(residual, x):
    """Plain iteration, which stops at once where the slope is 0, and stays so."""
    while np.abs(change := residual(x)).max() > 1e-13 * np.abs(x - change).max():
        x = x - change
    return x - change


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("solver", [to_a_part_of_the_slope, newton, broyden])
def test_a_solver_that_stops_by_the_size_of_the_slope_is_not_told_to_skip_stages(solver):
    for key in some(("backward_euler", "trapezoid", "gauss2")):
        assert not read(all_at_once(table(key), solver)).solved.skipped
    assert not read(one_by_one(TWO_AT_ONE_TIME, newton)).solved.skipped


def test_guesses_that_are_no_stages_are_left_out_of_what_the_clocks_show():
    steps = MarkedSteps(opened(one_by_one(BOTH_AT_START)))
    chains = StageChains(steps, steps.marks(1))
    assert len(chains.marks.labels) == 3
    _, (b,), _ = chains.tables()
    assert len(b) == len(chains.marks.labels) == 2


def adaptive(f, t, y, h):
    """Backward Euler, in two halves where the slope is large."""
    step = all_at_once(table("backward_euler"))
    if np.abs(f(t, y)).max() < 0.75:
        return step(f, t, y, h)
    return step(f, t + h / 2, step(f, t, y, h / 2), h / 2)


def bdf2():
    """The second step of BDF2 after whatever step came before."""
    before = {}

    def step(f, t, y, h):
        last = before.get(len(y), y)
        before[len(y)] = np.array(y)
        return newton(lambda x: x - (4 * y - last) / 3 - 2 / 3 * h * f(t + h, x), np.array(y))

    return step


def linearly_implicit(f, t, y, h):
    """A Rosenbrock method of order 2, ROS2 with gamma = 1 + 1/sqrt 2."""
    gamma, y = 1 + 2**-0.5, np.asarray(y)
    jacobian = np.array([(f(t, y + 1e-6 * e) - f(t, y)) * 1e6 for e in np.eye(len(y))]).T
    matrix = np.eye(len(y)) - gamma * h * jacobian
    k1 = solved(matrix, f(t, y))
    k2 = solved(matrix, f(t + h, y + h * k1) - 2 * k1)
    return y + 1.5 * h * k1 + 0.5 * h * k2


def symplectic(f, t, y, h):
    half = len(y) // 2
    v = y[half:] + h * f(t, y)[half:]
    return np.concatenate([y[:half] + h * v, v])


def alone(f, t, y, h):
    """One number only."""
    return newton(lambda x: x - float(np.asarray(y).item()) - h * f(t + h, x), np.array(y))


def of_one_number(coefficients, newtons=False):
    """One number only, until a change is small, by iteration or, of one stage, by Newton's method with differences."""
    a, b, c = coefficients

    def step(f, t, y, h):
        slopes = [f(t, y)] * len(b)
        at = lambda ks: [
            f(t + node * h, y + h * sum(x * k for x, k in zip(row, ks, strict=True)))
            for row, node in zip(a, c, strict=True)
        ]
        for _ in range(200):
            before, slopes = slopes, at(slopes)
            if newtons:
                off, (k,) = 2.0**-20, before
                slopes = [k - (k - slopes[0]) / (1 - (at([k + off])[0] - at([k - off])[0]) / (2 * off))]
            if max(abs(x - k) for x, k in zip(slopes, before, strict=True)) <= 1e-15 * max(map(abs, slopes)):
                break
        return y + h * sum(x * k for x, k in zip(b, slopes, strict=True))

    return step


@pytest.mark.parametrize(
    ("key", "newtons"),
    [("backward_euler", 1), ("trapezoid", 0), ("implicit_midpoint", 1), ("gauss2", 0), ("sdirk2", 0)],
)
def test_implicit_stages_of_one_number_are_read_through_one_that_stands_for_several(key, newtons):
    wrong = with_entry(key, -1, 0, table(key)[0][-1][0] + 1e-6)
    assert [found.key for found in match_tableau(read(of_one_number(table(key), newtons))).matches] == [key]
    assert not match_tableau(read(of_one_number(wrong, newtons))).matches


def late(f, t, y, h):
    """Backward Euler at t + 1/2 for t + h/2."""
    return all_at_once(([[1.0]], [1.0], [0.5 / h]))(f, t, y, h)


def dragged(f, t, y, h):
    return all_at_once(table("implicit_midpoint"))(f, t, y, h) - 0.01 * h * np.asarray(y)


READ = {
    "gauss2": all_at_once(table("gauss2"), fixed_point), "tr_bdf2": one_by_one(table("tr_bdf2"), fixed_point),
    "kept": one_by_one(table("crouzeix3"), SOLVERS["a Jacobian that is kept"]),
    "to a tolerance": one_by_one(table("sdirk2"), partial(fixed_point, tolerance=1e-6)),
    "two at one time": one_by_one(TWO_AT_ONE_TIME), "both at the start": one_by_one(BOTH_AT_START),
    "stopped early": one_by_one(BOTH_AT_START, partial(newton, most=1)),
    "stopped as early, but told apart": all_at_once(table("sdirk2"), partial(newton, most=1)),
    "the midpoint rule twice": all_at_once(([[0.25, 0.25], [0.25, 0.25]], [0.5, 0.5], [0.5, 0.5])),
    "untimed": untimed(all_at_once(table("radau_iia2"))),
    "without a weight": one_by_one(([[0.5, 0.0], [0.25, 0.5]], [0.0, 1.0], [0.5, 0.75])),
    "unused": one_by_one(([[0.5, 0.0], [0.25, 0.5]], [1.0, 0.0], [0.5, 0.75])),
    "too loose": all_at_once(table("trapezoid"), partial(SOLVERS["a Jacobian that is kept"], tolerance=0.01)),
    "nine iterations": all_at_once(table("implicit_midpoint"), partial(fixed_point, most=9, tolerance=0)),
    "only forward": lambda f, t, y, h: 1 / 0 if h < 0 else all_at_once(table("gauss2"))(f, t, y, h),
}  # fmt: skip


READ |= {
    "explicit": codes.rk4, "fixed iterations": codes.midpoint_iterated(3),
    "eight iterations": all_at_once(table("implicit_midpoint"), partial(fixed_point, most=8, tolerance=0)),
    "adaptive": adaptive, "remembers": bdf2(), "linearly implicit": linearly_implicit, "symplectic": symplectic,
    "one number": alone, "another time": late,
    "never near": all_at_once(table("gauss2"), lambda residual, x: newton(residual, x) + 1e-4),
    "drag": dragged,
    "never calls": lambda f, t, y, h: y,
    "no weight": lambda f, t, y, h: y + 0.0 * f(t, y),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", READ)
def test_all_that_is_asked_of_implicit_steps_and_read_is_as_before(name, as_before):
    asked = Asked(READ[name])
    try:
        reading = read(asked.code)
    except NotReadable as refusal:
        as_before(refusal, asked)
        return
    left = reading.stage_error, reading.solved.linear, reading.solved.curved, reading.solved.power
    as_before(reading.a, reading.b, reading.c, reading.remarks, left, asked)


def test_a_call_that_does_not_come_back_is_not_taken_for_a_refusal():
    subject = opened(partial(all_at_once(table("backward_euler"))), "field")

    def hung(call):
        raise NoAnswer(call)

    subject.before = hung
    with pytest.raises(NoAnswer):
        read_implicit_tableau(subject)


def planted(draw):
    """A method, whether it is right, and its step with one entry of A, b or c off by up to a third, or none."""
    key, solver, place = draw.choice(FEW_STAGES), draw.choice([*SOLVERS.values()]), draw.choice(["", "", "a", "b", "c"])
    a, b, c = ([*map(list, x)] if i == 0 else [*x] for i, x in enumerate(table(key)))
    off, i = draw.choice([1, -1]) * 10 ** draw.uniform(-6, -0.5), draw.randrange(len(b))
    rows = {"a": a[i], "b": b, "c": c, "": [0.0] * len(b)}
    rows[place][draw.randrange(len(b))] += off
    lower = not np.triu(a, 1).any()
    way = draw.choice([one_by_one, all_at_once]) if lower else all_at_once
    return key, not place, way((a, b, c), solver)


@pytest.mark.long
def test_of_two_hundred_steps_the_right_ones_match_and_the_wrong_ones_do_not():
    draw, seen = random.Random(1), {True: 0, False: 0}
    for _ in range(200):
        key, right, step = planted(draw)
        assert bool(match_method(read(step), METHODS[key]).matches) == right
        seen[right] += 1
    assert min(seen.values()) > 40
