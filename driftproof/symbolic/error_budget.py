"""The certified error of one float run on the oscillator, split into truncation and rounding."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.symbolic.runs import Entries, apply, as_balls, distance, exact_flow, power, short_power

_State: TypeAlias = tuple[Fraction, Fraction]
# Up to this many bits M**N is also formed exactly, to recognise a run without any rounding error.
LONGEST_POWER = 20_000


@dataclass(frozen=True)
class ErrorOfRun:
    """The error z^_N - z(t) = (z^_N - M^N z0) + (M^N z0 - z(t)) on q' = v, v' = -q: rounding plus truncation.

    `final` is z^_N, the final state of a float run of N = `steps` steps of size `h` from `start`. `h`, `start` and
    `final` are the floats themselves, as fractions; `matrix` is M(h), and t = N h. Distances are Euclidean. M^N is
    formed by squaring, so N = 10^7 takes no time.
    """

    matrix: Entries
    h: Fraction
    steps: int
    start: _State
    final: _State

    @property
    def rounding(self) -> CertifiableReal:
        """|z^_N - M^N z0|, the error due to rounding."""
        if self._is_exact:
            return Fraction(0)
        return lambda: distance(self._floats(), self._numerical())

    @property
    def truncation(self) -> CertifiableReal:
        """|M^N z0 - z(t)|, the error that the method would have in exact arithmetic."""
        return lambda: distance(self._numerical(), self._analytic())

    @property
    def total(self) -> CertifiableReal:
        """|z^_N - z(t)|; at most rounding + truncation."""
        return lambda: distance(self._floats(), self._analytic())

    @property
    def _is_exact(self) -> bool:
        whole = short_power(self.matrix, self.steps, LONGEST_POWER)
        return whole is not None and apply(whole, *self.start) == self.final

    def _floats(self) -> tuple[arb, arb]:
        return enclose(self.final[0]), enclose(self.final[1])

    def _numerical(self) -> tuple[arb, arb]:
        q, v = (enclose(x) for x in self.start)
        return apply(power(as_balls(self.matrix), self.steps), q, v)

    def _analytic(self) -> tuple[arb, arb]:
        return exact_flow(self.start, self.steps * self.h)
