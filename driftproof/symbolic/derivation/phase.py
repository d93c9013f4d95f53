"""The angle by which one step turns the state, and its series in h."""

from __future__ import annotations

from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix
from sympy.polys.ring_series import rs_atan, rs_nth_root, rs_series_inversion, rs_trunc

from driftproof.symbolic.derivation.one_step import (
    H,
    MatrixEntry,
    StepPolynomial,
    determinant,
    expression,
    numerator_and_denominator,
    trace,
)


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
