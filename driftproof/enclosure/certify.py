"""Proved errors of a float trajectory: the true solution is enclosed at the same times, and subtracted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import inf
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Refused, in_bits
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.certificate import BallRows, Certificate, Split, decimal, right_digits
from driftproof.enclosure.fields.fields import WRITTEN, RightHandSide, enclosable
from driftproof.enclosure.fields.text_fields import GivenField, given_field, right_hand_side
from driftproof.enclosure.invariants import GivenInvariants, drift_of, invariants_of
from driftproof.enclosure.problem_tables import GivenParameters, GivenTable, given_problem
from driftproof.enclosure.reproduction import require_reproduced_between
from driftproof.enclosure.runs.exact_runs import NotItsSteps, Row, StepPlan, plan_of, unchecked_intervals
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST, Enclosure, enclose_solution
from driftproof.enclosure.trajectories import Trajectory, failure_of, has_trajectory, read_trajectory, trajectory_of
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.rationals import ExactNumber
from driftproof.methods.schemes import Method
from driftproof.support.assertions import AssertedVerdict, assert_verdict
from driftproof.support.progress import stage, working
from driftproof.symbolic.algebra.certified import enclose

MOST_DOUBLINGS = 4
# A radius is small if it is 2⁻⁴⁰ of the largest error, which leaves twelve digits; or, for trajectories without error,
# 2⁻¹⁰⁴ of the solution, which is twice as many digits as a double has.
RADIUS_TO_ERROR, RADIUS_TO_SOLUTION = arb(2) ** -40, arb(2) ** -104
# Bits of the first exact run of a method, and of the last: balls of a plain run widen by some bits in each step, and a
# run whose balls are as wide as the solution ends there, so that the attempts together cost twice the last one.
BITS_OF_EXACT_RUN, MOST_BITS_OF_EXACT_RUN = 256, 2**16
# A first row that is off a problem's start by more than this part of it is no rounding of it to some digits.
ANOTHER_START = Fraction(1, 10**4)
# If twice the bits lead further by less than this part of the whole time, f is the obstacle and not the precision.
FURTHER = Fraction(1, 1000)
_WRITES = "f writes into its y, from which a solver may go on; the solution that is enclosed does not"


@working("certify")
@in_bits(BITS_AT_FIRST)
def certify(
    f: Any,
    t: Any = None,
    y: Any = None,
    *,
    parameters: GivenParameters = (),
    method: str | Path | Method | None = None,
    h: ExactNumber | None = None,
    invariants: GivenInvariants = (),
) -> Certificate:
    """Enclose the error of a float trajectory of y' = f(t, y) from any solver, with a row y[i] for each time t[i].

    t and y may be replaced by a solver's result, also as the first argument: an object with .t and .y, a column for
    each time (SciPy's), or with .ts and .ys, a row for each time (diffrax's); or by the path of a .csv, .txt, .dat,
    .npz or .npy file. f is run unchanged on balls, and on series of balls. If it is text, such as "y1; -sin(y0)", or
    the path of a .toml file, its numbers are exact. A .toml file, or a dict of its contents, may have a function
    instead; a run with another start or end than the file's is told so. `parameters` replace those of the file or the
    dict, or are keywords of the function. Raises Refused if nothing can be proved, and ValueError for bad input, such
    as an unknown method, h without a method, or an f of another number of components. Of a run that is not of the
    method the Refused is a NotItsSteps, and its `total` the certificate of the error, which is not split.

    `method` splits the error into those of the method and of rounding: a key of the catalogue, a .toml file, or RK23,
    RK45, DOP853 as SciPy has them. Its steps lead from point to point or, if the points are only some multiples of h,
    have the size h. `invariants` are first integrals whose drift is enclosed as well: functions of y or texts by name,
    or names in `FIRST_INTEGRALS`.

    >>> from driftproof import certify
    >>> found = certify(lambda t, y: -y, [0.0, 0.5, 1.0], [[1.0], [0.6065], [0.3679]])
    >>> print(found)
    largest error 3.065971263e-5, proved: component 0 at t = 0.5, point 1 of 0 to 2
    4 correct digits at every point, relative to its largest component; enclosure: 1 steps, 128 bits
    """
    if y is None and has_trajectory(f) and not has_trajectory(t):
        f, t = t, f
    given = given_problem(f, parameters)
    field = given_field(given.f)
    unknowns = field.unknowns if isinstance(field, VectorField) else ()
    run = read_trajectory(Path(t), unknowns) if y is None and isinstance(t, str | Path) else trajectory_of(t, y)
    if h is not None and method is None:
        raise ValueError("h has no effect without method")
    f = right_hand_side(field, len(run.states[0]))
    functions = invariants_of(invariants, field, len(run.states[0]))
    require_reproduced_between(f, enclosable(f), run.times, run.states)
    WRITTEN.set(False)
    try:
        found, off = _certified(f, run, functions, lambda: None if method is None else plan_of(f, run, method, h))
    except Refused as refusal:
        raise Refused(f"{refusal}; {_WRITES}", refusal.t) if WRITTEN.get() else refusal from None
    said = "\n".join(filter(None, [run.said, _WRITES if WRITTEN.get() else "", *_unlike(given, run)]))
    found = replace(found, unknowns=unknowns, said=said)
    if off is not None:
        raise type(off)(f"{off}; {found.text().splitlines()[0]}", found)
    return found


def _certified(
    f: RightHandSide,
    run: Trajectory,
    functions: Mapping[str, Callable[[Any], Any]],
    planned: Callable[[], StepPlan | None],
) -> tuple[Certificate, NotItsSteps | None]:
    """The certificate of a run, with what a plan splits, and the drifts of the `functions`. Raises Refused.

    If the run is not of the planned steps, its total error is certified, and the refusal of the split is the second.
    """
    plan, split, off = None, None, None
    try:
        plan = planned()
    except NotItsSteps as refusal:
        off = refusal
    try:
        enclosed = _enclosed(f, run, () if plan is None else plan.starts)
    except Refused as refusal:
        if off is None:
            raise
        raise type(off)(f"{off}; {refusal}") from None
    true = dict(zip(enclosed.times, enclosed.states, strict=True))
    errors = _errors(run, enclosed)
    try:
        split = None if plan is None else _split(plan, run, true)
    except NotItsSteps as refusal:
        off = refusal
    on_time = [true[t] for t in run.exact_times]
    with in_bits(enclosed.bits):
        digits = tuple(right_digits(*each) for each in zip(errors, on_time, strict=True))
    with in_bits(max(enclosed.bits, split.bits if split else 0)):
        exact = split.states if split else None
        drifts = {name: drift_of(name, each, run.states, on_time, exact) for name, each in functions.items()}
    points = tuple(run.times), tuple(map(tuple, run.states))
    found = Certificate(*points, errors, digits, enclosed.bits, enclosed.steps, enclosed.doubles, split, drifts)
    return replace(found, unsplit="" if off is None else str(off)), off


def _unlike(given: GivenTable, run: Trajectory) -> list[str]:
    """What tells that the run is not the whole solution of the problem that is given with a start and an end."""
    (first, *_, last), row, said, start = run.times, run.states[0], list[str](), given.start or ()
    allowed = ANOTHER_START * max(map(abs, start), default=0)
    alike: Callable[[Any, Any], bool] = lambda a, b: all(
        abs(Fraction(x) - y) <= allowed for x, y in zip(a, b, strict=False)
    )
    if start and first != 0:
        said.append(f"the run starts at t = {first:g}, the problem at 0")
    elif not alike(row, start):
        exchanged = ": are columns exchanged?" if alike(sorted(row), sorted(start)) else ""
        shown = (", ".join(f"{float(x) + 0:g}" for x in state) for state in (row, start))
        said.append(f"the run starts from {', the problem from '.join(shown)}{exchanged}")
    if given.end is not None and last < given.end * (1 - ANOTHER_START):
        said.append(f"the run ends at t = {last:g}, the problem at {float(given.end):g}")
    return said


def _enclosed(f: RightHandSide, run: Trajectory, more: Sequence[Fraction]) -> Enclosure:
    """The solution at the run's times and at `more`, with enough bits for a small radius. Raises Refused."""
    exact = run.exact_times
    bits, reached = BITS_AT_FIRST, exact[0]
    times = exact if more in ((), tuple(exact)) else sorted({*exact, *more})  # a run that slides has very many
    for last in (*[False] * MOST_DOUBLINGS, True):
        try:
            enclosed = enclose_solution(f, [Fraction(x) for x in run.states[0]], times, bits)
            if _is_small(_errors(run, enclosed), enclosed.states):
                return enclosed
        except Refused as refusal:
            if last or refusal.t is None or refusal.t <= reached + FURTHER * (exact[-1] - exact[0]):
                raise
            reached = refusal.t
        bits *= 2
    raise Refused(f"the error cannot be computed to twelve digits with {bits // 2} bits")


def _split(plan: StepPlan, run: Trajectory, true: Mapping[Fraction, Row]) -> Split:
    """The exact run minus the solution, and the float run minus the exact one. Raises Refused."""
    bits, reason = BITS_OF_EXACT_RUN, ""
    while bits <= MOST_BITS_OF_EXACT_RUN:
        try:
            with stage(f"the exact run of {plan.method.key} in {bits} bits"):
                rows = plan.states(run.states[0], bits)
        except Refused as refusal:  # a ball may have been too wide for f
            reason, bits = f": {refusal}", 2 * bits
            continue
        with in_bits(bits):
            truncation = _differences(rows, [true[t] for t in plan.starts])
            shifted = [
                [x - y for x, y in zip(true[a], true[b], strict=True)] if a != b else [arb(0)] * len(true[a])
                for a, b in zip(plan.starts, run.exact_times, strict=True)
            ]
            rounding = tuple(
                tuple(arb(x) - z + d for x, z, d in zip(*each, strict=True))
                for each in zip(run.states, rows, shifted, strict=True)
            )
        if _is_small(rounding, rows):
            run_of = plan.method.key, tuple(rows), truncation, rounding, sum(plan.counts), bits
            with in_bits(bits), stage(f"checking the steps of {plan.method.key}"):
                return Split(*run_of, not plan.method.explicit, unchecked_intervals(plan, run, rows))
        reason, bits = "", 2 * bits
    raise Refused(f"the exact run of {plan.method.key} cannot be found to twelve digits with {bits // 2} bits{reason}")


def assert_accurate(
    solution: Any,
    f: GivenField,
    tolerance: float | Sequence[float],
    *,
    rtol: float | None = None,
    atol: float = 0.0,
) -> None:
    """Assert that no component of a numerical solution of y' = f(t, y) is off by more than `tolerance` at any point.

    For components of different size give a tolerance for each, in a list.

    The errors are those against the true solution through the first point: what was lost before that point, for example
    if SciPy's `t_eval` leaves out the start, is not seen.
    Raises AssertionError with the point whose error is the largest multiple of its tolerance, and with that error, or
    if SciPy says that its solver failed; and Refused if nothing can be proved. `solution` is what `certify` takes, or a
    pair (t, y). If the `rtol` and `atol` of the solver are given, the message compares the error with what they
    promise, which is only the error of one step.

    >>> from driftproof import assert_accurate
    >>> rows = [0.0, 0.5, 1.0], [[1.0], [0.6065], [0.3679]]
    >>> assert_accurate(rows, lambda t, y: -y, 1e-4)
    >>> assert_accurate(rows, lambda t, y: -y, 1e-5, rtol=1e-5)
    Traceback (most recent call last):
    driftproof.support.assertions.VerdictError: off by 3.065971263e-5, more than 1e-05: component 0 at t = 0.5, point 1 of 0 to 2 (proved)
    rtol = 1e-05 allows an error of 6.07e-06 per step there; the error is 5.06 times that
    """  # noqa: E501
    __tracebackhide__ = True  # pytest shows the user's line, and the message
    if failed := failure_of(solution):
        assert_verdict(AssertedVerdict("the solution", "is of a solver that failed", False, failed), holds=False)
    found = certify(f, *solution) if isinstance(solution, tuple | list) else certify(f, solution)
    beyond = [each for each in _with_tolerances(found, tolerance) if not within(*each[:2])]
    if not beyond:
        where = f"at each of its {len(found.t)} points"
        words = f"is, {where}, within {tolerance} of the true one that starts at the first (proved)"
        assert_verdict(AssertedVerdict("the solution", words, True, found.text()), holds=True)
        return
    worst = max(beyond, key=lambda each: float(each[0].largest_error) / each[1] if each[1] else inf)
    part, allowed, (i, j) = worst
    said = f"off by {decimal(part.largest_error)}, more than {allowed}: {found.place((i, j))} (proved)"
    if rtol is not None:
        promised = atol + rtol * abs(found.y[i][j])
        times = f"; the error is {float(part.largest_error) / promised:.3g} times that" if promised else ""
        allow = f"rtol = {rtol} and atol = {atol} allow" if atol else f"rtol = {rtol} allows"
        said += f"\n{allow} an error of {promised:.3g} per step there{times}"
    verdict = AssertedVerdict("the solution", f"is {said.partition(chr(10))[0]}", False, f"{said}\n{found.text()}")
    assert_verdict(verdict, holds=False, message=said)


def _with_tolerances(found: Certificate, tolerance: Any) -> list[tuple[Certificate, Any, tuple[int, int]]]:
    """The certificate, or that of each component, with its tolerance and the place of the largest error."""
    if not isinstance(tolerance, Sequence | np.ndarray) or isinstance(tolerance, str):
        return [(found, tolerance, found.worst)]
    columns = [tuple((x,) for x in column) for column in zip(*found.errors, strict=True)]
    if len(tolerance) != len(columns):
        raise ValueError(f"tolerance must be a number >= 0, or one for each of the {len(columns)} components")
    parts = [replace(found, errors=column) for column in columns]
    return [(part, allowed, (part.worst[0], j)) for j, (part, allowed) in enumerate(zip(parts, tolerance, strict=True))]


def within(found: Certificate, tolerance: float | Fraction) -> bool:
    """True if the largest error is at most the tolerance. Raises Refused if its ball is too wide, or ValueError."""
    if not (isinstance(tolerance, Real) and tolerance >= 0):
        raise ValueError(f"tolerance is {tolerance!r}; it must be a number >= 0")
    largest = found.largest_error
    bound = enclose(tolerance) if isinstance(tolerance, Fraction) else arb(float(tolerance))
    if not (largest <= bound or largest > bound):
        raise Refused(f"the largest error is {decimal(largest)}, too close to the tolerance {tolerance} to decide")
    return bool(largest <= bound)


def _errors(run: Trajectory, enclosed: Enclosure) -> BallRows:
    true = dict(zip(enclosed.times, enclosed.states, strict=True))
    with in_bits(enclosed.bits):
        return _differences(run.states, [true[t] for t in run.exact_times])


def _differences(rows: Sequence[Sequence[float | arb]], others: Sequence[Row]) -> BallRows:
    return tuple(tuple(arb(x) - y for x, y in zip(*pair, strict=True)) for pair in zip(rows, others, strict=True))


def _is_small(errors: Sequence[Row], solution: Sequence[Row]) -> bool:
    """True if the radius of the errors is small relative to the largest error, or to the solution."""
    radius, largest, whole = (
        size(x for row in rows for x in row)
        for rows in ([[error.rad() for error in row] for row in errors], errors, solution)
    )
    return bool(radius <= RADIUS_TO_ERROR * largest or radius <= RADIUS_TO_SOLUTION * whole)
