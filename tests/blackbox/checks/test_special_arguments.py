"""Steps of 0, back in time, of NaN and of infinity, and the time that a stepper is told."""

import pytest

from tests.blackbox.checks.habits import (
    ABSOLUTE_STEP,
    DIVIDES_BY_H,
    FIXED_STEP,
    PENDULUM,
    POSITIVE_STEPS_ONLY,
    REPAIRS_NAN,
    assert_fault,
    code,
    identified,
    result,
)

FAULTS = [
    (DIVIDES_BY_H, "zero_step", "h = 0 is divided by: it raises ZeroDivisionError"),
    (
        code("return q + h * v, v - np.float64(h * h * q) / np.float64(h)"),
        "zero_step",
        "h = 0 is divided by: (1.0, nan) comes back",
    ),
    (FIXED_STEP, "zero_step", "h = 0 moves the state: (1.0, 0.75) becomes (1.0122222222222221, 0.73333333333"),
    (ABSOLUTE_STEP, "negative_step", "h < 0 acts as |h|"),
    (code("return plain(q, v, max(h, 0.0))"), "negative_step", "h < 0 does nothing: the state comes back"),
    (
        code("if abs(h) < 0.01: raise ValueError('too short')\nreturn plain(q, v, h) if h > 0 else (q + h * h, v)"),
        "negative_step",
        "h < 0 does something else than step back",
    ),
    (REPAIRS_NAN, "not_a_number", 'step(float("nan"), 0.75, 0.25) -> (0.0, 0.0)'),
    (REPAIRS_NAN, "not_a_number_step", "h = NaN goes in and ordinary numbers come out"),
    (
        code("return tuple(np.nan_to_num(x) for x in plain(q, v, h))"),
        "infinity",
        "an infinity goes in and ordinary numbers come out",
    ),
    (
        code("q, v = plain(y[0], y[1], h); return np.array([q, v + 1e-3 * h * math.sin(t)])", "t, y, h"),
        "time",
        "the answer depends on t: from the same state, t = 0 gives",
    ),
    (
        code("return y + h * f(0.0, y)", "f, t, y, h"),
        "time",
        "the right-hand side is told another time: from t = 8.0 with h = 0.25 it is asked",
    ),
]


@pytest.mark.parametrize(("step", "key", "words"), FAULTS, ids=identified)
def test_a_fault_is_told_in_words(step, key, words):
    assert_fault(step, key, words)


REFUSALS = [
    (POSITIVE_STEPS_ONLY, "zero_step", "h = 0 is refused: it raises ValueError: h must be positive"),
    (POSITIVE_STEPS_ONLY, "negative_step", "h < 0 is refused: it raises ValueError: h must be positive"),
    (PENDULUM, "infinity", "an infinity is refused: it raises ValueError"),
]


@pytest.mark.parametrize(("step", "key", "words"), REFUSALS, ids=identified)
def test_a_refusal_is_no_fault_and_said(step, key, words):
    seen = result(step, key)
    assert seen.holds is None
    assert words in seen.words
