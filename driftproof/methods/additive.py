"""Additive Runge-Kutta methods, IMEX pairs among them, for y' = f(y) + g(y): frozen, exact, validated data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from driftproof.methods.number_field import Exact, total
from driftproof.methods.schemes import MethodError, RungeKutta, Staged, is_strictly_lower, nonzero_residuals


@dataclass(frozen=True)
class Additive(Staged):
    """Yᵢ = y + h Σⱼ (aᵢⱼ f(Yⱼ) + âᵢⱼ g(Yⱼ)), y₁ = y + h Σ (bᵢ f(Yᵢ) + b̂ᵢ g(Yᵢ)): f explicit, g diagonally implicit.

    `a_explicit`, `b_explicit` are of f, `a_implicit`, `b_implicit` of g, with as many stages: a stage that one of them
    has not is a row of zeros. Where f and g depend on t, stage i is at t + h times its row sum. The rows that end in
    `_embedded`, of order `embedded_order`, are the second ones of a pair. Other fields as in `RungeKutta`
    (ascher-ruuth-spiteri-1997). Raises MethodError.
    """

    matrices: ClassVar[tuple[str, ...]] = ("a_explicit", "a_implicit")
    rows: ClassVar[tuple[str, ...]] = ("b_explicit", "b_implicit", "b_explicit_embedded", "b_implicit_embedded")
    leading_row: ClassVar[str] = "b_explicit"
    kind: ClassVar[str] = "an IMEX method, whose step takes two right-hand sides"
    key: str
    title: str
    claimed_order: int
    source: str
    a_explicit: tuple[tuple[Exact, ...], ...]
    a_implicit: tuple[tuple[Exact, ...], ...]
    b_explicit: tuple[Exact, ...]
    b_implicit: tuple[Exact, ...]
    b_explicit_embedded: tuple[Exact, ...] | None = None
    b_implicit_embedded: tuple[Exact, ...] | None = None
    embedded_order: int | None = None
    decimal: bool = False

    def __post_init__(self) -> None:
        """Refuse matrices that are not triangular, and half of a pair."""
        super().__post_init__()
        if not is_strictly_lower(self.a_explicit):
            raise MethodError(f"{self.key}: a_explicit has an entry on or above its diagonal")
        if any(x != 0 for i, row in enumerate(self.a_implicit) for x in row[i + 1 :]):
            raise MethodError(f"{self.key}: a_implicit has an entry above its diagonal")
        if len({x is None for x in (self.b_explicit_embedded, self.b_implicit_embedded, self.embedded_order)}) > 1:
            raise MethodError(f"{self.key}: both embedded rows and embedded_order come together")

    @property
    def explicit(self) -> bool:
        """True where g is not solved for either."""
        return is_strictly_lower(self.a_implicit)

    def table(self, part: str) -> RungeKutta:
        """The Runge-Kutta method of one part, "explicit" or "implicit": what the step is where the other is zero."""
        a, b = getattr(self, f"a_{part}"), getattr(self, f"b_{part}")
        words = (f"{self.key}, {part} part", f"{self.title}, {part} part", self.claimed_order, self.source)
        return RungeKutta(*words, a, b, tuple(map(total, a)), decimal=self.decimal)

    def inconsistencies(self) -> dict[str, Exact]:
        """The residuals, where not zero, of Σ b = 1 of each row: facts about the data, not errors."""
        rows = ((name, getattr(self, name)) for name in self.rows)
        return nonzero_residuals({f"sum({name}) - 1": total(row) - 1 for name, row in rows if row is not None})
