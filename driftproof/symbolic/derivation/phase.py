"""The angle by which one step turns the state, its series in h, and the powers of M in closed form."""

from __future__ import annotations

from typing import Any

import sympy
from sympy import QQ
from sympy.polys.matrices import DomainMatrix
from sympy.polys.ring_series import rs_atan, rs_nth_root, rs_series_inversion, rs_trunc

from driftproof.symbolic.derivation.formulas import as_matrix
from driftproof.symbolic.derivation.one_step import (
    RING,
    H,
    MatrixEntry,
    StepPolynomial,
    determinant,
    expression,
    numerator_and_denominator,
    trace,
)

STEPS = sympy.Symbol("n", integer=True)


def phase_per_step(m: DomainMatrix) -> sympy.Expr:
    """θ(h) = arccos(tr M / (2 sqrt(det M))), the eigenvalue angle in radians, in (0, π) where the roots are complex.

    Positive is clockwise, the direction of the exact flow, whose angle is h itself.
    """
    root = sympy.sqrt(expression(determinant(m)))
    return sympy.acos(sympy.expand(expression(trace(m)) / 2) / root)


def phase_error_series(m: DomainMatrix, terms: int) -> StepPolynomial:
    """θ(h) - h modulo h**terms, exact in Q[h]; a negative leading coefficient means that the method lags.

    It comes from tan θ = sqrt(det M - (tr M / 2)²) / (tr M / 2). Raises ValueError unless θ(h) = h + O(h²).
    """
    longer = terms + 2  # two terms are lost in the division by h²
    half_trace, area = (_series(f, longer) for f in (trace(m) / 2, determinant(m)))
    squared_sine = rs_trunc(area - half_trace**2, H, longer)  # h² (1 + ...) for a consistent method
    quotient, remainder = divmod(squared_sine, H**2)
    if remainder or quotient.evaluate(H, 0) != 1 or half_trace.evaluate(H, 0) != 1:
        raise ValueError("the step does not turn by an angle h + O(h**2), as a consistent method does")
    sine = H * rs_nth_root(quotient, 2, H, terms)
    tangent = rs_trunc(sine * rs_series_inversion(half_trace, H, terms), H, terms)
    return rs_atan(tangent, H, terms) - H


def _series(f: MatrixEntry, terms: int) -> StepPolynomial:
    """The series of `f` modulo h**terms, for an `f` without a pole at h = 0."""
    top, bottom = numerator_and_denominator(f)
    return rs_trunc(top * rs_series_inversion(bottom, H, terms), H, terms)


def leading_term(series: StepPolynomial) -> tuple[int, Any] | None:
    """(power, coefficient) of the lowest power of h in an element of Q[h]; None for zero."""
    if not series:
        return None
    (power,) = min(series.monoms())
    return power, series.coeff(H**power)


def sine_series(terms: int) -> StepPolynomial:
    """sin h modulo h**terms, in Q[h]."""
    return _exponential_part(terms, 1)


def cosine_series(terms: int) -> StepPolynomial:
    """cos h modulo h**terms, in Q[h]."""
    return _exponential_part(terms, 0)


def closed_form(m: DomainMatrix) -> sympy.ImmutableMatrix:
    """Mⁿ = ρⁿ⁻¹ (sin(nθ) M - ρ sin((n-1)θ) I) / sin θ, with ρ = sqrt(det M): entries in the symbols h and n.

    It holds wherever the two roots are complex, so that 0 < θ < π, by the Cayley-Hamilton theorem and induction on n.
    """
    rho, theta = sympy.sqrt(expression(determinant(m))), phase_per_step(m)
    turned = sympy.sin(STEPS * theta) * as_matrix(m) - rho * sympy.sin((STEPS - 1) * theta) * sympy.eye(2)
    return sympy.ImmutableMatrix(rho ** (STEPS - 1) * turned / sympy.sin(theta))


def _exponential_part(terms: int, start: int) -> StepPolynomial:
    total = RING.zero
    for power in range(start, terms, 2):
        sign = -1 if power % 4 >= 2 else 1
        total += H**power * QQ(sign, int(sympy.factorial(power)))
    return total
