"""Enclosing the solution of a stiff problem: implicit steps, their defect, and comparison systems for the errors.

A step's polynomial v comes from collocation, and its defect d = f(t, v) - v' is enclosed on the whole step. The error
e = y - v starts in a set B z, z in a box. Its slow part follows the variational equation: V nearly solves V' = JV from
the slow part of B. The rest ρ = e - Vz has ρ' = J̄ρ + (J̄V - V')z + d. In coordinates T in which the fast part of the
Jacobian is nearly diagonal, |Tρ| stays below the solution of the comparison system of T J̄ T⁻¹ over a tube around v;
components that decay fast have large negative diagonal entries there, and nothing is lost. That e stays in the tube is
checked afterwards, so that no sign and no invariant set of the solutions has to be known beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf

from flint import arb, arb_mat, arb_poly, ctx

from driftproof.enclosure.arithmetic.clocks import Clock, TimeCut
from driftproof.enclosure.arithmetic.double_balls import bounds, coefficients_in_doubles, convolved, derivative, ranges
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Overlapping, Refused, not_smooth
from driftproof.enclosure.arithmetic.models import TaylorModel, coefficients_of, value_at
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import RightHandSide, enclosed_rates, linearised, obstacle_ahead
from driftproof.enclosure.solution.collocation import NEGLIGIBLE, Stages, collocation, solved_stages
from driftproof.enclosure.solution.comparison import along_the_step, at_the_end, quasi_monotone, sizes_of
from driftproof.enclosure.solution.coordinates import Coordinates, basis_around, nearly_diagonal
from driftproof.enclosure.solution.crossings import WIDEST_WINDOW, Window, window_near
from driftproof.enclosure.solution.steps import DensePiece, fewer_steps
from driftproof.symbolic.algebra.certified import enclose

# Bits for each stage: 128 bits give 18 stages, whose steps are about as long as the nearest singularity is away.
BITS_PER_STAGE = 7
# A step adds less than 2⁻⁸⁰ with 128 bits, relative to the components, and widens what it carries by 2⁻⁸ at most.
BITS_OF_A_STEP, LOOSEST = Fraction(5, 8), 2.0**-8
MOST_STEPS, MOST_TRIES = 5000, 60
# The first tube is this many times what the step before needed, each further one what the try before showed is needed.
TUBE_AHEAD, TUBES = 8, (2, 2, 8, 32)
# Steps shorter than this part of the time gone by mean a pole; van der Pol's equation, mu = 10^6, has steps of 2⁻⁴⁵.
SHORTEST_STIFF_PART = Fraction(1, 2**64)
# A change of f is crossed where steps are as short as these parts of the whole time; where they are as NEAR only if the
# window adds no more than a step, as over a kink. Over a jump it adds the jump times its length, of 64 steps or more.
NEAREST, NEAR = Fraction(1, 2**86), WIDEST_WINDOW / 64
# Steps change by these factors at most.
SHORTEN, LENGTHEN = 0.25, 4.0


@dataclass(frozen=True)
class ErrorSet:
    """A set that contains y: all points of the balls `point`, plus B z for all |z| <= widths."""

    point: Sequence[arb]
    basis: arb_mat
    widths: arb_mat


@dataclass(frozen=True)
class StiffStep:
    """A step on [t, t + h]: y = v + V(σ) z + ρ for -1 <= σ <= 1, |z| <= widths, |ρ| <= around, at the end <= last."""

    t: Fraction
    h: Fraction
    polynomials: Sequence[arb_poly]
    flow: Sequence[arb_mat]
    widths: arb_mat
    around: arb_mat
    last: arb_mat

    def state_at(self, t: Fraction) -> tuple[arb, ...]:
        """Balls of the solution at a time t of the step."""
        sigma = enclose(2 * (t - self.t) / self.h - 1)
        rest = self.last if t == self.t + self.h else self.around
        around = (sizes_of(value_at(self.flow, sigma)) * self.widths + rest).entries()
        return tuple(arb(p(sigma)) + arb(0, r.upper()) for p, r in zip(self.polynomials, around, strict=True))


class StiffPath:
    """Implicit steps from the first time to the last, each beginning where the one before ends."""

    def __init__(
        self, f: RightHandSide, start: Sequence[arb], first: Fraction, last: Fraction, step: Fraction | None = None
    ) -> None:
        """Work with Arb's current precision; `step` is a guess of the first step size."""
        self.f, self.t, self.last, self.steps, self.n = f, first, last, 0, len(start)
        self.most, m = fewer_steps(MOST_STEPS, self.n), ctx.prec // BITS_PER_STAGE
        self.length = 2 * m + 2
        self.method = collocation(m, ctx.prec, self.length)
        self.tolerance = 2.0 ** -float(BITS_OF_A_STEP * ctx.prec)
        self.set = ErrorSet(
            [x.mid() for x in start], arb_mat(self.n, self.n, 1), arb_mat([[arb(x.rad())] for x in start])
        )
        self.first, self.start, self.largest = first, tuple(start), [0.0] * self.n
        self.h = (last - first) / 1024 if step is None else step
        # The next step's span, its latest end, and whether f changed where it begins.
        self.span, self.end, self.jumped = (first, last), last, False
        self.step: StiffStep | Window | None = None
        self.needed = arb_mat(self.n, 1)
        self.doubles, self.changes = set[float](), list[Fraction]()
        self.pieces: list[DensePiece] | None = None  # a list that gets one for each step

    def states_at(self, t: Fraction) -> tuple[arb, ...]:
        """Balls of the solution at t, which must not be before the t of an earlier call."""
        if t == self.first:
            return self.start
        while self.step is None or t > self.t:
            step = self.advance()
            if self.pieces is not None and isinstance(step, StiffStep):
                self.pieces.append(DensePiece(step.t, step.h, -1, step.polynomials))
        return self.step.state_at(t)

    def advance(self) -> StiffStep | Window:
        """Make the next step and return it. Raises Refused if none is found."""
        self.steps += 1
        if self.steps > self.most:
            raise Refused(f"{self.most} implicit steps, the limit, reach only t = {float(self.t):.9g}")
        obstacle: Refused | None = None
        near = [part * (self.last - self.first) for part in (NEAREST, NEAR)]
        for _ in range(MOST_TRIES):
            h = min(_short(self.h), self.end - self.t)
            try:
                added = self._attempt(h)
            except TimeCut as cut:
                self.end = cut.at
                continue
            except Refused as refusal:
                if isinstance(refusal, Overlapping) and near and h < near[-1]:
                    near.pop()  # once is enough from here
                    if (window := self._window(h, any_width=not near)) is not None:
                        return window
                added, obstacle = inf, refusal
            nears = isinstance(obstacle, Overlapping)  # a change of f, in steps that may be as short as needed
            ratio = max(added / self.tolerance, 1e-30) ** (-1 / (1 + len(self.method.stages))) if added < inf else 0.0
            wanted, self.h = self.h, h * Fraction(min(max(0.9 * ratio, SHORTEN), LENGTHEN))
            if added <= self.tolerance and self.step is not None:
                self.t = self.step.t + self.step.h
                self.jumped = self.t == self.end
                if self.jumped:
                    self.changes += [self.t] * (self.t < self.last)
                    self.h, self.end = max(self.h, wanted), self.last
                elif h < SHORTEST_STIFF_PART * (self.t - self.first) and not (near and nears):
                    raise not_smooth(self.t, obstacle_ahead(self.f, self.t, self.set.point, h))
                return self.step
        reason = obstacle or "earlier errors grow too fast"
        raise Refused(f"no implicit step from t = {float(self.t):.9g} could be proved: {reason}", self.t)

    def _window(self, h: Fraction, any_width: bool) -> Window | None:
        """Cross a change of f that is less than a short step ahead; None if it is farther, not proved, or too wide."""
        around = (sizes_of(self.set.basis) * self.set.widths).entries()
        box = [x + r * arb(0, 1) for x, r in zip(self.set.point, around, strict=True)]
        window = window_near(self.f, self.t, 16 * h, box, WIDEST_WINDOW * (self.last - self.first))
        if window is None:
            return None
        narrow = (x.rad() <= self.tolerance * size for x, size in zip(window.after, self.largest, strict=True))
        if not (any_width or all(narrow)):
            return None
        self.changes += [self.t] * (self.t > self.first)
        self.step, self.t, self.jumped, self.h = window, self.t + window.h, True, (self.last - self.first) / 1024
        widths = arb_mat([[arb(x.rad())] for x in window.after])
        self.set = ErrorSet([x.mid() for x in window.after], arb_mat(self.n, self.n, 1), widths)
        return window

    def _attempt(self, h: Fraction) -> float:
        """The error that a step of size h adds, relative to the components; the step is taken if it is small enough."""
        step, basis, widths = enclose(h), self.set.basis, self.set.widths
        self.span, accuracy = (self.t, self.t + h), self.tolerance * 2.0**-10
        stages = solved_stages(self.f, self.method, self.span, self._guess(step), accuracy)
        if stages is None:
            raise Refused("Newton's iteration does not converge")
        polynomials, sizes = stages.polynomials(), self._sizes(stages)
        middle, first = (self._coordinates(step, polynomials, sizes, sigma) for sigma in (0, -1))
        T, back = middle.T, sizes_of(middle.inverse)
        flow = stages.flow(first.slow_part(first.T * basis).mid())
        jump = arb_mat([[x - p(-1)] for x, p in zip(self.set.point, polynomials, strict=True)])
        start = sizes_of(T * (basis - value_at(flow, arb(-1)))) * widths + sizes_of(T * jump)
        M, sources, around, needed = self._tube(step, polynomials, (T, middle.inverse), flow, start)
        grown, added = at_the_end(M, sources, step)
        own, old = (arb_mat(self.n, 1, column) for column in added.transpose().tolist())
        old += grown * start
        if not all(x.is_finite() for x in (own + old).entries()):
            raise Refused("the error bound is not finite")
        relative = _relative(back * own, sizes)
        lost = sizes_of(middle.slow_part(arb_mat(self.n, self.n, 1))) * old  # fast errors decay by themselves
        followed = sizes_of(basis) * widths + sizes_of(value_at(flow, arb(1))) * widths
        allowed = [LOOSEST * float(x) + self.tolerance * a for x, a in zip(followed.entries(), sizes, strict=True)]
        if _relative(lost, allowed) > 1:
            return inf
        if relative <= self.tolerance:
            self.needed = needed
            last = own + old
            self.step = StiffStep(self.t, h, polynomials, flow, widths, back * around, back * last)
            self._carry(self.step, middle, last, sizes)
        return relative

    def _tube(
        self,
        step: arb,
        polynomials: Sequence[arb_poly],
        coordinates: tuple[arb_mat, arb_mat],
        flow: Sequence[arb_mat],
        start: arb_mat,
    ) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
        """M and δ in two columns, a bound of |Tρ|, and that of |e|, over a tube around v that holds the solution.

        The columns are the defect and what V leaves of the variational equation. Raises Refused.
        """
        (T, inverse), widths = coordinates, self.set.widths
        defect, carried = self._defect(step, polynomials, T), bounds(self.method.chebyshev, flow) * widths
        box = guess = self.needed * TUBE_AHEAD
        for multiple in TUBES:
            M, source = self._comparison(step, polynomials, coordinates, flow, box)
            source = source * widths
            around = along_the_step(M, start, defect + source, step)
            if around is not None:
                needed = carried + sizes_of(inverse) * around
                if all(x < y for x, y in zip(needed.entries(), box.entries(), strict=True)):
                    sources = arb_mat(2, self.n, [*defect.entries(), *source.entries()]).transpose()
                    return M, sources, around, needed
                box = needed * multiple
            elif box is guess:  # which may be too wide
                box = arb_mat(self.n, 1)
            else:
                raise Refused("the bounds of f around the step do not bound the errors")
        raise Refused("no tube around the step could be proved to hold the solution")

    def _carry(self, step: StiffStep, middle: Coordinates, last: arb_mat, sizes: Sequence[float]) -> None:
        """Keep the set of errors at the end of the step, in a new basis."""
        image = value_at(step.flow, arb(1))
        basis = basis_around(image, step.widths, middle.fast, sizes)
        back = basis.inv()
        widths = sizes_of(back * image) * step.widths + sizes_of(back * middle.inverse) * last
        self.set = ErrorSet([arb(p(1)) for p in step.polynomials], basis, sizes_of(widths))

    def _guess(self, step: arb) -> list[list[arb]]:
        """The values that the polynomial of the step before, without its last quarter, extrapolates to."""
        now = [x.mid() for x in self.set.point]
        if not isinstance(self.step, StiffStep) or self.jumped:
            return [now] * (1 + len(self.method.stages))
        ratio = step / enclose(self.step.h)
        few = [p.truncate(3 * len(self.method.stages) // 4) for p in self.step.polynomials]
        return [now, *([arb(p(1 + (1 + arb(s)) * ratio)).mid() for p in few] for s in self.method.stages)]

    def _sizes(self, stages: Stages) -> list[float]:
        """The size of each component on the step, at least a small part of its largest so far and of the others."""
        errors = (sizes_of(self.set.basis) * self.set.widths).entries()
        rows = stages.values.transpose().tolist()
        found = [max(float(abs(x)) for x in (*row, error)) for row, error in zip(rows, errors, strict=True)]
        self.largest = [max(x, y) for x, y in zip(found, self.largest, strict=True)]
        floor = max(max(found) * NEGLIGIBLE, 1e-290)
        return [max(x, y * NEGLIGIBLE, floor) for x, y in zip(found, self.largest, strict=True)]

    def _coordinates(
        self, step: arb, polynomials: Sequence[arb_poly], sizes: Sequence[float], sigma: int
    ) -> Coordinates:
        time = Clock(Evaluation(span=self.span), enclose(self.t) + step * (1 + sigma) / 2)
        return nearly_diagonal(linearised(self.f, time, [arb(p(sigma)) for p in polynomials])[1], step, sizes)

    def _time(self, step: arb) -> Clock:
        time = TaylorModel([enclose(self.t) + step / 2, step / 2], self.length)
        return Clock(Evaluation(doubles=self.doubles, span=self.span), time)

    def _defect(self, step: arb, polynomials: Sequence[arb_poly], T: arb_mat) -> arb_mat:
        """Upper bounds of |T (f(t, v) - v')| on the step."""
        time, length = self._time(step), self.length
        state = [Enclosed(time.evaluation, TaylorModel(p, length)) for p in polynomials]
        rates = [rate.value for rate in enclosed_rates(self.f, time, state)]
        slopes = [TaylorModel(p.derivative() * (2 / step), length) for p in polynomials]
        left = [[rate - slope] for rate, slope in zip(rates, slopes, strict=True)]
        coefficients, tails = coefficients_of(left)
        return bounds(self.method.chebyshev, [T * c for c in coefficients]) + sizes_of(T) * tails

    def _comparison(
        self,
        step: arb,
        polynomials: Sequence[arb_poly],
        coordinates: tuple[arb_mat, arb_mat],
        flow: Sequence[arb_mat],
        box: arb_mat,
    ) -> tuple[arb_mat, arb_mat]:
        """The comparison matrix of T J̄ T⁻¹ and a bound of T (J̄V - V'), for all mean Jacobians J̄ of v and the box."""
        (T, inverse), length = coordinates, self.length
        state = [TaylorModel(p, length) + arb(0, b.upper()) for p, b in zip(polynomials, box.entries(), strict=True)]
        _, rows = linearised(self.f, self._time(step), state)
        coefficients, tails = coefficients_of(rows)
        TJ, tails = [T * c for c in coefficients], sizes_of(T) * tails
        J = ranges(self.method.chebyshev, [c * inverse for c in TJ]).in_arb()
        M = quasi_monotone(J + _around(tails * sizes_of(inverse)))
        V = coefficients_in_doubles(flow).mid
        products = convolved(coefficients_in_doubles([c * (step / 2) for c in TJ]), V)
        left = products.less(convolved(coefficients_in_doubles([T]), derivative(V).mid))
        source = bounds(self.method.chebyshev, left) * (2 / step)
        return M, source + tails * bounds(self.method.chebyshev, flow)


def _short(h: Fraction) -> Fraction:
    """h cut to about eight bits, so that times stay short."""
    unit = Fraction(2) ** (h.numerator.bit_length() - h.denominator.bit_length() - 8)
    return int(h / unit) * unit


def _around(m: arb_mat) -> arb_mat:
    """Balls around 0 with these radii."""
    return arb_mat([[arb(0, x.upper()) for x in row] for row in m.tolist()])


def _relative(bounds: arb_mat, sizes: Sequence[float]) -> float:
    return max(float(x) / size for x, size in zip(bounds.entries(), sizes, strict=True))
