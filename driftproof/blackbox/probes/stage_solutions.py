"""How well a step solves its stage equations, compared with our own solution, where they are linear and nonlinear."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import fsum, log2
from operator import eq
from typing import Any, TypeAlias

from driftproof.blackbox.probes.marked_stages import MarkedSteps, Setting
from driftproof.blackbox.probes.scripted_answers import CONTROLS, Control, NotReadable
from driftproof.blackbox.probes.tableau import NO_POWER, StageSolution, TableauReading

# Sizes of hA times the derivative of f, which is 1, or below 3 if f is nonlinear: all iterations contract.
_STRENGTHS = tuple(2.0**-k for k in range(2, 8))
# So weak that one iteration is enough for any solver that checks its residual.
_WEAK = 2.0**-40
# Each round contracts by 3/4 or better, so that 200 lead from 1 to less than 2**-80.
_ROUNDS = 200
# A solver that leaves more in linear equations does not solve them, or they are not those of the step.
UNSOLVED = 2.0**-14
# Solvers in use stop at an error of this size or less for numbers of size 1.
SOLVED = 1e-6
# A Jacobian by differences is off by a few times the root of u, and so is what one iteration with it leaves.
_BY_DIFFERENCES = 16
# Slopes this close to a whole number count as that number (`judging.measured_order`).
_SLACK = 0.3
_VARIED = Control("other slopes", "", start=1.0, salt=2)


@dataclass(frozen=True)
class StageEquations:
    """The equations Yᵢ = y + h Σ aᵢⱼ f(t + cⱼh, Yⱼ) with the coefficients read, for an f linear or nonlinear in y.

    The stages are not marked: f is smooth in t and y and a contraction, so that we iterate up to rounding.
    """

    steps: MarkedSteps
    reading: TableauReading

    def solved(self) -> StageSolution:
        """How well the stages are solved. Raises NotReadable if linear ones are not, as `require_solved` does.

        Newton's method with the Jacobian of the last iterate squares an error, times the nonlinearity of f. With a
        fixed Jacobian or none, an error is multiplied by a change of h f', which is proportional to the nonlinearity.
        Thus k iterations leave an error like the power 2^k - 1 of the nonlinearity in the first case, k in the second.
        A solver that checks its residual makes more calls if more is left; one that always makes the same number does
        not check.
        """
        linear = max(self.require_solved(control) for control in CONTROLS)
        errors, counted = self._by_strength(curved=True)
        clear = [error for error in errors if error > self.reading.rounding.of(4.0)]
        power = _power(clear) or NO_POWER
        return StageSolution(linear, max(errors), power if counted and clear else 0)

    def require_solved(self, control: Control) -> float:
        """The error left in linear equations. Raises NotReadable if it is no error of a solver."""
        left, _ = self._left(control, _STRENGTHS[0], curved=False)
        if not left <= UNSOLVED:
            raise NotReadable(
                f"with {control.name}, the step is off by {left:.1e} from what the coefficients of its stages give: "
                f"{control.broken}, or its solver stops too early"
            )
        return left

    def require_solver(self) -> None:
        """Raise NotReadable for an explicit step: linear equations are off, and no more calls are made for them."""
        errors, counted = self._by_strength(curved=False)
        if counted and max(errors) > _BY_DIFFERENCES * float(self.reading.format.u) ** 0.5:
            raise NotReadable(
                f"linear stage equations are off by {max(errors):.1e} after as many calls as simpler ones: they are "
                "not solved, so the step is explicit, or not made of its stages"
            )

    def _by_strength(self, *, curved: bool) -> tuple[list[float], bool]:
        """The errors for each strength, and whether each takes as many calls as an f that hardly depends on y."""
        runs = [self._left(_VARIED, s, curved=curved) for s in _STRENGTHS]
        _, calls = self._left(_VARIED, _WEAK, curved=curved)
        return [error for error, _ in runs], all(made == calls for _, made in runs)

    def _left(self, control: Control, strength: float, *, curved: bool) -> tuple[float, int]:
        """How far the step is off our own iteration, relative to the size of its numbers; how many calls it makes."""
        h, largest = control.h, max(fsum(map(abs, row)) for row in self.reading.a)
        # From 1/4 to 64: a limit or an error control that does not act at one size acts at another.
        size = 1.0 if curved else 4.0 ** (control.salt - 2)
        weight = (strength if curved else 2 * strength) / (abs(h) * max(1.0, largest))

        def rates(node: float | None, moved: Sequence[float]) -> list[float]:
            clock = 1 / (1 + (node or 0.0) ** 2)
            following = moved if self.steps.alone else [*moved[1:], moved[0]]
            drawn = [0.75 * x - 0.25 * y + curved * x * y for x, y in zip(moved, following, strict=True)]
            return [size * (1 / (1 + i) - clock / 2) + weight * clock * x for i, x in enumerate(drawn)]

        run = self.steps.smooth(Setting(control.start, control.time, h), rates)
        reading, still = self.reading, [0.0] * self.steps.size
        nodes = reading.c or (None,) * reading.calls
        slopes = lambda i, moved, part: rates(nodes[i], moved)
        said, _ = step_by_iteration((reading.a,), (reading.b,), slopes, still, h, _ROUNDS)
        gaps = [x - control.start - y for x, y in zip(run.result, said, strict=True)]
        return max(map(abs, gaps)) / max(1.0, abs(control.start), *map(abs, said)), len(run.nodes)


# The slopes of each function at each stage.
_Slopes: TypeAlias = Sequence[Sequence[Sequence[Any]]]


def advanced(
    y: Sequence[Any], h: Any, rows: Sequence[Sequence[Any]], slopes: _Slopes, total: Callable[..., Any] = fsum
) -> list[Any]:
    """The numbers y + h Σ w k, with a row of weights for each function; slopes that are not known yet are left out."""
    terms = [pair for row, known in zip(rows, slopes, strict=True) for pair in zip(row, known, strict=False)]
    return [x + h * total(w * k[i] for w, k in terms) for i, x in enumerate(y)]


def step_by_iteration(
    tables: Sequence[Sequence[Sequence[Any]]],
    weights: Sequence[Sequence[Any]],
    slopes_at: Callable[[int, Sequence[Any], int], Sequence[Any]],
    y: Sequence[Any],
    h: Any,
    rounds: int,
    settled: Callable[[_Slopes, _Slopes], bool] = eq,
    total: Callable[..., Any] = fsum,
) -> tuple[list[Any], bool]:
    """The end of a step whose stages are solved by fixed-point iteration from k = y, and whether they settled.

    Each function has a table A and a row b. `slopes_at` gives the slopes at stage i in a place, by the function with
    this number.
    """
    slopes: _Slopes = [[y] * len(row) for row in weights]
    done = False
    for _ in range(rounds):
        before = slopes
        places = [advanced(y, h, rows, slopes, total) for rows in zip(*tables, strict=True)]
        slopes = [[slopes_at(i, place, part) for i, place in enumerate(places)] for part in range(len(tables))]
        if done := settled(slopes, before):
            break
    return advanced(y, h, weights, slopes, total), done


def _power(errors: Sequence[float]) -> int:
    """The whole power with which the last errors fall as the strength is halved; NO_POWER if there is none."""
    slopes = [log2(x / y) for x, y in pairwise(errors)][-2:]
    powers = {round(slope) if abs(slope - round(slope)) <= _SLACK else NO_POWER for slope in slopes}
    return powers.pop() if len(powers) == 1 else NO_POWER
