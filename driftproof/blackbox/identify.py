"""`identify`: the questions put to a stepper of unknown method, and the report with its name and the evidence."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.checks.trials import TRAITS, CheckResult
from driftproof.blackbox.families.damping import Damping, read_damping
from driftproof.blackbox.families.multistep_recurrence import NoRecurrence
from driftproof.blackbox.families.reports import family_report, read_family, unread_report
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES
from driftproof.blackbox.judging.habits import explain_by_habits
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import nonlinear_twins
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Specification
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.estimates import JudgedEstimate, judged_estimate
from driftproof.blackbox.matching.linear_match import linear_fit
from driftproof.blackbox.naming import Seen
from driftproof.blackbox.probes.questions import Introduction, introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Naming, Report, Section, sections, verification, without_duplicates
from driftproof.blackbox.stepper.calling_conventions import FAMILY_KINDS, SIGNATURES
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method
from driftproof.support.plain_text import Json

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
        of_run = partial(read_family, runs_only=True)
        read, order, dense, family = runner.run([read_coefficients, measured_orders, judged_dense, of_run])
        if read.failed and read.kind not in (UnsupportedCall.kind, *NO_EVIDENCE):
            family = runner.outcome_of(read_family)
        if family.result is not None or read.kind == UnsupportedCall.kind:
            opened = runner.outcome_of(introduction).result
            if family.result is not None:
                return family_report(runner.target.name, opened, family.result)
            if opened is not None and opened.calls in FAMILY_KINDS:
                return unread_report(runner.target.name, family)
        # If later steps depend on earlier ones by no known recurrence, only the first step was read.
        remembering = family.kind in (NotReadable.kind, NoRecurrence.kind, *NO_EVIDENCE)
        later = f"this holds for its first step only: {family.seen}" if remembering else ""
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
    explicit = METHODS[seen.key] if seen.key is not None and METHODS[seen.key].explicit else None
    rounding = None if explicit is None else _rounding(runner, explicit, seen.size)
    found = rounding.result if rounding and not rounding.failed and not (seen.read or fit.result.nearly) else None
    beyond = found and found.failing and found.failing.answer and not found.but_for and found.failing.error_over_bound
    off = f"but a step is off by {beyond:.3g} times the bound on its rounding" if beyond else ""
    verdict = "; ".join(filter(None, [seen.naming.words, off, later, arithmetic]))
    name = runner.target.name
    return Report(name, verdict, None, _sections(name, seen, rounding), _data(seen, rounding)), seen.naming


def _rounding(runner: IsolatedRunner, method: Method, size: float) -> Outcome:
    domain = ORDINARY_DOMAIN if size >= 1 else replace(ORDINARY_DOMAIN, largest_state=size)
    wanted = Specification(method, domain=domain)
    return runner.outcome_of(partial(explain_by_habits, wanted=wanted, examples=_EXAMPLES))


def _sections(name: str, seen: Seen, rounding: Outcome | None) -> tuple[Section, ...]:
    """The sections of the report: what to do first, then the evidence, the most important first."""
    damping: Damping | None = seen.damping.result
    damps = damping.faults if damping and not seen.ignores_step else []
    faults = [*damps, *(check.words for check in seen.checks if check.is_fault)]
    failed = [o for o in _questions(seen, rounding) if o.failed and o.kind != "unsupported_call"]
    opened: Introduction | None = seen.introduction.result
    stepper = [SIGNATURES[opened.calls], f"takes {opened.numbers}, works in {opened.format}"] if opened else []
    evidence = sections(
        ("What to do", _what_to_do(name, seen)),
        ("Faults", faults),
        ("Coefficients", [] if seen.read is None else [*seen.read.identity.lines, *seen.read.reading.lines]),
        ("Order", _orders(seen)),
        ("One-step matrix", [] if seen.fit is None else seen.fit.lines),
        ("Damping", damping.lines if damping and not damping.faults else []),
        ("Error estimate", _returned_besides_y1(seen.estimate)),
        ("Dense output", _returned_besides_y1(seen.dense)),
        ("Rounding", [] if rounding is None or rounding.failed else rounding.result.lines),
        ("Stepper", [*stepper, *filter(None, [seen.arithmetic])]),
    )
    answers = sections(("Not answered", without_duplicates(f"{o.kind}: {o.seen}" for o in failed)))
    return (*evidence, *_checks([check for check in seen.checks if not check.is_fault]), *answers)


def _checks(checks: Sequence[CheckResult]) -> tuple[Section, ...]:
    """The section of the checks that found no fault, with one line that counts those kept, traits and undecided."""
    traits = sum(check.key in TRAITS and check.holds is not None for check in checks)
    undecided = sum(check.holds is None for check in checks)
    counts = {"passed": len(checks) - traits - undecided, "on traits such as areas": traits, "undecided": undecided}
    brief = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    lines = tuple(check.words for check in checks)
    return (Section("Checks", lines, f"{brief}; --all shows each" if len(lines) > 1 else ""),) if lines else ()


def _what_to_do(name: str, seen: Seen) -> list[str]:
    """The next steps that the findings suggest."""
    held = verification(name)
    if seen.introduction.failed:
        helps = {
            "time_limit": "give it more time: --time-limit",
            "killed": "try again where nothing kills its process; running out of memory also kills processes",
            "instrument_failed": "report this to us",
        }
        return [helps.get(seen.introduction.kind or "", "make this one call return an answer, then try again")]
    lines = ["fix the faults first"] if any(check.is_fault for check in seen.checks) else []
    near = seen.read.identity.near if seen.read is not None else ()
    if near:
        key, wrong = near[0].key, "; ".join(near[0].differences)
        lines.append(f"if it should be {key}, correct this: {wrong}; then {held} {key}")
    elif seen.key is not None:
        solved = "" if seen.key not in METHODS or METHODS[seen.key].explicit else " --solver-tolerance 1e-10"
        lines.append(f"if it should be {seen.key}, verify it: {held} {seen.key}{solved}, or assert_verified in a test")
    else:
        lines.append(f"name the method it should be: {held} METHOD, or your own tableau in a .toml file")
    if seen.coefficients.failed and "is adaptive" in seen.coefficients.seen:
        lines.append(
            "if it adapts its step size, let a large tolerance accept each step, or examine a solver: --solver"
        )
    if seen.coefficients.kind == "unsupported_call":
        lines.append("to have its coefficients read, make the right-hand side or force an argument: step(f, t, y, h)")
    return lines


def _questions(seen: Seen, rounding: Outcome | None) -> Sequence[Outcome]:
    questions = seen.introduction, seen.coefficients, seen.linear, seen.order, seen.estimate, seen.dense
    return questions if rounding is None else (*questions, rounding)


def _returned_besides_y1(outcome: Outcome) -> list[str]:
    """The lines on an error estimate or a dense output, which is returned besides y1."""
    found: JudgedEstimate | JudgedDense | None = outcome.result
    return [] if found is None else [*found.lines, *found.faults]


def _orders(seen: Seen) -> list[str]:
    by_trees = [] if seen.read is None else seen.read.order.lines
    damped: MeasuredOrder | None = None if seen.damping.result is None else seen.damping.result.order
    measured = [found.words for found in (seen.measured if damped is None else (damped,))]
    linear_only = seen.order.kind == "unsupported_call"
    return [*by_trees, *measured, *(["the order on nonlinear problems is not known"] if linear_only else [])]


def _data(seen: Seen, rounding: Outcome | None) -> dict[str, Json]:
    read, fit = seen.read, seen.fit
    measured = seen.measured[0] if seen.measured else None
    return {
        "calls": None if seen.introduction.failed else seen.introduction.result.calls,
        "arithmetic": seen.arithmetic or None,
        "format": None if seen.introduction.failed else seen.introduction.result.format,
        "method": seen.key,
        "coefficients": None if read is None else [*read.identity.lines, *read.reading.lines],
        "matrix": None if fit is None else list(fit.lines),
        "order": None if read is None else read.order.order,
        "order_fails": None if read is None else read.order.failing_tree,
        "linear_order": None if fit is None or fit.facts is None else fit.facts.linear_order,
        "measured_order": None if measured is None else measured.order,
        "estimate": None if seen.estimate.result is None else seen.estimate.result.data,
        "dense": None if seen.dense.result is None else seen.dense.result.data,
        "rounding": None if rounding is None or rounding.failed else rounding.result.data,
        "damping": None if seen.damping.result is None else seen.damping.result.data,
        "checks": [check.as_dict() for check in seen.checks],
        "not_answered": [{"kind": o.kind, "seen": o.seen} for o in _questions(seen, rounding) if o.failed],
    }
