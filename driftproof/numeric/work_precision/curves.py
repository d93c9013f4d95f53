"""Errors of methods on a problem, and the evaluations that they take, while the number of steps doubles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cache, partial
from itertools import dropwhile, pairwise, takewhile
from math import hypot, inf, lcm, log2
from statistics import median
from typing import TypeAlias

from driftproof.methods.catalogue import Entry
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.numeric.advance import error_summary, field_rate
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import ENDS, STATE, Size, branch_remark, doubt, errors, largest_state_size
from driftproof.numeric.steps.multistep import start_of
from driftproof.numeric.work_precision.integrators import COMPILED_FROM, Integrator, has_numba, integrator

# The numbers of steps with which doubling starts and ends; implicit methods, in Python, get less far.
FEWEST, MOST, MOST_IMPLICIT = 8, 2**20, COMPILED_FROM
# For a goal an implicit method is run with up to so many, compiled; and the fewest are found to within a part NEAR.
MOST_FOR_GOAL, NEAR = 2**16, 1 / 16
# Where f changes at a time, errors depend on where the steps around it fall: on the remainder of their number, if that
# has no more values than this. Else as many numbers up to the next doubling are tried: where a tenth of them are worse,
# all are good by chance in one case of twelve.
SPREAD = 24
# Numbers of steps that would have to be multiples of more than this land on the last of the reference's times only.
LARGEST_UNIT = 64
# A curve ends after this many points whose whole error rounding may explain: its floor (chosen: one may be luck).
FLOOR_POINTS = 3
# A point counts if its error is more than ABOVE times its doubt. The method's own error is then within 1/32 of what is
# seen, and a slope over a doubling within log2(33/31) = 0.09 of the method's own.
ABOVE = 32
# The number of finest slopes that an order is read from.
SLOPES = 3
# What the remark of a run that was not made begins with.
NOT_RUN = "not run"
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
    between: bool = False  # not one of the doublings that an order is read from, but run for a goal

    @property
    def error(self) -> float:
        """The error of the state at the end; infinite if there is none."""
        return self.errors[STATE].final if self.errors else inf


_Beside: TypeAlias = Callable[[int], Sequence[int]]


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
    def unsettled(self) -> str:
        """Why the measured order is not settled, in words; "" if it is."""
        if self.against is not Against.NOT_SETTLED or not (found := self.order):
            return ""
        if found.largest - found.least >= 1:
            return "its last slopes lie a whole order or more apart, as where steps are long or errors change sign"
        if found.slopes < SLOPES:
            return f"only {found.slopes} slope{'s' * (found.slopes > 1)} could be taken, and three are needed"
        return "its error fell as claimed, and then stays"

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
    """The points, finest first, whose error is at most `goal`, up to a run that misses it by more than rounding may.

    A run that is coarser than that is good by chance, as where a step is a period of the force. Rounding may explain
    an error of up to ABOVE times the doubt, from which no order is read: one of 1/N is larger for N below 10⁷. A point
    for a goal that was looked at less often than any other, as where its steps miss the reference's times, has no
    largest error on the way.
    """
    if which != "final":
        enough = min((point.errors[STATE].looks for point in points if point.errors and not point.between), default=0)
        points = [point for point in points if not point.errors or point.errors[STATE].looks >= enough]
    made = dropwhile(lambda point: not point.errors, reversed(points))
    sizes = [(point, getattr(point.errors[STATE], which) if point.errors else inf) for point in made]
    good = takewhile(lambda each: each[0].error < each[0].scale and each[1] <= max(goal, ABOVE * each[0].doubt), sizes)
    return [point for point, size in good if size <= goal]


def _unit(problem: Problem) -> int:
    """The least number whose multiples, as numbers of steps, land on all of the reference's times; 1 if it is large."""
    unit = lcm(*((t / problem.t).denominator for t in problem.reference.times))
    return unit if unit <= LARGEST_UNIT else 1


def step_counts(problem: Problem, most: int = MOST) -> tuple[int, ...]:
    """Numbers of steps from FEWEST to `most`, each twice the previous one, that land on the reference's times.

    They are multiples of the common denominator of tᵢ/t. If that is above LARGEST_UNIT they land on t, and on those
    other times that happen to be whole numbers of steps.
    """
    unit = _unit(problem)
    first = unit * -(-FEWEST // unit)
    doubled = (first << i for i in range(most.bit_length()))
    return tuple(steps for steps in doubled if steps <= most)


def for_goal(curve: Curve, method: Entry, problem: Problem, goal: float) -> list[Point]:
    """The points of a compiled curve and those that a goal asks for: longer runs up to one that meets it, the least.

    It is to be met at the end, and on the way. An implicit method, whose doublings end early, goes on for it.
    """
    points = [*curve.points]
    if curve.refused or not points:
        return points
    runs, unit = integrator(method, problem, compiled=True), 1 if problem.reference.dense else _unit(problem)
    run, beside = cache(partial(measured, problem, runs)), _beside(problem)
    for which in reversed(ENDS):
        looked = unit if which == "largest" else 1
        while True:
            points = _with_fewest(points, goal, which, run, looked, beside)
            *_, last = (point for point in points if not point.between)
            steps = 2 * (last.steps or MOST_FOR_GOAL)
            ended = last.error <= last.doubt or last.remark.startswith(NOT_RUN)
            if lasting(points, goal, which) or ended or method.explicit or steps > MOST_FOR_GOAL or not has_numba():
                break
            points.append(run(steps))
    return points


def with_points_for(goals: Sequence[float], refined: Callable[..., Sequence[Point]], curve: Curve) -> Curve:
    """The curve with the points that `refined`, such as `for_goal`, adds for the goals, and without those of others."""
    curve = replace(curve, points=[point for point in curve.points if not point.between])
    for goal in sorted(goals):
        curve = replace(curve, points=refined(curve, goal=goal))
    return curve


def _beside(problem: Problem) -> _Beside:
    """What is added to a number of steps, in units, for the runs that tell whether it is good by chance.

    Where f jumps at a third of the time, the error depends on the remainder of the number by 3.
    """
    if problem.field.smooth:
        return lambda steps: (1, 2)
    period = lcm(*((t / problem.t).denominator for t in problem.reference.changes))
    if 1 < period <= SPREAD:
        return lambda steps: range(1, period + 1)
    return lambda steps: [1, 2, *(1 + part * steps // (SPREAD + 1) for part in range(1, SPREAD + 1))]


def _with_fewest(
    points: Sequence[Point], goal: float, which: str, run: Callable[[int], Point], unit: int, beside: _Beside
) -> list[Point]:
    """The points, the run of the fewest multiples of `unit` that meets the goal, and those that tell that it does.

    They are found by bisection, to a part NEAR, below the fewest that meet it already; a coarser run that meets it by
    luck is not looked for. If one of those `beside` does not meet it, finer ones are looked for.
    """
    tried = [*points]
    while good := lasting(tried, goal, which):
        steps, at = good[-1].steps or 0, tried.index(good[-1])
        low = (tried[at - 1] if at else good[-1]).steps or 0
        after = [steps + unit * more for more in beside(steps // unit)]
        if steps - low >= max(2 * unit, NEAR * low):
            further = [(low + steps) // (2 * unit) * unit]
        elif not (further := [n for n in after if all(point.steps != n for point in tried)]):
            return [point for point in tried if point in points or point.steps in (low, steps, *after)]
        tried = sorted([*tried, replace(run(further[0]), between=True)], key=lambda point: point.steps or 0)
    return tried


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
            remark = f"{NOT_RUN}: about {expected:.2g} evaluations, but the limit is {most:.2g}"
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
