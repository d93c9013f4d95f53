"""Every fact of this package about one method, each computed when first asked for, as JSON-ready values."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeAlias

from methods.schemes import Collocation, Method, RungeKutta
from symbolic.linear.bounded_powers import bounded_limit
from symbolic.linear.implicit_stability import Decision, a_stability, i_stability, l_stability
from symbolic.linear.invariants import (
    ModifiedHamiltonian,
    Quadratic,
    conserved_quadratics,
    definite_limit,
    modified_hamiltonian,
)
from symbolic.linear.limits import INFINITY, Limit, data, imaginary_limit, imaginary_margin, real_limit
from symbolic.linear.matrices import StepMatrix
from symbolic.linear.monotonicity import ssp_coefficient
from symbolic.linear.order_reduction import prothero_robinson
from symbolic.linear.oscillator import (
    determinant,
    energy_multiplier,
    energy_multiplier_of,
    is_matrix_symmetric,
    one_step_matrix,
    spread,
    stability_function_of,
)
from symbolic.linear.phase import (
    LeadingTerm,
    angle_error,
    angle_series,
    damping,
    damping_series,
    dispersion,
    dispersion_series,
    dissipation,
    dissipation_series,
    error_constant,
    is_linearly_symmetric,
    matrix_error,
    modified_factor_series,
    modified_rate,
)
from symbolic.linear.polynomials import coefficients, exact
from symbolic.linear.rational_functions import RationalFunction, fraction
from symbolic.linear.sector import sector_degrees, sector_tangent, tangent_data
from symbolic.linear.sector_enclosure import EnclosedTangent
from symbolic.linear.series import Series
from symbolic.linear.structure import is_first_same_as_last, is_stiffly_accurate, is_symmetric, is_symplectic
from symbolic.linear.text import polynomial_text, rational_text

Json: TypeAlias = Any

TERMS = 12


class LinearFacts:
    """The exact facts about `method`; properties hold exact objects, `FACTS` turns them into JSON-ready values."""

    def __init__(self, method: Method, terms: int = TERMS) -> None:
        """Compute nothing yet; `terms` is the length of the series."""
        self.method = method
        self.terms = terms

    @cached_property
    def stability_function(self) -> RationalFunction | None:
        """R(z), where the method has one."""
        return stability_function_of(self.method)

    @cached_property
    def matrix(self) -> StepMatrix:
        """M(h) on the oscillator."""
        return one_step_matrix(self.method)

    @cached_property
    def real_limit(self) -> Limit | None:
        """The real stability limit; None without R(z)."""
        return None if self.stability_function is None else real_limit(self.stability_function)

    @cached_property
    def imaginary_limit(self) -> Limit:
        """The imaginary stability limit; without R(z), the largest H with bounded powers of M(h) on (0, H)."""
        r = self.stability_function
        return bounded_limit(self.matrix) if r is None else imaginary_limit(r)

    @cached_property
    def a_stability(self) -> Decision | None:
        """A-stability with its reason; None without R(z)."""
        return None if self.stability_function is None else a_stability(self.stability_function)

    @cached_property
    def sector(self) -> Limit | EnclosedTangent | None:
        """tan α of A(α)-stability; None without R(z)."""
        if self.stability_function is None:
            return None
        return INFINITY if self.a_stability else sector_tangent(self.stability_function)

    @cached_property
    def dispersion(self) -> LeadingTerm:
        """The leading term of arg R(ih) - h, without R(z) of the eigenvalue angle minus h."""
        return angle_error(self.matrix) if self.stability_function is None else dispersion(self.stability_function)

    @cached_property
    def dissipation(self) -> LeadingTerm | None:
        """The leading term of log |R(ih)|, without R(z) of half log det M; None where it vanishes."""
        return damping(self.matrix) if self.stability_function is None else dissipation(self.stability_function)

    @cached_property
    def conserved_quadratics(self) -> list[Quadratic]:
        """A basis of the quadratics that a step on the oscillator conserves."""
        return conserved_quadratics(self.matrix)

    @cached_property
    def modified_hamiltonian(self) -> ModifiedHamiltonian | None:
        """The Hamiltonian whose exact flow the step is on the oscillator; None where there is none."""
        return modified_hamiltonian(self.matrix)

    def value(self, name: str) -> Json:
        """The fact `name` as a JSON-ready value. Raises KeyError for an unknown one."""
        return FACTS[name](self)


def linear_order(facts: LinearFacts) -> int:
    """The order on linear problems: of R(z), or of M(h) on the oscillator."""
    r = facts.stability_function
    return (matrix_error(facts.matrix)[0] if r is None else error_constant(r).power) - 1


def _stability_data(facts: LinearFacts) -> Json:
    return None if facts.stability_function is None else facts.stability_function.data()


def _at_infinity(facts: LinearFacts) -> str | None:
    return None if facts.stability_function is None else _limit_text(facts.stability_function)


def _limit_text(f: RationalFunction) -> str:
    value = f.at_infinity()
    return "oo" if value is None else str(value)


def _decided(decide: Callable[[RationalFunction], Decision]) -> Callable[[LinearFacts], bool | None]:
    return lambda facts: None if facts.stability_function is None else bool(decide(facts.stability_function))


def _decision_data(facts: LinearFacts) -> Json:
    """`margin`: |Q(iy)|² - |P(iy)|², ascending in y²."""
    found = facts.a_stability
    if found is None or facts.stability_function is None:
        return None
    witness = None if found.witness is None else str(found.witness)
    margin = imaginary_margin(facts.stability_function)
    return {
        "holds": found.holds,
        "reason": found.reason,
        "witness": witness,
        "margin": [str(c) for c in coefficients(margin)],
    }


def _sector_data(facts: LinearFacts) -> Json:
    if facts.sector is None:
        return None
    return {"tan": tangent_data(facts.sector), "degrees": sector_degrees(facts.sector)}


def _optional_limit(limit: Limit | None) -> Json:
    return None if limit is None else data(limit)


def _optional_term(term: LeadingTerm | None) -> Json:
    return None if term is None else term.data()


def _energy_data(facts: LinearFacts) -> Json:
    r = facts.stability_function
    found = energy_multiplier(facts.matrix) if r is None else energy_multiplier_of(r)
    return None if found is None else found.data()


def _determinant_data(facts: LinearFacts) -> Json:
    r = facts.stability_function
    if r is None:
        return determinant(facts.matrix).data()
    area = energy_multiplier_of(r)  # det R(hJ) = |R(ih)|², in h instead of h²
    return fraction(spread(area.num), spread(area.den)).data()


def _quadratic_data(form: Quadratic) -> Json:
    names = ("q2", "qv", "v2")
    return {name: polynomial_text(c, "h") for name, c in zip(names, form.coefficients, strict=True)}


def _invariant_data(facts: LinearFacts) -> Json:
    found = facts.conserved_quadratics
    return _quadratic_data(found[0]) if len(found) == 1 else None


def _conserved_data(facts: LinearFacts) -> Json:
    return [
        {"quadratic": _quadratic_data(form), "definite_limit": data(definite_limit(form))}
        for form in facts.conserved_quadratics
    ]


def _modified_data(facts: LinearFacts) -> Json:
    """H̃ = factor*(q2 q² + qv qv + v2 v²), in the words of `ModifiedHamiltonian`."""
    found = facts.modified_hamiltonian
    if found is None:
        return None
    cosine = rational_text(found.cosine, "h")
    return {
        "factor": f"acos({cosine})/sqrt(1 - ({cosine})**2)",
        "quadratic": {name: rational_text(getattr(found, name), "h") for name in ("q2", "qv", "v2")},
        "valid_limit": data(found.limit),
        "factor_series": _series_data(modified_factor_series(facts.matrix, facts.terms)),
    }


def _series_data(series: Series) -> list[str]:
    return [str(exact(c)) for c in series]


def _phase_series(facts: LinearFacts) -> Json:
    r, n = facts.stability_function, facts.terms
    return _series_data(angle_series(facts.matrix, n) if r is None else dispersion_series(r, n))


def _damping_series(facts: LinearFacts) -> Json:
    r, n = facts.stability_function, facts.terms
    return _series_data(damping_series(facts.matrix, n) if r is None else dissipation_series(r, n))


def _modified_rate(facts: LinearFacts) -> Json:
    r = facts.stability_function
    return None if r is None else _series_data(modified_rate(r, facts.terms))


def _linearly_symmetric(facts: LinearFacts) -> bool:
    r = facts.stability_function
    return is_matrix_symmetric(facts.matrix) if r is None else is_linearly_symmetric(r)


def _error_constant(facts: LinearFacts) -> Json:
    return None if facts.stability_function is None else error_constant(facts.stability_function).data()


def _ssp_data(facts: LinearFacts) -> Json:
    return data(ssp_coefficient(facts.method)) if isinstance(facts.method, RungeKutta) else None


def _order_reduction(facts: LinearFacts) -> Json:
    """The functions of Prothero and Robinson that are not zero, up to the power at which the linear order ends."""
    if not isinstance(facts.method, RungeKutta | Collocation):
        return None
    functions = ((k, prothero_robinson(facts.method, k)) for k in range(1, linear_order(facts) + 2))
    return [{"power": k, "function": f.data(), "at_infinity": _limit_text(f)} for k, f in functions if f.num != 0]


FACTS: dict[str, Callable[[LinearFacts], Json]] = {
    "stability_function": _stability_data,
    "one_step_matrix": lambda facts: [[entry.data() for entry in row] for row in facts.matrix],
    "determinant": _determinant_data,
    "energy_multiplier": _energy_data,
    "invariant": _invariant_data,
    "conserved_quadratics": _conserved_data,
    "modified_hamiltonian": _modified_data,
    "real_limit": lambda facts: _optional_limit(facts.real_limit),
    "imaginary_limit": lambda facts: data(facts.imaginary_limit),
    "a_stable": lambda facts: None if facts.a_stability is None else facts.a_stability.holds,
    "a_stability": _decision_data,
    "i_stable": _decided(i_stability),
    "l_stable": _decided(l_stability),
    "sector": _sector_data,
    "limit_at_infinity": _at_infinity,
    "stiffly_accurate": lambda facts: is_stiffly_accurate(facts.method),
    "first_same_as_last": lambda facts: is_first_same_as_last(facts.method),
    "symplectic": lambda facts: is_symplectic(facts.method),
    "symmetric": lambda facts: is_symmetric(facts.method),
    "linearly_symmetric": _linearly_symmetric,
    "linear_order": linear_order,
    "error_constant": _error_constant,
    "dispersion": lambda facts: facts.dispersion.data(),
    "dissipation": lambda facts: _optional_term(facts.dissipation),
    "dispersion_series": _phase_series,
    "dissipation_series": _damping_series,
    "modified_rate": _modified_rate,
    "order_reduction": _order_reduction,
    "ssp_coefficient": _ssp_data,
}
