"""The rounding bound of a definition: valid for every order in which its sums and products are evaluated.

A program made of +, -, * and constants returns the sum of its monomials, each multiplied by one factor (1 + a),
|a| <= d, for each rounding that it passes. A product passes on the counts of its two factors, added, and one more; in
a sum of n terms, no order takes a term through more than n - 1. So a monomial m errs by at most ((1+d)^k - 1)|m| with a
k that no order exceeds, and no monomial is cancelled against another. Underflow adds at most eta/2 at each of the at
most k products in m, times the factors still to come: together at most ((1+eta/2)^k - 1)(1+d)^k times m with each
factor that may be below 1 raised (constants to 1, |h| to 1 + |h|, the state to 1 + |q| + |v|).
Fusing a product into a sum only drops factors.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from methods.schemes import Method
from symbolic.float_formats import BINARY64, FloatFormat
from symbolic.one_step import Polynomial
from symbolic.roundoff import StepBound
from symbolic.roundoff_number import ETA, RING, D, H, Q, Rounded, V, majorant
from symbolic.roundoff_trace import Terms, at_state, at_step, in_format, program, trace


@dataclass(frozen=True)
class AnyOrderBound:
    """|fl(step(z)) - M(h) z| <= `errors`, bounds for |dq| and |dv| in Q[d, eta, |h|, |q|, |v|].

    Holds for every program that associates and commutes the definition's sums and products as it likes, fuses them or
    not, and rounds each coefficient; no monomial passes more than `roundings`. Whether some other program is inside,
    one that multiplies out a bracket say, is for `covers` to decide.
    """

    format: FloatFormat
    roundings: int
    errors: tuple[Polynomial, Polynomial]

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        dq, dv = (at_state(at_step(terms, abs(h)), abs(q), abs(v)) for terms in self._terms)
        return dq, dv

    def covers(self, bound: StepBound) -> bool:
        """True when a program's own bound is nowhere above this one: coefficient by coefficient, so for all h, q, v."""
        own = [in_format(x.error, bound.format) for x in bound.outputs]
        return bound.format == self.format and all(
            coefficient <= mine.get(powers, 0)
            for theirs, mine in zip(own, self._terms, strict=True)
            for powers, coefficient in theirs.items()
        )

    @cached_property
    def _terms(self) -> list[Terms]:
        return [in_format(error, self.format) for error in self.errors]


def any_order_bound(method: Method, fmt: FloatFormat = BINARY64) -> AnyOrderBound:
    """The any-order bound of a definition. Raises MethodError for an implicit method."""
    tally_q, tally_v = (_tally_of(output) for output in trace(method, fmt))
    roundings = max(tally_q.finished.degree(D), tally_v.finished.degree(D))
    return AnyOrderBound(fmt, int(roundings), (_error(tally_q), _error(tally_v)))


class _Tally(NamedTuple):
    """Sums of |monomials|, as they are and with small factors raised; a power of D counts a monomial's roundings.

    Still to be counted are the `additions` of the sum that ends here: any term may be the one that passes them all.
    """

    plain: Polynomial
    raised: Polynomial
    additions: int = 0

    @property
    def finished(self) -> Polynomial:
        """`plain` with the additions counted."""
        return self.plain * D**self.additions

    @property
    def finished_raised(self) -> Polynomial:
        """`raised` with the additions counted."""
        return self.raised * D**self.additions


def _tally_of(output: Rounded) -> _Tally:
    found: dict[int, _Tally] = {}
    for x in program([output]):
        found[id(x)] = _tally(x, [found[id(operand)] for operand, _ in x.operands])
    return found[id(output)]


def _tally(x: Rounded, operands: list[_Tally]) -> _Tally:
    if not operands:
        return _leaf(x)
    if len(operands) == 1:  # a negation
        return operands[0]
    a, b = operands
    if not x.fusible:
        return _Tally(a.plain + b.plain, a.raised + b.raised, a.additions + b.additions + 1)
    for (factor, _), other in zip(x.operands, (b, a), strict=True):
        if factor.held in (1, -1):  # no product at all: a sum behind it may be merged with the sum before it
            return other
    return _Tally(D * a.finished * b.finished, D * a.finished_raised * b.finished_raised)


def _leaf(x: Rounded) -> _Tally:
    size = majorant(x.exact)
    if x.held is None:
        return _Tally(size, 1 + H if size == H else 1 + Q + V)
    # A coefficient that this format holds may be another program's rounded one.
    count = RING.one if size == 1 else D
    return _Tally(count * size, count * max(size.LC, 1))


def _error(tally: _Tally) -> Polynomial:
    error = RING.zero
    for (k, *powers), c in tally.finished.terms():
        error += ((1 + D) ** k - 1) * RING({(0, *powers): c})
    for (k, *powers), c in tally.finished_raised.terms():
        error += ((1 + ETA / 2) ** k - 1) * (1 + D) ** k * RING({(0, *powers): c})
    return error
