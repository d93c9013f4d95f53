"""`identify`: the questions put to a stepper of unknown method, and the report, its evidence by its importance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from driftproof.blackbox import findings
from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.checks.trials import TRAITS, CheckResult
from driftproof.blackbox.families.damping import Damping, read_damping
from driftproof.blackbox.families.multistep_recurrence import NoRecurrence
from driftproof.blackbox.families.multistep_runs import later_steps
from driftproof.blackbox.families.reports import (
    GOES_ON,
    family_report,
    hand_jacobian,
    make_anew,
    read_family,
    unread_report,
)
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES
from driftproof.blackbox.judging.habits import explain_by_habits
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import nonlinear_twins
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Specification
from driftproof.blackbox.judging.systems.own_system import linear_fit_of_all, own_methods
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.estimates import JudgedEstimate, judged_estimate
from driftproof.blackbox.naming import Seen
from driftproof.blackbox.probes.linear_steps import LINEARISED
from driftproof.blackbox.probes.questions import Introduction, introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import ADAPTIVE, MOVES, REMEMBERS, NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import (
    NOT_KNOWN,
    Basis,
    Report,
    Section,
    sections,
    verification,
    without_duplicates,
)
from driftproof.blackbox.stepper.calling_conventions import FAMILY_KINDS, MAP, SIGNATURES
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS, entry_named
from driftproof.methods.families import Family
from driftproof.methods.given_methods import subject_of
from driftproof.support.plain_text import Json

# Examples of a recognised method's rounding errors: a fifth of those in `verify` shows their size.
_EXAMPLES = EXAMPLES // 5
# What to do about a stepper that gives no answer at all, by the kind of its failure.
_HELPS = {
    findings.NoAnswer.kind: "give it more time: --time-limit, in Python time_limit",
    findings.KILLED: "try again where nothing kills its process; running out of memory also kills processes",
    findings.INSTRUMENT_FAILED: "report this to us",
    findings.OwnClock.kind: "examine the wrapper in its place",
    findings.StaleSlope.kind: "return the slope, and the time, of the state at the end of the step",
}
_ANSWER = (
    "make this one call return an answer, or write a step of arrays that takes its right-hand side: step(f, t, y, h)"
)


def identify(
    step: Callable[..., Any] | str | Path,
    *,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Identify the method of a float stepper, its order, its rounding errors, and what else it does.

    `step` is a callable or "package.module:name". If it takes a right-hand side or a force, its coefficients are read;
    its one-step matrix is read in any case. Both are compared with the catalogue and with variants of its methods. If
    the stepper remembers earlier steps, the recurrence of many steps and its start are read. `calls`, `array`,
    `time_limit` and `isolate` are as for `verify`. Of a .toml file, the exact table is compared with the catalogue.
    Raises ValueError if the stepper cannot be imported or called.

    >>> from driftproof import identify
    >>> print(identify(lambda q, v, h: (q + h * v, v - h * q), isolate=False).verdict)
    judging by linear steps only, it is forward_euler
    """
    if isinstance(step, Path) or (isinstance(step, str) and step.partition(" at ")[0].endswith(".toml")):
        if calls or array:
            raise ValueError(f"{step} is a table, which nothing calls: leave out `calls` and `array`")
        return _identified_table(str(step))
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        return _identified(runner)


def _identified_table(name: str) -> Report:
    """Which method of the catalogue the table in a file is, its order, and the orders that it claims and lacks."""
    from driftproof.symbolic.claimed_orders import stated_order, unreached_orders
    from driftproof.symbolic.known_methods import known_as

    method = subject_of(name)
    if isinstance(method, Family):
        raise ValueError(f"{name} is a family; one method is needed, such as '{name} at 1/2'")
    found = known_as(method)
    words = (
        f"it is {found.words}" if found.methods or found.near else NOT_KNOWN + f": {found.words}" * bool(found.words)
    )
    known = [entry_named(key) for key in (*found.methods, *found.near)]
    order = stated_order(replace(method, claimed_order=0))
    parts = (
        ("Catalogue", [f"{each.key}: {each.title}; {each.source}" for each in known]),
        ("Order", [f"{order}, from the exact coefficients", *map(str, unreached_orders(method))]),
    )
    data = {"method": next(iter(found.methods), None), "near": [*found.near], "differences": [*found.differences]}
    named = bool(found.methods or found.near)
    return Report(name, words, None, sections(*parts), {**data, "order": order}, named)


def _identified(runner: IsolatedRunner) -> Report:
    """The report on a runner's stepper; of one that takes a Jacobian in vain for a family, on its steps of f alone."""
    of_run = partial(read_family, runs_only=True)
    read, dense, family = runner.run([read_coefficients, judged_dense, of_run])
    if read.failed and read.kind not in (UnsupportedCall.kind, *NO_EVIDENCE):
        family = runner.outcome_of(read_family)
    if family.result is not None or read.kind == UnsupportedCall.kind:
        opened = runner.outcome_of(introduction).result
        if family.result is not None:
            return family_report(runner.target.name, opened, family.result)
        if opened is not None and opened.calls in FAMILY_KINDS:
            if family.kind not in NO_EVIDENCE and (handed := hand_jacobian(runner)):
                report = _identified(runner)
                return replace(report, verdict=report.verdict + handed)
            return unread_report(runner.target.name, family)
    # If later steps depend on earlier ones by no known recurrence, only the first step was read.
    remembering = family.kind in (NotReadable.kind, NoRecurrence.kind, *NO_EVIDENCE)
    later = f"this holds for its first step only: {family.seen}" if remembering and family.seen != read.seen else ""
    target = runner.target
    if REMEMBERS in read.traits and make_anew(runner):
        of_copies, of_dense, steps = runner.run([read_coefficients, judged_dense, later_steps])
        if of_copies.failed:  # it is random, say
            runner.turn_to(target)
        else:
            read, dense = of_copies, of_dense
            alone = steps.result is None or steps.result.holds is not False
            later = later or (GOES_ON if alone else f"this holds for its first step only: {steps.result.words}")
    order = runner.outcome_of(partial(measured_orders, explicit=not (read.failed or read.result.implicit)))
    return identification(runner, read, order, dense, later).report


def identification(
    runner: IsolatedRunner, read: Outcome, order: Outcome, dense: Outcome, later: str = ""
) -> Identification:
    """Identify the runner's stepper, given three answers; the other questions are asked in the time that is left."""
    if read.kind == findings.BadInput.kind:
        raise ValueError(read.seen)
    asked = [introduction, linear_fit_of_all, judged_estimate, *CHECKS.values()]
    introduced, fit, estimate, *answers = outcomes = runner.run(asked)
    checks, arithmetic = checks_of(answers), arithmetic_of([read, order, dense, *outcomes])
    damping = runner.outcome_of(read_damping) if read.failed and not introduced.failed else Outcome()
    known = isinstance(read.result, TableauReading) or getattr(read.result, "implicit", False)
    best = None if fit.failed or known else fit.result.nearly or fit.result.best
    implicit = [key for key in (best.methods if best is not None else ()) if not METHODS[key].explicit]
    twins = runner.outcome_of(partial(nonlinear_twins, keys=implicit)) if implicit else Outcome()
    seen = Seen(introduced, read, fit, order, estimate, dense, damping, twins, tuple(checks), arithmetic=arithmetic)
    linear = seen.naming.basis is Basis.LINEAR_ONLY and seen.fit is not None and seen.fit.kind == LINEARISED
    if (linear or seen.naming.words == NOT_KNOWN) and introduced.result.calls == MAP:
        seen = replace(seen, own=runner.outcome_of(own_methods).result)
    rounding = Outcome()
    if seen.key is not None and METHODS[seen.key].explicit:
        domain = ORDINARY_DOMAIN if seen.size >= 1 else replace(ORDINARY_DOMAIN, largest_state=seen.size)
        wanted = Specification(METHODS[seen.key], domain=domain)
        rounding = runner.outcome_of(partial(explain_by_habits, wanted=wanted, examples=_EXAMPLES))
    return Identification(runner.target.name, seen, rounding, later)


@dataclass(frozen=True)
class Identification:
    """What was seen of a stepper, and the rounding errors of the method that it is, if that was judged.

    `later` says what is known of its later steps if these depend on earlier ones.
    """

    name: str
    seen: Seen
    rounding: Outcome
    later: str = ""

    @cached_property
    def report(self) -> Report:
        """The report, whose verdict is the stepper's name, with what makes that name less than certain."""
        verdict = "; ".join([self.seen.naming.words, *self.doubts])
        return Report(self.name, verdict, None, self._sections, self._data, self.seen.naming.basis.answered)

    @property
    def doubts(self) -> list[str]:
        """What makes the name less than certain: an error that is no rounding, later steps, another arithmetic."""
        seen, found = self.seen, self.rounding.result
        otherwise_named = seen.read or (seen.fit and seen.fit.nearly) or seen.own
        failing = None if found is None or found.but_for or otherwise_named else found.failing
        beyond = failing and failing.answer and failing.error_over_bound
        off = f"but a step is off by {beyond:.3g} times the bound on its rounding" if beyond else ""
        return [*filter(None, [off, self.later, seen.arithmetic])]

    @property
    def _opened(self) -> Introduction | None:
        opened: Introduction | None = self.seen.introduction.result
        return opened

    @property
    def _unanswered(self) -> list[Outcome]:
        seen = self.seen
        asked = seen.introduction, seen.coefficients, seen.linear, seen.order, seen.estimate, seen.dense, self.rounding
        return [outcome for outcome in asked if outcome.failed]

    @property
    def _sections(self) -> tuple[Section, ...]:
        seen, opened = self.seen, self._opened
        damping: Damping | None = seen.damping.result
        orders = [*([] if seen.read is None else seen.read.order.lines), *(found.words for found in _measured(seen))]
        orders += ["the order on nonlinear problems is not known"] * (seen.order.kind == UnsupportedCall.kind)
        stepper = [SIGNATURES[opened.calls], f"takes {opened.numbers}, works in {opened.format}"] if opened else []
        evidence = sections(
            ("What to do", self._what_to_do),
            ("Faults", [*seen.damps, *(check.words for check in seen.checks if check.is_fault)]),
            ("Coefficients", [] if seen.read is None else [*seen.read.identity.lines, *seen.read.reading.lines]),
            ("Order", orders),
            ("One-step matrix", [] if seen.fit is None or seen.naming.basis is Basis.UNDECIDED else seen.fit.lines),
            ("Damping", damping.lines if damping and not damping.faults else []),
            ("Error estimate", _returned_besides_y1(seen.estimate)),
            ("Dense output", _returned_besides_y1(seen.dense)),
            ("Rounding", [] if self.rounding.result is None else self.rounding.result.lines),
            ("Stepper", [*stepper, *filter(None, [seen.arithmetic])]),
        )
        said = without_duplicates(o.said for o in self._unanswered if o.kind != UnsupportedCall.kind)
        checks = _checks([check for check in seen.checks if not check.is_fault])
        return (*evidence, *checks, *sections(("Not answered", said)))

    @property
    def _what_to_do(self) -> list[str]:
        seen, held = self.seen, verification(self.name)
        if seen.introduction.failed:
            return [_HELPS.get(seen.introduction.kind or "", _ANSWER)]
        lines = ["fix the faults first"] if any(check.is_fault for check in seen.checks) else []
        near = seen.read.identity.near if seen.read is not None else ()
        if near:
            key, wrong = near[0].key, "; ".join(near[0].differences)
            lines.append(f"if it should be {key}, correct this: {wrong}; then {held} {key}")
        elif keys := [*filter(None, [seen.key]), *((seen.own and seen.own.keys) or ())]:
            key = keys[0]
            solved = "" if key not in METHODS or METHODS[key].explicit else " --solver-tolerance 1e-10"
            lines.append(f"if it should be {key}, verify it: {held} {key}{solved}, or assert_verified in a test")
        else:
            lines.append(f"name the method it should be: {held} METHOD, or your own tableau in a .toml file")
        if MOVES in seen.coefficients.traits:
            lines.append("if it takes differences of f as its Jacobian, hand it that: step(f, jac, t, y, h)")
        elif ADAPTIVE in seen.coefficients.traits:
            advice = "let a large tolerance accept each step, or examine a solver: --solver"
            lines.append(f"if it adapts its step size, {advice}")
        if seen.coefficients.kind == UnsupportedCall.kind:
            advice = "make the right-hand side or force an argument: step(f, t, y, h)"
            lines.append(f"to have its coefficients read, {advice}")
        return lines

    @property
    def _data(self) -> dict[str, Json]:
        seen, read, fit, opened = self.seen, self.seen.read, self.seen.fit, self._opened
        measured = next(iter(_measured(seen)), None)
        return {
            "calls": None if opened is None else opened.calls,
            "arithmetic": seen.arithmetic or None,
            "format": None if opened is None else opened.format,
            "method": seen.key,
            "coefficients": None if read is None else [*read.identity.lines, *read.reading.lines],
            "matrix": None if fit is None else list(fit.lines),
            "order": None if read is None else read.order.order,
            "order_fails": None if read is None else read.order.failing_tree,
            "linear_order": None if fit is None or fit.facts is None else fit.facts.linear_order,
            "measured_order": None if measured is None else measured.order,
            "estimate": _data_of(seen.estimate),
            "dense": _data_of(seen.dense),
            "rounding": _data_of(self.rounding),
            "damping": _data_of(seen.damping),
            "checks": [check.as_dict() for check in seen.checks],
            "not_answered": [{"kind": o.kind, "seen": o.seen} for o in self._unanswered],
        }


def _data_of(outcome: Outcome) -> Json:
    found: Json = None if outcome.result is None else outcome.result.data
    return found


def _checks(checks: Sequence[CheckResult]) -> tuple[Section, ...]:
    """The section of the checks that found no fault, with one line that counts those kept, traits and undecided."""
    traits = sum(check.key in TRAITS and check.holds is not None for check in checks)
    undecided = sum(check.holds is None for check in checks)
    counts = {"passed": len(checks) - traits - undecided, "on traits such as areas": traits, "undecided": undecided}
    brief = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    brief += "; --all (in Python, .text(True)) shows each"
    lines = tuple(check.words for check in checks)
    return (Section("Checks", lines, brief * (len(lines) > 1)),) if lines else ()


def _returned_besides_y1(outcome: Outcome) -> list[str]:
    found: JudgedEstimate | JudgedDense | None = outcome.result
    return [] if found is None else [*found.lines, *found.faults]


def _measured(seen: Seen) -> Sequence[MeasuredOrder]:
    """The orders measured; of a step that has a drag built in, that with the drag added to the force."""
    damped: MeasuredOrder | None = None if seen.damping.result is None else seen.damping.result.order
    return seen.measured if damped is None else (damped,)
