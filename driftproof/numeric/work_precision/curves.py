"""Errors of methods on a problem, and the evaluations that they take, while the number of steps doubles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise, takewhile
from math import hypot, inf, lcm, log2
from statistics import median

from driftproof.methods.catalogue import Entry
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.numeric.advance import error_summary, field_rate
from driftproof.numeric.multistep import start_of
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import STATE, Size, branch_remark, doubt, errors, largest_state_size
from driftproof.numeric.work_precision.integrators import COMPILED_FROM, Integrator, has_numba, integrator

# The numbers of steps with which doubling starts and ends; implicit methods, in Python, get less far.
FEWEST, MOST, MOST_IMPLICIT = 8, 2**20, COMPILED_FROM
# For a goal an implicit method is run with up to so many, compiled; and the fewest are found to within a part NEAR.
MOST_FOR_GOAL, NEAR = 2**16, 1 / 16
# Numbers of steps that would have to be multiples of more than this land on the last of the reference's times only.
LARGEST_UNIT = 64
# A curve ends after this many points whose whole error rounding may explain: its floor (chosen: one may be luck).
FLOOR_POINTS = 3
# A point counts if its error is more than ABOVE times its doubt. The method's own error is then within 1/32 of what is
# seen, and a slope over a doubling within log2(33/31) = 0.09 of the method's own.
ABOVE = 32
# The number of finest slopes that an order is read from.
SLOPES = 3
# An error of a smaller slope stays: that of a consistent method falls by half at each doubling.
STAYS = 0.5
# chosen: the weights of a table of decimals add up to 1 to more digits than this.
INCONSISTENT = 1e-8


@dataclass(frozen=True)
class Point:
    """One run of `steps` steps, or of an adaptive method at tolerance `setting`.

    `errors` has the names of `reference_errors.QUANTITIES` as keys. It is empty if `remark` says why: not finite, not
    solved, or not run because it would take too long; with errors a remark is the `branch_remark`. `doubt` and `scale`
    are `doubt` and `largest_state_size` of `reference_errors`.
    """

    setting: str
    evaluations: int | None
    errors: Mapping[str, Size] = field(default_factory=dict)
    doubt: float = 0.0
    scale: float = inf
    remark: str = ""
    steps: int | None = None
    between: bool = False  # not one of the doublings that an order is read from, but the cheapest run for a goal

    @property
    def error(self) -> float:
        """The error of the state at the end; infinite if there is none."""
        return self.errors[STATE].final if self.errors else inf


@dataclass(frozen=True)
class Order:
    """Median, least and largest of the finest SLOPES slopes of log error over log 1/N between neighbours that count."""

    median: float
    least: float
    largest: float
    slopes: int


class Against(Enum):
    """How a measured order stands against the claim; AGREES also if one of them is missing."""

    AGREES, BELOW, ABOVE, NOT_SETTLED = "", "below", "above", "not settled"


@dataclass(frozen=True)
class Curve:
    """The points of a method on a problem, N rising. `refused` says why there are none: the method does not apply.

    `started` is the key of the method that gives the first values of a multistep method.
    """

    key: str
    title: str
    claimed_order: int  # 0 if no order is claimed
    points: Sequence[Point] = ()
    refused: str = ""
    started: str = ""
    consistent: bool = True  # False if the weights of a step do not add up to 1: its error stays, however short

    @property
    def order(self) -> Order | None:
        """The measured order; None unless two neighbouring points count."""
        slopes = self._slopes[-SLOPES:]
        return Order(median(slopes), min(slopes), max(slopes), len(slopes)) if slopes else None

    @property
    def _slopes(self) -> list[float]:
        return [
            log2(coarse.error / fine.error) / log2(fine.steps / coarse.steps)
            for coarse, fine in pairwise([point for point in self.points if not point.between])
            if coarse.steps and fine.steps and counts(coarse) and counts(fine)
        ]

    @property
    def verdict(self) -> str:
        """How the measured order differs from the claim, in words; "" if it does not."""
        differs = f" the claimed order {self.claimed_order}" * (self.against in (Against.BELOW, Against.ABOVE))
        return self.against.value + differs

    @property
    def against(self) -> Against:
        """How the measured order differs from the claim: not if they agree to the nearest integer, or one is missing.

        Slopes that lie a whole order apart contradict no claim: they are "not settled", and so are fewer than SLOPES.
        So are those of an error that fell as claimed before and then stays, as where equal steps are too long for an
        initial layer.
        """
        found = self.order
        if found is None or not self.claimed_order:
            return Against.AGREES
        fell = [a + b for a, b in pairwise(self._slopes[: -found.slopes]) if a + b > 2 * self.claimed_order - 1]
        if found.largest - found.least >= 1 or (fell and self.consistent and found.largest < STAYS):
            return Against.NOT_SETTLED
        if round(found.median) == self.claimed_order:
            return Against.AGREES
        if found.slopes < SLOPES:
            return Against.NOT_SETTLED
        return Against.BELOW if found.median < self.claimed_order else Against.ABOVE


def counts(point: Point) -> bool:
    """True if the error shows the order: it is smaller than the solution and well above the floor.

    Rounding, and the reference's last digit, then explain no more than 1/ABOVE of it.
    """
    return point.scale > point.error > ABOVE * point.doubt


def lasting(points: Sequence[Point], goal: float, which: str = "final") -> list[Point]:
    """The points, finest first, whose error is at most `goal`, up to a run of more that is no matter of rounding.

    The error of a run that is coarser than that is small by chance, as where a step is a period of the force. A point
    for a goal that was looked at less often than any other, as where its steps miss the reference's times, has no
    largest error on the way.
    """
    if which != "final":
        enough = min((point.errors[STATE].looks for point in points if point.errors and not point.between), default=0)
        points = [point for point in points if point.errors and point.errors[STATE].looks >= enough]
    sizes = [(point, getattr(point.errors[STATE], which)) for point in reversed(points) if point.errors]
    good = takewhile(lambda each: each[0].error < each[0].scale and each[1] <= max(goal, each[0].doubt), sizes)
    return [point for point, size in good if size <= goal]


def step_counts(problem: Problem, most: int = MOST) -> tuple[int, ...]:
    """Numbers of steps from FEWEST to `most`, each twice the previous one, that land on the reference's times.

    They are multiples of the common denominator of tᵢ/t. If that is above LARGEST_UNIT they land on t, and on those
    other times that happen to be whole numbers of steps.
    """
    unit = lcm(*((t / problem.t).denominator for t in problem.reference.times))
    unit = unit if unit <= LARGEST_UNIT else 1
    first = unit * -(-FEWEST // unit)
    doubled = (first << i for i in range(most.bit_length()))
    return tuple(steps for steps in doubled if steps <= most)


def for_goal(curve: Curve, method: Entry, problem: Problem, goal: float) -> list[Point]:
    """The points of a compiled curve and those that a goal asks for: longer runs up to one that meets it, the least.

    Between a number of steps that meets the goal at the end and half of it the fewest are found by bisection, to a part
    NEAR. Finer runs meet it, too; a coarser one that does so by luck is not looked for.
    """
    points = [point for point in curve.points if not point.between]
    if curve.refused or not points:
        return points
    runs = integrator(method, problem, compiled=True)
    while not lasting(points, goal) and (steps := 2 * (points[-1].steps or MOST_FOR_GOAL)) <= MOST_FOR_GOAL:
        if method.explicit or not points[-1].errors or not has_numba() or points[-1].error <= points[-1].doubt:
            break
        points.append(measured(problem, runs, steps))

    def fewest(coarser: Point, found: Point) -> Point:
        low = coarser.steps or 0
        while (found.steps or 0) - low >= max(2, NEAR * low):
            middle = (low + (found.steps or 0)) // 2
            tried = measured(problem, runs, middle)
            found, low = (tried, low) if lasting([tried], goal) else (found, middle)
        return found

    return with_cheapest(points, goal, fewest)


def with_cheapest(points: Sequence[Point], goal: float, cheapest: Callable[[Point, Point], Point]) -> list[Point]:
    """The points with cheapest(coarser, met) between the coarsest that meets the goal and the one before it.

    Those between that belong to another goal are left out.
    """
    doubled = [point for point in points if not point.between]
    if not (met := lasting(doubled, goal)) or met[-1] is doubled[0]:
        return doubled
    at = doubled.index(met[-1])
    found = cheapest(doubled[at - 1], doubled[at])
    return doubled if found is doubled[at] else [*doubled[:at], replace(found, between=True), *doubled[at:]]


def curve_of(
    method: Entry, problem: Problem, steps: Sequence[int] | None = None, *, compiled: bool = False, most: float = inf
) -> Curve:
    """The errors and evaluations of one method, a point for each number of steps. Raises ValueError.

    `steps` rise; by default they are the `step_counts` of the problem. A method that does not apply has a curve without
    points, which says why. `compiled` runs by numba, if it is installed: the same numbers, sooner for many steps. A run
    that should take more than `most` evaluations is not made, see `measure_curve`.
    """
    claim = (method.key, method.title, method.claimed_order)
    weights = isinstance(method, RungeKutta) and abs(sum(map(float, method.b)) - 1) > INCONSISTENT
    try:
        runs = integrator(method, problem, compiled=compiled)
    except MethodError as error:
        return Curve(*claim, refused=str(error))
    steps_of_runs = steps or step_counts(problem, MOST if method.explicit else MOST_IMPLICIT)
    points = measure_curve(problem, runs, steps_of_runs, most)
    return Curve(
        *claim, points, started=start_of(method).key if isinstance(method, Multistep) else "", consistent=not weights
    )


def measure_curve(problem: Problem, runs: Integrator, steps_of_runs: Sequence[int], most: float = inf) -> list[Point]:
    """The points of one method, until FLOOR_POINTS of them are at the floor.

    A run that should take more than `most` evaluations, going by the previous run, is not made, and neither are longer
    ones: its point says so. Nothing is decided by a clock, so that every machine, busy or not, has the same points.
    """
    found, at_floor, of_a_step = list[Point](), 0, 0.0
    for steps in steps_of_runs:
        if (expected := of_a_step * steps) > most:
            remark = f"not run: about {expected:.2g} evaluations, but the limit is {most:.2g}"
            found.append(Point(str(steps), None, remark=remark, steps=steps))
            break
        found.append(measured(problem, runs, steps))
        of_a_step = (found[-1].evaluations or 0) / steps
        at_floor += found[-1].error <= found[-1].doubt
        if at_floor == FLOOR_POINTS:
            break
    return found


def measured(problem: Problem, runs: Integrator, steps: int) -> Point:
    """The point of a run of `steps` steps."""
    try:
        run = runs.run(steps)
        sizes = errors(problem, run.states, run.way)
    except (ArithmeticError, ValueError) as error:  # math.log of a negative number is a ValueError
        return Point(str(steps), None, remark=error_summary(error), steps=steps)
    unsure, remark = doubt(problem, steps, speed(problem)), branch_remark(problem, run.run, sizes[STATE].final)
    return Point(str(steps), run.evaluations, sizes, unsure, largest_state_size(problem), remark, steps)


def speed(problem: Problem) -> float:
    """‖f(t, y(t))‖ at the end of the problem, in floats."""
    last = [float(x) for x in problem.reference.states[-1]]
    return hypot(*field_rate(problem.field)(float(problem.t), last))
