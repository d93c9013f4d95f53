"""The time that a right-hand side is given: comparisons of it, its floor and its remainder are decided exactly.

A jump at a known time, such as the end of a dose or a knot of measured data, is no obstacle. A step takes f as it is
just after its beginning, and continues that analytically; it ends where a comparison of the time changes.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import ceil, floor
from typing import Any, TypeAlias

import numpy as np
from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused, Value
from driftproof.enclosure.arithmetic.numbers import Enclosed, enclosed, exact_value
from driftproof.methods.numbers.flint_rationals import dyadic

# Offset and rate.
_Line: TypeAlias = tuple[Fraction, Fraction]


class TimeCut(Refused):
    """The span of a step contains the time `at`, where a comparison of the time changes; the step has to end there."""

    def __init__(self, at: Fraction) -> None:
        """Keep the time."""
        super().__init__(f"f compares the time with {float(at):.9g}")
        self.at = at


def _by_sign(name: str) -> Callable[[Clock, object], Any]:
    """The comparison of a clock: by the sign of the difference where that is a clock, else as of any number."""
    compare, of_any_number = getattr(operator, name), getattr(Enclosed, f"__{name}__")

    def compared(self: Clock, other: object) -> Any:
        return of_any_number(self, other) if _line(other) is None else compare((self - other).sign(), 0)

    return compared


class Clock(Enclosed):
    """offset + rate t, t the time: what f makes of the time by adding constants, and multiplying by them."""

    __slots__ = ("offset", "rate")

    def __init__(self, evaluation: Evaluation, value: Value, line: _Line | None = None) -> None:
        """Take value, offset and rate; by default those of the time itself, which is a constant where it is exact."""
        if line is None:
            known = evaluation.span is None and isinstance(value, arb) and value.is_exact()
            line = (dyadic(value), Fraction(0)) if known else (Fraction(0), Fraction(1))
        self.offset, self.rate = line
        super().__init__(evaluation, value, exact=None if self.rate else self.offset)

    def sign(self) -> int:
        """-1, 0 or 1, on the whole span but for its ends. Raises TimeCut if it changes there."""
        if not self.rate:
            return int(self.offset > 0) - int(self.offset < 0)
        if self.evaluation.span is not None:
            rising = 1 if self.rate > 0 else -1
            return -rising if _is_ahead(-self.offset / self.rate, self.evaluation.span) else rising
        return 1 if self.evaluation.decide(self.value, arb(0)) else -1

    def __floor__(self) -> int:
        """The integer k with k <= self < k + 1, on the whole span but for its ends. Raises TimeCut if it changes."""
        if not self.rate:
            return floor(self.offset)
        if (span := self.evaluation.span) is None:
            return self.evaluation.floor(self.value)
        first = self.offset + self.rate * span[0]
        k = floor(first) if self.rate > 0 else ceil(first) - 1
        # Raises where the next integer is reached in the span.
        _is_ahead((k + (self.rate > 0) - self.offset) / self.rate, span)
        return k

    def __round__(self, digits: int | None = None) -> Any:
        return super().__round__(digits) if self.rate or digits is not None else round(self.offset)

    def __floordiv__(self, other: object) -> Any:
        return super().__floordiv__(other) if (of := exact_value(other)) is None else floor(self / of)

    def __mod__(self, other: object) -> Any:
        return super().__mod__(other) if (of := exact_value(other)) is None else self - floor(self / of) * of

    def __add__(self, other: object) -> Any:
        return self._line_of(operator.add, super().__add__(other), _line(other))

    __radd__ = __add__

    def __neg__(self) -> Clock:
        return Clock(self.evaluation, -self.value, (-self.offset, -self.rate))

    def __sub__(self, other: object) -> Any:
        return self._line_of(operator.sub, super().__sub__(other), _line(other))

    def __rsub__(self, other: object) -> Any:
        return -self + other

    def __mul__(self, other: object) -> Any:
        if not self.rate and isinstance(other, Clock):
            return other * self.offset
        return self._line_of(operator.mul, super().__mul__(other), _factors(other))

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Any:
        return self._line_of(operator.truediv, super().__truediv__(other), _factors(other))

    def __rtruediv__(self, other: object) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented
        made, numerator = Enclosed.__truediv__(enclosed(self.evaluation, other), self), exact_value(other)
        if self.rate or numerator is None:
            return made
        return Clock(self.evaluation, made.value, (numerator / self.offset, Fraction(0)))

    def _line_of(self, operation: Callable[[Fraction, Fraction], Fraction], made: Any, other: _Line | None) -> Any:
        """The number `made` as a clock, with the operation on offsets and on rates; as it is if there is no other."""
        if other is None:
            return made
        line = operation(self.offset, other[0]), operation(self.rate, other[1])
        return Clock(self.evaluation, made.value, line)

    __gt__, __ge__, __lt__, __le__, __eq__ = map(_by_sign, ("gt", "ge", "lt", "le", "eq"))


def exact_constant(evaluation: Evaluation, x: Any, ball: arb) -> Enclosed:
    """An exact constant in a ball; comparisons of the time with a rational one are decided exactly."""
    return Clock(evaluation, ball, (x, Fraction(0))) if isinstance(x, Fraction) else Enclosed(evaluation, ball)


def exact_time(evaluation: Evaluation, ball: arb, known: Sequence[tuple[Fraction, arb]]) -> Clock:
    """A time in a ball; of several `known` ones with their balls, one of which it is, that which alone overlaps it."""
    within = [t for t, its in known if ball.overlaps(its)]
    return Clock(evaluation, ball, (within[0], Fraction(0)) if len(within) == 1 else None)


def _line(x: object) -> _Line | None:
    """Offset and rate of a clock or of a constant; None for any other number."""
    if isinstance(x, Clock):
        return x.offset, x.rate
    return None if (constant := exact_value(x)) is None else (constant, Fraction(0))


def _factors(x: object) -> _Line | None:
    """What multiplies offset and rate, if x is a constant."""
    return None if (constant := exact_value(x)) is None else (constant, constant)


def _is_ahead(crossing: Fraction, span: tuple[Fraction, Fraction | None]) -> bool:
    """True if the crossing comes after the span, False if before. Raises TimeCut if it is in it."""
    first, last = span
    if crossing > first and last is not None and crossing < last:
        raise TimeCut(crossing)
    return crossing > first
