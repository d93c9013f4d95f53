"""How a method treats a stiff problem with a smooth solution: the functions of Prothero and Robinson."""

from __future__ import annotations

from math import factorial

from flint import fmpq

from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.polynomials import ONE, X
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.linear.stability_function import resolvent
from driftproof.symbolic.linear.tableaux import tableau


def prothero_robinson(method: RungeKutta | Collocation, power: int) -> RationalFunction:
    """ψₖ(z) for k = `power` >= 1: on y' = λ(y - φ(t)) + φ'(t), started at φ(t), φ(t + h) - y₁ = Σₖ ψₖ(hλ) hᵏ φ⁽ᵏ⁾(t).

    ψₖ = (z bᵀ(I - zA)⁻¹(cᵏ/k - A cᵏ⁻¹) + 1/k - bᵀcᵏ⁻¹) / (k - 1)! (hairer-wanner-1996, IV.15). It vanishes for k up
    to the stage order; where it does not and k <= order, the order is reduced on stiff problems.
    """
    if power < 1:
        raise ValueError(f"power = {power}; the functions are numbered from 1")
    data = tableau(method)
    nodes = data.power(power - 1)
    defects = [x / power - y for x, y in zip(data.power(power), data.applied(nodes), strict=True)]
    quadrature = fraction(ONE * (fmpq(1, power) - data.weighed(nodes)))
    total = quadrature + fraction(X) * resolvent(data, defects) if any(d != 0 for d in defects) else quadrature
    return total * fraction(ONE / factorial(power - 1))
