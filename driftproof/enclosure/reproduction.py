"""Whether what is enclosed is what floats compute: f in floats against f in balls, forwards and backwards."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from math import ulp

import numpy as np
from flint import arb

from driftproof.enclosure.certificate import decimal
from driftproof.enclosure.clocks import Clock
from driftproof.enclosure.evaluations import TWO_RUNS, Evaluation, Overlapping, Refused
from driftproof.enclosure.fields import RightHandSide
from driftproof.enclosure.numbers import size
from driftproof.enclosure.steps import linearised
from driftproof.enclosure.text_fields import field_function
from driftproof.methods.vector_fields import VectorField

# f in floats may differ from f in balls by this much, relative to the sizes of f and of (∂f/∂y) y: half of a double's
# digits. This detects another function, and does not bound rounding.
REPRODUCED = 2.0**-26
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


def _require_reproduced_if_possible(f: RightHandSide, in_balls: RightHandSide, t: float, y: Sequence[float]) -> None:
    """Do what `require_reproduced` does, unless f has no value at this place."""
    try:
        with np.errstate(all="ignore"):  # of NumPy's logarithm of a negative number, say
            require_reproduced(f, in_balls, [t], [y])
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
    require_reproduced(f, in_balls, times, states)
    intervals = len(times) - 1
    for k in range(MOST_REPRODUCED if intervals else 0):
        i, part = divmod(intervals * (k + _NOT_ROUND) / MOST_REPRODUCED, 1)
        (t, y), (other, at_other) = ((times[j], states[j]) for j in (int(i), int(i) + 1))
        state = [a + part * (b - a) for a, b in zip(y, at_other, strict=True)]
        _require_reproduced_if_possible(f, in_balls, t + part * (other - t), state)


def require_reproduced(
    f: RightHandSide, in_balls: RightHandSide, times: Sequence[float], states: Sequence[Sequence[float]]
) -> None:
    """Raise NotReproduced unless f in floats agrees with f in balls, up to rounding, at points of a trajectory.

    f is called at them forwards and then backwards, so that a memory of f, such as a switch, is detected; first with
    the time as a float, then as a number of NumPy, as SciPy gives it. Raises Refused where f has no value.
    """
    checked = sorted({len(times) * k // MOST_REPRODUCED for k in range(MOST_REPRODUCED)})
    forwards = [_rates_in_floats(f, times[i], states[i]) for i in checked]
    backwards = [_of_another_time(f, times[i], states[i]) for i in reversed(checked)]
    for i, given, repeated in zip(checked, forwards, reversed(backwards), strict=True):
        t, balls = times[i], [arb(x) for x in states[i]]
        if len(given) != len(balls):
            raise ValueError(f"f returns {len(given)} numbers for {len(balls)} components")
        try:
            rates, slopes = linearised(in_balls, Clock(Evaluation(), arb(t)), balls)
        except Refused as refusal:
            if not isinstance(refusal, Overlapping):
                raise
            more = f"if f changes its form there, as friction at rest does, {TWO_RUNS}"
            raise Refused(f"{refusal} at t = {t}; {more}", refusal.t) from None
        moved = [sum((abs(J * x) for J, x in zip(row, balls, strict=True)), arb(0)) for row in slopes]
        allowed = REPRODUCED * (size(rates) + size(moved)) + UNDERFLOW
        if not allowed.is_finite():
            raise Refused(f"f or its derivative is not finite at t = {t}")
        for j, (a, again) in enumerate(zip(given, repeated, strict=True)):
            if abs(arb(a) - again) > 2 * allowed:
                raise NotReproduced(f"f is {a!r} at t = {t}, component {j}, but {again!r} {_CALLED_AGAIN}")
        off = [j for j, (a, b) in enumerate(zip(given, rates, strict=True)) if not abs(arb(a) - b) <= allowed]
        if off and not _jumps_beside(in_balls, t, balls, given, allowed):
            said = f"f in floats is {given[off[0]]!r} at t = {t}, component {off[0]}"
            raise NotReproduced(f"{said}, but its enclosure is {decimal(rates[off[0]])}")


def _of_another_time(f: RightHandSide, t: float, y: Sequence[float]) -> list[float]:
    """f with the time as a NumPy number, or as a float if it takes no other, as -(t > 1)."""
    try:
        return _rates_in_floats(f, np.float64(t), y)
    except Refused:
        return _rates_in_floats(f, t, y)


def _jumps_beside(f: RightHandSide, t: float, y: list[arb], given: list[float], allowed: arb) -> bool:
    """True if f is what floats gave within some roundings of t, as where it jumps at t up to rounding."""
    for x in (t - ROUNDINGS_OF_TIME * ulp(t), t + ROUNDINGS_OF_TIME * ulp(t)):
        rates = linearised(f, Clock(Evaluation(), arb(x)), y, slopes=False)[0]
        if all(abs(arb(a) - b) <= allowed for a, b in zip(given, rates, strict=True)):
            return True
    return False


def _rates_in_floats(f: RightHandSide, t: float, y: Sequence[float]) -> list[float]:
    try:
        return [float(x) for x in np.asarray(f(t, np.array(y)), dtype=float).ravel()]
    except Exception as error:  # a user's function may raise anything
        said = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, TypeError) and error.__traceback__ and not error.__traceback__.tb_next:
            raise ValueError(f"f must take (t, y) and return numbers: {said}; see functools.partial") from None
        raise Refused(f"f fails in floats at t = {t}, on {len(y)} components: {said}") from None
