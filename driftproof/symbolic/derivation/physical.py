"""From a spring with mass, stiffness and length to the normalised oscillator, and back."""

from __future__ import annotations

from typing import NamedTuple

import sympy
from sympy import QQ, ring

from driftproof.methods.schemes import Method
from driftproof.methods.stepping import stepper
from driftproof.symbolic.derivation.one_step import StepPolynomial, rational


class Spring(NamedTuple):
    """A spring m x'' = -k x with displacement scale L; all three positive. Each is a SymPy symbol or number."""

    m: sympy.Expr
    k: sympy.Expr
    L: sympy.Expr

    @property
    def omega(self) -> sympy.Expr:
        """ω = sqrt(k/m), the angular frequency: dimensionless time is t = ω τ."""
        return sympy.sqrt(self.k / self.m)

    def state(self, x: sympy.Expr, velocity: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
        """(q, v) = (x / L, ẋ / (L ω)): both dimensionless."""
        return x / self.L, velocity / (self.L * self.omega)

    def energy(self, x: sympy.Expr, velocity: sympy.Expr) -> sympy.Expr:
        """½ m ẋ² + ½ k x², the physical energy, which is k L² times the normalised ½(q² + v²)."""
        return (self.m * velocity**2 + self.k * x**2) / 2

    def duration(self, h: sympy.Expr) -> sympy.Expr:
        """h / ω, the physical duration of a dimensionless step h."""
        return h / self.omega


def one_step_with_frequency(
    method: Method,
) -> tuple[tuple[StepPolynomial, StepPolynomial], tuple[StepPolynomial, StepPolynomial]]:
    """The rows of the one-step matrix for q' = v, v' = -ω² q, entries in Q[h, w] with w = ω."""
    frequency_ring, q, v, h, w = ring("q, v, h, w", QQ)
    step = stepper(method, lambda c: frequency_ring.ground_new(rational(c)))
    q1, v1 = step(lambda x: -(w**2) * x, q, v, h)
    return (q1.diff(q), q1.diff(v)), (v1.diff(q), v1.diff(v))
