"""The true solution of an initial value problem, enclosed at any times: steps, and the errors carried along by QR.

What earlier steps left open is a set Q z of small vectors, Q near orthogonal and z a box: the flow's derivative Φ takes
it to Q' z' with z' = (Q'^-1 Φ Q) z + Q'^-1 d, where Q' comes from the QR factors of the middle of ΦQ, so that boxes do
not wrap around what only turns (lohner-1987). Points are thin and of many bits, so that all this happens at 1e-30.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat, ctx

from driftproof.enclosure.fields import RightHandSide, rebound
from driftproof.enclosure.numbers import Enclosed, Evaluation, Refused, Stiff
from driftproof.enclosure.steps import (
    SHORTEST_PART,
    EnclosedStep,
    Expansion,
    Weights,
    balanced,
    decisions,
    jacobian_of,
    size,
)
from driftproof.enclosure.stiff import StiffPath
from driftproof.symbolic.algebra.certified import enclose

# Bits of the first attempt.
BITS_AT_FIRST = 128
# Each coefficient gains 7/8 of them: h is 2^(-21/8) of the radius of convergence, near the e⁻² that costs least.
BITS_PER_COEFFICIENT = 3
# Some minutes. A problem that needs more is stiff, or too long.
MOST_STEPS = 20_000
# Steps after which it is looked at how many there will be, all being as the last, or as all so far.
STEPS_OF_STIFF, STEPS_OF_LONG = 20, 1000
# A stiff problem with fewer left is done explicitly: implicit steps are as long as fifty to a thousand of those.
MOST_STIFF_STEPS = 2000
# What is stiff: some direction shrinks to less than this in a step, and steps do not get shorter, as before a pole.
SHRUNK = 0.6
# No problem needs a longer one; shorter are found by trying.
LONGEST_STEP = Fraction(2) ** 20


@dataclass(frozen=True)
class Enclosure:
    """Balls of the solution at `times`; `bits` worked with, `steps` taken, and the doubles that f's own text holds."""

    times: tuple[Fraction, ...]
    states: tuple[tuple[arb, ...], ...]
    bits: int
    steps: int
    doubles: tuple[float, ...]

    @property
    def radius(self) -> arb:
        """The largest radius of any ball."""
        return size(x.rad() for state in self.states for x in state)


def enclose_solution(
    f: RightHandSide, start: Sequence[Fraction | arb], times: Sequence[Fraction], bits: int = BITS_AT_FIRST
) -> Enclosure:
    """The solution of y' = f(t, y) with y(times[0]) = start at all `times`, which increase.

    A start given as balls stands for every point in them.

    Raises Refused where nothing rigorous can be said: see `driftproof.enclosure.numbers`.
    """
    with ctx.workprec(bits):
        function, balls = rebound(f), [x if isinstance(x, arb) else enclose(x) for x in start]
        explicit = _Path(function, balls, times, bits)
        path: _Path | StiffPath = explicit
        try:
            states = [explicit.states_at(t) for t in times]
        except Stiff:
            path = StiffPath(function, balls, times[0], times[-1], 16 * explicit.lengths[-1])
            states = [path.states_at(t) for t in times]
        return Enclosure(tuple(times), tuple(states), bits, path.steps, tuple(sorted(explicit.doubles | path.doubles)))


class _Path:
    """The steps made so far, from the first time on; the last one's end is where the next begins."""

    def __init__(self, f: RightHandSide, balls: Sequence[arb], times: Sequence[Fraction], bits: int) -> None:
        self.f, self.t, self.steps = f, times[0], 0
        self.first, self.last = times[0], times[-1]
        self.length = bits // BITS_PER_COEFFICIENT
        self.doubles: set[float] = set()
        n = len(balls)
        self.point = [x.mid() for x in balls]
        self.basis = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        self.box = arb_mat([[x - m] for x, m in zip(balls, self.point, strict=True)])
        self.step: EnclosedStep | None = None
        self.lengths: list[Fraction] = []

    def states_at(self, t: Fraction) -> tuple[arb, ...]:
        """The solution at t, which is not before any time asked for."""
        if t < self.t:
            raise Refused("times must not decrease")
        while self.step is None or t > self.step.t + self.step.h:
            self._advance()
        s = t - self.step.t
        values, near = self.step.at(s)
        if s == 0:
            return tuple(x + e for x, e in zip(self.point_before, self.error_before, strict=True))
        reach = near + self.step.spread * self.step.tube.growth(enclose(s))
        return tuple(x + ball for x, ball in zip(values, self.step.around(reach), strict=True))

    def _advance(self) -> None:
        if self.step is not None:
            self._carry(self.step)
        self.steps += 1
        error = (self.basis * self.box).entries()
        self.point_before, self.error_before = self.point, error
        decided = decisions(self.f, self.t, self.point, self.doubles)
        if self.step is not None:
            longest, weights = 4 * self.step.h, self.step.next_weights
        else:
            time = Enclosed(Evaluation(), enclose(self.t))
            longest, weights = LONGEST_STEP, balanced(jacobian_of(self.f, time, self.point), [arb(1)] * len(error))
        self.step = Expansion(self.f, self.t, self.point, self.length, decided, weights).step(longest, error)
        self._refuse_what_does_not_end(self.step)

    def _refuse_what_does_not_end(self, step: EnclosedStep) -> None:
        """No proof depends on this: it guesses how many steps there will be."""
        gone, left = step.t + step.h - self.first, self.last - step.t
        if step.h < SHORTEST_PART * gone:
            near = float(self.t + 8 * step.h)
            raise Refused(f"a pole, or a point where f is not smooth, is ahead near t = {near:.9g}")
        self.lengths.append(step.h)
        lasting = self.steps >= STEPS_OF_STIFF and 2 * step.h > self.lengths[-STEPS_OF_STIFF // 2]
        if lasting and left > MOST_STIFF_STEPS * step.h and _shrinks(step.flow):
            raise Stiff(
                f"stiff: {float(left / step.h):.1g} explicit steps would lead from t = {float(self.t):.4g} to the end"
            )
        if self.steps >= STEPS_OF_LONG and left * self.steps > MOST_STEPS * gone:
            raise Refused(f"too long: {self.steps} steps lead to t = {float(self.t):.6g}, {MOST_STEPS} will not do")

    def _carry(self, step: EnclosedStep) -> None:
        """From the start of the step to its end: the thin point, and the set of errors around it."""
        values, near = step.at(step.h)
        self.point = [x.mid() for x in values]
        made = arb_mat([[x - m + e] for x, m, e in zip(values, self.point, step.around(near), strict=True)])
        image = step.flow * self.basis
        basis = _near_orthogonal(image, self.box, step.weights)
        inverse = basis.inv()
        self.box = (inverse * image) * self.box + inverse * made
        self.basis, self.t = basis, step.t + step.h


def _near_orthogonal(image: arb_mat, box: arb_mat, weights: Weights) -> arb_mat:
    """The Q of the QR factors of the middle of `image`, longest columns first; thin, and only nearly orthogonal.

    In units of the weights.
    """
    widest = size(x.rad() for x in box.entries())
    widths = [float(x.rad() / widest) if widest > 0 else 1.0 for x in box.entries()]
    columns = np.array(
        [
            [float(x.mid() / d) * w for x, w in zip(row, widths, strict=True)]
            for row, d in zip(image.tolist(), weights, strict=True)
        ]
    )
    order = np.argsort(-np.linalg.norm(columns, axis=0), kind="stable")
    q, _ = np.linalg.qr(columns[:, order] + 1e-300 * np.eye(len(columns)))
    q = q if np.isfinite(q).all() and abs(np.linalg.det(q)) > 0.5 else np.eye(len(q))
    return arb_mat([[float(x) * d for x in row] for row, d in zip(q, weights, strict=True)])


def _shrinks(flow: arb_mat) -> bool:
    middle = np.array([[float(x.mid()) for x in row] for row in flow.tolist()])
    return bool(np.abs(np.linalg.eigvals(middle)).min() < SHRUNK)
