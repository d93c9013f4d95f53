"""The residuals of order conditions beside their trees, as tests compare them."""

from __future__ import annotations

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.trees.order_conditions import Conditions, TreeType


def residuals(conditions: Conditions[TreeType], vertices: int) -> tuple[tuple[TreeType, Exact], ...]:
    """Every tree with `vertices` vertices, and its residual Φ(t) - 1/γ(t), zeros included."""
    exact = conditions.scalars.exact
    return tuple((conditions.tree(vertices, label), exact(x)) for label, x in conditions.residuals(vertices))
