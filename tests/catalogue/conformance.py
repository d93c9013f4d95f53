"""The arithmetics that every method has to meet, and what its step is held to in each: for test_conformance.py."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from flint import arb, ctx, fmpq

from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.programs.stepping import Lift, Number, oscillator, stepper
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.polynomials import ONE, X, scalar
from driftproof.symbolic.algebra.polynomials import coefficients as entry_coefficients
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.derivation.one_step import STATE_H, STATE_Q, STATE_RING, STATE_V, rational
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.rounding import polynomials
from driftproof.symbolic.rounding.fixed_step_bound import FixedStepBound, fixed_step_bound
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from driftproof.symbolic.rounding.number import Rounded, constant
from driftproof.symbolic.rounding.step_bound import StepBound, lift_to
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.changes import changed, coefficients
from tests.witnesses.soft_float import FORMATS
from tests.witnesses.witness_steps import Pair, as_function, stage_equations

# q, v and h, in the numbers of an arithmetic.
Start: TypeAlias = tuple[Number, Number, Number]


@dataclass(frozen=True)
class Arithmetic:
    """A kind of number, a start and a step of that kind, and what the result of one step has to be.

    `agrees(found, method)` holds `found`, what a step from `start(method)` gave, against the exact M(h) of `method`.
    A change of `notices` in one coefficient must be noticed. Explicit methods run their step; implicit ones, which
    have none, solve their stage equations, where the numbers form a field.
    """

    suits: Callable[[Method], bool]
    lift: Lift
    start: Callable[[Method], Start]
    agrees: Callable[[Pair, Method], bool]
    notices: Q = Q(1, 10**30)

    def meets(self, run: Method, defined: Method) -> bool:
        """The step of `run` gives what the one-step matrix of `defined` says; that of another method must not."""
        with ctx.workprec(BITS), np.errstate(over="ignore", invalid="ignore"):
            step = stepper(run, self.lift) if run.explicit else stage_equations(run, self.lift)
            return self.agrees(step(oscillator, *self.start(defined)), defined)


# --- exact numbers and balls ----------------------------------------------------------------------------------------

BITS = 300
STATE, STEP = (Q(1, 3), Q(-2, 5)), Q(1, 7)


def rational_start(_: Method) -> Start:
    return *STATE, STEP


def irrational_start(method: Method) -> Start:
    root = method.field.generator if method.field else square_root(2)
    return root / 3, 1 - root, STEP


def is_exact(start: Callable[[Method], Start]) -> Callable[[Pair, Method], bool]:
    def agrees(found: Pair, method: Method) -> bool:
        q, v, h = start(method)
        return found == apply(exact_matrix_at(method, h), q, v)

    return agrees


# A power of h that keeps what v puts into a polynomial apart from what q does.
APART = X**200


def is_matrix_of_polynomials(found: Pair, method: Method) -> bool:
    return [fraction(x) for x in found] == [qq + qv * fraction(APART) for qq, qv in oscillator_matrix(method)]


def sympy_lift(c: Any) -> Number:
    return STATE_RING.ground_new(rational(c))


def is_sympys_matrix(found: Pair, method: Method) -> bool:
    """The powers of (q, v, h) in the result, by SymPy, are those of the matrix, which is FLINT's."""
    for x, row in zip(found, oscillator_matrix(method), strict=True):
        expected = {
            (*state, k): scalar(c)
            for state, entry in zip(((1, 0), (0, 1)), row, strict=True)
            for k, c in enumerate(entry_coefficients(entry.num))
            if c != 0
        }
        if {powers: scalar(Q(int(c.numerator), int(c.denominator))) for powers, c in x.terms()} != expected:
            return False
    return True


def function_start(_: Method) -> Start:
    return fraction(1 + X), fraction(2 - X), fraction(X)


def is_product_of_functions(found: Pair, method: Method) -> bool:
    q, v, _ = function_start(method)
    return list(found) == [qq * q + qv * v for qq, qv in oscillator_matrix(method)]


def ball_start(_: Method) -> Start:
    return enclose(STATE[0]), enclose(STATE[1]), enclose(STEP)


def is_contained(found: Pair, method: Method) -> bool:
    """The exact result lies in each ball, which is narrow: a step loses less than half of the bits."""
    exact = apply(exact_matrix_at(method, STEP), *STATE)
    with ctx.workprec(2 * BITS):
        narrow = arb(2) ** (-BITS // 2)
        return all(x.contains(enclose(y)) and x.rad() < narrow for x, y in zip(found, exact, strict=True))


# --- floats, held to the bound that is derived from their own program -------------------------------------------------

FLOAT_STEP = 0.7  # no dyadic number, so that h times a coefficient really rounds
STATES = {BINARY64: 60, BINARY32: 30, BINARY16: 30}


def states_of_all_exponents(dtype: Any) -> Callable[[Method], Start]:
    """Arrays of states of every exponent, subnormals and zeros among them; another sample for each method."""
    fmt = FORMATS[dtype]

    def start(method: Method) -> Start:
        tiny, draw = float(fmt.eta), random.Random(method.key)
        bits = np.frombuffer(draw.randbytes(4 * STATES[fmt] * dtype().itemsize), dtype).reshape(2, -1)
        drawn = bits[:, np.isfinite(bits).all(axis=0)][:, : STATES[fmt]]
        q, v = np.concatenate([np.array([[1, 0, tiny], [0, -0.0, -tiny]], dtype), drawn], axis=1)
        return q, v, dtype(FLOAT_STEP)

    return start


def is_within_float_bound(dtype: Any) -> Callable[[Pair, Method], bool]:
    """Each result that is finite errs by no more than the bound derived from the program, both exact.

    The program is the definition with each coefficient a number of the format, which the bound knows exactly.
    Infinities and NaN pass through sums and products, so in a result that is finite nothing has overflowed.
    """

    def agrees(found: Pair, method: Method) -> bool:
        *start, h = states_of_all_exponents(dtype)(method)
        held = changed(method, {place: Q(float(dtype(float(c)))) for place, c in coefficients(method).items()})
        bound = float_bound(held, dtype)
        if [x for row in bound.matrix for x in row] != [scalar(x) for x in exact_matrix_at(held, Q(float(h)))]:
            return False
        states = [state for state in zip(*start, *found, strict=True) if np.isfinite(state).all()]
        assert len(states) > len(found[0]) // 2
        exact = ([fmpq(*float(x).as_integer_ratio()) for x in state] for state in states)
        return all(errs_less(bound, i, q, v, reached[i]) for q, v, *reached in exact for i in (0, 1))

    return agrees


@cache
def float_bound(held: Method, dtype: Any) -> FixedStepBound:
    """The bound of the program of these coefficients, in FLINT's rationals."""
    bound = fixed_step_bound(stepper(held, lambda c: c), Q(float(dtype(FLOAT_STEP))), FORMATS[dtype])
    matrix, leading, remainder = map(_in_flint, (bound.matrix, bound.leading, tuple(bound.remainder)))
    return replace(bound, matrix=matrix, leading=leading, remainder=remainder)


def _in_flint(x: Any) -> Any:
    return tuple(map(_in_flint, x)) if isinstance(x, tuple) else scalar(x)


def errs_less(bound: Any, i: int, q: fmpq, v: fmpq, found: fmpq) -> bool:
    """|found - (M z)ᵢ| <= what `FixedStepBound.error_of` says, once more for FLINT, ten times faster."""
    (error, underflow), (by_q, by_v) = bound.remainder, bound.matrix[i]
    largest = error[i][0] * abs(q) + error[i][1] * abs(v) + underflow[i]
    largest = sum((abs(a * q + b * v + c) for a, b, c in bound.leading[i]), largest)
    return bool(abs(found - by_q * q - by_v * v) <= largest)


def is_each_member(found: Pair, method: Method) -> bool:
    """An array steps to the same bits as its members, one by one; NaN has many bits."""
    q, v, h = states_of_all_exponents(np.float64)(method)
    step = stepper(method, np.float64)
    alone = np.array([step(oscillator, *state, h) for state in zip(q, v, strict=True)]).T
    together, numbers = np.array(found), ~np.isnan(found)
    return together[numbers].tobytes() == alone[~np.isnan(alone)].tobytes()


# --- error-bounding numbers -----------------------------------------------------------------------------------------

BOUNDED_STEP = Q(1, 4)


def bounding_start(_: Method) -> Start:
    q, v = (Rounded(BINARY64, generator) for generator in (polynomials.Q, polynomials.V))
    return q, v, constant(BOUNDED_STEP, BINARY64)


def is_exact_and_bounds_floats(found: Pair, method: Method) -> bool:
    """The exact part is the definition's, and a step in doubles errs by no more than the bound that comes with it.

    The bound counts the distance of each coefficient from the nearest double.
    """
    matrix = exact_matrix_at(method, BOUNDED_STEP)
    powers_of_state = [{powers[-2:]: c for powers, c in polynomials.terms(x.exact)} for x in found]
    if [row.get(column, 0) for row in powers_of_state for column in ((1, 0), (0, 1))] != list(matrix):
        return False
    q, v = 1.0, -0.7
    reached = stepper(method, float)(oscillator, q, v, float(BOUNDED_STEP))
    exact = apply(matrix, Q(q), Q(v))
    bounds = StepBound(BINARY64, found).error_of(BOUNDED_STEP, Q(q), Q(v))
    return all(-bound <= y - Q(x) <= bound for x, y, bound in zip(reached, exact, bounds, strict=True))


# --- the table ------------------------------------------------------------------------------------------------------


def every(_: Method) -> bool:
    return True


def implicit(method: Method) -> bool:
    return not method.explicit


def explicit(method: Method) -> bool:
    return method.explicit


def over_the_rationals(method: Method) -> bool:
    return method.field is None


def explicit_over_the_rationals(method: Method) -> bool:
    return method.explicit and method.field is None


def in_floats(dtype: Any, notices: Q) -> Arithmetic:
    start, agrees = states_of_all_exponents(dtype), is_within_float_bound(dtype)
    return Arithmetic(explicit, lambda c: dtype(float(c)), start, agrees, notices)


ARITHMETICS: dict[str, Arithmetic] = {
    "Fraction": Arithmetic(over_the_rationals, lambda c: c, rational_start, is_exact(rational_start)),
    "number field": Arithmetic(every, lambda c: c, irrational_start, is_exact(irrational_start)),
    "polynomials in h": Arithmetic(explicit, scalar, lambda _: (ONE, APART, X), is_matrix_of_polynomials),
    "SymPy's polynomials": Arithmetic(
        explicit_over_the_rationals, sympy_lift, lambda _: (STATE_Q, STATE_V, STATE_H), is_sympys_matrix
    ),
    "functions of h": Arithmetic(implicit, as_function, function_start, is_product_of_functions),
    "balls": Arithmetic(every, enclose, ball_start, is_contained),
    "float64": in_floats(np.float64, Q(1, 10**12)),
    "float32": in_floats(np.float32, Q(1, 10**4)),
    "float16": in_floats(np.float16, Q(1, 10)),
    "arrays": Arithmetic(explicit, np.float64, states_of_all_exponents(np.float64), is_each_member, Q(1, 10**12)),
    "error-bounding numbers": Arithmetic(explicit, lift_to(BINARY64), bounding_start, is_exact_and_bounds_floats),
}
