"""Floats of any format in exact arithmetic: every operation is done on fractions and rounded once, to nearest even."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

# The formats that the machine has.
NATIVE: dict[FloatFormat, type] = {BINARY16: np.float16, BINARY32: np.float32, BINARY64: np.float64}
FORMATS: dict[type, FloatFormat] = {dtype: fmt for fmt, dtype in NATIVE.items()}


@dataclass(frozen=True, eq=False)
class SoftFloat:
    """A number of `format`; with `fusing`, a product that enters a sum is fused into it, as a compiler may.

    `exact` is the value before rounding: only a product that waits to be fused has one that differs from `value`.
    Constants (int, Fraction, float) are rounded to the format. Raises OverflowError instead of giving an infinity;
    zeros have no sign.
    """

    exact: Fraction
    format: FloatFormat
    fusing: bool = False

    @property
    def value(self) -> Fraction:
        """The float itself."""
        return self.format.nearest(self.exact)

    def __add__(self, other: object) -> SoftFloat:
        """x + y, rounded once; of two waiting products the first is fused."""
        y = self._operand(other)
        if self._waits:
            return self._rounded(self.exact + y.value)
        return self._rounded(self.value + y.exact)

    def __radd__(self, other: object) -> SoftFloat:
        """y + x, rounded once."""
        return self._operand(other) + self

    def __sub__(self, other: object) -> SoftFloat:
        """x - y, rounded once."""
        return self + (-self._operand(other))

    def __rsub__(self, other: object) -> SoftFloat:
        """y - x, rounded once."""
        return self._operand(other) - self

    def __mul__(self, other: object) -> SoftFloat:
        """x*y, rounded once, or not yet."""
        product = self.value * self._operand(other).value
        return SoftFloat(product, self.format, self.fusing) if self.fusing else self._rounded(product)

    def __rmul__(self, other: object) -> SoftFloat:
        """y*x, rounded once, or not yet."""
        return self * other

    def __truediv__(self, other: object) -> SoftFloat:
        """x/y, rounded once."""
        return self._rounded(self.value / self._operand(other).value)

    def __neg__(self) -> SoftFloat:
        """-x."""
        return SoftFloat(-self.exact, self.format, self.fusing)

    @property
    def _waits(self) -> bool:
        return self.exact != self.value

    def _rounded(self, x: Fraction) -> SoftFloat:
        return SoftFloat(self.format.nearest(x), self.format, self.fusing)

    def _operand(self, other: object) -> SoftFloat:
        if isinstance(other, SoftFloat):
            return other
        if isinstance(other, int | float | Fraction):
            return self._rounded(Fraction(other))
        raise TypeError(f"{other!r} is {type(other).__name__}; constants are int, float or Fraction")


def soft_lift(fmt: FloatFormat, fusing: bool = False) -> Callable[[Exact], SoftFloat]:
    """The lift of exact numbers to floats of the format."""
    return lambda exact: SoftFloat(decide_by_enclosure(exact, fmt.nearest), fmt, fusing)
