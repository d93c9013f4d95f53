"""The formats against the floats of this machine, and the model of rounding that every bound rests on."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from driftproof.symbolic.rounding.formats import (
    BFLOAT16,
    BINARY32,
    FloatFormat,
    exponent,
    is_power_of_two,
    power_of_two,
)
from tests.looping import exactly, some
from tests.witnesses.soft_float import NATIVE
from tests.witnesses.worst_case import random_floats

# Small enough to try every pair of numbers: 3 bits, exponents -2 to 2, so also subnormals.
TOY = FloatFormat("toy", 3, -2, 2)


def every_number(fmt: FloatFormat) -> list[Fraction]:
    """Every finite number of a small format, from its definition as multiples of a quantum."""
    numbers = {Fraction(0)}
    for e in range(fmt.emin, fmt.emax + 1):
        quantum = power_of_two(e - fmt.precision + 1)
        numbers |= {sign * n * quantum for n in range(1, 2**fmt.precision) for sign in (1, -1)}
    return sorted(numbers)


@pytest.mark.parametrize(("fmt", "dtype"), NATIVE.items())
def test_a_format_has_the_constants_of_the_machine_s_own_type(fmt, dtype):
    info = np.finfo(dtype)
    assert fmt.u == Fraction(float(info.eps)) / 2
    assert fmt.eta == Fraction(float(info.smallest_subnormal))
    assert fmt.largest == Fraction(float(info.max))


def test_bfloat16_is_binary32_cut_to_8_bits():
    assert (BFLOAT16.emin, BFLOAT16.emax, BFLOAT16.precision) == (BINARY32.emin, BINARY32.emax, 8)
    assert BFLOAT16.eta == Fraction(2) ** -133


@pytest.mark.parametrize(("fmt", "dtype"), list(NATIVE.items())[:2])
def test_nearest_rounds_as_the_machine_converts(fmt, dtype):
    with np.errstate(over="ignore"):
        for x in some(random_floats(np.random.default_rng(1), np.dtype(np.float64), 4000), 4000):
            converted = dtype(x)
            if np.isfinite(converted):
                assert fmt.nearest(Fraction(float(x))) == Fraction(float(converted))
            else:
                with pytest.raises(OverflowError, match=fmt.name):
                    fmt.nearest(Fraction(float(x)))


def test_nearest_is_the_closest_number_of_the_format_and_even_in_a_tie():
    numbers = every_number(TOY)
    for k in exactly(897, range(-64 * 7, 64 * 7 + 1)):
        x = Fraction(k, 64)
        rounded = TOY.nearest(x)
        distances = sorted((abs(x - number), number) for number in numbers)
        closest = [number for distance, number in distances if distance == distances[0][0]]
        assert rounded in closest
        if len(closest) == 2 and rounded != 0:
            quantum = power_of_two(max(exponent(rounded), TOY.emin) - TOY.precision + 1)
            assert rounded / quantum % 2 == 0


def test_overflow_begins_half_an_ulp_above_the_largest_number():
    half_ulp = power_of_two(TOY.emax - TOY.precision)
    assert TOY.nearest(TOY.largest + half_ulp - Fraction(1, 10**9)) == TOY.largest
    with pytest.raises(OverflowError):
        TOY.nearest(TOY.largest + half_ulp)


def test_every_pair_of_numbers_obeys_the_rounding_model_and_each_clause_is_needed():
    """The model that every bound rests on, by exhaustion: and without its eta, or with a smaller d, it is false."""
    d, eta, numbers = TOY.relative_error, TOY.eta, every_number(TOY)
    worst_sum, worst_product, underflows = Fraction(0), Fraction(0), 0
    for x, y in product(numbers, repeat=2):
        if 0 < abs(x + y) <= TOY.largest:
            worst_sum = max(worst_sum, abs(TOY.nearest(x + y) / (x + y) - 1))
        if 0 < abs(x * y) <= TOY.largest:
            error = abs(TOY.nearest(x * y) - x * y)
            assert error <= max(d * abs(x * y), eta / 2)
            underflows += error > d * abs(x * y)
            if is_power_of_two(x):
                assert error <= (0 if x.denominator == 1 else eta / 2)
            elif x.denominator == 1:
                assert error <= d * abs(x * y)
            worst_product = max(worst_product, error / eta if abs(x * y) < power_of_two(TOY.emin) else 0)
    assert worst_sum == d  # attained, so no smaller d would do, and sums need no eta
    assert worst_product == Fraction(1, 2)  # attained, so no smaller multiple of eta would do
    assert underflows > 0
