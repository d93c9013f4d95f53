"""One run on the oscillator, exactly: final state, errors, energy and phase to any number of certified digits."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, ctx

from driftproof.methods.rationals import step_count
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import Exact, enclose
from driftproof.symbolic.n_steps import (
    Entries,
    apply,
    as_balls,
    distance,
    exact_flow,
    exact_matrix_at,
    power,
    short_power,
)

# Above this many bits a power of M is only enclosed: the fraction would be longer than anyone reads.
LONGEST_FRACTION = 4_000


@dataclass(frozen=True)
class OscillatorRun:
    """N = t/h steps of `method` on q' = v, v' = -q from the rational state `start`.

    Every quantity is a Fraction where it is rational and short, else an enclosing procedure (`certified.Exact`).
    The start is rational and t too, so the exact state is rational only at t = 0, where Fractions are returned, or
    from the origin, where the enclosures are exact: hence no question asked of these numbers is an undecidable tie
    (Lindemann: cos t and sin t are transcendental at rational t != 0).
    Raises ValueError if h does not divide t.
    """

    method: Method
    h: Fraction
    t: Fraction
    start: tuple[Fraction, Fraction] = (Fraction(1), Fraction(0))

    def __post_init__(self) -> None:
        """Refuse a step that does not divide the interval."""
        step_count(self.t, self.h)

    @property
    def steps(self) -> int:
        """N = t / h."""
        return step_count(self.t, self.h)

    @cached_property
    def _matrix(self) -> Entries:
        return exact_matrix_at(self.method, self.h)

    @cached_property
    def _enclosures(self) -> dict[int, tuple[arb, arb]]:
        """The final state in balls, by precision: every readout needs it, and a long run has thousands of squarings."""
        return {}

    @cached_property
    def _power(self) -> Entries | None:
        """M(h)ᴺ in fractions, None where they are longer than LONGEST_FRACTION."""
        return short_power(self._matrix, self.steps, LONGEST_FRACTION)

    @property
    def has_short_fractions(self) -> bool:
        """True when M(h)ᴺ is kept as fractions rather than as balls."""
        return self._power is not None

    @cached_property
    def final_state(self) -> tuple[Exact, Exact]:
        """(q_N, v_N) = M(h)ᴺ (q₀, v₀)."""
        if self._power is not None:
            q, v = apply(self._power, *self.start)
            return q, v
        return lambda: _numerical(self)[0], lambda: _numerical(self)[1]

    @cached_property
    def exact_state(self) -> tuple[Exact, Exact]:
        """(q₀ cos t + v₀ sin t, v₀ cos t - q₀ sin t)."""
        if self.t == 0:
            return self.start
        import sympy  # takes a second to load, and no other readout needs it

        q, v, t = (sympy.Rational(x.numerator, x.denominator) for x in (*self.start, self.t))
        c, s = sympy.cos(t), sympy.sin(t)
        return q * c + v * s, v * c - q * s

    @property
    def state_error(self) -> Exact:
        """The Euclidean distance between the numerical and the exact final state."""
        if self.t == 0:
            return Fraction(0)
        return lambda: distance(_numerical(self), exact_flow(self.start, self.t))

    @property
    def energy(self) -> Exact:
        """½(q_N² + v_N²)."""
        if self.has_short_fractions:
            return _energy(*self.final_state)
        return lambda: _energy(*_numerical(self))

    @property
    def energy_change(self) -> Exact:
        """½(q_N² + v_N²) - ½(q₀² + v₀²)."""
        before = _energy(*self.start)
        if self.has_short_fractions:
            return _energy(*self.final_state) - before
        return lambda: _energy(*_numerical(self)) - enclose(before)

    @property
    def phase_error(self) -> Exact | None:
        """The angle, in degrees in [-180, 180), by which the numerical final state is ahead of the exact one.

        atan2 of cross and dot product, so whole turns are not counted. None where an angle is undefined: at the
        origin.
        """
        origin = (Fraction(0), Fraction(0))
        if origin in (self.start, self.final_state):
            return None
        if self.t == 0:
            return Fraction(0)
        return lambda: _angle_between(_numerical(self), exact_flow(self.start, self.t)) * 180 / arb.pi()


def _numerical(run: OscillatorRun) -> tuple[arb, arb]:
    if ctx.prec not in run._enclosures:
        q, v = (enclose(x) for x in run.start)
        run._enclosures[ctx.prec] = apply(power(as_balls(run._matrix), run.steps), q, v)
    return run._enclosures[ctx.prec]


def _energy(q: Any, v: Any) -> Any:
    return (q * q + v * v) / 2


def _angle_between(numerical: tuple[arb, arb], exact: tuple[arb, arb]) -> arb:
    """How far `numerical` is ahead (clockwise) of `exact`, in radians."""
    (q, v), (q_exact, v_exact) = numerical, exact
    return arb.atan2(q * v_exact - v * q_exact, q * q_exact + v * v_exact)
