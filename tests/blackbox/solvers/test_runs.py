"""Each question of the runs has a solver that it catches; the right solver is at fault in none."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest

from driftproof.blackbox.findings import NoAnswer
from driftproof.blackbox.solvers import runs
from driftproof.blackbox.solvers.foreign_solver import LENGTH, ForeignSolver
from driftproof.blackbox.solvers.identify_solver import identify_solver
from driftproof.blackbox.solvers.runs import read_runs
from tests.blackbox.solvers.planted_solvers import Answer, adaptive, fixed, in_steps_of_h, of_scipy, refusing
from tests.blackbox.transcripts import Asked
from tests.looping import some


def read(solve):
    return read_runs(ForeignSolver(solve))


def of_the_first_number(f, t_span, y0, rtol, atol):
    """A solver that looks at the error of y[0] alone."""
    weights = np.array([1.0, *[1e9] * (len(y0) - 1)])
    return adaptive(tolerances=lambda rtol, atol: (rtol, atol * weights))(f, t_span, y0, rtol, atol)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("method", ["Radau", "BDF", "LSODA"])
def test_what_solves_for_its_steps_is_told_from_what_does_not(method):
    solve = of_scipy(method)
    found = read(solve)
    assert found.seen["Stiffness"][1].startswith("it solves equations for its steps")
    assert "differences of f in y" in found.seen["Stiffness"][2]
    assert "it solves equations for its steps" in identify_solver(solve, isolate=False).verdict


def test_the_stages_of_an_explicit_pair_at_the_end_of_its_step_are_no_differences_for_a_jacobian():
    found = read(lambda f, t_span, y0, rtol, atol: of_scipy("RK45")(f, t_span, y0, 1e-6, 1e-9))
    assert [line.split(" its longest")[0] for line in found.seen["Stiffness"]] == ["on y' = -1000 (y - cos t) - sin t"]


@pytest.mark.slow
def test_an_error_per_unit_of_time_that_takes_many_steps_is_not_said_never_to_end():
    found = read(adaptive("heun_euler21", exponent=1, safety=0.9, per_unit=True))
    assert found.seen["Clock"][0].startswith("not seen: after 30000 calls")
    assert found.faults == ()


def refuses_backward(f, t_span, y0, rtol, atol):
    if t_span[1] < t_span[0]:
        raise ValueError("the end lies before the start")
    return adaptive()(f, t_span, y0, rtol, atol)


def test_a_solver_that_ends_early_and_says_so_is_not_said_to_be_silent():
    found = read(refusing(lambda t_span, y0, rtol: t_span[1] < t_span[0], "only forward"))
    assert found.seen["Backward"] == ("backward in time it ends at t = 1 and reports: only forward",)
    assert found.faults == ()


def before_the_end(f, t_span, y0, h):
    """A loop that leaves out the end, and backward makes no step at all."""
    (t, end), y, times, states = t_span, np.array(y0), [], []
    while t < end:
        times.append(t)
        states.append(y)
        y, t = y + h * f(t, y), t + h
    return times, states


def test_a_solver_that_returns_nothing_backward_keeps_its_other_faults():
    found = identify_solver(before_the_end, isolate=False).data
    assert any("one step too few" in each for each in found["faults"])
    assert found["runs"]["Backward"][0].startswith("backward in time it gives no answer")


def test_an_instrument_that_fails_is_a_fault_of_the_report(monkeypatch):
    monkeypatch.setitem(runs._QUESTIONS, "Clock", lambda subject: ()[0])
    assert "not measured: IndexError" in identify_solver(adaptive(), isolate=False).data["faults"][-1]


ENDINGS = {  # what is said of 5.4 steps of h, and the fault
    "cut": ("5 steps of h, then one of 0.4 h", ""), "divided anew": ("6 equal steps of 0.9 h", ""),
    "refused": ("", ""),
    "relabelled": ("5 steps of h, then one of 0.4 h", "the time that it integrates over and the time that it returns"),
    "stretched": ("5 equal steps of 1.08 h", "the time that it integrates over and the time that it returns"),
    "beyond": ("6 steps of h", "one step too many, or a last one that is not shortened: it ends 0.188889 beyond"),
    "truncated": ("5 steps of h", "one step too few: it ends 0.125926 before the end"),
    "deaf": ("100 equal steps of 0.054 h", "it makes 100 equal steps"),
    "cut late": ("5 steps of h, then one of 0.4 h", "the last step is not of its method"),
    "cut, with memory": ("5 steps of h, then one of 0.4 h", "the last step is not of its method"),
}  # fmt: skip


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_step_size_that_does_not_divide_the_span_shows_what_becomes_of_the_last_step(ending):
    seen, fault = ENDINGS[ending]
    found = read_runs(ForeignSolver(in_steps_of_h(ending), takes=LENGTH, names=("h",)))
    words = "with h = 0.314815 from 0.1 to 1.8"
    assert found.seen["Clock"][1].startswith(
        f"{words} it makes {seen}" if seen else f"{words} it gives no answer: raises"
    )
    assert [each.startswith(f"{words}, {fault}") for each in found.faults] == [True] * bool(fault)


def test_a_step_size_of_which_three_round_below_the_span_loses_none():
    """0.3 / 0.1 is less than 3."""
    solve = lambda f, t_span, y0, h: in_steps_of_h("truncated" if t_span[0] == 0 else "cut")(f, t_span, y0, h)
    (fault,) = read_runs(ForeignSolver(solve, takes=LENGTH, names=("h",))).faults
    assert fault == "with h = 0.1 from 0 to 0.3, one step too few: it ends 0.1 before the end"


def raises_at_nan(f, t_span, y0, rtol, atol):
    def checked(t, y):
        slopes = f(t, y)
        if not np.all(np.isfinite(slopes)):
            raise FloatingPointError("not finite")
        return slopes

    return adaptive()(checked, t_span, y0, rtol, atol)


def gives_up_at_a_jump(f, t_span, y0, rtol, atol):
    times, states, *_ = adaptive()(f, t_span, y0, rtol, atol)
    ok = len(times) < 40
    return {"t": times, "y": states, "success": ok, "message": "too many steps" * (not ok)}


def spoiled(change):
    """Heun's method in 20 steps, whose times and states are changed."""
    return lambda f, t_span, y0, rtol, atol: change(*fixed(20)(f, t_span, y0, rtol, atol))


def always_raises(f, t_span, y0, rtol, atol):
    raise RuntimeError("no")


OTHERS = {
    "one error": of_the_first_number, "the least error": adaptive(norm=np.min),
    "another start": lambda f, t_span, y0, rtol, atol: adaptive()(f, t_span, np.float32(y0), rtol, atol),
    "u' = 1": adaptive(estimate=lambda e: [*e[:-1], 0.0]),
    "binary32": fixed(clock=np.float32), "one too many": fixed(extra=1), "one too few": fixed(extra=-1),
    "not cut": adaptive(ending="beyond"), "a tiny one": adaptive(ending="tiny"),
    "another clock": adaptive(stepped=lambda h: h * (1 + 1e-6)),
    "silent at NaN": adaptive(on_nan="silent"), "endless at NaN": adaptive(on_nan="retry"),
    "over a jump": adaptive(estimate=lambda e: [0.0] * 4),
    "deaf": adaptive(tolerances=lambda rtol, atol: (1e-5, 1e-8)),
    "deaf to the other": adaptive(tolerances=lambda rtol, atol: (rtol, 1e-9)),
    "of other units": adaptive(tolerances=lambda rtol, atol: (1e6 * rtol, 1e6 * atol)),
    "hard of hearing": adaptive(tolerances=lambda rtol, atol: (1e-4 + rtol / 1e3, 1e-7)),
    **{each.__name__: each for each in (refuses_backward, raises_at_nan, gives_up_at_a_jump)},
    "not_sorted": spoiled(lambda t, y: ([*t[:5], t[4], *t[5:]], [*y[:5], y[4], *y[5:]])),
    "nan_at_the_end": spoiled(lambda t, y: (t, [*y[:-1], y[-1] * float("nan")])),
    "one array": spoiled(lambda t, y: (t, [y[0], *[y[-1]] * (len(y) - 1)])),
    "loses_a_state": spoiled(lambda t, y: (t, y[1:])), "always_raises": always_raises,
    "slow": lambda f, *given: fixed(40_000)(f, *given),
    "Euler": fixed(50, order="euler"), "few steps": fixed(3),
    "binary32 and one too many": fixed(60, extra=1, clock=np.float32),
    "coarse": adaptive(tolerances=lambda rtol, atol: (max(rtol, 1e-3), atol)),
    "gives up": refusing(lambda t_span, y0, rtol: len(y0) == 2 and y0[0] not in (0.0, 1.0), "no step is small enough"),
    "deaf to its error": adaptive(growth_at_zero=4.0, estimate=lambda e: [0.0] * 4),  # and no implicit one
    "dormand_prince54": adaptive("dormand_prince54", exponent=0.2),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", OTHERS)
def test_all_that_runs_show_is_what_it_was(name, as_before):
    asked = Asked(OTHERS[name])
    found = read(asked.code)
    as_before(*found.seen.items(), *found.faults, asked)


def changed(start, change):
    """Heun's method in 100 steps; where the state begins so, its times and states are changed."""

    def solve(f, t_span, y0, rtol, atol):
        found = fixed()(f, t_span, y0, rtol, atol)
        return change(f, rtol, *found) if tuple(y0) == start else found

    return solve


def ending(shift=0.0, by=0.0):
    """The last time and the last state are off by so much."""
    return lambda f, rtol, t, y: ([*t[:-1], t[-1] + shift], [*y[:-1], y[-1] + by])


def ending_at(time):
    return lambda f, rtol, t, y: ([*t[:-1], time], y)


def erring(first, last, at=1e-5):
    """The solution of q'' = -q at t = 6 but for an error that goes from the first to the last with the tolerance."""
    end = cos(6.0), -sin(6.0)
    return lambda f, rtol, t, y: ([0.0, rtol, 6.0], [y[0], y[0], (end[0] + (first if rtol > at else last), end[1])])


def following(steps, off=0.0):
    """The solution cos t, in so many steps, and off at the end."""
    times = np.linspace(0.1, 1.8, steps + 1)
    return lambda f, rtol, t, y: (times, [[cos(t) + off * (t > 1.7)] for t in times])


def asking_beyond(by):
    return lambda f, rtol, t, y: (f(1.8 + by, y[-1]), ending_at(1.8)(f, rtol, t, y))[1]


def in_hundredths(f, rtol, t, y):
    times = [0.1]
    while times[-1] < 1.8:
        times.append(times[-1] + 0.01)
    return times, [[t - 0.1, 0.0] for t in times]


def fewer(by):
    """So many steps are left out if the second number has the bump."""
    return lambda f, rtol, t, y: (t[:50] + t[50 + by :], y[:50] + y[50 + by :]) if y[-1][1] > 0 else (t, y)


def asking_at(time):
    """What f is at that time, and at 1, is the end."""
    return lambda f, rtol, t, y: (t, [*y[:-1], f(time, np.ones(1))])


def asking_near(*pairs):
    """Pairs of questions, at a time and so much later, at 1 and so much more; and the solution in long steps."""

    def change(f, rtol, t, y):
        for n, (later, more) in enumerate(pairs):
            f(n / 8, np.ones(1)), f(n / 8 + later, np.ones(1) + more)
        return following(15)(f, rtol, t, y)

    return change


def hanging(f, rtol, t, y):
    raise NoAnswer("no time")


def endless(f, rtol, t, y):
    while True:
        f(t[0], y[0])


def complaining(f, rtol, t, y):
    return Answer(np.array(t), np.array(y), False, "too steep")


CONSTANT, CLOCK, BACKWARD, STIFF, CIRCLE, JUMP = (1 / 3,), (0.0, 0.0), (1.0,), (cos(0.1),), (1.0, 0.0), (0.0,)
NUMBERS = (0.0,) * 5
LITTLE_BOUGHT = "a tolerance 1000 times smaller"
# Of a step of 0.017 the last one is cut, or one too many, or something else; a clock of 24 bits is no error.
SAID = [
    (CONSTANT, ending(by=4e-4), "u' = 0 ends at u = 0.333733333 instead of 0.333333333"),
    (CLOCK, ending_at(1.817), "one step too many, or a last one that is not shortened"),
    (CLOCK, ending_at(1.802), "the last step ends 0.002 from the end"),
    (CLOCK, ending_at(1.794), "one step too few: it ends 0.006 before"),
    (CLOCK, ending_at(1.798), "the last step ends -0.002 from the end"),
    (CLOCK, ending_at(1.79), "the last step ends -0.01 from the end"),
    (CLOCK, ending_at(1.8 + 2.0**-44), "the last step ends 5.68434e-14 from the end"),
    (CLOCK, ending_at(1.8 + 2.0**-45), "rounding errors of 100 steps"),
    (CLOCK, ending(by=1.8e-13), "differ by 1.8"),  # the bound is 4 u 200 calls of numbers up to 1.8
    (CLOCK, asking_beyond(2e-15), "f is called up to 2e-15 beyond the end"),
    (CLOCK, in_hundredths, "time is accumulated, t += h in binary64"),
    (CLOCK, lambda f, rtol, t, y: ([*t, 1.817, 1.834], [*y, y[-1], y[-1]]), "the last step ends 0.034 from the end"),
    (CLOCK, lambda f, rtol, t, y: (t[:1], y[:1]), "where y' = 1 it makes no step"),
    (CLOCK, lambda f, rtol, t, y: (t[::99], y[::99]), "the last step ends -0.017 from the end"),
    (CLOCK, hanging, "not seen: no time"),
    (NUMBERS, fewer(2), "with a bump in y[1] it takes 98 steps, with one in y[0] 100"),
    (CLOCK, endless, "clock: does not end: after 30000 calls of f it is at t = 0.1 of"),
    (JUMP, endless, "at a jump of f it has not ended: after 30000 calls"),
    (JUMP, complaining, "it reports: too steep"),
    (STIFF, endless, "on y' = -1000 (y - cos t) - sin t it has not ended: after 30000 calls"),
    (BACKWARD, ending(by=0.05), "it integrates backward in time"),
    (BACKWARD, ending(by=0.2), "backward in time, from 1 to 0, it ends at t = "),
    (BACKWARD, ending(shift=1e-3), "without saying so"),
    (CIRCLE, erring(1e-3, 1.1e-4), LITTLE_BOUGHT),
    (CIRCLE, erring(1.1e-6, 1.1e-6), LITTLE_BOUGHT),  # more than the smallest tolerance
    (CIRCLE, erring(1e-3, 0.0, 5e-4), "at rtol = 0.0001: error 0, 0 times rtol"),
    (CIRCLE, erring(1e-3, 0.0), "errors fall like rtol^0.00"),
    (CIRCLE, erring(1e-3, 5e-5), "at rtol = 1e-06: error 5e-05, 50 times rtol"),
    (STIFF, following(15), "it solves equations for its steps"),
    (STIFF, following(15, off=0.05), "it solves equations for its steps"),
    (STIFF, asking_near((0, 2e-7), (0, 0.0), (0, 3e-7), (0, 2e-7), (0.01, 2e-7)), "of f in y, 2 times"),
]
NOT_SAID = [
    (CONSTANT, ending(by=3e-4), "u' = 0 ends at"), (CLOCK, ending_at(1.8 - 1e-15), "f is called up to"),
    (CLOCK, asking_beyond(1.2e-15), "f is called up to"), (CLOCK, ending(by=1.4e-13), "that it returns differ"),
    (BACKWARD, ending(shift=1e-4, by=0.05), "backward in time, from"),
    (CIRCLE, erring(1e-3, 0.9e-4), LITTLE_BOUGHT), (CIRCLE, erring(0.9e-6, 0.9e-6), LITTLE_BOUGHT),
    (CLOCK, lambda f, rtol, t, y: ([*t, t[-1]], [*y, y[-1]]), "one step too many"),
    (NUMBERS, fewer(1), "does not treat all components alike"),
    (BACKWARD, asking_at((0.1 + (0.1 + 1.7)) / 2), "where f becomes NaN it returns NaN"),
    (JUMP, asking_at(2.0 / 3.0), "off by 0.13"),
    (STIFF, asking_near((0, 2e-7)), "it forms differences"),
    (STIFF, following(19), "it solves equations for its steps"),
    (STIFF, lambda f, rtol, t, y: (t[:1], y[:1]), "it solves equations for its steps"),
    (STIFF, following(15, off=0.2), "it solves equations for its steps"),
]  # fmt: skip


def test_a_step_that_is_never_shorter_is_told_where_it_costs_more_than_the_tolerance():
    (fault,) = read(adaptive(shortest=2e-5)).faults
    assert fault.startswith("across a jump of f the shortest step that it takes, of 2e-05, is off by 2.")
    assert not read(adaptive(shortest=1e-9)).faults


@pytest.mark.parametrize("jumps", [False, True])
def test_a_run_that_ends_early_has_no_error_and_one_that_raises_at_a_jump_says_so(jumps):
    """Where it is not told that it ends early, the start has the error 0."""

    def solve(f, t_span, y0, rtol, atol):
        found = adaptive()(f, t_span, y0, rtol, atol)
        if jumps and len(y0) == 1 and f(0.1, y0)[0] == 0 and f(1.8, y0)[0] == 1:
            raise ArithmeticError("the step size is too small")
        stops = not jumps and t_span == (0.0, 6.0) and rtol == 1e-5
        return (found.t[:2], found.y[:2]) if stops else found

    found = read(solve)
    assert ("at a jump of f it reports that: raises" in found.seen["A jump"]) is jumps
    told = ["on q'' = -q it ends at t = 0.001 of (0.0, 6.0), without saying so"]
    assert [*found.faults] == told * (not jumps)


def test_a_scale_of_errors_from_numbers_with_their_signs_is_told():
    squared = lambda errors: np.mean(errors**2) ** 0.5
    faults = read(adaptive("dormand_prince54", exponent=0.2, size=lambda y: y, norm=squared)).faults
    assert [fault.partition(":")[0] for fault in faults] == ["the step sizes depend on the signs of the numbers"]


@pytest.mark.parametrize(("norm", "told"), [
    (np.min, "an error counts only if other components have errors as well: with a bump in one of 5"),
    (lambda errors: errors[-1], "the error norm does not treat all components alike: with a bump in y[4]"),
])  # fmt: skip
def test_an_error_norm_that_is_0_where_some_numbers_have_none_is_told(norm, told):
    (fault,) = read(adaptive("dormand_prince54", exponent=0.2, norm=norm)).faults
    assert fault.startswith(told)


@pytest.mark.parametrize("cancel", [True, False])
@pytest.mark.slow
def test_errors_that_cancel_and_runs_that_remember_others_are_told(cancel):
    made = []

    def solve(f, t_span, y0, rtol, atol):
        made.append(1)
        slope = abs(sum(f(1.0, np.array(y0))))
        steps = 10 + (int(90 * slope) if cancel else len(made) % 7)
        times = np.linspace(*t_span, steps + 1)
        return times, np.array([y0] * len(times))

    words = "errors of opposite signs cancel in its error norm" if cancel else "the same run, made again after others"
    assert any(words in fault for fault in read(solve).faults)


def lines_of(reading):
    return [*reading.faults, *(line for lines in reading.seen.values() for line in lines)]


@pytest.mark.slow
@pytest.mark.parametrize("is_said", [True, False])
def test_what_is_off_by_much_is_said_and_by_little_not(is_said, as_before):
    plain, said = lines_of(read(fixed())), []
    for start, change, words in some(SAID if is_said else NOT_SAID, 8):
        lines = lines_of(read(changed(start, change)))
        assert any(words in line for line in lines) == is_said, words
        said += [line for line in lines if line not in plain]
    as_before(*said)
