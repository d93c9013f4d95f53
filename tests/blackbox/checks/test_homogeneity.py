"""A step is told to be linear, linear up to a border, or bent; and what becomes of the smallest numbers."""

import pytest

from tests.blackbox.checks.habits import assert_fault, code, identified, result, then

WRAPPED_PENDULUM = code(
    "q, v = plain(q, v - h * (math.sin(q) - q), h)\nreturn (q + math.pi) % (2 * math.pi) - math.pi, v"
)
FAULTS = [
    (
        then("q, v = (0.0 if abs(x) < 2.0**-1022 else x for x in (q, v))"),
        "subnormals",
        "subnormal numbers become 0: q below 2.37e-308",
    ),
    (
        then("q, v = (1.5 * x if abs(x) < 2.0**-1022 else x for x in (q, v))"),
        "subnormals",
        "q near 3.2e-311 has another answer",
    ),
    (WRAPPED_PENDULUM, "small_digits", "small states lose digits: the error stays at up to 4e-16"),
    (
        code("size = np.float64(q * q + v * v)\nq, v = plain(q / size, v / size, h)\nreturn q * size, v * size"),
        "rest",
        "(0, 0) has no answer: (nan, nan)",
    ),
]


@pytest.mark.parametrize(("step", "key", "words"), FAULTS, ids=identified)
def test_what_becomes_of_small_states_is_told(step, key, words):
    assert_fault(step, key, words)


NONLINEAR = [
    (WRAPPED_PENDULUM, "nonlinear: at q = 2.96 it departs from proportionality by 0.23"),
    (code("v = v - h * q * (1 + abs(q) ** 7.5); return q + h * v, v"), "nonlinear: at q = 0.739 it departs"),
    (code("v = v - h * q * (1 + abs(q) ** 7.75); return q + h * v, v"), "linear up to q = 0.0"),
    (
        code("q, v = plain(q, v, 1 / 60)\nreturn q, bounded(v, -100.0, 100.0)"),
        "linear up to v = 100 and no further; linear up to v = -100 and no further",
    ),
    (code("v = v - h * max(q, 0.0); return q + h * v, v"), "not linear: S(-z) is not -S(z)"),
    (
        code("return q + h * v, v - h * (q + 0.1 * math.sqrt(abs(q * v)))"),
        "not linear: S(q, v) is not S(q, 0) + S(0, v)",
    ),
]


@pytest.mark.parametrize(("step", "words"), NONLINEAR, ids=identified)
def test_a_nonlinear_step_is_told_from_one_that_is_cut_off(step, words):
    seen = result(step, "linear")
    assert (seen.holds, seen.is_fault) == (False, False)
    assert words in seen.words
