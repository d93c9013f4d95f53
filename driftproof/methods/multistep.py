"""Linear multistep methods, whose step remembers earlier values: rho and sigma as frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.schemes import Definition, MethodError, nonzero_residuals, rational_row


@dataclass(frozen=True)
class Multistep(Definition):
    """The method Σⱼ ρⱼ yₙ₊ⱼ = hᵈ Σⱼ σⱼ F(yₙ₊ⱼ), j = 0, ..., k, for y' = F(y) with d = 1, or y'' = F(y) with d = 2.

    `rho` and `sigma` have k + 1 rational numbers each, those of yₙ first, and `derivative` is d. ρₖ is not 0, and ρ₀
    and σ₀ are not both 0. ρₖ need not be 1: a common factor of rho and sigma changes only the residuals. Other fields
    as in `RungeKutta`. Raises MethodError.

    >>> Multistep("mine", "BDF2", 2, "", rho=(1, -4, 3), sigma=(0, 0, 2)).steps
    2
    """

    rho: tuple[Fraction, ...]
    sigma: tuple[Fraction, ...]
    derivative: int = 1
    decimal: bool = False
    kind: ClassVar[str] = "a linear multistep method"

    def __post_init__(self) -> None:
        """Promote integers, then raise MethodError for inexact numbers, unequal lengths, and zeros that change k."""
        for name in ("rho", "sigma"):
            object.__setattr__(self, name, rational_row(getattr(self, name), f"{self.key}: {name}"))
        if len(self.rho) != len(self.sigma) or len(self.rho) < 2:
            sizes = f"rho has {len(self.rho)} entries, sigma {len(self.sigma)}"
            raise MethodError(f"{self.key}: {sizes}; both need k + 1 entries for k >= 1 steps, zeros included")
        if self.rho[-1] == 0 or not any(self.sigma):
            what = "the last entry of rho" if self.rho[-1] == 0 else "sigma"
            turned = "; rho and sigma go from the oldest value to the new one" * (self.rho[-1] == 0)
            raise MethodError(f"{self.key}: {what} is 0, so the method does not define a new value from F{turned}")
        if self.rho[0] == self.sigma[0] == 0:
            raise MethodError(f"{self.key}: rho and sigma both begin with 0; leave these entries out")
        if self.derivative not in (1, 2):
            raise MethodError(f"{self.key}: derivative is {self.derivative!r}; write 1 for y' = F(y), 2 for y'' = F(y)")

    @property
    def steps(self) -> int:
        """The number k of earlier values from which the next one is computed."""
        return len(self.rho) - 1

    @property
    def explicit(self) -> bool:
        """True if F is not evaluated at the new value."""
        return self.sigma[-1] == 0

    def coefficients(self) -> tuple[Fraction, ...]:
        """All coefficients: rho, then sigma."""
        return *self.rho, *self.sigma

    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of the conditions of order 1: facts about the data, not errors."""
        at_one, slope, sigma = total(self.rho), total(j * x for j, x in enumerate(self.rho)), total(self.sigma)
        if self.derivative == 1:
            return nonzero_residuals({"rho(1)": at_one, "rho'(1) - sigma(1)": slope - sigma})
        bend = total(j * (j - 1) * x for j, x in enumerate(self.rho))
        return nonzero_residuals({"rho(1)": at_one, "rho'(1)": slope, "rho''(1) - 2*sigma(1)": bend - 2 * sigma})
