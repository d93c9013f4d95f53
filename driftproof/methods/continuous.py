"""Continuous extensions of Runge-Kutta methods (dense output) as exact data.

>>> from driftproof.methods.catalogue import EXTENSIONS
>>> EXTENSIONS["bogacki_shampine32_hermite"].weights[0]
(Fraction(0, 1), Fraction(1, 1), Fraction(-4, 3), Fraction(5, 9))
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import zip_longest

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Definition, MethodError, RungeKutta

# A polynomial in theta, constant term first.
PolynomialInTheta = tuple[Exact, ...]


@dataclass(frozen=True)
class ContinuousExtension(Definition):
    """The dense output y(t + θh) ≈ y + h Σ bᵢ(θ) kᵢ for 0 <= θ <= 1 of a Runge-Kutta method.

    `a` and `c` are of all stages: first those of `method`, then those that the extension adds. `weights` has the
    polynomial bᵢ(θ) of each stage. `claimed_order` is the order that the source states for every θ. Other fields as in
    `RungeKutta`. Raises MethodError if the first stages are not those of the method, or if lengths differ.
    """

    method: RungeKutta
    a: tuple[tuple[Exact, ...], ...]
    c: tuple[Exact, ...]
    weights: tuple[PolynomialInTheta, ...]

    def __post_init__(self) -> None:
        """Raise MethodError unless the lengths agree and the first stages are those of the method."""
        if {len(self.c), len(self.weights), *map(len, self.a)} != {len(self.a)}:
            raise MethodError(f"{self.key}: A, c and the weights need as many entries as there are stages")
        own = self.method.stages
        if tuple(row[:own] for row in self.a[:own]) != self.method.a or self.c[:own] != self.method.c:
            raise MethodError(f"{self.key}: the first stages are not those of {self.method.key}")

    @property
    def degree(self) -> int:
        """The degree of the weights in θ."""
        return max(len(weight) for weight in self.weights) - 1

    @property
    def decimal(self) -> bool:
        """True if coefficients of the method are rounded decimals."""
        return self.method.decimal

    @cached_property
    def columns(self) -> tuple[tuple[Exact, ...], ...]:
        """For each power of θ from 0, the row of its coefficients in all weights."""
        return tuple(zip_longest(*self.weights, fillvalue=Fraction(0)))


def hermite(method: RungeKutta, source: str = "hairer-norsett-wanner-1993, II.6 (6.7)") -> ContinuousExtension:
    """The cubic through y and y₁ with the slopes f(t, y) and f(t + h, y₁): of order 3 if the method has that order.

    The slope at the end is added as a stage unless the last stage of the method is that slope. Raises MethodError if
    the first stage is not f(t, y).
    """
    if any(method.a[0]) or method.c[0]:
        raise MethodError(f"{method.key}: its first stage is not f(t, y), which the cubic needs")
    a, b, c = [*method.a], method.b, [*method.c]
    if a[-1] != b or c[-1] != 1:
        zero = Fraction(0)
        a, c = [*((*row, zero) for row in a), (*b, zero)], [*c, Fraction(1)]
        b = (*b, zero)
    last = len(b) - 1
    # 3θ² - 2θ³ times y₁ - y, θ(1 - θ)² times the slope at the start, θ²(θ - 1) times the slope at the end.
    weights = [
        (Fraction(0), Fraction(i == 0), 3 * x - 2 * (i == 0) - (i == last), (i == 0) + (i == last) - 2 * x)
        for i, x in enumerate(b)
    ]
    key, title, order = f"{method.key}_hermite", f"{method.title}, cubic Hermite", min(3, method.claimed_order)
    return ContinuousExtension(key, title, order, source, method, tuple(a), tuple(c), tuple(weights))
