"""The exact run of a linear multistep method, in Fractions or in balls, from first values that another method gives."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log2
from typing import Any, TypeAlias

from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import enclose

# A vector of Fractions or of balls.
_Row: TypeAlias = Sequence[Any]


@dataclass(frozen=True)
class StartedMultistep:
    """A multistep method for y' = f(t, y) with what its first values y1, y2, ... are: steps of `starter`, or exact.

    `starter` is None for first values on the solution. Raises ValueError for a method for y'' = F(y).
    """

    method: Multistep
    starter: Method | None

    def __post_init__(self) -> None:
        """Refuse methods for y'' = F(y), which advance positions alone."""
        if self.method.derivative != 1:
            raise ValueError(f"{self.key} is for y'' = F(y) and gives positions only; methods for y' = f can be run")

    @property
    def key(self) -> str:
        """The key of the multistep method."""
        return self.method.key

    def bits_lost(self, steps: int) -> int:
        """The bits of precision that balls lose in so many steps, each of which widens them by Σ|ρⱼ/ρₖ| or so.

        BDF multiplies radii by 5/3 or more in each step although its values do not grow; the Adams methods do not.
        """
        *earlier, last = self.method.rho
        return ceil(steps * log2(sum(abs(x / last) for x in earlier)))

    def states(
        self,
        rate: Callable[[Any, _Row], _Row],
        first: Sequence[_Row],
        h: Fraction,
        solved: Callable[[_Row, Fraction, Fraction], _Row],
    ) -> Iterator[_Row]:
        """Yield yₖ, yₖ₊₁, ... without end, from the `first` values y₀ to yₖ₋₁; all are of the type of these.

        ρₖ yₙ₊ₖ = Σⱼ (h σⱼ f(tₙ₊ⱼ, yₙ₊ⱼ) - ρⱼ yₙ₊ⱼ), where `rate` is f. For an implicit method the terms of yₙ₊ₖ are
        those of a backward Euler step of size γ = h σₖ/ρₖ: `solved(y, t, γ)` makes it from time t.
        """
        lift: Callable[[Any], Any] = Fraction if isinstance(first[0][0], Fraction) else enclose
        k, last = self.method.steps, self.method.rho[-1]
        of_slopes, of_states = ([lift(x / last) for x in row] for row in (self.method.sigma, self.method.rho))
        width, implicit = lift(h), h * self.method.sigma[-1] / last
        states = deque(first, maxlen=k)
        slopes = deque((rate(lift(n * h), y) for n, y in enumerate(first)), maxlen=k)
        n = k
        while True:
            y: _Row = [
                sum(
                    width * s * f[i] - r * x[i]
                    for s, r, f, x in zip(of_slopes, of_states, slopes, states, strict=False)
                )
                for i in range(len(first[0]))
            ]
            if implicit:
                y = solved(y, n * h - implicit, implicit)
            yield y
            states.append(y)
            slopes.append(rate(lift(n * h), y))
            n += 1
