"""Rules about large and small states are told in words with their border, to the float."""

import random

import pytest

from tests.blackbox.checks.habits import bounded, code, plain, result, results_of


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
    assert seen.words.startswith(f"|v| is capped at {limit!r}" if limit > 1e-3 else "not tested: no step is short")
