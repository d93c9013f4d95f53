"""Floats emulated in exact arithmetic are the floats of this machine, bit for bit."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from driftproof.symbolic.rounding.formats import BINARY64
from tests.looping import exactly
from tests.witnesses.soft_float import NATIVE, SoftFloat, soft_lift
from tests.witnesses.worst_case import random_floats


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("fmt", "dtype"), NATIVE.items())
def test_soft_floats_agree_bit_for_bit_with_the_machine(fmt, dtype):
    rng = np.random.default_rng(2)
    xs, ys = (random_floats(rng, np.dtype(dtype), 1500) for _ in range(2))
    lift = soft_lift(fmt)
    operations = [lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x * y, lambda x, y: x / y, lambda x, y: -x]
    with np.errstate(all="ignore"):
        for x, y in exactly(1500, zip(xs, ys, strict=True)):
            for operate in operations:
                expected = operate(x, y)
                if np.isfinite(expected):
                    found = operate(lift(Fraction(float(x))), lift(Fraction(float(y))))
                    assert found.value == Fraction(float(expected))


def test_a_fusing_soft_float_rounds_a_product_and_its_sum_once():
    x, y = Fraction(1) + BINARY64.u * 2, Fraction(1) - BINARY64.u * 2
    fused, split = (soft_lift(BINARY64, fusing) for fusing in (True, False))
    assert (fused(x) * fused(y) - fused(Fraction(1))).value == -4 * BINARY64.u**2
    assert (split(x) * split(y) - split(Fraction(1))).value == 0
    assert (fused(Fraction(-1)) + fused(x) * fused(y)).value == -4 * BINARY64.u**2


def test_a_soft_float_takes_no_constant_that_it_does_not_know():
    with pytest.raises(TypeError, match="str"):
        SoftFloat(Fraction(1), BINARY64) + "1"
