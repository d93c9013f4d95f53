"""Crossing from one form of f to another: the kink of |y|, a valve that opens, a relay.

Steps come as near to the crossing as they can be proved to lie before it. Over what is left, a window of some 2⁻¹⁰⁰,
nothing is assumed of the side on which the solution is: y' lies in the hull of all values that f takes, on whichever
sides of its comparisons, on a box that the solution cannot leave. Behind the window the side is certain again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly, ctx

from driftproof.enclosure.clocks import Clock
from driftproof.enclosure.fields import RightHandSide, enclosed_rates
from driftproof.enclosure.numbers import Enclosed, Evaluation, Refused, size
from driftproof.symbolic.algebra.certified import enclose

# A step is searched for changes at so many places; one that is missed is only found by shorter steps.
SEARCHED = 16
# The box is twice as long as the solution goes by f where it begins, or by f behind it; it hardly goes back, to where
# the other side of f may be: by 2⁻²³ of its length, which Arb's radii of thirty bits still tell from nothing.
WIDENINGS, AROUND = 3, arb(1 - 2.0**-24, 1 + 2.0**-24)
# Bits that the rounding of sums of balls may take.
BITS_OF_SUMS = 8
# The set is followed for at most so many times, each four times as long as the one before; f has to be certain on a set
# so many times as wide as it is, since the first tube of a step is four times as wide in the norm of its weights.
FOLLOWED, CERTAIN = 10, 64
# More sides than a few relays that switch at once have.
MOST_SIDES = 64
# The parts of the time to the crossing that a step leaves, the least first: near it, f's comparisons are nearly linear
# in time, so that a step can leave about the square of the time that is left.
LEFT = tuple(Fraction(1, 2**k) for k in (96, 48, 24, 12, 6, 3, 1))


class Crossing(Refused):
    """No step towards a change of f's comparisons can be proved; along the polynomial it comes after the time `s`."""

    def __init__(self, reason: str, s: Fraction) -> None:
        """Keep the time."""
        super().__init__(reason)
        self.s = s


@dataclass(frozen=True)
class Window:
    """A crossing within [t, t + h]: the solution is in the balls `whole` all the time, and in `after` at the end."""

    t: Fraction
    h: Fraction
    whole: tuple[arb, ...]
    after: tuple[arb, ...]

    def state_at(self, _: Fraction) -> tuple[arb, ...]:
        """Balls of the solution at a time of the window."""
        return self.whole


def first_change(
    f: RightHandSide, t: Fraction, rows: Sequence[Sequence[arb]], decided: Sequence[bool], longest: Fraction
) -> Fraction | None:
    """About when f's comparisons along the polynomials in s are no longer those decided: a guess, and None if never."""
    polynomials = [arb_poly(list(row)) for row in rows]

    def changes(s: Fraction) -> bool:
        evaluation, at = Evaluation(span=(t + s, None)), enclose(s)
        try:
            state = [Enclosed(evaluation, arb(p(at)).mid()) for p in polynomials]
            enclosed_rates(f, Clock(evaluation, enclose(t + s)), state)
        except Refused:
            return True
        return evaluation.taken != decided

    after = next((s for k in range(SEARCHED) if changes(s := longest * (k + 1) / SEARCHED)), None)
    if after is None:
        return None
    before = after - longest / SEARCHED
    for _ in range(ctx.prec):
        middle = (before + after) / 2
        before, after = (before, middle) if changes(middle) else (middle, after)
    return after


def crossed(f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb]) -> Window | None:
    """A window that begins with [t, t + h], for solutions from the box; None if f is certain behind none.

    The set of solutions is as wide as the sides of f differ in the first h. It is followed, by times that grow, until f
    is certain on a set many times as wide, as tubes are.
    """
    whole, end = list(box), t
    for k in range(FOLLOWED):
        length = h * 4**k
        if (found := _followed(f, end, length, box)) is None:
            return None
        during, box = found
        whole, end = [x.union(y) for x, y in zip(whole, during, strict=True)], end + length
        wide = CERTAIN * size(x.rad() for x in box)
        if _is_certain(f, end, [x + arb(0, wide.upper()) for x in box]):
            return Window(t, end - t, tuple(whole), tuple(box))
    return None


def _followed(
    f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb]
) -> tuple[Sequence[arb], Sequence[arb]] | None:
    """Balls of the solutions from the box during [t, t + h], and at its end; None if no box is found to hold them."""
    length, rates = enclose(h), _rates_on_all_sides(f, t, h, box)
    resolved = [arb(0, ((abs(x) + length) * arb(2) ** (BITS_OF_SUMS - ctx.prec)).upper()) for x in box]
    for _ in range(WIDENINGS):
        around = [x + rate * AROUND * length + r for x, rate, r in zip(box, rates, resolved, strict=True)]
        rates = _rates_on_all_sides(f, t, h, around)
        during = [x + rate * length * arb(0.5, 0.5) for x, rate in zip(box, rates, strict=True)]
        if all(big.contains_interior(x) for big, x in zip(around, during, strict=True)):
            return during, [x + rate * length for x, rate in zip(box, rates, strict=True)]
    return None


def _is_certain(f: RightHandSide, t: Fraction, box: Sequence[arb]) -> bool:
    evaluation = Evaluation(span=(t, None))
    try:
        enclosed_rates(f, Clock(evaluation, enclose(t)), [Enclosed(evaluation, x) for x in box])
    except Refused:
        return False
    return True


class _SomeSides(Evaluation):
    """A run whose comparisons that are not decided have the outcomes `sides`, and those beyond are False."""

    def __init__(self, sides: Sequence[bool], span: tuple[Fraction, Fraction]) -> None:
        super().__init__(span=span)
        self.sides, self.asked = sides, 0

    def undecided(self) -> bool:
        self.asked += 1
        return self.asked <= len(self.sides) and self.sides[self.asked - 1]


def _rates_on_all_sides(f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb]) -> list[arb]:
    """Balls of f on [t, t + h] and the box, whatever the outcomes of the comparisons that these do not decide."""
    found: list[arb] | None = None
    left, runs = [list[bool]()], 0
    time = arb(0.5, 0.5) * enclose(h) + enclose(t)
    while left:
        sides, runs = left.pop(), runs + 1
        if runs > MOST_SIDES:
            raise Refused("f changes too often at one time")
        evaluation = _SomeSides(sides, (t, t + h))
        rates = enclosed_rates(f, Clock(evaluation, time), [Enclosed(evaluation, x) for x in box])
        values = [arb(rate.value) for rate in rates]
        found = values if found is None else [a.union(b) for a, b in zip(found, values, strict=True)]
        left += [[*sides, *[False] * k, True] for k in range(evaluation.asked - len(sides))]
    assert found is not None
    return found
