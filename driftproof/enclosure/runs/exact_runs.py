"""The exact run of a method, in balls: the same start and the same steps as a float run, without rounding."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

from flint import arb

from driftproof.enclosure.arithmetic.array_functions import array_of
from driftproof.enclosure.arithmetic.clocks import exact_time
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused, in_bits
from driftproof.enclosure.arithmetic.numbers import Enclosed, size
from driftproof.enclosure.fields.fields import RightHandSide, enclosable, enclosed_rates, linearised
from driftproof.enclosure.runs.implicit_runs import implicit_step, rational_nodes
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST
from driftproof.enclosure.trajectories import Trajectory
from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.numbers.rationals import ExactNumber
from driftproof.methods.programs.explicit_steps import array_step
from driftproof.methods.schemes import Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import enclose

# SciPy's explicit solvers, and the methods whose coefficients they hold as doubles.
SCIPY_SOLVERS = {"RK23": "bogacki_shampine32", "RK45": "dormand_prince54", "DOP853": "dop853"}
# A time may be off its multiple of h by this part of h, as it is if times are summed up in floats.
_OFF_GRID = Fraction(1, 1000)
# A float step passes for the method's if it is off the exact one by at most this many roundings of y, h f, h ∂f/∂y y:
# a step of 13 stages has some hundred operations, and f its own. This detects another method, or points that are not
# steps, and bounds nothing.
ROUNDINGS_OF_A_STEP = 2.0**10
# The same for an implicit method, whose stages a solver solves to at least half of the digits.
UNSOLVED_STAGES = 2.0**27
# SciPy's Radau stops Newton's method at min(0.03, sqrt(rtol)) (atol + rtol |y|): what is left may be as much as that,
# with the default rtol or a smaller one. It is no allowance: steps of other methods are as near.
LOOSEST_NEWTON, LOOSEST_RTOL = 0.03, 1e-3
# The number of steps that are checked before the solution is enclosed, evenly spread.
MOST_LOOKED_AT = 64
# An interval in which rounding may grow to more than this part of the state is not told from steps of another method
# (chosen: six digits).
LEAST_TELLING = 2.0**-20
# These take some four minutes with a method of four stages.
MOST_STEPS_EXACTLY = 10**6

Row = tuple[arb, ...]


class NotItsSteps(Refused):
    """Points of a run are off the steps of the method by more than rounding; `total` certifies its error if it can."""

    def __init__(self, message: str, total: Any = None) -> None:
        super().__init__(message)
        self.total = total


class PerhapsItsSteps(NotItsSteps):
    """Points are off the steps of Radau IIA by no more than what SciPy's Radau may leave of Newton's method."""


@dataclass(frozen=True)
class StepPlan:
    """A method and its steps: `counts[i]` steps of the size `sizes[i]` lead from point i to the next.

    `f` is the right-hand side for balls. `starts` are the exact times of the points.
    """

    f: RightHandSide
    method: Method
    starts: tuple[Fraction, ...]
    counts: tuple[int, ...]
    sizes: tuple[Fraction, ...]

    def states(self, start: Sequence[float], bits: int) -> list[Row]:
        """The exact run at each point, in balls of `bits` bits. Raises Refused if one is as wide as the solution."""
        with in_bits(bits):
            step = exact_step(self.method, self.f, len(start))
            y: Row = tuple(arb(x) for x in start)
            found, largest = [y], size(y)
            for t, n, h in zip(self.starts, self.counts, self.sizes, strict=False):
                for k in range(n):
                    y = step(y, t + k * h, h)
                largest = largest.max(size(x.mid() for x in y))
                if not size(x.rad() for x in y) <= largest or not largest.is_finite():
                    raise Refused(f"the exact run of {self.method.key} is not finite after t = {float(t):.9g}")
                found.append(y)
            return found


def plan_of(f: RightHandSide, run: Trajectory, method: str | Path | Method, h: ExactNumber | None = None) -> StepPlan:
    """The steps of the run: from each point to the next or, given h, of size h between points at multiples of h.

    Raises NotItsSteps if some that are looked at first are not of the method; `unchecked_intervals` asks of all.
    """
    found, times = named_method(method), run.exact_times
    if h is None:
        starts, counts, sizes = times, [1] * (len(times) - 1), [b - a for a, b in pairwise(times)]
    else:
        try:
            exact = Fraction(h)
        except (ValueError, OverflowError, ZeroDivisionError):  # NaN, infinity, or no number
            exact = Fraction(0)
        if exact <= 0:
            raise Refused(f"h is {h}; it must be positive and finite")
        at = [round((t - times[0]) / exact) for t in times]
        starts = [times[0] + n * exact for n in at]
        for i, (t, given) in enumerate(zip(starts, times, strict=True)):
            if abs(t - given) > _OFF_GRID * exact:
                raise Refused(f"t[{i}] = {run.times[i]} is not the first time plus a multiple of h = {float(exact)!r}")
        counts, sizes = [b - a for a, b in pairwise(at)], [exact] * (len(at) - 1)
    if 0 in counts:
        raise Refused(f"two of the times are the same multiple of h = {float(sizes[0])!r}")
    if sum(counts) > MOST_STEPS_EXACTLY:
        raise Refused(f"{sum(counts)} steps are too many to run exactly; at most {MOST_STEPS_EXACTLY}")
    plan = StepPlan(enclosable(f), found, tuple(starts), tuple(counts), tuple(sizes))
    with in_bits(BITS_AT_FIRST):  # with a double's bits, balls widen too far where coefficients cancel
        unchecked_intervals(plan, run)
    return plan


def named_method(method: str | Path | Method) -> Method:
    """A method of the catalogue or of a file, or SciPy's RK23, RK45, DOP853 with its doubles. Raises ValueError."""
    if method in SCIPY_SOLVERS:
        return in_doubles(method_of(SCIPY_SOLVERS[str(method)]), str(method))
    if method in ("BDF", "LSODA"):
        raise ValueError(f"SciPy's {method} changes its formula between steps and cannot be run exactly; omit method")
    return method_of(method)


def in_doubles(method: Method, key: str) -> RungeKutta:
    """The method with each coefficient rounded to the nearest double, as in a program."""
    assert isinstance(method, RungeKutta)

    def double(x: Exact) -> Fraction:
        return Fraction(float(Fraction(x)))  # type: ignore[arg-type]

    rows = tuple(tuple(map(double, row)) for row in method.a)
    embedded = None if method.b_embedded is None else tuple(map(double, method.b_embedded))
    b, c = tuple(map(double, method.b)), tuple(map(double, method.c))
    return replace(method, key=key, a=rows, b=b, c=c, b_embedded=embedded)


def exact_step(method: Method, f: RightHandSide, components: int) -> Callable[[Row, Fraction, Fraction], Row]:
    """A function step(y, t, h) -> y₁ in balls: the program text of the method, or solved stages if it is implicit.

    Splittings and Nyström methods take y = (q, v); the acceleration is the second half of f, at velocity 0.
    """
    if not method.explicit:
        return implicit_step(method, f, components)
    half, nodes, known = components // 2, rational_nodes(method), list[tuple[Fraction, arb]]()

    def rates(t: arb, y: Any) -> Any:
        evaluation = Evaluation()
        state = [Enclosed(evaluation, x) for x in y]
        return array_of(arb(x.value) for x in enclosed_rates(f, exact_time(evaluation, t, known), state))

    if isinstance(method, RungeKutta):
        whole = array_step(method, rates, enclose)
    else:
        halves = array_step(method, lambda t, q: rates(t, [*q, *[arb(0)] * half])[half:], enclose)

    def step(y: Row, t: Fraction, h: Fraction) -> Row:
        known[:] = [(at, enclose(at)) for at in (t + c * h for c in nodes)]
        if isinstance(method, RungeKutta):
            return tuple(whole((array_of(y),), enclose(t), enclose(h))[0])
        q, v = halves((array_of(y[:half]), array_of(y[half:])), enclose(t), enclose(h))
        return (*q, *v)

    return step


def unchecked_intervals(plan: StepPlan, run: Trajectory, exact: Sequence[Row] = ()) -> tuple[int, ...]:
    """The intervals that may not be told from steps of another method, as rounding may have grown too much in them.

    Raises NotItsSteps if points are not the planned number of steps after the ones before, up to rounding. Given the
    rows of the `exact` run, every interval is checked, but for those at whose end the run is within one interval's
    rounding of it. Without them about `MOST_LOOKED_AT` steps are checked, evenly spread, and no interval of more steps
    than that.
    """
    step = exact_step(plan.method, plan.f, len(run.states[0]))
    per_step = float(run.unit) * (ROUNDINGS_OF_A_STEP if plan.method.explicit else UNSOLVED_STAGES)
    intervals, found, failed = len(plan.counts), list[int](), dict[int, tuple[arb, arb]]()
    most = intervals if exact else max(1, MOST_LOOKED_AT // max(plan.counts))
    off_by = partial(_off_by, run, step, per_step)

    def look_at(i: int, *, near: bool) -> None:
        y, after = (tuple(map(arb, state)) for state in run.states[i : i + 2])
        if not exact and isinstance(plan.method, Splitting | Nystrom):
            _require_second_order(plan.method, y, *_linearised_at(plan, plan.starts[i], y))
        sizes = size(y) + size(after)
        close = min(plan.counts[i] * per_step, LEAST_TELLING) * sizes
        far = size(x - z for x, z in zip(after, exact[i + 1], strict=True)) if exact and not near else arb(0)
        skipped = bool(far <= close) if exact and not near else plan.counts[i] > MOST_LOOKED_AT
        if skipped:
            return
        off, allowed = off_by(plan, i)
        if not off <= allowed:
            failed[i] = off, allowed
        elif not near and not (off <= close or allowed <= LEAST_TELLING * sizes):
            found.append(i)

    asked = {intervals * k // most for k in range(most)}
    try:
        for i in sorted(asked):
            look_at(i, near=False)
        if len(failed) <= 2:  # perhaps one point is off, between two intervals, or rows are missing
            beside = {j for i in failed for j in (i - 1, i + 1) if 0 <= j < intervals} - {*failed}
            asked |= beside
            for i in sorted(beside):
                look_at(i, near=True)
    except Refused:  # where a point is off, f may have no value
        if not failed:
            raise
    if failed:
        raise _not_its_steps(plan, run, dict(sorted(failed.items())), len(asked), off_by)
    return tuple(found)


def _linearised_at(plan: StepPlan, t: Fraction, y: Row) -> tuple[list[arb], list[list[arb]]]:
    return linearised(plan.f, exact_time(Evaluation(), enclose(t), [(t, enclose(t))]), y)


def _off_by(
    run: Trajectory, step: Callable[[Row, Fraction, Fraction], Row], per_step: float, plan: StepPlan, i: int
) -> tuple[arb, arb]:
    """How far a point is off the planned steps from the one before, and what is allowed: so many roundings in each.

    They grow by exp(h |J|), J at the start of each further step. No proof depends on it.
    """
    y, after = (tuple(map(arb, state)) for state in run.states[i : i + 2])
    h, allowed = plan.sizes[i], arb(0)
    for k in range(plan.counts[i]):
        t = plan.starts[i] + k * h
        rates, slopes = _linearised_at(plan, t, y)
        moved = [sum((abs(J * x) for J, x in zip(row, y, strict=True)), arb(0)) for row in slopes]
        if k:
            allowed *= (enclose(h) * size(sum(map(abs, row), arb(0)) for row in slopes)).exp()
        before, y = y, step(y, t, h)
        allowed += per_step * (size(before) + size(y) + enclose(h) * (size(rates) + size(moved)))
    return size(x - z for x, z in zip(after, y, strict=True)), allowed


def _steps_that_fit(plan: StepPlan, i: int, allowed: arb, off_by: Callable[[StepPlan, int], tuple[arb, arb]]) -> int:
    """The number of steps, as long as the one before, that fit in an interval as well as one should; or 0."""
    n = round(plan.sizes[i] / plan.sizes[i - 1]) if i else 0
    if not 1 < n <= MOST_LOOKED_AT or plan.counts[i] > 1:
        return 0
    off, _ = off_by(replace(plan, counts=(n,) * (i + 1), sizes=(plan.sizes[i] / n,) * (i + 1)), i)
    return n if off <= allowed else 0


def _not_its_steps(
    plan: StepPlan, run: Trajectory, failed: Mapping[int, tuple[arb, arb]], asked: int, off_by: Any
) -> NotItsSteps:
    """The refusal of points that are off the steps from those before by more than rounding may explain."""
    i, *others = failed
    (off, allowed), n, last = failed[i], plan.counts[i], i + 2 == len(run.times)
    left = float(off / size(map(arb, run.states[i])))
    rtol = max(left ** (2 / 3), left / LOOSEST_NEWTON)
    causes = "another method, another f or parameter, digits cut in a file, steps left out (give h), a stage at a jump "
    causes += "of f, or SciPy's t_eval"
    if asked > 2 and others == [i + 1]:
        causes = f"the others fit, as if y[{i + 1}] alone were changed"
    elif asked > 1 and not others and last:
        causes = "the others fit: if an event ended the run, leave out the last point"
    elif asked > 1 and not others and (steps := _steps_that_fit(plan, i, allowed, off_by)):
        causes = f"{steps} steps fit there, as if rows were missing"
    stopped = plan.method.key == "radau_iia3" and rtol <= LOOSEST_RTOL
    if stopped:
        causes += f", or SciPy's Radau stopped Newton's method early, as with rtol = {rtol:.1g}: take 1e-6 or less"
    return (PerhapsItsSteps if stopped else NotItsSteps)(
        f"y[{i + 1}] is not {'one step' if n == 1 else f'{n} steps'} of {plan.method.key} from y[{i}]: off by "
        f"{float(off):.2g}, where {float(allowed):.2g} is allowed for rounding (intervals that are off: {len(failed)} "
        f"of {asked} looked at): {causes}"
    )


def _require_second_order(
    method: Method, y: Sequence[arb], rates: Sequence[arb], slopes: Sequence[Sequence[arb]]
) -> None:
    half, odd = divmod(len(y), 2)
    positions = [rate - v for rate, v in zip(rates[:half], y[half:], strict=not odd)]
    of_velocity = [x for row in slopes[half:] for x in row[half:]]
    if odd or not all(x.is_zero() for x in (*positions, *of_velocity)):
        raise Refused(f"{method.key} needs y = (q, v) with q' = v and v' independent of v; f is not of this form")
