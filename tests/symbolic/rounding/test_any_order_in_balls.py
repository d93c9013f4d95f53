"""The any-order bound in balls is that of the polynomials, and nothing where nothing is rounded."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, ctx

from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.rounding.any_evaluation_order import any_evaluation_order_bound
from driftproof.symbolic.rounding.any_order_in_balls import LinearSizes, any_order_columns, flushed_columns
from driftproof.symbolic.rounding.formats import BINARY16, BINARY64
from tests.looping import exactly

BITS = 320
STEPS = ((Q(1, 3), Q(3, 4), Q(7, 5)), (Q(2), Q(0), Q(1)), (Q(1, 1000), Q(1), Q(0)), (Q(1), Q(0), Q(0)))


def at(columns, h, q, v):
    return sum((column(enclose(h)) * enclose(x) for column, x in zip(columns, (q, v, Q(1)), strict=True)), arb(0))


@pytest.mark.parametrize("fmt", [BINARY64, BINARY16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", ["forward_euler", "velocity_verlet", "kutta3", "nystrom4"])
def test_the_bound_is_that_of_the_polynomials(key, fmt):
    bound = any_evaluation_order_bound(METHODS[key], fmt, multiplied_out=True)
    columns = any_order_columns(METHODS[key], fmt, BITS, fmt.eta / 2)
    with ctx.workprec(4 * BITS):
        for step in STEPS:
            for want, found in exactly(2, zip(bound.error_of(*step), columns, strict=True)):
                assert bool(abs(at(found, *step) - enclose(want)) <= enclose(want) * enclose(Q(1, 2**200)))


def test_flushing_costs_some_smallest_normal_numbers():
    lost = at(flushed_columns(METHODS["forward_euler"], BINARY64, BITS)[0], Q(1), Q(1), Q(1))
    assert bool(lost > enclose(Q(1, 2**1022)))
    assert bool(lost < enclose(Q(100, 2**1022)))


def test_what_is_quadratic_in_the_state_is_refused():
    q = LinearSizes(*(LinearSizes.constant(arb(1)).columns[i] for i in (2, 0, 0)))
    with pytest.raises(ValueError, match="depend on the state"):
        q * q
