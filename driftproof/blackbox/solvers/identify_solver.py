"""`identify_solver`: which method a solver advances, the law of its step sizes, and what else it does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from driftproof.blackbox.families.multistep import Corrected
from driftproof.blackbox.findings import INSTRUMENT_FAILED, NO_EVIDENCE, BadInput, Outcome, StepRaised, WrongShape
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.matching.estimates import is_pair
from driftproof.blackbox.matching.match import match_method
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.report import NO_ANSWER, UNDECIDED, Report, sections, without_duplicates
from driftproof.blackbox.solvers.controller import ControllerReading, read_controller
from driftproof.blackbox.solvers.foreign_solver import DoesNotEnd, ForeignSolver, SolverTarget
from driftproof.blackbox.solvers.multistep import SolverMemory, read_memory
from driftproof.blackbox.solvers.runs import RunsReading, read_runs
from driftproof.blackbox.solvers.steps import SolverSteps, read_steps, unlike
from driftproof.blackbox.solvers.tolerance_runs import RunLines
from driftproof.methods.catalogue import EMBEDDED_SUFFIX, FurtherMethod
from driftproof.methods.families import Family
from driftproof.methods.given_methods import method_of, subject_of
from driftproof.methods.schemes import Method, RungeKutta

_WHAT_TO_DO = {
    StepRaised.kind: "write def wrapped(f, t_span, y0): return solve(f, *t_span, y0), say; t_span is (start, end)",
    NotReadable.kind: "where a solver cannot be read, one of its steps often can: give that to identify or verify, as "
    "step(f, t, y, h), or step(f, jacobian, t, y, h) of a Rosenbrock method with f' as an argument",
    WrongShape.kind: "return the times and the states of its own steps; of a run over given times, leave --solver out",
}

_REMARK = "; remark: {}"  # of a verdict


def identify_solver(
    solve: Callable[..., Any] | str,
    method: str | Path | Method | FurtherMethod | None = None,
    *,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Identify the method that a solver advances, the law of its step sizes, and faults of its clock and tolerances.

    `solve(f, t_span, y0, rtol, atol)`, a callable or "package.module:name", returns (t, y), or an object with t and y,
    at every step that it makes; f(t, y) is supplied here. In place of rtol and atol it may take one tolerance, a step
    size as h or dt, a number of steps as n or steps, or nothing. The tableau of its steps is read through marked
    answers, up to a few roundings; of multistep methods, the recurrence and the start are read. The step size control
    and runs with known solutions are measured, and the report says so. What the solver does where f is NaN is among
    `report.data["remarks"]`, and no fault. With a `method`, its `passed` is True
    if the solver advances that and has no fault, False if it does not or has one, and None if its steps are not read.
    Raises ValueError if the solver cannot be imported or does not solve y' = 0, and for what is no method.

    >>> from driftproof import identify_solver
    >>> def solve(f, t_span, y0, rtol, atol):
    ...     t, y, h = [t_span[0]], [y0], (t_span[1] - t_span[0]) / 64
    ...     for n in range(64):
    ...         y.append(y[-1] + h * f(t[-1], y[-1]))
    ...         t.append(t_span[0] + (n + 1) * h)
    ...     return t, y
    >>> report = identify_solver(solve, isolate=False)
    >>> print(report.verdict.partition(";")[0])
    it advances forward_euler, of order 1
    """
    wanted = None if method is None else Corrected.named(method) or subject_of(method)
    if isinstance(wanted, Family):
        wanted = method_of(wanted)  # raises ValueError
    runner = IsolatedRunner(SolverTarget(solve), time_limit, isolate)
    controlled = partial(_controlled, held=wanted if isinstance(wanted, RungeKutta) and is_pair(wanted) else None)
    steps, controller, runs, seen = runner.run([_steps, controlled, read_runs, _seen])
    if steps.kind == BadInput.kind:
        raise ValueError(steps.seen)
    if isinstance(steps.result, SolverMemory):  # there is no pair whose estimate could be in a law
        controller = Outcome()
    found = _Answers(steps, controller, runs, "" if seen.failed else seen.result)
    report = found.report(runner.target.name)
    if wanted is None:
        return report
    if steps.failed and found.own_faults:  # one with faults of its own fails, whatever it advances
        return replace(report, verdict="; ".join([*found.faults, found.named]), passed=False)
    unread = steps.kind == NotReadable.kind and report.answered is not False and not found.faults
    if unread and isinstance(wanted, RungeKutta) and wanted.explicit:
        apart = runner.outcome_of(partial(unlike, method=wanted)).result
        if apart:
            return replace(report, verdict=f"is not {wanted.key}: {apart}; {report.verdict}", passed=False)
    return _held(report, found, wanted)


def assert_verified_solver(
    solve: Callable[..., Any] | str,
    method: str | Path | Method | FurtherMethod,
    *,
    allow_undecided: bool = False,
    time_limit: float | None = None,
    isolate: bool = True,
) -> None:
    """Raise AssertionError with the whole report of `identify_solver` unless the solver passes: for a test.

    It passes if it advances the method and has no fault, of its clock, its tolerances or its dense output, say. An
    undecided verdict fails as well unless `allow_undecided` is true, and one that passes with a remark is warned of, as
    by `assert_verified`, whose default time limit it has.

    >>> from driftproof import assert_verified_solver
    >>> def solve(f, t_span, y0):
    ...     t, y, h = [t_span[0]], [y0], (t_span[1] - t_span[0]) / 64
    ...     for n in range(64):
    ...         y.append(y[-1] + h * f(t[-1], y[-1]))
    ...         t.append(t_span[0] + (n + 1) * h)
    ...     return t, y
    >>> assert_verified_solver(solve, "forward_euler", isolate=False)
    """
    from driftproof.blackbox.verify import assert_report

    __tracebackhide__ = True
    assert_report(partial(identify_solver, solve, method, isolate=isolate), time_limit, allow_undecided)


@dataclass(frozen=True)
class _Answers:
    """What was asked of a solver: its steps, its step size control, and runs with known solutions; what they took."""

    steps: Outcome
    controller: Outcome
    runs: Outcome
    looked_at: str

    def report(self, name: str) -> Report:
        """The report on a solver of this name that is held to no method."""
        said = "; ".join([self.named, *self.faults]) + "".join(map(_REMARK.format, self.remarks))
        steps, controller, runs = self.steps, self.controller, self.runs
        measured = self.measured.seen
        what_to_do = _WHAT_TO_DO.get(steps.kind or "") if runs.failed or steps.kind == NotReadable.kind else None
        return Report(
            name,
            self.named if steps.failed and runs.failed else said,
            None,
            sections(
                ("What to do", [*filter(None, [what_to_do])]),
                ("Steps", [] if steps.failed else steps.result.lines),
                ("Dense output", () if steps.failed or steps.result.dense is None else steps.result.dense.lines),
                ("Step size control", [] if controller.result is None else controller.result.lines),
                *((f"{title}, measured", lines) for title, lines in measured.items()),
                ("Faults", self.faults),
                ("Remarks", self.remarks),
                ("Not answered", without_duplicates([o.said for o in (steps, controller, runs) if o.failed])),
                ("Looked at", [*filter(None, [self.looked_at])]),
            ),
            {
                "steps": None if steps.failed else {"name": steps.result.name, "order": self.order},
                "controller": None if controller.result is None else list(controller.result.lines),
                "runs": None if runs.failed else {title: list(lines) for title, lines in measured.items()},
                "faults": self.faults,
                "remarks": self.remarks,
                "looked_at": self.looked_at,
                "not_answered": [{"kind": o.kind, "seen": o.seen} for o in (steps, controller, runs) if o.failed],
            },
            # Steps that are not read may be those of any method; without an answer there are none.
            steps.result.named if not steps.failed else None if steps.kind in NO_EVIDENCE or not runs.failed else False,
        )

    @property
    def own_faults(self) -> list[str]:
        """The faults of the solver, those of the step size control first, which may be the cause of steps that differ.

        What it does where f is NaN, a last step of a rounding, and which row of a pair it advances, are no faults of a
        method's steps.
        """
        dense = None if self.steps.failed else self.steps.result.dense
        found = filter(None, [dense, self.controller.result, self.steps.result, self.runs.result])
        faults = [fault for each in found for fault in each.faults if fault not in self.measured.beside]
        endless = self.controller.kind == DoesNotEnd.kind
        return faults + [f"step size control: does not end: {self.controller.seen}"] * endless

    @property
    def faults(self) -> list[str]:
        """The faults of the solver, and what a fault of ours left unmeasured."""
        asked = (self.steps, self.controller, self.runs)
        return self.own_faults + [f"not measured: {each.seen}" for each in asked if each.kind == INSTRUMENT_FAILED]

    @property
    def remarks(self) -> list[str]:
        """What else was seen, and what was not."""
        control = self.controller
        rows = [*getattr(control.result or self.steps.result, "remarks", ())]
        if control.kind == NotReadable.kind and self.steps.result and self.steps.result.adaptive:
            rows = [f"step size control not seen: {control.seen}"]
        return [*rows, *self.measured.beside, *self.measured.remarks]

    @property
    def measured(self) -> RunsReading:
        """What the runs with known solutions show: nothing if they failed."""
        return self.runs.result or RunsReading({})

    @property
    def order(self) -> int | None:
        """The order of the tableau or the recurrence; of a step of another length than its times, that observed."""
        steps = self.steps.result
        order: int | None = steps.order if isinstance(steps, SolverMemory) else steps.order.order
        observed = self.measured.answers.get("Tolerance", RunLines()).orders if order == 0 else ()
        return min(map(round, observed), default=order)

    @property
    def named(self) -> str:
        """What it advances, and the law of its step sizes; or why nothing of that is known."""
        if self.steps.failed and self.runs.failed:
            word = UNDECIDED if self.steps.kind in NO_EVIDENCE else NO_ANSWER
            return f"{word}: {self.steps.seen}"
        found: SolverSteps | SolverMemory | None = self.steps.result
        implicit = self.measured.answers.get("Stiffness", RunLines()).implicit  # whose steps have no explicit tableau
        implicit = implicit and f"; {implicit}"
        if found is None:
            name = f"its steps are not read: {self.steps.seen}{implicit}"
        else:
            shown = implicit if self.order is None else f", of order {self.order}"
            if isinstance(found, SolverSteps) and self.order != found.order.order:
                shown = f" in one run; order {self.order} is observed"  # its share depends on the number of steps
            name = f"it advances {found.name}{shown}"
        control: ControllerReading | None = self.controller.result
        if control is not None and (control.law or not control.faults):
            name += f"; its step sizes: {control.law.words if control.law else control.lines[0]}"
        return name


def _held(report: Report, found: _Answers, method: Method | FurtherMethod) -> Report:
    """The report on a solver that should advance this method. Steps of several methods in turn leave that open.

    One whose runs gave no evidence is undecided.
    """
    steps: SolverSteps | SolverMemory | None = found.steps.result
    if steps is None or (isinstance(steps, SolverMemory) and steps.order is None):
        passed = False if steps is None and report.answered is False else None
        verdict = f"{UNDECIDED} whether it is {method.key}: {report.verdict}" if passed is None else report.verdict
        return replace(report, verdict=verdict, passed=passed)
    if isinstance(steps, SolverMemory):
        same = steps.key is not None and (Corrected.named(steps.key) or steps).key == method.key
    else:
        same = isinstance(method, Method) and bool(match_method(steps.reading, method).matches)
    if not same:
        others = {pair.key for pair in getattr(steps, "pairs", ())}
        both = (method.key + EMBEDDED_SUFFIX, method.key.removesuffix(EMBEDDED_SUFFIX))
        instead = next((f"; if that row of the pair is meant: --method {key}" for key in both if key in others), "")
        return replace(report, verdict=f"is not {method.key}; {report.verdict}{instead}", passed=False)
    if found.faults:
        return replace(report, verdict=f"is {method.key}, but {'; '.join(found.faults)}", passed=False)
    seen = f" in {found.looked_at}" if found.looked_at else ""
    verdict = f"is {method.key}{seen}{''.join(map(_REMARK.format, found.remarks))}"
    unseen = found.controller.result.unseen if found.controller.result else ""
    if unseen := "its clock and its tolerances are not seen" if found.runs.failed else unseen:
        return replace(report, verdict=f"{UNDECIDED} whether it {verdict}: {unseen}", passed=None)
    return replace(report, verdict=verdict, passed=True)


def _steps(subject: ForeignSolver) -> SolverSteps | SolverMemory:
    """The tableau of its steps, or else its multistep method. Raises NotReadable with both reasons."""
    try:
        return read_steps(subject)
    except NotReadable as refusal:
        try:
            memory = read_memory(subject)
        except NotReadable as other:
            raise NotReadable(f"{refusal}; {other}") from None
        return memory if memory.settled else replace(memory, faults=(*memory.faults, str(refusal)))


def _seen(subject: ForeignSolver) -> str:
    """What all questions looked at: how many steps, in how many runs, of how many numbers."""
    sizes, steps = zip(*subject.runs, strict=True)
    *most, last = map(str, sorted({*sizes}))
    return f"{sum(steps)} steps, in {len(sizes)} runs of {' and '.join(filter(None, [', '.join(most), last]))} numbers"


def _controlled(subject: ForeignSolver, held: RungeKutta | None) -> ControllerReading:
    return read_controller(subject, read_steps(subject), held)
