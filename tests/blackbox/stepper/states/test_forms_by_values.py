"""Steps of a built-in system whose arguments are its state, whatever their names: their values tell."""

import math
from functools import partial

import numpy as np
import pytest

from driftproof import Allowance, identify
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify

PAIRS = ("m p", "n p", "x m", "x k", "s k", "z w", "u w", "r n", "x n", "u n", "T c", "c T", "N P", "f g", "e h", "A B")


def named(pair, right=True):
    """A step of forward Euler with these names; if it is not right, the second slope has the new first number."""
    one, other = pair.split()
    source = f"def step({one}, {other}, dt):\n    new = {one} + dt * (1 - {one} - 0.5 * {one} * {other})\n"
    source += f"    return new, {other} + dt * (0.7 * {one if right else 'new'} - 0.3 * {other})"
    exec(source, known := {})
    return known["step"]


@pytest.mark.parametrize("pair", [*PAIRS, "q w", "v b"])
def test_what_a_short_step_returns_is_the_state_whatever_its_name(pair):
    found = opened(named(pair))
    assert found.reading == f"the state: {pair.replace(' ', ', ')}; the step size: dt"
    assert found.step_state([0.5, 0.75], 0.1) == pytest.approx([0.53125, 0.7625])


@pytest.mark.parametrize("right", [True, False])
def test_its_steps_are_judged_on_that_system_which_the_report_names(right):
    system = "m' = -m + 1, p' = 0.7 m - 0.3 p"
    found = verify(named("m p", right), "forward_euler", examples=20, isolate=False)
    assert found.passed is (None if right else False)
    assert (f"is forward_euler on its own system ({system} near (0, 0))" if right else system) in found.verdict
    assert "(the state: m, p; the step size: dt)" in found.text()


def level(h, dt):
    return h + dt * (1 - 0.4 * math.sqrt(abs(h)))


def clipped(v, t, dt, late=1.0):
    """Backward Euler, by Newton's method, of a driven circuit of two diodes, which is so stiff that 2**-20 is long."""
    slope = lambda x: 40 * (math.sin(5 * (t + late * dt)) - x) - 0.2 * math.sinh(20 * x)
    x = v
    for _ in range(60):
        x += max(-0.1, min(0.1, (v + dt * slope(x) - x) / (1 + dt * (40 + 4 * math.cosh(20 * x)))))
    return x


def decay(N, h, rate):
    return N - h * rate * N


def decay_twice(N, h):
    middle = N - 2 * h * N
    return N - h * middle


def heated(T, dt):
    return np.array([T[0], *(T[1:-1] + dt * (T[2:] - 2 * T[1:-1] + T[:-2])), T[-1]])


def heated_in_place(T, dt):
    for i in range(1, len(T) - 1):
        T[i] += dt * (T[i + 1] - 2 * T[i] + T[i - 1])


def driving(pose, vel, omega, dt):
    return pose + dt * np.array([vel * math.cos(pose[2]), vel * math.sin(pose[2]), omega])


def wave(first=True):
    """Cells on a ring; the second field is moved by the first one before its step, or after it."""

    def step(u, v, dt):
        bent = lambda u: np.roll(u, 1) - 2 * u + np.roll(u, -1)
        moved = u + dt * v
        return moved, v + dt * bent(u if first else moved)

    return step


STIFF = np.array([[3.0, -1.0], [-1.0, 1.0]])


def storeys(u, v, dt, late=0.0):
    """The midpoint rule of two storeys, whose matrix takes vectors of two alone."""
    return u + dt * (v - dt / 2 * STIFF @ u), v - dt * STIFF @ (u + dt / 2 * (v - late * v))


def spinor(psi, dt, share=1.0):
    """Heun's method of two complex amplitudes."""
    k1 = -1j * (STIFF @ psi)
    return psi + dt / 2 * (k1 - 1j * share * (STIFF @ (psi + dt * k1)))


def epidemic(state, dt, late=False):
    """Forward Euler of a dict of three numbers."""
    s, i = state["S"], state["I"]
    moved = i + dt * (s * i - i)
    return {"S": s - dt * s * i, "I": moved, "R": state["R"] + dt * (moved if late else i)}


def orbit(x, y, vx, vy, dt, stale=False):
    """Velocity Verlet in the plane, one coordinate after the other."""
    cube = (x * x + y * y) ** 1.5
    vx, vy = vx - dt / 2 * x / cube, vy - dt / 2 * y / cube
    x, y = x + dt * vx, y + dt * vy
    cube = cube if stale else (x * x + y * y) ** 1.5
    return x, y, vx - dt / 2 * x / cube, vy - dt / 2 * y / cube


def driven_by_time(x, y, z, t, dt, late=0.0):
    return x + dt * (y + np.cos(t + late * dt)), y - dt * x * z, z + dt * t


READ = [
    (level, "forward_euler", "the state: h;", None), (decay, "forward_euler", "the state: N;", None),
    (decay_twice, "forward_euler", "the state: N;", False),
    (heated, "forward_euler", "one of 4 numbers", None), (heated_in_place, "forward_euler", "one of 4 numbers", False),
    (wave(), "forward_euler", "one of 6 numbers", None), (wave(False), "forward_euler", "one of 6 numbers", False),
    (storeys, "midpoint2", "one of 4 numbers", None), (partial(storeys, late=1.0), "midpoint2", "one of 4 n", False),
    (spinor, "heun2", "one of 4 numbers", None), (partial(spinor, share=0.5), "heun2", "one of 4 numbers", False),
    (epidemic, "forward_euler", "the state: S, I, R of a dict", None),
    (partial(epidemic, late=True), "forward_euler", "one of 3 numbers", False),
    (orbit, "velocity_verlet", "one of 4 numbers", None),
    (partial(orbit, stale=True), "velocity_verlet", "one of 4 numbers", False),
    (driven_by_time, "forward_euler", "one of 3 numbers", None),
    (partial(driven_by_time, late=1.0), "forward_euler", "one of 3 numbers", False),
]  # fmt: skip


@pytest.mark.slow(keep=5)
@pytest.mark.parametrize(("step", "method", "words", "passed"), READ)
def test_one_number_several_and_arrays_of_cells_are_read_by_their_values_and_judged(step, method, words, passed):
    found = verify(step, method, examples=30, isolate=False)
    assert found.passed is passed
    assert words in found.text()
    assert (f"is {method} on its own system" in found.verdict) is (passed is None)


def test_parameters_that_are_not_returned_stay_parameters_and_no_step_notices_the_trial():
    counted = []
    step = lambda x, v, dt, k, m: counted.append(dt) or (x + dt * v, v - dt * k / m * x)
    assert opened(step).convention.extra == {"k": 1.0, "m": 1.0}
    assert 2.0**-20 not in counted
    assert opened(lambda y, m, dt: y - dt * y / m).reading == "the state: y; the step size: dt; set to 1: m"
    assert opened(lambda q, v, h: (q + h * v, v)).reading == ""


@pytest.mark.parametrize(("late", "passed"), [(1.0, True), (0.0, None)])
def test_a_state_that_is_stiff_is_seen_by_shorter_steps(late, passed):
    system = lambda t, y: 40 * (math.sin(5 * t) - y) - 0.2 * np.sinh(20 * y)
    options = {"allowance": Allowance(solver_tolerance=1e-9), "isolate": False}
    step = lambda v, t, dt: clipped(v, t, dt, late)
    assert verify(step, "backward_euler", system=system, **options).passed is passed
    assert verify(step, "backward_euler", **options).passed is None
    assert "its steps are those of backward_euler" in identify(step, isolate=False).verdict


def test_an_array_that_a_short_step_hardly_changes_is_the_state_whatever_its_name():
    assert opened(heated).reading == "the state: T; the step size: dt"
    assert opened(driving).reading == "the state: pose; the step size: dt; set to 1: vel, omega"
    found = verify(driving, "forward_euler", examples=20, isolate=False)
    assert "is forward_euler on its own system (one of 3 numbers)" in found.verdict
    with pytest.raises(BadInput, match="a step that takes its right-hand side"):
        opened(lambda pose, vel, omega, dt: pose + 1.0)
