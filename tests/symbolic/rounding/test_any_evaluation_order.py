"""The any-order bound of a definition: rearrangements of its sums and products are inside, other formulas are not."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from itertools import product

import pytest
from flint import arb, ctx

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.numeric.steppers import HAND_WRITTEN, rk4
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.rounding.any_evaluation_order import LinearSizes, any_order_columns, flushed_columns
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat
from driftproof.symbolic.rounding.step_bound import step_bound
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.looping import exactly
from tests.nine import NINE
from tests.symbolic.rounding.programs import all_within, covers, rk4_reassociated
from tests.witnesses.any_order import any_order
from tests.witnesses.leapfrog import leapfrog
from tests.witnesses.soft_float import soft_lift

COARSE = FloatFormat("coarse", 4, -3, 3)
BITS = 320
STEPS = ((Q(1, 3), Q(3, 4), Q(7, 5)), (Q(2), Q(0), Q(1)), (Q(1, 1000), Q(1), Q(0)), (Q(1), Q(0), Q(0)))


def rk4_multiplied_out(force, q, v, h):
    """q - (h h/2) q + ...: the one-step matrix entry by entry."""
    a, b = 1 - h * h / 2 + h * h * h * h / 24, h - h * h * h / 6
    return a * q + b * v, a * v - b * q


def rk4_with_a_detour(force, q, v, h):
    """The same polynomial, by way of a sum that is a million times larger and taken away again."""
    q1, v1 = rk4(force, q, v, h)
    large = 1000000 * q
    return (q1 + large) - large, v1


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", NINE)
def test_the_generic_and_the_hand_written_program_are_inside(key, fmt):
    bound = any_order(NINE[key], fmt)
    assert covers(bound, step_bound(NINE[key], fmt))
    if key in HAND_WRITTEN:
        assert covers(bound, step_bound(HAND_WRITTEN[key], fmt))


def test_a_reassociated_step_leaves_its_program_s_bound_but_not_the_definition_s():
    program, definition = step_bound(rk4), any_order(NINE["rk4"])
    other = step_bound(rk4_reassociated)
    assert covers(definition, other)
    at = Q(1, 4), Q(1), Q(1)
    assert other.error_of(*at) != program.error_of(*at)
    assert all_within(other.error_of(*at), definition.error_of(*at))


@pytest.mark.parametrize(
    ("step", "key"), [(rk4_with_a_detour, "rk4"), (rk4_multiplied_out, "rk4"), (leapfrog, "velocity_verlet")]
)
def test_a_program_that_multiplies_out_or_takes_a_detour_is_not_said_to_be_inside(step, key):
    """The same polynomial, but from other sums: here q passes one more addition than the definition has for it."""
    assert step_bound(step).differences(oscillator_matrix(NINE[key])) == []
    assert not covers(any_order(NINE[key]), step_bound(step))


@pytest.mark.parametrize("key", ["gill4", "mclachlan2"])
def test_it_covers_the_program_over_a_field_too(key: str):
    assert covers(any_order(METHODS[key]), step_bound(METHODS[key]))
    assert not covers(any_order(METHODS[key]), step_bound(METHODS["luther6"]))


def test_the_price_of_any_order_is_small():
    at = Q(1, 4), Q(1), Q(1)
    for key, factor in (("forward_euler", Q(1)), ("symplectic_euler", Q(1)), ("rk4", Q(5, 4))):
        own, every = (step_bound(HAND_WRITTEN[key]).error_of(*at)[0], any_order(NINE[key]).error_of(*at)[0])
        assert own <= every <= own * factor * (1 + 8 * BINARY64.u)


def test_a_sum_counts_the_most_additions_that_any_order_can_put_on_a_term():
    """RK4: coefficient, product, 3 additions, product by h, last addition for each of 4 slopes nested: 17 at most."""
    assert any_order(NINE["forward_euler"]).roundings == 2
    assert any_order(NINE["rk4"]).roundings == 17


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("fusing", [False, True])
@pytest.mark.parametrize("step", [rk4, rk4_reassociated, stepper(NINE["rk4"], lambda c: c)])
def test_no_coarse_float_state_leaves_it_in_any_order_fused_or_not(step, fusing):
    bound, lift = any_order(NINE["rk4"], COARSE), soft_lift(COARSE, fusing)
    numbers = [COARSE.nearest(Q(n, 8)) for n in range(-12, 13, 3)]
    for h, q, v in product((Q(1, 8), Q(3, 8), Q(7, 8)), numbers, numbers):
        floats = step(oscillator, lift(q), lift(v), lift(h))
        exact = stepper(NINE["rk4"], lambda c: c)(oscillator, q, v, h)
        assert all_within([abs(x.value - y) for x, y in zip(floats, exact, strict=True)], bound.error_of(h, q, v))


def test_a_program_that_multiplies_out_the_last_bracket_needs_the_wider_bound():
    heun, z, h = METHODS["heun2"], (1.9887002281591322, -128.0), 0.015625

    def multiplied_out(q, v, h):
        k1, k2 = (v, -q), (v - h * q, -(q + h * v))
        return q + h / 2 * k1[0] + h / 2 * k2[0], v + h / 2 * k1[1] + h / 2 * k2[1]

    exact = apply(exact_matrix_at(heun, Q(h)), *map(Q, z))
    errors = [abs(Q(x) - y) for x, y in zip(multiplied_out(*z, h), exact, strict=True)]
    narrow, wide = (any_order(heun, multiplied_out=wider).error_of(Q(h), *map(Q, z)) for wider in (False, True))
    assert errors[1] > narrow[1]
    assert all_within(errors, wide)
    assert all(x <= y <= 4 * x for x, y in zip(narrow, wide, strict=True))


# --- in balls, as it is used ---


def at(columns, h, q, v):
    return sum((column(enclose(h)) * enclose(x) for column, x in zip(columns, (q, v, Q(1)), strict=True)), arb(0))


@pytest.mark.parametrize("fmt", [BINARY64, BINARY16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", ["forward_euler", "velocity_verlet", "kutta3", "nystrom4"])
def test_the_bound_is_that_of_the_polynomials(key, fmt):
    bound = any_order(METHODS[key], fmt, multiplied_out=True)
    columns = any_order_columns(METHODS[key], fmt, BITS)
    with ctx.workprec(4 * BITS):
        for step in STEPS:
            for want, found in exactly(2, zip(bound.error_of(*step), columns, strict=True)):
                assert bool(abs(at(found, *step) - enclose(want)) <= enclose(want) * enclose(Q(1, 2 ** (BITS - 10))))


def test_too_few_bits_make_the_bound_wider_and_lose_nothing():
    """The differences drown in the balls, whose upper ends are then the bound."""
    coarse, fine = (any_order_columns(NINE["rk4"], BINARY16, bits) for bits in (1, 320))
    pairs = [
        (x[i], y[i])
        for rough, right in zip(coarse, fine, strict=True)
        for x, y in zip(rough, right, strict=True)
        for i in range(len(y))
    ]
    assert all(x.abs_upper() >= y.abs_lower() for x, y in exactly(30, pairs))


def test_flushing_costs_some_smallest_normal_numbers():
    lost = at(flushed_columns(METHODS["forward_euler"], BINARY64, BITS)[0], Q(1), Q(1), Q(1))
    assert bool(lost > enclose(Q(1, 2**1022)))
    assert bool(lost < enclose(Q(100, 2**1022)))
    columns = flushed_columns(METHODS["forward_euler"], BINARY64, BITS)[0]
    assert all(c.rel_accuracy_bits() > BITS - 10 for column in columns for c in column.coeffs() if c)


def test_what_is_quadratic_in_the_state_is_refused():
    q = LinearSizes(*(LinearSizes.constant(arb(1)).columns[i] for i in (2, 0, 0)))
    with pytest.raises(ValueError, match="depend on the state"):
        q * q


def test_a_coefficient_in_the_underflow_range_is_refused():
    tiny = replace(NINE["symplectic_euler"], parts=(("kick", Q(1, 10**6)), ("drift", Q(1))))
    assert len(any_order_columns(tiny, BINARY32, BITS)) == 2
    with pytest.raises(ValueError, match="the coefficient 1/1000000 is so small that it underflows in binary16"):
        any_order_columns(tiny, BINARY16, BITS)
