"""What facts on linear problems are: exact functions, series, sectors, conserved forms, as objects with names."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction, rational_function_text
from driftproof.symbolic.linear import invariants, oscillator
from driftproof.symbolic.linear.a_stability import Angle
from driftproof.symbolic.linear.stability_limits import Limit


@dataclass(frozen=True)
class ExactFunction:
    """The rational function x -> f(x**power) for a power of 1 or 2, with x written as `variable`."""

    f: RationalFunction
    variable: str = "z"
    power: int = 1

    def __call__(self, x: Exact | int) -> Exact:
        """The value at an exact number. Raises ZeroDivisionError at a pole."""
        return exact(self.f(scalar(x) ** self.power))

    def __str__(self) -> str:
        """The function in SymPy's syntax, e.g. "(1 - h**2/4)/(1 + h**2/4)"."""
        return rational_function_text(self.inflated().f, self.variable)

    def inflated(self) -> ExactFunction:
        """The same function, with power 1."""
        if self.power == 1:
            return self
        num, den = (oscillator.inflated(p) for p in (self.f.num, self.f.den))
        return ExactFunction(fraction(num, den), self.variable)

    def as_formula(self) -> Formula:
        """The text of the function, together with the function."""
        return Formula(str(self), self)


@dataclass(frozen=True)
class Formula:
    """A formula in SymPy's syntax, and its rational function if it has one variable."""

    text: str
    function: ExactFunction | None = None

    def __str__(self) -> str:
        return self.text


class TruncatedSeries(NamedTuple):
    """The series Σ cₖ xᵏ + O(xⁿ) by its n coefficients c₀, c₁, ..., with x written as `variable`."""

    coefficients: tuple[Exact, ...]
    variable: str = "h"


class AStability(NamedTuple):
    """Whether |R(z)| <= 1 for Re z <= 0, the reason, a witness of a no, and |Q(iy)|² - |P(iy)|² in powers of y².

    For a multistep method, `margin` is Re(ρ/σ) on the unit circle, times a positive number, in powers of tan²(arg ζ/2).
    """

    holds: bool
    reason: str
    witness: Fraction | None
    margin: tuple[Exact, ...]


class Sector(NamedTuple):
    """The sector |arg(-z)| < α by tan α, and α in degrees."""

    tan: Limit
    degrees: Angle


class Conserved(NamedTuple):
    """A conserved quadratic form, and the largest H such that it is positive definite for every h in (0, H)."""

    quadratic: invariants.QuadraticForm
    definite_limit: Limit


class ModifiedEnergy(NamedTuple):
    """The modified Hamiltonian, and its factor θ / sin θ as a series if the coefficients are short enough to read."""

    hamiltonian: invariants.ModifiedHamiltonian
    factor_series: TruncatedSeries | None


class OrderReduction(NamedTuple):
    """The function ψₖ of Prothero and Robinson for k = `power`, and its limit at infinity."""

    power: int
    function: ExactFunction
    at_infinity: Exact | Limit


class RegionBoundary(NamedTuple):
    """(Re R, Re z, Im z) for points z with |R(z)| = 1 and Im z >= 0, as decimals with errors of z below 1e-15."""

    points: list[tuple[str, str, str]]
