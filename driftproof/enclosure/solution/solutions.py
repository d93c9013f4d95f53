"""Enclosing the true solution of an initial value problem at given times: steps, and the errors that they carry along.

The errors of earlier steps lie in a set Q z of small vectors, Q a basis and z a box. The flow's derivative Φ takes it
to Q' z' with z' = (Q'^-1 Φ Q) z + Q'^-1 d, where `basis_around` chooses Q' such that boxes do not wrap around a set
that only rotates (lohner-1987). Points are thin and have many bits, so that all these vectors are about 1e-30 long.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat, ctx

from driftproof.enclosure.arithmetic.clocks import Clock
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Overlapping, Refused, Stiff, in_bits, not_smooth
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.fields.fields import (
    NO_SLOPE,
    RightHandSide,
    decisions,
    enclosable,
    linearised,
    obstacle_ahead,
    require_the_same,
)
from driftproof.enclosure.solution.coordinates import basis_around
from driftproof.enclosure.solution.crossings import WIDEST_WINDOW, Crossing, Window, window_near
from driftproof.enclosure.solution.steps import (
    SHORTEST_PART,
    DensePiece,
    EnclosedStep,
    Expansion,
    Weights,
    balanced,
    fewer_steps,
)
from driftproof.enclosure.solution.stiff import StiffPath
from driftproof.support.progress import stage
from driftproof.symbolic.algebra.certified import enclose

# Bits of the first attempt.
BITS_AT_FIRST = 128
# Each coefficient gains 7/8 of these bits: h is 2^(-21/8) of the radius of convergence, near the e⁻² that costs least.
BITS_PER_COEFFICIENT = 3
# These take some minutes with the bits of the first attempt. A problem that needs more steps is stiff, or too long.
MOST_STEPS = 20_000
# With more components, even a few steps take minutes. Thirty bodies in space have 180.
MOST_COMPONENTS = 200
# A problem may be found stiff after this many steps, if all others are as long as the last; too long after 1/20 of the
# steps allowed, if the others are like those so far; or after 1/200, if both estimates are ten times too many.
STEPS_OF_STIFF, PART_OF_LONG, PART_OF_FAR_TOO_LONG = 20, Fraction(1, 20), Fraction(1, 200)
# A stiff problem with fewer explicit steps left is finished by them, and one with fewer than the second number if no
# implicit step is found; an implicit step is as long as 10 to 1000 of them, and takes the time of 4 to 9 (measured).
MOST_STIFF_STEPS, MOST_IF_NO_OTHERS = 500, 10_000
# A problem is stiff if a direction shrinks to less than this in a step, and steps do not get shorter, as at a pole.
# Chosen: a little more than e⁻¹, as of a rate that a step is as long as the time of.
SHRUNK = 0.4
# No problem needs a longer first step; a shorter one is found by trying. Each further step is a sixth of the radius of
# convergence, which grows by no more than the length of a step: so 5/4 is more than the next can use.
LONGEST_STEP, LONGER = Fraction(2) ** 20, Fraction(5, 4)


@dataclass(frozen=True)
class Enclosure:
    """Balls of the solution at `times`, with the `bits` and `steps` that they took and the `doubles` in f's code.

    `changes` are the times on the way where f changes, with a jump or a kink: those that it says itself, and about when
    the solution crosses others.
    """

    times: tuple[Fraction, ...]
    states: tuple[tuple[arb, ...], ...]
    bits: int
    steps: int
    doubles: tuple[float, ...]
    changes: tuple[Fraction, ...] = ()


def enclose_solution(
    f: RightHandSide,
    start: Sequence[Fraction | arb],
    times: Sequence[Fraction],
    bits: int = BITS_AT_FIRST,
    pieces: list[DensePiece] | None = None,
) -> Enclosure:
    """Enclose the solution of y' = f(t, y) with y(times[0]) = start at all `times`, which must increase.

    A start given as balls stands for every point in them. A list of `pieces`, empty, gets one for each step but those
    over a kink. Raises Refused if nothing can be proved.
    """
    with in_bits(bits), np.errstate(all="ignore"):
        function, balls = enclosable(f), [x if isinstance(x, arb) else enclose(x) for x in start]
        explicit = _Path(function, balls, times, bits)
        path: _Path | StiffPath = explicit
        before = list[arb]()
        with suppress(Refused):  # where f starts on a kink, say
            before = linearised(function, Clock(Evaluation(span=(times[0], None)), enclose(times[0])), balls)[0]
        try:
            try:
                states = _states(path, times, pieces)
            except Stiff:
                path = StiffPath(function, balls, times[0], times[-1], 16 * explicit.lengths[-1])
                try:
                    states = _states(path, times, pieces)
                except Refused:
                    if times[-1] - explicit.t > MOST_IF_NO_OTHERS * explicit.lengths[-1]:
                        raise
                    path = _Path(function, balls, times, bits)
                    path.most_stiff = MOST_STEPS
                    states = _states(path, times, pieces)
        except (OverflowError, ZeroDivisionError, np.linalg.LinAlgError):  # in a guess, not in a proof
            raise Refused("f or the solution is outside the range of doubles") from None
        finally:
            if before:
                require_the_same(function, times[0], balls, before)
        doubles, changes = tuple(sorted(explicit.doubles | path.doubles)), tuple(path.changes)
        return Enclosure(tuple(times), tuple(states), bits, path.steps, doubles, changes)


def _states(
    path: _Path | StiffPath, times: Sequence[Fraction], pieces: list[DensePiece] | None
) -> list[tuple[arb, ...]]:
    """The solution at each time, with the progress reported; the pieces are those of this path alone."""
    states, path.pieces = [], pieces
    if pieces is not None:
        pieces.clear()
    with stage(f"enclosing the solution in {ctx.prec} bits") as progress:
        for t in times:
            states.append(path.states_at(t))
            progress.part = float((t - times[0]) / (times[-1] - times[0] or 1))
    return states


class _Path:
    """Explicit steps from the first time on, each beginning where the one before ends."""

    def __init__(self, f: RightHandSide, balls: Sequence[arb], times: Sequence[Fraction], bits: int) -> None:
        self.f, self.t, self.steps, self.most_stiff = f, times[0], 0, MOST_STIFF_STEPS
        self.first, self.last, self.start = times[0], times[-1], tuple(balls)
        self.length = bits // BITS_PER_COEFFICIENT
        self.doubles: set[float] = set()
        n = len(balls)
        if n > MOST_COMPONENTS:
            raise Refused(f"{n} components are too many; at most {MOST_COMPONENTS} can be enclosed")
        self.most = fewer_steps(MOST_STEPS, n)
        self.point = [(x + 0).mid() for x in balls]  # of no more bits than a step's polynomial has
        self.basis = arb_mat(n, n, 1)
        self.box = arb_mat([[x - m] for x, m in zip(balls, self.point, strict=True)])
        self.step: EnclosedStep | Window | None = None
        self.weights: Weights | None = None
        self.coupled = 0.0
        self.lengths, self.longest, self.changes = list[Fraction](), LONGEST_STEP, list[Fraction]()
        self.pieces: list[DensePiece] | None = None  # a list that gets one for each step but those over a kink

    def states_at(self, t: Fraction) -> tuple[arb, ...]:
        if t == self.first:
            return self.start
        if t < self.t:
            raise Refused("times must not decrease")
        while self.step is None or t > self.step.t + self.step.h:
            self._advance()
            if self.pieces is not None and isinstance(self.step, EnclosedStep):
                self.pieces.append(DensePiece(self.step.t, self.step.h, 0, self.step.polynomials))
        return self.step.state_at(t)

    def _advance(self) -> None:
        if isinstance(self.step, EnclosedStep):
            self._carry(self.step)
        self.steps += 1
        if self.steps > self.most:
            raise Refused(f"too long: {self.most} steps, the limit, reach only t = {float(self.t):.9g}")
        error = (self.basis * self.box).entries()
        try:
            decided = decisions(self.f, self.t, self.point, self.doubles)
        except Refused as refusal:
            if isinstance(refusal, Overlapping):
                if self._cross((self.last - self.first) / 2**ctx.prec, error):
                    return
                raise not_smooth(self.t, refusal, at_start=self.t == self.first) from None
            raise Refused(f"{refusal} near t = {float(self.t):.9g}", refusal.t) from None
        if self.weights is None:
            time = Clock(Evaluation(span=(self.t, None)), enclose(self.t))
            _, jacobian = linearised(self.f, time, self.point)
            self.weights = [arb(1)] * len(error)
            if self.step is None:  # behind a kink that is left from rest, derivatives may be tiny
                self.weights = balanced(jacobian, self.weights)
            self.coupled = sum(x is not NO_SLOPE for row in jacobian for x in row) / len(error)
        expansion = Expansion(self.f, self.t, self.point, self.length, decided, self.weights, self.coupled)
        before = self.step
        try:
            self.step = expansion.step(self.longest, error, WIDEST_WINDOW * (self.last - self.first))
        except Crossing as ahead:
            if not self._comes_nearer(expansion, error) and not self._cross(ahead.s, error):
                raise not_smooth(self.t + ahead.s, ahead) from None
            return
        self.weights = self.step.next_weights
        if expansion.jumped and self.step.t + self.step.h < self.last:
            self.changes.append(self.step.t + self.step.h)
        self.longest = LONGEST_STEP if expansion.cut else LONGER * self.step.h
        # They grow behind a window in which the argument of a root was 0.
        grows = isinstance(before, Window) or (before is not None and self.step.h > before.h)
        shrinks = not grows and not expansion.cut
        if (
            shrinks
            and self.step.h < SHORTEST_PART * (self.t + self.step.h - self.first)
            and self._has_crossed(self.step.h)
        ):
            return
        self._refuse_what_does_not_end(self.step, grows)

    def _comes_nearer(self, expansion: Expansion, error: Sequence[arb]) -> bool:
        """Step towards a crossing with weights as the errors are: those of other components do not keep it away."""
        largest = size(error)
        expansion.weights = [arb(2) ** max(_binary(size([x])), _binary(largest) - ctx.prec) for x in error]
        try:
            self.step = expansion.step(self.longest, error, WIDEST_WINDOW * (self.last - self.first))
        except Refused:
            return False
        self.longest = LONGEST_STEP
        return True

    def _cross(self, s: Fraction, error: Sequence[arb]) -> bool:
        """Go to where f is certain again after it changes at about the time s from now; False if that is not near."""
        box = [x + e for x, e in zip(self.point, error, strict=True)]
        if (window := window_near(self.f, self.t, s, box, WIDEST_WINDOW * (self.last - self.first))) is None:
            return False
        self.changes += [self.t] * (self.t > self.first)
        self.step, self.t, self.longest = window, self.t + window.h, LONGEST_STEP
        self.point, self.basis = [x.mid() for x in window.after], arb_mat(len(box), len(box), 1)
        self.box = arb_mat([[x - m] for x, m in zip(window.after, self.point, strict=True)])
        return True

    def _has_crossed(self, h: Fraction) -> bool:
        """True after crossing what f refuses just ahead of a very short step, False before it; Refused at a pole."""
        obstacle = obstacle_ahead(self.f, self.t, self.point, h)
        may_cross = isinstance(obstacle, Overlapping)  # at a root that becomes 0, to which no step leads
        near = 64 * h < WIDEST_WINDOW * (self.last - self.first)
        if may_cross and near and self._cross(16 * h, (self.basis * self.box).entries()):
            return True
        if near or not may_cross:
            raise not_smooth(self.t + 8 * h, obstacle)
        return False

    def _refuse_what_does_not_end(self, step: EnclosedStep, grows: bool) -> None:
        """Raise Refused or Stiff if there will be too many steps: a guess on which no proof depends."""
        gone, left = step.t + step.h - self.first, self.last - step.t
        self.lengths.append(step.h)
        lasting = self.steps >= STEPS_OF_STIFF and 2 * step.h > self.lengths[-STEPS_OF_STIFF // 2]
        if lasting and left > self.most_stiff * step.h and _shrinks(step.flow):
            raise Stiff(f"stiff: too many steps are needed from t = {float(self.t):.4g} to the end")
        part, as_all, as_last = Fraction(self.steps, self.most), left * self.steps / gone, left / step.h
        far_too_long = lasting and part >= PART_OF_FAR_TOO_LONG and min(as_all, as_last) > 10 * self.most
        if (far_too_long and not grows) or (part >= PART_OF_LONG and as_all > self.most):
            raise Refused(f"too long: {self.steps} steps reach t = {float(self.t):.6g}; at most {self.most} are taken")

    def _carry(self, step: EnclosedStep) -> None:
        """Move the thin point, and the set of errors around it, from the start of the step to its end."""
        values, near = step.at(step.h)
        self.point = [x.mid() for x in values]
        made = arb_mat([[x - m + e] for x, m, e in zip(values, self.point, step.around(near), strict=True)])
        image = step.flow * self.basis
        no_fast_ones = arb_mat(len(self.point), 0)
        widths = arb_mat([[arb(x.rad())] for x in self.box.entries()])
        basis = basis_around(image, widths, no_fast_ones, step.weights)
        inverse = basis.inv()
        self.box = (inverse * image) * self.box + inverse * made
        self.basis, self.t = basis, step.t + step.h


def _binary(x: arb) -> int:
    """The exponent k of 2^k, about the number; of 0 a very small one."""
    return int(x.man_exp()[1]) + int(x.man_exp()[0]).bit_length() if x else -(2**20)


def _shrinks(flow: arb_mat) -> bool:
    middle = np.array([[float(x.mid()) for x in row] for row in flow.tolist()])
    return bool(np.abs(np.linalg.eigvals(middle)).min() < SHRUNK)
