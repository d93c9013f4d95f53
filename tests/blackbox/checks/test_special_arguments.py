"""Steps of 0, back in time, of NaN and of infinity, and the time that a stepper is told."""

import pytest

from tests.blackbox.checks.habits import DIVIDES_BY_H, assert_fault, code, identified

FAULTS = [
    (DIVIDES_BY_H, "zero_step", "h = 0 is divided by: it raises ZeroDivisionError"),
    (
        code("return q + h * v, v - np.float64(h * h * q) / np.float64(h)"),
        "zero_step",
        "h = 0 is divided by: (1.0, nan) comes back",
    ),
    (code("return plain(q, v, max(h, 0.0))"), "negative_step", "h < 0 does nothing: the state comes back"),
    (
        code("if abs(h) < 0.01: raise ValueError('too short')\nreturn plain(q, v, h) if h > 0 else (q + h * h, v)"),
        "negative_step",
        "h < 0 does something else than step back",
    ),
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
