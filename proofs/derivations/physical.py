"""Conversion between a spring with mass, stiffness and length and the normalised oscillator."""

from __future__ import annotations

from typing import NamedTuple

import sympy
from sympy import QQ, ring

from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Method
from driftproof.symbolic.derivation.one_step import StepPolynomial, rational


class Spring(NamedTuple):
    """A spring m x'' = -k x with displacement scale L; all three positive. Each is a SymPy symbol or number."""

    m: sympy.Expr
    k: sympy.Expr
    L: sympy.Expr

    @property
    def omega(self) -> sympy.Expr:
        """The angular frequency ω = sqrt(k/m): dimensionless time is t = ω τ."""
        return sympy.sqrt(self.k / self.m)

    def state(self, x: sympy.Expr, velocity: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
        """The dimensionless state (q, v) = (x / L, ẋ / (L ω))."""
        return x / self.L, velocity / (self.L * self.omega)

    def energy(self, x: sympy.Expr, velocity: sympy.Expr) -> sympy.Expr:
        """The physical energy ½ m ẋ² + ½ k x², which is k L² times the normalised ½(q² + v²)."""
        return (self.m * velocity**2 + self.k * x**2) / 2

    def duration(self, h: sympy.Expr) -> sympy.Expr:
        """The physical duration h / ω of a dimensionless step size h."""
        return h / self.omega


def one_step_with_frequency(
    method: Method,
) -> tuple[tuple[StepPolynomial, StepPolynomial], tuple[StepPolynomial, StepPolynomial]]:
    """The rows of the one-step matrix for q' = v, v' = -ω² q, entries in Q[h, w] with w = ω."""
    frequency_ring, q, v, h, w = ring("q, v, h, w", QQ)
    step = stepper(method, lambda c: frequency_ring.ground_new(rational(c)))
    q1, v1 = step(lambda x: -(w**2) * x, q, v, h)
    return (q1.diff(q), q1.diff(v)), (v1.diff(q), v1.diff(v))
