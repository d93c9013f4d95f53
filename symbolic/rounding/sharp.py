"""The sharper rounding bound for one given h: each rounding counted with the weight it really has in the result.

The error of a program obeys dx = sum of (partial derivative) times (operand's error) + own rounding + product of two
operands' errors, exactly. Solved backwards, the error of an output is the sum over all operations i of
adjoint_i * (own rounding_i + crossed_i), where adjoint_i is the derivative of the output by result i. The own rounding
is at most d|x_i| + d propagated_i + eta/2. The leading part d |adjoint_i x_i| is a number times |a q + b v| once h is
known, and keeps the cancellation inside a and b that the sum of |monomials| of `step` gives away; the rest is of
second order or underflow, where nothing is lost by bounding it as `step` does.

A product may be fused into some of the sums that use it and not into others, so its own rounding is weighed use by use,
without the cancellation between uses. Hence this form holds under fusing, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TypeAlias

from methods.problems import oscillator
from methods.stepping import Force
from symbolic.one_step import Polynomial
from symbolic.rounding.formats import BINARY64, FloatFormat
from symbolic.rounding.number import ETA, RING, D, Rounded, majorant
from symbolic.rounding.step import COLUMNS, LinearBound, demand_linear, linear_bound
from symbolic.rounding.trace import Subject, Terms, at_step, in_format, program, trace

# (a, b, c) of a form a q + b v + c.
Form: TypeAlias = tuple[Fraction, Fraction, Fraction]
Pair: TypeAlias = tuple[Fraction, Fraction]
_Derivatives: TypeAlias = list[tuple[Rounded, list[Polynomial]]]


@dataclass(frozen=True)
class SharpBound:
    """|dq| <= sum of |a q + b v + c| over `leading[0]` + the q row of `remainder`, and |dv| likewise, at this one h.

    d is multiplied in. `matrix` is M(h), row by row. Holds for every state for which nothing overflows.
    """

    format: FloatFormat
    h: Fraction
    matrix: tuple[Pair, Pair]
    leading: tuple[tuple[Form, ...], tuple[Form, ...]]
    remainder: LinearBound

    def error_of(self, q: Fraction, v: Fraction) -> Pair:
        """The bounds on |dq| and |dv| of one step from this very (q, v)."""
        dq, dv = (sum((abs(a * q + b * v + c) for a, b, c in forms), Fraction(0)) for forms in self.leading)
        rest = self.remainder.of(q, v)
        return dq + rest[0], dv + rest[1]

    def over_box(self, q: Fraction, v: Fraction) -> Pair:
        """The bounds on |dq| and |dv| of one step from any state with |q|, |v| at most these.

        `error_of` is convex in the state, so its largest values are at corners; it suffices to look at all four.
        """
        corners = [self.error_of(s * q, t * v) for s, t in product((1, -1), repeat=2)]
        return max(dq for dq, _ in corners), max(dv for _, dv in corners)

    @property
    def linear(self) -> LinearBound:
        """E and r with |dz| <= E|z| + r: the triangle inequality in each |a q + b v + c|."""
        rows = [
            [sum((abs(form[i]) for form in forms), Fraction(0)) + rest[i] for i in range(3)]
            for forms, rest in zip(self.leading, _rows(self.remainder), strict=True)
        ]
        (qq, qv, rq), (vq, vv, rv) = rows
        return LinearBound(((qq, qv), (vq, vv)), (rq, rv))


def sharp_bound(subject: Subject, h: Fraction, fmt: FloatFormat = BINARY64, force: Force = oscillator) -> SharpBound:
    """The sharper bound of one step at h, found by running the step with that h as the constant it is.

    Products with a power of two are then known to be exact. Raises ValueError if h is not a number of the format,
    NotLinear, RefusedOperation.
    """
    if not fmt.holds(h):
        raise ValueError(f"h = {h} is not a {fmt.name} number; the nearest is {fmt.nearest(h)}")
    outputs = trace(subject, fmt, force, h)
    derivatives = [_derivatives(output) for output in outputs]
    leading_q, leading_v = (_leading(by, fmt) for by in derivatives)
    rest_q, rest_v = (_remainder(by, fmt) for by in derivatives)
    row_q, row_v = (_form(_state_terms(output.exact, fmt)) for output in outputs)
    return SharpBound(fmt, h, (row_q[:2], row_v[:2]), (leading_q, leading_v), linear_bound(rest_q, rest_v))


def _derivatives(output: Rounded) -> _Derivatives:
    """Every number that the output depends on, with the derivative of the output by it, one part for each use of it."""
    order = program([output])
    by_use: dict[int, list[Polynomial]] = {id(x): [] for x in order}
    by_use[id(output)].append(RING.one)
    for x in reversed(order):
        # A negation has no rounding of its own: its uses are uses of its operand.
        parts = by_use[id(x)] if len(x.operands) == 1 else [sum(by_use[id(x)], RING.zero)]
        for operand, partial in x.operands:
            by_use[id(operand)] += [partial * part for part in parts]
    return [(x, by_use[id(x)]) for x in order]


def _leading(derivatives: _Derivatives, fmt: FloatFormat) -> tuple[Form, ...]:
    roundings: list[Polynomial] = []
    for x, uses in derivatives:
        own = D * x.exact if x.rounds else x.error if x.held is not None else RING.zero
        parts = uses if x.fusible else [sum(uses, RING.zero)]
        roundings += [own * part for part in parts]
    forms = (_form(_state_terms(polynomial, fmt)) for polynomial in roundings)
    return tuple(form for form in forms if any(form))


def _remainder(derivatives: _Derivatives, fmt: FloatFormat) -> Terms:
    rest = RING.zero
    for x, uses in derivatives:
        second_order = x.crossed + (D * x.propagated if x.rounds else RING.zero)
        own = second_order + (ETA / 2 if x.underflows else RING.zero)
        rest += own * sum((majorant(part) for part in uses), RING.zero)
    return _state_terms(rest, fmt)


def _state_terms(polynomial: Polynomial, fmt: FloatFormat) -> Terms:
    """The polynomial in (q, v) in this format; h does not occur, for it was a constant of the program."""
    return at_step(in_format(polynomial, fmt), Fraction(1))


def _form(terms: Terms) -> Form:
    demand_linear(terms)
    a, b, c = (terms.get(column, Fraction(0)) for column in COLUMNS)
    return a, b, c


def _rows(bound: LinearBound) -> tuple[Form, Form]:
    (qq, qv), (vq, vv) = bound.error
    return (qq, qv, bound.underflow[0]), (vq, vv, bound.underflow[1])
