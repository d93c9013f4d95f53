"""The grain on which numbers lie, and the narrowest format that holds them."""

import numpy as np
import pytest

from driftproof.blackbox.checks.quantisation import narrow_format, quantisation_of, significant_bits
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32

STATES = [0.7390851332151607, -123.45678901234567, 0.0009876543210987654, 5.551234567890123]


RULES = [
    (float, None, None),
    (round, 1.0, "answers are whole numbers"),
    (lambda x: round(x, 1), 0.1, "answers are rounded to 1 decimal"),
    (lambda x: round(x, 9), 1e-9, "answers are rounded to 9 decimals"),
    (lambda x: round(x, 11), 1e-11, "answers are rounded to 11 decimals"),
    (lambda x: round(x, 12), None, None),
    (lambda x: round(x * 2**20) / 2**20, 2.0**-20, "answers are multiples of 2**-20"),
    (lambda x: round(x * 2**40) / 2**40, 2.0**-40, "answers are multiples of 2**-40"),
    (lambda x: round(x * 2**41) / 2**41, None, None),
    (lambda x: float(np.float32(x)), None, None),
    (lambda x: float(np.float16(x)), None, None),
]


@pytest.mark.parametrize(("rule", "size", "words"), RULES, ids=range(len(RULES)))
def test_a_rule_that_rounds_is_seen_in_the_numbers(rule, size, words):
    grain = quantisation_of([float(rule(x)) for x in STATES])
    assert (grain and grain.size, grain and grain.words) == (size, words)


# Of four numbers with so many bits, 20 behind the point, the second says how many a small one has; zeros are left out.
BITS = [((19, 19, 24, 24), None), ((18, 19, 24, 24), None), ((18, 18, 24, 24), 2.0**-20), ((0, 0, 24), None)]


@pytest.mark.parametrize(("bits", "size"), BITS)
def test_small_numbers_with_as_many_bits_as_large_ones_are_those_of_a_format(bits, size):
    grain = quantisation_of([(2**n - 1) * 2.0**-20 for n in bits])
    assert (grain and grain.size) == size
    assert quantisation_of([2.0**23, -(2.0**1000)]) is None  # whole, as every float of such a size
    assert quantisation_of([2.0**23 - 1, -(2.0**40)]).size == 1


def test_a_narrower_format_is_seen_in_the_numbers():
    assert narrow_format([float(np.float32(x)) for x in STATES]) is BINARY32
    assert narrow_format([float(np.float16(x)) for x in STATES]) is BINARY16
    assert narrow_format(STATES) is None
    assert narrow_format([1.0, 2.0]) is None
    assert [significant_bits(x) for x in (0.0, 1.0, -0.75, 0.1, 2.0**-1074, 3 * 2.0**1000)] == [0, 1, 2, 52, 1, 2]
