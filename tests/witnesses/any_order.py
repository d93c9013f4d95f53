"""The any-order bound of a definition in polynomials: each monomial with the power of D that counts its roundings."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.schemes import Method
from driftproof.symbolic.rounding.any_evaluation_order import ErrorTally, MultipliedOutTally, size_of_coefficient
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat
from driftproof.symbolic.rounding.polynomials import D, ErrorPolynomial, H, Q, V, constant_polynomial, terms
from driftproof.symbolic.rounding.step_bound import Terms, at_state, at_step


class PolynomialTally(ErrorTally):
    """The tally in polynomials in D, |h|, |q|, |v|."""

    rounding = D
    __slots__ = ()


class MultipliedOutPolynomials(MultipliedOutTally, PolynomialTally):
    """The same where brackets may be multiplied out."""

    __slots__ = ()


@dataclass(frozen=True)
class AnyOrder:
    """Σ c ((1+d)^k - 1)|m| over the monomials c D^k m of `counted`, for dq and dv; `raised`: small factors raised."""

    format: FloatFormat
    counted: list[ErrorPolynomial]
    raised: list[ErrorPolynomial]

    @property
    def roundings(self) -> int:
        """The most roundings that a monomial passes, in any order."""
        return max(int(p.degrees()[0]) for p in self.counted)

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> list[Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        return [at_state(at_step(found, abs(h)), abs(q), abs(v)) for found in self.error_terms]

    @cached_property
    def error_terms(self) -> tuple[Terms, Terms]:
        """The bounds on |dq| and |dv| as polynomials in |h|, |q|, |v| in this format."""
        growth, loss = 1 + self.format.relative_error, 1 + self.format.eta / 2
        found: tuple[Terms, Terms] = ({}, {})
        for total, counted, raised in zip(found, self.counted, self.raised, strict=True):
            weighted = [(tuple(powers), c * (growth**k - 1)) for (k, _, *powers), c in terms(counted)]
            weighted += [(tuple(powers), c * (loss**k - 1) * growth**k) for (k, _, *powers), c in terms(raised)]
            for powers, c in weighted:
                total[powers] = total.get(powers, 0) + c
        return found


def any_order(method: Method, fmt: FloatFormat = BINARY64, *, multiplied_out: bool = False) -> AnyOrder:
    """The bound of every order of evaluation; with `multiplied_out` also of programs that multiply out brackets."""
    tally = MultipliedOutPolynomials if multiplied_out else PolynomialTally

    def sizes(q: Any, v: Any, h: Any, least: int) -> list[ErrorPolynomial]:
        def number(exact: Any) -> PolynomialTally:
            size = size_of_coefficient(exact, fmt)
            return tally(constant_polynomial(max(size, Fraction(least))) * D ** int(size != 1), factor=exact)

        return [x.finished for x in stepper(method, number)(oscillator, tally(q), tally(v), tally(h))]

    state = 1 + Q + V
    return AnyOrder(fmt, sizes(Q, V, H, 0), sizes(state, state, 1 + H, 1))
