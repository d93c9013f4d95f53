"""Time in float runs: i h, one rounding, never accumulated; and an h = t/N that no float is."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from driftproof.numeric.run import nearest_double


class Clock(NamedTuple):
    """N steps from 0 towards t: `h` is the double that is run, `end` the time N h at which they end, exactly.

    With |h - t/N| <= u|t/N|, unless h is subnormal, |end - t| <= u|t|: as if t itself were rounded. To separate the
    error of a run from that of its clock, compare with the solution at `end`. The time fl(i h) of step i is within
    (2u + u²)|i t/N| of i t/N, while a sum of i times h may be off by i²u|h|/2 more.
    """

    h: float
    end: Fraction

    def at(self, i: int) -> float:
        """The time fl(i h) at which step i starts, i below 2**53."""
        return i * self.h


def clock(t: Fraction, steps: int) -> Clock:
    """The clock of `steps` steps to t. Raises ValueError for no step, and for an h that no double is near to."""
    if steps < 1:
        raise ValueError(f"steps is {steps}; at least one step leads to t")
    h = nearest_double(t / steps, "h = t / steps")
    return Clock(h, steps * Fraction(h))
