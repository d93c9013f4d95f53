"""One step of an enclosure: a Taylor polynomial, its defect, and how far the true solutions near it can be.

From a thin point y0 a polynomial p with thin coefficients is made. Its defect g = f(t, p) - p' is analytic on a disc
|s| <= R on which f(t0 + s, p(s)) evaluates finitely, so with its first K coefficients enclosed, the rest is at most
(s/R)^K times the largest size of g - (g_0 + ... + g_(K-1) s^(K-1)) on the disc, by the maximum principle. Gronwall's
inequality with the logarithmic norm μ of the Jacobian on a tube then bounds |y - p| by s δ exp(max(μ, 0) s); the tube
is checked to be wide enough for this after the fact, so that no a-priori box is needed. The variational equation, whose
solution carries along the errors made so far, is enclosed in the same way.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import frexp
from typing import Any

from flint import acb, acb_poly, arb, arb_mat, ctx

from driftproof.enclosure.fields import RightHandSide, enclosed_rates
from driftproof.enclosure.numbers import Enclosed, Evaluation, Refused, series
from driftproof.symbolic.algebra.certified import enclose

# R/h: each further coefficient makes the tail of the defect this much smaller; larger steps cost more coefficients.
DISC_PER_STEP = 8
# Coefficients of the variational equation, whose relative accuracy 8⁻¹¹ is ample: it multiplies what is tiny already.
VARIATIONAL_LENGTH = 12
# A step that fails is halved, at most so often: from any sensible first length to below 2⁻⁶⁰ of it.
MOST_HALVINGS = 60
# A step is halved until what it adds is this small, relative to the state and to the derivative of the flow: 2⁻¹⁶ of
# the latter lets a thousand steps widen what they carry by 1.6 %; the former is near what the bits give.
LOOSEST_FLOW = arb(2) ** -16
BITS_OF_A_STEP = Fraction(7, 8)
# A tube is tried at these multiples of the error that it must hold.
TUBES = (2, 4, 16, 256)

Rows = Sequence[Sequence[arb]]


@dataclass(frozen=True)
class Tube:
    """Solutions stay within `radius` of p over the step; `norm` is max(μ, 0) there."""

    radius: arb
    norm: arb

    def growth(self, s: arb) -> arb:
        """exp(max(μ, 0) s): how much a distance grows at most in the time s."""
        return (self.norm * s).exp()


@dataclass(frozen=True)
class EnclosedStep:
    """[t, t + h]: p as rows of ascending coefficients, the defect's bound δ, and the tube in which all this holds.

    `flow` encloses the derivative of the solution at t + h with respect to its start, for all starts in the tube.
    """

    t: Fraction
    h: Fraction
    polynomials: Rows
    defect: arb
    tube: Tube
    flow: arb_mat

    def at(self, s: Fraction) -> tuple[list[arb], arb]:
        """p(s), and how far the solution from the step's own start is from it at most, for 0 <= s <= h."""
        ball = enclose(s)
        return [horner(p, ball) for p in self.polynomials], ball * self.defect * self.tube.growth(ball)


def horner(coefficients: Sequence[arb], x: arb) -> arb:
    """The polynomial with ascending coefficients at x."""
    value = arb(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value


def size(values: Iterable[arb | acb]) -> arb:
    """The largest absolute value that any of the balls holds, as an exact number; 0 of none, NaN if any is NaN."""
    largest = arb(0)
    for x in values:
        largest = largest.max(arb(x.abs_upper()))  # Python's max would lose a NaN
    return largest


@dataclass(frozen=True)
class Disc:
    """The disc |s - centre| <= radius, on which polynomials are enclosed by their Taylor coefficients at the centre."""

    centre: acb
    radius: arb

    @property
    def ball(self) -> acb:
        """A square that contains the disc."""
        wide = arb(0, self.radius)
        return self.centre + acb(wide, wide)

    def values(self, coefficients: Sequence[arb]) -> acb:
        """A square that contains the polynomial's values on the disc."""
        around: Sequence[Any] = coefficients
        if not self.centre.is_zero():
            around = acb_poly(list(coefficients))(acb_poly([self.centre, 1])).coeffs() or [acb(0)]
        reach = arb(0)
        for c in reversed(around[1:]):
            reach = (reach + arb(c.abs_upper())) * self.radius
        wide = arb(0, reach.upper())
        return acb(around[0]) + acb(wide, wide)


def whole_disc(radius: Fraction) -> list[Disc]:
    """|s| <= radius in one piece."""
    return [Disc(acb(0), enclose(radius))]


def covered_disc(radius: Fraction) -> list[Disc]:
    """Eight discs that cover the upper half of |s| <= radius; f is real on reals, so the lower half has the conjugates.

    They stand around the squares of side radius/2 that do, the polynomials' values wrapping far less in each.
    """
    quarter = enclose(radius / 4)
    around = arb((quarter * arb(2).sqrt()).upper())
    return [Disc(acb(i * quarter, j * quarter), around) for i in (-3, -1, 1, 3) for j in (1, 3)]


# Ways to cover a disc, the cheapest first.
COVERS = (whole_disc, covered_disc)


def decisions(f: RightHandSide, t: Fraction, y: Sequence[arb], seen: set[float]) -> list[bool]:
    """Which branches f takes at a point; the doubles that it reads are added to `seen`."""
    evaluation = Evaluation(doubles=seen)
    rates = enclosed_rates(f, Enclosed(evaluation, enclose(t)), [Enclosed(evaluation, x) for x in y])
    if not all(rate.value.is_finite() for rate in rates):
        raise Refused(f"f is not finite at t = {float(t):.6g}")
    return evaluation.taken


class Expansion:
    """The solution from a thin point, expanded; and steps of any length made of it."""

    def __init__(self, f: RightHandSide, t: Fraction, y: Sequence[arb], length: int, decided: Sequence[bool]) -> None:
        """Coefficients of p up to s^length, thin, each from those before it."""
        self.f, self.t, self.length, self.decided = f, t, length, decided
        self.rows = [[x] for x in y]
        for k in range(1, length + 1):
            for row, rate in zip(self.rows, self._on_series(self.rows, k), strict=True):
                row.append((_coefficient(rate.value, k - 1) / k).mid())
        slopes = [_derivative(row) for row in self.rows]
        rates = [_coefficients(rate.value, length) for rate in self._on_series(self.rows, length)]
        self._defect_known = [_minus(rate, slope) for rate, slope in zip(rates, slopes, strict=True)]
        # p' and what is known of the defect are taken off f(t, p) as one polynomial: few operations on boxes.
        self._defect_taken = rates

    def step(self, longest: Fraction, spread: arb) -> EnclosedStep:
        """A step of `longest` at most that holds for every start within `spread` of the point.

        Raises Refused where no disc is found on which f evaluates finitely, or no tube.
        """
        h = min(longest, self._first_length())
        reason = "a pole is ahead, or f is not smooth there"
        for _ in range(MOST_HALVINGS):
            for cover in COVERS:
                try:
                    if (made := self._attempt(h, cover(DISC_PER_STEP * h), spread)) is not None:
                        return made
                except Refused as refusal:
                    reason = str(refusal)
            h /= 2
        raise Refused(f"no step from t = {float(self.t):.9g} is found, however small: {reason}", self.t)

    def _first_length(self) -> Fraction:
        """A power of two, below 4/3 of the radius that the last coefficients show, over DISC_PER_STEP."""
        radii = [1e12]
        for row in self.rows:
            first = max(float(row[0].abs_upper()), 2.0**-20)
            sizes = [(k, float(row[k].abs_upper())) for k in (self.length - 1, self.length)]
            radii += [(first / c) ** (1 / k) for k, c in sizes if c > 0]
        return Fraction(2) ** (frexp(min(radii) / DISC_PER_STEP * 4 / 3)[1] - 1)

    def _attempt(self, h: Fraction, pieces: Sequence[Disc], spread: arb) -> EnclosedStep | None:
        step = enclose(h)
        defect = self._defect(step, pieces)
        if defect is None or not step * defect < self._scale() * arb(2) ** -int(BITS_OF_A_STEP * ctx.prec):
            return None
        tube = self._tube(h, arb((spread + step * defect).upper()))
        flow = None if tube is None else self._flow(step, pieces, tube)
        if tube is None or flow is None or not all(x.is_finite() for x in flow.entries()):
            return None
        if size(x.rad() for x in flow.entries()) > LOOSEST_FLOW * size(flow.entries()):
            return None
        return EnclosedStep(self.t, h, self.rows, defect, tube, flow)

    def _scale(self) -> arb:
        return size(row[0] for row in self.rows).max(arb(1))

    def _time(self, evaluation: Evaluation, s: Any) -> Enclosed:
        return Enclosed(evaluation, enclose(self.t) + s)

    def _on_series(self, rows: Rows, length: int, *, jacobian: bool = False) -> Any:
        cap, ctx.cap = ctx.cap, length
        try:
            evaluation = Evaluation(self.decided)
            time = series(evaluation, [enclose(self.t), arb(1)], length)
            state = [series(evaluation, row, length) for row in rows]
            return (
                jacobian_of(self.f, time, [x.value for x in state]) if jacobian else enclosed_rates(self.f, time, state)
            )
        finally:
            ctx.cap = cap

    def _defect(self, step: arb, pieces: Sequence[Disc]) -> arb | None:
        """An upper bound of |f(t + s, p(s)) - p'(s)| for 0 <= s <= h, or None where f is not finite on the disc."""
        largest = arb(0)
        for piece in pieces:
            evaluation = Evaluation(self.decided)
            state = [Enclosed(evaluation, piece.values(row)) for row in self.rows]
            rates = enclosed_rates(self.f, self._time(evaluation, piece.ball), state)
            whole = [acb(rate.value) - piece.values(part) for rate, part in zip(rates, self._defect_taken, strict=True)]
            if not all(x.is_finite() for x in whole):
                return None
            largest = largest.max(size(whole))
        tail = largest * arb(DISC_PER_STEP) ** -self.length
        return size(_bound(part, step) + tail for part in self._defect_known)

    def _tube(self, h: Fraction, error: arb) -> Tube | None:
        """A tube that no solution starting near enough can leave: its radius exceeds error exp(max(μ, 0) h).

        f decides its comparisons here on the whole tube; they have to be those that every other evaluation follows.
        """
        middle = enclose(h / 2)
        span = arb(middle, middle)
        path = [horner(row, span) for row in self.rows]
        for multiple in TUBES:
            radius = arb((multiple * error + arb(2) ** -ctx.prec).upper())
            evaluation = Evaluation()
            norm = self._norm(self._time(evaluation, span), [x + arb(0, radius) for x in path])
            if evaluation.taken != list(self.decided):
                raise Refused("f takes another branch within the step")
            if not norm.is_finite():
                return None
            tube = Tube(radius, norm)
            if tube.growth(enclose(h)) * error < radius:
                return tube
        return None

    def _norm(self, time: Enclosed, box: Sequence[arb]) -> arb:
        """The larger of 0 and the logarithmic norm of the Jacobian on the box; NaN where f is not finite there."""
        rates = _with_partials(self.f, time, box)
        if not all(rate.value.is_finite() for rate in rates):
            return arb("nan")
        return _logarithmic_norm([_partials(rate, len(box)) for rate in rates])

    def _flow(self, step: arb, pieces: Sequence[Disc], tube: Tube) -> arb_mat | None:
        """The derivative of y(t + h) with respect to its start, for all starts in the tube: P(h), and Gronwall.

        P has thin coefficients; its defect J(t + s, p(s) + b) P(s) - P'(s) is analytic in s for each b in the tube.
        """
        n, length, wide = len(self.rows), VARIATIONAL_LENGTH, arb(0, tube.radius)
        jacobian = self._on_series([[row[0] + wide, *row[1:]] for row in self.rows], length, jacobian=True)
        J = [arb_mat([[_coefficient(x, k) for x in row] for row in jacobian]) for k in range(length)]
        P, known, taken = [arb_mat([[int(i == j) for j in range(n)] for i in range(n)])], [], []
        for k in range(length - 1):
            product = sum((J[i] * P[k - i] for i in range(1, k + 1)), J[0] * P[k])
            P.append(arb_mat([[(x / (k + 1)).mid() for x in row] for row in product.tolist()]))
            taken.append(product)
            known.append(product - (k + 1) * P[-1])
        places = [(i, j) for i in range(n) for j in range(n)]
        polynomials = {place: [m[place] for m in P] for place in places}
        totals = {place: [m[place] for m in taken] for place in places}
        largest = [arb(0)] * n
        for piece in pieces:
            time = self._time(Evaluation(self.decided), piece.ball)
            on_piece = jacobian_of(self.f, time, [piece.values(row) + wide for row in self.rows])
            values = {place: piece.values(p) for place, p in polynomials.items()}
            for i in range(n):
                row = [
                    sum((on_piece[i][k] * values[k, j] for k in range(n)), acb(0)) - piece.values(totals[i, j])
                    for j in range(n)
                ]
                if not all(x.is_finite() for x in row):
                    return None
                largest[i] = largest[i].max(sum((arb(x.abs_upper()) for x in row), arb(0)))
        tail = arb(DISC_PER_STEP) ** (1 - length)
        sums = [sum((_bound([m[i, j] for m in known], step) for j in range(n)), arb(0)) for i in range(n)]
        bounds = [each + most * tail for each, most in zip(sums, largest, strict=True)]
        error = arb(0, (step * size(bounds) * tube.growth(step)).upper())
        return arb_mat([[horner(polynomials[i, j], step) + error for j in range(n)] for i in range(n)])


def _coefficient(value: Any, k: int) -> arb:
    """Coefficient k of a series; a constant has one."""
    if isinstance(value, int | arb):
        return arb(value) if k == 0 else arb(0)
    return arb(value[k])


def _coefficients(value: Any, length: int) -> list[arb]:
    return [_coefficient(value, k) for k in range(length)]


def _derivative(coefficients: Sequence[arb]) -> list[arb]:
    return [k * c for k, c in enumerate(coefficients)][1:]


def _minus(first: Sequence[arb], second: Sequence[arb]) -> list[arb]:
    return [a - b for a, b in zip(first, second, strict=True)]


def _bound(coefficients: Sequence[arb], step: arb) -> arb:
    """What the polynomial's size is at most for 0 <= s <= step."""
    return horner([abs(c) for c in coefficients], step)


def _with_partials(f: RightHandSide, time: Enclosed, y: Sequence[Any]) -> list[Enclosed]:
    n = len(y)
    state = [Enclosed(time.evaluation, value, tuple(arb(int(i == j)) for j in range(n))) for i, value in enumerate(y)]
    return enclosed_rates(f, time, state)


def _partials(rate: Enclosed, n: int) -> list[Any]:
    return list(rate.partials or [arb(0)] * n)


def jacobian_of(f: RightHandSide, time: Enclosed, y: Sequence[Any]) -> list[list[Any]]:
    """∂f/∂y by rows, in the arithmetic of y."""
    return [_partials(rate, len(y)) for rate in _with_partials(f, time, y)]


def _logarithmic_norm(jacobian: Sequence[Sequence[arb]]) -> arb:
    """The larger of 0 and the logarithmic maximum norm, max over i of J_ii + Σ over j != i of |J_ij|, rounded up."""
    norm = arb(0)
    for i, row in enumerate(jacobian):
        total = row[i] + sum((abs(x) for j, x in enumerate(row) if j != i), arb(0))
        if not total.is_finite():
            return arb("nan")
        norm = norm.max(arb(total.upper()))
    return norm
