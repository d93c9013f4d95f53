"""Crossing from one form of f to another: the kink of |y|, a valve that opens, a relay.

Steps come as near to the crossing as they can be proved to lie before it. Over what is left, a window of some 2⁻¹⁰⁰,
nothing is assumed of the side on which the solution is: y' lies in the hull of all values that f takes, on whichever
sides of its comparisons, on a cone that the solution cannot leave. Behind the window the side is certain again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, pairwise, product, takewhile
from typing import Any

from flint import arb, arb_poly, ctx

from driftproof.enclosure.arithmetic.clocks import Clock
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Overlapping, Refused, Value
from driftproof.enclosure.arithmetic.models import TaylorModel
from driftproof.enclosure.arithmetic.numbers import Enclosed, size
from driftproof.enclosure.fields.branches import Branching, on_all_branches
from driftproof.enclosure.fields.fields import RightHandSide, enclosed_rates
from driftproof.methods.numbers.flint_rationals import dyadic
from driftproof.symbolic.algebra.certified import enclose

# A step is searched for changes at so many places; one that is missed is only found by shorter steps.
SEARCHED = 16
# Rates are sought in balls wider by this part of them, first around those at the beginning, then around what is found
# there, as when the set reaches the other side of f; models have so many coefficients, of which a window needs two.
WIDENINGS, WIDER, LENGTH = 4, arb(2) ** -10, 4
# The set is followed for at most so many times, each four times as long as the one before; f has to be certain on a set
# so many times as wide as it is, since the first tube of a step is four times as wide in the norm of its weights.
FOLLOWED, CERTAIN = 10, 64
# A crossing takes no more than this part of the whole time: a wider window would not leave twelve digits.
WIDEST_WINDOW = Fraction(1, 2**50)
# The parts of the time to the crossing that a step leaves, the least first: near it, f's comparisons are nearly linear
# in time, so that a step can leave about the square of the time that is left.
LEFT = tuple(Fraction(1, 2**k) for k in (96, 48, 24, 12, 6, 3, 1))


class Crossing(Overlapping):
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


class _Watched(Evaluation):
    """A run that keeps the numbers of which f asks the sign or the floor; it is `refused` where f has no value."""

    def __init__(self, t: Fraction) -> None:
        super().__init__(span=(t, None))
        self.asked, self.refused = list[Value](), False

    def decide(self, greater: Value, less: Value, at_zero: bool = False) -> bool:
        """The outcome, by the sign of the difference."""
        self.asked.append(greater - less)
        return super().decide(greater, less, at_zero)

    def floor(self, x: Value) -> int:
        """The integer."""
        self.asked.append(x)
        return super().floor(x)

    def differs(self, decided: Sequence[int]) -> bool:
        """True if the outcomes are not those decided."""
        return self.refused or self.taken != decided

    def crossing(self, decided: Sequence[int], after: _Watched) -> Fraction | None:
        """The number here that has crossed 0 in the run after the change; None if that is not known."""
        first = next(
            (i for i, (x, y) in enumerate(zip(decided, after.taken, strict=False)) if x != y), len(after.taken)
        )
        if first >= min(len(self.asked), len(after.asked), len(decided)):
            return None
        x, there = self.asked[first], after.asked[first]
        if not all(isinstance(each, arb) and each.is_finite() for each in (x, there)):
            return None
        # Of a floor, the integer that is passed; where it is not decided, that which is near.
        passed = max(decided[first], *(after.taken[first:][:1] or [round(dyadic(there.mid()))]))
        return dyadic(x.mid()) - (0 if isinstance(decided[first], bool) else passed)


def first_change(
    f: RightHandSide, t: Fraction, rows: Sequence[Sequence[arb]], decided: Sequence[int], longest: Fraction
) -> Fraction | None:
    """About when f's comparisons along the polynomials in s are no longer those decided: a guess, and None if never."""
    polynomials, parts = [arb_poly(list(row)) for row in rows], 1 << int(ctx.prec)

    def seen(place: int) -> _Watched:
        s = longest * place / parts
        run, at = _Watched(t + s), enclose(s)
        try:
            state = [Enclosed(run, arb(p(at)).mid()) for p in polynomials]
            enclosed_rates(f, Clock(run, enclose(t + s)), state)
        except Refused:
            run.refused = True
        return run

    for a, b in pairwise(parts * k // SEARCHED for k in range(SEARCHED + 1)):
        if (after := seen(b)).differs(decided):
            return longest * _first_place(seen, decided, (a, seen(a)), (b, after)) / parts
    return None


def _first_place(
    seen: Callable[[int], _Watched], decided: Sequence[int], start: tuple[int, _Watched], end: tuple[int, _Watched]
) -> int:
    """The place behind which runs differ from what is decided, by the Illinois rule for the number that crosses 0.

    Where signs do not tell, and every fourth time, the places are halved.
    """
    (a, before), (b, after), weights, last = start, end, [Fraction(1), Fraction(1)], None
    for rounds in count():
        if b - a <= 1:
            break
        u, v = (run.crossing(decided, after) for run in (before, after))
        middle = (a + b) // 2
        if u is not None and v is not None and u * v <= 0 and u != v and rounds % 4 != 3:
            u, v = u * weights[0], v * weights[1]
            middle = min(max(b - round((b - a) * v / (v - u)), a + 1), b - 1)
        run = seen(middle)
        if changed := run.differs(decided):
            b, after = middle, run
        else:
            a, before = middle, run
        weights[changed] = Fraction(1)
        if changed == last:  # the end that stays counts for less
            weights[not changed] /= 2
        last = changed
    return b


def crossed(f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb], margin: arb | int = 0) -> Window | None:
    """A window that begins with [t, t + h], for solutions from the box; None if f is certain behind none.

    The set of solutions is as wide as the sides of f differ in the first h. It is followed, by times that grow, until f
    is certain on a set many times as wide as it and the margin together, as tubes are.
    """
    whole, end = list(box), t
    for k in range(FOLLOWED):
        length = h * 4**k
        try:
            found = _followed(f, end, length, box)
        except Refused:  # on the other side, too
            return None
        if found is None:
            return None
        during, box = found
        whole, end = [x.union(y) for x, y in zip(whole, during, strict=True)], end + length
        wide = CERTAIN * (size(x.rad() for x in box) + margin)
        if _is_certain(f, end, [x + arb(0, wide.upper()) for x in box]):
            return Window(t, end - t, tuple(whole), tuple(box))
    return None


def window_near(f: RightHandSide, t: Fraction, s: Fraction, box: Sequence[arb], widest: Fraction) -> Window | None:
    """A window from t for a change of f about the time s ahead, no longer than the `widest`; None if none is found."""
    first = Fraction(2) ** (s.numerator.bit_length() - s.denominator.bit_length())
    # Each is followed as far as the next but one.
    units = [*takewhile(lambda unit: unit < widest, (first * 4 ** (k * FOLLOWED // 2) for k in count()))]
    # The first tube of a step is wider than the set by so much, unless the weights say less.
    for margin, unit in product((arb(2) ** -ctx.prec, arb(0)), units):
        h = (t + 2 * unit) // unit * unit + unit - t  # so that the time behind it is short
        if (window := crossed(f, t, h, box, margin)) is not None:
            return window
    return None


def _followed(
    f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb]
) -> tuple[Sequence[arb], Sequence[arb]] | None:
    """Balls of the solutions from the box during [t, t + h], and at its end; None if no rates are found to hold theirs.

    While y(s) is in x + s R, y' is in the rates F there; if these lie in R, y is in x + s F and cannot leave. At the
    end y is x and the integral of the rates, too, which shows where a solution goes that is at rest on a kink.
    """
    length, (rates, _) = enclose(h), _rates_on_all_sides(f, t, h, box, [arb(0)] * len(box))
    for _ in range(WIDENINGS):
        wider = [rate + arb(0, (abs(rate) * WIDER + arb(2) ** -ctx.prec).upper()) for rate in rates]
        rates, means = _rates_on_all_sides(f, t, h, box, wider)
        if all(big.contains_interior(rate) for big, rate in zip(wider, rates, strict=True)):
            during = [x + rate * length * arb(0.5, 0.5) for x, rate in zip(box, rates, strict=True)]
            ends = [rate.intersection(mean) for rate, mean in zip(rates, means, strict=True)]
            return during, [x + end * length for x, end in zip(box, ends, strict=True)]
    return None


def _is_certain(f: RightHandSide, t: Fraction, box: Sequence[arb]) -> bool:
    evaluation = Evaluation(span=(t, None))
    try:
        enclosed_rates(f, Clock(evaluation, enclose(t)), [Enclosed(evaluation, x) for x in box])
    except Refused:
        return False
    return True


class _SomeSides(Branching):
    """A run whose comparisons that are not decided come out as told.

    With a constant not a x + c is compared but x, so that y - 1 > 0, y > 1 and -y < -1 are asked once.
    """

    def __init__(self, sides: Sequence[bool]) -> None:
        super().__init__(sides, forward=True)
        self.kept, self.lines = list[Value](), dict[int, tuple[Fraction, Value, Fraction]]()

    def made_of(self, made: Value, x: Value, y: Value, *, product: bool) -> None:
        """Keep factor, number and shift of what is made of a number and a constant."""
        if (constant := _constant(y)) is None:
            x, constant = y, _constant(x)
        if constant is not None and (constant or not product):
            a, root, c = self.lines.get(id(x), (Fraction(1), x, Fraction(0)))
            line = (a * constant, root, c * constant) if product else (a, root, c + constant)
            self.kept += [made, root]  # or other numbers might be put in their places
            self.lines[id(made)] = line

    def undecided(self, greater: Value, less: Value, at_zero: bool) -> bool:
        """The outcome of this run."""
        known, x = (limit, less) if (limit := _constant(greater)) is not None else (_constant(less), greater)
        a, root, c = self.lines.get(id(x), (Fraction(1), x, Fraction(0)))
        self.kept.append(root)
        if known is None:
            self.kept.append(less)
            return self.outcome(id(greater), id(less), at_zero)
        bound = (known - c) / a
        if (x is greater) == (a > 0):
            return self.outcome(id(root), ("constant", bound), at_zero)
        return self.outcome(("constant", bound), id(root), at_zero)

    def function(self, name: str, x: Value) -> Value:
        """The square root also of a number that may be 0, if it is not negative on this side. Raises Refused if it is.

        Where f has no value, or is not a number, it may be any other function.
        """
        if name == "sqrt" and isinstance(x, TaylorModel) and not x.range() > 0:
            if not self.undecided(x, arb(0), at_zero=True):
                raise Refused("f takes the root of a number that may be negative")
            return x.range().nonnegative_part().sqrt()
        return super().function(name, x)


def _constant(x: Value) -> Fraction | None:
    return dyadic(x) if isinstance(x, arb) and x.is_exact() else None


def _rates_on_all_sides(
    f: RightHandSide, t: Fraction, h: Fraction, box: Sequence[arb], rates: Sequence[arb]
) -> tuple[list[arb], list[arb]]:
    """Balls of f on all x + s R, x in the box and 0 <= s <= h, whatever the outcomes of comparisons not decided there.

    They are Taylor models in σ = s/h, so that a difference of two unknowns is as narrow as that of their rates. The
    second balls are of means over the time: at each, f is between the models of all outcomes.
    """
    length = enclose(h)
    along = [TaylorModel([x, rate * length], LENGTH) for x, rate in zip(box, rates, strict=True)]

    def run(sides: Sequence[bool]) -> tuple[tuple[list[arb], list[TaylorModel]], Branching]:
        evaluation = _SomeSides(sides)
        time = Clock(evaluation, TaylorModel([enclose(t), length], LENGTH))
        found = enclosed_rates(f, time, [Enclosed(evaluation, x) for x in along])
        models = [TaylorModel([arb(0)], LENGTH) + rate.value for rate in found]
        return ([x.range() for x in models], models), evaluation

    def either(_: Any, one: Any, other: Any) -> Any:
        pairs = zip(*((*each[0], *each[1]) for each in (one, other)), strict=True)
        joined = [x.union(y) for x, y in pairs]
        return joined[: len(box)], joined[len(box) :]

    found, models = on_all_branches(run, either)
    return found, [x.mean() for x in models]
