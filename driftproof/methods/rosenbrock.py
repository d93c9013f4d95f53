"""Rosenbrock and W methods, whose stages solve linear systems with a Jacobian: frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from driftproof.methods.number_field import Exact, total
from driftproof.methods.schemes import MethodError, RungeKutta, Staged, is_strictly_lower, nonzero_residuals


@dataclass(frozen=True)
class Rosenbrock(Staged):
    """kᵢ = f(y + h Σⱼ αᵢⱼ kⱼ) + hJ Σⱼ γᵢⱼ kⱼ, y₁ = y + h Σ bᵢ kᵢ, with J = f'(y), or any J: then it is a W method.

    α is strictly lower triangular, γ lower triangular; γᵢᵢ = 0 makes a stage explicit. Where f depends on t, stage i is
    at t + h Σⱼ αᵢⱼ and has a term h Σⱼ γᵢⱼ ∂f/∂t: so it is y' = f made autonomous. `b_embedded`, of order
    `embedded_order`, is the second row of weights of a pair. Other fields as in `RungeKutta`
    (hairer-wanner-1996, IV.7). Raises MethodError.
    """

    matrices: ClassVar[tuple[str, ...]] = ("alpha", "gamma")
    rows: ClassVar[tuple[str, ...]] = ("b", "b_embedded")
    leading_row: ClassVar[str] = "b"
    kind: ClassVar[str] = "a Rosenbrock method, whose step takes a Jacobian"
    key: str
    title: str
    claimed_order: int
    source: str
    alpha: tuple[tuple[Exact, ...], ...]
    gamma: tuple[tuple[Exact, ...], ...]
    b: tuple[Exact, ...]
    b_embedded: tuple[Exact, ...] | None = None
    embedded_order: int | None = None
    decimal: bool = False

    def __post_init__(self) -> None:
        """Refuse matrices that are not triangular, and half of a pair."""
        super().__post_init__()
        if not is_strictly_lower(self.alpha):
            raise MethodError(f"{self.key}: alpha has an entry on or above its diagonal; stages come in order")
        if any(x != 0 for i, row in enumerate(self.gamma) for x in row[i + 1 :]):
            raise MethodError(f"{self.key}: gamma has an entry above its diagonal; stages come in order")
        if (self.b_embedded is None) != (self.embedded_order is None):
            raise MethodError(f"{self.key}: b_embedded and embedded_order come together")

    @property
    def explicit(self) -> bool:
        """True where no stage solves a system: every γᵢᵢ is 0."""
        return is_strictly_lower(self.gamma)

    def linear_twin(self) -> RungeKutta:
        """The Runge-Kutta method with A = α + γ: the same step on every linear problem with constant coefficients."""
        a = tuple(tuple(x + y for x, y in zip(*rows, strict=True)) for rows in zip(self.alpha, self.gamma, strict=True))
        return RungeKutta(
            self.key, self.title, self.claimed_order, self.source, a, self.b, tuple(map(total, a)), decimal=self.decimal
        )

    def inconsistencies(self) -> dict[str, Exact]:
        """The residuals, where not zero, of Σ b = 1 and of Σ b_embedded = 1: facts about the data, not errors."""
        rows = {"b": self.b, "b_embedded": self.b_embedded}
        return nonzero_residuals({f"sum({name}) - 1": total(row) - 1 for name, row in rows.items() if row is not None})
