"""Solvers that remember are named with their start, whichever way they choose their steps; wrong ones are caught."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify_solver
from driftproof.blackbox.families.multistep_recurrence import FORWARD_EULER
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.foreign_solver import SolverTarget
from driftproof.blackbox.solvers.multistep import BACKWARD_EULER, TRAPEZOID, _quadrature, _solution, read_memory
from driftproof.symbolic.linear.multistep import MultistepFacts
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Corrected, Remembering
from tests.blackbox.handwritten_steppers import euler, rk4
from tests.blackbox.solvers.planted_solvers import adaptive, of_scipy, run
from tests.blackbox.transcripts import Asked, summed
from tests.looping import exactly, some

BASHFORTH4 = [55 / 24, -59 / 24, 37 / 24, -9 / 24]


def by_number(make):
    """A solver that is told how many steps to make."""
    return lambda f, t_span, y0, n: run(make, f, t_span, y0, n)


def by_length(make):
    """A solver that is told how long its steps are."""
    return lambda f, t_span, y0, dt: run(make, f, t_span, y0, round((t_span[1] - t_span[0]) / dt))


def of_its_own_number(make):
    """A solver of 100 steps, deaf to its tolerances."""
    return lambda f, t_span, y0, rtol, atol: run(make, f, t_span, y0, 100)


def of_its_own_length(make):
    """A solver whose steps are of 1/100, as long as they do not pass the end by one."""

    def solve(f, t_span, y0):
        t, states, times, step = t_span[0], [np.array(y0)], [t_span[0]], make()
        while t < t_span[1]:
            states.append(step(f, t, states[-1], 0.01))
            times.append(t := t + 0.01)
        return times, states

    return solve


def of_whole_steps(make):
    """A solver of as many steps of 0.47 as their quotient has in its whole part: of 40 times that, which is 39.99..."""

    def solve(f, t_span, y0):
        steps = int((t_span[1] - t_span[0]) / 0.47)
        return run(make, f, (t_span[0], t_span[0] + 0.47 * steps), y0, steps)

    return solve


def adams_bashforth2():
    return Remembering("adams_bashforth2", euler).step


def theta_step(share, left=0.0):
    """The theta method, by iteration of a fixed point until a number changes by no more than what may be left."""

    def step(f, t, y, h):
        y1, old = y, np.inf
        while np.max(np.abs(y1 - old)) > left:
            old, y1 = y1, y + h * ((1 - share) * f(t, y) + share * f(t + h, y1))
        return y1

    return step


def linearised(f, t, y, h):
    """ROS2, its Jacobian from differences."""
    slope, g = f(t, y), 1 + 0.5**0.5
    J = np.array([f(t, y + 1e-7 * e) - slope for e in np.eye(len(y))]).T / 1e-7
    M = np.eye(len(y)) - g * h * J
    k1 = np.linalg.solve(M, slope)
    return y + h / 2 * (3 * k1 + np.linalg.solve(M, f(t + h, y + h * k1) - 2 * k1))


STARTED = "adams_bashforth2, started by forward_euler"
PECE = "adams_moulton3, corrected once from the prediction of adams_bashforth4 (PECE), started by rk4"
KINDS = (by_number, by_length, of_its_own_number, of_its_own_length, of_whole_steps)
RIGHT = {
    STARTED: [kind(adams_bashforth2) for kind in KINDS],
    "adams_bashforth4, started by rk4": [by_length(lambda: Remembering("adams_bashforth4", rk4).step)],
    "bdf2, started by backward_euler": [by_number(lambda: Remembering("bdf2", planted.implicit_euler).step)],
    "the theta method, theta = 11/20": [of_its_own_number(lambda: theta_step(0.55))],
    "trapezoid": [by_length(lambda: theta_step(0.5))],
    PECE: [by_number(lambda: Corrected("adams_moulton3", rk4, BASHFORTH4).step)],
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", RIGHT)
def test_a_right_one_is_named_without_alarm(name, as_before):
    said = []
    for asked in map(Asked, some(RIGHT[name])):
        memory = read_memory(SolverTarget(asked.code).open())
        assert (memory.name, memory.faults) == (name, ())
        said += [*memory.lines, memory.order, asked]
    as_before(*said)


WRONG = {
    "its start is too inaccurate: first errors are like h^2, and whole runs have order 2, not 4":
        lambda: Remembering("adams_bashforth4", euler).step,
    "adams_bashforth2 except for sigma[0]: -1/3 instead of -1/2":
        lambda: Remembering("adams_bashforth2", euler, sigma=[-1 / 3, 3 / 2, 0.0]).step,
    "it is not consistent: rho'(1) - sigma(1) = 1/6":
        lambda: Remembering("adams_bashforth2", euler, sigma=[-2 / 3, 3 / 2, 0.0]).step,
}  # fmt: skip


@pytest.mark.parametrize("words", WRONG)
def test_a_wrong_one_is_caught_with_its_cause(words, as_before):
    found = [identify_solver(kind(WRONG[words]), isolate=False) for kind in exactly(2, (by_number, of_its_own_length))]
    assert all(words in report.verdict for report in found)
    as_before(*(line for report in found for line in summed(report)))


def test_the_report_is_of_the_recurrence_and_finds_no_fault_in_a_solver_without_tolerances():
    report = identify_solver(by_number(adams_bashforth2), isolate=False)
    assert report.verdict == f"it advances {STARTED}, of order 2"
    assert report.data["steps"] == {"name": STARTED, "order": 2}
    assert report.section("Not answered") is None
    assert "q'' = -q to t = 6: with 128 steps: error 0.0056, order 2.01" in report.section("Tolerance, measured").lines


def test_known_recurrences_have_the_order_they_say_and_the_runs_the_solution_they_are_held_to():
    known = (FORWARD_EULER, BACKWARD_EULER, TRAPEZOID)
    assert [m.claimed_order for m in known] == [MultistepFacts(m).order for m in known] == [1, 1, 2]
    slopes = np.subtract(_solution(0.7 + 1e-5), _solution(0.7 - 1e-5)) / 2e-5
    assert [*slopes, *_solution(0.0)] == pytest.approx([*_quadrature(0.7), 0.0, 0.0], abs=1e-9)


VARYING = {"BDF": {"ndf1", "ndf2", "ndf3", "ndf4", "bdf5"}, "LSODA": {"adams_moulton2", "adams_moulton5"}}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("method", VARYING)
def test_the_methods_of_a_solver_of_several_orders_are_told_where_its_steps_are_of_one_length(method):
    memory = read_memory(SolverTarget(of_scipy(method)).open())
    assert memory.name.endswith("where its step size is constant")
    assert VARYING[method] <= set(memory.name.replace(",", "").split())
    assert memory.order is None


def of_two_lengths(f, t_span, y0, rtol, atol):
    """Begun anew with steps of half the length."""
    t, y, times, states = t_span[0], np.array(y0), [t_span[0]], [np.array(y0)]
    for part, h in ((0.4, 0.5 * rtol**0.1), (1.0, 0.25 * rtol**0.1)):
        step = adams_bashforth2()
        while t < part * t_span[1]:
            y, t = step(f, t, y, h), t + h
            times.append(t)
            states.append(y)
    return times, states


@pytest.mark.slow
def test_steps_of_two_lengths_are_told_and_counted(as_before):
    asked = Asked(of_two_lengths)
    memory = read_memory(SolverTarget(asked.code).open())
    assert memory.name == "forward_euler, adams_bashforth2 where its step size is constant"
    as_before(*memory.lines, memory.order, memory.faults, asked)


@pytest.mark.parametrize(("by", "name"), [(2.0**-46, STARTED), (2.0**-44, "where its step size is constant")])
def test_lengths_are_one_if_their_times_cannot_tell_them_apart(by, name):
    def solve(f, t_span, y0, rtol, atol):
        times, states = run(adams_bashforth2, f, t_span, y0, 100)
        return [*times[:50], *(t + by for t in times[50:])], states

    assert read_memory(SolverTarget(solve).open()).name.endswith(name)


def of_heun(f, t_span, y0, rtol, atol):
    """Heun's slopes are the trapezoid's where they depend on t alone."""
    t, y, times, states = t_span[0], np.array(y0), [t_span[0]], [np.array(y0)]
    while t < t_span[1]:
        h = min(t_span[1] - t, 5 * rtol ** (1 / 3) * (1.0 if t < t_span[1] / 2 else 1.5))
        while rtol < 1e-7:
            f(t, y)
        slope = f(t, y)
        t, y = t + h, y + h / 2 * (slope + f(t + h, y + h * slope))
        times.append(t)
        states.append(y)
    return times, states


def stuck(f, t_span, y0, rtol, atol):
    """Adaptive, and never at the end of a long span."""
    while t_span[1] > 20:
        f(t_span[0], y0)
    return adaptive()(f, t_span, y0, rtol, atol)


def of_few(steps):
    return lambda f, t_span, y0: run(adams_bashforth2, f, t_span, y0, steps)


def of_one_step(f, t, y, h):
    return y + h * (0.3 * f(t, y) + 0.7 * f(t + h, y + h * f(t, y)))


STAGES = adaptive("dormand_prince54", exponent=0.2)
NO_MEMORY = {
    "of stages": (STAGES, "none that follows others of its size satisfies a known recurrence"),
    "of weights": (of_heun, "its steps are those of trapezoid, as are those of every method with these"),
    "of ten steps": (of_few(10), "it returns 11 states in a run of 40"),
    "of two steps": (of_few(2), "it returns 3 states"),
    "of a step": (of_few(1), "its steps are those of forward_euler, as"),
    "linearised": (by_number(lambda: linearised), "where they depend on y, its right-hand side is not evaluated at"),
    "of one step": (by_number(lambda: of_one_step), "each step depends on the previous state only"),
    "stuck": (stuck, "after 30000 calls of f"),
}


def test_equations_that_are_not_solved_well_are_remarked_on():
    solved, order = identify_solver(by_number(lambda: theta_step(0.5, 1e-5)), isolate=False).data["remarks"]
    assert solved.startswith("its equations are solved to ")
    assert order.startswith("no order is observed in whole runs")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("solve", "words"), NO_MEMORY.values(), ids=NO_MEMORY)
def test_what_is_no_memory_says_what_was_seen(solve, words):
    with pytest.raises(NotReadable, match=words):
        read_memory(SolverTarget(solve).open())
