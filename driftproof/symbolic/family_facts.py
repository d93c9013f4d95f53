"""Every fact about a family of Runge-Kutta methods as a function of its parameter, JSON-ready."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, TypeAlias

from driftproof.methods.families import Family
from driftproof.methods.number_field import UndecidedError
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.text import rational_text
from driftproof.symbolic.facts import answers
from driftproof.symbolic.family_order import FamilyOrder, family_order
from driftproof.symbolic.linear.families import family_error_constant, family_stability
from driftproof.symbolic.linear.implicit_stability import a_stability, i_stability, l_stability
from driftproof.symbolic.linear.parameter_sets import Line, parameter_set, set_data
from driftproof.symbolic.linear.parametric_limits import (
    ParametricLimit,
    parametric_imaginary_limit,
    parametric_real_limit,
)
from driftproof.symbolic.trees.rooted import written

Json: TypeAlias = Any
Fact: TypeAlias = Callable[["FamilyFacts"], Json]


class FamilyFacts:
    """The facts about `family`; the order is computed once for all that use it."""

    def __init__(self, family: Family) -> None:
        """Compute nothing yet."""
        self.family = family

    @cached_property
    def order(self) -> FamilyOrder:
        """The order for all values, and the values where it is higher."""
        return family_order(self.family)

    def text(self, f: RationalFunction) -> str:
        """A function of the parameter in SymPy's syntax."""
        return rational_text(f, self.family.parameter)


def _order_fails(facts: FamilyFacts) -> Json:
    return {"tree": written(facts.order.failing_tree), "residual": facts.text(facts.order.residual)}


def _order_sets(facts: FamilyFacts) -> Json:
    return [{"order": p, **set_data(where)} for p, where in enumerate(facts.order.sets, 1)]


def _stability(facts: FamilyFacts) -> Json:
    num, den = family_stability(facts.family).coefficients()
    return {"num": [facts.text(c) for c in num], "den": [facts.text(c) for c in den]}


def _error_constant(facts: FamilyFacts) -> Json:
    power, constant = family_error_constant(facts.family)
    return {"power": power, "coefficient": facts.text(constant)}


def _set_where(decide: Callable[[RationalFunction], object]) -> Fact:
    return _if_decided(lambda facts: set_data(parameter_set(facts.family, decide)))


def _limit(limit: Callable[[Family], ParametricLimit]) -> Fact:
    return _if_decided(lambda facts: limit(facts.family).data())


def _if_decided(fact: Fact) -> Fact:
    """The fact, or why it is not decided: a critical value of the parameter lies in a number field too large."""

    def found(facts: FamilyFacts) -> Json:
        try:
            return fact(facts)
        except UndecidedError as reason:
            return {"refused": f"a critical value of {facts.family.parameter} is not decided: {reason}"}

    return found


FAMILY_FACTS: dict[str, Fact] = {
    "method": lambda facts: facts.family.key,
    "title": lambda facts: facts.family.title,
    "family": lambda facts: "runge_kutta",
    "parameter": lambda facts: facts.family.parameter,
    "source": lambda facts: facts.family.source,
    "stages": lambda facts: facts.family.stages,
    "explicit": lambda facts: facts.family.explicit,
    "defined": lambda facts: set_data(Line.cut(facts.family, []).where(lambda value: True)),
    "claimed_order": lambda facts: facts.family.claimed_order,
    "order": lambda facts: facts.order.order,
    "order_fails": _order_fails,
    "order_sets": _order_sets,
    "stability_function": _stability,
    "error_constant": _error_constant,
    "real_limit": _limit(parametric_real_limit),
    "imaginary_limit": _limit(parametric_imaginary_limit),
    "a_stable": _set_where(a_stability),
    "i_stable": _set_where(i_stability),
    "l_stable": _set_where(l_stability),
}


def family_facts(family: Family, names: Sequence[str] = tuple(FAMILY_FACTS)) -> dict[str, Json]:
    """The named facts of the family, for almost all or for which values of the parameter; those of a member differ.

    Sets are exact unions of intervals, functions in SymPy's syntax. Raises ValueError for an unknown name.
    """
    return answers(FAMILY_FACTS, names, FamilyFacts(family))
