"""The sharper rounding bound for one given h: each rounding error is multiplied by its actual weight in the result.

The error of a program obeys dx = sum of (partial derivative) times (operand's error) + own rounding + product of two
operands' errors, exactly. Solved backwards, the error of an output is the sum over all operations i of
adjoint_i * (own rounding_i + crossed_i), where adjoint_i is the derivative of the output by result i. The own rounding
is at most d|x_i| + d propagated_i + eta/2. The leading part d |adjoint_i x_i| is a number times |a q + b v| once h is
known, and keeps the cancellation inside a and b that the sums of |monomials| in `step_bound` lose; the rest is of
second order or underflow, where nothing is lost by bounding it as `step_bound` does. Irrational a and b are replaced by
rationals near them; the distance goes into the rest.

A product may be fused into some of the sums that use it and not into others, so its own rounding is weighted use by
use, without cancellation between uses. Hence the bound also holds under fusing.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import Force, oscillator
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat
from driftproof.symbolic.rounding.number import Rounded
from driftproof.symbolic.rounding.polynomials import ETA, ONE, ZERO, D, ErrorPolynomial, majorant, near_rational, terms
from driftproof.symbolic.rounding.step_bound import (
    LinearBound,
    StepOrMethod,
    Terms,
    linear_bound,
    linear_form,
    operations_of,
    require_linear,
    state_terms,
    trace_step,
)

# (a, b, c) of a form a q + b v + c.
Form: TypeAlias = tuple[Fraction, Fraction, Fraction]
_Derivatives: TypeAlias = list[tuple[Rounded, list[ErrorPolynomial]]]


@dataclass(frozen=True)
class FixedStepBound:
    """|dq| <= sum of |a q + b v + c| over `leading[0]` + the q row of `remainder`, and |dv| likewise, at this one h.

    The forms include the factor d. `matrix` is the exact M(h) by rows. The bound holds unless something overflows.
    """

    format: FloatFormat
    h: Fraction
    matrix: tuple[tuple[Exact, Exact], tuple[Exact, Exact]]
    leading: tuple[tuple[Form, ...], tuple[Form, ...]]
    remainder: LinearBound

    def error_of(self, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from this (q, v)."""
        dq, dv = (sum((abs(a * q + b * v + c) for a, b, c in forms), Fraction(0)) for forms in self.leading)
        rest = self.remainder.of(q, v)
        return dq + rest[0], dv + rest[1]

    @property
    def linear(self) -> LinearBound:
        """E and r with |dz| <= E|z| + r: the triangle inequality in each |a q + b v + c|."""
        rests = [(*error, free) for error, free in zip(*self.remainder, strict=True)]
        rows = [
            [sum((abs(form[i]) for form in forms), Fraction(0)) + rest[i] for i in range(3)]
            for forms, rest in zip(self.leading, rests, strict=True)
        ]
        (qq, qv, rq), (vq, vv, rv) = rows
        return LinearBound(((qq, qv), (vq, vv)), (rq, rv))


def fixed_step_bound(
    subject: StepOrMethod, h: Fraction, fmt: FloatFormat = BINARY64, force: Force = oscillator
) -> FixedStepBound:
    """The sharper bound of one step at h, found by running the step with h as a constant.

    Products with h are then known to be exact if h is a power of two. Raises ValueError if h is not a number of the
    format, NotLinear, RefusedOperation.
    """
    if not fmt.holds(h):
        raise ValueError(f"h = {h} is not a {fmt.name} number; the nearest is {fmt.nearest(h)}")
    outputs = trace_step(subject, fmt, force, h)
    (leading_q, rest_q), (leading_v, rest_v) = (_parts(output, fmt) for output in outputs)
    row_q, row_v = (_row(output.exact) for output in outputs)
    return FixedStepBound(fmt, h, (row_q, row_v), (leading_q, leading_v), linear_bound(rest_q, rest_v))


def _parts(output: Rounded, fmt: FloatFormat) -> tuple[tuple[Form, ...], Terms]:
    """The leading forms and the rest of one output."""
    derivatives = _derivatives(output)
    roundings = [near_rational(rounding) for rounding in _roundings(derivatives)]
    forms = (linear_form(state_terms(middle, fmt)) for middle, _ in roundings)
    rest = _remainder(derivatives) + sum((radius for _, radius in roundings), ZERO)
    return tuple(form for form in forms if any(form)), state_terms(rest, fmt)


def _derivatives(output: Rounded) -> _Derivatives:
    """Every number that the output depends on, with the derivative of the output by it, split into its uses."""
    order = operations_of([output])
    by_use: dict[int, list[ErrorPolynomial]] = {id(x): [] for x in order}
    by_use[id(output)].append(ONE)
    for x in reversed(order):
        # A negation has no rounding of its own: its uses are uses of its operand.
        parts = by_use[id(x)] if len(x.operands) == 1 else [sum(by_use[id(x)], ZERO)]
        for operand, partial in x.operands:
            by_use[id(operand)] += [partial * part for part in parts]
    return [(x, by_use[id(x)]) for x in order]


def _roundings(derivatives: _Derivatives) -> list[ErrorPolynomial]:
    """The leading part of each operation's own rounding error, multiplied by its weight in the output."""
    roundings: list[ErrorPolynomial] = []
    for x, uses in derivatives:
        own = D * x.exact if x.rounds else x.error if x.stored_value is not None else ZERO
        parts = uses if x.may_fuse else [sum(uses, ZERO)]
        roundings += [own * part for part in parts]
    return roundings


def _remainder(derivatives: _Derivatives) -> ErrorPolynomial:
    rest = ZERO
    for x, uses in derivatives:
        second_order = x.crossed + (D * x.propagated if x.rounds else ZERO)
        own = second_order + (ETA / 2 if x.underflows else ZERO)
        rest += own * sum((majorant(part) for part in uses), ZERO)
    return rest


def _row(exact: ErrorPolynomial) -> tuple[Exact, Exact]:
    by_state = {(in_q, in_v): c for (_, _, _, in_q, in_v), c in terms(exact)}
    require_linear(by_state)
    return by_state.get((1, 0), Fraction(0)), by_state.get((0, 1), Fraction(0))
