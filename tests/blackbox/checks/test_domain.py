"""Rules about large and small states are told in words with their border, to the float."""

import random

import pytest

from tests.blackbox.checks.habits import assert_fault, bounded, code, identified, plain, result, results_of, then

WRAPPED_ONCE = then("q = q - 2 * math.pi if q > math.pi else q + 2 * math.pi if q < -math.pi else q")
SQUARES = code(
    "size = math.sqrt(q * q + v * v); q, v = plain(q / size, v / size, h) if size else (0.0, 0.0); "
    "return size * q, size * v"
)
FAULTS = [
    (code("return plain(q, bounded(v, -100.0, 100.0), h)"), "velocity_range", "|v| is capped at 100"),
    (then("q = max(q, 0.0)"), "position_range", "q below 0 becomes 0"),
    (
        then("q, v = (3.0, 0.0) if q > 3.0 else (q, v)"),
        "position_range",
        "with q beyond 3 the state jumps to (3.0, 0.0)",
    ),
    (
        then("q = -9.25 if abs(q) > 9.25 else q"),
        "position_range",
        "q beyond 9.25 becomes -9.25; q below -9.25 becomes -9.25",
    ),
    (then("q = q % (2 * math.pi)"), "position_range", "with q from 2 pi on the state is changed at once"),
    (WRAPPED_ONCE, "position_range", "with |q| beyond pi the state is changed at once"),
    (then("q, v = (-q, -v) if q < 0 else (q, v)"), "position_range", "with q below 0 the state is changed at once"),
    (
        then("size = math.hypot(q, v); q, v = (q * 5 / size, v * 5 / size) if size > 5 else (q, v)"),
        "position_range",
        "the state is changed at once: (5.0, 0.375) becomes (4.98",
    ),
    (then("q, v = (0.0, 0.0) if q * q + v * v < 1e-6 else (q, v)"), "small_states", "becomes (0.0, 0.0)"),
    (
        code("if q > 5.0: raise ValueError('far')\nreturn plain(7.0 if q == 5.0 else q, v, h)"),
        "position_range",
        "with q from 5 on the state is changed at once: (5.0, 0.375) becomes (7.0, 0.375)",
    ),
    (SQUARES, "large_states", "overflows from q = 1.341e+154 on, where the answer is far from too large"),
]


@pytest.mark.parametrize(("step", "key", "words"), FAULTS, ids=identified)
def test_a_rule_is_told_in_words(step, key, words):
    assert_fault(step, key, words)


def test_a_refusal_is_no_fault_and_said():
    seen = result(code("if abs(q) >= 10: raise ValueError('out of range')\nreturn plain(q, v, h)"), "position_range")
    assert (seen.holds, seen.words) == (None, "|q| from 10 on is refused: it raises ValueError: out of range")


def test_a_strong_force_that_is_felt_far_out_is_no_rule():
    assert result(code("return q + h * v, v - 1e8 * h * q"), "position_range").holds


@pytest.mark.parametrize("limit", [random.Random(seed).lognormvariate(0, 30) for seed in range(6)])
def test_a_cap_of_any_size_is_found_to_the_float(limit):
    def capped(q, v, h):
        q, v = plain(q, v, h)
        return q, bounded(v, -limit, limit)

    seen = next(check for check in results_of(capped) if check.key == ("velocity_range" if limit > 1e-3 else "domain"))
    assert seen.words.startswith(f"|v| is capped at {limit!r}" if limit > 1e-3 else "not asked: there is no step")
