"""How well a step solves its stage equations: beside our own solution, where they are linear and where they bend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import fsum, log2

from driftproof.blackbox.probes.marked_stages import MarkedSteps, MovedSlopes, Setting
from driftproof.blackbox.probes.scripted_answers import CONTROLS, Control, NotReadable
from driftproof.blackbox.probes.tableau import NO_POWER, StageSolution, TableauReading

# Of hA times the derivative of f, which is 1, or where it bends below 3: then iterations contract, ours among them.
_STRENGTHS = tuple(2.0**-k for k in range(2, 8))
# So weak that one iteration is enough for any solver that looks.
_WEAK = 2.0**-40
# Each contracts by 3/4 or more, from 1 to less than 2**-80.
_ROUNDS = 200
# A solver that leaves more than this in linear equations does not solve them, or they are not the step's.
UNSOLVED = 2.0**-14
# A Jacobian by differences is off by some roots of u, and so is what one iteration with it leaves.
_BY_DIFFERENCES = 16
# Slopes as near as this to one whole number show it (`judging.measured_order`).
_SLACK = 0.3
_VARIED = Control("other slopes", "", start=1.0, salt=2)


@dataclass(frozen=True)
class StageEquations:
    """Yᵢ = y + h Σ aᵢⱼ f(t + cⱼh, Yⱼ) with the coefficients read, for an f that is linear in y or bends.

    The stages are not marked: f is smooth in t and y, and contracts. We iterate up to rounding.
    """

    steps: MarkedSteps
    reading: TableauReading

    def solved(self) -> StageSolution:
        """How well the stages are solved. Raises NotReadable where linear ones are not, as `demand_solved`.

        Newton's method with the Jacobian of the last iterate squares an error times the bend of f; one that keeps a
        Jacobian, or none, multiplies it by a change of h f', proportional to the bend, too. From a first guess, after
        k iterations an error is left like the power 2^k - 1 of the bend in the first case, k in the other. Whoever
        looks at what is left makes more calls where more is: one that makes as many does not look.
        """
        linear = max(self.demand_solved(control) for control in CONTROLS)
        errors, counted = self._by_strength(curved=True)
        clear = [error for error in errors if error > self.reading.rounding.of(4.0)]
        power = _power(clear) or NO_POWER
        return StageSolution(linear, max(errors), power if counted and clear else 0)

    def demand_solved(self, control: Control) -> float:
        """The error that is left in linear equations. Raises NotReadable where it is no error of a solver."""
        left, _ = self._left(control, _STRENGTHS[0], curved=False)
        if not left <= UNSOLVED:
            raise NotReadable(
                f"with {control.name}, the step is off by {left:.1e} from what the coefficients of its stages give: "
                f"{control.broken}, or its solver stops too early"
            )
        return left

    def demand_solver(self) -> None:
        """Raises NotReadable for an explicit step: linear equations are off, and no more calls are made for that."""
        errors, counted = self._by_strength(curved=False)
        if counted and max(errors) > _BY_DIFFERENCES * float(self.reading.format.u) ** 0.5:
            raise NotReadable(
                f"linear stage equations are off by {max(errors):.1e} after as many calls as simpler ones: they are "
                "not solved, so the step is explicit, or not made of its stages"
            )

    def _by_strength(self, *, curved: bool) -> tuple[list[float], bool]:
        """The errors for each strength, and whether all make as many calls as if f hardly depended on y."""
        runs = [self._left(_VARIED, s, curved=curved) for s in _STRENGTHS]
        _, calls = self._left(_VARIED, _WEAK, curved=curved)
        return [error for error, _ in runs], all(made == calls for _, made in runs)

    def _left(self, control: Control, strength: float, *, curved: bool) -> tuple[float, int]:
        """By how much the step is off, in units of its numbers, and how many calls it makes."""
        h, largest = control.h, max(fsum(map(abs, row)) for row in self.reading.a)
        # From 1/4 to 64: a limit or an error control that is out of reach of the one shows with the other.
        size = 1.0 if curved else 4.0 ** (control.salt - 2)
        weight = (strength if curved else 2 * strength) / (abs(h) * max(1.0, largest))

        def rates(node: float | None, moved: Sequence[float]) -> list[float]:
            clock = 1 / (1 + (node or 0.0) ** 2)
            following = moved if self.steps.alone else [*moved[1:], moved[0]]
            drawn = [0.75 * x - 0.25 * y + curved * x * y for x, y in zip(moved, following, strict=True)]
            return [size * (1 / (1 + i) - clock / 2) + weight * clock * x for i, x in enumerate(drawn)]

        run = self.steps.smooth(Setting(control.start, control.time, h), rates)
        said = self._moved(rates, h)
        gaps = [x - control.start - y for x, y in zip(run.result, said, strict=True)]
        return max(map(abs, gaps)) / max(1.0, abs(control.start), *map(abs, said)), len(run.nodes)

    def _moved(self, rates: MovedSlopes, h: float) -> list[float]:
        """How far the numbers move in a step: our own iteration."""
        nodes = self.reading.c or (None,) * self.reading.calls
        slopes: list[Sequence[float]] = [[0.0] * self.steps.size for _ in nodes]
        for _ in range(_ROUNDS):
            before = slopes
            slopes = [rates(c, _summed(row, slopes, h)) for c, row in zip(nodes, self.reading.a, strict=True)]
            if slopes == before:
                break
        return _summed(self.reading.b, slopes, h)


def _summed(row: Sequence[float], slopes: Sequence[Sequence[float]], h: float) -> list[float]:
    return [h * fsum(x * k for x, k in zip(row, column, strict=True)) for column in zip(*slopes, strict=True)]


def _power(errors: Sequence[float]) -> int:
    """The whole power of the strength that the last of them are like, falling by halves; NO_POWER if there is none."""
    slopes = [log2(x / y) for x, y in pairwise(errors)][-2:]
    powers = {round(slope) if abs(slope - round(slope)) <= _SLACK else NO_POWER for slope in slopes}
    return powers.pop() if len(powers) == 1 else NO_POWER
