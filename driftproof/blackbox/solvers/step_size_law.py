"""The law of step sizes: its form in words, and its fit to the errors of attempted steps and the factors after them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import exp, inf, isclose, log, log1p
from typing import Any, NamedTuple

import numpy as np

# A law must give every factor to this relative accuracy: the scale is known better, and its exponents are small.
_CLOSE = 1e-4
# Fits with memory leave out steps after a smaller r: some codes remember no error below 10^-4.
FORGOTTEN = 1e-3
# The largest denominator of an exponent, and 1 over the least one: controllers in use have 1/5, 7/50, 17/100, ...
_MOST_DENOMINATOR = 120


@dataclass(frozen=True)
class Law:
    """h_next = h · clip(safety · r^(-exponent) · r_before^(memory) · (h/h_before)^(filtered), smallest, largest).

    r is the error over the tolerance, by the estimate of the pair `estimate`. `smallest`, `largest` and `longest` are
    None if no factor was clipped there, and no step. `after_rejection` is true if steps after a rejected one do not
    grow, `exception` says which other steps do not follow the law. `accepted` is the largest r of an accepted step,
    `rejected` the least of a rejected one.
    """

    estimate: str
    safety: float
    exponent: Fraction | float
    memory: Fraction | float
    filtered: Fraction | float
    smallest: float | None
    largest: float | None
    longest: float | None
    after_rejection: bool
    accepted: float
    exception: str
    rejected: float = inf

    def logs(self, p: LawPoint) -> tuple[float, float]:
        """The logs of the factor after an attempt if nothing limits it, with the memory of the law and without it."""
        forgetful = log(self.safety) - self.exponent * p.error
        return forgetful + self.memory * p.before + self.filtered * p.growth, forgetful

    @property
    def words(self) -> str:
        """The law in one line."""
        power = f"{self.safety:.4g} r^(-{shown(self.exponent)})"
        before = f" r_before^({shown(self.memory)})" if self.memory else ""
        before += f" (h/h_before)^({shown(self.filtered)})" if self.filtered else ""
        low = "no smallest factor observed" if self.smallest is None else f"at least {self.smallest:.4g}"
        high = "no largest observed" if self.largest is None else f"at most {self.largest:.4g}"
        high += "" if self.longest is None else f", no step above {self.longest:.4g}"
        beyond = f", accepting up to {self.accepted:.3g} times the tolerance" * (self.accepted > 1 + _CLOSE)
        kind = "PI" if self.memory or self.filtered else "not PI"
        return f"h_next/h = {power}{before}, {low}, {high}{beyond} ({kind}){self.exception}"


class LawPoint(NamedTuple):
    """An attempt and the `factor` of the step size after it.

    `error` and `before` are log r of this and of the last accepted step, `growth` is the log of h over the h of that.
    `rounded` is the part of r that rounding of the states may change. `longest` is the size of the next step if no
    other is longer, else 0.
    """

    error: float
    rounded: float
    before: float
    growth: float
    factor: float
    accepted: bool
    rejections: int
    at_jump: bool
    longest: float = 0.0


def fitted_law(name: str, points: Sequence[LawPoint]) -> Law | None:
    """The law in this estimate, or None: fitted to the steps that no limit clips, then compared with all."""
    factors = [p.factor for p in points if p.rejections <= 1]
    smallest, largest = min(factors), max(factors)
    known = [p for p in points if not (p.rejections or p.longest or p.rounded > _CLOSE)]
    free = [p for p in known if not any(is_close(p.factor, x) for x in (smallest, largest, 1.0))]
    remembered = [p for p in free if p.before > log(FORGOTTEN)]
    found = _fitted(free, 2) or _fitted(remembered, 3) or _fitted(remembered, 4)
    if found is None:
        return None
    exponent, memory, filtered = [*found[1:], 0, 0][:3]
    held = [p.factor for p in points if p.accepted and p.rejections]
    accepted = exp(max(p.error for p in points if p.accepted and not p.at_jump))
    after = bool(held) and max(held) <= 1 + _CLOSE
    rejected = exp(min((p.error for p in points if not (p.accepted or p.at_jump or p.rounded > _CLOSE)), default=inf))
    law = Law(name, exp(found[0]), exponent, memory, filtered, None, None, None, after, accepted, "", rejected)
    if (exception := exceptions(points, law, smallest, largest)) is None:
        return None
    cut = [(p, log(p.factor) - max(law.logs(p))) for p in points if p.rejections <= 1]  # by limits: not 0
    # At a jump rounded times make an error another one, and one factor the least; a limit is that of most below it.
    below = [p.factor for p, x in cut if log(smallest / p.factor) + x > _CLOSE]
    low = 2 * sum(is_close(factor, smallest) for factor in below) > len(below)
    high = any(x < -_CLOSE and is_close(p.factor, largest) and not p.longest for p, x in cut)
    long = [p.longest for p, x in cut if p.longest and x < -_CLOSE and not (high and is_close(p.factor, largest))]
    least, most, longest = smallest if low else None, largest if high else None, long[0] if long[1:] else None
    return replace(law, smallest=least, largest=most, longest=longest, exception=exception)


def exceptions(points: Sequence[LawPoint], law: Law, smallest: float, largest: float) -> str | None:
    """The steps that do not follow the law, in words, by the rejections in a row before them; "" if there are none.

    None if these are half of all or more, so that it is no law. A step may keep its size, and a law may forget its
    memory after a rejection. For a law with memory, steps after an error too small to be remembered are left out.
    """
    known = [p for p in points if not p.at_jump and (not law.memory or p.before > log(FORGOTTEN))]
    others: list[tuple[LawPoint, float]] = []
    for p in known:
        remembering, forgetful = law.logs(p)
        # Where rounding may be more than r, the step still grows as after an error of both together.
        doubtful = min(remembering, forgetful) - law.exponent * log1p(p.rounded)
        *said, least = (exp(min(max(x, log(smallest)), log(largest))) for x in (remembering, forgetful, doubtful))
        short = p.rounded > 1 and not p.rejections and p.factor < least * (1 - _CLOSE)
        cut = p.longest and p.factor < said[0]
        if short or not (cut or any(isclose(p.factor, x, rel_tol=_CLOSE + p.rounded) for x in (*said, 1.0))):
            others.append((p, said[0]))
    if 2 * len(others) >= len(known):
        return None
    if not others:
        return ""
    free = [p for p, _ in others if not is_close(p.factor, smallest)]
    plain = None if any(p.accepted for p, _ in others) else _fitted(free, 2)
    clipped = [p for p, _ in others if is_close(p.factor, smallest)]
    if plain and plain[1] > 0 and all(plain[0] - plain[1] * p.error < log(smallest) + _CLOSE for p in clipped):
        return f"; after a rejection {exp(plain[0]):.4g} r^(-{shown(plain[1])})"
    first, said_first = min(others, key=lambda pair: pair[0].rejections)
    beside = sum(p.rejections >= first.rejections for p in known)
    where = f" after {first.rejections} or more rejections in a row" * (first.rejections > 0)
    times = f"{first.factor:.4g} times as long instead of {said_first:.4g}"
    return f", but {len(others)} of {beside} steps{where} differ: one is {times}"


def _fitted(points: Sequence[LawPoint], terms: int) -> list[Any] | None:
    """The log of the safety, the exponent and the further terms that give all factors; None if none do.

    The safety has two digits, and a term is a fraction of a denominator in use, if that gives the factors as well.
    Further terms below those of any controller in use are no law: such a fit follows the noise of another one.
    """
    if len(points) < terms + 3:
        return None
    matrix = np.array([[-p.error, p.before, p.growth] for p in points])[:, : terms - 1]
    logarithms = np.log([p.factor for p in points])
    solved, *_ = np.linalg.lstsq(np.hstack([np.ones((len(points), 1)), matrix]), logarithms, rcond=None)
    exact: list[Fraction | float] = solved[1:].tolist()
    near: list[Fraction | float] = [Fraction(x).limit_denominator(_MOST_DENOMINATOR) for x in exact]
    tried = (near, *([*exact[:i], x, *exact[i + 1 :]] for i, x in enumerate(near)), exact)

    def left_by(terms: Sequence[Fraction | float]) -> np.ndarray[Any, Any]:
        return np.asarray(logarithms - matrix @ [*map(float, terms)])

    found = next((each for each in tried if np.ptp(left_by(each)) <= 2 * _CLOSE), None)
    if found is None or any(0 < abs(float(x)) < 1 / _MOST_DENOMINATOR for x in found[1:]):
        return None
    if terms > 2 and isclose(found[0], found[1], abs_tol=_CLOSE):  # a law over itself one step before: no tolerance
        return None
    left = left_by(found)
    safety = float(left.max() + left.min()) / 2
    two_digits = log(round(exp(safety), 2) or 1.0)
    return [two_digits if np.abs(left - two_digits).max() <= _CLOSE else safety, *found]


def is_close(x: float, value: float) -> bool:
    """True if a factor, or an exponent, is this one as far as the scale of errors is known."""
    return isclose(x, value, rel_tol=_CLOSE)


def shown(x: Fraction | float) -> str:
    """An exponent as a fraction, or in four digits."""
    return str(x) if isinstance(x, Fraction) else f"{x:.4g}"
