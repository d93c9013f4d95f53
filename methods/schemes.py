"""RungeKutta and Splitting: one-step methods as frozen, exact, validated data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

SUBSTEPS = ("kick", "drift")


class MethodError(ValueError):
    """A definition that is not a method: wrong shape, an inexact coefficient, an unknown sub-step."""


@dataclass(frozen=True)
class RungeKutta:
    """kᵢ = F(t + cᵢh, z + h Σⱼ aᵢⱼ kⱼ), then z + h Σᵢ bᵢ kᵢ: the Runge-Kutta method with tableau (A, b, c).

    `a` is s rows of s coefficients, `b` and `c` have s; integers are promoted to `Fraction`, anything inexact is
    refused. `claimed_order` is what the source says, to be tested against the order that the coefficients have.
    `source` is a key of `references.bib` and a place in it. Raises MethodError.
    """

    key: str
    title: str
    claimed_order: int
    source: str
    a: tuple[tuple[Fraction, ...], ...]
    b: tuple[Fraction, ...]
    c: tuple[Fraction, ...]

    def __post_init__(self) -> None:
        """Promote integers, then refuse a tableau that is not square or not exact."""
        _demand_iterable(self.a, f"{self.key}: a")
        rows = tuple(_exact(row, f"{self.key}: a[{i}]") for i, row in enumerate(self.a))
        object.__setattr__(self, "a", rows)
        object.__setattr__(self, "b", _exact(self.b, f"{self.key}: b"))
        object.__setattr__(self, "c", _exact(self.c, f"{self.key}: c"))
        if not self.b:
            raise MethodError(f"{self.key}: b is empty; a method has at least one stage")
        for name, length in [("a", len(rows)), ("c", len(self.c))] + [
            (f"a[{i}]", len(row)) for i, row in enumerate(rows)
        ]:
            if length != self.stages:
                raise MethodError(f"{self.key}: {name} has {length} entries, b has {self.stages}; they must agree")

    @property
    def stages(self) -> int:
        """The number s of slopes."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """True when no slope depends on itself or on a later one (A strictly lower triangular)."""
        return all(x == 0 for i, row in enumerate(self.a) for x in row[i:])

    def inconsistencies(self) -> dict[str, Fraction]:
        """The residuals, where not zero, of Σb = 1 and of cᵢ = Σⱼ aᵢⱼ: facts about the data, not errors."""
        residuals = {"sum(b) - 1": sum(self.b) - Fraction(1)}
        for i, row in enumerate(self.a):
            residuals[f"c[{i}] - sum(a[{i}])"] = self.c[i] - sum(row)
        return {condition: residual for condition, residual in residuals.items() if residual}


@dataclass(frozen=True)
class Splitting:
    """A composition of kicks v ← v + c·h·F(q) and drifts q ← q + c·h·v, in the order given.

    `parts` is pairs such as ("kick", 1/2). Every such composition is symplectic when F is a gradient.
    Other fields as in `RungeKutta`. Raises MethodError.
    """

    key: str
    title: str
    claimed_order: int
    source: str
    parts: tuple[tuple[str, Fraction], ...]

    def __post_init__(self) -> None:
        """Promote integers, then refuse unknown sub-steps and inexact coefficients."""
        _demand_iterable(self.parts, f"{self.key}: parts")
        parts = tuple(self.parts)
        if not parts:
            raise MethodError(f"{self.key}: parts is empty; a splitting has at least one kick or drift")
        for i, part in enumerate(parts):
            if not isinstance(part, tuple) or len(part) != 2 or part[0] not in SUBSTEPS:
                raise MethodError(f"{self.key}: parts[{i}] is {part!r}; write ('kick', c) or ('drift', c)")
        coefficients = _exact((c for _, c in parts), f"{self.key}: parts")
        kinds = (kind for kind, _ in parts)
        object.__setattr__(self, "parts", tuple(zip(kinds, coefficients, strict=True)))

    def inconsistencies(self) -> dict[str, Fraction]:
        """The residuals, where not zero, of Σ kicks = 1 and Σ drifts = 1: facts about the data, not errors."""
        residuals = {
            f"sum({kind}s) - 1": sum(c for part, c in self.parts if part == kind) - Fraction(1) for kind in SUBSTEPS
        }
        return {condition: residual for condition, residual in residuals.items() if residual}


Method: TypeAlias = RungeKutta | Splitting


def _exact(values: Iterable[object], where: str) -> tuple[Fraction, ...]:
    _demand_iterable(values, where)
    return tuple(_exact_coefficient(value, f"{where}[{i}]") for i, value in enumerate(values))


def _demand_iterable(values: object, where: str) -> None:
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise MethodError(f"{where} is {values!r}; write a tuple of exact coefficients")


def _exact_coefficient(value: object, where: str) -> Fraction:
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(value)
    raise MethodError(
        f"{where} is {value!r} ({type(value).__name__}); coefficients are exact: write an int or a Fraction"
    )


def nonzero(coefficients: Sequence[Fraction]) -> list[tuple[int, Fraction]]:
    """The pairs (index, coefficient) with coefficient ≠ 0, in order: what a step has to multiply."""
    return [(i, c) for i, c in enumerate(coefficients) if c != 0]
