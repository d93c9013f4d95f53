"""The tableau of a float code is read to the last bit, and where there is none, what was seen is said."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked


def read(step):
    return read_tableau(opened(step, "field"))


THREE_WAYS = [codes.rk4, codes.rk4_in_lists, codes.rk4_of_one_number]


@pytest.mark.parametrize("step", THREE_WAYS)
def test_rk4_shows_the_quotients_that_its_code_forms(step, as_before):
    asked = Asked(step)
    reading = read(asked.code)
    as_before(reading, asked)
    assert reading.c == (0.0, 0.5, 0.5, 1.0)
    assert reading.a == ((0.0,) * 4, (0.5, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))
    assert reading.b == (1 / 6, 2 / 6, 2 / 6, 1 / 6)
    assert reading.lines == [
        "c = 0, 1/2, 1/2, 1",
        "a[1] = 1/2",
        "a[2] = 0, 1/2",
        "a[3] = 0, 0, 1",
        "b = 1/6, 1/3, 1/3, 1/6",
    ]


coefficients = st.floats(-4, 4, allow_subnormal=False).filter(lambda x: x == 0 or abs(x) > 1e-6)


@st.composite
def tableaux(draw):
    stages = draw(st.integers(1, 6))
    rows = [draw(st.lists(coefficients, min_size=i, max_size=i)) for i in range(stages)]
    a = tuple((*row, *[0.0] * (stages - len(row))) for row in rows)
    b, c = (tuple(draw(st.lists(coefficients, min_size=stages, max_size=stages))) for _ in range(2))
    return a, b, c


@given(tableaux())
@settings(max_examples=40)
def test_any_tableau_comes_out_as_it_went_in(given_tableau):
    a, b, c = given_tableau
    reading = read(codes.tableau(a, b, c))
    assert (reading.a, reading.b, reading.c) == (a, b, c)


def test_a_code_that_passes_no_time_has_no_nodes_and_a_stopped_clock_has_zeros():
    without, stopped = read(codes.rk4_without_time), read(codes.rk4_on_a_stopped_clock)
    assert without.c is None
    assert "the right-hand side is given no time" in without.lines
    assert stopped.c == (0.0, 0.0, 0.0, 0.0)
    assert (without.a, without.b) == (stopped.a, stopped.b) == (read(codes.rk4).a, read(codes.rk4).b)


def test_the_call_for_the_next_step_is_seen_to_be_unused():
    reading = read(codes.dopri5)
    assert (reading.calls, reading.unused) == (7, (6,))
    assert "call 6 is made, and its answer is not used" in reading.lines
    assert reading.a[6][:6] == reading.b[:6]
    assert read(codes.rk4).unused == ()


@pytest.mark.parametrize(("kind", "fmt"), [(np.float32, BINARY32), (np.float16, BINARY16)])
def test_narrow_floats_are_read_as_they_are(kind, fmt, as_before):
    asked = Asked(codes.in_precision(codes.rk4, kind))
    reading = read(asked.code)
    as_before(reading, asked)
    assert reading.format == fmt
    assert reading.b == tuple(float(kind(x) / kind(6)) for x in (1, 2, 2, 1))
    assert "b = 1/6, 1/3, 1/3, 1/6" in reading.lines


def test_low_storage_and_convex_combinations_are_within_what_rounding_allows():
    assert read(codes.ssprk104_in_two_registers).calls == 10
    assert read(codes.ssprk33_in_convex_combinations).calls == 3


def iterated_to_the_end(f, t, y, h):
    k = f(t, y)
    for _ in range(100):
        before, k = k, f(t + h / 2, y + h / 2 * k)
        if np.max(np.abs(k - before)) < 1e-12:
            break
    return y + h * k


def adaptive(f, t, y, h):
    low, high = codes.euler(f, t, y, h), codes.heun(f, t, y, h)
    return high if np.max(np.abs(high - low)) < 1e-3 else codes.repeated(codes.heun, 2)(f, t, y, h)


class Remembering:
    """Calls its right-hand side once fewer from the second step on."""

    def __init__(self):
        self.last = None

    def __call__(self, f, t, y, h):
        k = f(t, y) if self.last is None else self.last
        y1 = y + h * k
        self.last = f(t + h, y1)
        return y + h / 2 * (k + self.last)


class Anticipating:
    """Starts from where the first slope of the step before would have led."""

    kept = 0.0

    def step(self, f, t, y, h):
        self.kept = first = f(t, y + h * self.kept)
        return y + h * f(t + h, y + h * first)


def without_h(f, t, y, h):
    return y + f(t, y)


def limited(f, t, y, h):
    return y + h * np.clip(f(t, y), -2, 2)


def slightly_nonlinear(f, t, y, h):
    k = f(t, y)
    return y + h * k + 1e-12 * h * k**3


def crossed(f, t, y, h):
    return y + h * f(t, y)[::-1]


def falling(f, t, y, h):
    return y + h * (f(t, y) - 9.81)


def endless(f, t, y, h):
    while True:
        f(t, y)


def wandering(f, t, y, h):
    return y * 0.99 + h * f(t, y)


def aware_of_the_time(f, t, y, h):
    return y + h * f(t, y) * (2 if t > 1 else 1)


NOT_READABLE = [
    (iterated_to_the_end, r"the number of calls depends on the answers: \d+, then \d+"),
    (adaptive, r"the number of calls depends on the answers: 3, then 7"),
    (Remembering(), "the same step of 2 calls taken twice is not the same"),
    (Anticipating().step, "call 1 or one before depends on the answer to call 1: the step remembers"),
    (without_h, "with h = 2, .* does not scale with h"),
    (slightly_nonlinear, "the step is not linear in them|does not scale|not linearly in their slopes"),
    (crossed, "the slope of one number of y moves another one"),
    (falling, "with all slopes 0, y = 0 does not stay"),
    (endless, "more than 200 calls"),
    (wandering, "with another start, .* depends on where it starts"),
    (aware_of_the_time, "with the time 7, .* depends on the time"),
    (codes.symplectic_euler_in_a_field, "the numbers of y are not stepped alike|moves another one"),
    (lambda f, t, y, h: y, "the right-hand side is never called"),
]


@pytest.mark.parametrize(("step", "words"), NOT_READABLE)
def test_what_is_no_runge_kutta_step_is_refused_with_what_was_seen(step, words, as_before):
    subject, asked = opened(codes.euler), Asked(step)
    subject.function = asked.code  # as `opened` would have it, without its trial step
    with pytest.raises(NotReadable, match=words) as refused:
        read_tableau(subject)
    as_before(refused.value, asked)


def test_a_step_with_a_limit_is_read_below_it_with_a_remark(as_before):
    subject, asked = opened(codes.euler), Asked(limited)
    subject.function = asked.code
    reading = read_tableau(subject)
    as_before(reading, asked)
    assert (reading.a, reading.b, reading.c) == (((0.0,),), (1.0,), (0.0,))
    assert reading.amplitude < 1
    assert "of size 1, with" in reading.remarks[0]


def test_a_step_that_ignores_the_sign_of_h_is_read_with_a_remark():
    reading = read(lambda f, t, y, h: codes.heun(f, t, y, abs(h)))
    assert reading.b == (0.5, 0.5)
    assert [line for line in reading.lines if "with h = -1" in line]
    assert read(codes.heun).remarks == ()


def test_a_step_that_refuses_to_go_back_is_read_with_a_remark():
    def step(f, t, y, h):
        if h < 0:
            raise ValueError("h must be positive")
        return codes.heun(f, t, y, h)

    assert "h must be positive" in read(step).remarks[0]


def test_other_conventions_have_no_right_hand_side():
    for step in (codes.velocity_verlet, lambda q, v, h: (q + h * v, v - h * q)):
        with pytest.raises(UnsupportedCall):
            read_tableau(opened(step))


def test_what_the_code_raises_passes_through():
    def step(f, t, y, h):
        if h == 3:
            raise RuntimeError("three")
        return codes.euler(f, t, y, h)

    with pytest.raises(Misbehaviour, match="RuntimeError: three"):
        read(step)
