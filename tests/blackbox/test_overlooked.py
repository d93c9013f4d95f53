"""Mistakes that once passed, misled or were blamed on right code, each beside its right twin."""

import re
import warnings
from dataclasses import dataclass

import numpy as np
import pytest

from driftproof import assert_verified, identify, verify
from tests.blackbox.families.remembering_steppers import Remembering, euler


@dataclass
class Clock:
    t: float
    q: float
    v: float


def spring(force_of=lambda x, k, m: k / m * x):
    def step(x, v, dt, k, m):
        v = v - dt * force_of(x, k, m)
        return x + dt * v, v

    return step


def pendulum(power):
    def step(x, v, dt, omega):
        v = v - dt * omega**power * x
        return x + dt * v, v

    return step


def heavy(masses_of):
    def step(force, x, v, masses, dt):
        m = masses_of(np.asarray(masses), x)
        v = v + dt / 2 * force(x) / m
        x = x + dt * v
        return x, v + dt / 2 * force(x) / m

    return step


def on_times(intervals):
    def step(f, y0, t):
        rows, sizes = [np.array(y0)], intervals(t)
        for at, h in zip(t[:-1], sizes, strict=True):
            slope = f(at, rows[-1])
            rows.append(rows[-1] + h / 2 * (slope + f(at + h, rows[-1] + h * slope)))
        return np.array(rows)

    return step


def later(place):
    def step(x0, v0, dt, n_steps):
        xs, vs = [x0], [v0]
        for _ in range(n_steps):
            vs.append(vs[-1] - dt * xs[place(len(xs))])
            xs.append(xs[-1] + dt * vs[-1])
        return xs, vs

    return step


def end_of(run):
    def step(x0, v0, dt, n_steps):
        xs, vs = run(x0, v0, dt, n_steps)
        return xs[-1], vs[-1]

    return step


def timed(ahead):
    def step(f, t, y, h):
        slope = f(t, y)
        return t + ahead * h, y + h / 2 * (slope + f(t + h, y + h * slope))

    return step


def record(ahead):
    def step(state: Clock, h: float) -> Clock:
        return Clock(state.t + ahead * h, state.q + h * state.v, state.v - h * state.q)

    return step


def weighted(sixth):
    def step(force, q, v, h):
        a = force(q)
        b = force(q + h / 2 * v + h * h / 8 * a)
        c = force(q + h * v + h * h / 2 * b)
        return q + h * v + h * h * (sixth * (a + 2 * b)), v + h * (sixth * (a + 4 * b + c))

    return step


def cast(form):
    def step(q, v, h):
        v = form(v - h * q)
        return q + h * float(v), v

    return step


RUN = later(lambda n: n - 1)
WRONG = [
    (spring(lambda x, k, m: k * x), spring(), "symplectic_euler", "with m = 2, k = 8 its step of q'' = -4 q is wrong"),
    (spring(lambda x, k, m: x / m), spring(), "symplectic_euler", "not for all parameters: with m = 2, k = 8"),
    (pendulum(1), pendulum(2), "symplectic_euler", "not for all parameters: with omega = 2"),
    (heavy(lambda m, x: m), heavy(lambda m, x: m[:, None] if x.ndim > 1 else m), "velocity_verlet", "with 9 positions"),
    (heavy(lambda m, x: m.mean()), heavy(lambda m, x: (m * x.T**0).T), "velocity_verlet", "q[0], q[1], v[0], v[1]"),
    (on_times(lambda t: [t[1] - t[0]] * (len(t) - 1)), on_times(np.diff), "heun2", "times of its grid are unequally"),
    (later(lambda n: max(n - 2, 0)), RUN, "symplectic_euler", "for its first step only"),
    (end_of(later(lambda n: max(n - 2, 0))), end_of(RUN), "symplectic_euler", "for its first step only"),
    (timed(0.5), timed(1), "heun2", "known method: it returns the time t + 0.125 with the state at its end, t + 0.25"),
    (record(2), record(1), "forward_euler", "it returns the time t + 0.5 with the state at its end, t + 0.25"),
    (weighted(np.float32(1 / 6)), weighted(1 / 6), "nystrom4", "is not nystrom4"),
    (cast(np.float32), cast(np.float64), "symplectic_euler", "the simplest step beyond the bound"),
]  # fmt: skip


@pytest.mark.parametrize(("wrong", "right", "method", "cause"), WRONG, ids=range(len(WRONG)))
def test_the_mistake_is_caught_and_its_twin_passes(wrong, right, method, cause):
    assert verify(right, method, examples=60, isolate=False).passed
    found = verify(wrong, method, examples=60, isolate=False)
    assert found.passed is False
    assert cause in found.verdict


def test_a_time_that_is_left_to_the_caller_or_a_step_size_is_no_wrong_time():
    def proposing(f, t, y, h):
        return 2 * h, y + h * f(t, y)

    assert verify(timed(0), "heun2", examples=60, isolate=False).passed
    assert verify(proposing, "forward_euler", examples=60, isolate=False).passed


def test_a_momentum_is_one_if_the_position_moves_by_p_over_m():
    def of(power):
        def step(force, x, p, m, dt):
            p = p + dt / 2 * force(x)
            x = x + dt * p / m**power
            return x, p + dt / 2 * force(x)

        return step

    assert verify(of(1), "velocity_verlet", examples=60, isolate=False).passed
    assert verify(of(0), "velocity_verlet", examples=60, isolate=False).passed is False


def test_a_remark_on_a_step_that_passes_is_warned_of():
    narrow = lambda f, t, y, h: (y + h * f(t, y)).astype(np.float32)
    cut = lambda f, t, y, h: np.add(y, h * f(t, y), out=np.zeros_like(y), casting="unsafe")
    for step, remark in ((narrow, "answers are rounded to binary32"), (cut, "integers truncate the answer")):
        with pytest.warns(UserWarning, match=remark):
            assert_verified(step, "forward_euler", examples=60, isolate=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_verified(narrow, "forward_euler", array=np.float32, examples=60, isolate=False)


def test_the_object_of_a_method_is_left_as_it_is():
    """It would begin its next examination with the slopes of this one, and be told that its start is inaccurate."""
    own = Remembering("adams_bashforth2", euler)
    said = {verify(own.step, "adams_bashforth2", isolate=False).verdict for _ in range(2)}
    assert said == {"is adams_bashforth2 in steps of equal length, started by forward_euler"}
    assert not own.states


def test_a_factorisation_that_is_kept_is_told_by_numbers_that_differ():
    kept = []

    def ros2(f, jac, t, y, h):
        gamma = 1 - 2**-0.5
        if not kept or len(kept[0]) != len(y):
            kept[:] = [np.linalg.inv(np.eye(len(y)) - gamma * h * np.asarray(jac(t, y)))]
        k1 = kept[0] @ np.asarray(f(t, y))
        return y + 3 / 2 * h * k1 + h / 2 * (kept[0] @ (np.asarray(f(t + h, y + h * k1)) - 2 * k1))

    report = verify(ros2, "ros2", isolate=False)
    seen, said = re.search(r"it ends at (\S+), where the coefficients read give (\S+):", report.verdict).groups()
    assert (report.passed, seen == said) == (None, False)
    assert "or remembers another step" in report.verdict


def test_headlines_say_what_was_seen():
    inverse = np.linalg.inv([[1, -0.25], [0.25, 1]])

    def ignoring(q, v, h):
        return tuple(inverse @ [q, v])

    def nearly(force, x, v, dt):
        a = force(x)
        x = x + dt * v + 0.499999 * dt * dt * a
        return x, v + 0.5 * dt * (a + force(x))

    def slowed(force, x, v, dt):
        v = (v + dt / 2 * force(x)) * (1 - 1e-9)
        x = x + dt * v
        return x, v + dt / 2 * force(x)

    for step, headline in (
        (ignoring, "it is not a known method: h is ignored"),
        (nearly, "it is velocity_verlet except for a[1][0]: 499999/1000000 instead of 1/2"),
        (cast(np.float32), "it is symplectic_euler in numbers of few bits, not in all numbers"),
    ):
        report = identify(step, isolate=False)
        assert headline in report.verdict
        assert "damping" not in report.text()
    assert re.search(r"multiplied by 1 -1e-09 in each step", identify(slowed, isolate=False).text())
