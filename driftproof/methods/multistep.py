"""Linear multistep methods, whose step remembers earlier ones: rho and sigma as frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from driftproof.methods.number_field import Exact, total
from driftproof.methods.schemes import Definition, MethodError, nonzero_residuals, rational_row


@dataclass(frozen=True)
class Multistep(Definition):
    """Σⱼ ρⱼ yₙ₊ⱼ = hᵈ Σⱼ σⱼ F(yₙ₊ⱼ), j = 0, ..., k, for y' = F(y) where d = `derivative` is 1, for y'' = F(y) where 2.

    `rho` and `sigma` hold k + 1 rational numbers each, those of yₙ first; ρₖ is not 0, and neither are both of ρ₀ and
    σ₀. ρₖ need not be 1: no fact but the residuals changes where both are multiplied. Other fields as in `RungeKutta`.
    Raises MethodError.

    >>> Multistep("mine", "BDF2", 2, "", rho=(1, -4, 3), sigma=(0, 0, 2)).steps
    2
    """

    rho: tuple[Fraction, ...]
    sigma: tuple[Fraction, ...]
    derivative: int = 1
    decimal: bool = False
    kind: ClassVar[str] = "a linear multistep method"

    def __post_init__(self) -> None:
        """Promote integers; refuse what is inexact, of two lengths, or leaves a number of steps that is not k."""
        for name in ("rho", "sigma"):
            object.__setattr__(self, name, rational_row(getattr(self, name), f"{self.key}: {name}"))
        if len(self.rho) != len(self.sigma) or len(self.rho) < 2:
            sizes = f"rho has {len(self.rho)} entries, sigma {len(self.sigma)}"
            raise MethodError(f"{self.key}: {sizes}; both need k + 1 entries for k >= 1 steps, zeros included")
        if self.rho[-1] == 0 or not any(self.sigma):
            what = "the last entry of rho" if self.rho[-1] == 0 else "sigma"
            raise MethodError(f"{self.key}: {what} is 0, so the method does not define a new value from F")
        if self.rho[0] == self.sigma[0] == 0:
            raise MethodError(f"{self.key}: rho and sigma both begin with 0; leave these entries out")
        if self.derivative not in (1, 2):
            raise MethodError(f"{self.key}: derivative is {self.derivative!r}; write 1 for y' = F(y), 2 for y'' = F(y)")

    @property
    def steps(self) -> int:
        """The number k of values from which the next one is made."""
        return len(self.rho) - 1

    @property
    def explicit(self) -> bool:
        """True when F is not evaluated at the new value."""
        return self.sigma[-1] == 0

    def inconsistencies(self) -> dict[str, Exact]:
        """The residuals, where not zero, of the conditions of order 1: facts about the data, not errors."""
        at_one, slope, sigma = total(self.rho), total(j * x for j, x in enumerate(self.rho)), total(self.sigma)
        if self.derivative == 1:
            return nonzero_residuals({"rho(1)": at_one, "rho'(1) - sigma(1)": slope - sigma})
        bend = total(j * (j - 1) * x for j, x in enumerate(self.rho))
        return nonzero_residuals({"rho(1)": at_one, "rho'(1)": slope, "rho''(1) - 2*sigma(1)": bend - 2 * sigma})
