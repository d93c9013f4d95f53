"""The simplifying assumptions B(p), C(q) and D(r), each as far as it holds exactly, and the stage order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flint import fmpq

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.collocation import collocation_order
from driftproof.symbolic.trees.scalars import Number, scalars_for
from driftproof.symbolic.trees.weights import AnyMethod, NodePolynomial, Tableau

# The residuals of the k-th condition of a family, one number for each equation in it.
Condition = Callable[[int], list[Number]]


@dataclass(frozen=True)
class Simplifying:
    """The largest p, q, r with B(p), C(q), D(r); None where every one of the conditions holds.

    B(p): Σ bᵢ cᵢᵏ⁻¹ = 1/k; C(q): Σⱼ aᵢⱼ cⱼᵏ⁻¹ = cᵢᵏ/k; D(r): Σᵢ bᵢ cᵢᵏ⁻¹ aᵢⱼ = bⱼ (1 - cⱼᵏ)/k, for k up to the
    number (hairer-norsett-wanner-1993, II.7; butcher-2016, 321).
    """

    b: int
    c: int | None
    d: int | None

    @property
    def stage_order(self) -> int:
        """The largest q with B(q) and C(q): the order to which stages and step both approximate the solution."""
        return self.b if self.c is None else min(self.b, self.c)


def simplifying_assumptions(method: AnyMethod) -> Simplifying:
    """How far B, C and D hold, with the c that the method states.

    For collocation at s nodes with a quadrature formula of order p they hold to p, s and p - s.
    """
    if isinstance(method, NodePolynomial):
        order, stages = collocation_order(method.node_polynomial).order, len(method.node_polynomial) - 1
        return Simplifying(order, stages, order - stages)
    conditions = _Conditions(method)
    # Polynomials of degree 2s tell all s nodes apart from integrals: whoever passes 2s + 1 conditions passes all.
    last = 2 * len(method.b) + 1
    b, c, d = (_degree(condition, last) for condition in (conditions.b, conditions.c, conditions.d))
    if b is None:
        raise AssertionError(f"a quadrature formula with {len(method.b)} nodes and order {last}")
    return Simplifying(b, c, d)


class _Conditions:
    """The residuals of the conditions numbered k = 1, 2, ..., in the method's field."""

    def __init__(self, method: Tableau) -> None:
        scalars = scalars_for([*method.b, *method.c, *(x for row in method.a for x in row)])
        lift: Callable[[Exact | int], Number] = scalars.lift
        self.weights, nodes = [lift(x) for x in method.b], [lift(x) for x in method.c]
        self.rows = [[lift(x) for x in row] for row in method.a]
        self.columns = list(zip(*self.rows, strict=True))
        self.powers = [[lift(1)] * len(nodes)]
        for _ in range(2 * len(nodes) + 1):
            self.powers.append([x * y for x, y in zip(self.powers[-1], nodes, strict=True)])

    def b(self, k: int) -> list[Number]:
        return [_dot(self.weights, self.powers[k - 1]) - fmpq(1, k)]

    def c(self, k: int) -> list[Number]:
        inverse = fmpq(1, k)
        return [_dot(row, self.powers[k - 1]) - x * inverse for row, x in zip(self.rows, self.powers[k], strict=True)]

    def d(self, k: int) -> list[Number]:
        weighted = [w * x for w, x in zip(self.weights, self.powers[k - 1], strict=True)]
        expected = [w * (1 - x) * fmpq(1, k) for w, x in zip(self.weights, self.powers[k], strict=True)]
        return [_dot(weighted, column) - x for column, x in zip(self.columns, expected, strict=True)]


def _degree(condition: Condition, last: int) -> int | None:
    """The largest k to which the conditions hold, or None if they hold to `last`."""
    return next((k - 1 for k in range(1, last + 1) if any(condition(k))), None)


def _dot(u: list[Number], v: list[Number] | tuple[Number, ...]) -> Number:
    return sum((x * y for x, y in zip(u, v, strict=True)), 0 * u[0])
