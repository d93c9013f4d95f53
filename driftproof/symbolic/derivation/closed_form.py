"""M to the N in closed form, in the symbols h and n."""

from __future__ import annotations

import sympy
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.derivation.one_step import determinant, entries, expression
from driftproof.symbolic.derivation.phase import phase_per_step

STEPS = sympy.Symbol("n", integer=True)


def closed_form(m: DomainMatrix) -> sympy.ImmutableMatrix:
    """Mⁿ = ρⁿ⁻¹ (sin(nθ) M - ρ sin((n-1)θ) I) / sin θ, with ρ = sqrt(det M): entries in the symbols h and n.

    Holds wherever the two roots are complex, so that 0 < θ < π. By Cayley-Hamilton and induction on n.
    """
    rho, theta = sympy.sqrt(expression(determinant(m))), phase_per_step(m)
    one_step = sympy.Matrix(2, 2, [expression(entry) for entry in entries(m)])
    turned = sympy.sin(STEPS * theta) * one_step - rho * sympy.sin((STEPS - 1) * theta) * sympy.eye(2)
    return sympy.ImmutableMatrix(rho ** (STEPS - 1) * turned / sympy.sin(theta))
