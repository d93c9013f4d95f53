"""Facts that are numbers or formulas, from exact objects: of every length, and at a given h or z."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from driftproof.methods.expressions import parse_number
from driftproof.methods.number_field import Algebraic
from driftproof.methods.number_field import Exact as Coefficient
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.polynomials import Polynomial, coefficients, evaluate, exact, polynomial, scalar
from driftproof.symbolic.algebra.radicals import radical_form
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO, RealRoot
from driftproof.symbolic.algebra.text import polynomial_text, rational_text
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.limits import INFINITY, Infinity, Limit, real_limit
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.oscillator import determinant, energy_multiplier, spread
from driftproof.symbolic.linear.phase import LeadingTerm, error_constant
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent
from driftproof.texts.questions.asking import Asking
from driftproof.texts.questions.value import CERTIFIED, Value

ExactFact: TypeAlias = Callable[[Asking, LinearFacts], Value]

DEGREES = "degrees"


class NoSuchFact(ValueError):
    """The method has no such fact; the message says why, where there is more to say than that."""


def of_number(x: Coefficient | Limit) -> Value:
    """A number of any kind that facts consist of, with its radicals where it has some; oo is no number."""
    if isinstance(x, Infinity):
        return Value("", None, form="oo")
    if isinstance(x, RealRoot):
        return Value("", x.rational) if x.rational is not None else _of_root(x)
    return Value("", x.as_fraction() if isinstance(x, Algebraic) and x.is_rational else x)


def _of_root(root: RealRoot) -> Value:
    """An irrational root: in its quadratic field where it lies in one, so that arithmetic with it stays exact."""
    form = radical_form(root)
    if form is not None and len(root.minimal) == 3:
        return Value("", parse_number(form, "root"), form=form)
    return Value("", root.ball, form=form)


def _of_function(asking: Asking, f: RationalFunction, variable: str, *, part: bool = False) -> Value:
    """A rational function as a formula, or its value where the variable is set; a constant is a number.

    `part` is true where the readout has been seen to.
    """
    asking.demand_only(variable, readout=part)
    if variable in asking.asked.settings:
        x = asking.asked.settings[variable].value
        try:
            return of_number(exact(f(scalar(x))))
        except ZeroDivisionError:
            raise ValueError(f"{asking.head} has a pole at {variable} = {x}") from None
    if f.num.degree() <= 0 and f.den.degree() <= 0:
        return of_number(exact(f(scalar(0))))
    return Value("", None, form=rational_text(f, variable))


def _stability(facts: LinearFacts) -> RationalFunction:
    if facts.stability_function is None:
        raise NoSuchFact("only Runge-Kutta and collocation methods have R(z)")
    return facts.stability_function


def _stability_function(asking: Asking, facts: LinearFacts) -> Value:
    return _of_function(asking, _stability(facts), "z")


def _determinant(asking: Asking, facts: LinearFacts) -> Value:
    return _of_function(asking, determinant(facts.matrix), "h")


def _energy_multiplier(asking: Asking, facts: LinearFacts) -> Value:
    """As a function of h, not of h²."""
    found = energy_multiplier(facts.matrix)
    if found is None:
        raise NoSuchFact("what a step does to the energy depends on the state")
    return _of_function(asking, fraction(spread(found.num), spread(found.den)), "h")


def _one_step_matrix(asking: Asking, facts: LinearFacts) -> Value:
    (qq, qv), (vq, vv) = facts.matrix
    return _of_function(asking, asking.readout({"M_qq": qq, "M_qv": qv, "M_vq": vq, "M_vv": vv}), "h", part=True)


def _invariant(asking: Asking, facts: LinearFacts) -> Value:
    """The conserved quadratic: a formula in h, q and v, one coefficient of it, or its value at h and a state."""
    found = facts.conserved_quadratics
    if len(found) != 1:
        raise NoSuchFact(f"the quadratics that it conserves form a space of dimension {len(found)}")
    forms = dict(zip(("q2", "qv", "v2"), found[0].coefficients, strict=True))
    if asking.asked.readout is not None:
        return _of_function(asking, fraction(asking.readout(forms)), "h", part=True)
    asking.demand_only("h", start=True)
    h = asking.asked.settings.get("h")
    if h is not None:
        forms = {name: polynomial([exact(evaluate(p, scalar(h.value)))]) for name, p in forms.items()}
    if asking.asked.start is None:
        return Value("", None, form=_quadratic_text(forms))
    if h is None:
        raise ValueError("the value of the invariant at a state needs h, as in h=1/2 from 1,0")
    q, v = asking.start
    return of_number(exact(sum(p[0] * scalar(x) for p, x in zip(forms.values(), (q * q, q * v, v * v), strict=True))))


def _quadratic_text(forms: dict[str, Polynomial]) -> str:
    """Σ coefficient*monomial in SymPy's syntax."""
    text = ""
    for monomial, p in zip(("q**2", "q*v", "v**2"), forms.values(), strict=True):
        terms = [(k, c) for k, c in enumerate(coefficients(p)) if c]
        if len(terms) == 1:
            [(k, c)] = terms
            power = "" if k == 0 else "h*" if k == 1 else f"h**{k}*"
            term = polynomial_text(polynomial([0, c]), power + monomial)
        else:
            term = f"({polynomial_text(p, 'h')})*{monomial}"
        if terms:
            size = term.removeprefix("-")
            text += f" {'+' if size == term else '-'} {size}" if text else term
    return text or "0"


def _leading(find: Callable[[LinearFacts], LeadingTerm | None], variable: str, whole: bool) -> ExactFact:
    """The leading term of a series: the term itself where `whole`, else its coefficient; or what the readout names."""

    def found(asking: Asking, facts: LinearFacts) -> Value:
        term = find(facts)
        if term is None:
            raise NoSuchFact("the whole series vanishes")
        if asking.asked.readout is None and whole:
            monomial = polynomial([*term.power * [0], term.coefficient])
            return _of_function(asking, fraction(monomial), variable)
        asking.demand_only(readout=True)
        parts: dict[str, Coefficient] = {"coefficient": term.coefficient, "power": Fraction(term.power)}
        return of_number(asking.readout(parts) if asking.asked.readout else term.coefficient)

    return found


def _real_limit(asking: Asking, facts: LinearFacts) -> Value:
    asking.demand_only()
    return of_number(real_limit(_stability(facts)))


def _imaginary_limit(asking: Asking, facts: LinearFacts) -> Value:
    asking.demand_only()
    return of_number(facts.imaginary_limit)


def _limit_at_infinity(asking: Asking, facts: LinearFacts) -> Value:
    """The limit of R(z) as z grows, oo where it has none."""
    asking.demand_only()
    found = _stability(facts).at_infinity()
    return of_number(INFINITY if found is None else found)


def _ssp_coefficient(asking: Asking, facts: LinearFacts) -> Value:
    asking.demand_only()
    if not isinstance(facts.method, RungeKutta | Collocation):
        raise NoSuchFact("only Runge-Kutta and collocation methods have one")
    return of_number(ssp_coefficient(facts.method))


def _sector(asking: Asking, facts: LinearFacts) -> Value:
    """The sector of A(α)-stability: its tangent, or α in degrees."""
    asking.demand_only(readout=True)
    unit, tangent = asking.readout({"degrees": DEGREES, "tan": None}), facts.sector
    if tangent is None:
        raise NoSuchFact("only Runge-Kutta and collocation methods have R(z)")
    if unit is None:
        return Value("", tangent.ball, CERTIFIED) if isinstance(tangent, EnclosedTangent) else of_number(tangent)
    if isinstance(tangent, Infinity) or tangent == ZERO:
        return Value("", Fraction(0 if tangent == ZERO else 90), unit=unit)
    return Value("", lambda: tangent.ball().atan() * 180 / arb.pi(), CERTIFIED, unit)


EXACT_FACTS: dict[str, ExactFact] = {
    "stability_function": _stability_function,
    "one_step_matrix": _one_step_matrix,
    "determinant": _determinant,
    "energy_multiplier": _energy_multiplier,
    "invariant": _invariant,
    "real_limit": _real_limit,
    "imaginary_limit": _imaginary_limit,
    "sector": _sector,
    "ssp_coefficient": _ssp_coefficient,
    "limit_at_infinity": _limit_at_infinity,
    "error_constant": _leading(lambda facts: error_constant(_stability(facts)), "z", whole=False),
    "dispersion": _leading(lambda facts: facts.dispersion, "h", whole=True),
    "dissipation": _leading(lambda facts: facts.dissipation, "h", whole=True),
}
