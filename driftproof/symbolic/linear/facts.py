"""The facts of a method on linear problems, as exact objects, each derived when it is first asked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, RungeKutta
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients, exact, scalar
from driftproof.symbolic.algebra.radicals import is_readable
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction, rational_function_text
from driftproof.symbolic.linear.bounded_powers import bounded_limit
from driftproof.symbolic.linear.implicit_stability import a_stability, i_stability, l_stability
from driftproof.symbolic.linear.invariants import (
    ModifiedHamiltonian,
    Quadratic,
    conserved_quadratics,
    definite_limit,
    modified_hamiltonian,
)
from driftproof.symbolic.linear.limits import INFINITY, Limit, imaginary_limit, imaginary_margin, real_limit
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
from driftproof.symbolic.linear.region import rounded_boundary
from driftproof.symbolic.linear.sector import Angle, sector_tangent
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent
from driftproof.symbolic.linear.structure import (
    is_first_same_as_last,
    is_stiffly_accurate,
    is_symmetric,
    is_symplectic,
)

# Terms of a series: those of a method of order 8, and a few of its error.
TERMS = 12


@dataclass(frozen=True)
class ExactFunction:
    """The rational function x -> f(x**power), x being written `variable`."""

    f: RationalFunction
    variable: str = "z"
    power: int = 1

    def __call__(self, x: Exact | int) -> Exact:
        """The value at an exact number. Raises ZeroDivisionError at a pole."""
        return exact(self.f(scalar(x) ** self.power))

    def __str__(self) -> str:
        """The function in SymPy's syntax, e.g. "(1 - h**2/4)/(1 + h**2/4)"."""
        f = self.f if self.power == 1 else RationalFunction(spread(self.f.num), spread(self.f.den))
        return rational_function_text(f, self.variable)


class PowerSeries(NamedTuple):
    """Σ cₖ xᵏ + O(xⁿ), with the n coefficients c₀, c₁, ..., x being written `variable`."""

    coefficients: tuple[Exact, ...]
    variable: str = "h"


class AStability(NamedTuple):
    """Whether |R(z)| <= 1 for Re z <= 0, why, where not, and |Q(iy)|² - |P(iy)|² as a polynomial in y²."""

    holds: bool
    reason: str
    witness: Fraction | None
    margin: tuple[Exact, ...]


class Sector(NamedTuple):
    """The sector |arg(-z)| < α: tan α, and α."""

    tan: Limit | EnclosedTangent
    degrees: Angle


class Conserved(NamedTuple):
    """A conserved quadratic, and the largest H such that it is positive definite for h in (0, H)."""

    quadratic: Quadratic
    definite_limit: Limit


class ModifiedEnergy(NamedTuple):
    """The modified Hamiltonian, and its factor θ / sin θ as a series where its coefficients can be read."""

    hamiltonian: ModifiedHamiltonian
    factor_series: PowerSeries | None


class OrderReduction(NamedTuple):
    """The function ψ of Prothero and Robinson with this number, and its limit at infinity."""

    power: int
    function: ExactFunction
    at_infinity: Exact | Limit


class Boundary(NamedTuple):
    """Points (Re R, Re z, Im z) of the upper half-plane, as decimals within 10**-places of |R(z)| = 1."""

    points: list[tuple[str, str, str]]


class LinearFacts:
    """What a method does on linear problems; a fact is None where the method has none.

    Where it has R(z), facts are about y' = λy, else about the oscillator q' = v, v' = -q, with the matrix M(h).
    """

    def __init__(self, method: Method, terms: int = TERMS) -> None:
        """Compute nothing yet; `terms` is the length of the series."""
        self.method = method
        self.terms = terms

    @cached_property
    def stability_function(self) -> ExactFunction | None:
        """R(z), with y₁ = R(hλ) y₀ on y' = λy."""
        return None if self._r is None else ExactFunction(self._r)

    @cached_property
    def one_step_matrix(self) -> StepMatrix:
        """M(h), with (q₁, v₁)ᵀ = M(h) (q₀, v₀)ᵀ."""
        return one_step_matrix(self.method)

    @cached_property
    def determinant(self) -> ExactFunction:
        """det M(h), the factor by which a step scales area."""
        if self._r is None:
            return ExactFunction(determinant(self.one_step_matrix), "h")
        area = energy_multiplier_of(self._r)  # det R(hJ) = |R(ih)|², in h instead of h²
        return ExactFunction(fraction(spread(area.num), spread(area.den)), "h")

    @cached_property
    def energy_multiplier(self) -> ExactFunction | None:
        """The factor by which a step multiplies q² + v², where it is the same for all states; given by h²."""
        found = energy_multiplier(self.one_step_matrix) if self._r is None else energy_multiplier_of(self._r)
        return None if found is None else ExactFunction(found, "h", 2)

    @cached_property
    def invariant(self) -> Quadratic | None:
        """The quadratic form in q and v that a step conserves, where there is one up to a factor."""
        return self._conserved[0] if len(self._conserved) == 1 else None

    @cached_property
    def conserved_quadratics(self) -> list[Conserved]:
        """A basis of the quadratic forms that a step conserves, and how far each is definite."""
        return [Conserved(form, definite_limit(form)) for form in self._conserved]

    @cached_property
    def modified_hamiltonian(self) -> ModifiedEnergy | None:
        """The Hamiltonian whose exact flow over time h the step is, for det M = 1."""
        found = modified_hamiltonian(self.one_step_matrix)
        if found is None:
            return None
        series = modified_factor_series(self.one_step_matrix, self.terms) if self._turns_readably else None
        return ModifiedEnergy(found, None if series is None else _series(series))

    @cached_property
    def real_limit(self) -> Limit | None:
        """The largest x with |R| <= 1 on [-x, 0]."""
        return None if self._r is None else real_limit(self._r)

    @cached_property
    def imaginary_limit(self) -> Limit:
        """The largest y with |R| <= 1 on [0, iy]; without R(z), the largest H with bounded powers of M(h) on (0, H)."""
        return bounded_limit(self.one_step_matrix) if self._r is None else imaginary_limit(self._r)

    @cached_property
    def a_stable(self) -> bool | None:
        """Whether |R(z)| <= 1 for every z with Re z <= 0."""
        return None if self.a_stability is None else self.a_stability.holds

    @cached_property
    def a_stability(self) -> AStability | None:
        """A-stability with its reason, and a point where it fails."""
        if self._r is None:
            return None
        found = a_stability(self._r)
        return AStability(found.holds, found.reason, found.witness, coefficients(imaginary_margin(self._r)))

    @cached_property
    def i_stable(self) -> bool | None:
        """Whether |R(iy)| <= 1 for every real y."""
        return None if self._r is None else bool(i_stability(self._r))

    @cached_property
    def l_stable(self) -> bool | None:
        """A-stable, and R vanishes at infinity."""
        return None if self._r is None else bool(l_stability(self._r))

    @cached_property
    def sector(self) -> Sector | None:
        """The widest sector in which |R(z)| <= 1: A(α)-stability."""
        if self._r is None:
            return None
        tangent = INFINITY if self.a_stable else sector_tangent(self._r)
        return Sector(tangent, Angle(tangent))

    @cached_property
    def limit_at_infinity(self) -> Exact | Limit | None:
        """The limit of R(z) as z grows."""
        return None if self._r is None else _at_infinity(self._r)

    @cached_property
    def stiffly_accurate(self) -> bool | None:
        """Whether the last stage is the step itself."""
        return is_stiffly_accurate(self.method)

    @cached_property
    def first_same_as_last(self) -> bool | None:
        """Whether the last stage is the first of the next step."""
        return is_first_same_as_last(self.method)

    @cached_property
    def symplectic(self) -> bool:
        """Whether a step conserves the symplectic form on every Hamiltonian problem that the method is for."""
        return is_symplectic(self.method)

    @cached_property
    def symmetric(self) -> bool:
        """Whether a step of -h undoes a step of h, on every problem."""
        return is_symmetric(self.method)

    @cached_property
    def linearly_symmetric(self) -> bool:
        """Whether a step of -h undoes a step of h, on linear problems."""
        return is_matrix_symmetric(self.one_step_matrix) if self._r is None else is_linearly_symmetric(self._r)

    @cached_property
    def linear_order(self) -> int:
        """The order on linear problems: of R(z), or of M(h) on the oscillator."""
        return (matrix_error(self.one_step_matrix)[0] if self._r is None else error_constant(self._r).power) - 1

    @cached_property
    def error_constant(self) -> LeadingTerm | None:
        """The leading term of R(z) - exp z."""
        return None if self._r is None else error_constant(self._r)

    @cached_property
    def dispersion(self) -> LeadingTerm | None:
        """The leading term of arg R(ih) - h; without R(z), of the angle of the eigenvalues of M(h) minus h."""
        if self._r is not None:
            return dispersion(self._r)
        return None if self._turning_rate is None else angle_error(self.one_step_matrix)

    @cached_property
    def dissipation(self) -> LeadingTerm | None:
        """The leading term of log |R(ih)|; without R(z), of half log det M."""
        return damping(self.one_step_matrix) if self._r is None else dissipation(self._r)

    @cached_property
    def dispersion_series(self) -> PowerSeries | None:
        """The series of which `dispersion` is the leading term."""
        if self._r is not None:
            return _series(dispersion_series(self._r, self.terms))
        return _series(angle_series(self.one_step_matrix, self.terms)) if self._turns_readably else None

    @cached_property
    def dissipation_series(self) -> PowerSeries:
        """The series of which `dissipation` is the leading term."""
        if self._r is not None:
            return _series(dissipation_series(self._r, self.terms))
        return _series(damping_series(self.one_step_matrix, self.terms))

    @cached_property
    def modified_rate(self) -> PowerSeries | None:
        """log R(z): on y' = λy the step is the exact flow of y' = (log R(hλ)/h) y."""
        return None if self._r is None else _series(modified_rate(self._r, self.terms), "z")

    @cached_property
    def order_reduction(self) -> list[OrderReduction] | None:
        """The functions of Prothero and Robinson that are not zero, up to the power at which the linear order ends."""
        method = self.method
        if not isinstance(method, RungeKutta | Collocation):
            return None
        functions = {k: prothero_robinson(method, k) for k in range(1, self.linear_order + 2)}
        return [OrderReduction(k, ExactFunction(f), _at_infinity(f)) for k, f in functions.items() if f.num != 0]

    @cached_property
    def ssp_coefficient(self) -> Limit | None:
        """The largest c such that steps up to c times that of forward Euler preserve what forward Euler preserves."""
        return ssp_coefficient(self.method) if isinstance(self.method, RungeKutta | Collocation) else None

    @cached_property
    def region_boundary(self) -> Boundary | None:
        """Points of the boundary |R(z)| = 1 of the stability region."""
        return None if self._r is None else Boundary(rounded_boundary(self._r))

    @cached_property
    def _r(self) -> RationalFunction | None:
        return stability_function_of(self.method)

    @cached_property
    def _conserved(self) -> list[Quadratic]:
        return conserved_quadratics(self.one_step_matrix)

    @cached_property
    def _turning_rate(self) -> Exact | None:
        """The σ of the eigenvalue angle σh + O(h²), 1 for a consistent method; None for a step that is no rotation."""
        try:
            return turning_rate(self.one_step_matrix)
        except NoRotationError:
            return None

    @property
    def _turns_readably(self) -> bool:
        """True where the series of the eigenvalue angle has coefficients that somebody can read."""
        return self._turning_rate is not None and is_readable(self._turning_rate)


def fact_names(kind: type) -> tuple[str, ...]:
    """The names of the facts of a class: its public cached properties, in the order of their definition."""
    return tuple(name for name, x in vars(kind).items() if isinstance(x, cached_property) and not name.startswith("_"))


def facts_by_name(facts: Any, names: Sequence[str], known: Sequence[str]) -> dict[str, Any]:
    """The facts with these names: what `facts`, or else its method, has by that name.

    Raises ValueError for a name that is not known.
    """
    demand_known(names, known)
    own = {*dir(type(facts)), *vars(facts)}
    return {name: getattr(facts if name in own else facts.method, name) for name in names}


def demand_known(names: Sequence[str], known: Iterable[str]) -> None:
    """Raises ValueError for a name that is not known."""
    for name in names:
        if name not in known:
            raise ValueError(f"unknown fact {name!r}; choose from {', '.join(known)}")


def _series(coefficients: list[Any], variable: str = "h") -> PowerSeries:
    return PowerSeries(tuple(exact(c) for c in coefficients), variable)


def _at_infinity(f: RationalFunction) -> Exact | Limit:
    value = f.at_infinity()
    return INFINITY if value is None else value
