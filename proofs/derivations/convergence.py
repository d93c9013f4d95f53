"""The error of one step, and at a fixed final time, as h goes to 0."""

from __future__ import annotations

from dataclasses import dataclass

import sympy
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.derivation.one_step import RING, H, StepPolynomial, entries, matrix
from driftproof.symbolic.derivation.phase import leading_term

J = sympy.ImmutableMatrix([[0, 1], [-1, 0]])
FINAL_TIME = sympy.Symbol("T")


def exact_flow_series(terms: int) -> DomainMatrix:
    """exp(hJ) = [[cos h, sin h], [-sin h, cos h]] modulo h**terms, over Q[h]."""
    c, s = _exponential_part(terms, 0), _exponential_part(terms, 1)
    return matrix([[c, s], [-s, c]])


def _exponential_part(terms: int, start: int) -> StepPolynomial:
    total = RING.zero
    for power in range(start, terms, 2):
        sign = -1 if power % 4 >= 2 else 1
        total += H**power * QQ(sign, int(sympy.factorial(power)))
    return total


def rotation(angle: sympy.Expr) -> sympy.ImmutableMatrix:
    """exp(angle·J), the exact flow over time `angle`: clockwise in the (q, v) plane."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    return sympy.ImmutableMatrix([[c, s], [-s, c]])


@dataclass(frozen=True)
class LocalError:
    """M(h) - exp(hJ) = C h**power + O(h**(power + 1)), with C != 0 a 2x2 rational matrix."""

    power: int
    coefficient: sympy.ImmutableMatrix

    @property
    def linear_order(self) -> int:
        """The order on this oscillator, power - 1. On nonlinear problems the order can be lower, never higher."""
        return self.power - 1


def local_error(m: DomainMatrix) -> LocalError:
    """The leading term of M(h) - exp(hJ), the error of one step that starts on the exact solution, for M over Q[h].

    There is one: exp(hJ) has every power of h, and M none above its degree.
    """
    terms = 3 + max(polynomial.degree() for polynomial in entries(m))
    difference = m - exact_flow_series(terms)
    power = min(leading[0] for polynomial in entries(difference) if (leading := leading_term(polynomial)))
    coefficients = [[RING.domain.to_sympy(entry.coeff(H**power)) for entry in row] for row in difference.to_list()]
    return LocalError(power, sympy.ImmutableMatrix(coefficients))


def global_error_coefficient(local: LocalError) -> sympy.ImmutableMatrix:
    """G(T) with M(h)ᴺ - exp(TJ) = G(T) hᵖ + O(hᵖ⁺¹) at fixed T = N h, entries in T, cos T, sin T.

    G(T) = ∫₀ᵀ exp((T-s)J) C exp(sJ) ds. The part C₊ of C that commutes with J leaves T exp(TJ) C₊, the part C₋
    that anticommutes leaves sin(T) C₋ (hairer-norsett-wanner-1993, II.3 and II.8).
    """
    c = local.coefficient
    conjugated = J * c * J  # = -c on the commuting part, +c on the anticommuting part
    commuting, anticommuting = (c - conjugated) / 2, (c + conjugated) / 2
    return sympy.ImmutableMatrix(FINAL_TIME * rotation(FINAL_TIME) * commuting + sympy.sin(FINAL_TIME) * anticommuting)
