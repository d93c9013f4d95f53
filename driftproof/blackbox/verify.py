"""`verify` and `assert_verified`: a stepper's coefficients, rounding errors and order against those of a method."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from pathlib import Path
from typing import Any

from driftproof.blackbox import criteria
from driftproof.blackbox.checks.arguments import arguments, types
from driftproof.blackbox.checks.determinism import CALL_BEFORE
from driftproof.blackbox.checks.output_precision import digits
from driftproof.blackbox.families.magnetic import BORIS_NAMES, Boris
from driftproof.blackbox.families.reports import turns, verify_family
from driftproof.blackbox.findings import Outcome, RightInAnotherForm, StepFinding, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES, Agreement
from driftproof.blackbox.judging.habits import HABITS
from driftproof.blackbox.judging.nonlinear_step import NonlinearAgreement
from driftproof.blackbox.judging.specification import (
    NO_ALLOWANCE,
    ORDINARY_DOMAIN,
    Allowance,
    Domain,
    Specification,
)
from driftproof.blackbox.judging.tolerance import Tolerance
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.report import NOT_KNOWN, UNDECIDED, Basis, Criterion, Naming, Report, criteria_parts, sections
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS, FactsOnly
from driftproof.methods.schemes import Method
from driftproof.methods.tableau_file import method_of, subject_of
from driftproof.support.assertions import AssertedVerdict, assert_verdict, time_limit_of_test
from driftproof.symbolic.rounding.formats import BINARY64

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
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        if isinstance(found, FactsOnly | Boris):
            return verify_family(runner, found)
        asked = method_of(found)  # raises ValueError for a family
        if METHODS.get(asked.key, asked) != asked:  # a user's method under the key of another one
            asked = replace(asked, key=f"own_{asked.key}")
        wanted = Specification(asked, allowance, domain)
        Tolerance.of(wanted, BINARY64)  # an allowance without meaning is refused before anything runs
        return _report_on_one_step(runner, asked, criteria.questions_of(wanted, examples))


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
        limit = (time_limit_of_test.get() or TIME_LIMIT) if time_limit is None else time_limit
        options: dict[str, Any] = {"examples": examples, "domain": domain, "allowance": allowance}
        report = verify(step, method, calls=calls, array=array, time_limit=limit, isolate=isolate, **options)
    except ValueError as error:  # so that pytest shows the user's line and the message
        raise ValueError(str(error)) from None
    found = AssertedVerdict(report.target, report.verdict, report.passed, report.text(), report.data)
    assert_verdict(found, holds=report.passed is True or (report.passed is None and allow_undecided))
    if report.data.get("remarks"):
        warnings.warn(found.headline, stacklevel=2)


def _report_on_one_step(runner: IsolatedRunner, method: Method, questions: Sequence[criteria.Question]) -> Report:
    """The report on a stepper compared with a one-step method, or with one that turns if the stepper turns vectors."""
    replies = runner.run([*(question.ask for question in questions), *_REMARKS])
    seen = _Comparison(method, questions, dict(zip((each.title for each in questions), replies, strict=False)))
    rounding = seen.outcomes[criteria.ROUNDING]
    if rounding.kind == "bad_input":
        raise ValueError(rounding.seen)
    if rounding.kind == UnsupportedCall.kind and runner.outcome_of(turns).result:
        return verify_family(runner, method)
    target, made, arithmetic = runner.target.name, sum(reply.calls for reply in replies), arithmetic_of(replies)
    parts, data = criteria_parts([*seen.checks.values()], seen.passed)
    data |= {"remarks": [], "calls_made": made}
    if seen.passed is False:
        refuted = _refutation(runner, seen)
        data["instead"] = refuted.instead.data
        verdict = refuted.verdict if arithmetic in refuted.verdict else f"{refuted.verdict}; {arithmetic}"
        return Report(target, verdict, False, sections(*parts, *refuted.parts), data)
    remarked = (check for reply in replies[len(questions) :] for check in reply.result or ())
    remarks = [f"remark: {check.words}" for check in remarked if check.holds is False]
    data["remarks"] = list(remarks)
    verdict = "; ".join(filter(None, [seen.verdict, *remarks, *seen.unjudged, arithmetic]))
    parts.append(("Calls made", [f"{made} calls of the stepper"]))
    return Report(target, verdict, seen.passed, sections(*parts), data)


@dataclass(frozen=True)
class _Comparison:
    """A stepper beside a method: the questions asked of it, and the outcome of each by its title."""

    method: Method
    questions: Sequence[criteria.Question]
    outcomes: Mapping[str, Outcome]

    @cached_property
    def checks(self) -> Mapping[str, Criterion]:
        """The criteria by title; if one step is not known to be the method's, without those on further steps."""
        found = {each.title: each.criterion(self.method, self.outcomes[each.title]) for each in self.questions}
        if found[criteria.ROUNDING].passed is False or found[criteria.ROUNDING].missing:
            return {question.title: found[question.title] for question in self.questions if not question.only}
        return found

    @property
    def of_step(self) -> list[Criterion]:
        return [self.checks[title] for title in criteria.SINGLE_STEP_CRITERIA]

    @property
    def failed(self) -> list[Criterion]:
        return [check for check in self.checks.values() if check.passed is False]

    @property
    def passed(self) -> bool | None:
        """False if a criterion failed, None if one is open that decides; else True.

        Coefficients or nonlinear steps suffice. A stepper with its system built in is judged by its steps of that
        system.
        """
        return False if self.failed else None if self._open else True

    @property
    def _open(self) -> list[Criterion]:
        """The criteria that keep the verdict open: those of a single step, or else others whose answer is missing."""
        rounding, coefficients, nonlinear = decisive = self.of_step[:3]
        if rounding.mark == "not tested":  # the stepper takes one number only
            seen = coefficients.passed and nonlinear.passed
        else:
            built_in = not (coefficients.missing or nonlinear.missing)
            seen = rounding.passed and (built_in or coefficients.passed or nonlinear.passed)
        if not seen:
            return [check for check in decisive if not check.passed]
        others = (check for title, check in self.checks.items() if title not in criteria.SINGLE_STEP_CRITERIA)
        return [check for check in others if check.missing]

    @property
    def verdict(self) -> str:
        """The verdict if no criterion failed: what agrees, or what is undecided."""
        key, found = self.method.key, self.rounding
        if self._open:
            unseen = min(self._open, key=lambda check: check.mark != "undecided")
            what = "" if unseen.title in criteria.SINGLE_STEP_CRITERIA else f"{unseen.title.lower()}: "
            return f"{UNDECIDED} whether it is {key}: {what}{unseen.lines[-1]}"
        _, coefficients, nonlinear, _ = self.of_step
        if found is None:
            return f"is {key} for a single component: its coefficients agree, and {nonlinear.lines[0]}"
        where = " on q'' = -q" if coefficients.mark == nonlinear.mark == "not tested" else ""
        near = " in ".join(filter(None, [self.how_near, found.narrow]))
        bound = f"within the derived bound, the largest error {found.worst.error_over_bound:.2f} of it"
        return f"is {key}{where} {near}: {found.examples} steps {bound}"

    @property
    def unjudged(self) -> list[str]:
        """A line for what the step returns besides y1 if that could not be read."""
        titles = (criteria.ERROR_ESTIMATE, criteria.DENSE_OUTPUT)
        unread = [x for x in titles if self.outcomes[x].kind not in (None, UnsupportedCall.kind)]
        return [f"the {x.lower()} is not judged: {self.outcomes[x].seen}" for x in unread if not self.checks[x].missing]

    @property
    def rounding(self) -> Agreement | None:
        """The comparison of many steps; None if the stepper takes one number only."""
        found: Agreement | None = self.outcomes[criteria.ROUNDING].result
        return found

    @property
    def how_near(self) -> str:
        return "to roundoff" if self.method.explicit else "to the tolerance stated"

    @property
    def right_form(self) -> str:
        """The other form of the state in which the step is the method's; "" if there is none."""
        found: StepFinding | None = self.outcomes[criteria.STATE_FORMS].result
        return found.words if isinstance(found, RightInAnotherForm) else ""


@dataclass(frozen=True)
class _Refutation:
    """A comparison that failed, the report and name of what the stepper is instead, and mistakes that explain it."""

    seen: _Comparison
    instead: Report
    naming: Naming
    mistakes: Sequence[str]

    @property
    def verdict(self) -> str:
        """What the stepper is not and why, or what explains its errors: the first reason that holds."""
        return next(chain(self._departures(), self._explanations()), self._other_method)

    @property
    def parts(self) -> list[tuple[str, Sequence[str]]]:
        """The evidence for what the stepper is instead, as titles with lines."""
        read = self.instead.section("Coefficients") or self.instead.section("One-step matrix")
        shown = (read, self.instead.section("Faults"), self.instead.section("Not answered"))
        same_steps = [*self.mistakes, *filter(None, [self.seen.right_form])]
        evidence = [(section.title.lower(), section.lines) for section in shown if section]
        named = [("one mistake that gives the same steps", same_steps), *evidence]
        return [(f"Identified instead: {title}", lines) for title, lines in named]

    def _departures(self) -> Iterator[str]:
        """Yield the verdicts on a stepper that has the method's coefficients, or is the method but for one thing."""
        seen, key = self.seen, self.seen.method.key
        rounding, coefficients, nonlinear, order = seen.of_step
        agrees, stages = "its coefficients agree, but", coefficients.data.get("stages")
        if stages and False in (coefficients.passed, nonlinear.passed):
            yield f"is not {key} {seen.how_near}: {agrees} {stages}"
        beside = [seen.checks[title] for title in (criteria.ERROR_ESTIMATE, criteria.DENSE_OUTPUT)]
        wrong = [str(check.data.get("faults", check.lines)[0]) for check in beside if check.passed is False]
        if wrong and coefficients.passed:
            yield f"is {key}, but {'; '.join(wrong)}"
        only = {question.title: question.only for question in seen.questions if question.only}
        if {check.title for check in seen.failed} <= {*only}:
            first = max(seen.failed, key=lambda check: check.title == criteria.FIRST_CALL)
            yield f"is {key}{only[first.title]}: {first.lines[0]}"
        again: StepFinding | None = seen.outcomes[criteria.FIRST_CALL].result
        if again is not None and again.holds is False:
            yield f"is not {key}: its answers change from call to call: {again.words}"
        if seen.right_form and not self.instead.data["method"]:
            yield f"is not {key}; {seen.right_form}"
        failing = seen.rounding and order.passed is not False and seen.rounding.failing
        if failing and seen.rounding:
            habit = seen.rounding.but_for
            if habit and (coefficients.passed is not False or habit not in HABITS):
                yield f"is not {key} to roundoff; it is, {habit}"
            if coefficients.passed and failing.answer is not None:
                if CALL_BEFORE in self._faults:
                    yield f"is not {key}: {agrees} {CALL_BEFORE}"
                off = f"a step is off by {failing.error_over_bound:.3g} times the bound"
                yield f"is not {key} {seen.how_near}: {agrees} {off}"
        found: NonlinearAgreement | None = seen.outcomes[criteria.NONLINEAR_STEP].result
        if coefficients.passed and rounding.passed and found is not None and nonlinear.passed is False:
            names = f"{', '.join(found.wrong)} {'is' if len(found.wrong) == 1 else 'are'}"
            yield f"is not {key}: {agrees} on {found.problem}, {names} not what the coefficients give"

    def _explanations(self) -> Iterator[str]:
        """Yield the verdicts by the name that the stepper has, or by a mistake that gives its steps."""
        seen, naming, key, coefficients = self.seen, self.naming, self.seen.method.key, self.seen.of_step[1]
        if naming.basis is Basis.NO_ANSWER:
            yield self.instead.verdict
        reading, first = seen.outcomes[criteria.COEFFICIENTS].result, seen.failed[0]
        if coefficients.passed is None and isinstance(reading, ForceReading) and reading.refused:
            yield f"is not {key}: it is on q'' = F(q), but not on y' = f(t, y): {reading.refused}"
        named = key in naming.methods
        one_entry = len(coefficients.data.get("differences", ())) == 1 and naming.basis is Basis.NEAR and named
        by_linear_steps = naming.basis is Basis.LINEAR_ONLY and coefficients.passed is False
        unnamed = naming.basis in (Basis.UNKNOWN, Basis.UNDECIDED)
        if self.mistakes and not one_entry and (by_linear_steps or unnamed or naming.reserved or named):
            yield f"is not {key}; it is {key} with one mistake: {self.mistakes[0]}"
        if self.instead.section("Coefficients") is None and named:
            yield f"is not {key}: {first.lines[0 if first.title == criteria.ROUNDING else -1]}"
        if naming.basis is Basis.KNOWN and naming.methods[0] == key and naming.words == self.instead.verdict:
            yield f"is {key}, but not everywhere: {first.lines[0]}"

    @property
    def _other_method(self) -> str:
        """The verdict on a stepper that is another method, or none that is known."""
        coefficients, verdict = self.seen.of_step[1], self.instead.verdict
        wrong = "; ".join(coefficients.data.get("differences", ()))
        what = f": {wrong}" if wrong and wrong not in verdict else ""
        unread = self.seen.outcomes[criteria.COEFFICIENTS].kind == NotReadable.kind
        why = coefficients.lines if unread else self._faults
        return f"is not {self.seen.method.key}{what}; {verdict}{f': {why[0]}' if why and verdict == NOT_KNOWN else ''}"

    @property
    def _faults(self) -> Sequence[str]:
        section = self.instead.section("Faults")
        return section.lines if section else ()


def _refutation(runner: IsolatedRunner, seen: _Comparison) -> _Refutation:
    """Ask the runner's stepper what it is instead; a stepper that passes loads nothing of this."""
    from driftproof.blackbox.identify import identification_report
    from driftproof.blackbox.judging.single_mistakes import single_mistakes

    titles = criteria.COEFFICIENTS, criteria.ORDER, criteria.DENSE_OUTPUT
    read, order, dense = (seen.outcomes[title] for title in titles)
    instead, naming = identification_report(runner, read, order, dense)
    mistakes = runner.outcome_of(partial(single_mistakes, method=seen.method)).result or ()
    return _Refutation(seen, instead, naming, mistakes)
