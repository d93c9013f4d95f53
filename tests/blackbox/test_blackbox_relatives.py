"""What is no method but a relative of one is named in words: each planted in a stepper written by hand."""

from __future__ import annotations

from fractions import Fraction as Q
from math import exp

import numpy as np
import pytest

from driftproof.blackbox.linear.fit import LinearFit, linear_fit
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import stepper
from driftproof.numeric.steppers import forward_euler, rk4, symplectic_euler


def fit(step) -> LinearFit:
    return linear_fit(opened(step))


def verlet(force, q, v, h):
    v = v + h / 2 * force(q)
    q = q + h * v
    return q, v + h / 2 * force(q)


def verlet_without_last_kick(force, q, v, h):
    v = v + h / 2 * force(q)
    return q + h * v, v


def verlet_without_first_kick(force, q, v, h):
    q = q + h * v
    return q, v + h / 2 * force(q)


def yoshida_without_last_kick(force, q, v, h):
    w = 1 / (2 - 2 ** (1 / 3))
    for c, d in ((w / 2, w), ((1 - w) / 2, 1 - 2 * w), ((1 - w) / 2, w)):
        v = v + c * h * force(q)
        q = q + d * h * v
    return q, v


def two_half_steps(force, q, v, h):
    q, v = rk4(force, q, v, h / 2)
    return rk4(force, q, v, h / 2)


def five_substeps(force, q, v, h):
    for _ in range(5):
        q, v = symplectic_euler(force, q, v, h / 5)
    return q, v


def position_exact_for_constant_force(force, q, v, h):
    a = force(q)
    return q + h * v + a * h**2 / 2, v + a * h


def three_substeps_with_one_force(force, q, v, h):
    a = force(q)
    for _ in range(3):
        v = v + h / 3 * a
        q = q + h / 3 * v
    return q, v


def two_euler_substeps_with_one_force(force, q, v, h):
    a = force(q)
    for _ in range(2):
        q, v = q + h / 2 * v, v + h / 2 * a
    return q, v


def backwards_in_time(force, q, v, h):
    return rk4(force, q, v, -h)


def adjoint_of_rk4(q, v, h):
    c, s = 1 - h**2 / 2 + h**4 / 24, h - h**3 / 6
    det = c * c + s * s
    return (c * q + s * v) / det, (c * v - s * q) / det


def swapped_output(force, q, v, h):
    return symplectic_euler(force, q, v, h)[::-1]


def swapped_input(force, q, v, h):
    return symplectic_euler(force, v, q, h)


def swapped_both(force, q, v, h):
    return verlet(force, v, q, h)[::-1]


def step_rounded(force, q, v, h):
    return rk4(force, q, v, float(np.float32(h)))


def half_force(force, q, v, h):
    return rk4(lambda x: force(x) / 2, q, v, h)


def half_drift(q, v, h):
    v = v - h * q
    return q + h / 2 * v, v


def scaled_step(force, q, v, h):
    return rk4(force, q, v, 0.75 * h)


UNDAMPED = [
    (verlet_without_last_kick, "velocity_verlet without its last kick: v is the half-step velocity"),
    (verlet_without_first_kick, "velocity_verlet without its first kick: v is the half-step velocity"),
    (yoshida_without_last_kick, "yoshida4 without its last kick: v is a velocity between two steps"),
    (two_half_steps, "two half steps of rk4"),
    (five_substeps, "5 steps of h/5 of velocity-first symplectic Euler"),
    (
        position_exact_for_constant_force,
        "q + h v + 1/2 h^2 F(q), v + h F(q): position exact for a constant force, velocity as in forward_euler",
    ),
    (
        three_substeps_with_one_force,
        "q + h v + 2/3 h^2 F(q), v + h F(q): 3 substeps of symplectic_euler with the force of the first",
    ),
    (
        two_euler_substeps_with_one_force,
        "q + h v + 1/4 h^2 F(q), v + h F(q): 2 substeps of forward_euler with the force of the first",
    ),
    (backwards_in_time, "rk4, with -h for h: it steps back in time"),
    (adjoint_of_rk4, "the adjoint of rk4"),
    (swapped_output, "velocity-first symplectic Euler, with q and v exchanged in its output"),
    (swapped_input, "velocity-first symplectic Euler, with q and v exchanged in its input"),
    (step_rounded, "rk4, with h rounded to binary32"),
    (half_force, "rk4, but the force enters 0.5 times"),
    (half_drift, "velocity-first symplectic Euler, but the position moves by 0.5 h v"),
    (scaled_step, "rk4, with 0.75 h for h"),
]


@pytest.mark.parametrize(("step", "words"), UNDAMPED, ids=lambda x: getattr(x, "__name__", ""))
def test_a_relative_without_damping_is_named(step, words):
    found = fit(step)
    assert found.best.words == words
    assert found.best.extras == 1
    assert found.best.score <= 1


def test_an_exchange_of_both_pairs_is_named_beside_the_step_back_in_time_that_it_equals():
    words = [candidate.words for candidate in fit(swapped_both).candidates]
    assert "velocity_verlet, with q and v exchanged in its input and its output" in words
    assert "position_verlet, with -h for h: it steps back in time" in words


def test_order_0_is_said_of_a_position_that_moves_by_half():
    lines = fit(half_drift).lines
    assert "order 0: the position moves by 0.5 h v" in lines
    assert "linear order 0" in lines


def test_the_half_step_velocity_is_told_where_the_system_is_the_stepper_s_own():
    words = [
        candidate.words for candidate in fit(lambda q, v, h: verlet_without_last_kick(lambda x: -x, q, v, h)).candidates
    ]
    assert words[:2] == ["velocity-first symplectic Euler", UNDAMPED[0][1]]


def drag_in_the_kick(q, v, h):
    v = v + h * (-q - 0.04 * v)
    return q + h * v, v


def drag_in_both_kicks(q, v, h):
    v = v + h / 2 * (-4 * q - 0.5 * v)
    q = q + h * v
    return q, v + h / 2 * (-4 * q - 0.5 * v)


def implicit_drag(q, v, h):
    v = (v - h * q) / (1 + 0.25 * h)
    return q + h * v, v


def drag_on_the_mean(q, v, h):
    v = ((1 - 0.1 * h) * v - h * q) / (1 + 0.1 * h)
    return q + h * v, v


def explicit_then_implicit(q, v, h):
    v = v + h / 2 * (-q - 0.2 * v)
    q = q + h * v
    return q, (v - h / 2 * q) / (1 + h / 2 * 0.2)


def drag_in_the_field(q, v, h):
    def rate(y):
        return np.array([y[1], -4 * y[0] - 0.3 * y[1]])

    y = np.array([q, v])
    k1 = rate(y)
    k2 = rate(y + h / 2 * k1)
    k3 = rate(y + h / 2 * k2)
    k4 = rate(y + h * k3)
    return tuple((y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)).tolist())


def implicit_field(q, v, h):
    q1, v1 = np.linalg.solve(np.array([[1.0, -h], [h, 1 + 0.5 * h]]), np.array([q, v]))
    return float(q1), float(v1)


def oscillator_then_factor(q, v, h):
    q, v = rk4(lambda x: -x, q, v, h)
    return q, v * (1 - 0.125 * h)


def factor_then_oscillator(q, v, h):
    return verlet(lambda x: -x, q, v * exp(-0.3 * h), h)


def between_two_halves(q, v, h):
    q, v = verlet(lambda x: -x, q, v * exp(-0.15 * h), h)
    return q, v * exp(-0.15 * h)


def baoab(q, v, h):
    v = v - h / 2 * q
    q = q + h / 2 * v
    v = v * exp(-0.3 * h)
    q = q + h / 2 * v
    return q, v - h / 2 * q


def power_after_the_kick(q, v, h):
    v = (v - h * q) * 0.97**h
    return q + h * v, v


def factor_whatever_the_step(q, v, h):
    v = (v - h * q) * 0.99
    return q + h * v, v


def four_damped_substeps(q, v, h):
    for _ in range(4):
        v = v + h / 4 * (-q - 0.1 * v)
        q = q + h / 4 * v
    return q, v


def frozen_force_with_drag(q, v, h):
    a = -q - 0.2 * v
    return q + h * v + h * h / 2 * a, v + h * a


def exact_and_damped(q, v, h):
    w = (1 - 0.01) ** 0.5
    e, c, s = exp(-0.1 * h), np.cos(w * h), np.sin(w * h) / w
    return float(e * (c * q + s * (v + 0.1 * q))), float(e * (c * v - s * (q + 0.1 * v)))


DAMPED = [
    (drag_in_the_kick, "velocity-first symplectic Euler plus linear drag 0.04", Q(1, 25)),
    (drag_in_both_kicks, "velocity_verlet plus linear drag 0.5", Q(1, 2)),
    (
        implicit_drag,
        "velocity-first symplectic Euler plus implicit linear drag 0.25: each kick divides by 1 + 0.25 times its time",
        Q(1, 4),
    ),
    (
        drag_on_the_mean,
        "velocity-first symplectic Euler plus linear drag 0.2 on the mean of v before and after each kick",
        Q(1, 5),
    ),
    (
        explicit_then_implicit,
        "velocity_verlet plus linear drag 0.2, explicit in its first kick and implicit in its last",
        Q(1, 5),
    ),
    (drag_in_the_field, "rk4 with linear drag 0.3 in its right-hand side", Q(3, 10)),
    (implicit_field, "backward_euler with linear drag 0.5 in its right-hand side", Q(1, 2)),
    (oscillator_then_factor, "rk4, then v times 1 - 0.125 h", Q(1, 8)),
    (factor_then_oscillator, "v times exp(-0.3 h), then velocity_verlet", Q(3, 10)),
    (
        between_two_halves,
        "velocity_verlet between two halves of a damping, v times exp(-0.3 h) with h/2 for h",
        Q(3, 10),
    ),
    (baoab, "velocity_verlet, v times exp(-0.3 h) in the middle of its drift", Q(3, 10)),
    (power_after_the_kick, "velocity-first symplectic Euler, v times 0.97**h after its kick", None),
    (factor_whatever_the_step, "velocity-first symplectic Euler, v times 0.99, whatever h is after its kick", Q(0)),
    (four_damped_substeps, "4 steps of h/4 of velocity-first symplectic Euler plus linear drag 0.1", Q(1, 10)),
    (
        frozen_force_with_drag,
        "q + h v + 1/2 h^2 F(q), v + h F(q): position exact for a constant force, velocity as in forward_euler"
        " plus linear drag 0.2",
        Q(1, 5),
    ),
    (exact_and_damped, "the exact solution with linear drag 0.2", Q(1, 5)),
]


@pytest.mark.parametrize(("step", "words", "damping"), DAMPED, ids=lambda x: getattr(x, "__name__", ""))
def test_a_damped_relative_is_named(step, words, damping):
    found = fit(step)
    assert found.best.words == words
    assert found.best.score <= 1
    if damping is not None:
        assert found.damping == damping


def test_a_damping_is_named_where_no_step_goes_back():
    def forward_only(q, v, h):
        if h < 1e-8:
            raise ValueError("h is too small")
        return drag_in_the_kick(q, v, h)

    found = fit(forward_only)
    assert found.best.words == DAMPED[0][1]
    assert any("h is too small" in line for line in found.lines)


@pytest.mark.parametrize("step", [drag_in_the_kick, factor_then_oscillator, implicit_drag], ids=lambda x: x.__name__)
def test_a_damping_that_is_off_in_the_tenth_digit_of_one_part_is_no_longer_that_relative(step):
    def disturbed(q, v, h):
        q1, v1 = step(q, v, h)
        return q1 + 1e-10 * h * h * v, v1

    found = fit(disturbed)
    assert found.best is None


def test_a_relative_of_two_kinds_at_once_is_named_where_it_is_simple_and_reported_where_it_is_not():
    swapped_and_damped = fit(lambda q, v, h: drag_in_the_kick(q, v, h)[::-1])
    assert swapped_and_damped.best.words == f"{DAMPED[0][1]}, with q and v exchanged in its output"
    assert swapped_and_damped.best.extras == 2
    euler_then_rk4 = fit(lambda force, q, v, h: rk4(force, *forward_euler(force, q, v, h / 2), h / 2))
    assert euler_then_rk4.best is None
    assert euler_then_rk4.facts.linear_order == 1


@pytest.mark.parametrize(("key", "n"), [("kahan_li8", 10), ("yoshida8", 10), ("dop853", 2)])
def test_substeps_of_long_methods_are_named_though_shorter_ones_come_near(key, n):
    step = stepper(METHODS[key], float)

    def substeps(force, q, v, h):
        for _ in range(n):
            q, v = step(force, q, v, h / n)
        return q, v

    found = fit(substeps)
    assert found.best.methods[0] == key
    assert found.best.words == f"{'two half steps' if n == 2 else f'{n} steps of h/{n}'} of {key}"
    assert found.facts.linear_order == METHODS[key].claimed_order
