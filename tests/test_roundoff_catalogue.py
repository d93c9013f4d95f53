"""Every explicit method of the catalogue, run in floats, stays within the bound derived from that float program."""

import random
import struct
from dataclasses import replace
from fractions import Fraction as Q
from math import isfinite

import pytest

from methods.catalogue import METHODS
from methods.number_field import Algebraic
from methods.problems import oscillator
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from methods.stepping import stepper
from symbolic.n_steps import apply, exact_matrix_at
from symbolic.rounding.overflow import largest_safe_state
from symbolic.rounding.sharp import sharp_bound

# No dyadic number, so that h times a coefficient really rounds.
STEP = 0.7
STATES = 60
# Forty stages take a quarter of a minute to trace; the other eighty methods take a few seconds together.
SLOW = {"ssprk40_2"}


def is_explicit(method):
    return not isinstance(method, Collocation) and (isinstance(method, Splitting) or method.explicit)


EXPLICIT = [key for key, method in METHODS.items() if is_explicit(method)]


def cases():
    return [pytest.param(key, marks=pytest.mark.long if key in SLOW else ()) for key in EXPLICIT]


def rounded(x):
    return tuple(map(rounded, x)) if isinstance(x, tuple) else Q(float(x)) if isinstance(x, Q | Algebraic) else x


def with_rounded_coefficients(method):
    """The definition whose exact coefficients are the doubles that the float program holds."""
    names = {RungeKutta: ("a", "b", "c"), Nystrom: ("a", "c", "b_position", "b_velocity"), Splitting: ("parts",)}
    changes = {name: rounded(getattr(method, name)) for name in names[type(method)]}
    if isinstance(method, RungeKutta):
        changes |= {"b_embedded": None, "embedded_order": None}
    return replace(method, **changes)


def states(seed, largest):
    """States of every exponent, subnormals and zeros among them, from which no operation overflows."""
    draw = random.Random(seed)
    found = [(1.0, 0.0), (0.0, -0.0), (5e-324, -5e-324)]
    while len(found) < STATES:
        pair = struct.unpack("<2d", draw.randbytes(16))
        if all(isfinite(x) and abs(Q(x)) <= largest for x in pair):
            found.append(pair)
    return found


def worst_ratio(key, h, bound_of):
    """The largest error over bound that the drawn states show, both exact; 0 where both vanish."""
    method = METHODS[key]
    step, bound = stepper(method, float), sharp_bound(stepper(bound_of, float), Q(h))
    (qq, qv), (vq, vv) = bound.matrix
    worst = Q(0)
    for q, v in states(key, largest_safe_state(step, Q(h))):
        exact = apply((qq, qv, vq, vv), Q(q), Q(v))
        pairs = zip(step(oscillator, q, v, h), exact, bound.error_of(Q(q), Q(v)), strict=True)
        worst = max(worst, *(abs(Q(x) - y) / limit if limit else abs(Q(x) - y) for x, y, limit in pairs))
    return worst


@pytest.mark.parametrize("key", cases())
def test_float_steps_stay_within_their_bound_at_every_scale(key):
    assert worst_ratio(key, STEP, METHODS[key]) <= 1


@pytest.mark.parametrize("key", cases())
def test_program_is_the_definition_with_its_coefficients_rounded(key):
    h = Q(1, 4)
    (qq, qv), (vq, vv) = sharp_bound(stepper(METHODS[key], float), h).matrix
    assert (qq, qv, vq, vv) == exact_matrix_at(with_rounded_coefficients(METHODS[key]), h)


def test_a_weight_wrong_in_the_thirteenth_digit_leaves_the_bound():
    dp = METHODS["dormand_prince54"]
    wrong = replace(dp, b=(dp.b[0] + Q(1, 10**13), *dp.b[1:]))
    assert worst_ratio("dormand_prince54", STEP, wrong) > 1
