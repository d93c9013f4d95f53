"""Stability as float runs show it: where runs end, whether powers of a linear step stay bounded, and up to which h."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import floor, hypot, inf, isfinite, nextafter
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.numeric.advance import Advance, State, error_summary
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.steps.field_loops import field_writers

_Matrix: TypeAlias = NDArray[np.float64]

# The most steps between two looks at the state (chosen: to find the first that is not finite repeats about as many).
STEPS_BETWEEN_CHECKS = 1 << 12
# The step sizes at which growth is first looked for, as powers of two times 1/|A|.
SMALLEST, LARGEST = -20, 30
# A proved limit H is looked beyond at H (1 + 2**-k), for growth that ends before the next power; and above the first
# growth there are so many equally spaced looks for an end of it (chosen: gaps of splittings are some tenths wide).
BEYOND, AGAIN = range(4, 41, 4), 48

# Powers 2**n, n up to SQUARINGS, of the balanced matrix count as bounded if they stay below GROWTH. A spectral radius
# ρ > 1 is detected from ρ - 1 = log(GROWTH)/2**SQUARINGS = 7e-14 on: more squarings would show how the entries of a
# float step were rounded, which moves ρ by some u. A Jordan block on the unit circle grows to 2**SQUARINGS.
# Rounding: entries of size up to GROWTH lose GROWTH² 2**-BITS = 7e-28 relatively in one squaring, and 2**48 times as
# much by the end, 2e-13. Powers near a limit where two eigenvalues meet stay below GROWTH to a distance of 1e-18. What
# has fallen below 1/GROWTH stays there, as n/GROWTH < 1.
SQUARINGS, GROWTH, BITS = 48, 1e9, 150
_VANISHED = (1 << BITS) // int(GROWTH)
# Floats decide first, over 2**FEWER powers: those that fall below 1/GROWTH stay there, those above GROWTH have grown.
FEWER = 36
_U = 2.0**-53
# Each sweep to balance a matrix makes it smaller; chosen: two suffice in most units, many in those of a long chain.
_MOST_SWEEPS = 100


# Chosen: a solution that decays by e^-1000 where it follows slower ones costs explicit methods some 400 steps or more.
STIFF_DECAY = 1000.0


def fastest_decay(problem: Problem) -> tuple[float, float]:
    """The largest -Re of an eigenvalue of df/dy at the reference's times, less what grows there, and its first time."""
    n, writers, found = len(problem.start), field_writers(problem.field, compiled=False), (0.0, 0.0)
    times: list[tuple[Fraction, Sequence[Any]]] = [(Fraction(0), problem.start)]
    times += zip(problem.reference.times, problem.reference.states, strict=True)
    for t, state in times:
        rows, matrix = writers.zeros(n, min(n, sum(writers.band) + 1)), np.zeros((n, n))
        with suppress(ArithmeticError, ValueError):  # of a formula without a value there
            writers.jacobian(float(t), list(map(float, state)), rows)
            for k, row in enumerate(rows):
                first = max(0, k - writers.band.lower)
                matrix[k, first : first + len(row)] = row[: n - first]
            rates = np.linalg.eigvals(matrix).real
            decay = float(-rates.min() - max(rates.max(), 0.0))  # no more than where others grow as fast
            found = max(found, (decay, float(t)), key=lambda each: each[0])
    return found


@dataclass(frozen=True)
class Observed:
    """What was seen of a run: its last state and, if it failed, at which step and why (`remark`).

    `failed_after` is the number of the first step whose state is not finite or could not be computed; None if there is
    none. `largest` is the largest norm of a state seen, at looks up to STEPS_BETWEEN_CHECKS steps apart.
    """

    state: State
    largest: float
    failed_after: int | None = None
    remark: str = ""


def observe(
    advance: Advance,
    start: State,
    h: float,
    steps: int,
    enough: float = inf,
    *,
    apart: int = STEPS_BETWEEN_CHECKS,
    look: Callable[[int, State], object] = lambda done, y: None,
) -> Observed:
    """Run, looking at the state after 1, 2, 4, ... more steps; stop if it is not finite or larger than `enough`.

    Looks are at most `apart` steps apart; `look` gets the number of steps so far and the state.
    """
    y, done, stride, largest = start, 0, 1, hypot(*start)
    while done < steps and largest <= enough:
        last = min(steps, done + stride)
        try:
            reached = advance(y, h, done, last)
        except (ArithmeticError, ValueError) as error:  # math.log of a negative number is a ValueError
            if last == done + 1:
                return Observed(y, largest, last, error_summary(error))
            stride = 1
            continue
        if not all(map(isfinite, reached)):
            if last == done + 1:
                return Observed(reached, inf, last, "not finite")
            stride = (last - done) // 2
            continue
        y, done, largest = reached, last, max(largest, hypot(*reached))
        look(done, y)
        stride = min(2 * stride, apart)
    return Observed(y, largest)


def stays_bounded(advance: Advance, components: int, h: float) -> bool:
    """True if the powers of a linear problem's float step, the matrix of its steps from unit vectors, stay bounded.

    A step without a solution does not.
    """
    try:
        steps = [advance(tuple(unit), h, 0, 1) for unit in np.eye(components).tolist()]
    except ArithmeticError:
        return False
    return powers_stay_bounded(np.array(steps).T)


def powers_stay_bounded(matrix: _Matrix) -> bool:
    """True if the powers 1, 2, 4, ..., 2**SQUARINGS of the matrix stay below GROWTH; False for entries not finite.

    The units of the components do not matter, as the matrix is balanced first.
    """
    if not np.isfinite(matrix).all():
        return False
    matrix = in_balanced_units(matrix)
    verdict = _by_floats(matrix)
    return _by_integers(matrix) if verdict is None else verdict


def in_balanced_units(matrix: _Matrix) -> _Matrix:
    """The matrix in units 2**e of its components, chosen from it alone: entries (i, j) times 2**(eⱼ - eᵢ).

    Groups of components that act on each other are balanced: rows and columns have about the same sum (osborne-1960). A
    group on which others act one way gets a unit in which the largest entry from them is about the largest within
    groups, so that a Jordan block grows however small its entry is.
    """
    n, e = len(matrix), np.zeros(len(matrix), dtype=int)
    with np.errstate(divide="ignore"):
        sizes = np.log2(np.abs(matrix))
    acts = np.isfinite(sizes) | np.eye(n, dtype=bool)
    for _ in range(n.bit_length()):
        acts = acts @ acts
    mutual, order = acts & acts.T, np.argsort(acts.sum(axis=1), kind="stable")  # what acts comes first
    groups = [group for i in order if (group := np.flatnonzero(mutual[i]))[0] == i]
    for group in groups:
        for _ in range(_MOST_SWEEPS * (len(group) > 1)):
            before = e[group]
            for k in group:
                rest = group[group != k]
                row, column = sizes[k, rest] + e[rest], sizes[rest, k] - e[rest]
                e[k] = np.rint((np.logaddexp2.reduce(row) - np.logaddexp2.reduce(column)) / 2)
            if (e[group] == before).all():
                break
    largest = (sizes + e - e[:, None])[mutual].max()
    for group in groups:
        if (others := np.flatnonzero(acts[group[0]] & ~mutual[group[0]])).size:
            entry = (sizes[np.ix_(group, others)] + e[others] - e[group, None]).max()
            e[group] += int(np.ceil(entry - (largest if isfinite(largest) else 0.0)))
    found: _Matrix = np.ldexp(matrix, e - e[:, None])
    return found


def _by_floats(matrix: _Matrix) -> bool | None:
    """True if the powers vanish whatever rounding did, False if they grow before it could, None if undecided.

    `off` bounds the error of each entry of a power P with n rows. For P² the bound is n (2 |P| off + off² + n u |P|²),
    whatever the order of the sums. Where n (|P| + off) < 1, the powers of the true P vanish.
    """
    power, off, n = matrix, 0.0, len(matrix)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for squared in range(FEWER):
            largest = float(np.abs(power).max())
            if not largest < GROWTH:  # NaN is not
                return False if squared < FEWER // 2 else None
            if largest < 1 / GROWTH:
                return True if n * (largest + off) < 1 else None
            off = n * (2 * largest * off + off * off + n * _U * largest * largest)
            power = power @ power
    return None


def _by_integers(matrix: _Matrix) -> bool:
    """The same with entries that are whole multiples of 2**-BITS, once they have been rounded down to these."""
    power = np.array([[floor(Fraction(float(x)) * 2**BITS) for x in row] for row in matrix], dtype=object)
    for _ in range(SQUARINGS + 1):
        largest = max(map(abs, power.ravel()))
        if largest >= int(GROWTH) << BITS or largest <= _VANISHED:
            return bool(largest <= _VANISHED)
        power = (power @ power) >> BITS
    return True


def largest_bounded(
    is_bounded: Callable[[float], bool], scale: float, proved: float | None = None, most: int = LARGEST
) -> tuple[float, float]:
    """Two neighbouring doubles, bounded at the first but not at the next, by bisection where growth first shows.

    Looks at h = 2ⁿ scale for n from SMALLEST to `most`, and just beyond a `proved` limit, as growth may end again
    before the next power of two. Returns (0, h) if the smallest is not bounded, and (h, inf) if all are. The pair is
    one change from bounded to not: the first, unless two lie between neighbours of these h.
    """
    powers, low = [scale * 2.0**exponent for exponent in range(SMALLEST, most + 1)], 0.0
    beyond = [proved * (1 + 2.0**-k) for k in BEYOND if proved and powers[0] < proved < powers[-1]]
    for high in sorted([*powers, *beyond]):
        if not is_bounded(high):
            return _change(is_bounded, low, high) if low else (low, high)
        low = high
    return low, inf


def bounded_again(is_bounded: Callable[[float], bool], grows: float, largest: float) -> tuple[float, ...]:
    """The first h above `grows` with bounded powers and the last before they grow again, up to `largest`.

    Seen at AGAIN h up to 4 grows and then at powers of two times that, and found by bisection; () if no look finds
    bounded powers, one number if none finds growth after them.
    """
    ends, low, looks = list[float](), grows, [grows * (1 + 3 * k / AGAIN) for k in range(1, AGAIN + 1)]
    while looks[-1] < largest / 2:
        looks.append(2 * looks[-1])
    for high in looks:
        if len(ends) < 2 and is_bounded(high) is not bool(ends):
            ends.append(_change(is_bounded, low, high)[1 - len(ends)])
        low = high
    return tuple(ends)


def _change(is_bounded: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Two neighbouring doubles between which the answer changes, which differs at the two given."""
    at_low = is_bounded(low)
    while nextafter(low, high) < high:
        middle = (low + high) / 2
        low, high = (middle, high) if is_bounded(middle) is at_low else (low, middle)
    return low, high


def fewest_steps(is_good: Callable[[int], bool], most: int) -> int | None:
    """An N such that N, 2N, 4N, ... up to `most` are good, and those of N - 1 are not; 1 if all are.

    None if `most`, a power of 2, is not good. Halving from it down avoids an N that is good by luck below others that
    are not. Bisection between the last good power of 2 and the next lower one then finds N.
    """

    @cache
    def lasts(steps: int) -> bool:
        return is_good(steps) and (2 * steps > most or lasts(2 * steps))

    if not lasts(good := most):
        return None
    while good > 1 and lasts(good // 2):
        good //= 2
    bad = good // 2
    while good - bad > 1:
        middle = (bad + good) // 2
        bad, good = (bad, middle) if lasts(middle) else (middle, good)
    return good
