"""A stepper is named by the surest that was seen: coefficients, nonlinear steps, linear steps, or nearly these."""

import re

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.dragged_steppers import WRONG
from tests.blackbox.transcripts import summed


def of_average(force, q, v, h):
    """The implicit midpoint rule, iterated for its one force."""
    a = force(q)
    for _ in range(60):
        a = force(q + h / 2 * v + h * h / 4 * a)
    return q + h * v + h * h / 2 * a, v + h * a


def backward(force, q, v, h):
    """Backward Euler, iterated so that it stands at once where the force is -q."""
    a = force(q)
    for _ in range(100):
        before, a = a, a + (force(q + h * v + h * h * a) - a) / (1 + h * h)
        if before == a:
            break
    return q + h * v + h * h * a, v + h * a


@pytest.mark.slow
@pytest.mark.parametrize("step", [of_average, backward])
def test_implicit_steps_of_a_force_with_one_linear_step_are_told_apart_by_nonlinear_ones(step, as_before):
    as_before(*summed(identify(step, isolate=False)))


@pytest.mark.parametrize(
    ("rows", "weights", "order"),
    [([[], [1 / 3], [-3 / 16, 15 / 16]], [1 / 6, 3 / 10, 8 / 15], 3), ([[], [1 / 3], [0.0, 1.0]], [0.5, 0.0, 0.5], 2)],
)
def test_coefficients_that_were_read_are_not_called_by_what_their_linear_steps_are_alone(rows, weights, order):
    verdict = identify(codes.tableau(rows, weights, [sum(row) for row in rows]), isolate=False).verdict
    words = f"it is not a known method, but has 3 stages and order {order}, though on linear problems it is heun3 "
    assert verdict.startswith(words)


def test_a_method_of_linear_steps_is_not_named_without_a_word_on_the_step_that_is_beyond_its_bound():
    asleep = lambda f, t, y, h: y.copy() if max(abs(f(t, y))) < 1e-4 else codes.rk4(f, t, y, h)
    words = r"judging by linear steps only, it is rk4 \(.*\); but a step is off by \S+ times the bound on its rounding"
    assert re.fullmatch(words, identify(asleep, isolate=False).verdict)
    linear = identify(lambda q, v, h: (q + h * v, v - h * q), isolate=False)
    assert linear.verdict == "judging by linear steps only, it is forward_euler"


def pendulum(push=lambda v: 0.0):
    """Velocity Verlet of the pendulum; with a push h³ v² it is another method, but for states near (0, 0)."""

    def step(q, v, h):
        half = v - h / 2 * np.sin(q)
        q1 = q + h * half
        return q1, half - h / 2 * np.sin(q1) + h**3 * push(v)

    return step


def midpoint_of_pendulum(q, v, h):
    """The implicit midpoint rule, iterated until it stands: its linear steps in few digits are those of others."""
    k, w = v, -np.sin(q)
    for _ in range(100):
        k, w = v + h / 2 * w, -np.sin(q + h / 2 * k)
    return q + h * k, v + h * w


def single(q, v, h):
    """Velocity Verlet of the pendulum in single precision."""
    return tuple(map(float, pendulum()(*map(np.float32, (q, v, h)))))


NEAR_0, ANOTHER = "method; near (0, 0) it is velocity_verlet", "its system is built in, not q'' = -q but another one"
PENDULUM = "its system is built in, not q'' = -q but q' = v, v' = -q near (0, 0)"


@pytest.mark.parametrize(
    ("step", "verdict"),
    [
        (pendulum(), f"judging by one system only, it is velocity_verlet; {PENDULUM}"),
        (midpoint_of_pendulum, f"judging by one system only, it is implicit_midpoint or lobatto_iiib2; {PENDULUM}"),
        (
            pendulum(lambda v: v * v),
            f"it is not a known method: {PENDULUM}, and on it its steps are those of no {NEAR_0}",
        ),
        (single, f"judging by linear steps only, it is velocity_verlet; {ANOTHER}"),
    ],
    ids=["verlet", "midpoint", "pushed", "single"],
)
def test_steps_of_a_system_that_is_linear_near_0_alone_are_named_by_what_they_are_on_it(step, verdict):
    assert identify(step, isolate=False).verdict == verdict


def solved_by_iteration(theta, tolerance, *, relative):
    """q₁ = q + h ((1 - θ) v + θ v₁), and v₁ alike, iterated until a change is small."""

    def step(q, v, h):
        end = q, v
        for _ in range(100):
            x, w = ((1 - theta) * z + theta * z1 for z, z1 in zip((q, v), end, strict=True))
            before, end = end, (q + h * w, v - h * x)
            change = max(abs(a - b) for a, b in zip(before, end, strict=True))
            if change <= tolerance * (max(map(abs, end)) if relative else 1):
                break
        return end

    return step


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("theta", "tolerance", "relative"), [(0.5, 1e-6, False), (0.5, 1e-6, True), (1.0, 1e-8, False), (1.0, 1e-5, True)]
)
def test_a_solver_that_stops_early_leaves_the_method_that_it_nearly_is(theta, tolerance, relative, as_before):
    as_before(*summed(identify(solved_by_iteration(theta, tolerance, relative=relative), isolate=False)))
    assert identify(lambda q, v, h: (q + h * v, v - h * 1.001 * q), isolate=False).verdict.find("nearly") == -1


@pytest.mark.parametrize(("drag", "rate", "key"), [(0.0, 1.0, "symplectic_euler"), (0.04, 1.0, None), (0.0, 4.0, None)])
def test_a_map_has_a_key_where_it_is_that_method_of_the_plain_oscillator(drag, rate, key, as_before):
    def step(q, v, h):
        v = v - h * (rate * q + drag * v)
        return q + h * v, v

    report = identify(step, isolate=False)
    assert report.data["method"] == key
    as_before(*summed(report))


def adapting(f, t, y, h):
    while np.max(np.abs(h / 2 * (f(t + h, y + h * f(t, y)) - f(t, y)))) > 1e-6:
        h = h / 2
    return codes.heun(f, t, y, h)


def test_a_step_that_is_not_read_is_told_how_to_be_and_is_no_method_that_it_is_far_from():
    report = identify(adapting, isolate=False)
    assert any(line.startswith("if it adapts its step size, let") for line in report.section("What to do").lines)
    assert "nearly" not in report.verdict


def test_the_first_call_with_a_velocity_of_another_time_is_told_and_how_many_are_like_it():
    (step,) = (step for step, key, _ in WRONG if key == "yoshida4")
    _, call, others = identify(step, isolate=False).verdict.partition("not 4: call 1 is given the position of ")
    assert call
    assert others.endswith(", and 2 more")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("calls", [40, 41])
def test_a_method_that_is_iterated_so_many_times_is_named_and_its_long_table_left_out(calls):
    report = identify(codes.midpoint_iterated(calls - 1, first=0.5), isolate=False)
    start = "the state at the start: explicit"
    assert report.verdict == f"it is implicit_midpoint, with {calls} fixed-point iterations from {start}"
    left_out = f"A, b and c are not shown: a step makes {calls} calls"
    assert (left_out in report.section("Coefficients").lines) == (calls > 40)
