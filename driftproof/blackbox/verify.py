"""`verify` and `assert_verified`: a stepper's coefficients, rounding errors and order against those of a method."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from driftproof.blackbox import criteria
from driftproof.blackbox.checks.arguments import arguments, types
from driftproof.blackbox.checks.determinism import CALL_BEFORE
from driftproof.blackbox.checks.output_precision import digits
from driftproof.blackbox.families.magnetic import BORIS_NAMES, Boris
from driftproof.blackbox.families.reports import turns, verify_family
from driftproof.blackbox.findings import Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, Examined, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES, NO_ALLOWANCE, ORDINARY_DOMAIN, Agreement, Domain
from driftproof.blackbox.judging.habits import ROUNDED
from driftproof.blackbox.judging.nonlinear_step import NonlinearAgreement
from driftproof.blackbox.judging.state_objects import RIGHT_AS
from driftproof.blackbox.judging.tolerance import Allowance, Tolerance
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.report import NOT_KNOWN, UNDECIDED, Basis, Criterion, Naming, Report, criteria_parts, sections
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS, FactsOnly
from driftproof.methods.schemes import Method
from driftproof.methods.tableau_file import method_of, subject_of
from driftproof.support.assertions import AssertedVerdict, assert_verdict, time_limit_of_test

# What a verdict of `verify` that passes remarks on, besides its criteria.
_REMARKS = (arguments, digits, types)


def verify(
    step: Callable[..., Any] | str,
    method: str | Path | Method | FactsOnly,
    *,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    examples: int = EXAMPLES,
    domain: Domain = ORDINARY_DOMAIN,
    allowance: Allowance = NO_ALLOWANCE,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Verify that a float stepper is `method`: on q'' = -q to the method's any-order rounding bound, and elsewhere.

    `step` is a callable or "package.module:name"; `method` is a catalogue key, a .toml file, a method, or "boris" for a
    step in a magnetic field. The stepper is tried at `examples` floats from the `domain`; `allowance` adds to the
    bound. If it takes a force or a right-hand side, its coefficients are read, its steps of a nonlinear problem with t
    are compared with the method's own, and its order is measured there. If its system is built in, only its steps of
    q'' = -q are seen, and the verdict says no more.

    The report's `passed` is True, False, or None for undecided, as when neither coefficients nor nonlinear steps were
    seen. If it is False, the report says what the stepper is instead; if it is None, what would decide it. `calls`
    ("map", "force" or "field") and `array` are for steppers whose parameters do not show how they are called. All
    questions together take at most `time_limit` seconds; those left without time count as not seen. If `isolate` is
    false, the stepper runs in this process, without a limit.

    Raises ValueError for a method, calls or an allowance that makes no sense, and for a domain that overflows.

    >>> from driftproof import verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", examples=50, isolate=False).passed
    True
    """
    found = Boris() if isinstance(method, str) and method.lower() in BORIS_NAMES else subject_of(method)
    if isinstance(found, FactsOnly | Boris):
        with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
            return verify_family(runner, found)
    asked = method_of(found)  # raises ValueError for a family
    if METHODS.get(asked.key, asked) != asked:  # a user's method under the key of another one
        asked = replace(asked, key=f"own_{asked.key}")
    Tolerance(asked, allowance=allowance)  # an allowance without meaning is refused before anything runs
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        questions = criteria.questions_of(asked, allowance, domain, examples)
        asked_for = [*(question.ask for question in questions), *_REMARKS]
        answers, remarks = (replies := runner.run(asked_for))[: len(questions)], replies[len(questions) :]
        outcomes = {question.title: outcome for question, outcome in zip(questions, answers, strict=True)}
        rounding = outcomes[criteria.ROUNDING]
        if rounding.kind == "bad_input":
            raise ValueError(rounding.seen)
        if rounding.kind == UnsupportedCall.kind and runner.outcome_of(turns).result:
            return verify_family(runner, asked)
        checks = {question.title: question.criterion(asked, outcomes[question.title]) for question in questions}
        if checks[criteria.ROUNDING].passed is False or checks[criteria.ROUNDING].missing:
            checks = {question.title: checks[question.title] for question in questions if not question.only}
        passed, arithmetic = _decided(checks), arithmetic_of(replies)
        made = sum(outcome.calls for outcome in replies)
        if passed is False:
            from driftproof.blackbox.identify import identification_report
            from driftproof.blackbox.judging.single_mistakes import single_mistakes

            titles = criteria.COEFFICIENTS, criteria.ORDER, criteria.DENSE_OUTPUT
            read, order, dense = (outcomes[title] for title in titles)
            instead, naming = identification_report(runner, read, order, dense)
            mistakes = runner.outcome_of(partial(single_mistakes, method=asked)).result or ()
            same_steps = [*mistakes, *filter(None, [_right_form(outcomes)])]
            refuted = _refuted(asked, questions, checks, outcomes, instead, naming, mistakes)
            named = refuted if arithmetic in refuted else f"{refuted}; {arithmetic}"
            return _report(runner.target, named, passed, checks, made, instead, same_steps)
    verdict = _agreed(asked, rounding.result, checks) if passed else _not_decided(asked, checks)
    remarked = [
        f"remark: {check.words}" for outcome in remarks for check in outcome.result or () if check.holds is False
    ]
    unjudged = [
        f"the {title.lower()} is not judged: {outcomes[title].seen}"
        for title in (criteria.ERROR_ESTIMATE, criteria.DENSE_OUTPUT)
        if outcomes[title].kind not in (None, UnsupportedCall.kind) and not checks[title].missing
    ]
    whole = "; ".join(filter(None, [verdict, *remarked, *unjudged, arithmetic]))
    return _report(runner.target, whole, passed, checks, made, remarks=remarked)


def assert_verified(
    step: Callable[..., Any] | str,
    method: str | Path | Method | FactsOnly,
    *,
    allow_undecided: bool = False,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    examples: int = EXAMPLES,
    domain: Domain = ORDINARY_DOMAIN,
    allowance: Allowance = NO_ALLOWANCE,
    time_limit: float | None = None,
    isolate: bool = True,
) -> None:
    """Raise AssertionError with the whole report of `verify` unless the stepper passes: for a test.

    An undecided verdict fails as well, and the report says what would decide it, unless `allow_undecided` is true. A
    verdict that passes with a remark, such as answers that are rounded to binary32, is warned of (UserWarning). The
    default time limit is that of the test's mark, `@pytest.mark.driftproof(time_limit=30)`, or else that of `verify`.

    >>> from driftproof import assert_verified
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> assert_verified(step, method="forward_euler", examples=50, isolate=False)
    """
    __tracebackhide__ = True
    try:
        report = verify(
            step,
            method,
            calls=calls,
            array=array,
            examples=examples,
            domain=domain,
            allowance=allowance,
            time_limit=(time_limit_of_test.get() or TIME_LIMIT) if time_limit is None else time_limit,
            isolate=isolate,
        )
    except ValueError as error:  # so that pytest shows the user's line and the message
        raise ValueError(str(error)) from None
    found = AssertedVerdict(report.target, report.verdict, report.passed, report.text(), report.data)
    assert_verdict(found, holds=report.passed is True or (report.passed is None and allow_undecided))
    if report.data.get("remarks"):
        warnings.warn(found.headline, stacklevel=2)


def _decided(checks: Mapping[str, Criterion]) -> bool | None:
    """False if a criterion failed, None if one is open that decides; else True.

    Coefficients or nonlinear steps suffice. A stepper with its system built in is judged by its steps of that system.
    """
    if any(check.passed is False for check in checks.values()):
        return False
    return None if _open(checks) else True


def _open(checks: Mapping[str, Criterion]) -> list[Criterion]:
    """The criteria that keep the verdict open: those of a single step, or else others whose answer is missing."""
    rounding, coefficients, nonlinear = of_step = [
        checks[title] for title in (criteria.ROUNDING, criteria.COEFFICIENTS, criteria.NONLINEAR_STEP)
    ]
    if rounding.mark == "not tested":  # the stepper takes one number only
        seen = coefficients.passed and nonlinear.passed
    else:
        built_in = not (coefficients.missing or nonlinear.missing)
        seen = rounding.passed and (built_in or coefficients.passed or nonlinear.passed)
    if not seen:
        return [check for check in of_step if not check.passed]
    return [check for title, check in checks.items() if title not in criteria.SINGLE_STEP_CRITERIA and check.missing]


def _agreed(method: Method, found: Agreement | None, checks: Mapping[str, Criterion]) -> str:
    coefficients, nonlinear = checks[criteria.COEFFICIENTS], checks[criteria.NONLINEAR_STEP]
    if found is None:
        return f"is {method.key} for a single component: its coefficients agree, and {nonlinear.lines[0]}"
    where = " on q'' = -q" if coefficients.mark == nonlinear.mark == "not tested" else ""
    near = " in ".join(filter(None, [_how_near(method), found.narrow]))
    bound = f"within the derived bound, the largest error {found.worst.error_over_bound:.2f} of it"
    return f"is {method.key}{where} {near}: {found.examples} steps {bound}"


def _how_near(method: Method) -> str:
    return "to roundoff" if method.explicit else "to the tolerance stated"


def _not_decided(method: Method, checks: Mapping[str, Criterion]) -> str:
    unseen = min(_open(checks), key=lambda check: check.mark != "undecided")
    what = "" if unseen.title in criteria.SINGLE_STEP_CRITERIA else f"{unseen.title.lower()}: "
    return f"{UNDECIDED} whether it is {method.key}: {what}{unseen.lines[-1]}"


def _refuted(
    method: Method,
    questions: Sequence[criteria.Question],
    checks: Mapping[str, Criterion],
    outcomes: Mapping[str, Outcome],
    instead: Report,
    naming: Naming,
    mistakes: Sequence[str],
) -> str:
    """The verdict on a stepper that failed: what it is not and why, or what explains its rounding errors."""
    rounding, coefficients, nonlinear, order = (checks[title] for title in criteria.SINGLE_STEP_CRITERIA)
    beside = [checks[criteria.ERROR_ESTIMATE], checks[criteria.DENSE_OUTPUT]]
    found: Agreement | None = outcomes[criteria.ROUNDING].result
    of_step = all(check.passed is not False for check in (coefficients, nonlinear, order, *beside))
    failed = next(check for check in checks.values() if check.passed is False)
    faults = instead.section("Faults")
    stages = coefficients.data.get("stages")
    if stages and False in (coefficients.passed, nonlinear.passed):
        return f"is not {method.key} {_how_near(method)}: its coefficients agree, but {stages}"
    wrong_beside = [str(check.data.get("faults", check.lines)[0]) for check in beside if check.passed is False]
    if wrong_beside and coefficients.passed:
        return f"is {method.key}, but {'; '.join(wrong_beside)}"
    for question in sorted(questions, key=lambda each: each.title != criteria.FIRST_CALL) if of_step else ():
        check = checks.get(question.title)
        if question.only and check and check.passed is False:
            return f"is {method.key}{question.only}: {check.lines[0]}"
    unlike = outcomes[criteria.FIRST_CALL].result
    if unlike is not None and unlike[0] is False:
        return f"is not {method.key}: its answers change from call to call: {unlike[1]}"
    form = _right_form(outcomes)
    if form and not instead.data["method"]:
        return f"is not {method.key}; {form}"
    if found is not None and found.failing is not None and order.passed is not False:
        if found.but_for and (coefficients.passed is not False or found.but_for.startswith(ROUNDED)):
            return f"is not {method.key} to roundoff; it is, {found.but_for}"
        if coefficients.passed and found.failing.answer is not None:
            if faults is not None and CALL_BEFORE in faults.lines:
                return f"is not {method.key}: its coefficients agree, but {CALL_BEFORE}"
            off = f"a step is off by {found.failing.error_over_bound:.3g} times the bound"
            return f"is not {method.key} {_how_near(method)}: its coefficients agree, but {off}"
    seen: NonlinearAgreement | None = outcomes[criteria.NONLINEAR_STEP].result
    if coefficients.passed and rounding.passed and seen is not None and nonlinear.passed is False:
        wrong = f"{', '.join(seen.wrong)} {'is' if len(seen.wrong) == 1 else 'are'} not what the coefficients give"
        return f"is not {method.key}: its coefficients agree, but on {seen.problem}, {wrong}"
    if naming.basis is Basis.NO_ANSWER:
        return instead.verdict
    read = outcomes[criteria.COEFFICIENTS]
    reading = read.result
    if coefficients.passed is None and isinstance(reading, ForceReading) and reading.refused:
        return f"is not {method.key}: it is on q'' = F(q), but not on y' = f(t, y): {reading.refused}"
    differences = coefficients.data.get("differences", ())
    one_entry = len(differences) == 1 and naming.basis is Basis.NEAR and method.key in naming.methods
    by_linear_steps = naming.basis is Basis.LINEAR_ONLY and coefficients.passed is False
    unnamed = naming.basis in (Basis.UNKNOWN, Basis.UNDECIDED)
    unclear = by_linear_steps or unnamed or naming.reserved or method.key in naming.methods
    if mistakes and unclear and not one_entry:
        link = "except for" if " instead of " in mistakes[0] else "with one mistake:"
        return f"is not {method.key}; it is {method.key} {link} {mistakes[0]}"
    if instead.section("Coefficients") is None and method.key in naming.methods:
        return f"is not {method.key}: {failed.lines[0 if failed is rounding else -1]}"
    wrong = "; ".join(differences)
    if naming.basis is Basis.KNOWN and naming.methods[0] == method.key and naming.words == instead.verdict:
        return f"is {method.key}, but not everywhere: {failed.lines[0]}"
    what = f": {wrong}" if wrong and wrong not in instead.verdict else ""
    why = [*coefficients.lines] if read.kind == "not_readable" else [*(faults.lines if faults else ())]
    cause = f": {why[0]}" if why and instead.verdict == NOT_KNOWN else ""
    return f"is not {method.key}{what}; {instead.verdict}{cause}"


def _right_form(outcomes: Mapping[str, Outcome]) -> str:
    """The other form of the state in which the step is the method's; "" if there is none."""
    _, words, _ = outcomes[criteria.STATE_FORMS].result or (None, "", "")
    return words if words.startswith(RIGHT_AS) else ""


def _report(
    target: Examined,
    verdict: str,
    passed: bool | None,
    checks: Mapping[str, Criterion],
    made: int,
    instead: Report | None = None,
    mistakes: Sequence[str] = (),
    remarks: Sequence[str] = (),
) -> Report:
    parts, data = criteria_parts([*checks.values()], passed)
    data["remarks"] = list(remarks)
    data["calls_made"] = made
    if instead is None:
        parts.append(("Calls made", [f"{made} calls of the stepper"]))
    else:
        read = instead.section("Coefficients") or instead.section("One-step matrix")
        shown = [section for section in (read, instead.section("Faults"), instead.section("Not answered")) if section]
        parts.append(("Identified instead: one mistake that gives the same steps", tuple(mistakes)))
        parts += [(f"Identified instead: {section.title.lower()}", section.lines) for section in shown]
        data["instead"] = instead.data
    return Report(target.name, verdict, passed, sections(*parts), data)
