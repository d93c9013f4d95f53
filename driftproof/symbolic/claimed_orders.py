"""Orders that a table claims and does not have, not even but for the rounding of its coefficients."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from typing import Any, NamedTuple

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS, Entry
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta, Splitting, Staged
from driftproof.symbolic.algebra.certified import AWAY, scientific
from driftproof.symbolic.algebra.polynomials import X, polynomial
from driftproof.symbolic.facts import derived, order_within
from driftproof.symbolic.linear.printed_digits import JUMP, RESIDUAL_DIGITS
from driftproof.symbolic.linear.root_condition import root_condition
from driftproof.symbolic.trees.order_conditions import TOLERANCE_ORDER
from driftproof.symbolic.trees.order_in_balls import rounded_order
from driftproof.symbolic.trees.partitioned_trees import general_conditions, nystrom_conditions

# Chosen: each entry that is tried costs the evaluation of the order conditions.
_MOST_ENTRIES = 70


class UnreachedOrder(NamedTuple):
    """The method that claims an order, or that of the embedded weights, its order but for rounding, and what it may be.

    `remark` is empty, or says why a small residual is no rounding, or that `decimal` would say that it is one.
    """

    method: Entry
    embedded: bool
    order: int
    remark: str

    def __str__(self) -> str:
        """The claim, if there is one, and the order in one line."""
        claimed = f"claimed {'embedded ' * self.embedded}order {self.method.claimed_order}, has "
        return f"{claimed if self.method.claimed_order else 'order '}{self.order}{self.remark}"


def unreached_orders(method: Entry, tolerance: Fraction | None = None) -> list[UnreachedOrder]:
    """The claims of orders, by the method and by its embedded weights, that do not hold, nor to a given tolerance.

    An order holds that is missed only by the rounding of the coefficients, as far as their digits explain it, which is
    proved by a jump of the residuals or said by the table; of a splitting also if it is that on q'' = F(q) alone, which
    authors of such methods claim; of a multistep method, also of one that claims none, only if it is zero-stable.

    >>> from dataclasses import replace
    >>> from driftproof import METHODS
    >>> from driftproof.symbolic.claimed_orders import unreached_orders
    >>> print(*unreached_orders(replace(METHODS["heun2"], claimed_order=3)))
    claimed order 3, has 2
    """
    missed = [found for each, embedded in _claims(method) if (found := _unreached(each, embedded, tolerance))]
    for words, turned in _exchanged(method) if missed else ():
        if not any(_unreached(each, embedded, tolerance) for each, embedded in _claims(turned)):
            missed[0] = missed[0]._replace(remark=f"{missed[0].remark}; {words}")
    return missed


def stated_order(method: Entry) -> int:
    """The order that the method claims, if it reaches that, or else the one that it has."""
    if not method.claimed_order:
        return int(derived(method).order)
    return next((found.order for found in false_claims(method) if not found.embedded), method.claimed_order)


@cache
def false_claims(method: Entry, tolerance: Fraction | None = None) -> list[UnreachedOrder]:
    """`unreached_orders` of a method of the user's own; those of the catalogue are tested to have none."""
    known = method in (METHODS.get(method.key), FURTHER_METHODS.get(method.key))
    return [] if known else unreached_orders(method, tolerance)


def stated_orders(methods: Iterable[Entry]) -> dict[str, str]:
    """`stated_order` of each method in words, by key, with a claim that is not true.

    >>> from driftproof.methods.catalogue import METHODS
    >>> from driftproof.symbolic.claimed_orders import stated_orders
    >>> stated_orders([METHODS["rk4"]])
    {'rk4': '4'}
    """
    found = {method.key: (stated_order(method), method.claimed_order) for method in methods}
    return {
        key: f"{order}, not {claimed} as claimed" if 0 < claimed != order else str(order)
        for key, (order, claimed) in found.items()
    }


def _exchanged(method: Any) -> Iterator[tuple[str, Entry]]:
    """The table with its rows in other places, and what then may be wrong with the one given."""
    if isinstance(method, Multistep) and method.claimed_order and method.rho[0]:
        rows = {name: getattr(method, name)[::-1] for name in ("rho", "sigma")}
        yield (
            "rho and sigma may stand newest first; they go from the oldest value to the new one",
            replace(method, **rows),
        )
    end = "_embedded"
    if pairs := [(name.removesuffix(end), name) for name in getattr(method, "rows", ()) if name.endswith(end)]:
        rows = {one: getattr(method, other) for pair in pairs for one, other in (pair, pair[::-1])}
        if None not in rows.values():
            yield " and ".join(pairs[0]) + " may be exchanged", replace(method, **rows)


def _claims(method: Entry) -> Iterator[tuple[Entry, bool]]:
    yield method, False
    if isinstance(method, Staged) and (order := getattr(method, "embedded_order", None)):
        end = "_embedded"
        rows = {name.removesuffix(end): getattr(method, name) for name in method.rows if name.endswith(end)}
        yield replace(method, claimed_order=order, **rows), True


def _unreached(method: Entry, embedded: bool, tolerance: Fraction | None) -> UnreachedOrder | None:
    facts, claimed = derived(method), method.claimed_order
    within = (
        (lambda by: order_within(method, by)) if isinstance(method, Method) else getattr(facts, "orders_within", None)
    )
    if tolerance is not None and within and within(tolerance).order >= claimed:
        return None
    second = facts.order_second_order_problems if isinstance(method, Splitting) else None
    reached = max(facts.order, second or 0)
    if reached < claimed:
        reached = max(reached, *_but_for_rounding(method))
    if reached >= claimed:
        unstable = _unstable(method) if isinstance(method, Multistep) else ""
        return UnreachedOrder(method, embedded, reached, unstable) if unstable else None
    residual, remark = facts.order_fails.residual, ""
    if not isinstance(method, Collocation) and not getattr(method, "field", None):
        small = JUMP * abs(residual)
        if max(_but_for_rounding(replace(method, decimal=True))) >= claimed:
            remark = "; decimal = true says that its coefficients are rounded, which explains that"
        elif within and small < Fraction(1, 100) and within(small).order == claimed:
            size, most = scientific(abs(residual), RESIDUAL_DIGITS, AWAY), scientific(small, 1, AWAY)
            remark = f": a condition fails by {size}, more than its digits explain"
            remark += f"; `facts --order-tolerance {most}` allows that"
    return UnreachedOrder(method, embedded, reached, remark)


def _unstable(method: Multistep) -> str:
    """Why the method is not zero-stable, "" if it is; a rounding of rho that moves the root 1 is left out."""
    times = method.derivative
    found = root_condition(polynomial(method.rho) // (X - 1) ** times * (X - 1) ** times, times)
    return "" if found.holds else f", but is not zero-stable: {found.reason}"


def _but_for_rounding(method: Entry) -> Iterator[int]:
    """The orders but for rounding, 0 without one; where it explains every condition that is tried, as high as any."""
    found = [derived(method).order_but_for_rounding]
    if isinstance(method, Splitting):
        found.append(rounded_order(lambda by: nystrom_conditions(method, by), method, TOLERANCE_ORDER))
    for each in found:
        yield 0 if each is None else each.order if each.next_residual is not None else method.claimed_order


def restoring_entries(method: Entry, claimed: int) -> list[str]:
    """The entries whose change alone restores the order claimed, each as a line of text.

    The first order condition that is linear in the entry, as those of the tall trees are in one of an explicit table,
    leaves one value, for which the order is derived. A c that has the sums of the rows of A follows them.
    """
    if isinstance(method, Collocation) or not claimed or len([*method.coefficients()]) > _MOST_ENTRIES:
        return []
    method, found = replace(method, claimed_order=claimed), []
    if _unreached(method, False, None) is None:
        return []
    for name, was, changed in _entries(method):
        try:
            value = _solved(changed, claimed)
            if value not in (None, was) and _unreached(changed(value), False, None) is None:
                what = f"{name} = {value} in place of {was}"
                found.append(f"with this one entry changed, order {claimed} is restored: {what}")
        except MethodError:  # the value is one that no such method has
            continue
    return found


def _entries(method: Any) -> Iterator[tuple[str, Exact, Callable[[Exact], Any]]]:
    """Each entry that may be wrong, by name, with its value, and the method with another in its place."""
    sums = isinstance(method, RungeKutta) and method.c == tuple(map(sum, method.a))
    tables = *getattr(method, "matrices", ()), *getattr(method, "rows", ("parts", "rho", "sigma"))
    for name in tables:
        for i, row in enumerate(getattr(method, name, None) or () if "embedded" not in name else ()):
            if name in getattr(method, "matrices", ()):
                for j, x in enumerate(row[: i + 1] if row[i] else row[:i]):
                    yield f"{name}[{i}][{j}]", x, partial(_changed, method, sums, name, i, j)
            elif not (sums and name == "c"):
                yield f"{name}[{i}]", row[1] if name == "parts" else row, partial(_changed, method, sums, name, i, None)


def _changed(method: Any, sums: bool, name: str, i: int, j: int | None, value: Exact) -> Any:
    rows = list(getattr(method, name))
    kind = (rows[i][0],) if name == "parts" else ()
    rows[i] = (*kind, value) if kind else value if j is None else (*rows[i][:j], value, *rows[i][j + 1 :])
    return replace(method, **{name: tuple(rows)}, **({"c": tuple(map(sum, rows))} if sums and j is not None else {}))


def _solved(changed: Callable[[Exact], Any], claimed: int) -> Any:
    """The value of the entry for which the first condition that is linear in it holds; None without one."""
    below, start, end = (_residuals(changed(Fraction(x)), claimed) for x in (-1, 0, 1))
    for before, at_zero, at_one in zip(below, start, end, strict=False):
        if at_zero != at_one and before + at_one == 2 * at_zero:
            return at_zero / (at_zero - at_one)
    return None


def _residuals(method: Entry, claimed: int) -> Iterator[Any]:
    """The residuals of the order conditions up to the order that is claimed."""
    facts = derived(method)
    if isinstance(method, Multistep):
        yield from map(facts.residual, range(claimed + method.derivative))
        return
    conditions = general_conditions(method) if isinstance(method, Method) else facts.conditions
    for n in range(1, claimed + 1):
        yield from (conditions.scalars.exact(x) for _, x in conditions.residuals(n))
