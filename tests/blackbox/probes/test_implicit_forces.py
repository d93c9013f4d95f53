"""Implicit steps of a force: Nyström's table is read to what the solver leaves, and a wrong entry is named."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Allowance
from driftproof.blackbox.matching.entries import side_by_side
from driftproof.blackbox.matching.match import match_forces, match_method
from driftproof.blackbox.probes.implicit_forces import read_implicit_forces
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import dragged_steppers
from tests.blackbox.implicit_steppers import SOLVERS, fixed_point, induced, newton, of_force
from tests.blackbox.transcripts import Asked

SOLVED = Allowance(solver_tolerance=1e-9)
# Fixed-point iterations converge there.
NEAR = replace(ORDINARY_DOMAIN, largest_step=1.0)


def read(step):
    return read_implicit_forces(opened(step))


def the_same(reading, table, error):
    rows = zip((reading.c, reading.a, reading.b_position, reading.b_velocity), table, strict=True)
    return max(np.abs(np.array(seen) - np.array(said)).max() for seen, said in rows) <= error


@pytest.mark.parametrize(
    ("key", "timed"), [("implicit_midpoint", False), ("trapezoid", True), ("gauss2", False), ("lobatto_iiic3", True)]
)
def test_every_coefficient_is_read_to_rounding_and_the_method_is_named(key, timed):
    reading = read(of_force(induced(key), timed=timed))
    assert the_same(reading, induced(key), 32 * 2.0**-53)
    assert reading.drift == pytest.approx(1, abs=4 * 2.0**-53)
    assert key in match_forces(reading).keys


@pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
def test_the_coefficients_do_not_depend_on_what_solves_the_stages(solver):
    reading = read(of_force(induced("gauss2"), solver))
    assert the_same(reading, induced("gauss2"), 4 * reading.stage_error)
    assert match_forces(reading).keys == ("gauss2",)


def scalar(beta: float = 0.25, gamma: float = 0.5, *, solver: str = "iteration", most: int = 100):
    """Newmark's method on one number, as engineers write it, by fixed-point iteration or Newton's."""

    def step(force, x, v, dt):
        a0 = force(x)
        a1 = a0
        for _ in range(most):
            place = x + dt * v + dt**2 * ((0.5 - beta) * a0 + beta * a1)
            new, slope = force(place), 0.0
            if solver != "iteration":
                slope = dt**2 * beta * (force(place + 1e-7) - new) / 1e-7
            change = (new - a1) / (1 - slope)
            a1 += change
            if abs(change) < 1e-13:
                break
        return x + dt * v + dt**2 * ((0.5 - beta) * a0 + beta * a1), v + dt * ((1 - gamma) * a0 + gamma * a1)

    return step


def settled(change, x):
    """Where the iteration x ← change(x) comes to."""
    for _ in range(200):
        before, x = x, change(x)
        if np.max(np.abs(x - before)) < 1e-14:
            break
    return x


def midpoint(force, x, v, t, dt):
    """Of a force of position, velocity and time."""
    v1 = settled(lambda v1: v + dt * force(x + dt / 4 * (v + v1), (v + v1) / 2, t + dt / 2), v)
    return x + dt / 2 * (v + v1), v1


def half_implicit(force, x, v, dt):
    """Velocity Verlet whose second kick is solved for, since the force depends on the velocity."""
    first = force(x, v)
    end = x + dt * v + dt**2 / 2 * first
    return end, settled(lambda v1: v + dt / 2 * (first + force(end, v1)), v)


def late(force, x, v, dt):
    """The implicit midpoint rule whose force is given the velocity of the start."""
    push = settled(lambda push: force(x + dt / 2 * (v + dt / 2 * push), v), force(x, v))
    return x + dt * (v + dt / 2 * push), v + dt * push


VERDICTS = [
    (scalar(), "it is trapezoid"), (scalar(solver="newton"), "it is trapezoid"),
    (scalar(1 / 6), "it is newmark, with beta = 1/6 and gamma = 1/2"),
    (scalar(0.3, 0.55, solver="newton"), "it is newmark, with beta = 3/10 and gamma = 11/20"),
    (midpoint, "it is implicit_midpoint"), (half_implicit, "it is velocity_verlet"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "verdict"), VERDICTS, ids=range(len(VERDICTS)))
def test_implicit_steps_of_a_force_are_named_as_they_are_written(step, verdict):
    assert identify(step, isolate=False).verdict == verdict


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("row", [None, 0, 1, 2, 3])
def test_a_wrong_entry_stands_beside_the_one_claimed_and_a_right_one_does_not(row):
    table = [np.array(part, dtype=float) for part in induced("gauss2")]
    if row is not None:
        table[row].flat[0] += 1 / 64
    reading = read(of_force(tuple(table)))
    assert bool(match_method(reading, METHODS["gauss2"]).matches) == (row is None)
    names = ("c[0]", "a[0][0]", "b_position[0]", "b_velocity[0]")
    beside = side_by_side(reading, METHODS["gauss2"])
    assert (beside == []) if row is None else any(line.startswith(f"{names[row]} ") for line in beside)


@pytest.mark.slow
def test_a_right_step_is_verified_and_a_wrong_one_is_not():
    right = verify(of_force(induced("trapezoid")), "trapezoid", examples=20, isolate=False, allowance=SOLVED)
    assert right.passed is True
    c, a, *weights = induced("implicit_midpoint")
    wrong = of_force((c, a + 1 / 64, *weights))
    found = verify(wrong, "implicit_midpoint", examples=20, isolate=False, allowance=SOLVED)
    assert found.passed is False
    assert found.verdict == "is not implicit_midpoint; it is implicit_midpoint except for a[0][0]: 17/64 instead of 1/4"
    assert "a[0][0]  1/4      17/64      0.0156" in found.section("Coefficients: FAILED").lines


@pytest.mark.slow
def test_a_velocity_of_the_start_costs_an_order_and_is_named():
    assert "order 1 where the force depends on the velocity, not 2" in identify(late, isolate=False).verdict
    right = verify(midpoint, "implicit_midpoint", examples=20, isolate=False, allowance=SOLVED, domain=NEAR)
    assert right.passed is True
    found = verify(late, "implicit_midpoint", examples=20, isolate=False, allowance=SOLVED)
    assert found.passed is False
    assert "the velocity of call 0 holds F[0]: 0 instead of 1/2" in found.verdict


def test_velocities_that_do_not_tell_the_stages_apart_are_refused():
    gauss = of_force(induced("gauss2"), timed=False)
    with pytest.raises(NotReadable, match="velocit"):
        read(lambda force, x, v, dt: gauss(lambda q: force(q, v), x, v, dt))


@pytest.mark.slow
def test_a_solver_that_stops_early_is_told_by_what_it_leaves():
    early = of_force(induced("gauss2"), partial(newton, most=1))
    assert "its solver stops early" in identify(early, isolate=False).verdict
    assert verify(early, "gauss2", examples=20, isolate=False, allowance=SOLVED).passed is False
    rough = read(of_force(induced("gauss2"), partial(fixed_point, tolerance=1e-7)))
    assert 1e-12 < rough.solved.curved < 1e-6


def drag(force, x, v, t, dt):
    x1, v1 = of_force(induced("implicit_midpoint"))(force, x, v, t, dt)
    return x1, v1 - 0.25 * dt * v


def halving(force, x, v, t, dt):
    x1, v1 = of_force(induced("implicit_midpoint"))(force, x, v, t, dt)
    return x1, v1 - 0.5 * v


def one_by_one(force, x, v, dt):
    """Each position for itself."""
    step = of_force(induced("trapezoid"), timed=False)
    pairs = [step(lambda q: force(q[0]), a, b, dt) for a, b in zip(np.atleast_1d(x), np.atleast_1d(v), strict=True)]
    return np.array([a[0] for a, _ in pairs]), np.array([b[0] for _, b in pairs])


def at_another_time(force, x, v, t, dt):
    return of_force(induced("gauss2"))(lambda q, at: force(q, t), x, v, t, dt)


ASKED = {
    **{verdict: step for step, verdict in VERDICTS},
    "two stages": of_force(induced("radau_iia2"), fixed_point),
    "late": late,
    "stopped early": of_force(induced("gauss2"), partial(newton, most=1)),
    "moved by half": lambda force, x, v, dt: scalar(0.25, 0.5)(force, x, v / 2, dt),
    "at another time": at_another_time, "drag": drag, "halving": halving, "one by one": one_by_one,
    "never asks, in arrays": lambda force, x, v, dt: (x.copy() + dt * v, v),
    "explicit": of_force(([0.0, 1.0], [[0.0, 0.0], [0.5, 0.0]], [0.5, 0.0], [0.5, 0.5])),
    "explicit with velocities": dragged_steppers.verlet(lambda v, a, dt: v + dt * a),
    "without a weight": of_force(([0.5, 0.75], [[0.25, 0.0], [0.25, 0.25]], [0.0, 0.5], [0.0, 1.0])),
    "never asks": lambda force, x, v, dt: (x + dt * v, v),
}  # fmt: skip


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("name", ASKED)
def test_all_that_is_asked_of_implicit_steps_of_forces_and_said_is_as_before(name, as_before):
    asked = Asked(ASKED[name])
    try:
        reading = read(asked.code)
        as_before(reading, asked)
    except NotReadable as refusal:
        as_before(refusal, asked)


def test_what_is_no_step_of_forces_at_all_is_refused_as_one_with_implicit_stages():
    with pytest.raises(NotReadable, match="as one with implicit stages: without a force"):
        read_coefficients(opened(drag))
