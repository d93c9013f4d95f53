"""Every exact fact of a method by name, as exact objects: who it is, its order, and what it does on linear problems."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FactsOnly
from driftproof.methods.multistep import Multistep
from driftproof.methods.number_field import Exact
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting, demand_method
from driftproof.symbolic.additive import ADDITIVE_FACTS, AdditiveFacts
from driftproof.symbolic.linear.facts import LinearFacts, fact_names, facts_by_name
from driftproof.symbolic.linear.multistep import MULTISTEP_FACTS, MULTISTEP_ON_REQUEST, MultistepFacts
from driftproof.symbolic.linear.reduced_tableau import reduced_stages_of
from driftproof.symbolic.pairs import EstimateFacts, ExtensionFacts, estimate_facts, extension_facts
from driftproof.symbolic.rosenbrock import ROSENBROCK_FACTS, RosenbrockFacts
from driftproof.symbolic.trees import order_conditions, partitioned_trees
from driftproof.symbolic.trees.algebraic_stability import algebraic_stability
from driftproof.symbolic.trees.modified_equation import modified_equation
from driftproof.symbolic.trees.order_conditions import TOLERANCE_ORDER, Conditions, OrderFact
from driftproof.symbolic.trees.order_in_balls import RoundedOrder, order_but_for_rounding
from driftproof.symbolic.trees.partitioned_trees import general_conditions
from driftproof.symbolic.trees.rooted_trees import TooManyTrees, Tree

FAMILY_NAMES = {RungeKutta: "runge_kutta", Splitting: "splitting", Nystrom: "nystrom", Collocation: "collocation"}
# Vertices of the trees in the modified equation: 17 trees; those with six vertices would be 20 more.
MODIFIED_ORDER = 5


# The other facts are the same of both.
OF_THE_TABLE = (
    *("stages", "explicit", "field", "inconsistencies", "embedded_order", "estimate", "stage_order"),
    *("simplifying_assumptions", "algebraically_stable", "order_reduction"),
    *("stiffly_accurate", "first_same_as_last", "stability_within_digits"),
)
OF_THE_IRREDUCIBLE_METHOD = ("symplectic", "symmetric", "ssp_coefficient")


class Reduction(NamedTuple):
    """The stages of the irreducible method, and of which facts it matters whether they are of it or of the table."""

    irreducible_stages: int
    of_the_table: tuple[str, ...]
    of_the_irreducible_method: tuple[str, ...]


class Facts(LinearFacts):
    """The exact facts about `method`, each derived when it is first asked for: `Facts(METHODS["rk4"]).imaginary_limit`.

    A fact is None where the method has none. FACTS has the names of all.

    >>> from driftproof import METHODS, Facts
    >>> facts = Facts(METHODS["rk4"])
    >>> facts.order, facts.a_stable, facts.error_constant.coefficient
    (4, False, Fraction(-1, 120))
    """

    @cached_property
    def family(self) -> str:
        """The kind of method by which its coefficients are read."""
        return FAMILY_NAMES[type(self.method)]

    @cached_property
    def stages(self) -> int:
        """How often a step evaluates the right-hand side, as written; of a splitting, its kicks."""
        if isinstance(self.method, Splitting):
            return sum(kind == "kick" for kind, _ in self.method.parts)
        return self.method.stages

    @cached_property
    def reduction(self) -> Reduction | None:
        """Which facts are of the table as written, and which of the irreducible method, where that has fewer stages."""
        if not isinstance(self.method, RungeKutta | Nystrom):
            return None
        stages = len(reduced_stages_of(self.method).b)
        return None if stages == self.stages else Reduction(stages, OF_THE_TABLE, OF_THE_IRREDUCIBLE_METHOD)

    @cached_property
    def inconsistencies(self) -> Mapping[str, Exact]:
        """What is not zero and should be, as sum(b) - 1: of coefficients that are printed as decimals."""
        return self.method.inconsistencies()

    @cached_property
    def order(self) -> int:
        """The order on the widest class of problems that the family is for, never on linear problems alone."""
        return self.order_fails.order

    @cached_property
    def order_fails(self) -> OrderFact[Any]:
        """Why the order is no higher: the first tree with a residual, and the residual."""
        if isinstance(self.method, RungeKutta):
            return order_conditions.order_of(self._conditions)
        return general_order(self.method)

    @cached_property
    def order_but_for_rounding(self) -> RoundedOrder | None:
        """The order that rounded coefficients miss by their rounding alone; None where there is nothing of the kind."""
        method, claimed = self.method, self.method.claimed_order
        if isinstance(method, Collocation) or method.field or (claimed and self.order == claimed):
            return None
        return order_but_for_rounding(method, TOLERANCE_ORDER)

    @property
    def _rounded(self) -> bool:
        """As the source says, or as the residuals of the order conditions show."""
        return super()._rounded or self.order_but_for_rounding is not None

    @cached_property
    def order_second_order_problems(self) -> int | None:
        """The order on q'' = F(q), of splittings and Nyström methods."""
        method = self.method
        return partitioned_trees.nystrom_order(method).order if isinstance(method, Splitting | Nystrom) else None

    @cached_property
    def embedded_order(self) -> int | None:
        """The order of the embedded method of a pair."""
        found = order_conditions.embedded_order(self.method) if isinstance(self.method, RungeKutta) else None
        return None if found is None else found.order

    @cached_property
    def estimate(self) -> EstimateFacts | None:
        """Of a pair: the order of its error estimate, what it is on y' = λy, and whether it is what it estimates."""
        return estimate_facts(self.method) if isinstance(self.method, RungeKutta) else None

    @cached_property
    def continuous_extensions(self) -> tuple[ExtensionFacts, ...] | None:
        """The dense outputs that the catalogue holds: orders for every θ, and how they fit to the steps."""
        return extension_facts(self.method) if isinstance(self.method, RungeKutta) else None

    @cached_property
    def stage_order(self) -> int | None:
        """The order to which stages approximate the solution."""
        return None if self.simplifying_assumptions is None else self.simplifying_assumptions.stage_order

    @cached_property
    def simplifying_assumptions(self) -> order_conditions.Simplifying | None:
        """How far B, C and D hold."""
        return None if self._tableau is None else order_conditions.simplifying_assumptions(self._tableau)

    @cached_property
    def principal_error(self) -> order_conditions.PrincipalError[Tree] | TooManyTrees | None:
        """The coefficients of the leading error term, by trees, unless there are too many."""
        if self._tableau is None:
            return None
        try:
            return order_conditions.principal_error(self._conditions, self.order)
        except TooManyTrees as refusal:
            return refusal

    @cached_property
    def algebraically_stable(self) -> bool | None:
        """Whether two solutions of a contractive problem never come apart."""
        return None if self._tableau is None else algebraic_stability(self._tableau).holds

    @cached_property
    def modified_equation(self) -> Mapping[Tree, Exact] | None:
        """The coefficients that are not zero of the equation whose exact flow the step is, by trees."""
        if self._tableau is None:
            return None
        return {tree: c for tree, c in modified_equation(self._tableau, MODIFIED_ORDER).items() if c}

    @cached_property
    def _conditions(self) -> order_conditions.RungeKuttaConditions:
        """Those of the order and of the principal error: the stages of each tree are made once for both."""
        assert self._tableau is not None
        return order_conditions.runge_kutta_conditions(self._tableau)

    @property
    def _tableau(self) -> RungeKutta | Collocation | None:
        return self.method if isinstance(self.method, RungeKutta | Collocation) else None


# So long that they are given only when they are named.
ON_REQUEST = ("region_boundary",)
# Every fact by name, in the order in which a reader wants them; those that the method itself states, among the first.
_IDENTITY = ("method", "title", "family", "source", "stages", "explicit", "decimal", "field", "inconsistencies")
_LINEAR = (name for name in fact_names(LinearFacts) if name not in ON_REQUEST)
FACTS = tuple(dict.fromkeys((*_IDENTITY, "claimed_order", *fact_names(Facts), *_LINEAR)))
# Why a method may not have a fact.
_NO_R = "only Runge-Kutta and collocation methods have R(z)"
WHY_NONE = {
    **dict.fromkeys(("stability_function", "real_limit", "a_stable", "a_stability", "i_stable", "l_stable"), _NO_R),
    **dict.fromkeys(("sector", "limit_at_infinity", "error_constant", "modified_rate", "region_boundary"), _NO_R),
    "reduction": "no stage is superfluous",
    "stability_within_digits": "it is explicit, its coefficients are not rounded, or R has no limit for them",
    "order_but_for_rounding": f"no condition up to {TOLERANCE_ORDER} vertices fails by far more than those before it",
    "estimate": "it is not an embedded pair",
    "continuous_extensions": "the catalogue holds none",
    "ssp_coefficient": "only Runge-Kutta and collocation methods have one",
    "energy_multiplier": "the energy change of a step depends on the state",
    "invariant": "it conserves no quadratic form, or several independent ones",
    "dissipation": "the whole series vanishes",
}


# Of each kind of method that has facts only: what derives them, their names, and names given on request.
_FACTS_ONLY: Mapping[type, tuple[Callable[[Any], Any], tuple[str, ...], tuple[str, ...]]] = {
    Multistep: (MultistepFacts, MULTISTEP_FACTS, MULTISTEP_ON_REQUEST),
    Rosenbrock: (RosenbrockFacts, ROSENBROCK_FACTS, ()),
    Additive: (AdditiveFacts, ADDITIVE_FACTS, ()),
}
OTHER_FACTS = tuple(dict.fromkeys(name for _, *known in _FACTS_ONLY.values() for names in known for name in names))


def facts_only(method: FactsOnly, names: Sequence[str] = (), tolerance: Fraction | None = None) -> dict[str, Any]:
    """The named facts, else all but those on request, of a method that has facts only; the orders to a tolerance.

    Raises ValueError for an unknown name, and for a tolerance where no order is to one.
    """
    make, known, on_request = _FACTS_ONLY[type(method)]
    facts = make(method)
    if others := [name for name in names if name in FACTS and name not in (*known, *on_request)]:
        raise ValueError(f"{method.key} is {method.kind}, and has no {others[0]}; choose from {', '.join(known)}")
    found = facts_by_name(facts, names or known, (*known, *on_request))
    if tolerance is not None:
        if not hasattr(facts, "orders_within"):
            raise ValueError(f"{method.key} is {method.kind}, whose order is exact; a tolerance is for trees")
        found["order_to_tolerance"] = facts.orders_within(tolerance)
    return found


class OrderWithin(NamedTuple):
    """The largest p such that every residual of the order conditions up to p is at most `tolerance` in size."""

    tolerance: Fraction
    order: int
    order_second_order_problems: int | None
    embedded_order: int | None


def general_order(method: Method) -> OrderFact[Any]:
    """The order by `general_conditions`, never that on linear problems alone."""
    if isinstance(method, Collocation):
        return order_conditions.order(method)  # by its quadrature formula
    return order_conditions.order_of(general_conditions(method))


def order_within(method: Method, tolerance: Fraction) -> OrderWithin:
    """The order to a tolerance, also on second-order problems, and of an embedded method.

    Not the order: that is decided by equality alone. Looked for up to TOLERANCE_ORDER, or to the order where that is
    higher. Raises ValueError for a negative tolerance.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, order_within
    >>> order_within(METHODS["tsitouras54"], Fraction(1, 10**12)).order
    5
    """
    demand_method(method)
    if tolerance < 0:
        raise ValueError(f"tolerance {tolerance} is below zero")

    def within(conditions: Conditions[Any]) -> int:
        return order_conditions.order_to_tolerance(conditions, tolerance)

    exact_order = general_order(method).order
    second = order_conditions.embedded_conditions(method) if isinstance(method, RungeKutta) else None
    return OrderWithin(
        tolerance,
        exact_order if exact_order >= TOLERANCE_ORDER else within(general_conditions(method)),
        within(partitioned_trees.nystrom_conditions(method)) if isinstance(method, Splitting) else None,
        None if second is None else within(second),
    )
