"""`identify_solver`: which method a solver advances, the law of its step sizes, and what else it does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
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
    and runs with known solutions are measured, and the report says so. A test may hold that `report.data["faults"]` is
    empty; what the solver does where f is NaN is among `report.data["remarks"]`. With a `method`, its `passed` is True
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
    own, lost, remarks = _faults(steps, controller, runs)
    named, faults = _named(steps, controller, runs), [*own, *lost]
    said = "; ".join([named, *faults]) + "".join(map(_REMARK.format, remarks))
    looked_at = "" if seen.failed else seen.result
    report = Report(
        runner.target.name,
        named if steps.failed and runs.failed else said,
        None,
        (*_sections(steps, controller, runs, faults, remarks), *sections(("Looked at", [*filter(None, [looked_at])]))),
        {
            "steps": None if steps.failed else {"name": steps.result.name, "order": _order(steps.result, runs)},
            "controller": None if controller.result is None else list(controller.result.lines),
            "runs": None if runs.failed else {title: list(lines) for title, lines in runs.result.seen.items()},
            "faults": list(faults),
            "remarks": list(remarks),
            "looked_at": looked_at,
            "not_answered": [{"kind": o.kind, "seen": o.seen} for o in (steps, controller, runs) if o.failed],
        },
        # Steps that are not read may be those of any method; without an answer there are none.
        steps.result.named if not steps.failed else None if steps.kind in NO_EVIDENCE or not runs.failed else False,
    )
    if wanted is not None and steps.failed and own:  # one with faults of its own fails, whatever it advances
        return replace(report, verdict="; ".join([*faults, named]), passed=False)
    unread = steps.kind == NotReadable.kind and report.answered is not False and not faults
    if unread and isinstance(wanted, RungeKutta) and wanted.explicit:
        apart = runner.outcome_of(partial(unlike, method=wanted)).result
        if apart:
            return replace(report, verdict=f"is not {wanted.key}: {apart}; {report.verdict}", passed=False)
    unseen = controller.result.unseen if controller.result else ""
    return report if wanted is None else _held(report, steps.result, wanted, faults, remarks, unseen)


def _held(
    report: Report,
    steps: SolverSteps | SolverMemory | None,
    method: Method | FurtherMethod,
    faults: Sequence[str],
    remarks: Sequence[str],
    unseen: str,
) -> Report:
    """The report on a solver that should advance this method. Steps of several methods in turn leave that open.

    One whose runs gave no evidence is undecided.
    """
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
    if faults:
        return replace(report, verdict=f"is {method.key}, but {'; '.join(faults)}", passed=False)
    seen = f" in {report.data['looked_at']}" if report.data["looked_at"] else ""
    verdict = f"is {method.key}{seen}{''.join(map(_REMARK.format, remarks))}"
    if unseen := "its clock and its tolerances are not seen" if report.data["runs"] is None else unseen:
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


def _order(steps: SolverSteps | SolverMemory, runs: Outcome) -> int | None:
    """The order of the tableau or the recurrence; of a step of another length than its times, the order observed."""
    order = steps.order if isinstance(steps, SolverMemory) else steps.order.order
    observed = () if order != 0 or runs.failed else runs.result.answers.get("Tolerance", RunLines()).orders
    return min(map(round, observed), default=order)


def _seen(subject: ForeignSolver) -> str:
    """What all questions looked at: how many steps, in how many runs, of how many numbers."""
    sizes, steps = zip(*subject.runs, strict=True)
    *most, last = map(str, sorted({*sizes}))
    return f"{sum(steps)} steps, in {len(sizes)} runs of {' and '.join(filter(None, [', '.join(most), last]))} numbers"


def _controlled(subject: ForeignSolver, held: RungeKutta | None) -> ControllerReading:
    return read_controller(subject, read_steps(subject), held)


def _faults(steps: Outcome, controller: Outcome, runs: Outcome) -> tuple[list[str], list[str], list[str]]:
    """The faults of the solver, what a fault of ours left unmeasured, and the remarks.

    The faults of the step size control, which may be the cause of steps that differ, come first. What it does where f
    is NaN, a last step of a rounding, and which row of a pair it advances, are no faults of a method's steps.
    """
    found = [outcome.result for outcome in (controller, steps, runs) if outcome.result is not None]
    dense = None if steps.failed else steps.result.dense
    endless = [f"step size control: does not end: {controller.seen}"] * (controller.kind == DoesNotEnd.kind)
    lost = [f"not measured: {each.seen}" for each in (steps, controller, runs) if each.kind == INSTRUMENT_FAILED]
    faults = [*(fault for each in (*filter(None, [dense]), *found) for fault in each.faults), *endless]
    beside = [] if runs.failed else [line for each in runs.result.answers.values() for line in each.beside]
    rows = [*controller.result.remarks] if controller.result else [*getattr(steps.result, "remarks", ())]
    if controller.kind == NotReadable.kind and steps.result and steps.result.adaptive:
        rows = [f"step size control not seen: {controller.seen}"]
    unseen = () if runs.failed else runs.result.remarks
    return [each for each in faults if each not in beside], lost, [*rows, *beside, *unseen]


def _named(steps: Outcome, controller: Outcome, runs: Outcome) -> str:
    """What it advances, and the law of its step sizes; or why nothing of that is known."""
    if steps.failed and runs.failed:
        word = UNDECIDED if steps.kind in NO_EVIDENCE else NO_ANSWER
        return f"{word}: {steps.seen}"
    found: SolverSteps | SolverMemory | None = steps.result
    if found is None:
        name = f"its steps are not read: {steps.seen}{_implicit(runs)}"
    else:
        order = _order(found, runs)
        shown = _implicit(runs) if order is None else f", of order {order}"
        if isinstance(found, SolverSteps) and order != found.order.order:  # that share depends on the number of steps
            shown = f" in one run; order {order} is observed"
        name = f"it advances {found.name}{shown}"
    control: ControllerReading | None = controller.result
    measured = ""
    if control is not None and (control.law or not control.faults):
        measured = f"; its step sizes: {control.law.words if control.law else control.lines[0]}"
    return name + measured


def _implicit(runs: Outcome) -> str:
    """The line on an implicit solver, whose steps have no explicit tableau; "" for an explicit one."""
    line = "" if runs.failed else runs.result.answers.get("Stiffness", RunLines()).implicit
    return line and f"; {line}"


def _sections(steps: Outcome, controller: Outcome, runs: Outcome, faults: Sequence[str], remarks: Sequence[str]) -> Any:
    measured: RunsReading | None = runs.result
    found = [] if measured is None else [(f"{title}, measured", lines) for title, lines in measured.seen.items()]
    unread = steps.kind == NotReadable.kind
    unanswered = [o.said for o in (steps, controller, runs) if o.failed]
    return sections(
        ("What to do", [_WHAT_TO_DO[steps.kind]] if steps.kind in _WHAT_TO_DO and (runs.failed or unread) else []),
        ("Steps", [] if steps.failed else steps.result.lines),
        ("Dense output", () if steps.failed or steps.result.dense is None else steps.result.dense.lines),
        ("Step size control", [] if controller.result is None else controller.result.lines),
        *found,
        ("Faults", faults),
        ("Remarks", remarks),
        ("Not answered", without_duplicates(unanswered)),
    )
