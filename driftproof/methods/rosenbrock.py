"""Rosenbrock and W methods, whose stages solve linear systems with a Jacobian: frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.schemes import RungeKutta, Staged


@dataclass(frozen=True)
class Rosenbrock(Staged):
    """kᵢ = f(y + h Σⱼ αᵢⱼ kⱼ) + hJ Σⱼ γᵢⱼ kⱼ, y₁ = y + h Σ bᵢ kᵢ, with J = f'(y), or with any J for a W method.

    α is strictly lower triangular, γ lower triangular; γᵢᵢ = 0 makes a stage explicit. If f depends on t, stage i is at
    t + h Σⱼ αᵢⱼ and has the further term h Σⱼ γᵢⱼ ∂f/∂t, as for y' = f made autonomous. `b_embedded`, of order
    `embedded_order`, is the second row of weights of a pair. `places` are the decimals of a source that prints other
    numbers, from which these are computed. Other fields as in `RungeKutta` (hairer-wanner-1996, IV.7).
    Raises MethodError.

    >>> Rosenbrock("mine", "Linearly implicit Euler", 1, "", alpha=((0,),), gamma=((1,),), b=(1,)).stages
    1
    """

    matrices: ClassVar[tuple[str, ...]] = ("alpha", "gamma")
    zero_from: ClassVar[tuple[int, ...]] = (0, 1)
    rows: ClassVar[tuple[str, ...]] = ("b", "b_embedded")
    leading_row: ClassVar[str] = "b"
    kind: ClassVar[str] = "a Rosenbrock method, whose step takes a Jacobian"
    alpha: tuple[tuple[Exact, ...], ...]
    gamma: tuple[tuple[Exact, ...], ...]
    b: tuple[Exact, ...]
    b_embedded: tuple[Exact, ...] | None = None
    embedded_order: int | None = None
    decimal: bool = False
    places: int | None = None

    def linear_twin(self) -> RungeKutta:
        """The Runge-Kutta method with A = α + γ: the same step on linear problems with constant coefficients."""
        summands = (getattr(self, name) for name in self.matrices)
        a = tuple(tuple(map(total, zip(*rows, strict=True))) for rows in zip(*summands, strict=True))
        key, title, order, source = self.key, self.title, self.claimed_order, self.source
        return RungeKutta(key, title, order, source, a, self.b, tuple(map(total, a)), decimal=self.decimal)
