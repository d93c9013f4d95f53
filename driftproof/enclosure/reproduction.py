"""Whether what is enclosed is what floats compute: f in floats against f in balls, forwards and backwards."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from inspect import signature
from math import ulp

import numpy as np
from flint import arb

from driftproof.enclosure.arithmetic.clocks import Clock
from driftproof.enclosure.arithmetic.evaluations import (
    TWO_RUNS,
    Evaluation,
    Overlapping,
    Refused,
    Replay,
    ZeroByZero,
    in_bits,
    not_smooth,
)
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.certificate import decimal
from driftproof.enclosure.fields.fields import RightHandSide, linearised
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.methods.formulas.vector_fields import VectorField

# f in floats may differ from f in balls by this much, relative to the sizes of f and of (∂f/∂y) y: half of a double's
# digits. This detects another function, and does not bound rounding.
REPRODUCED = 2.0**-26
# Where f cancels, as 1 + tanh does, it may also differ by what roundings of its intermediates leave. Balls of 53 bits
# widen by at least a unit in the last place of each number that is rounded; NumPy's functions are off by at most four.
# Twice that is allowed, since floats add in another order, but no more than REPRODUCED of the largest sizes on the run:
# beyond that, what f rounds away is f, as in (y + 2**52) - 2**52.
BITS_OF_DOUBLES, UNITS_OF_FLOATS = 53, 8
# What f computes of the time, such as t * 1000 % 1, may be off by so many roundings of it.
ROUNDINGS_OF_TIME = 8
# Floats keep fewer digits of smaller numbers, or none.
UNDERFLOW = arb(2) ** -1022
# The number of points at which this is checked, evenly spread.
MOST_REPRODUCED = 64
_CALLED_AGAIN = "in a second call, with the time as a NumPy number, not a float"
# The number of places around a start; chosen: states differ by up to 8 from it, or by eight times its size, and are no
# round numbers, at which f may jump.
_PLACES, _NOT_ROUND = 12, 0.8137
# As Python says it of x, y, z = state; of so many components more than the trajectory's f is tried.
_UNPACKS, _MORE_COMPONENTS = re.compile(r"too many values to unpack \(expected (\d+)"), 8
_LOST = "f in floats keeps no more digits of it; write it so that it does, as 2*sin(x/2)**2 for 1 - cos(x)"
_NONE = arb(0)


class NotReproduced(Refused):
    """What is enclosed is not what f computes in floats."""


def reproduced_field(
    f: RightHandSide, made: Callable[[], VectorField], start: Sequence[Fraction], end: Fraction
) -> VectorField:
    """The text `made` of f. Raises NotReproduced if f is another function at times up to the end, near the start.

    Places where f has no value are left out. The first value is asked for before, since making the text calls f.
    """
    places, first = list[tuple[float, list[float]]](), list[list[float]]()
    for k in range(_PLACES):
        off = _NOT_ROUND * ((-1) ** k * 2.0 ** (k // 2 - 2) if k else 2.0**-10)
        signs = [-1 if i % 2 and k % 4 > 1 else 1 for i in range(len(start))]
        state = [x + sign * off * max(1.0, abs(x)) for x, sign in zip(map(float, start), signs, strict=True)]
        places.append((float(end) * (k + _NOT_ROUND) / (_PLACES + 1), state))
    with suppress(Refused, ValueError), np.errstate(all="ignore"):
        first.append(_rates_in_floats(f, *places[0]))
    field = made()
    in_balls, answered = field_function(field), lambda t, y: first.pop() if first else f(t, y)
    for t, y in (*places, *reversed(places)):
        _require_reproduced_if_possible(answered, in_balls, t, y)
    return field


def _require_reproduced_if_possible(
    f: RightHandSide, in_balls: RightHandSide, t: float, y: Sequence[float], scale: arb = _NONE
) -> None:
    """Do what `require_reproduced` does, unless f has no value at this place."""
    try:
        with np.errstate(all="ignore"):  # of NumPy's logarithm of a negative number, say
            require_reproduced(f, in_balls, [t], [y], scale)
    except NotReproduced:
        raise
    except (Refused, ValueError):
        return


def require_reproduced_between(
    f: RightHandSide, in_balls: RightHandSide, times: Sequence[float], states: Sequence[Sequence[float]]
) -> None:
    """Raise NotReproduced as `require_reproduced` does, at places between the points of a trajectory as well.

    Places where f has no value are left out: they are not on the solution.
    """
    between, intervals, scale = list[tuple[float, list[float]]](), len(times) - 1, _NONE
    for k in range(MOST_REPRODUCED if intervals else 0):
        i, part = divmod(intervals * (k + _NOT_ROUND) / MOST_REPRODUCED, 1)
        (t, y), (other, at_other) = ((times[j], states[j]) for j in (int(i), int(i) + 1))
        between.append((t + part * (other - t), [a + part * (b - a) for a, b in zip(y, at_other, strict=True)]))
        with suppress(Refused, ValueError), np.errstate(all="ignore"):
            scale = scale.max(_Rates.of(in_balls, *between[-1], len(y)).scale)
    scale = require_reproduced(f, in_balls, times, states, scale)
    for t, y in between:
        _require_reproduced_if_possible(f, in_balls, t, y, scale)


def require_reproduced(
    f: RightHandSide,
    in_balls: RightHandSide,
    times: Sequence[float],
    states: Sequence[Sequence[float]],
    scale: arb = _NONE,
) -> arb:
    """Raise NotReproduced unless f in floats agrees with f in balls, up to rounding, at points of a trajectory.

    f is called at them forwards and then backwards, so that a memory of f, such as a switch, is detected; first with
    the time as a float, then as a number of NumPy, as SciPy gives it. Raises Refused where f has no value. Returns the
    largest sizes of f on the run, or the scale that is known to be larger.
    """
    checked = sorted({len(times) * k // MOST_REPRODUCED for k in range(MOST_REPRODUCED)})
    forwards = [_rates_in_floats(f, times[i], states[i]) for i in checked]
    backwards = [_of_another_time(f, times[i], states[i]) for i in reversed(checked)]
    compared = zip(checked, forwards, reversed(backwards), strict=True)
    enclosed = [
        _Rates.of(in_balls, times[i], states[i], len(given)) for i, given in zip(checked, forwards, strict=True)
    ]
    scale = size([scale, *(each.scale for each in enclosed)])
    for (i, given, repeated), found in zip(compared, enclosed, strict=True):
        t, allowed = times[i], found.allowed(scale)
        for j, (a, again) in enumerate(zip(given, repeated, strict=True)):
            if abs(arb(a) - again) > 2 * allowed[j]:
                raise NotReproduced(f"f is {a!r} at t = {t}, component {j}, but {again!r} {_CALLED_AGAIN}")
        off = _beyond(given, found.rates, allowed)
        if off and not _jumps_beside(in_balls, t, states[i], given, allowed):
            j, said = off[0], f"f in floats is {given[off[0]]!r} at t = {t}, component {off[0]}"
            said = f"{said}, but its enclosure is {decimal(found.rates[j])}"
            lost = abs(arb(given[j]) - found.rates[j]) <= found.roundings[j]
            raise NotReproduced(f"{said}: {_LOST}" if lost else said)
    return scale


@dataclass(frozen=True)
class _Rates:
    """f in balls at a point, the sizes of f and of (∂f/∂y) y together, and bounds of what f's roundings there make."""

    rates: list[arb]
    scale: arb
    roundings: list[arb]

    @classmethod
    def of(cls, f: RightHandSide, t: float, y: Sequence[float], components: int) -> _Rates:
        """f at a point, for as many components as y has. Raises Refused where f has no value."""
        evaluation, balls = Evaluation(), [arb(x) for x in y]
        if components != len(balls):
            raise ValueError(f"f returns {components} numbers for {len(balls)} components")
        try:
            rates, slopes = linearised(f, Clock(evaluation, arb(t)), balls)
        except ZeroByZero as refusal:
            raise not_smooth(t, refusal) from None
        except Overlapping as refusal:
            more = f"if f changes its form there, as friction at rest does, {TWO_RUNS}"
            raise Refused(f"{refusal} at t = {t}; {more}", refusal.t) from None
        scale = size(rates) + size(sum((abs(J * x) for J, x in zip(row, balls, strict=True)), _NONE) for row in slopes)
        if not scale.is_finite():
            raise Refused(f"f or its derivative is not finite at t = {t}")
        roundings = [_NONE] * components
        with suppress(Refused), in_bits(BITS_OF_DOUBLES):  # what cannot be divided there has no such bounds
            rounded, _ = linearised(f, Clock(Replay(outcomes=evaluation.taken), arb(t)), balls, slopes=False)
            roundings = [UNITS_OF_FLOATS * x.rad() for x in rounded]
        return cls(rates, scale, roundings)

    def allowed(self, scale: arb) -> list[arb]:
        """How far floats may be off in each component, on a run of this scale."""
        least, most = REPRODUCED * self.scale + UNDERFLOW, REPRODUCED * scale
        return [least.max(x.min(most)) for x in self.roundings]


def _beyond(given: Sequence[float], rates: Sequence[arb], allowed: Sequence[arb]) -> list[int]:
    """The components that are off by more than is allowed."""
    return [j for j, (a, b, most) in enumerate(zip(given, rates, allowed, strict=True)) if not abs(arb(a) - b) <= most]


def _of_another_time(f: RightHandSide, t: float, y: Sequence[float]) -> list[float]:
    """f with the time as a NumPy number, or as a float if it takes no other, as -(t > 1)."""
    try:
        return _rates_in_floats(f, np.float64(t), y)
    except Refused:
        return _rates_in_floats(f, t, y)


def _jumps_beside(
    f: RightHandSide, t: float, y: Sequence[float], given: Sequence[float], allowed: Sequence[arb]
) -> bool:
    """True if f is what floats gave within some roundings of t, as where it jumps at t up to rounding."""
    for x in (t - ROUNDINGS_OF_TIME * ulp(t), t + ROUNDINGS_OF_TIME * ulp(t)):
        rates = linearised(f, Clock(Evaluation(), arb(x)), [arb(x) for x in y], slopes=False)[0]
        if not _beyond(given, rates, allowed):
            return True
    return False


def _rates_in_floats(f: RightHandSide, t: float, y: Sequence[float]) -> list[float]:
    try:
        return [float(x) for x in np.asarray(f(t, np.array(y)), dtype=float).ravel()]
    except Refused:  # by an enclosed number, which no float run is given
        raise NotReproduced(
            "f keeps a state from call to call: it computes with what an earlier call was given"
        ) from None
    except Exception as error:  # a user's function may raise anything
        said = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, TypeError) and error.__traceback__ and not error.__traceback__.tb_next:
            held = [*signature(f.func).parameters][2:] if isinstance(f, partial) and f.keywords else []
            more = f"its parameters are {', '.join(held)}" if held else "see functools.partial"
            raise ValueError(f"f must take (t, y) and return numbers: {said}; {more}") from None
        if (taken := _components_taken(f, t, y, said)) is not None:
            raise ValueError(f"f fails on the {len(y)} components that it is given, not on {taken}; {said}") from None
        raise Refused(f"f fails in floats at t = {t}, on {len(y)} components: {said}") from None


def _components_taken(f: RightHandSide, t: float, y: Sequence[float], said: str) -> int | None:
    """The number of components on which f does not fail as `said`; None if it fails on others, too.

    More are tried with y repeated, so that all that f may fail on is still there, and fewer if f itself tells them.
    """
    fewer = [int(told[1]) for told in [_UNPACKS.search(said)] if told]
    for n in fewer or range(len(y) + 1, len(y) + 1 + _MORE_COMPONENTS):
        with suppress(Exception):
            if np.size(f(t, np.resize(np.array(y), n))) == n:
                return n
    return None
