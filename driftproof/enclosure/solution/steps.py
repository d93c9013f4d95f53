"""One step of an enclosure: a Taylor polynomial, its defect, and how far the true solutions near it can be.

From a thin point y0, balls of radius 0, a polynomial p with thin coefficients is made, in σ = s/h. Its defect
g = f(t0 + hσ, p) - p'/h is evaluated as a Taylor model, whose norm δ bounds |g| on the step. Gronwall's inequality with
the logarithmic norm μ of the Jacobian on a tube then bounds |y - p| by s δ exp(max(μ, 0) s). That the tube is wide
enough for this is checked afterwards, so that no a-priori box is needed. The variational equation, whose solution
carries along the errors made so far, is enclosed in the same way. Norms are max |e_i|/d_i with weights d, so that the μ
of a spring q'' = -ω² q is ω, not ω².
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from operator import add
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from flint import arb, arb_mat, arb_poly, ctx

from driftproof.enclosure.arithmetic.clocks import Clock, TimeCut
from driftproof.enclosure.arithmetic.double_balls import DoubleBalls, convolved, derivative, norm_of, value_at_one
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Overlapping, Refused, Replay
from driftproof.enclosure.arithmetic.models import TaylorModel
from driftproof.enclosure.arithmetic.numbers import Enclosed, series, size
from driftproof.enclosure.fields.fields import NO_SLOPE, RightHandSide, enclosed_rates, linearised, require_the_same
from driftproof.enclosure.solution.crossings import LEFT, Crossing, first_change
from driftproof.symbolic.algebra.certified import enclose

# Coefficients for the variational equation. A relative accuracy of some 2⁻³⁰ is ample: it multiplies tiny errors.
VARIATIONAL_LENGTH = 24
# A step that fails is shortened by this factor, in 128 bits at most this often: to below 2⁻⁶⁰ of its first length. In
# more bits that is in proportion, since a solution at rest on a kink leaves it by steps from some 2^(-bits/2) on.
SHORTER, MOST_SHORTENINGS = Fraction(5, 8), 90
# Weights that let the tube of a step grow by less than exp of this are as good as any.
UNGROWN = arb(2) ** -8
# A step is shortened until its errors are this small. The first bound is relative to the derivative of the flow: with
# 2⁻¹⁶, a thousand steps widen what they carry by 1.6 %. The second, relative to the state, is near what the bits give.
LOOSEST_FLOW = arb(2) ** -16
BITS_OF_A_STEP = Fraction(7, 8)
# Steps that are shorter than this part of the time gone by mean a pole; this is seen before 128 bits are used up.
SHORTEST_PART = Fraction(1, 2**40)
# The first tube is four times as wide as the error that it must contain, the next twice what the first shows is needed.
FIRST_TUBE, WIDEST_TUBE = 4, arb(2) ** 12
# Sweeps to balance the weights. A few suffice even for the first step; others begin with the weights of the one before.
SWEEPS = 2
_EFFORT = ContextVar("part of the steps that are allowed", default=1.0)

# The weights d of the norm |e| = max |e_i|/d_i, each a power of two.
Weights: TypeAlias = Sequence[arb]


@dataclass(frozen=True)
class Tube:
    """Solutions stay within `radius` of p over the step, in the weighted norm; `norm` is max(μ, 0) there."""

    radius: arb
    norm: arb

    def growth(self, s: arb) -> arb:
        """exp(max(μ, 0) s), a bound of the growth of a distance in the time s."""
        return (self.norm * s).exp()


@dataclass(frozen=True)
class EnclosedStep:
    """An enclosed step on [t, t + h]: p in σ = s/h, a bound δ of its defect, and a tube that contains the solutions.

    Starts are within `spread` of p(0). `flow` encloses the derivative of the solution at t + h with respect to its
    start, for all starts in the tube. `next_weights` would have suited this step best and serve the next one.
    """

    t: Fraction
    h: Fraction
    polynomials: Sequence[arb_poly]
    spread: arb
    defect: arb
    tube: Tube
    flow: arb_mat
    weights: Weights
    next_weights: Weights

    def at(self, s: Fraction) -> tuple[list[arb], arb]:
        """p(s), and a bound of its distance to the solution that starts at p(0), for 0 <= s <= h."""
        ball = enclose(s)
        return [arb(p(enclose(s / self.h))) for p in self.polynomials], ball * self.defect * self.tube.growth(ball)

    def state_at(self, t: Fraction) -> tuple[arb, ...]:
        """Balls of all solutions at a time t of the step."""
        values, near = self.at(t - self.t)
        reach = near + self.spread * self.tube.growth(enclose(t - self.t))
        return tuple(map(add, values, self.around(reach)))

    def around(self, distance: arb) -> list[arb]:
        """Balls around 0, one for each component, of everything within the distance."""
        return [arb(0, (distance * d).upper()) for d in self.weights]


class DensePiece(NamedTuple):
    """The polynomials of a step on [t, t + h] in σ, which is `low` at its begin and 1 at its end.

    They are as near to the solution as its balls are small.
    """

    t: Fraction
    h: Fraction
    low: int
    polynomials: Sequence[arb_poly]


def fewer_steps(most: int, components: int) -> int:
    """The number of steps that takes about as much time as `most` steps of 128 bits and twelve components."""
    return int(most * _EFFORT.get() * min(1, 128 / ctx.prec) * min(1, (12 / components) ** 2))


@contextmanager
def with_effort(part: float) -> Iterator[None]:
    """Refuse a solution that takes more than this part of the steps allowed: for values that nobody asked for."""
    before = _EFFORT.set(part)
    try:
        yield
    finally:
        _EFFORT.reset(before)


class Expansion:
    """The Taylor expansion of the solution from a thin point, from which steps of any length are made."""

    def __init__(
        self,
        f: RightHandSide,
        t: Fraction,
        y: Sequence[arb],
        length: int,
        decided: Sequence[int],
        weights: Weights,
        coupled: float | None = None,
    ) -> None:
        """Compute `length` thin coefficients of p in s. All bounds hold whatever the weights are.

        A rate is said to depend on so many components that are `coupled` with it, in the mean; by default on all.
        """
        self.f, self.t, self.length, self.decided, self.weights = f, t, length, decided, weights
        self.cut = self.jumped = False
        self.rows, slopes, known, self.affine = [[x] for x in y], list[arb_mat](), 1, False
        most = _slopes_that_pay(len(y) if coupled is None else coupled, length)
        while known < length:
            reach = length if self.affine else min(length, known + min(known, most) + 1)
            slopes, known = self._extend(known, reach, slopes)

    def step(self, longest: Fraction, errors: Sequence[arb], nearest: Fraction = Fraction(0)) -> EnclosedStep:
        """A step of at most the length `longest`, valid for every start that differs from the point by the errors.

        `jumped` says afterwards whether f changes at its end, and `cut` whether there or just behind. Raises Refused if
        no disc on which f is analytic is found, or no tube, and Crossing where f changes nearer than `nearest` and
        cannot be approached.
        """
        h, spread, cut = min(longest, self._first_length()), self._size(errors), None
        change: Fraction | None = None
        before_it: Iterator[Fraction] = iter(())
        reason = "f or the solution has a pole ahead, or f is not smooth there"
        for _ in range(MOST_SHORTENINGS * max(ctx.prec, 128) // 128):
            try:
                if (made := self._attempt(h, spread)) is not None:
                    self.jumped = h == cut
                    self.cut = self.jumped or change is not None
                    self._require_the_same()
                    return made
            except TimeCut as found:
                h = cut = found.at - self.t
                continue
            except Refused as refusal:
                reason = str(refusal)
                if isinstance(refusal, Overlapping) and change is None:
                    change = first_change(self.f, self.t, self.rows, self.decided, h)
                    before_it = iter([] if change is None else [change * (1 - left) for left in LEFT])
            if change is None:
                h *= SHORTER
            elif (nearer := next(before_it, None)) is not None:
                h = nearer
            elif change < nearest:
                self._require_the_same()
                raise Crossing(reason, change)
            else:
                h, change = change / 4, None
        self._require_the_same()
        raise Refused(f"no step from t = {float(self.t):.9g}, however short, could be proved: {reason}", self.t)

    def _require_the_same(self) -> None:
        require_the_same(self.f, self.t, [row[0] for row in self.rows], [row[1] for row in self.rows])

    def _size(self, values: Iterable[arb]) -> arb:
        """The weighted norm."""
        return size(x / d for x, d in zip(values, self.weights, strict=True))

    def _tolerance(self) -> arb:
        return self._size(abs(row[0]).max(arb(1)) for row in self.rows) * arb(2) ** -int(BITS_OF_A_STEP * ctx.prec)

    def _first_length(self) -> Fraction:
        """The length, to eight bits, at which the last terms are below the tolerance; most steps keep it."""
        logarithms, wanted = [40.0], self._tolerance() / 8
        for k in (self.length - 2, self.length - 1):
            most = self._size(row[k] for row in self.rows)
            if most > 0:
                logarithms.append(float((wanted / most).log() / arb(2).log()) / k)
        exponent, part = divmod(min(logarithms), 1)
        return int(2**part * 256) * Fraction(2) ** int(exponent - 8)

    def _attempt(self, h: Fraction, spread: arb) -> EnclosedStep | None:
        step = enclose(h)
        powers = [arb(1)]
        for _ in range(1, self.length):
            powers.append(powers[-1] * step)
        polynomials = [arb_poly([(c * x).mid() for c, x in zip(row, powers, strict=True)]) for row in self.rows]
        defect = self._defect(h, polynomials)
        if not step * defect < self._tolerance():
            return None
        error = arb((spread + step * defect).upper())
        multiple = arb(FIRST_TUBE)
        while multiple < WIDEST_TUBE:
            radius = arb((multiple * error + arb(2) ** -ctx.prec).upper())
            jacobian = self._jacobian(h, polynomials, radius)
            ranges = [[x if isinstance(x, arb) else x.range() for x in row] for row in jacobian]
            tube = Tube(radius, _logarithmic_norm(ranges))
            if tube.growth(step) * error < radius:
                if (flow := _flow(jacobian, step, tube)) is None:
                    return None
                flow = arb_mat(self._scaled(flow.tolist(), -1))
                grown = tube.norm * step > UNGROWN
                after = balanced(ranges, self.weights) if grown else self.weights
                return EnclosedStep(self.t, h, polynomials, spread, defect, tube, flow, self.weights, after)
            multiple = arb((2 * multiple.max(tube.growth(step))).upper())
        return None

    def _extend(self, known: int, length: int, slopes: list[arb_mat]) -> tuple[list[arb_mat], int]:
        """Extend p from `known` to `length` coefficients; the coefficients of ∂f/∂y are `slopes` if these suffice.

        With k coefficients known, e = y - p = O(s^k) has e' = f(p) - p' + ∂f/∂y e + O(s^2k) (Newton's method). If
        ∂f/∂y is constant, nothing is left out, and the first coefficient serves for all.
        """
        wanted = 1 if self.affine else min(known, length - known - 1)
        rates, partials = self._on_series(length - 1, slopes=len(slopes) < wanted)
        if len(slopes) < wanted:
            self.affine = all(isinstance(x, arb) for row in partials for x in row)
            wanted = 1 if self.affine else wanted
            slopes = [arb_mat(len(rates), len(rates)) for _ in range(wanted)]
            for i, j, x in _entries(partials):
                for k, J in enumerate(slopes):
                    J[i, j] = _coefficient(x, k).mid()
        found: list[arb_mat] = []
        for k in range(known, length):
            left = arb_mat([[_coefficient(rate, k - 1)] for rate in rates])
            left = sum((J * e for J, e in zip(slopes, reversed(found), strict=False)), left)
            found.append((left * (1 / arb(k))).mid())
        for row, *more in zip(self.rows, *(e.entries() for e in found), strict=True):
            row += more
        return slopes, length

    def _on_series(self, length: int, *, slopes: bool) -> tuple[list[Any], list[list[Any]]]:
        cap, ctx.cap = ctx.cap, length
        try:
            evaluation = Replay(outcomes=self.decided, span=(self.t, None))
            time, *state = (series(evaluation, row, length).value for row in ([enclose(self.t), arb(1)], *self.rows))
            return linearised(self.f, Clock(evaluation, time), state, slopes=slopes)
        finally:
            ctx.cap = cap

    def _time(self, h: Fraction, length: int) -> Clock:
        return Clock(
            Evaluation(span=(self.t, self.t + h), forward=True), TaylorModel([enclose(self.t), enclose(h)], length)
        )

    def _defect(self, h: Fraction, polynomials: Sequence[arb_poly]) -> arb:
        """An upper bound of |f(t + s, p(s)) - p'(s)| for 0 <= s <= h."""
        time, length = self._time(h, self.length), self.length
        state = [Enclosed(time.evaluation, TaylorModel(p, length)) for p in polynomials]
        rates = enclosed_rates(self.f, time, state)
        slopes = [TaylorModel(p.derivative() * (1 / enclose(h)), length) for p in polynomials]
        return self._size((rate.value - slope).norm for rate, slope in zip(rates, slopes, strict=True))

    def _jacobian(self, h: Fraction, polynomials: Sequence[arb_poly], radius: arb) -> list[list[Any]]:
        """∂f/∂y along p + b for every constant b in the tube, in units of the weights; b may be the error at any time.

        f decides its comparisons here on the whole tube, and so as it did on p, which is part of it.
        """
        length = VARIATIONAL_LENGTH
        box = [
            TaylorModel(p, length) + arb(0, (radius * d).upper())
            for p, d in zip(polynomials, self.weights, strict=True)
        ]
        return self._scaled(linearised(self.f, self._time(h, length), box)[1], 1)

    def _scaled(self, rows: list[list[Any]], power: int) -> list[list[Any]]:
        """The matrix with entry (i, j) times (d_j/d_i)^power; this is exact, as the weights are powers of two."""
        d = self.weights
        return [
            [x * (d[j] / d[i]) ** power if x is not NO_SLOPE and d[i] != d[j] else x for j, x in enumerate(row)]
            for i, row in enumerate(rows)
        ]


def _flow(jacobian: Sequence[Sequence[Any]], step: arb, tube: Tube) -> arb_mat | None:
    """The derivative of y(t + h) with respect to its start, for all starts in the tube; None if it is not sharp.

    P, in doubles, nearly solves P' = hJP in σ. Gronwall's inequality turns the norm of its defect hJP - P',
    which has tiny low coefficients, products beyond the length and J's tail, into a bound of the error.
    """
    n, length = len(jacobian), VARIATIONAL_LENGTH
    entries, J = _entries(jacobian), DoubleBalls(np.zeros((length, n, n)), np.zeros((length, n, n)))
    parts = DoubleBalls.of(
        (_coefficient(x, k) * step for *_, x in entries for k in range(length)), len(entries), length
    )
    for whole, part in zip(J, parts, strict=True):
        whole[:, [i for i, *_ in entries], [j for _, j, _ in entries]] = part.T
    tail = step * size(sum((x.tail for x in row if isinstance(x, TaylorModel)), arb(0)) for row in jacobian)
    P = np.zeros((length, n, n))
    P[0] = np.eye(n)
    for k in range(length - 1):
        P[k + 1] = (J.mid[: k + 1] @ P[k::-1]).sum(axis=0) / (k + 1)
    defect = norm_of(convolved(J, P).less(derivative(P)).sizes()) + tail * norm_of(np.abs(P))
    error, found = (defect * tube.growth(step)).upper(), value_at_one(P)
    if not error < LOOSEST_FLOW * size(found.entries()):
        return None
    return found + arb_mat([[arb(0, error)] * n] * n)


def _slopes_that_pay(coupled: float, length: int) -> int:
    """The number of coefficients of ∂f/∂y with which p costs the fewest runs of f, one with gradients costing 1 + n.

    With m = 2^i - 1 of them, i runs with gradients give 2m + 1 coefficients of p, and each further run m + 1 more.
    """
    sizes = [(i, 1 << i) for i in range(length.bit_length())]
    runs = {size - 1: i * (1 + coupled) + (length - 2 * size + 1) / size for i, size in sizes}
    return min(runs, key=runs.__getitem__)


def _entries(rows: Sequence[Sequence[Any]]) -> list[tuple[int, int, Any]]:
    """Row, column and value of the entries that are not NO_SLOPE."""
    return [(i, j, x) for i, row in enumerate(rows) for j, x in enumerate(row) if x is not NO_SLOPE]


def _coefficient(value: Any, k: int) -> arb:
    """Coefficient k of a series or a model, or of a constant."""
    if isinstance(value, arb):
        return value if k == 0 else NO_SLOPE
    return value.coefficient(k) if isinstance(value, TaylorModel) else arb(value[k])


def balanced(jacobian: Sequence[Sequence[arb]], before: Weights) -> Weights:
    """The weights, powers of two, for which each row of the Jacobian, given in units of `before`, balances its column.

    They come from Osborne's sweeps (osborne-1960); a component coupled in one direction only keeps its weight.
    """
    sizes = np.array([[float(x.abs_upper()) for x in row] for row in jacobian])
    np.fill_diagonal(sizes, 0)
    exponents = np.zeros(len(sizes), dtype=int)
    for i in [*range(len(sizes))] * SWEEPS:
        row, column = sizes[i].sum(), sizes[:, i].sum()
        if 0 < row < np.inf and 0 < column < np.inf:
            change = int(np.rint(np.log2(row / column) / 2))
            exponents[i] += change
            sizes[i] *= 2.0**-change
            sizes[:, i] *= 2.0**change
    return [d * arb(2) ** int(k) for d, k in zip(before, exponents, strict=True)]


def _logarithmic_norm(jacobian: Sequence[Sequence[arb]]) -> arb:
    """The larger of 0 and the logarithmic maximum norm, max over i of J_ii + Σ over j != i of |J_ij|, rounded up."""
    norm = arb(0)
    for i, row in enumerate(jacobian):
        total = row[i] + sum((abs(x) for j, x in enumerate(row) if j != i), arb(0))
        norm = norm.max(arb(total.upper()))
    return norm
