"""The facts about a method on linear problems, as exact objects, each derived at its first use."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, RungeKutta
from driftproof.support.plain_text import unknown
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients, exact
from driftproof.symbolic.algebra.radicals import is_readable
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.linear import a_stability as half_plane
from driftproof.symbolic.linear import invariants, oscillator, phase, reduced_tableau, stability_limits
from driftproof.symbolic.linear.a_stability import Angle, sector_tangent
from driftproof.symbolic.linear.fact_values import (
    AStability,
    Conserved,
    ExactFunction,
    ModifiedEnergy,
    OrderReduction,
    RegionBoundary,
    Sector,
    TruncatedSeries,
)
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.printed_digits import (
    StabilityWithinDigits,
    imaginary_limit_within_digits,
    stability_within_digits,
)
from driftproof.symbolic.linear.region import rounded_boundary
from driftproof.symbolic.linear.stability_function import prothero_robinson, scalar_tableau
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit, bounded_powers


class _Checkable(Protocol):
    def inconsistencies(self) -> dict[str, Exact]: ...


_T = TypeVar("_T")
_M = TypeVar("_M", bound=_Checkable)

# Terms of a series; chosen: those of a method of order 8 and a few of its error.
TERMS = 12


def _from_r(derive: Callable[[RationalFunction], _T], doc: str | None = None) -> cached_property[_T | None]:
    """A fact derived from R(z); None for a method without R(z)."""
    return _as_fact(lambda facts: None if facts._r is None else derive(facts._r), doc or derive.__doc__)


def _from_step(of_r: Callable[[RationalFunction], _T], of_matrix: Callable[[StepMatrix], _T]) -> cached_property[_T]:
    """A fact derived from R(z), or from M(h) for a method without R(z)."""
    return _as_fact(
        lambda facts: of_matrix(facts.one_step_matrix) if facts._r is None else of_r(facts._r), of_r.__doc__
    )


def _from_method(derive: Callable[[Method], _T]) -> cached_property[_T]:
    """A fact derived from the coefficients of the method."""
    return _as_fact(lambda facts: derive(facts.method), derive.__doc__)


def _as_fact(fact: Callable[[LinearFacts], _T], doc: str | None) -> cached_property[_T]:
    fact.__doc__ = doc
    return cached_property(fact)


def fact_of_twin(twin: str, name: str) -> cached_property[Any]:
    """The fact called `name` of the attribute `twin`, the LinearFacts of a method that is equal on linear problems."""

    def fact(facts: Any) -> Any:
        return getattr(getattr(facts, twin), name)

    fact.__doc__ = getattr(LinearFacts, name).__doc__
    return cached_property(fact)


class FactsOfFamily(Generic[_M]):
    """The facts that multistep, Rosenbrock and additive methods have in common; a subclass sets its `kind`."""

    kind: ClassVar[str]

    def __init__(self, method: _M) -> None:
        self.method = method

    @cached_property
    def family(self) -> str:
        """The kind of method, which says how the coefficients are read."""
        return self.kind

    @cached_property
    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of the consistency conditions by name, such as sum(b) - 1 or rho(1)."""
        return self.method.inconsistencies()


class LinearFacts:
    """The exact facts about a method on linear problems; a fact that the method does not have is None.

    For a method with R(z) they are about y' = λy, else about the oscillator q' = v, v' = -q with the matrix M(h).
    """

    def __init__(self, method: str | Path | Method, terms: int = TERMS) -> None:
        """Keep the method; nothing is computed yet. `terms` is the length of the series."""
        self.method = method_of(method)
        self.terms = terms

    stability_function = _from_r(ExactFunction, "R(z), with y₁ = R(hλ) y₀ on y' = λy; None without it.")

    one_step_matrix = _from_method(oscillator.oscillator_matrix)

    @cached_property
    def determinant(self) -> ExactFunction:
        """det M(h), the factor by which a step scales area."""
        found = self.energy_multiplier  # μ, where MᵀM = μI
        return ExactFunction(oscillator.area_factor(self.one_step_matrix), "h") if found is None else found.inflated()

    @cached_property
    def energy_multiplier(self) -> ExactFunction | None:
        """The factor by which a step multiplies q² + v², a function of h²; None if it depends on the state."""
        if self._r is not None:
            return ExactFunction(oscillator.energy_multiplier_of(self._r), "h", 2)
        found = oscillator.energy_factor(self.one_step_matrix)
        return None if found is None else ExactFunction(found, "h", 2)

    @cached_property
    def invariant(self) -> invariants.QuadraticForm | None:
        """The quadratic form in q and v that a step conserves; None unless it is unique up to a factor."""
        return self._conserved[0] if len(self._conserved) == 1 else None

    @cached_property
    def conserved_quadratics(self) -> list[Conserved]:
        """A basis of the quadratic forms that a step conserves, with the limit up to which each is definite."""
        return [Conserved(form, invariants.definite_limit(form)) for form in self._conserved]

    @cached_property
    def modified_hamiltonian(self) -> ModifiedEnergy | None:
        """The quadratic Hamiltonian whose exact flow over time h is the step; None if there is none for small h."""
        m = self.one_step_matrix
        found = invariants.modified_hamiltonian(m) if self._keeps_area else None
        if found is None:
            return None
        return ModifiedEnergy(
            found, _series(phase.modified_factor_series(m, self.terms)) if self._turns_readably else None
        )

    real_limit = _from_r(stability_limits.real_limit)
    imaginary_limit = _from_step(stability_limits.imaginary_limit, lambda m: bounded_powers(m).limit)

    @cached_property
    def a_stable(self) -> bool | None:
        """True if |R(z)| <= 1 for every z with Re z <= 0; None without R(z)."""
        return None if self.a_stability is None else self.a_stability.holds

    @cached_property
    def a_stability(self) -> AStability | None:
        """A-stability with its reason and a witness of a no; None without R(z)."""
        if self._r is None:
            return None
        found = half_plane.a_stability(self._r)
        margin = coefficients(stability_limits.imaginary_margin(self._r))
        return AStability(found.holds, found.reason, found.witness, margin)

    i_stable = _from_r(lambda r: half_plane.i_stability(r).holds, "True if |R(iy)| <= 1 for real y; None without R(z).")

    l_stable = _from_r(lambda r: half_plane.l_stability(r).holds, "True if A-stable and R(oo) = 0; None without R(z).")

    @cached_property
    def stability_within_digits(self) -> StabilityWithinDigits | None:
        """I-, A- and L-stability and |R(oo)| within the rounding of the coefficients; None if they are not rounded."""
        method = self.method
        return stability_within_digits(method) if isinstance(method, RungeKutta) and self._rounded else None

    @cached_property
    def imaginary_limit_within_digits(self) -> str | None:
        """The imaginary limit that the rounding of an explicit table makes 0; None if it does not, or the digits do."""
        method = self.method
        if self.imaginary_limit != ZERO_ROOT or not isinstance(method, RungeKutta) or not self._rounded:
            return None
        return imaginary_limit_within_digits(method)

    @property
    def _rounded(self) -> bool:
        """True if the coefficients are rounded from others."""
        return self.method.decimal

    @cached_property
    def sector(self) -> Sector | None:
        """The widest sector in which |R(z)| <= 1, for A(α)-stability; None without R(z), or if that takes too long."""
        tangent = None if self._r is None else INFINITY if self.a_stable else sector_tangent(self._r)
        return None if tangent is None else Sector(tangent, Angle(tangent))

    limit_at_infinity = _from_r(lambda r: _at_infinity(r), "The limit of R(z) at infinity; None without R(z).")

    stiffly_accurate = _from_method(reduced_tableau.is_stiffly_accurate)
    first_same_as_last = _from_method(reduced_tableau.is_first_same_as_last)
    symplectic = _from_method(reduced_tableau.is_symplectic)
    symmetric = _from_method(reduced_tableau.is_symmetric)
    linearly_symmetric = _from_step(phase.is_linearly_symmetric, oscillator.is_matrix_symmetric)

    @cached_property
    def linear_order(self) -> int:
        """The order on linear problems: that of R(z), or without R(z) that of M(h) on the oscillator."""
        if self._r is None:
            return phase.matrix_error(self.one_step_matrix) - 1
        return phase.error_constant(self._r).power - 1

    error_constant = _from_r(phase.error_constant)

    @cached_property
    def dispersion(self) -> phase.LeadingTerm | None:
        """The leading term of arg R(ih) - h, or without R(z) of the angle of the eigenvalues of M(h) minus h."""
        if self._r is not None:
            return phase.dispersion(self._r)
        return None if self._turning_rate is None else phase.angle_error(self.one_step_matrix)

    dissipation = _from_step(phase.dissipation, phase.leading_dissipation)

    @cached_property
    def dispersion_series(self) -> TruncatedSeries | None:
        """The series of which `dispersion` is the leading term."""
        if self._r is not None:
            return _series(phase.dispersion_series(self._r, self.terms))
        return _series(phase.angle_error_series(self.one_step_matrix, self.terms)) if self._turns_readably else None

    @cached_property
    def dissipation_series(self) -> TruncatedSeries:
        """The series of which `dissipation` is the leading term."""
        if self._r is not None:
            return _series(phase.dissipation_series(self._r, self.terms))
        return _series(phase.damping_series(self.one_step_matrix, self.terms))

    @cached_property
    def modified_rate(self) -> TruncatedSeries | None:
        """The series of log R(z): on y' = λy the step is the exact flow of y' = (log R(hλ)/h) y; None without R(z)."""
        return None if self._r is None else _series(phase.modified_rate(self._r, self.terms), "z")

    @cached_property
    def order_reduction(self) -> list[OrderReduction] | None:
        """The nonzero functions ψₖ of Prothero and Robinson for k up to the linear order plus 1; None without R(z)."""
        method = self.method
        if not isinstance(method, RungeKutta | Collocation):
            return None
        data = scalar_tableau(method)  # one for all, which keeps the products of its matrix
        functions = {k: prothero_robinson(data, k) for k in range(1, self.linear_order + 2)}
        return [OrderReduction(k, ExactFunction(f), _at_infinity(f)) for k, f in functions.items() if f.num]

    @cached_property
    def ssp_coefficient(self) -> Limit | None:
        """The largest c such that the method preserves for h <= c h₀ what forward Euler preserves for h <= h₀."""
        return ssp_coefficient(self.method) if isinstance(self.method, RungeKutta | Collocation) else None

    region_boundary = _from_r(
        lambda r: RegionBoundary(rounded_boundary(r)), "Points of the boundary |R(z)| = 1 of the stability region."
    )

    @cached_property
    def _r(self) -> RationalFunction | None:
        return oscillator.stability_function_of(self.method)

    @cached_property
    def _conserved(self) -> list[invariants.QuadraticForm]:
        return invariants.quadratic_invariants(self.one_step_matrix) if self._keeps_area else []

    @property
    def _keeps_area(self) -> bool:
        """False if det M = |R(ih)|² is not 1 for all h; then nothing is conserved, as that needs |R|² = 1 or R = ±1."""
        return self._r is None or phase.is_linearly_symmetric(self._r)

    @cached_property
    def _turning_rate(self) -> Exact | None:
        """The σ in the eigenvalue angle σh + O(h²), 1 for a consistent method; None for a step that is no rotation."""
        try:
            return phase.leading_frequency(self.one_step_matrix)
        except phase.NoRotationError:
            return None

    @property
    def _turns_readably(self) -> bool:
        """True if the series of the eigenvalue angle has coefficients that are short enough to read."""
        return self._turning_rate is not None and is_readable(self._turning_rate)


# What the facts of a method of stages begin with.
IDENTITY = ("method", "title", "family", "source", "stages", "explicit", "decimal", "field", "inconsistencies",
            "claimed_order")  # fmt: skip


def fact_names(kind: type) -> tuple[str, ...]:
    """The names of the facts of a class: its public cached properties, in the order of their definition."""
    return tuple(name for name, x in vars(kind).items() if isinstance(x, cached_property) and not name.startswith("_"))


def facts_by_name(facts: Any, names: Sequence[str], known: Sequence[str]) -> dict[str, Any]:
    """The facts with these names, as attributes of `facts` or else of its method.

    Raises ValueError for a name that is not in `known`.
    """
    require_known(names, known)
    own = {*dir(type(facts)), *vars(facts)}
    return {name: getattr(facts if name in own else facts.method, name) for name in names}


def require_known(names: Sequence[str], known: Collection[str]) -> None:
    """Raise ValueError for a name that is not in `known`."""
    for name in names:
        if name not in known:
            raise ValueError(unknown("fact", name, known))


def _series(coefficients: list[Any], variable: str = "h") -> TruncatedSeries:
    return TruncatedSeries(tuple(exact(c) for c in coefficients), variable)


def _at_infinity(f: RationalFunction) -> Exact | Limit:
    value = f.at_infinity()
    return INFINITY if value is None else value
