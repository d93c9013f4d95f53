"""Binary floating-point formats: precision, exponent range, exact unit roundoff, and rounding to nearest."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property


@dataclass(frozen=True)
class FloatFormat:
    """A binary format with p-bit significands and exponents emin to emax, gradual underflow, rounding to nearest even.

    Its finite numbers are the multiples of 2**(max(e, emin) - p + 1) with exponent e at most emax. Arithmetic that
    flushes subnormals to zero, or rounds twice through a wider register, is not covered.
    Source: ieee-754-2019, 3.3; bfloat16 has binary32's exponents and 8 bits.
    """

    name: str
    precision: int
    emin: int
    emax: int

    @cached_property
    def u(self) -> Fraction:
        """u = 2**-p, the unit roundoff: half the distance from 1 to the next number."""
        return power_of_two(-self.precision)

    @cached_property
    def relative_error(self) -> Fraction:
        """u/(1+u), the largest relative error of one rounding to nearest of a number not in the underflow range.

        Attained at 1 + u. Source: jeannerod-rump-2018, 1.
        """
        return self.u / (1 + self.u)

    @cached_property
    def eta(self) -> Fraction:
        """2**(emin - p + 1), the smallest subnormal: below 2**emin one rounding errs by at most eta/2."""
        return power_of_two(self.emin - self.precision + 1)

    @cached_property
    def largest(self) -> Fraction:
        """(2 - 2u) 2**emax, the largest finite number."""
        return (2 - 2 * self.u) * power_of_two(self.emax)

    def nearest(self, x: Fraction | int) -> Fraction:
        """The number of the format nearest to `x`, ties to even. Raises OverflowError where that would be infinite."""
        x = Fraction(x)
        if not x:
            return x
        quantum = power_of_two(max(exponent(x), self.emin) - self.precision + 1)
        rounded = round(x / quantum) * quantum
        if abs(rounded) > self.largest:
            raise OverflowError(f"{self.name} overflows at a magnitude of about 2**{exponent(x)}")
        return rounded

    def holds(self, x: Fraction | int) -> bool:
        """True when `x` is one of the format's finite numbers."""
        return -self.largest <= x <= self.largest and self.nearest(x) == x


def power_of_two(k: int) -> Fraction:
    """2**k, exactly."""
    return Fraction(1 << max(k, 0), 1 << max(-k, 0))


def is_power_of_two(x: Fraction) -> bool:
    """True when x = ±2**k for an integer k of either sign."""
    return x.numerator.bit_count() == x.denominator.bit_count() == 1


def exponent(x: Fraction) -> int:
    """The integer e with 2**e <= |x| < 2**(e + 1), for x != 0."""
    e = abs(x.numerator).bit_length() - x.denominator.bit_length()
    return e if power_of_two(e) * x.denominator <= abs(x.numerator) else e - 1


BINARY64 = FloatFormat("binary64", 53, -1022, 1023)
BINARY32 = FloatFormat("binary32", 24, -126, 127)
BINARY16 = FloatFormat("binary16", 11, -14, 15)
BFLOAT16 = FloatFormat("bfloat16", 8, -126, 127)
FORMATS: dict[str, FloatFormat] = {f.name: f for f in (BINARY64, BINARY32, BINARY16, BFLOAT16)}
