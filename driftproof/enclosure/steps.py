"""One step of an enclosure: a Taylor polynomial, its defect, and how far the true solutions near it can be.

From a thin point y0 a polynomial p with thin coefficients is made. Its defect g = f(t, p) - p' is analytic on a disc
|s| <= R on which f(t0 + s, p(s)) evaluates finitely, so with its first K coefficients enclosed, the rest is at most
(s/R)^K times the largest size of g - (g_0 + ... + g_(K-1) s^(K-1)) on the disc, by the maximum principle. Gronwall's
inequality with the logarithmic norm μ of the Jacobian on a tube then bounds |y - p| by s δ exp(max(μ, 0) s); the tube is
checked to be wide enough for this after the fact. No a-priori box is needed (makino-berz-2003 use one; neumaier-1994).
The variational equation, whose solution carries the errors made so far along, is enclosed in the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, acb_poly, arb, arb_mat, ctx

from driftproof.enclosure.fields import RightHandSide, evaluate
from driftproof.enclosure.numbers import Enclosed, Evaluation, Refused, exact_ball, series

# R/h: each further coefficient makes the tail of the defect this much smaller; larger steps cost more coefficients.
DISC_PER_STEP = 8
# Coefficients of the variational equation, whose relative accuracy 8⁻¹² is ample: it multiplies what is tiny already.
VARIATIONAL_LENGTH = 12
# Tried disc radii fall by this factor until f evaluates finitely, at most so often.
SHRINK, MOST_SHRINKS = Fraction(1, 2), 60
# A step is halved until what it adds is this small, relative to the state and to the derivative of the flow: 2⁻¹⁶ of the
# latter lets a thousand steps widen what they carry by 1.6 %; the former is near what the bits give.
LOOSEST_FLOW = arb(2) ** -16
LOOSEST_STEP = Fraction(7, 8)
# A tube is tried at so many multiples of the error it must hold, from the smallest.
TUBES = (2, 4, 16, 256)


class Tube(NamedTuple):
    """On the box around p over the whole step: the radius, and exp(max(μ, 0) s) at s = h."""

    radius: arb
    growth: Callable[[arb], arb]


@dataclass(frozen=True)
class Step:
    """[t0, t0 + h]: p as rows of ascending coefficients, the defect's bound δ, and the tube in which all this holds.

    `flow` encloses the derivative of the solution at t0 + h with respect to its start, over all starts in the tube.
    """

    t: Fraction
    h: Fraction
    polynomials: tuple[tuple[arb, ...], ...]
    defect: arb
    tube: Tube
    flow: arb_mat

    def at(self, s: Fraction) -> tuple[list[arb], arb]:
        """p(s), and how far the solution from y0 is from it at most, for 0 <= s <= h."""
        ball = exact_ball(s)
        return [horner(p, ball) for p in self.polynomials], ball * self.defect * self.tube.growth(ball)


def horner(coefficients: Sequence[arb], x: Any) -> Any:
    """The polynomial at x, a real or a complex ball."""
    value = 0 * x
    for c in reversed(coefficients):
        value = value * x + c
    return value


def size(values: Iterable[arb | acb]) -> arb:
    """The largest absolute value that any of the balls holds, as an exact number."""
    return max((arb(abs(x).upper()) if isinstance(x, arb) else arb(x.abs_upper()) for x in values), default=arb(0))


def taylor(f: RightHandSide, t: Fraction, y: Sequence[arb], length: int, decided: Sequence[bool]) -> list[list[arb]]:
    """The coefficients of the solution from (t, y), thin: those below `length`, each from those before it."""
    rows = [[x] for x in y]
    for k in range(1, length):
        rates = _on_series(f, t, rows, k, decided)
        for row, rate in zip(rows, rates, strict=True):
            row.append((_coefficient(rate.value, k - 1) / k).mid())
    return rows


def _on_series(
    f: RightHandSide, t: Fraction, rows: Sequence[Sequence[arb]], length: int, decided: Sequence[bool]
) -> list[Enclosed]:
    cap, ctx.cap = ctx.cap, length
    try:
        evaluation = Evaluation(decided)
        time = series(evaluation, [exact_ball(t), arb(1)], length)
        return evaluate(f, time, [series(evaluation, row, length) for row in rows])
    finally:
        ctx.cap = cap


def _coefficient(value: object, k: int) -> arb:
    """Coefficient k of a series; a constant has one."""
    if isinstance(value, arb):
        return value if k == 0 else arb(0)
    return value[k]  # type: ignore[index]


def decisions(f: RightHandSide, t: Fraction, y: Sequence[arb], seen: set[float]) -> list[bool]:
    """Which branches f takes at a point; the doubles that it reads are added to `seen`."""
    evaluation = Evaluation(doubles=seen)
    evaluate(f, Enclosed(evaluation, exact_ball(t)), [Enclosed(evaluation, x) for x in y])
    return evaluation.taken


def make_step(
    f: RightHandSide, t: Fraction, y: Sequence[arb], spread: arb, length: int, longest: Fraction, decided: Sequence[bool]
) -> Step:
    """A step from the thin point y at t, which holds for every start within `spread` of it, of `longest` at most.

    Raises Refused where no disc is found on which f evaluates finitely, or no tube.
    """
    rows = taylor(f, t, y, length + 1, decided)
    h = min(longest, _first_length(rows, length))
    for _ in range(MOST_SHRINKS):
        for cover in COVERS:
            made = _attempt(f, t, rows, spread, h, cover, decided)
            if made is not None:
                return made
        h *= SHRINK
    raise Refused(f"at t = {float(t):.6g} no step is found, however small: the solution may not be smooth there")


def _first_length(rows: Sequence[Sequence[arb]], length: int) -> Fraction:
    """A power of two near a third of the radius of convergence, as the last coefficients show it, over DISC_PER_STEP."""
    largest = 2.0 ** 40
    radii = [largest]
    for k in (length - 1, length):
        for row in rows:
            if (c := float(abs(row[k]).upper())) > 0:
                first = max(float(abs(row[0]).upper()), 1e-3)
                radii.append((first / c) ** (1 / k))
    exponent = _floor_log2(min(radii) / (3 * DISC_PER_STEP) * 4)
    return Fraction(2) ** exponent


def _floor_log2(x: float) -> int:
    import math

    return math.frexp(x)[1] - 1


def _attempt(
    f: RightHandSide,
    t: Fraction,
    rows: list[list[arb]],
    spread: arb,
    h: Fraction,
    cover: Callable[[Fraction], list[_Piece]],
    decided: Sequence[bool],
) -> Step | None:
    radius = DISC_PER_STEP * h
    pieces = cover(radius)
    try:
        defect = _defect(f, t, rows, h, radius, pieces, decided)
        if defect is None:
            return None
        tube = _tube(f, t, rows, h, (spread + exact_ball(h) * defect).upper(), decided)
        if tube is None:
            return None
        flow = _flow(f, t, rows, h, radius, pieces, tube, decided)
    except Refused:
        return None
    if flow is None or not _is_tight(rows, h, defect, flow):
        return None
    return Step(t, h, tuple(map(tuple, rows)), defect, tube, flow)


def _is_tight(rows: Sequence[Sequence[arb]], h: Fraction, defect: arb, flow: arb_mat) -> bool:
    scale = size(row[0] for row in rows).max(arb(1))
    loose = size(x.rad() for x in flow.entries()) > LOOSEST_FLOW * size(flow.entries())
    return not loose and bool(exact_ball(h) * defect < scale * arb(2) ** -int(LOOSEST_STEP * ctx.prec))


@dataclass(frozen=True)
class _Piece:
    """The disc |s - centre| <= radius, on which polynomials are enclosed by their Taylor coefficients at the centre."""

    centre: acb
    radius: arb

    @property
    def ball(self) -> acb:
        """The piece itself."""
        wide = arb(0, self.radius)
        return self.centre + acb(wide, wide)

    def values(self, coefficients: Sequence[arb]) -> acb:
        """A box that contains the polynomial's values."""
        moved = acb_poly(list(coefficients))(acb_poly([self.centre, 1])).coeffs() or [acb(0)]
        reach = arb(0)
        for c in reversed(moved[1:]):
            reach = (reach + arb(c.abs_upper())) * self.radius
        wide = arb(0, reach.upper())
        return moved[0] + acb(wide, wide)


def _whole_disc(radius: Fraction) -> list[_Piece]:
    return [_Piece(acb(0), exact_ball(radius))]


def _covered_disc(radius: Fraction) -> list[_Piece]:
    """Discs around squares that cover the upper half of |s| <= radius; of the lower half all values are conjugates."""
    eighth = exact_ball(radius / 4)
    around = arb((eighth * arb(2).sqrt()).upper())
    return [_Piece(acb(i * eighth, j * eighth), around) for i in (-3, -1, 1, 3) for j in (1, 3)]


# Ways to cover a disc, the cheapest first.
COVERS = (_whole_disc, _covered_disc)


def _derivative(coefficients: Sequence[arb]) -> list[arb]:
    return [k * c for k, c in enumerate(coefficients)][1:]


def _defect(
    f: RightHandSide,
    t: Fraction,
    rows: list[list[arb]],
    h: Fraction,
    radius: Fraction,
    pieces: Sequence[_Piece],
    decided: Sequence[bool],
) -> arb | None:
    """An upper bound of |f(t + s, p(s)) - p'(s)| for 0 <= s <= h, or None where f is not finite on the disc."""
    length = len(rows[0]) - 1
    known = _on_series(f, t, rows, length, decided)
    slopes = [_derivative(row) for row in rows]
    low = [[_coefficient(k.value, i) - slope[i] for i in range(length)] for k, slope in zip(known, slopes, strict=True)]
    # p' and what is taken off the defect, as one polynomial: few operations on boxes
    taken = [[a + b for a, b in zip(slope, part, strict=True)] for slope, part in zip(slopes, low, strict=True)]
    largest = arb(0)
    for piece in pieces:
        evaluation = Evaluation(decided)
        time = Enclosed(evaluation, exact_ball(t) + piece.ball)
        rates = evaluate(f, time, [Enclosed(evaluation, piece.values(row)) for row in rows])
        whole = [acb(rate.value) - piece.values(part) for rate, part in zip(rates, taken, strict=True)]
        if not all(x.is_finite() for x in whole):
            return None
        largest = largest.max(size(whole))
    tail = largest * (exact_ball(h) / exact_ball(radius)) ** length
    return size(horner([abs(c) for c in part], exact_ball(h)) + tail for part in low)


def _box(rows: Sequence[Sequence[arb]], h: Fraction, radius: arb) -> list[arb]:
    """Boxes around p over [0, h], by `radius` wider."""
    middle = exact_ball(h / 2)
    span, wide = arb(middle, middle), arb(0, radius)
    return [horner(row, span) + wide for row in rows]


def _tube(
    f: RightHandSide, t: Fraction, rows: list[list[arb]], h: Fraction, error: arb, decided: Sequence[bool]
) -> Tube | None:
    """A tube that no solution starting near enough can leave: its radius exceeds error exp(max(μ, 0) h)."""
    middle = exact_ball(h / 2)
    least = arb(2) ** -ctx.prec
    for multiple in TUBES:
        radius = arb((multiple * error + least).upper())
        evaluation = Evaluation(decided)
        time = Enclosed(evaluation, exact_ball(t) + arb(middle, middle))
        jacobian = _jacobian(f, time, _box(rows, h, radius))
        norm = _logarithmic_norm(jacobian)
        if not norm.is_finite():
            return None
        growth = lambda s, norm=norm: (norm * s).exp()
        if growth(exact_ball(h)) * error < radius:
            return Tube(radius, growth)
    return None


def _jacobian(f: RightHandSide, time: Enclosed, y: Sequence[object]) -> list[list[object]]:
    """∂f/∂y by rows, in the arithmetic of y."""
    n = len(y)
    numbers = [
        Enclosed(time.evaluation, value, tuple(arb(int(i == j)) for j in range(n))) for i, value in enumerate(y)
    ]
    rates = evaluate(f, time, numbers)
    return [list(rate.partials or [arb(0)] * n) for rate in rates]


def _logarithmic_norm(jacobian: Sequence[Sequence[arb]]) -> arb:
    """The larger of 0 and the logarithmic maximum norm max over i of (J_ii + Σ over j != i of |J_ij|), rounded up."""
    norm = arb(0)
    for i, row in enumerate(jacobian):
        total = row[i] + sum((abs(x) for j, x in enumerate(row) if j != i), arb(0))
        norm = norm.max(arb(total.upper())) if total.is_finite() else arb("nan")
    return norm


def _flow(
    f: RightHandSide,
    t: Fraction,
    rows: list[list[arb]],
    h: Fraction,
    radius: Fraction,
    pieces: Sequence[_Piece],
    tube: Tube,
    decided: Sequence[bool],
) -> arb_mat | None:
    """The derivative of y(t + h) with respect to its start, for all starts in the tube: P(h), and Gronwall for the rest.

    P has thin coefficients; its defect J(t + s, p(s) + b) P(s) - P'(s) is analytic in s for each b in the tube.
    """
    n, length = len(rows), VARIATIONAL_LENGTH
    step = exact_ball(h)
    wide = arb(0, tube.radius)
    cap, ctx.cap = ctx.cap, length
    try:
        evaluation = Evaluation(decided)
        time = series(evaluation, [exact_ball(t), arb(1)], length)
        starts = [series(evaluation, [row[0] + wide, *row[1:]], length).value for row in rows]
        jacobian = _jacobian(f, time, starts)
    finally:
        ctx.cap = cap
    J = [arb_mat([[_coefficient(x, k) for x in row] for row in jacobian]) for k in range(length)]
    P = [arb_mat([[int(i == j) for j in range(n)] for i in range(n)])]
    for k in range(length - 1):
        total = sum((J[i] * P[k - i] for i in range(1, k + 1)), J[0] * P[k])
        P.append(arb_mat([[(x / (k + 1)).mid() for x in row] for row in total.tolist()]))
    polynomials = [[[P[k][i, j] for k in range(length)] for j in range(n)] for i in range(n)]
    first = [sum((J[i] * P[k - i] for i in range(1, k + 1)), J[0] * P[k]) - (k + 1) * P[k + 1] for k in range(length - 1)]
    low = [[[m[i, j] for m in first] for j in range(n)] for i in range(n)]
    taken = [[[(k + 1) * P[k + 1][i, j] + first[k][i, j] for k in range(length - 1)] for j in range(n)] for i in range(n)]
    largest = [arb(0)] * n
    for piece in pieces:
        evaluation = Evaluation(decided)
        time = Enclosed(evaluation, exact_ball(t) + piece.ball)
        on_disc = _jacobian(f, time, [piece.values(row) + wide for row in rows])
        at = [[piece.values(entry) for entry in row] for row in polynomials]
        for i in range(n):
            total = arb(0)
            for j in range(n):
                whole = sum((on_disc[i][k] * at[k][j] for k in range(n)), acb(0)) - piece.values(taken[i][j])
                if not whole.is_finite():
                    return None
                total += arb(whole.abs_upper())
            largest[i] = largest[i].max(arb(total.upper()))
    tail = (step / exact_ball(radius)) ** (length - 1)
    known = [sum((horner([abs(c) for c in entry], step) for entry in row), arb(0)) for row in low]
    bounds = size(known[i] + largest[i] * tail for i in range(n))
    error = arb(0, (step * bounds * tube.growth(step)).upper())
    return arb_mat([[horner(polynomials[i][j], step) + error for j in range(n)] for i in range(n)])
