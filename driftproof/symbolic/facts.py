"""Every exact fact of a method by name: who it is, its order by rooted trees, and what it does on linear problems."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias, TypeVar

from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.algebra.radicals import DIGITS, integer_polynomial_text
from driftproof.symbolic.linear.facts import FACTS as LINEAR_FACTS
from driftproof.symbolic.linear.facts import ON_REQUEST, LinearFacts
from driftproof.symbolic.linear.systems import SYSTEM_FACTS, SystemFacts
from driftproof.symbolic.trees.alternating import (
    nystrom_conditions,
    nystrom_order,
    separable_conditions,
    separable_order,
)
from driftproof.symbolic.trees.modified import modified_equation
from driftproof.symbolic.trees.order import (
    Conditions,
    OrderFact,
    embedded_conditions,
    embedded_order,
    order,
    order_to_tolerance,
    principal_error,
    runge_kutta_conditions,
)
from driftproof.symbolic.trees.quadratic import algebraic_stability
from driftproof.symbolic.trees.rooted import written
from driftproof.symbolic.trees.simplifying import simplifying_assumptions
from driftproof.symbolic.trees.table import TooManyTrees

Json: TypeAlias = Any
Fact: TypeAlias = Callable[[LinearFacts], Json]
TableauMethod: TypeAlias = RungeKutta | Collocation
Subject = TypeVar("Subject")

FAMILIES = {RungeKutta: "runge_kutta", Splitting: "splitting", Nystrom: "nystrom", Collocation: "collocation"}
# Trees that the modified equation goes to.
MODIFIED_ORDER = 5
# Vertices to which an order to a tolerance goes: beyond the exact order, no further.
TOLERANCE_ORDER = 12


def general_order(method: Method) -> OrderFact[Any]:
    """The order on the widest class of problems that the family is for: any y' = f(y) for Runge-Kutta and collocation,
    separable Hamiltonians for splittings, q'' = F(q) for Nyström methods. Never the order on linear problems alone.
    """
    if isinstance(method, Splitting):
        return separable_order(method)
    if isinstance(method, Nystrom):
        return nystrom_order(method)
    return order(method)


def general_conditions(method: Method) -> Conditions[Any]:
    """The order conditions on the class of problems that `general_order` speaks of."""
    if isinstance(method, Splitting):
        return separable_conditions(method)
    return nystrom_conditions(method) if isinstance(method, Nystrom) else runge_kutta_conditions(method)


def order_within(method: Method, tolerance: Fraction) -> Json:
    """The largest p such that every residual of the order conditions up to p is at most `tolerance` in size.

    Not the order: that is decided by equality alone. Looked for up to TOLERANCE_ORDER, or to the order where that is
    higher; likewise on second-order problems, and of an embedded method. Raises ValueError for a negative tolerance.
    """

    if tolerance < 0:
        raise ValueError(f"tolerance {tolerance} is below zero")

    def within(conditions: Conditions[Any], order: int = 0) -> int:
        return order if order >= TOLERANCE_ORDER else order_to_tolerance(conditions, tolerance, TOLERANCE_ORDER)

    second = embedded_conditions(method) if isinstance(method, RungeKutta) else None
    return {
        "tolerance": str(tolerance),
        "order": within(general_conditions(method), general_order(method).order),
        "order_second_order_problems": within(nystrom_conditions(method)) if isinstance(method, Splitting) else None,
        "embedded_order": None if second is None else within(second),
    }


def _order_fails(facts: LinearFacts) -> Json:
    found = general_order(facts.method)
    return {"tree": written(found.failing_tree), "residual": str(found.residual)}


def _stages(method: Method) -> int:
    if isinstance(method, Splitting):
        return sum(kind == "kick" for kind, _ in method.parts)
    return method.stages


def _embedded_order(facts: LinearFacts) -> Json:
    if not isinstance(facts.method, RungeKutta):
        return None
    found = embedded_order(facts.method)
    return None if found is None else found.order


def _field(facts: LinearFacts) -> Json:
    field = facts.method.field
    if field is None:
        return None
    return {
        "generator": field.name,
        "minpoly": integer_polynomial_text(field.minimal),
        "interval": [str(field.low), str(field.high)],
        "decimal": significant(field.generator, DIGITS),
    }


def _simplifying(method: TableauMethod) -> Json:
    found = simplifying_assumptions(method)
    degrees = {"B": found.b, "C": found.c, "D": found.d}
    return {name: "oo" if degree is None else degree for name, degree in degrees.items()}


def _principal_error(method: TableauMethod) -> Json:
    try:
        found = principal_error(runge_kutta_conditions(method))
    except TooManyTrees as refusal:
        return {"refused": str(refusal)}
    coefficients = {written(tree): str(value) for tree, value in found.coefficients}
    return {"vertices": found.vertices, "squared_norm": str(found.squared_norm), "coefficients": coefficients}


def _modified_equation(method: TableauMethod) -> Json:
    series = modified_equation(method, MODIFIED_ORDER)
    return {written(tree): str(value) for tree, value in series.items() if value != 0}


def _of_tableaux(fact: Callable[[TableauMethod], Json]) -> Fact:
    """The fact, of methods that have a tableau; null for the others."""
    return lambda facts: fact(facts.method) if isinstance(facts.method, RungeKutta | Collocation) else None


IDENTITY: dict[str, Fact] = {
    "method": lambda facts: facts.method.key,
    "title": lambda facts: facts.method.title,
    "family": lambda facts: FAMILIES[type(facts.method)],
    "source": lambda facts: facts.method.source,
    "stages": lambda facts: _stages(facts.method),
    "explicit": lambda facts: facts.method.explicit,
    "decimal": lambda facts: facts.method.decimal,
    "field": _field,
    "inconsistencies": lambda facts: {k: str(r) for k, r in facts.method.inconsistencies().items()},
    "claimed_order": lambda facts: facts.method.claimed_order,
}
ORDER: dict[str, Fact] = {
    "order": lambda facts: general_order(facts.method).order,
    "order_fails": _order_fails,
    "order_second_order_problems": lambda facts: (
        nystrom_order(facts.method).order if isinstance(facts.method, Splitting | Nystrom) else None
    ),
    "embedded_order": _embedded_order,
    "stage_order": _of_tableaux(lambda method: simplifying_assumptions(method).stage_order),
    "simplifying_assumptions": _of_tableaux(_simplifying),
    "principal_error": _of_tableaux(_principal_error),
    "algebraically_stable": _of_tableaux(lambda method: algebraic_stability(method).holds),
    "modified_equation": _of_tableaux(_modified_equation),
}
# Every fact by name, in the order in which a reader wants them.
FACTS: dict[str, Fact] = {**IDENTITY, **ORDER, **LINEAR_FACTS}


def facts_of(method: Method, names: Sequence[str] = tuple(FACTS), terms: int | None = None) -> dict[str, Json]:
    """The named facts of the method, JSON-ready: numbers are strings, null is what the method has not.

    Only those asked for are computed. `terms` is the length of series. Beside FACTS, points of the boundary of the
    stability region may be named, "region_boundary". Raises ValueError for an unknown name.
    """
    return answers({**FACTS, **ON_REQUEST}, names, LinearFacts(method) if terms is None else LinearFacts(method, terms))


def system_facts(
    method: Method, rows: Sequence[Sequence[Fraction]], names: Sequence[str] = tuple(SYSTEM_FACTS)
) -> dict[str, Json]:
    """The named facts of the method on z' = Az, A given by its rows: one-step matrix, eigenvalues, limits of h.

    Raises ValueError for an unknown name, a matrix that is not square, and a system that the method is not for.
    """
    return answers(SYSTEM_FACTS, names, SystemFacts(method, rows))


def answers(table: Mapping[str, Callable[[Subject], Json]], names: Sequence[str], subject: Subject) -> dict[str, Json]:
    """What the table says of the subject, by name. Raises ValueError for a name that it does not have."""
    for name in names:
        if name not in table:
            raise ValueError(f"unknown fact {name!r}; choose from {', '.join(table)}")
    return {name: table[name](subject) for name in names}
