"""Measure error against work: first errors and evaluations of all runs, then times, in turns, stored as they come."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cache, partial
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

from driftproof import __version__
from driftproof.methods.catalogue import Entry
from driftproof.methods.schemes import MethodError
from driftproof.numeric.advance import State, error_summary
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import ENDS, Size, distance_from_digits, doubt, errors, largest_state_size
from driftproof.numeric.sweep import digest
from driftproof.numeric.work_precision import integrators
from driftproof.numeric.work_precision.curves import Curve, Point, curve_of, for_goal, lasting, speed, with_points_for
from driftproof.numeric.work_precision.timing import ROUNDS, SEED, Timing, interleave, needs_more_samples, started
from driftproof.reports.work_precision.peers import TOLERANCES, ControlledSolver, Peer, Solver
from driftproof.support.environment import machine_description, versions_of
from driftproof.support.kept import NotKept, keep, kept
from driftproof.support.progress import stage

# The evaluations that a run for errors, made once, may take per second of the time limit: ten times as many as compiled
# code makes in a second. For solvers see `peers.Solver.once`.
ONCE = 10**8
EVALUATIONS = "evaluations"
Say: TypeAlias = Callable[[str], object]
# progress(more, done), for a progress bar: how many more points are expected, and how many have been done.
Progress: TypeAlias = Callable[[int, int], object]


@dataclass
class Measured:
    """What has been measured so far.

    The keys of `curves` are methods, or peer and solver, as in "scipy DOP853", in the order asked for; those of
    `timings` are "curve | kind | setting". Those of `warm_up` and `absent` are "curve | kind": the seconds of the very
    first call, in which compilers compile, and why there are no times of that kind. `refined` are the errors wanted for
    which a curve has got its points.
    """

    curves: dict[str, Curve] = field(default_factory=dict)
    timings: dict[str, Timing] = field(default_factory=dict)
    warm_up: dict[str, float] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)
    refined: dict[str, list[float]] = field(default_factory=dict)

    def timed(self, curve: Curve, kind: str) -> dict[str, Timing]:
        """The timings of a curve by the settings of its points, without those that were not timed."""
        names = {point.setting: timing_name(curve.key, kind, point.setting) for point in curve.points}
        return {s: self.timings[n] for s, n in names.items() if n in self.timings and self.timings[n].samples}

    def costs(self, curve: Curve, cost: str) -> dict[str, float]:
        """The cost of a curve's points by setting: evaluations or, for a kind of time, the least seconds of a state."""
        if cost == EVALUATIONS:
            return {point.setting: point.evaluations for point in curve.points if point.evaluations}
        return {setting: per_state(cost, timing.best) for setting, timing in self.timed(curve, cost).items()}

    @property
    def kinds(self) -> list[str]:
        """The kinds of time with at least one timing."""
        return [kind for kind in integrators.KINDS if any(self.timed(curve, kind) for curve in self.curves.values())]


def timing_name(*parts: str) -> str:
    """The key of a timing."""
    return " | ".join(parts)


def per_state(kind: str, seconds: float) -> float:
    """The seconds of one state: a call of an ensemble integrates MEMBERS of them."""
    return seconds / integrators.MEMBERS if kind == integrators.ENSEMBLE else seconds


@dataclass(frozen=True)
class Study:
    """The question: the methods and peers, the problem, how many seconds a point may be timed, the errors wanted."""

    problem: Problem
    methods: Sequence[Entry]
    peers: Sequence[Peer]
    limit: float
    wanted: Sequence[float] = ()

    def question(self) -> dict[str, Any]:
        """All that the answers depend on, as JSON; points that answer another question are not reused."""
        packages = ("numpy", "numba", *(peer.name for peer in self.peers))
        return {
            "problem": self.problem.key,
            "definition": digest(self.problem),
            "methods": {method.key: digest(method) for method in self.methods},
            "peers": [peer.name for peer in self.peers],
            "time_limit": repr(self.limit),
            "rounds": str(ROUNDS),
            "machine": machine_description(),
            "versions": {"driftproof": __version__, **versions_of(packages)},
        }


def held(place: Path | None, question: dict[str, Any], say: Say) -> Measured:
    """What a file has; nothing, and `say` tells so in a line, if it answers another question or cannot be read."""
    if place is not None and place.exists():
        try:
            return _from_json(kept(place, question))
        except NotKept as reason:
            say(f"{place} {reason}; everything is measured again")
    return Measured()


def _from_json(found: dict[str, Any]) -> Measured:
    curves = {}
    for key, curve in found["curves"].items():
        sizes = [{name: Size(*size) for name, size in point["errors"].items()} for point in curve["points"]]
        points = [Point(**{**point, "errors": errors}) for point, errors in zip(curve["points"], sizes, strict=True)]
        curves[key] = Curve(**{**curve, "points": points})
    timings = {key: Timing(**timing) for key, timing in found["timings"].items()}
    return Measured(curves, timings, found["warm_up"], found["absent"], found["refined"])


# The function that returns the call to be timed for a point of a curve; those functions by kind.
_CallAt: TypeAlias = Callable[[Point], Callable[[], State]]
_Calls: TypeAlias = Mapping[str, _CallAt]


@dataclass(frozen=True)
class _Contestant:
    """A method, in given or in its own steps, or a peer's solver: its curve, and what is timed by kind, or why not."""

    key: str
    curve: Callable[[], Curve]
    for_goal: Callable[..., Sequence[Point]]  # for_goal(curve, goal=goal)
    calls: Callable[[], tuple[_Calls, Mapping[str, str]]]


def _contestants(study: Study) -> list[_Contestant]:
    """All whose curves are measured, in the order in which they are shown."""
    problem, once = study.problem, ONCE * study.limit
    found = list[_Contestant]()
    for method in study.methods:
        curve = partial(curve_of, method, problem, compiled=True, most=once)
        refined = partial(for_goal, method=method, problem=problem)
        found.append(_Contestant(method.key, curve, refined, partial(_calls_of_method, method, problem)))
        with suppress(MethodError):  # of a method without an error estimate
            found.append(_controlled(method, study))
    for peer in (peer for peer in study.peers if peer.installed):
        for name in peer.solvers:
            solver = cache(partial(peer.on, problem, name))  # constructed when first used
            found.append(_of_solvers(f"{peer.name} {name}", {peer.kind: solver}, study))
    return found


def _controlled(method: Entry, study: Study) -> _Contestant:
    """The method with step-size control. Raises MethodError."""
    solvers: dict[str, Callable[[], Solver]] = {
        kind: cache(partial(ControlledSolver, method, study.problem, compiled=kind == integrators.COMPILED))
        for kind in integrators.kinds_of_trajectories()
    }
    for solver in solvers.values():
        solver()
    return _of_solvers(f"{method.key} controlled", solvers, study)


def _of_solvers(key: str, solvers: Mapping[str, Callable[[], Solver]], study: Study) -> _Contestant:
    """A solver, by the kinds of its times; the curve is that of the last, the fastest."""

    def call(solver: Callable[[], Solver], point: Point) -> Callable[[], State]:
        return partial(solver().solve, float(point.setting), float(study.problem.t))

    *_, best = solvers.values()
    calls = {kind: partial(call, solver) for kind, solver in solvers.items()}
    curve, refined = partial(_solver_curve, key, best, study), partial(_tolerance_for_goal, best, study)
    return _Contestant(key, curve, refined, lambda: (calls, {}))


def _calls_of_method(method: Entry, problem: Problem) -> tuple[_Calls, Mapping[str, str]]:
    try:
        runs = integrators.integrator(method, problem, compiled=True)
    except MethodError:  # its curve says why
        return {}, {}
    return {kind: lambda point, call=call: call(point.steps or 0) for kind, call in runs.calls.items()}, runs.absent


def _solver_curve(key: str, solver: Callable[[], Solver], study: Study) -> Curve:
    """The points of a solver at TOLERANCES, until it fails or takes too long where it did not before, if it applies."""
    points: list[Point] = []
    try:
        solver()
    except MethodError as error:
        return Curve(key, key, 0, refused=str(error))
    for tolerance in TOLERANCES:
        points.append(solver_point(solver(), tolerance, study))
        if points[-1].remark and not all(point.remark for point in points):
            break
    return Curve(key, key, 0, points)


def _tolerance_for_goal(solver: Callable[[], Solver], study: Study, curve: Curve, goal: float) -> Sequence[Point]:
    """The points with the largest tolerance that meets the goal, of 5 and 2 times the one that does."""
    points = [*curve.points]
    for which in reversed(ENDS):
        decades = [point for point in points if not point.between]
        if not (met := lasting(decades, goal, which)) or met[-1] is decades[0]:
            continue
        for times in (5, 2):
            tried = replace(solver_point(solver(), times * float(met[-1].setting), study), between=True)
            others = [point for point in points if point.setting != tried.setting]
            found = sorted([*others, tried], key=lambda point: -float(point.setting))
            if tried in lasting(found, goal, which):
                points = found
                break
    return points


def solver_point(solver: Solver, tolerance: float, study: Study) -> Point:
    """Errors and evaluations of one solve; if it does not arrive, the solver's own message."""
    problem, setting = study.problem, f"{tolerance:.0e}"
    try:
        evaluations = solver.counted(tolerance, float(problem.t), solver.once * study.limit)
        way = solver.way(tolerance, float(problem.t)) if problem.reference.dense else None
        times = problem.reference.times if way is None else [problem.t]
        sizes = errors(problem, {t: solver.solve(tolerance, float(t)) for t in times}, way)
    except (ArithmeticError, ValueError) as error:  # math.log of a negative number is a ValueError
        return Point(setting, None, remark=error_summary(error))
    return Point(setting, evaluations, sizes, doubt(problem, 0, speed(problem)), largest_state_size(problem))


def measure(study: Study, folder: Path | None, say: Say, progress: Progress = lambda more, done: None) -> Measured:
    """Measure all that the study asks for and `folder` does not have: first every error, then times in turns."""
    everybody, place, question = _contestants(study), folder and folder / "points.json", study.question()
    measured, calls = held(place, question, say), dict[str, Callable[[], object]]()

    def save() -> None:
        """Keep each point as soon as it is measured."""
        if place is not None:
            keep(place, question, asdict(measured))

    progress(len(everybody), 0)
    for one in everybody:
        if one.key not in measured.curves:
            with stage(f"errors of {one.key}"):
                measured.curves[one.key] = one.curve()
            save()
        if measured.refined.get(one.key, []) != [*study.wanted]:
            with stage(f"errors of {one.key} near those wanted"):
                measured.curves[one.key] = with_points_for(study.wanted, one.for_goal, measured.curves[one.key])
            measured.refined[one.key] = [*study.wanted]
            save()
        progress(0, 1)
    for one in everybody:
        with stage(f"compiling {one.key}"):
            made, absent = one.calls()
            measured.absent |= {timing_name(one.key, kind): why for kind, why in absent.items()}
            calls |= _begin_timings(study, measured, measured.curves[one.key], made)
        save()
    wanted = [name for name in calls if needs_more_samples(measured.timings[name], ROUNDS, study.limit)]
    progress(sum(ROUNDS - len(measured.timings[name].samples) for name in wanted), 0)
    for name in interleave(calls, measured.timings, limit=study.limit, rounds=ROUNDS, seed=SEED):
        if name:
            progress(0, 1)
        else:
            save()
    measured.curves = {one.key: measured.curves[one.key] for one in everybody}
    return measured


def _begin_timings(study: Study, measured: Measured, curve: Curve, made: _Calls) -> dict[str, Callable[[], object]]:
    """The calls of the points that have errors, each with a timing begun; those not to be timed get a remark."""
    calls: dict[str, Callable[[], object]] = {}
    met = [lasting(curve.points, goal, which) for goal in study.wanted for which in ENDS]
    named = [found[-1] for found in met if found]
    points = [point for point in curve.points if isfinite(point.error) and (not point.between or point in named)]
    sizes = [point.steps or 1 for point in points]
    for kind, call_at in (made if points else {}).items():
        names = [timing_name(curve.key, kind, point.setting) for point in points]
        if all((x := measured.timings.get(name)) and not needs_more_samples(x, ROUNDS, study.limit) for name in names):
            continue
        seconds, before = _warm_up(measured, curve, kind, call_at, points), sizes[0]
        for name, point, size in zip(names, points, sizes, strict=True):
            call, expected = call_at(point), seconds * size / before
            too_long = expected > study.limit
            remark = f"about {expected:.2g} s, over {study.limit:g} s" if too_long else ""
            if not remark and kind != integrators.ENSEMBLE:
                remark = state_remark(study.problem, point, call)
            if remark:
                measured.timings.setdefault(name, Timing(remark=remark, too_long=too_long))
                continue
            begun, seconds = started(call)
            before, calls[name] = size, call
            measured.timings.setdefault(name, begun)
    return calls


def state_remark(problem: Problem, point: Point, call: Callable[[], State]) -> str:
    """A remark if the timed call does not reach the very state whose error is known; that call may compile.

    Ensembles are not checked: functions of arrays round otherwise than functions of floats.
    """
    try:
        same = distance_from_digits(call(), problem.reference.states[-1]) == point.error
    except (ArithmeticError, ValueError) as error:  # Python raises where compiled code goes on
        return f"{type(error).__name__}: {error}"
    return "" if same else "its final state differs from that of the run whose error was measured"


def _warm_up(measured: Measured, curve: Curve, kind: str, call_at: _CallAt, points: Sequence[Point]) -> float:
    """The seconds of a second call at the first point; those of the first call are stored apart."""
    call, taken = call_at(points[0]), []
    for _ in range(2):
        before = perf_counter()
        with suppress(ArithmeticError, ValueError):  # reported by `state_remark`
            call()
        taken.append(perf_counter() - before)
    measured.warm_up.setdefault(timing_name(curve.key, kind), taken[0])
    return taken[1]
