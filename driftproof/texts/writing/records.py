"""Facts as records, JSON-ready: exact numbers as strings, polynomials as lists with the constant term first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import singledispatch
from typing import Any

from driftproof.methods.families import Family
from driftproof.methods.number_field import NumberField
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import Json
from driftproof.symbolic.algebra.certified import decide_by_enclosure, significant
from driftproof.symbolic.algebra.radicals import (
    PRINTED_DIGITS,
    integer_polynomial_text,
    is_readable,
    radical_form,
    root_decimal,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, rational_root, root_of
from driftproof.symbolic.facts import FACTS, ON_REQUEST, Facts
from driftproof.symbolic.family_facts import (
    FAMILY_FACTS,
    FailingTree,
    FamilyFacts,
    FamilyFunction,
    FamilyTerm,
    LimitPiece,
    OrderSet,
)
from driftproof.symbolic.linear.a_stability import Angle, EnclosedTangent
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary
from driftproof.symbolic.linear.facts import (
    TERMS,
    ExactFunction,
    ModifiedEnergy,
    PowerSeries,
    RegionBoundary,
    facts_by_name,
)
from driftproof.symbolic.linear.families import Interval, ParameterSet
from driftproof.symbolic.linear.invariants import QuadraticForm
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.region import PLACES
from driftproof.symbolic.linear.stability_limits import INFINITY, Infinity
from driftproof.symbolic.linear.systems import SYSTEM_FACTS, EigenvalueLimit, facts_on_system
from driftproof.symbolic.trees.order_conditions import OrderFact, PrincipalError, Simplifying
from driftproof.symbolic.trees.rooted_trees import to_brackets


@dataclass(frozen=True)
class Formula:
    """A formula in SymPy's syntax, and the function that it is where it is one of one variable."""

    text: str
    function: ExactFunction | None = None

    def __str__(self) -> str:
        """The formula."""
        return self.text


def facts_of(method: Method, names: Sequence[str] = FACTS, terms: int = TERMS) -> dict[str, Json]:
    """The named facts of the method, JSON-ready: numbers are strings, null is what the method has not.

    Only those asked for are computed. `terms` is the length of series. Beside FACTS, points of the boundary of the
    stability region may be named, "region_boundary". Raises ValueError for an unknown name.

    >>> from driftproof import METHODS, facts_of
    >>> facts_of(METHODS["rk4"], ["order", "stability_function"])
    {'order': 4, 'stability_function': {'num': ['1', '1', '1/2', '1/6', '1/24'], 'den': ['1']}}
    """
    return record(facts_by_name(Facts(method, terms), names, (*FACTS, *ON_REQUEST)))  # type: ignore[no-any-return]


def system_facts(
    method: Method, rows: Sequence[Sequence[Fraction]], names: Sequence[str] = tuple(SYSTEM_FACTS)
) -> dict[str, Json]:
    """The named facts of the method on z' = Az, A given by its rows: one-step matrix, eigenvalues, limits of h.

    Raises ValueError for an unknown name, a matrix that is not square, and a system that the method is not for.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, system_facts
    >>> system_facts(METHODS["forward_euler"], [[Fraction(-3)]], ["step_limit"])["step_limit"]["exact"]
    '2/3'
    """
    return record(facts_on_system(method, rows, names))  # type: ignore[no-any-return]


def family_facts(family: Family, names: Sequence[str] = FAMILY_FACTS) -> dict[str, Json]:
    """The named facts of the family, for almost all or for which values of the parameter; those of a member differ.

    Sets are exact unions of intervals, functions in SymPy's syntax. Raises ValueError for an unknown name.

    >>> from driftproof import FAMILIES, family_facts
    >>> family_facts(FAMILIES["sdirk_order_2"], ["a_stable"])["a_stable"]["set"]
    '[1/4, oo)'
    """
    return record(facts_by_name(FamilyFacts(family), names, FAMILY_FACTS))  # type: ignore[no-any-return]


# --- what facts consist of


def parts(value: Any) -> Mapping[str, Any] | None:
    """The parts of a fact that has some, by name; None for a number, a word, a formula, a list."""
    if type(value) in _PARTS:
        return _PARTS[type(value)](value)
    if isinstance(value, Mapping):
        return {key if isinstance(key, str) else to_brackets(key): part for key, part in value.items()}
    return value._asdict() if hasattr(value, "_asdict") else None


def _of_tree(found: OrderFact[Any] | FailingTree) -> dict[str, Any]:
    tree = found.failing_tree if isinstance(found, OrderFact) else found.tree
    return {"tree": to_brackets(tree), "residual": _in_parameter(found.residual)}


def _in_parameter(x: Any) -> Any:
    return Formula(str(x), x) if isinstance(x, ExactFunction) else x


def _of_hamiltonian(found: ModifiedEnergy) -> dict[str, Any]:
    """H̃ = factor*(q2 q² + qv qv + v2 v²), in the words of `ModifiedHamiltonian`; the factor also as a series."""
    cosine = ExactFunction(found.hamiltonian.cosine, "h")
    return {
        "factor": Formula(f"acos({cosine})/sqrt(1 - ({cosine})**2)"),
        "quadratic": {name: _in_step(getattr(found.hamiltonian, name)) for name in ("q2", "qv", "v2")},
        "valid_limit": found.hamiltonian.limit,
        "factor_series": found.factor_series,
    }


def _in_step(f: RationalFunction) -> Formula:
    return Formula(str(ExactFunction(f, "h")), ExactFunction(f, "h"))


def _of_eigenvalue(found: EigenvalueLimit) -> dict[str, Any]:
    """The eigenvalue, of a pair the one above the real axis, and for which h its part of the step stays bounded."""
    eigenvalue, bound = found
    limit, attained = (bound, None) if isinstance(bound, Exception) else bound
    names = ("value", "multiplicity", "largest_block", "limit", "attained")
    return dict(zip(names, (eigenvalue.place, eigenvalue.multiplicity, eigenvalue.block, limit, attained), strict=True))


_PARTS: dict[type, Callable[[Any], dict[str, Any]]] = {
    OrderFact: _of_tree,
    FailingTree: _of_tree,
    PrincipalError: lambda x: {
        "vertices": x.vertices,
        "squared_norm": x.squared_norm,
        "coefficients": {to_brackets(tree): c for tree, c in x.coefficients},
    },
    Simplifying: lambda x: {name: INFINITY if n is None else n for name, n in zip("BCD", (x.b, x.c, x.d), strict=True)},
    QuadraticForm: lambda x: {
        name: _in_step(fraction(c)) for name, c in zip(("q2", "qv", "v2"), x.coefficients, strict=True)
    },
    ModifiedEnergy: _of_hamiltonian,
    LeadingTerm: lambda x: {
        "power": x.power,
        "coefficient": x.coefficient if is_readable(x.coefficient) else root_of(x.coefficient),
    },
    RegionBoundary: lambda x: {
        "radius": f"1e-{PLACES}",
        "points": [dict(zip(("cosine", "re", "im"), point, strict=True)) for point in x.points],
    },
    FamilyFunction: lambda x: {"num": [str(c) for c in x.num], "den": [str(c) for c in x.den]},
    FamilyTerm: lambda x: {"power": x.power, "coefficient": _in_parameter(x.coefficient)},
    ParameterSet: lambda x: {"set": str(x), "intervals": x.intervals},
    OrderSet: lambda x: {"order": x.order, "set": str(x.values), "intervals": x.values.intervals},
    Interval: lambda x: {
        "low": "-oo" if x.low is None else x.low,
        "high": "oo" if x.high is None else x.high,
        "low_closed": x.low_closed,
        "high_closed": x.high_closed,
    },
    LimitPiece: lambda x: {**x._asdict(), "where": str(x.where), "interval": x.where},
    EigenvalueLimit: _of_eigenvalue,
}


# --- the writer


@singledispatch
def record(value: Any) -> Json:
    """A fact, or what facts consist of, as JSON has it: null, true, counts, words, "1/2", [...], {...}."""
    found = parts(value)
    if found is not None:
        return {name: record(part) for name, part in found.items()}
    if isinstance(value, list | tuple):
        return [record(part) for part in value]
    return value if value is None or isinstance(value, bool | int) else str(value)


@record.register
def _(value: Angle) -> str:
    return significant(value.exact, PRINTED_DIGITS) if callable(value.exact) else str(value.exact)


@record.register(RungeKutta | Splitting | Nystrom | Collocation | Family)
def _(value: Method | Family) -> str:
    return value.key


@record.register
def _(value: Exception) -> dict[str, str]:
    return {"refused": str(value)}


@record.register
def _(value: PowerSeries) -> list[str]:
    return [str(c) for c in value.coefficients]


@record.register(RationalFunction | ExactFunction)
def _(value: RationalFunction | ExactFunction) -> dict[str, list[str]]:
    return (value.f if isinstance(value, ExactFunction) else value).data()


@record.register
def _(value: Infinity) -> str:
    return value.value


@record.register
def number_record(value: RealRoot, digits: int = PRINTED_DIGITS) -> str | dict[str, Any]:
    """ "0" or {"exact", "minpoly", "interval", "decimal"}: radicals in SymPy's syntax or None, polynomial in x.

    The number is the one root of its polynomial in the closed interval; `root_decimal` is rounded correctly.
    """
    if value == ZERO_ROOT:
        return "0"
    return {
        "exact": radical_form(value),
        "minpoly": integer_polynomial_text(value.minimal),
        "interval": [str(end) for end in value.interval()],
        "decimal": root_decimal(value, digits),
    }


@record.register
def _(value: EnclosedTangent) -> dict[str, Any]:
    billionths = decide_by_enclosure(value.ball, lambda x: int(x * 10**9))
    interval = [str(Fraction(n, 10**9)) for n in (billionths, billionths + 1)]
    return {"exact": None, "minpoly": None, "interval": interval, "decimal": significant(value.ball, PRINTED_DIGITS)}


@record.register
def _(value: NumberField) -> dict[str, Any]:
    return {
        "generator": value.name,
        "minpoly": integer_polynomial_text(value.minimal),
        "interval": [str(value.low), str(value.high)],
        "decimal": significant(value.generator, PRINTED_DIGITS),
    }


@record.register
def _(value: Imaginary) -> dict[str, Any]:
    size = radical_form(value.size)
    exact = size and _times_i(size)
    return {
        "exact": exact,
        "minpoly": integer_polynomial_text(value.minimal),
        "real": "0",
        "imaginary": root_decimal(value.size),
    }


@record.register
def _(value: Complex) -> dict[str, Any]:
    exact = None
    if value.degree == 2:
        total, product = value.sum_and_product()
        square = product - total * total / 4
        height = radical_form(rational_root(Fraction(int(square.p), int(square.q))).square_root())
        exact = height and f"{total / 2} + {_times_i(height)}"
    real, imaginary = (significant(x, PRINTED_DIGITS) for x in (lambda: value.ball().real, lambda: value.ball().imag))
    return {
        "exact": exact,
        "minpoly": integer_polynomial_text(value.minimal),
        "real": real,
        "imaginary": imaginary,
    }


def _times_i(size: str) -> str:
    """The number times i, e.g. "sqrt(399)/20*I"."""
    return "I" if size == "1" else f"({size})*I" if " " in size else f"{size}*I"
