"""Every fact of this package about one method, each computed when first asked for, as JSON-ready values."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeAlias

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, RungeKutta
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.radicals import is_readable
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.linear.bounded_powers import bounded_limit
from driftproof.symbolic.linear.implicit_stability import Decision, a_stability, i_stability, l_stability
from driftproof.symbolic.linear.invariants import (
    ModifiedHamiltonian,
    Quadratic,
    conserved_quadratics,
    modified_hamiltonian,
)
from driftproof.symbolic.linear.limits import INFINITY, Limit, data, imaginary_limit, real_limit
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.order_reduction import prothero_robinson
from driftproof.symbolic.linear.oscillator import (
    determinant,
    energy_multiplier,
    energy_multiplier_of,
    is_matrix_symmetric,
    one_step_matrix,
    spread,
    stability_function_of,
)
from driftproof.symbolic.linear.phase import (
    LeadingTerm,
    NoRotationError,
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
    turning_rate,
)
from driftproof.symbolic.linear.records import (
    at_infinity,
    boundary_record,
    conserved_record,
    decision_record,
    hamiltonian_record,
    quadratic_record,
    sector_record,
    series_record,
)
from driftproof.symbolic.linear.sector import sector_tangent
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent
from driftproof.symbolic.linear.structure import (
    is_first_same_as_last,
    is_stiffly_accurate,
    is_symmetric,
    is_symplectic,
)

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
    def dispersion(self) -> LeadingTerm | None:
        """The leading term of arg R(ih) - h, without R(z) of the eigenvalue angle minus h; None where there is none."""
        if self.stability_function is not None:
            return dispersion(self.stability_function)
        return None if self.turning_rate is None else angle_error(self.matrix)

    @cached_property
    def turning_rate(self) -> Exact | None:
        """The σ of the eigenvalue angle σh + O(h²), 1 for a consistent method; None for a step that is no rotation."""
        try:
            return turning_rate(self.matrix)
        except NoRotationError:
            return None

    @property
    def turns_readably(self) -> bool:
        """True where the series of the eigenvalue angle has coefficients that somebody can read."""
        return self.turning_rate is not None and is_readable(self.turning_rate)

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


def _a_stability(facts: LinearFacts) -> Json:
    r, found = facts.stability_function, facts.a_stability
    return None if r is None or found is None else decision_record(found, r)


def _of_r(record: Callable[[RationalFunction], Json]) -> Callable[[LinearFacts], Json]:
    """The record of R(z); null for a method without R(z)."""
    return lambda facts: None if facts.stability_function is None else record(facts.stability_function)


def _determinant(facts: LinearFacts) -> Json:
    r = facts.stability_function
    if r is None:
        return determinant(facts.matrix).data()
    area = energy_multiplier_of(r)  # det R(hJ) = |R(ih)|², in h instead of h²
    return fraction(spread(area.num), spread(area.den)).data()


def _energy(facts: LinearFacts) -> Json:
    r = facts.stability_function
    found = energy_multiplier(facts.matrix) if r is None else energy_multiplier_of(r)
    return None if found is None else found.data()


def _invariant(facts: LinearFacts) -> Json:
    found = facts.conserved_quadratics
    return quadratic_record(found[0]) if len(found) == 1 else None


def _optional_term(term: LeadingTerm | None) -> Json:
    return None if term is None else term.data()


def _phase_series(facts: LinearFacts) -> Json:
    r, n = facts.stability_function, facts.terms
    if r is not None:
        return series_record(dispersion_series(r, n))
    return series_record(angle_series(facts.matrix, n)) if facts.turns_readably else None


def _damping_series(facts: LinearFacts) -> Json:
    r, n = facts.stability_function, facts.terms
    return series_record(damping_series(facts.matrix, n) if r is None else dissipation_series(r, n))


def _modified_rate(facts: LinearFacts) -> Json:
    r = facts.stability_function
    return None if r is None else series_record(modified_rate(r, facts.terms))


def _modified_hamiltonian(facts: LinearFacts) -> Json:
    found = facts.modified_hamiltonian
    if found is None:
        return None
    series = modified_factor_series(facts.matrix, facts.terms) if facts.turns_readably else None
    return hamiltonian_record(found, series)


def _linearly_symmetric(facts: LinearFacts) -> bool:
    r = facts.stability_function
    return is_matrix_symmetric(facts.matrix) if r is None else is_linearly_symmetric(r)


def _ssp(facts: LinearFacts) -> Json:
    return data(ssp_coefficient(facts.method)) if isinstance(facts.method, RungeKutta | Collocation) else None


def _order_reduction(facts: LinearFacts) -> Json:
    """The functions of Prothero and Robinson that are not zero, up to the power at which the linear order ends."""
    method = facts.method
    if not isinstance(method, RungeKutta | Collocation):
        return None
    functions = {k: prothero_robinson(method, k) for k in range(1, linear_order(facts) + 2)}
    return [
        {"power": k, "function": f.data(), "at_infinity": at_infinity(f)} for k, f in functions.items() if f.num != 0
    ]


FACTS: dict[str, Callable[[LinearFacts], Json]] = {
    "stability_function": _of_r(RationalFunction.data),
    "one_step_matrix": lambda facts: [[entry.data() for entry in row] for row in facts.matrix],
    "determinant": _determinant,
    "energy_multiplier": _energy,
    "invariant": _invariant,
    "conserved_quadratics": lambda facts: [conserved_record(form) for form in facts.conserved_quadratics],
    "modified_hamiltonian": _modified_hamiltonian,
    "real_limit": lambda facts: None if facts.real_limit is None else data(facts.real_limit),
    "imaginary_limit": lambda facts: data(facts.imaginary_limit),
    "a_stable": lambda facts: None if facts.a_stability is None else facts.a_stability.holds,
    "a_stability": _a_stability,
    "i_stable": _of_r(lambda r: bool(i_stability(r))),
    "l_stable": _of_r(lambda r: bool(l_stability(r))),
    "sector": lambda facts: None if facts.sector is None else sector_record(facts.sector),
    "limit_at_infinity": _of_r(at_infinity),
    "stiffly_accurate": lambda facts: is_stiffly_accurate(facts.method),
    "first_same_as_last": lambda facts: is_first_same_as_last(facts.method),
    "symplectic": lambda facts: is_symplectic(facts.method),
    "symmetric": lambda facts: is_symmetric(facts.method),
    "linearly_symmetric": _linearly_symmetric,
    "linear_order": linear_order,
    "error_constant": _of_r(lambda r: error_constant(r).data()),
    "dispersion": lambda facts: _optional_term(facts.dispersion),
    "dissipation": lambda facts: _optional_term(facts.dissipation),
    "dispersion_series": _phase_series,
    "dissipation_series": _damping_series,
    "modified_rate": _modified_rate,
    "order_reduction": _order_reduction,
    "ssp_coefficient": _ssp,
}
# So long that they are given only when they are named.
ON_REQUEST: dict[str, Callable[[LinearFacts], Json]] = {"region_boundary": _of_r(boundary_record)}
