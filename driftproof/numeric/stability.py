"""What float runs show of stability: where they end, how a linear step grows, the largest step that stays bounded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, isfinite, nextafter

import numpy as np

from driftproof.numeric.advance import Advance, State, why
from driftproof.numeric.powers import powers_stay_bounded

# Steps that a run takes between looks at its state, at most: a state that is not finite is found by going back.
BETWEEN_LOOKS = 1 << 12
# Steps looked at for a first growth, in powers of two times 1/|A|.
SMALLEST, LARGEST = -20, 30


@dataclass(frozen=True)
class Observed:
    """A run of `steps` steps of the float h: its last state, or after how many steps it ended, and of what.

    `failed_after` is the number of the first step whose state is not finite, or which could not be made; None if all
    were. `largest`: the largest size of a state seen, at looks up to BETWEEN_LOOKS steps apart.
    """

    h: float
    steps: int
    state: State
    largest: float
    failed_after: int | None = None
    remark: str = ""


def observe(advance: Advance, start: State, h: float, steps: int, enough: float = inf) -> Observed:
    """Run, looking after 1, 2, 4, ... more steps; it stops at a state that is not finite, or larger than `enough`."""
    y, done, stride, largest = start, 0, 1, size(start)
    while done < steps and largest <= enough:
        last = min(steps, done + stride)
        try:
            reached = advance(y, h, done, last)
        except (ArithmeticError, ValueError) as error:  # math.log of a negative number is a ValueError
            if last == done + 1:
                return Observed(h, steps, y, largest, last, why(error))
            stride = 1
            continue
        if not isfinite(size(reached)):
            if last == done + 1:
                return Observed(h, steps, reached, inf, last, "not finite")
            stride = (last - done) // 2
            continue
        y, done, largest = reached, last, max(largest, size(reached))
        stride = min(2 * stride, BETWEEN_LOOKS)
    return Observed(h, steps, y, largest)


def size(y: State) -> float:
    """The Euclidean length; infinite or NaN where a component is, and also where only the length overflows: inf."""
    return hypot(*y)


def step_matrix(advance: Advance, components: int, h: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The matrix of the float step of a linear problem: its columns are the steps of the unit vectors."""
    units = np.eye(components)
    return np.array([advance(tuple(map(float, unit)), h, 0, 1) for unit in units]).T


def stays_bounded(advance: Advance, components: int, h: float) -> bool:
    """The powers of the float step's matrix stay bounded, as far as `powers` tells."""
    return powers_stay_bounded(step_matrix(advance, components, h))


def largest_bounded(is_bounded: Callable[[float], bool], scale: float) -> tuple[float, float]:
    """Neighbouring doubles, h bounded and the next one not, by bisection where growth first shows; (h, inf) if nowhere.

    Looked for over h = 2ⁿ scale, n from SMALLEST to LARGEST; (0, h) if already the smallest is not bounded. What is
    found is one change from bounded to not: the first, unless two lie between powers of two.
    """
    low = 0.0
    for exponent in range(SMALLEST, LARGEST + 1):
        high = scale * 2.0**exponent
        if not is_bounded(high):
            break
        low = high
    else:
        return low, inf
    while low > 0 and nextafter(low, high) < high:
        middle = (low + high) / 2
        low, high = (middle, high) if is_bounded(middle) else (low, middle)
    return low, high


def fewest_steps(is_good: Callable[[int], bool], most: int) -> int | None:
    """An N with N good and N - 1 not, found between a power of 2 and the next, from which on all up to `most` are good.

    By halving from `most`, a power of 2, so that none is found that is good by luck below others that are not; None if
    `most` itself is not good. Then by bisection; 1 if all are good.
    """
    if not is_good(most):
        return None
    good = most
    while good > 1 and is_good(good // 2):
        good //= 2
    bad = good // 2
    while good - bad > 1:
        middle = (bad + good) // 2
        bad, good = (bad, middle) if is_good(middle) else (middle, good)
    return good
