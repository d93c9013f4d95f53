"""The error of a float trajectory, proved: the true solution enclosed at the same times, and subtracted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import floor
from typing import Any

import numpy as np
from flint import arb, ctx

from driftproof.enclosure.fields import RightHandSide, enclosed_rates, rebound
from driftproof.enclosure.numbers import Enclosed, Evaluation, Refused
from driftproof.enclosure.solutions import BITS_AT_FIRST, Enclosure, enclose_solution
from driftproof.enclosure.steps import jacobian_of, size

MOST_DOUBLINGS = 4
# The radius is small at 2⁻⁴⁰ of the largest error, which leaves twelve digits; or at 2⁻¹⁰⁴ of the solution, which is
# twice as many digits as a double has, for trajectories without an error.
RADIUS_TO_ERROR, RADIUS_TO_SOLUTION = arb(2) ** -40, arb(2) ** -104
# f in floats may differ from f in balls by so much, relative to what the rounding of its arguments does: half of a
# double's digits. It is to notice another function, not to bound rounding.
REPRODUCED = 2.0**-26
# The points at which this is looked at, evenly spread.
MOST_REPRODUCED = 64
# Twice the bits that lead further by less than this part of the whole time show that f is in the way, not the bits.
FURTHER = Fraction(1, 1000)


@dataclass(frozen=True)
class Certificate:
    """The error y[i] - y(t[i]) of each point of a trajectory, as a row of balls; y(t) starts from y[0] as it stands.

    `digits` is how many decimals of the solution's largest component every point has right at least; `steps` and
    `bits` say what the enclosure took; `doubles` are the constants of f, taken as they are: 0.1 is not 1/10.
    """

    t: tuple[float, ...]
    errors: tuple[tuple[arb, ...], ...]
    digits: int
    bits: int
    steps: int
    doubles: tuple[float, ...]

    @property
    def worst(self) -> tuple[int, int]:
        """Point and component of the largest error."""
        places = [(i, j) for i, row in enumerate(self.errors) for j in range(len(row))]
        return max(places, key=lambda place: float(self.errors[place[0]][place[1]].abs_upper()))

    @property
    def largest_error(self) -> arb:
        """A ball of the largest size of any error."""
        with ctx.workprec(self.bits):
            largest = arb(0)
            for error in (error for row in self.errors for error in row):
                largest = largest.max(abs(error))
            return largest

    def place(self) -> str:
        """Where the largest error is, in words."""
        i, j = self.worst
        return f"component {j} at t = {self.t[i]:.17g}, point {i} of {len(self.t)}"

    def text(self) -> str:
        """The certificate in words, each number rounded to the digits that are proved."""
        lines = [
            f"largest error {decimal(self.largest_error)}, proved: {self.place()}",
            f"{self.digits} digits right at every point; steps: {self.steps}, bits: {self.bits}",
        ]
        if self.doubles:
            lines.append(f"f's constants are these doubles, exactly: {', '.join(map(repr, self.doubles))}")
        return "\n".join(lines)


def decimal(x: arb) -> str:
    """Ten digits, or those that the ball is sure of."""
    return str(x.str(10, radius=False))


def certify(f: RightHandSide, t: Any, y: Any = None) -> Certificate:
    """The error of a float trajectory of y' = f(t, y), enclosed: y[i] at t[i], one row a time, from any solver.

    In place of t and y there may be what a solver returned: an object with .t and .y, one column a time (SciPy's), or
    with .ts and .ys, one row a time. f is run unchanged on balls, and on series of balls. Raises Refused where nothing
    can be proved.

    >>> from driftproof import certify
    >>> found = certify(lambda t, y: -y, [0.0, 0.5, 1.0], [[1.0], [0.6065], [0.3679]])
    >>> print(found.text())
    largest error 3.065971263e-5, proved: component 0 at t = 0.5, point 1 of 3
    4 digits right at every point; steps: 1, bits: 128
    """
    times, states = trajectory_of(t, y)
    _require_reproduced(f, times, states)
    exact = [Fraction(x) for x in times]
    bits, reached = BITS_AT_FIRST, exact[0]
    for last in (*[False] * MOST_DOUBLINGS, True):
        try:
            enclosed = enclose_solution(f, [Fraction(x) for x in states[0]], exact, bits)
            errors = _errors(states, enclosed)
            if _is_small(errors, enclosed):
                return Certificate(
                    tuple(times), errors, _digits(errors, enclosed), bits, enclosed.steps, enclosed.doubles
                )
        except Refused as refusal:
            if last or refusal.t is None or refusal.t <= reached + FURTHER * (exact[-1] - exact[0]):
                raise
            reached = refusal.t
        bits *= 2
    raise Refused(f"the error is not known to twelve digits with {bits // 2} bits")


def assert_accurate(solution: Any, f: RightHandSide, tolerance: float) -> None:
    """No component of the solution of y' = f(t, y) is off by more than the tolerance at any of its points.

    Raises AssertionError with the worst point and its proved error, and Refused where nothing can be proved. `solution`
    is what `certify` takes, or a pair (t, y).

    >>> from driftproof import assert_accurate
    >>> rows = [0.0, 0.5, 1.0], [[1.0], [0.6065], [0.3679]]
    >>> assert_accurate(rows, lambda t, y: -y, 1e-4)
    >>> assert_accurate(rows, lambda t, y: -y, 1e-5)
    Traceback (most recent call last):
    AssertionError: off by 3.065971263e-5, more than 1e-05: component 0 at t = 0.5, point 1 of 3 (proved)
    """
    if not tolerance >= 0:
        raise ValueError(f"tolerance is {tolerance}; it has to be a number that is not negative")
    found = certify(f, *solution) if isinstance(solution, tuple) else certify(f, solution)
    largest = found.largest_error
    if largest <= arb(tolerance):
        return
    if not largest > arb(tolerance):
        raise Refused(f"the largest error is {decimal(largest)}, too near the tolerance {tolerance} to tell")
    raise AssertionError(f"off by {decimal(largest)}, more than {tolerance}: {found.place()} (proved)")


def trajectory_of(t: Any, y: Any) -> tuple[list[float], list[list[float]]]:
    """Times and states, a row each. Raises Refused for what is no trajectory."""
    if y is None:
        if hasattr(t, "t") and hasattr(t, "y"):
            t, y = t.t, np.asarray(t.y).T
        elif hasattr(t, "ts") and hasattr(t, "ys"):
            t, y = t.ts, t.ys
        else:
            raise Refused(f"{type(t).__name__} has neither .t and .y nor .ts and .ys; give t and y apart")
    times, states = _floats("t", t), _floats("y", y)
    if times.ndim != 1 or len(times) < 2:
        raise Refused(f"t has the shape {times.shape}; it has to be a row of two times at least")
    if states.ndim == 1:
        states = states[:, None]
    if states.ndim != 2 or len(states) != len(times) or not states.shape[1]:
        raise Refused(f"y has the shape {states.shape}; it has to be a row for each of {len(times)} times")
    for i, (before, after) in enumerate(pairwise(times), 1):
        if not before < after:
            raise Refused(f"times have to increase: t[{i}] = {after} is not above t[{i - 1}] = {before}")
    return times.tolist(), states.tolist()


def _floats(name: str, values: Any) -> Any:
    found = np.asarray(values)
    if found.dtype.kind not in "fiu" or found.dtype.itemsize > 8:
        raise Refused(f"{name} holds {found.dtype}; floats of at most 64 bits are taken")
    if not np.isfinite(found).all():
        where = np.argwhere(~np.isfinite(found))[0].tolist()
        raise Refused(f"{name}{where} is {found[tuple(where)]}")
    return found.astype(float)


def _require_reproduced(f: RightHandSide, times: list[float], states: list[list[float]]) -> None:
    """f in floats has to be f in balls, up to what rounding does, at points of the trajectory."""
    ours = rebound(f)
    for i in sorted({len(times) * k // MOST_REPRODUCED for k in range(MOST_REPRODUCED)}):
        t, y = times[i], states[i]
        try:
            given = np.asarray(f(t, np.array(y)), dtype=float).ravel()
        except (TypeError, ValueError, ArithmeticError, IndexError) as error:
            raise Refused(f"f fails in floats at t = {t}: {type(error).__name__}: {error}") from None
        evaluation = Evaluation()
        time, balls = Enclosed(evaluation, arb(t)), [arb(x) for x in y]
        rates = [arb(rate.value) for rate in enclosed_rates(ours, time, [Enclosed(evaluation, x) for x in balls])]
        if len(given) != len(rates):
            raise Refused(f"f returns {len(given)} rates for {len(rates)} components")
        slopes = jacobian_of(ours, Enclosed(Evaluation(), arb(t)), balls)
        moved = [sum((abs(J * x) for J, x in zip(row, balls, strict=True)), arb(0)) for row in slopes]
        allowed = REPRODUCED * (size(rates) + size(moved))
        for j, (a, b) in enumerate(zip(given.tolist(), rates, strict=True)):
            if not abs(arb(a) - b) <= allowed:
                raise Refused(f"f in floats is {a!r} at t = {t}, component {j}; in balls it is {decimal(b)}")


def _errors(states: list[list[float]], enclosed: Enclosure) -> tuple[tuple[arb, ...], ...]:
    with ctx.workprec(enclosed.bits):
        return tuple(
            tuple(arb(x) - true for x, true in zip(row, balls, strict=True))
            for row, balls in zip(states, enclosed.states, strict=True)
        )


def _is_small(errors: Sequence[Sequence[arb]], enclosed: Enclosure) -> bool:
    radius = size(error.rad() for row in errors for error in row)
    largest = size(error for row in errors for error in row)
    solution = size(x for row in enclosed.states for x in row)
    return bool(radius <= RADIUS_TO_ERROR * largest or radius <= RADIUS_TO_SOLUTION * solution)


def _digits(errors: Sequence[Sequence[arb]], enclosed: Enclosure) -> int:
    """The least over the points of floor(-log10 |error|/|y|) in the maximum norm, at least 0."""
    with ctx.workprec(enclosed.bits):
        relative = [
            size(row) / max((arb(x.abs_lower()) for x in true), key=float)
            for row, true in zip(errors, enclosed.states, strict=True)
            if size(row) > 0
        ]
        least = min((float((-x.log() / arb(10).log()).lower()) for x in relative), default=float("inf"))
    # Without any error: as many digits as the doubles have.
    return 17 if least == float("inf") else max(0, floor(least)) if least == least else 0
