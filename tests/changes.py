"""A method with some of its numbers changed: every coefficient has a place, zeros included."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise
from typing import Any

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.facts import general_order
from driftproof.symbolic.linear.oscillator import oscillator_matrix, stability_function_of
from driftproof.symbolic.linear.reduced_tableau import reduced, stages_of
from driftproof.symbolic.linear.stability_function import stability_function

# What holds the number, and where in it: ("a", i, j), ("b", i), ("kick", i).
Place = tuple[str, int] | tuple[str, int, int]

ROWS = {RungeKutta: ("b", "c", "b_embedded"), Nystrom: ("c", "b_position", "b_velocity"), Collocation: ()}


def coefficients(method: Method) -> dict[Place, Exact]:
    """Every number of the definition; of a node polynomial all but the leading one, which is 1."""
    if isinstance(method, Splitting):
        return {(kind, i): c for i, (kind, c) in enumerate(method.parts)}
    if isinstance(method, Collocation):
        return {("node_polynomial", i): c for i, c in enumerate(method.node_polynomial[:-1])}
    found: dict[Place, Exact] = {("a", i, j): c for i, row in enumerate(method.a) for j, c in enumerate(row)}
    return found | {(name, i): c for name in ROWS[type(method)] for i, c in enumerate(getattr(method, name) or ())}


def changed(method: Method, to: Mapping[Place, Exact]) -> Method:
    """The method with these numbers in these places."""
    numbers = coefficients(method) | dict(to)
    if isinstance(method, Splitting):
        return replace(method, parts=tuple((kind, numbers[kind, i]) for i, (kind, _) in enumerate(method.parts)))
    if isinstance(method, Collocation):
        rest = tuple(numbers["node_polynomial", i] for i in range(method.stages))
        return replace(method, node_polynomial=(*rest, Q(1)))
    s = range(method.stages)
    rows = {name: tuple(numbers[name, i] for i in s) for name in ROWS[type(method)] if (name, 0) in numbers}
    return replace(method, a=tuple(tuple(numbers["a", i, j] for j in s) for i in s), **rows)


def moved(method: Method, place: Place, by: Q) -> Method:
    """The method with `by` added to one number."""
    return changed(method, {place: coefficients(method)[place] + by})


def first_weight(method: Method) -> Place:
    """A place that the order of every method depends on, from order 1 on."""
    return next(place for place in coefficients(method) if place[0] not in ("a", "c", "b_position"))


def rows(method: Method) -> list[list[Place]]:
    """The places that are added up in one sum: a row of A (below the diagonal if explicit), the weights, all kicks."""
    found: dict[tuple[str | int, ...], list[Place]] = {}
    for place in coefficients(method):
        if place[0] == "a" and not (method.explicit and place[2] >= place[1]):
            found.setdefault(place[:2], []).append(place)
        elif place[0] not in ("a", "c", "node_polynomial"):
            found.setdefault(place[:1], []).append(place)
    return list(found.values())


def compensated(method: Method, by: Q) -> Iterator[tuple[tuple[Place, Place], Method]]:
    """Two neighbours in one sum changed, so that no sum shows it."""
    given = coefficients(method)
    for row in rows(method):
        for first, second in pairwise(row):
            off = changed(method, {first: given[first] + by, second: given[second] - by})
            yield (first, second), off


def is_the_same_in_disguise(one: Any, other: Any) -> bool:
    """Some stages are equal on every problem, and only how their weights are shared has changed."""
    return reduced(stages_of(one)) == reduced(stages_of(other)) != stages_of(other)


def second_row(method: RungeKutta) -> RungeKutta:
    """The method that propagates the second row of weights."""
    assert method.b_embedded is not None
    return replace(method, b=method.b_embedded, b_embedded=None, embedded_order=None)


# What can notice a change. The order of a rounded table is low to begin with, and not asked for.
NOTICES: dict[str, Callable[[Any], object]] = {
    "one-step matrix": lambda method: stability_function_of(method) or oscillator_matrix(method),
    "order": lambda method: method.decimal or general_order(method).order,
    "second row": lambda method: getattr(method, "b_embedded", None) and stability_function(second_row(method)),
    "sums": lambda method: method.inconsistencies(),
}
# Merson's method is one of a family with this parameter.
FREE = {("merson45", ("a", 1, 0))}


def must_notice(method: Any, place: Place) -> set[str]:
    """What has to notice a change of any size in this place.

    A change by x in row i of A multiplies out to R' - R = x z² (bᵀ(I - zA)⁻¹)ᵢ times a function that is not 0 at z = 0,
    so the size of the change does not matter, nor what stood there; only that stage i counts.
    """
    kind, index = place[0], place[1]
    if isinstance(method, Collocation):
        return {"one-step matrix", "order"}
    if isinstance(method, RungeKutta) and kind == "c":  # no autonomous problem tells it
        return {"sums"}
    if kind == "b_embedded" or (kind == "a" and index not in counted(method)):
        return {"second row", "sums"}
    kept = method.decimal or (kind == "a" and method.claimed_order < 2) or (method.key, place) in FREE
    return {"one-step matrix", "sums"} | (set() if kept else {"order"})


def counted(method: RungeKutta | Nystrom) -> set[int]:
    """The stages that the result depends on; others serve the second row only."""
    rows = (method.b_position, method.b_velocity) if isinstance(method, Nystrom) else (method.b,)
    found = {i for row in rows for i, x in enumerate(row) if x}
    while more := {j for i in found for j, x in enumerate(method.a[i]) if x} - found:
        found |= more
    return found
