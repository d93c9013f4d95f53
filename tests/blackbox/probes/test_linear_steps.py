"""The one-step matrix is read from steps of a stepper that is linear, or nearly, or said not to be."""

from __future__ import annotations

from fractions import Fraction as Q
from math import cos, sin, tanh

import numpy as np
import pytest

from driftproof.blackbox.findings import Misbehaviour, NoAnswer
from driftproof.blackbox.probes.linear_steps import (
    LINEAR,
    LINEARISED,
    NOT_LINEAR,
    NOT_REPEATABLE,
    LinearReading,
    read_linear_steps,
)
from driftproof.blackbox.stepper.opening import opened
from driftproof.numeric.steppers import rk4, symplectic_euler
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.broken_steppers import hanging_at
from tests.blackbox.matching.linear_fits import alike, fit
from tests.blackbox.transcripts import Asked
from tests.looping import exactly


def in_half_precision(force, q, v, h):
    q, v, h = np.float16(q), np.float16(v), np.float16(h)
    v = v + h * np.float16(force(float(q)))
    return q + h * v, v


def limited(force, q, v, h):
    q, v = symplectic_euler(force, q, v, h)
    return q, max(-100.0, min(100.0, v))


def forwards(force, q, v, h):
    if h <= 0:
        raise ValueError("h must be positive")
    return rk4(force, q, v, h)


def kicked(push):
    """Symplectic Euler in a force of the position."""

    def step(q, v, h):
        v = v - h * push(q)
        return q + h * v, v

    return step


def at_rest_below_a_speed(q, v, h):
    v = v - h * q
    v = v if abs(v) > 1e-3 else 0.0
    return q + h * v, v


NAMED = [
    (in_half_precision, LINEAR, 1.0, "symplectic_euler", 1),
    (kicked(lambda q: 9.81 * sin(q)), LINEARISED, 2.0**-60, "symplectic_euler", Q("9.81")),
    (limited, LINEAR, 1.0, "symplectic_euler", 1),
    (at_rest_below_a_speed, LINEAR, 2.0**20, "symplectic_euler", 1),
    (forwards, LINEAR, 1.0, "rk4", 1),
]


@pytest.mark.parametrize(("step", "kind", "amplitude", "key", "stiffness"), NAMED)
def test_a_method_is_named_where_the_step_is_linear(step, kind, amplitude, key, stiffness):
    with np.errstate(all="ignore"):
        found = fit(step)
    assert (found.kind, found.amplitude, found.stiffness) == (kind, amplitude, stiffness)
    assert (found.best.methods[0], found.best.extras) == (key, 0)


def test_a_step_that_bends_at_ordinary_size_is_named_where_it_is_linear_and_compared_where_it_is_not():
    def bending(force, q, v, h):
        v = tanh(v + h * force(q))
        return q + h * v, v

    found = fit(bending)
    assert (found.kind, found.best.methods) == (LINEARISED, ("symplectic_euler",))
    # From (0, 1) and (1, 0) by h = 1/4: tanh(1) for 1 is the largest difference, and h of that in the position.
    assert (found.nearest.h, found.nearest.off) == (0.25, pytest.approx(1 - 0.25**2 - tanh(1.0)))
    assert found.nearest.methods == ("symplectic_euler_position_first",)


NOISE = iter(np.random.default_rng(0).random(10**4))


@pytest.mark.parametrize(
    ("noise", "kind", "near"),
    [(lambda z: next(NOISE), NOT_REPEATABLE, None), (lambda z: hash(z) % 1000 / 1000, NOT_LINEAR, "rk4")],
)
def test_noise_whether_it_repeats_or_not_is_reported_and_not_named(noise, kind, near):
    def noisy(force, q, v, h):
        q1, v1 = rk4(force, q, v, h)
        return q1 * (1 + 1e-9 * noise((q, v, h))), v1

    found = fit(noisy)
    assert (found.kind, found.best) == (kind, None)
    assert (found.nearest and found.nearest.methods) == (near and tuple(alike()[near]))


def test_a_bent_step_of_a_built_in_length_has_no_rates_and_is_not_linearised():
    read = read_linear_steps(opened(lambda q, v, h: (q + 0.25 * v, v - 0.25 * sin(q))))
    assert (read.kind, read.at_zero) == (NOT_LINEAR, None)
    cubic = lambda q, v, h: in_half_precision(lambda x: -x - 4 * x**3, q, v, h)
    assert read_linear_steps(opened(cubic)).kind == NOT_LINEAR


def test_rates_are_read_to_more_than_the_length_of_the_steps_that_are_taken():
    def step(q, v, h):
        if 0 < abs(h) < 2.0**-15:
            raise ValueError("too short")
        return (q * cos(h) + v * sin(h)) * (1 - h / 2), (v * cos(h) - q * sin(h)) * (1 - h / 2)

    found = read_linear_steps(opened(step))
    assert found.tiny == 2.0**-12
    assert [x / found.tiny for x in found.at_zero[1:3]] == pytest.approx([1, -1], rel=1e-8)


def test_a_call_that_does_not_come_back_is_told_and_changes_nothing_of_what_is_read():
    right, told = read_linear_steps(opened(symplectic_euler)), []
    for nth in exactly(60, range(60)):
        subject = opened(symplectic_euler)
        subject.before = hanging_at(nth)
        try:
            found = read_linear_steps(subject)
        except NoAnswer:
            continue
        assert (found.kind, found.unit, found.steps[:3]) == (right.kind, right.unit, right.steps[:3])
        told += [remark.partition(":")[0] for remark in found.remarks]
    assert {"not seen far out", "no answer at h = 2", "no answer at h = -1"} <= {*told}


def stopping(refuses):
    """Euler's method, which refuses some lengths of steps."""

    def step(q, v, h):
        if refuses(h):
            raise ValueError("not so")
        return q + h * v, v - h * q

    return step


def limited_at_10000(q, v, h):
    v = max(-1e4, min(1e4, v - h * q))
    return q + h * v, v


READ = {
    "cubic far out": kicked(lambda q: q + 1e-3 * q**3),
    "pendulum": kicked(lambda q: 9.75 * (q - q**3 / 6)),
    "stops at half": stopping(lambda h: h == 0.5),
    "stops at long steps": stopping(lambda h: abs(h) > 0.6),
    "stops backwards": stopping(lambda h: h <= 0),
    "stops at short steps": stopping(lambda h: 0 < abs(h) < 1e-4),
    "at rest below a speed": at_rest_below_a_speed,
    "fast": lambda q, v, h: (q + h * v, v - 1e6 * h * q),
    "limited far out": limited_at_10000,
    "falls": lambda q, v, h: (q + h * v, v - h),
    "bent": lambda q, v, h: (q + h * v * abs(v), v - h * q * q),
    "bent in h": lambda q, v, h: (q + h * v, v - abs(h) ** 0.5 * q),
    "with a rate that falls to its half": lambda q, v, h: (q + h * v, v - abs(h) ** 1.5 * q),
    "with a rate that falls less": lambda q, v, h: (q + h * v, v - abs(h) ** 1.2 * q),
    "stays": lambda q, v, h: (q, v),
}


@pytest.mark.parametrize("name", READ)
@pytest.mark.parametrize(("array", "size"), [(None, 1.0), (None, 2.0**-5), (np.float32, 1.0), (np.float16, 1.0)])
def test_what_is_read_of_linear_steps_is_what_it_was(name, array, size, as_before):
    asked = Asked(READ[name])
    try:
        found = read_linear_steps(opened(asked.code, array=array), size)
    except Misbehaviour as refusal:
        as_before(refusal, asked)
        return
    rates = [f"{x:.9g}" for x in found.at_zero or ()]
    shown = found.kind, found.amplitude, found.unit, found.tiny, found.identifiable, found.starts_at_identity
    ordinary = next(iter(found.ordinary), None)
    as_before(shown, rates, (ordinary, len(found.steps)), found.steps[::6], *found.remarks, asked)


@pytest.mark.parametrize("component", [0, 1])
@pytest.mark.parametrize("state", [(1.0, 1.0), (0.625, -0.75), (-1.5, 0.0)])
def test_a_step_is_linear_that_is_off_the_sum_of_its_parts_by_no_more_than_4096_roundings(state, component):
    length, (q0, v0) = 0.125, state
    sizes = abs(q0) + length * abs(v0), length * abs(q0) + abs(v0)
    for factor, linear in ((0.99, True), (1.01, False)):
        error = factor * 4096 * 2.0**-53 * (abs(q0) + abs(v0) + sizes[component])

        def step(q, v, h, error=error):
            off = error * ((q, v, h) == (q0, v0, length))
            return q + h * v + off * (component == 0), v - h * q + off * (component == 1)

        assert (read_linear_steps(opened(step, "map")).kind == LINEAR) is linear


@pytest.mark.parametrize("place", range(4))
def test_a_step_of_0_is_none_as_far_as_a_tiny_step_tells(place):
    slack = 8 * (2.0**-12 + 2.0**-53)
    for more, seen in ((0.0, True), (2.0**-51, False)):
        at_zero = [x + (slack + more) * (i == place) for i, x in enumerate((1.0, 0.0, 0.0, 1.0))]
        reading = LinearReading(BINARY64, LINEAR, unit=4.0, tiny=2.0**-10, at_zero=tuple(at_zero))
        assert reading.starts_at_identity is seen
    assert not LinearReading(BINARY64, LINEAR).starts_at_identity


@pytest.mark.parametrize(("jump", "tiny"), [(0.0019, 2.0**-60), (0.002, 2.0**-26)])
def test_rates_at_a_step_and_a_fourth_of_it_are_one_to_ten_bits(jump, tiny):
    def step(q, v, h):
        return q + h * v, v - h * q * (1 + jump * (abs(h) == 2.0**-60))

    assert read_linear_steps(opened(step)).tiny == tiny


# Sixteen roundings of 0.963, the largest number of the state and of the answer, are 15.4 units of the last place.
@pytest.mark.parametrize(("units", "kind"), [(15, LINEAR), (16, NOT_REPEATABLE)])
def test_the_same_step_repeats_to_a_few_roundings(units, kind):
    seen = []

    def step(q, v, h):
        seen.append((q, v, h) == (1 / 3, 0.7, 0.3))
        return q + 3 * h * v + units * 2.0**-53 * (seen[-1] and sum(seen) > 2), v - h * q

    assert read_linear_steps(opened(step)).kind == kind
