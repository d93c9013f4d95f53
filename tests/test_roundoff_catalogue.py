"""Every explicit method of the catalogue, run in floats, stays within the bound derived from that float program."""

import random
from dataclasses import replace
from fractions import Fraction as Q

import numpy as np
import pytest

from methods.catalogue import METHODS
from methods.number_field import Algebraic
from methods.problems import oscillator
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from methods.stepping import stepper
from symbolic.n_steps import apply, exact_matrix_at
from symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from symbolic.rounding.overflow import largest_safe_state
from symbolic.rounding.sharp import sharp_bound

# No dyadic number, so that h times a coefficient really rounds.
STEP = 0.7
STATES = {BINARY64: 60, BINARY32: 30, BINARY16: 30}
TYPES = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}
# Tracing a program takes time with the square of its length: long ones are traced in binary64 only, unless asked for.
LONGEST = 8
SLOW = {"ssprk40_2"}


def is_explicit(method):
    return not isinstance(method, Collocation) and (isinstance(method, Splitting) or method.explicit)


EXPLICIT = [key for key, method in METHODS.items() if is_explicit(method)]


def length(method):
    return len(method.parts) // 2 if isinstance(method, Splitting) else method.stages


def cases(fmt):
    for key in EXPLICIT:
        slow = key in SLOW or (fmt != BINARY64 and length(METHODS[key]) > LONGEST)
        yield pytest.param(key, fmt, marks=pytest.mark.long if slow else (), id=f"{key}-{fmt.name}")


ALL_CASES = [case for fmt in TYPES for case in cases(fmt)]


def rounded(x):
    return tuple(map(rounded, x)) if isinstance(x, tuple) else Q(float(x)) if isinstance(x, Q | Algebraic) else x


def with_rounded_coefficients(method):
    """The definition whose exact coefficients are the doubles that the float program holds."""
    names = {RungeKutta: ("a", "b", "c"), Nystrom: ("a", "c", "b_position", "b_velocity"), Splitting: ("parts",)}
    changes = {name: rounded(getattr(method, name)) for name in names[type(method)]}
    if isinstance(method, RungeKutta):
        changes |= {"b_embedded": None, "embedded_order": None}
    return replace(method, **changes)


def states(seed, fmt, largest):
    """States of every exponent, subnormals and zeros among them, from which no operation overflows."""
    dtype, draw = TYPES[fmt], random.Random(seed)
    tiny = dtype(float(fmt.eta))
    found = [(dtype(1), dtype(0)), (dtype(0), dtype(-0.0)), (tiny, -tiny)]
    while len(found) < STATES[fmt]:
        pair = tuple(np.frombuffer(draw.randbytes(2 * dtype().itemsize), dtype))
        if all(np.isfinite(x) and abs(Q(float(x))) <= largest for x in pair):
            found.append(pair)
    return found


def worst_ratio(key, fmt, traced):
    """The largest error over bound that the drawn states show, both exact; `traced` is what the bound is derived from.

    The program holds each coefficient as a number of the format; the bound knows that number exactly.
    """
    dtype = TYPES[fmt]
    h = dtype(STEP)
    step, program = (
        stepper(METHODS[key], lambda c: dtype(float(c))),
        stepper(traced, lambda c: Q(float(dtype(float(c))))),
    )
    bound = sharp_bound(program, Q(float(h)), fmt)
    (qq, qv), (vq, vv) = bound.matrix
    worst = Q(0)
    for q, v in states(key, fmt, largest_safe_state(program, Q(float(h)), fmt)):
        start = Q(float(q)), Q(float(v))
        reached = (Q(float(x)) for x in step(oscillator, q, v, h))
        pairs = zip(reached, apply((qq, qv, vq, vv), *start), bound.error_of(*start), strict=True)
        worst = max(worst, *(abs(x - y) / limit if limit else abs(x - y) for x, y, limit in pairs))
    return worst


@pytest.mark.parametrize(("key", "fmt"), ALL_CASES)
def test_float_steps_stay_within_their_bound_at_every_scale(key, fmt):
    assert worst_ratio(key, fmt, METHODS[key]) <= 1


@pytest.mark.parametrize(("key", "fmt"), list(cases(BINARY64)))
def test_program_is_the_definition_with_its_coefficients_rounded(key, fmt):
    h = Q(1, 4)
    (qq, qv), (vq, vv) = sharp_bound(stepper(METHODS[key], float), h, fmt).matrix
    assert (qq, qv, vq, vv) == exact_matrix_at(with_rounded_coefficients(METHODS[key]), h)


def test_a_weight_wrong_in_the_thirteenth_digit_leaves_the_bound():
    dp = METHODS["dormand_prince54"]
    wrong = replace(dp, b=(dp.b[0] + Q(1, 10**13), *dp.b[1:]))
    assert worst_ratio("dormand_prince54", BINARY64, wrong) > 1
