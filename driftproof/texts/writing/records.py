"""Write facts as JSON: exact numbers as strings, polynomials as lists with the constant term first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from driftproof.methods.catalogue import FurtherMethod
from driftproof.methods.families import Family
from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.methods.numbers.number_field import Algebraic, NumberField
from driftproof.methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import Json
from driftproof.symbolic.algebra import radicals
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.algebra.radicals import PRINTED_DIGITS, integer_polynomial_text
from driftproof.symbolic.algebra.rational_functions import RationalFunction, exact_text, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, rational_root, root_of
from driftproof.symbolic.family_facts import FailingTree, LimitPiece, OrderSet
from driftproof.symbolic.linear import fact_values as linear
from driftproof.symbolic.linear.a_stability import Angle
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary
from driftproof.symbolic.linear.families import Interval, ParameterSet
from driftproof.symbolic.linear.invariants import QuadraticForm
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.region import PLACES
from driftproof.symbolic.linear.stability_limits import INFINITY
from driftproof.symbolic.linear.systems import EigenvalueLimit
from driftproof.symbolic.trees.order_conditions import OrderFact, PrincipalError, Simplifying
from driftproof.symbolic.trees.rooted_trees import to_brackets

# Characters of a number that people may read: two integers of thirty digits, or a few terms with a root.
LONGEST_BARE = 60
# The 1842 trees of order 11 take 100 kB; those of order 15, of a method of 7 stages, took 5 MB.
MOST_TREES_READ = 2000


def parts(value: Any) -> Mapping[str, Any] | None:
    """The parts of a composite fact, by name; None for a number, words, a formula or a list."""
    if type(value) in _PARTS:
        return _PARTS[type(value)](value)
    if isinstance(value, Mapping):
        return {key if isinstance(key, str) else to_brackets(key): part for key, part in value.items()}
    return value._asdict() if hasattr(value, "_asdict") else None


def _hamiltonian_parts(found: linear.ModifiedEnergy) -> dict[str, Any]:
    """H̃ = factor*(q2 q² + qv qv + v2 v²), as in `ModifiedHamiltonian`; the factor also as a series."""
    cosine = linear.ExactFunction(found.hamiltonian.cosine, "h")
    forms = {name: linear.ExactFunction(getattr(found.hamiltonian, name), "h") for name in ("q2", "qv", "v2")}
    return {
        "factor": linear.Formula(f"acos({cosine})/sqrt(1 - ({cosine})**2)"),
        "quadratic": {name: form.as_formula() for name, form in forms.items()},
        "valid_limit": found.hamiltonian.limit,
        "factor_series": found.factor_series,
    }


def _eigenvalue_parts(found: EigenvalueLimit) -> dict[str, Any]:
    """The eigenvalue, for a pair the one above the real axis, and the limit of h for which its powers stay bounded."""
    eigenvalue, bound = found
    limit, attained = (bound, None) if isinstance(bound, Exception) else bound
    names = ("value", "multiplicity", "largest_block", "limit", "attained")
    return dict(zip(names, (eigenvalue.place, eigenvalue.multiplicity, eigenvalue.block, limit, attained), strict=True))


def number_record(value: RealRoot, digits: int = PRINTED_DIGITS) -> dict[str, Any]:
    """{"exact", "minpoly", "interval", "decimal"} of an algebraic number: radicals or None, and its polynomial in x.

    The number is the only root of the polynomial in the closed interval; the decimal is rounded correctly.
    """
    exact, minimal = radicals.radical_form(value), integer_polynomial_text(value.minimal)
    ends = [str(end) for end in value.interval()]
    return {"exact": exact, "minpoly": minimal, "interval": ends, "decimal": radicals.root_decimal(value, digits)}


def _place_parts(place: Imaginary | Complex) -> dict[str, Any]:
    """A non-real eigenvalue, the one above the real axis."""
    exact = None
    if isinstance(place, Imaginary):
        size = radicals.radical_form(place.size)
        exact, real, imaginary = size and _times_i(size), "0", radicals.root_decimal(place.size)
    else:
        parts_of = (lambda: place.ball().real), (lambda: place.ball().imag)
        real, imaginary = (significant(x, PRINTED_DIGITS) for x in parts_of)
        if place.degree == 2:
            total, product = place.sum_and_product()
            square = product - total * total / 4
            height = radicals.radical_form(rational_root(as_fraction(square)).square_root())
            exact = height and f"{total / 2} + {_times_i(height)}"
    return {"exact": exact, "minpoly": integer_polynomial_text(place.minimal), "real": real, "imaginary": imaginary}


def _times_i(size: str) -> str:
    """The text of a number times i, e.g. "sqrt(399)/20*I"."""
    return "I" if size == "1" else f"({size})*I" if " " in size else f"{size}*I"


_PARTS: dict[type, Callable[[Any], dict[str, Any]]] = {
    OrderFact: lambda x: {"tree": to_brackets(x.failing_tree), "residual": x.residual},
    FailingTree: lambda x: {"tree": to_brackets(x.tree), "residual": x.residual},
    PrincipalError: lambda x: {
        "vertices": x.vertices,
        "squared_norm": x.squared_norm,
        "coefficients": {to_brackets(tree): c for tree, c in x.coefficients}
        if len(x.errors) <= MOST_TREES_READ
        else f"of {len(x.errors)} trees, too many to list; Facts(method).principal_error has them",
    },
    Simplifying: lambda x: {name: INFINITY if n is None else n for name, n in zip("BCD", (x.b, x.c, x.d), strict=True)},
    QuadraticForm: lambda x: {
        name: linear.ExactFunction(fraction(c), "h").as_formula()
        for name, c in zip(("q2", "qv", "v2"), x.coefficients, strict=True)
    },
    linear.ModifiedEnergy: _hamiltonian_parts,
    LeadingTerm: lambda x: {
        "power": x.power,
        "coefficient": x.coefficient if radicals.is_readable(x.coefficient) else root_of(x.coefficient),
    },
    linear.RegionBoundary: lambda x: {
        "radius": f"1e-{PLACES}",
        "points": [dict(zip(("cosine", "re", "im"), point, strict=True)) for point in x.points],
    },
    ParameterSet: lambda x: {"set": str(x), "intervals": x.intervals},
    OrderSet: lambda x: {"order": x.order, "set": str(x.values), "intervals": x.values.intervals},
    Interval: lambda x: {
        "low": "-oo" if x.low is None else x.low,
        "high": "oo" if x.high is None else x.high,
        "low_closed": x.low_closed,
        "high_closed": x.high_closed,
    },
    LimitPiece: lambda x: {**x._asdict(), "where": str(x.where), "interval": x.where},
    EigenvalueLimit: _eigenvalue_parts,
    RealRoot: number_record,
    NumberField: lambda x: {
        "generator": x.name,
        "minpoly": integer_polynomial_text(x.minimal),
        "interval": [str(x.low), str(x.high)],
        "decimal": significant(x.generator, PRINTED_DIGITS),
    },
    Imaginary: _place_parts,
    Complex: _place_parts,
}
# Types without parts that str() does not write, and their writers.
_SIMPLE: tuple[tuple[Any, Callable[[Any], Json]], ...] = (
    (RungeKutta | Splitting | Nystrom | Collocation | Family | FurtherMethod, lambda x: x.key),
    (RationalFunction, RationalFunction.data),
    (linear.ExactFunction, lambda x: x.f.data()),
    (linear.TruncatedSeries, lambda x: [exact_text(c) for c in x.coefficients]),
    (Angle, lambda x: significant(x.exact, PRINTED_DIGITS) if callable(x.exact) else str(x.exact)),
    (Exception, lambda x: {"refused": str(x)}),
)


def is_long(value: Any) -> bool:
    """True for a number with an exact form too long to read, which needs a decimal beside it."""
    return isinstance(value, Fraction | Algebraic) and len(exact_text(value)) > LONGEST_BARE


def record(value: Any) -> Json:
    """A fact or a part of one as JSON: null, true, counts, words, "1/2", [...], {...}.

    A number of more than LONGEST_BARE characters is {"exact", "decimal"}, except in a list of coefficients.
    """
    if is_long(value):
        return {"exact": exact_text(value), "decimal": significant(value, PRINTED_DIGITS)}
    for kinds, write in _SIMPLE:
        if isinstance(value, kinds):
            return write(value)
    if value == ZERO_ROOT:
        return "0"
    found = parts(value)
    if found is not None:
        return {name: record(part) for name, part in found.items()}
    if isinstance(value, list | tuple):
        return [exact_text(part) if is_long(part) else record(part) for part in value]
    return value if value is None or isinstance(value, bool | int) else str(value)
