"""Orders that a table claims and does not have, not even but for the rounding of its coefficients."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from driftproof.methods.catalogue import Entry
from driftproof.methods.schemes import Collocation, Method, Splitting, Staged
from driftproof.symbolic.facts import derived, order_within
from driftproof.symbolic.linear.printed_digits import JUMP, RoundedOrder, rounding
from driftproof.symbolic.trees.order_conditions import TOLERANCE_ORDER
from driftproof.symbolic.trees.order_in_balls import rounded_order
from driftproof.symbolic.trees.partitioned_trees import nystrom_conditions


class UnreachedOrder(NamedTuple):
    """The method that claims an order, or that of the embedded weights, and its order but for rounding.

    `apart` is None unless a rounding coarser than the digits show would explain why the order is missed.
    """

    method: Entry
    embedded: bool
    order: int
    apart: RoundedOrder | None

    def __str__(self) -> str:
        """The claim and the order in one line."""
        claimed = f"claimed {'embedded ' * self.embedded}order {self.method.claimed_order}"
        if self.apart is None:
            return f"{claimed}, has {self.order}"
        beyond = f"conditions up to {self.apart.order} fail by {self.apart.residual}, more than its digits explain"
        return f"{claimed}, has {self.order}: {beyond}; decimal = true says that its coefficients are rounded"


def unreached_orders(method: Entry, tolerance: Fraction | None = None) -> list[UnreachedOrder]:
    """The claims of orders, by the method and by its embedded weights, that do not hold, nor to a given tolerance.

    An order holds that is missed only by the rounding of the coefficients, of which those of a table that says that it
    is rounded may have any; of a splitting also if it is that on q'' = F(q) alone, which authors of such methods claim.

    >>> from dataclasses import replace
    >>> from driftproof import METHODS
    >>> from driftproof.symbolic.claimed_orders import unreached_orders
    >>> print(*unreached_orders(replace(METHODS["heun2"], claimed_order=3)))
    claimed order 3, has 2
    """
    return [found for each, embedded in _claims(method) if (found := _unreached(each, embedded, tolerance))]


def _claims(method: Entry) -> Iterator[tuple[Entry, bool]]:
    yield method, False
    if isinstance(method, Staged) and (order := getattr(method, "embedded_order", None)):
        end = "_embedded"
        rows = {name.removesuffix(end): getattr(method, name) for name in method.rows if name.endswith(end)}
        yield replace(method, claimed_order=order, **rows), True


def _unreached(method: Entry, embedded: bool, tolerance: Fraction | None) -> UnreachedOrder | None:
    facts, claimed = derived(method), method.claimed_order
    if tolerance is not None:
        within = order_within(method, tolerance) if isinstance(method, Method) else facts.orders_within(tolerance)
        if within.order >= claimed:
            return None
    orders: list[tuple[int, Callable[[], RoundedOrder | None]]] = [(facts.order, lambda: facts.order_but_for_rounding)]
    if isinstance(method, Splitting):
        of_second_order = lambda by: nystrom_conditions(method, by)
        rounded = lambda: rounded_order(of_second_order, method.coefficients(), TOLERANCE_ORDER)
        orders.append((facts.order_second_order_problems, rounded))
    reached, apart = max(order for order, _ in orders), None
    if reached < claimed and not isinstance(method, Collocation) and not getattr(method, "field", None):
        hidden = JUMP * rounding(method.coefficients())
        apart_from_rounding = [x for _, but_for_rounding in orders if (x := but_for_rounding())]
        # Orders above the highest that is tried, and few digits, show no jump: what may be rounding is no fault.
        untold = claimed > TOLERANCE_ORDER or (method.decimal and not apart_from_rounding)
        if untold and abs(facts.order_fails.residual) <= hidden:
            return None
        for found in apart_from_rounding:
            if method.decimal or Fraction(found.residual) <= hidden:
                reached = max(reached, found.order)
            elif found.order >= claimed:
                apart = found
    return None if reached >= claimed else UnreachedOrder(method, embedded, reached, apart)
