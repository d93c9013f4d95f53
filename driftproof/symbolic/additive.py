"""Exact facts about additive Runge-Kutta methods: the order of both tables together and of each, and stability."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from driftproof.methods.additive import Additive
from driftproof.methods.numbers.number_field import Exact, total
from driftproof.symbolic.linear.facts import IDENTITY, FactsOfFamily, LinearFacts, fact_names, fact_of_twin
from driftproof.symbolic.linear.printed_digits import RoundedOrder
from driftproof.symbolic.rosenbrock import MOST_VERTICES
from driftproof.symbolic.trees.elementary_weights import EXACT, Scalars, TableauStages
from driftproof.symbolic.trees.order_conditions import OrderFact, order, order_of, order_to_tolerance
from driftproof.symbolic.trees.order_conditions import runge_kutta_conditions as conditions_of_one
from driftproof.symbolic.trees.order_in_balls import rounded_order
from driftproof.symbolic.trees.partitioned_trees import ColouredConditions
from driftproof.symbolic.trees.rooted_trees import ColouredTree

_COLOURS = ("explicit", "implicit")


class CoupledOrders(NamedTuple):
    """Orders to a tolerance: the largest p such that no condition up to p has a residual above `tolerance` in size."""

    tolerance: Fraction
    order: int
    explicit_order: int
    implicit_order: int
    embedded_order: int | None


class AdditiveFacts(FactsOfFamily[Additive]):
    """The exact facts about an additive method, each derived when it is first asked for.

    >>> from driftproof.methods.catalogue import FURTHER_METHODS
    >>> facts = AdditiveFacts(FURTHER_METHODS["ars443"])
    >>> facts.order, facts.explicit_order, facts.implicit_order, facts.implicit_l_stable
    (3, 3, 3, True)
    """

    kind = "additive"

    @cached_property
    def nodes(self) -> tuple[Exact, ...] | None:
        """The nodes Σⱼ aᵢⱼ = Σⱼ âᵢⱼ of the stages; None if the two tables have different nodes."""
        found, other = (tuple(map(total, a)) for a in (self.method.a_explicit, self.method.a_implicit))
        return found if found == other else None

    @cached_property
    def weights_agree(self) -> bool:
        """True if b = b̂; then every linear invariant of f + g is kept, even if neither f nor g has it."""
        return self.method.b_explicit == self.method.b_implicit

    @cached_property
    def order(self) -> int:
        """The order on every y' = f(y) + g(y), by the conditions of all two-coloured trees, coupling ones included."""
        return self.order_fails.order

    @cached_property
    def order_fails(self) -> OrderFact[ColouredTree]:
        """Why the order is not higher: the first tree that fails, with explicit and implicit vertices; its residual."""
        return order_of(self._both)

    @cached_property
    def order_but_for_rounding(self) -> RoundedOrder | None:
        """The order that rounded coefficients miss only by their rounding; None if there is no such order."""
        method = self.method
        if method.claimed_order == self.order:
            return None
        rows = method.b_explicit, method.b_implicit
        return rounded_order(lambda by: self._conditions(*rows, by), method, MOST_VERTICES)

    @cached_property
    def explicit_order(self) -> int:
        """The order of the explicit table alone."""
        return order(self.method.table("explicit")).order

    @cached_property
    def implicit_order(self) -> int:
        """The order of the implicit table alone."""
        return order(self.method.table("implicit")).order

    @cached_property
    def embedded_order(self) -> int | None:
        """The order of the embedded weights on y' = f(y) + g(y); None without such weights."""
        found = self._embedded
        return None if found is None else order_of(found).order

    explicit_stability_function = fact_of_twin("_explicit", "stability_function")
    explicit_real_limit = fact_of_twin("_explicit", "real_limit")
    explicit_imaginary_limit = fact_of_twin("_explicit", "imaginary_limit")
    explicit_imaginary_limit_within_digits = fact_of_twin("_explicit", "imaginary_limit_within_digits")
    implicit_stability_function = fact_of_twin("_implicit", "stability_function")
    implicit_a_stable = fact_of_twin("_implicit", "a_stable")
    implicit_l_stable = fact_of_twin("_implicit", "l_stable")
    implicit_stability_within_digits = fact_of_twin("_implicit", "stability_within_digits")
    implicit_limit_at_infinity = fact_of_twin("_implicit", "limit_at_infinity")
    implicit_stiffly_accurate = fact_of_twin("_implicit", "stiffly_accurate")

    def orders_within(self, tolerance: Fraction) -> CoupledOrders:
        """The orders to a tolerance, for decimal tables, whose conditions hold up to rounding. Raises ValueError."""
        both = order_to_tolerance(self._both, tolerance)
        parts = (conditions_of_one(self.method.table(part)) for part in _COLOURS)
        explicit, implicit = (order_to_tolerance(conditions, tolerance) for conditions in parts)
        embedded = None if self._embedded is None else order_to_tolerance(self._embedded, tolerance)
        return CoupledOrders(tolerance, both, explicit, implicit, embedded)

    @cached_property
    def _explicit(self) -> LinearFacts:
        return LinearFacts(self.method.table("explicit"))

    @cached_property
    def _implicit(self) -> LinearFacts:
        return LinearFacts(self.method.table("implicit"))

    @cached_property
    def _both(self) -> ColouredConditions:
        return self._conditions(self.method.b_explicit, self.method.b_implicit)

    conditions = property(lambda self: self._both)

    @property
    def _embedded(self) -> ColouredConditions | None:
        rows = self.method.b_explicit_embedded, self.method.b_implicit_embedded
        return None if None in rows else self._conditions(*rows)  # type: ignore[arg-type]

    def _conditions(
        self, b_explicit: Sequence[Exact], b_implicit: Sequence[Exact], scalars: Scalars = EXACT
    ) -> ColouredConditions:
        """The conditions of trees with vertices of f and of g, with any branches (kennedy-carpenter-2003, 2)."""
        tables = (self.method.a_explicit, b_explicit), (self.method.a_implicit, b_implicit)
        stages = (TableauStages(a, b, scalars) for a, b in tables)
        return ColouredConditions(_COLOURS, *stages, internal=2, scalars=scalars)


# Every fact by name, in the order in which a reader wants them.
ADDITIVE_FACTS = tuple(dict.fromkeys((*IDENTITY, *fact_names(AdditiveFacts))))
