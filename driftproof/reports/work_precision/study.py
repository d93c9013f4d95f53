"""Error against work, measured: errors and evaluations of every run, then times, in turns, kept as they come."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from functools import cached_property, partial
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

from driftproof import __version__
from driftproof.methods.schemes import Method, MethodError
from driftproof.numeric.advance import State
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.work_precision.curves import Curve, Point, curve_of, speed
from driftproof.numeric.work_precision.exact import Size, distance, doubt, errors, scale
from driftproof.numeric.work_precision.integrators import ENSEMBLE, MEMBERS, Call, integrator
from driftproof.numeric.work_precision.timing import ROUNDS, SEED, Timing, interleave, needs_more_samples, started
from driftproof.reports.work_precision.peers import TOLERANCES, Peer, Solver
from driftproof.support.environment import machine_description, versions_of
from driftproof.support.files import atomic_write

# A run for its error, which is made once, may take so many times as long as one that is timed.
ONCE = 10
POINTS = "points.json"
Json: TypeAlias = Any
Say: TypeAlias = Callable[[str], object]


@dataclass
class Measured:
    """What has been measured so far.

    `curves` by method or by peer and solver, as in "scipy DOP853", in the order asked for. `timings` by
    "curve | kind | setting". By "curve | kind": `warm_up` holds the seconds of the first call of all, in which
    compilers compile, and `absent` why there are no times of that kind.
    """

    curves: dict[str, Curve] = field(default_factory=dict)
    timings: dict[str, Timing] = field(default_factory=dict)
    warm_up: dict[str, float] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)

    def timed(self, curve: Curve, kind: str) -> dict[str, Timing]:
        """The timings of a curve, by the settings of its points; without those that were not timed."""
        names = {point.setting: name_of(curve.key, kind, point.setting) for point in curve.points}
        return {s: self.timings[n] for s, n in names.items() if n in self.timings and self.timings[n].samples}


def name_of(*parts: str) -> str:
    """The name of a timing."""
    return " | ".join(parts)


@dataclass(frozen=True)
class Study:
    """What is asked: the methods and peers, the problem, and how many seconds a point may be timed for."""

    problem: Problem
    methods: Sequence[Method]
    peers: Sequence[Peer]
    limit: float

    def question(self) -> Json:
        """All that the answers depend on, as JSON: the points of another question are not taken over."""
        packages = ("numpy", "numba", *(peer.name for peer in self.peers))
        return {
            "problem": self.problem.key,
            "definition": _digest(self.problem),
            "methods": {method.key: _digest(method) for method in self.methods},
            "peers": [peer.name for peer in self.peers],
            "time_limit": repr(self.limit),
            "rounds": str(ROUNDS),
            "machine": machine_description(),
            "versions": {"driftproof": __version__, **versions_of(packages)},
        }


def _digest(data: object) -> str:
    return hashlib.sha256(repr(data).encode()).hexdigest()[:16]


class ResultStore:
    """Where points are written down as soon as they are measured, whole or not at all; without a folder, nowhere."""

    def __init__(self, folder: Path | None, question: Json, say: Say) -> None:
        """Take over what the folder holds on the same question; say so in a line when it is another one."""
        self.path = folder / POINTS if folder else None
        self.question, self.measured = question, Measured()
        if self.path is not None and self.path.exists():
            self._take_over(self.path, say)

    def save(self) -> None:
        """Write down everything that is known by now."""
        if self.path is not None:
            with atomic_write(self.path) as draft:
                Path(draft).write_text(json.dumps(self._content(), indent=1, sort_keys=True), encoding="utf-8")

    def _content(self) -> Json:
        return {"question": self.question, **asdict(self.measured)}

    def _take_over(self, path: Path, say: Say) -> None:
        try:
            held = json.loads(path.read_text(encoding="utf-8"))
            different = [key for key in self.question if held["question"].get(key) != self.question[key]]
            if not different:
                self.measured = _from_json(held)
        except (ValueError, KeyError, TypeError, AttributeError):
            say(f"{path} holds no points that can be read; everything is measured anew")
        else:
            if different:
                say(f"{path} answers another question ({', '.join(different)} differ); everything is measured anew")


def _from_json(held: Json) -> Measured:
    curves = {}
    for key, curve in held["curves"].items():
        points = [
            Point(**{**point, "errors": {name: Size(*size) for name, size in point["errors"].items()}})
            for point in curve["points"]
        ]
        curves[key] = Curve(**{**curve, "points": points})
    return Measured(
        curves, {key: Timing(**timing) for key, timing in held["timings"].items()}, held["warm_up"], held["absent"]
    )


@dataclass(frozen=True)
class Steps:
    """How far a study is, for a progress bar: `expect` more steps, and one is `done`."""

    expect: Callable[[int], object] = lambda _: None
    done: Callable[[], object] = lambda: None


def measure(study: Study, folder: Path | None, say: Say, steps: Steps | None = None) -> Measured:
    """Everything that the study asks for, and that `folder` does not hold already."""
    steps = steps or Steps()
    store = ResultStore(folder, study.question(), say)
    measured, solvers = store.measured, _solvers(study)
    steps.expect(len(study.methods) + len(solvers))
    for key, make in _curve_makers(study, solvers).items():
        if key not in measured.curves:
            measured.curves[key] = make()
            store.save()
        steps.done()
    _time(study, solvers, store, steps)
    measured.curves = {key: measured.curves[key] for key in _curve_makers(study, solvers)}
    return measured


@dataclass(frozen=True)
class _OfPeer:
    """A solver of a peer, made when it is first used."""

    peer: Peer
    name: str
    problem: Problem

    @cached_property
    def solver(self) -> Solver:
        return self.peer.on(self.problem, self.name)


def _solvers(study: Study) -> dict[str, _OfPeer]:
    installed = [peer for peer in study.peers if peer.installed]
    return {f"{peer.name} {name}": _OfPeer(peer, name, study.problem) for peer in installed for name in peer.solvers}


def _curve_makers(study: Study, solvers: Mapping[str, _OfPeer]) -> dict[str, Callable[[], Curve]]:
    """How the curve of each contestant is made, in the order in which they are shown."""
    once = ONCE * study.limit
    ours: dict[str, Callable[[], Curve]] = {
        method.key: partial(curve_of, method, study.problem, compiled=True, limit=once) for method in study.methods
    }
    return ours | {key: partial(peer_curve, key, of_peer, study) for key, of_peer in solvers.items()}


def peer_curve(key: str, asked: _OfPeer, study: Study) -> Curve:
    """The points of a peer's solver at TOLERANCES, until it fails or takes too long."""
    points: list[Point] = []
    for tolerance in TOLERANCES:
        points.append(_peer_point(asked.solver, tolerance, study))
        if points[-1].remark:
            break
    return Curve(key, key, 0, points)


def _peer_point(solver: Solver, tolerance: float, study: Study) -> Point:
    problem, setting = study.problem, f"{tolerance:.0e}"
    try:
        evaluations = solver.counted(tolerance, float(problem.t), ONCE * study.limit)
        states: Mapping[Fraction, Sequence[float]] = {
            t: solver.solve(tolerance, float(t)) for t in problem.reference.times
        }
        sizes = errors(problem, states)
    except ArithmeticError as error:
        return Point(setting, None, remark=" ".join(str(error).split()))
    return Point(setting, evaluations, sizes, doubt(problem, 0, speed(problem)), scale(problem))


# What is called for a point of a curve, and that by kind.
_CallAt: TypeAlias = Callable[[Point], Callable[[], State]]
_Calls: TypeAlias = Mapping[str, _CallAt]


def _time(study: Study, solvers: Mapping[str, _OfPeer], store: ResultStore, steps: Steps) -> None:
    """Choose batches one curve after the other, then take turns."""
    measured, calls = store.measured, dict[str, Callable[[], object]]()
    for key, made in _callable_curves(study, solvers, measured):
        calls |= _started(study, measured, measured.curves[key], made)
    store.save()
    wanted = {name for name in calls if needs_more_samples(measured.timings[name], ROUNDS, study.limit)}
    steps.expect(sum(ROUNDS - len(measured.timings[name].samples) for name in wanted))
    for name in interleave(calls, measured.timings, limit=study.limit, rounds=ROUNDS, seed=SEED):
        if name:
            steps.done()
        else:
            store.save()


def _callable_curves(study: Study, solvers: Mapping[str, _OfPeer], measured: Measured) -> Iterator[tuple[str, _Calls]]:
    for method in study.methods:
        with suppress(MethodError):  # said by its curve
            runs = integrator(method, study.problem, compiled=True)
            measured.absent |= {name_of(method.key, kind): why for kind, why in runs.absent.items()}
            yield method.key, {kind: _at_steps(call) for kind, call in runs.calls.items()}
    for key, asked in solvers.items():
        yield key, {asked.peer.kind: _at_tolerance(asked, float(study.problem.t))}


def _at_steps(call: Call) -> _CallAt:
    return lambda point: call(point.steps or 0)


def _at_tolerance(asked: _OfPeer, t: float) -> _CallAt:
    return lambda point: partial(asked.solver.solve, float(point.setting), t)


def _started(study: Study, measured: Measured, curve: Curve, made: _Calls) -> dict[str, Callable[[], object]]:
    """The calls of the points that have errors, each with a timing begun; those not to be timed have a remark."""
    calls: dict[str, Callable[[], object]] = {}
    points = [point for point in curve.points if isfinite(point.error)]
    for kind, call_at in made.items():
        names = [name_of(curve.key, kind, point.setting) for point in points]
        if all(_is_finished(measured.timings.get(name), study.limit) for name in names):
            continue
        seconds, before = _warm_up(measured, curve, kind, call_at, points), points[0].steps or 1
        for name, point in zip(names, points, strict=True):
            expected = seconds * (point.steps or 1) / before
            if expected > study.limit:
                measured.timings.setdefault(name, Timing(remark=f"about {expected:.2g} s, limit {study.limit:g} s"))
                continue
            call = call_at(point)
            remark = "" if kind == ENSEMBLE else doubtful(study.problem, point, call)
            if remark:
                measured.timings[name] = Timing(remark=remark)
                continue
            begun, seconds = started(call)
            before, calls[name] = point.steps or 1, call
            measured.timings.setdefault(name, begun)
    return calls


def doubtful(problem: Problem, point: Point, call: Callable[[], State]) -> str:
    """A remark if what is to be timed does not reach the very state whose error is known; it may compile in that call.

    Of an ensemble that is not asked: functions of arrays round otherwise than functions of floats.
    """
    try:
        same = distance(call(), problem.reference.states[-1]) == point.error
    except (ArithmeticError, ValueError) as error:  # Python raises where compiled code goes on
        return f"{type(error).__name__}: {error}"
    return "" if same else "it reaches another state than the run whose error was measured"


def _is_finished(timing: Timing | None, limit: float) -> bool:
    return timing is not None and not needs_more_samples(timing, ROUNDS, limit)


def _warm_up(measured: Measured, curve: Curve, kind: str, call_at: _CallAt, points: Sequence[Point]) -> float:
    """The seconds of a second call at the first point; those of the first are kept apart."""
    call, taken = call_at(points[0]), []
    for _ in range(2):
        before = perf_counter()
        with suppress(ArithmeticError, ValueError):  # told apart by `doubtful`
            call()
        taken.append(perf_counter() - before)
    measured.warm_up.setdefault(name_of(curve.key, kind), taken[0])
    return taken[1]


def per_state(kind: str, seconds: float) -> float:
    """The seconds of one state: a call of an ensemble integrates MEMBERS of them."""
    return seconds / MEMBERS if kind == ENSEMBLE else seconds


def kinds_of(measured: Measured, kinds: Iterable[str]) -> list[str]:
    """Those of the kinds that have any timing."""
    return [kind for kind in kinds if any(measured.timed(curve, kind) for curve in measured.curves.values())]
