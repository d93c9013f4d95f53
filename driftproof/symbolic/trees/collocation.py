"""The order of collocation from its nodes' polynomial M(x) = Π (x - cᵢ) over Q alone: no node is ever computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

from flint import fmpq, fmpq_poly

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.weights import distinct_nodes


@dataclass(frozen=True)
class QuadratureFact:
    """Order s + k and not s + k + 1: ∫₀¹ M(x) xʲ dx = 0 for j < k, and `residual`, not zero, for j = k, M monic.

    The residual is also what 1/(p + 1) has beyond the quadrature formula's value for the first power it misses, xᵖ.
    """

    order: int
    residual: Fraction


def collocation_order(nodes: Sequence[Exact]) -> QuadratureFact:
    """The order of the collocation method at the roots of M, which is that of its quadrature formula, s + k.

    M is orthogonal on [0, 1] to k powers (hairer-lubich-wanner-2006, II.1.2 Theorem 1.5); Gauss has k = s.
    `nodes` is M's coefficients, constant term first. Raises ValueError if M is constant or has a multiple root.
    """
    polynomial = distinct_nodes(nodes)
    power = fmpq_poly([0, 1])
    for k in count():  # ends at k = s, since M is not orthogonal to itself
        moment = (polynomial * power**k).integral()(1)
        if moment != 0:
            return QuadratureFact(int(polynomial.degree()) + k, _fraction(moment / polynomial.leading_coefficient()))
    raise AssertionError("unreachable: count has no end")


def _fraction(x: fmpq) -> Fraction:
    return Fraction(int(x.numerator), int(x.denominator))
