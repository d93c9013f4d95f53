"""How far one step turns the state: the angle, its series in h, and the series of the damping."""

from __future__ import annotations

from typing import Any

import sympy
from sympy import QQ
from sympy.polys.matrices import DomainMatrix
from sympy.polys.ring_series import rs_atan, rs_log, rs_nth_root, rs_series_inversion, rs_trunc

from driftproof.symbolic.derivation.one_step import RING, H, Polynomial, determinant, expression, trace


def phase_per_step(m: DomainMatrix) -> sympy.Expr:
    """θ(h) = arccos(tr M / (2 sqrt(det M))), the eigenvalue angle in radians, in (0, π) where the roots are complex.

    Positive is clockwise, the direction of the exact flow, whose angle is h itself.
    """
    root = sympy.sqrt(expression(determinant(m)))
    return sympy.acos(sympy.expand(expression(trace(m)) / 2) / root)


def phase_error_series(m: DomainMatrix, terms: int) -> Polynomial:
    """θ(h) - h modulo h**terms, exact in Q[h]: negative leading coefficient means that the method lags.

    From tan θ = sqrt(det M - (tr M / 2)²) / (tr M / 2). Raises ValueError unless M(h) = I + hJ + O(h²).
    """
    half_trace = trace(m) / 2
    squared_sine = determinant(m) - half_trace**2  # h² (1 + ...) for a consistent method
    quotient, remainder = divmod(squared_sine, H**2)
    if remainder != 0 or quotient.evaluate(H, 0) != 1 or half_trace.evaluate(H, 0) != 1:
        raise ValueError("the step is not a consistent rotation: its angle is not h + O(h**2)")
    sine = H * rs_nth_root(quotient, 2, H, terms)
    tangent = rs_trunc(sine * rs_series_inversion(half_trace, H, terms), H, terms)
    return rs_atan(tangent, H, terms) - H


def damping_series(m: DomainMatrix, terms: int) -> Polynomial:
    """log ρ(h) = ½ log det M modulo h**terms, exact in Q[h]: the growth rate per step of the eigenvectors' radius."""
    return rs_log(determinant(m), H, terms) / 2


def leading_term(series: Polynomial) -> tuple[int, Any] | None:
    """(power, coefficient) of the lowest power of h in an element of Q[h]; None for zero."""
    if series == 0:
        return None
    (power,) = min(series.monoms())
    return power, series.coeff(H**power)


def sine_series(terms: int) -> Polynomial:
    """sin h modulo h**terms, in Q[h]."""
    return _exponential_part(terms, 1)


def cosine_series(terms: int) -> Polynomial:
    """cos h modulo h**terms, in Q[h]."""
    return _exponential_part(terms, 0)


def _exponential_part(terms: int, start: int) -> Polynomial:
    total = RING.zero
    for power in range(start, terms, 2):
        sign = -1 if power % 4 >= 2 else 1
        total += H**power * QQ(sign, int(sympy.factorial(power)))
    return total
