"""All exact facts about a method by name: its order, error estimate, stability, and behaviour on linear problems."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import Entry, FurtherMethod
from driftproof.methods.families import Family
from driftproof.methods.given_methods import method_of
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.numbers.rationals import ExactNumber, exact_number
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.additive import ADDITIVE_FACTS, AdditiveFacts
from driftproof.symbolic.family_facts import FAMILY_FACTS, FamilyFacts
from driftproof.symbolic.linear.facts import IDENTITY, LinearFacts, fact_names, facts_by_name
from driftproof.symbolic.linear.multistep import MULTISTEP_FACTS, MultistepFacts
from driftproof.symbolic.linear.printed_digits import RoundedOrder
from driftproof.symbolic.linear.reduced_tableau import reduced_stages_of
from driftproof.symbolic.pairs import EstimateFacts, ExtensionFacts, estimate_facts, extension_facts
from driftproof.symbolic.rosenbrock import ROSENBROCK_FACTS, RosenbrockFacts
from driftproof.symbolic.trees import order_conditions, partitioned_trees
from driftproof.symbolic.trees.algebraic_stability import is_algebraically_stable
from driftproof.symbolic.trees.modified_equation import modified_equation
from driftproof.symbolic.trees.order_conditions import TOLERANCE_ORDER, Conditions, OrderFact
from driftproof.symbolic.trees.order_in_balls import rounded_order
from driftproof.symbolic.trees.partitioned_trees import general_conditions
from driftproof.symbolic.trees.rooted_trees import TooManyTrees, Tree

FAMILY_NAMES = {RungeKutta: "runge_kutta", Splitting: "splitting", Nystrom: "nystrom", Collocation: "collocation"}
# Vertices of the trees in the modified equation: 17 trees; those with six vertices would be 20 more.
MODIFIED_ORDER = 5


# The facts that differ between the table as written and the irreducible method, by which of the two they describe.
OF_THE_TABLE = (
    *("stages", "explicit", "field", "inconsistencies", "embedded_order", "estimate", "stage_order"),
    *("simplifying_assumptions", "algebraically_stable", "order_reduction"),
    *("stiffly_accurate", "first_same_as_last", "stability_within_digits", "imaginary_limit_within_digits"),
)
OF_THE_IRREDUCIBLE_METHOD = ("symplectic", "symmetric", "ssp_coefficient")


class Reduction(NamedTuple):
    """The number of stages of the irreducible method, and the facts that describe the table or that method only."""

    irreducible_stages: int
    of_the_table: tuple[str, ...]
    of_the_irreducible_method: tuple[str, ...]


class Facts(LinearFacts):
    """The exact facts about `method`, each derived when it is first asked for: `Facts(METHODS["rk4"]).imaginary_limit`.

    A fact that the method does not have is None. FACTS lists all names.

    >>> from driftproof import METHODS, Facts
    >>> facts = Facts(METHODS["rk4"])
    >>> facts.order, facts.a_stable, facts.error_constant.coefficient
    (4, False, Fraction(-1, 120))
    """

    @cached_property
    def family(self) -> str:
        """The family of methods, which says what the coefficients mean."""
        return FAMILY_NAMES[type(self.method)]

    @cached_property
    def stages(self) -> int:
        """The number of evaluations of the right-hand side in a step as written; for a splitting, its kicks."""
        if isinstance(self.method, Splitting):
            return sum(kind == "kick" for kind, _ in self.method.parts)
        return self.method.stages

    @cached_property
    def reduction(self) -> Reduction | None:
        """Which facts describe the table and which the irreducible method; None unless that has fewer stages."""
        if not isinstance(self.method, RungeKutta | Nystrom):
            return None
        stages = len(reduced_stages_of(self.method).b)
        return None if stages == self.stages else Reduction(stages, OF_THE_TABLE, OF_THE_IRREDUCIBLE_METHOD)

    @cached_property
    def inconsistencies(self) -> Mapping[str, Exact]:
        """The residuals that should be zero and are not, such as sum(b) - 1, of coefficients printed as decimals."""
        return self.method.inconsistencies()

    @cached_property
    def order(self) -> int:
        """The order on all problems that the family is for, y' = f(t, y) for a Runge-Kutta method."""
        return self.order_fails.order

    @cached_property
    def order_fails(self) -> OrderFact[Any]:
        """Why the order is not higher: the first tree whose condition fails, and its residual."""
        if isinstance(self.method, RungeKutta):
            return order_conditions.order_of(self._conditions)
        return general_order(self.method)

    @cached_property
    def order_but_for_rounding(self) -> RoundedOrder | None:
        """The order that rounded coefficients miss only by their rounding; None if there is no such order."""
        method, claimed = self.method, self.method.claimed_order
        if isinstance(method, Collocation) or (claimed and self.order == claimed):
            return None
        return rounded_order(lambda by: general_conditions(method, by), method, TOLERANCE_ORDER)

    @property
    def _rounded(self) -> bool:
        """True if the source says so, or if the residuals of the order conditions show it."""
        return super()._rounded or self.order_but_for_rounding is not None

    @cached_property
    def order_second_order_problems(self) -> int | None:
        """The order of a splitting or a Nyström method on q'' = F(q); None for other methods."""
        method = self.method
        return partitioned_trees.nystrom_order(method).order if isinstance(method, Splitting | Nystrom) else None

    @cached_property
    def embedded_order(self) -> int | None:
        """The order of the embedded method of a pair; None without one."""
        found = partitioned_trees.embedded_order(self.method) if isinstance(self.method, RungeKutta) else None
        return None if found is None else found.order

    @cached_property
    def estimate(self) -> EstimateFacts | None:
        """The error estimate of a pair: its order, its value on y' = λy, and how well it matches the error."""
        return estimate_facts(self.method) if isinstance(self.method, RungeKutta) else None

    @cached_property
    def continuous_extensions(self) -> tuple[ExtensionFacts, ...] | None:
        """The dense outputs in the catalogue: their orders for every θ, and how well they join the steps."""
        return extension_facts(self.method) if isinstance(self.method, RungeKutta) else None

    @cached_property
    def stage_order(self) -> int | None:
        """The order to which both the stages and the step approximate the solution."""
        return None if self.simplifying_assumptions is None else self.simplifying_assumptions.stage_order

    @cached_property
    def simplifying_assumptions(self) -> order_conditions.Simplifying | None:
        """The largest p, q, r for which the simplifying assumptions B(p), C(q), D(r) hold."""
        return None if self._tableau is None else order_conditions.simplifying_assumptions(self._tableau)

    @cached_property
    def principal_error(self) -> order_conditions.PrincipalError[Tree] | TooManyTrees | None:
        """The coefficients of the leading error term, by trees; a TooManyTrees if there are too many."""
        if self._tableau is None:
            return None
        try:
            return order_conditions.principal_error(self._conditions, self.order)
        except TooManyTrees as refusal:
            return refusal

    @cached_property
    def algebraically_stable(self) -> bool | None:
        """True if the method is algebraically stable: no step moves two solutions of a contractive problem apart."""
        return None if self._tableau is None else is_algebraically_stable(self._tableau)

    @cached_property
    def modified_equation(self) -> Mapping[Tree, Exact] | None:
        """The nonzero coefficients, by trees, of the modified equation on y' = f(y), whose exact flow is the step."""
        if self._tableau is None:
            return None
        return {tree: c for tree, c in modified_equation(self._tableau, MODIFIED_ORDER).items() if c}

    @cached_property
    def _conditions(self) -> Conditions[Any]:
        """The order conditions, shared by the order and the principal error: each tree is evaluated once."""
        assert self._tableau is not None
        return general_conditions(self._tableau)

    @property
    def _tableau(self) -> RungeKutta | Collocation | None:
        return self.method if isinstance(self.method, RungeKutta | Collocation) else None


# Facts that are so long that they are given only if they are asked for by name.
ON_REQUEST = ("region_boundary",)
# The names of all facts in the order in which a reader wants them; most of what the method itself states comes first.
_LINEAR = (name for name in fact_names(LinearFacts) if name not in ON_REQUEST)
FACTS = tuple(dict.fromkeys((*IDENTITY, *fact_names(Facts), *_LINEAR)))
# What holds but for the rounding of a table, and the facts that hold of the table as it is written.
BUT_FOR_ROUNDING = {
    "order_but_for_rounding": ("order", "embedded_order"),
    "imaginary_limit_within_digits": ("imaginary_limit",),
    "explicit_imaginary_limit_within_digits": ("explicit_imaginary_limit",),
    "stability_within_digits": ("i_stable", "a_stable", "a_stability", "l_stable", "limit_at_infinity", "sector"),
}


def hidden_by_rounding(facts: Any, names: Sequence[str]) -> dict[str, Any]:
    """What holds but for the rounding of the coefficients, as far as it concerns the named facts."""
    hidden = {more: getattr(facts, more, None) for more, of in BUT_FOR_ROUNDING.items() if {*of} & {*names}}
    return {name: value for name, value in hidden.items() if value is not None}


# Why a method may not have a fact.
_NO_R = "only Runge-Kutta and collocation methods have R(z)"
WHY_NONE = {
    **dict.fromkeys(("stability_function", "real_limit", "a_stable", "a_stability", "i_stable", "l_stable"), _NO_R),
    "sector": f"{_NO_R}, and that of this one has an angle whose equation is too long",
    **dict.fromkeys(("limit_at_infinity", "error_constant", "modified_rate", "region_boundary"), _NO_R),
    "reduction": "every stage counts: table and method have the same facts",
    "stability_within_digits": "the method is explicit, its residuals show no rounding, or R has no limit at infinity",
    "imaginary_limit_within_digits": "the method is implicit, the limit is not 0, or it is so but for no rounding",
    "order_but_for_rounding": f"no residual up to {TOLERANCE_ORDER} vertices is far larger than all before it",
    "estimate": "the method is not an embedded pair",
    "continuous_extensions": "the catalogue has none for this method",
    "ssp_coefficient": "only Runge-Kutta and collocation methods have one",
    "energy_multiplier": "the energy change of a step depends on the state",
    "invariant": "the method conserves no quadratic form, or several independent ones",
    "dissipation": "every term of the series vanishes",
}


# For families and each kind of further method: the class that derives them, and their names.
_FURTHER_METHODS: Mapping[type, tuple[Callable[[Any], Any], tuple[str, ...]]] = {
    Family: (FamilyFacts, FAMILY_FACTS),
    Multistep: (MultistepFacts, MULTISTEP_FACTS),
    Rosenbrock: (RosenbrockFacts, ROSENBROCK_FACTS),
    Additive: (AdditiveFacts, ADDITIVE_FACTS),
}
OTHER_FACTS = tuple(dict.fromkeys(name for _, names in _FURTHER_METHODS.values() for name in names))


def derived(method: Entry | Family) -> Any:
    """The facts of the class for methods of this kind, such as `Facts`."""
    return Facts(method) if isinstance(method, Method) else _FURTHER_METHODS[type(method)][0](method)


def facts_of_further(
    method: FurtherMethod | Family, names: Sequence[str] = (), tolerance: Fraction | None = None
) -> dict[str, Any]:
    """The named facts of a family, or of a method of `FURTHER_METHODS`, by default all.

    A `tolerance` adds "order_to_tolerance". Raises ValueError for an unknown name, and for a tolerance for a family
    whose order is always exact.
    """
    _, known = _FURTHER_METHODS[type(method)]
    facts = derived(method)
    if others := [name for name in names if name in FACTS and name not in known]:
        said = f"{method.key} is {method.kind}, and has no {others[0]}; choose from"
        if isinstance(method, Family):
            said = f"{others[0]} is a fact of single methods; choose one with `at`, a value of {method.parameter}, or"
        raise ValueError(f"{said} {', '.join(known)}")
    found = facts_by_name(facts, names or known, known) | hidden_by_rounding(facts, names)
    if tolerance is not None:
        if not hasattr(facts, "orders_within"):
            raise ValueError(f"{method.key} is {method.kind}: its order is exact and takes no tolerance")
        found["order_to_tolerance"] = facts.orders_within(tolerance)
    return found


class OrderWithin(NamedTuple):
    """Orders to a tolerance: the largest p such that no condition up to p has a residual above `tolerance` in size."""

    tolerance: Fraction
    order: int
    order_second_order_problems: int | None
    embedded_order: int | None


def general_order(method: Method) -> OrderFact[Any]:
    """The order by `general_conditions`, never the order on linear problems alone."""
    if isinstance(method, Collocation):
        return order_conditions.order(method)  # by its quadrature formula
    return order_conditions.order_of(general_conditions(method))


def order_within(method: str | Path | Method, tolerance: ExactNumber) -> OrderWithin:
    """The order to a tolerance, that on second-order problems, and that of an embedded method.

    It is not the order, which only exact equality decides. It is at most TOLERANCE_ORDER, or the order if that is
    higher. Raises ValueError for a negative tolerance.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, order_within
    >>> order_within(METHODS["tsitouras54"], Fraction(1, 10**12)).order
    5
    """
    method = method_of(method)
    tolerance = exact_number(tolerance, "tolerance")

    def within(conditions: Conditions[Any]) -> int:
        return order_conditions.order_to_tolerance(conditions, tolerance)

    second = partitioned_trees.embedded_conditions(method) if isinstance(method, RungeKutta) else None
    return OrderWithin(
        tolerance,
        max(general_order(method).order, within(general_conditions(method))),
        within(partitioned_trees.nystrom_conditions(method)) if isinstance(method, Splitting) else None,
        None if second is None else within(second),
    )
