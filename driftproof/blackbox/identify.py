"""`identify`: the questions put to a stepper of unknown method, and in what order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.families.damping import read_damping
from driftproof.blackbox.families.multistep_recurrence import NoRecurrence
from driftproof.blackbox.families.reports import family_report, hand_jacobian, read_family, unread_report
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.identification import Identification
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES
from driftproof.blackbox.judging.habits import explain_by_habits
from driftproof.blackbox.judging.measured_order import measured_orders
from driftproof.blackbox.judging.nonlinear_step import nonlinear_twins
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Specification
from driftproof.blackbox.matching.dense_outputs import judged_dense
from driftproof.blackbox.matching.estimates import judged_estimate
from driftproof.blackbox.matching.linear_match import linear_fit
from driftproof.blackbox.naming import Seen
from driftproof.blackbox.probes.questions import introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Naming, Report
from driftproof.blackbox.stepper.calling_conventions import FAMILY_KINDS
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS

# Examples of a recognised method's rounding errors: a fifth of those in `verify` shows their size.
_EXAMPLES = EXAMPLES // 5


def identify(
    step: Callable[..., Any] | str,
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
    `time_limit` and `isolate` are as for `verify`. Raises ValueError if the stepper cannot be imported or called.

    >>> from driftproof import identify
    >>> print(identify(lambda q, v, h: (q + h * v, v - h * q), isolate=False).verdict)
    judging by linear steps only, it is forward_euler
    """
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        return _identified(runner)


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
    order = runner.outcome_of(partial(measured_orders, explicit=not (read.failed or read.result.implicit)))
    return identification_report(runner, read, order, dense, later)[0]


def identification_report(
    runner: IsolatedRunner, read: Outcome, order: Outcome, dense: Outcome, later: str = ""
) -> tuple[Report, Naming]:
    """Report on the runner's stepper, given three answers; the other questions are asked in the time that is left."""
    if read.kind == "bad_input":
        raise ValueError(read.seen)
    asked = [introduction, linear_fit, judged_estimate, *CHECKS.values()]
    introduced, fit, estimate, *answers = outcomes = runner.run(asked)
    checks, arithmetic = checks_of(answers), arithmetic_of([read, order, dense, *outcomes])
    damping = runner.outcome_of(read_damping) if read.failed and not introduced.failed else Outcome()
    known = isinstance(read.result, TableauReading) or getattr(read.result, "implicit", False)
    best = None if fit.failed or known else fit.result.nearly or fit.result.best
    implicit = [key for key in (best.methods if best is not None else ()) if not METHODS[key].explicit]
    twins = runner.outcome_of(partial(nonlinear_twins, keys=implicit)) if implicit else Outcome()
    seen = Seen(introduced, read, fit, order, estimate, dense, damping, twins, tuple(checks), arithmetic)
    rounding = Outcome()
    if seen.key is not None and METHODS[seen.key].explicit:
        domain = ORDINARY_DOMAIN if seen.size >= 1 else replace(ORDINARY_DOMAIN, largest_state=seen.size)
        wanted = Specification(METHODS[seen.key], domain=domain)
        rounding = runner.outcome_of(partial(explain_by_habits, wanted=wanted, examples=_EXAMPLES))
    return Identification(runner.target.name, seen, rounding, later).report, seen.naming
