"""The Nyström table of a float code is read to the last bit, as kicks and drifts where it is a composition of these."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked


def read(step):
    return read_forces(opened(step))


KICK_DRIFT = (("kick", 1.0), ("drift", 1.0))
HALVES = (("kick", 0.5), ("drift", 1.0), ("kick", 0.5))
AROUND = (("drift", 0.5), ("kick", 1.0), ("drift", 0.5))
SPLITTINGS = [
    (codes.symplectic_euler, KICK_DRIFT),
    (codes.velocity_from_positions, KICK_DRIFT),
    (codes.symplectic_euler_in_a_field, KICK_DRIFT),
    (codes.velocity_verlet, HALVES),
    (codes.velocity_verlet_by_acceleration, HALVES),
    (codes.position_verlet_calling_twice, AROUND),
]


@pytest.mark.parametrize(("step", "parts"), SPLITTINGS)
def test_sub_steps_are_seen_however_they_are_written(step, parts, as_before):
    asked = Asked(step)
    reading = read(asked.code)
    as_before(reading, *reading.lines, asked)
    assert reading.parts == parts
    assert reading.drift == 1
    assert reading.remarks == ()


coefficients = st.floats(-4, 4, allow_subnormal=False).filter(lambda x: abs(x) > 1e-3)
weights = st.lists(coefficients, min_size=4, max_size=4).map(tuple)


@given(weights, weights, weights, st.lists(weights, min_size=4, max_size=4))
@settings(max_examples=30)
def test_any_nystrom_table_comes_out_as_it_went_in(c, b_position, b_velocity, rows):
    a = tuple(tuple(x if j < i else 0.0 for j, x in enumerate(row)) for i, row in enumerate(rows))
    reading = read(codes.nystrom(c, a, b_position, b_velocity))
    assert (reading.c, reading.a, reading.drift) == (c, a, 1.0)
    assert (reading.b_position, reading.b_velocity) == (b_position, b_velocity)


@given(st.lists(coefficients, min_size=2, max_size=9), st.booleans())
@settings(max_examples=30)
def test_any_splitting_comes_out_as_it_went_in_up_to_rounding(numbers, kick_first):
    kinds = ("kick", "drift") if kick_first else ("drift", "kick")
    parts = [(kinds[i % 2], x) for i, x in enumerate(numbers)]
    seen = read(codes.composed(parts)).parts
    assert [kind for kind, _ in seen] == [kind for kind, _ in parts]
    for (kind, x), (_, y) in zip(seen, parts, strict=True):
        # A kick is read as it is; a drift is a product by the kick before it, over that kick: three roundings.
        assert abs(x - y) <= (0 if kind == "kick" else 4 * 2.0**-53 * abs(y))


def test_a_runge_kutta_code_shows_the_square_of_its_matrix_and_is_no_splitting():
    reading = read_forces(opened(codes.rk4, "field"))
    assert reading.c == (0.0, 0.5, 0.5, 1.0)
    assert reading.a[2:] == ((0.25, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0))
    assert reading.b_velocity == (1 / 6, 2 / 6, 2 / 6, 1 / 6)
    assert reading.parts is None
    assert any(line.startswith("b_position = 1/6, 1/6, 1/6") for line in reading.lines)


def test_a_table_one_rounding_off_a_splitting_is_one_and_one_off_by_1e_12_is_none():
    b = (0.5, 0.5)
    assert read(codes.nystrom((0.0, 1.0), ((0.0, 0.0), (np.nextafter(0.5, 1), 0.0)), (0.5, 0.0), b)).parts is not None
    assert read(codes.nystrom((0.0, 1.0), ((0.0, 0.0), (0.5 + 1e-12, 0.0)), (0.5, 0.0), b)).parts is None


def test_a_position_that_moves_by_half_is_said_to():
    reading = read(codes.half_moved)
    assert (reading.drift, reading.parts) == (0.5, (("kick", 1.0), ("drift", 0.5)))
    assert "without a force the position moves by 1/2 h v, not by h v" in reading.lines
    assert len(read(codes.symplectic_euler).lines) == 1


def test_a_call_for_the_next_step_is_seen_to_be_unused():
    def step(force, q, v, h):
        q, v = codes.symplectic_euler(force, q, v, h)
        force(q)
        return q, v

    reading = read(step)
    assert reading.unused == (1,)
    assert reading.lines == ["sub-steps: kick 1, drift 1", "call 1 is made, and its answer is not used"]


def with_drag(force, q, v, h):
    v = v * (1 - 0.04 * h) + h * force(q)
    return q + h * v, v


def with_a_spring(force, q, v, h):
    v = v + h * (force(q) - q)
    return q + h * v, v


def without_h(force, q, v, h):
    return q + v, v + h * force(q)


def with_h_squared_in_the_kick(force, q, v, h):
    v = v + h * h * force(q)
    return q + h * v, v


def limited(force, q, v, h):
    v = min(max(v + h * force(q), -2), 2)
    return q + h * v, v


def wrapped(force, q, v, h):
    v = v + h * force(q)
    return (q + h * v + 4) % 8 - 4, v


def heavy(force, q, v, h):
    v = v + h * (force(q) - 9.81)
    return q + h * v, v


def iterated(force, q, v, h):
    middle = q
    for _ in range(100):
        before, middle = middle, q + h / 2 * (v + h / 2 * force(middle))
        if abs(middle - before) < 1e-12:
            break
    return q + h * (v + h / 2 * force(middle)), v + h * force(middle)


class Remembering:
    """Verlet that keeps its last acceleration, whatever state it is given next."""

    def __init__(self):
        self.last = 0.0

    def __call__(self, force, q, v, h):
        v = v + h / 2 * self.last
        q = q + h * v
        self.last = force(q)
        return q, v + h / 2 * self.last


class Anticipating:
    """Starts from where the first force of the step before would have led."""

    kept = 0.0

    def step(self, force, q, v, h):
        self.kept = first = force(q + h * self.kept)
        return q + h * v, v + h * force(q + h * first)


NOT_READABLE = [
    (Anticipating().step, "call 1 or one before depends on the answer to call 1: the step remembers"),
    (with_drag, "the new velocity is 0.96 v, not 1 v"),
    (with_a_spring, "the new velocity holds -1 q, not 0 q"),
    (without_h, "with h = 2, the new position is .* does not scale with h"),
    (with_h_squared_in_the_kick, "with h = 2, the new .* does not scale with h"),
    (heavy, "at rest at 0 and without a force, the step does not stay"),
    (iterated, r"the number of calls depends on the answers: \d+, then \d+"),
    (Remembering(), "remembers"),
    (lambda force, q, v, h: (q + h * v, v), "the force is never called"),
]


@pytest.mark.parametrize(("step", "words"), NOT_READABLE)
def test_what_is_no_method_for_forces_is_refused_with_what_was_seen(step, words, as_before):
    subject, asked = opened(codes.symplectic_euler), Asked(step)
    subject.function = asked.code
    with pytest.raises(NotReadable, match=words) as refused:
        read_forces(subject)
    as_before(refused.value, asked)


@pytest.mark.parametrize("step", [limited, wrapped])
def test_a_step_with_a_limit_is_read_below_it_with_a_remark(step, as_before):
    subject, asked = opened(codes.symplectic_euler), Asked(step)
    subject.function = asked.code
    reading, free = read_forces(subject), read_forces(opened(codes.symplectic_euler))
    assert (reading.a, reading.b_velocity, reading.drift) == (free.a, free.b_velocity, free.drift)
    assert reading.amplitude < 1 == free.amplitude
    assert "of size 1, with" in reading.remarks[0]
    assert "where the coefficients read say" in reading.remarks[0]
    assert free.remarks == ()
    as_before(reading, asked)


def test_a_step_that_does_not_go_back_is_read_with_a_remark():
    reading = read(lambda force, q, v, h: codes.velocity_verlet(force, q, v, abs(h)))
    assert reading.parts == HALVES
    assert "with h = -1" in reading.lines[-1]


def test_a_map_has_no_force():
    with pytest.raises(UnsupportedCall):
        read_forces(opened(lambda q, v, h: (q + h * v, v - h * q)))


@pytest.mark.parametrize(
    ("times", "wrong"),
    [
        (lambda t, h: (t, t + h), ""),
        (lambda t, h: (t, t), "in a step of 1 from t = 0, call 1 asks at the time 0 for the position of the time 1"),
        (lambda t, h: (t, t + h * h),
            "in a step of 2 from t = 0, call 1 asks at the time 4 for the position of the time 2"),
        (lambda t, h: (0 * t, h),
            "in a step of 1 from t = 7, call 0 asks at the time 0 for the position of the time 7"),
    ],
)  # fmt: skip
def test_a_force_that_is_asked_at_another_time_than_its_position_has_is_told(times, wrong, as_before):
    def of_a_field(f, t, y, h):
        (q, v), (first, last) = y, times(t, h)
        v = v + h / 2 * f(first, [q, v])[1]
        q = q + h * v
        return [q, v + h / 2 * f(last, [q, v])[1]]

    def of_a_force(force, q, v, t, h):
        first, last = times(t, h)
        v = v + h / 2 * force(q, first)
        q = q + h * v
        return q, v + h / 2 * force(q, last)

    def time_first(force, t, q, v, h):
        return of_a_force(lambda q, t: force(t, q), q, v, t, h)

    for step in (of_a_field, of_a_force, time_first):
        reading = read(step)
        assert reading.wrong_time == wrong
        assert reading.parts == HALVES
        assert any("wrong times: " in line for line in reading.lines) == bool(wrong)
    asked = Asked(of_a_force)
    as_before(*read(asked.code).lines, asked)
