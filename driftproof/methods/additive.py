"""Additive (IMEX) Runge-Kutta methods for y' = f(y) + g(y), as frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.schemes import RungeKutta, Staged


@dataclass(frozen=True)
class Additive(Staged):
    """Yᵢ = y + h Σⱼ (aᵢⱼ f(Yⱼ) + âᵢⱼ g(Yⱼ)), y₁ = y + h Σ (bᵢ f(Yᵢ) + b̂ᵢ g(Yᵢ)): f explicit, g diagonally implicit.

    `a_explicit` and `b_explicit` belong to f, `a_implicit` and `b_implicit` to g, with the same number of stages: a
    stage that only one of them has is a row of zeros in the other. If f and g depend on t, stage i is at t + h times
    its row sum. The rows `..._embedded`, of order `embedded_order`, are the second weights of a pair. Other fields as
    in `RungeKutta` (ascher-ruuth-spiteri-1997). Raises MethodError.
    """

    matrices: ClassVar[tuple[str, ...]] = ("a_explicit", "a_implicit")
    zero_from: ClassVar[tuple[int, ...]] = (0, 1)
    rows: ClassVar[tuple[str, ...]] = ("b_explicit", "b_implicit", "b_explicit_embedded", "b_implicit_embedded")
    leading_row: ClassVar[str] = "b_explicit"
    kind: ClassVar[str] = "an IMEX method, whose step takes two right-hand sides"
    a_explicit: tuple[tuple[Exact, ...], ...]
    a_implicit: tuple[tuple[Exact, ...], ...]
    b_explicit: tuple[Exact, ...]
    b_implicit: tuple[Exact, ...]
    b_explicit_embedded: tuple[Exact, ...] | None = None
    b_implicit_embedded: tuple[Exact, ...] | None = None
    embedded_order: int | None = None
    decimal: bool = False

    def table(self, part: str) -> RungeKutta:
        """The Runge-Kutta method of one part, "explicit" or "implicit": the step if the other right-hand side is 0."""
        a, b = getattr(self, f"a_{part}"), getattr(self, f"b_{part}")
        words = (f"{self.key}, {part} part", f"{self.title}, {part} part", self.claimed_order, self.source)
        return RungeKutta(*words, a, b, tuple(map(total, a)), decimal=self.decimal)
