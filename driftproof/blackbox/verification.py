"""The verdict on a stepper beside a method: what agrees, what is undecided, or what the stepper is instead and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from driftproof.blackbox import criteria
from driftproof.blackbox.checks.arguments import DIVIDES, ROUNDED
from driftproof.blackbox.checks.determinism import CALL_BEFORE, MEMORY
from driftproof.blackbox.checks.domain import LARGE_STATES
from driftproof.blackbox.findings import Outcome, RightInAnotherForm, StepFinding, UnsupportedCall
from driftproof.blackbox.judging.agreement import Agreement
from driftproof.blackbox.judging.habits import HABITS
from driftproof.blackbox.judging.nonlinear_step import NonlinearAgreement
from driftproof.blackbox.judging.systems.own_system import AsOnOwnSystem, NotOnOwnSystem
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.report import NOT_KNOWN, UNDECIDED, Basis, Criterion, refusal
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, Splitting
from driftproof.symbolic.known_methods import EXCHANGED, turned_over

if TYPE_CHECKING:
    from driftproof.blackbox.identify import Identification


@dataclass(frozen=True)
class Verification:
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
        """The criteria of a single step: rounding, coefficients, nonlinear step, order."""
        return [self.checks[title] for title in criteria.SINGLE_STEP_CRITERIA]

    @property
    def failed(self) -> list[Criterion]:
        """The criteria that failed, in the order of the report."""
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
            if self.outcomes[criteria.ROUNDING].kind == AsOnOwnSystem.kind:
                return self.outcomes[criteria.ROUNDING].seen
            unseen = min(self._open, key=lambda check: check.mark != "undecided")
            what = "" if unseen.title in criteria.SINGLE_STEP_CRITERIA else f"{unseen.title.lower()}: "
            return f"{UNDECIDED} whether it is {key}: {what}{unseen.lines[-1]}"
        _, coefficients, nonlinear, _ = self.of_step
        if found is None:
            return f"is {key} for a single component: its coefficients agree, and {nonlinear.lines[0]}"
        where = " on q'' = -q" if coefficients.mark == nonlinear.mark == "not tested" else ""
        where += f", {found.oscillators} oscillators in one state," * (found.oscillators > 1)
        near = " in ".join(filter(None, [self.how_near, found.narrow]))
        steps, largest = f"{found.examples} steps {found.bound}", f"{found.worst.error_over_bound:.2f}"
        return f"is {key}{where} {near}: {steps}, the largest error {largest} of it"

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
        """What a step of the method is held to."""
        return "to roundoff" if self.method.explicit else "to the tolerance stated"

    @property
    def right_form(self) -> str:
        """The other form of the state in which the step is the method's; "" if there is none."""
        found: StepFinding | None = self.outcomes[criteria.STATE_FORMS].result
        return found.words if isinstance(found, RightInAnotherForm) else ""


@dataclass(frozen=True)
class Refutation:
    """A comparison that failed, what the stepper is instead, and mistakes that explain it."""

    seen: Verification
    instead: Identification
    mistakes: Sequence[str]

    @property
    def verdict(self) -> str:
        """What the stepper is not, with the reason, or else what it is."""
        return self.reason or self._other_method

    @cached_property
    def reason(self) -> str:
        """Why it is not the method, or what explains its errors: the first reason that holds; "" if none does."""
        return next(chain(self._departures(), self._explanations()), "")

    @property
    def parts(self) -> list[tuple[str, Sequence[str]]]:
        """The evidence for what the stepper is instead, as titles with lines."""
        report = self.instead.report
        if self.instead.seen.naming.basis is Basis.NO_ANSWER:  # the criteria say why
            return [(section.title, section.lines) for section in report.sections if section.title == "What to do"]
        read = report.section("Coefficients") or report.section("One-step matrix")
        shown = (read, report.section("Faults"), report.section("Not answered"))
        same_steps = [*self.mistakes, *filter(None, [self.seen.right_form])]
        evidence = [(section.title.lower(), section.lines) for section in shown if section]
        named = [("one mistake that gives the same steps", same_steps), *evidence]
        return [(f"Identified instead: {title}", lines) for title, lines in named]

    def _departures(self) -> Iterator[str]:
        """Yield the verdicts on a stepper that has the method's coefficients, or is the method but for one thing."""
        seen, key = self.seen, self.seen.method.key
        rounding, coefficients, nonlinear, order = seen.of_step
        elsewhere = seen.outcomes[criteria.ROUNDING]
        if elsewhere.kind == NotOnOwnSystem.kind and self.instead.seen.naming.basis is not Basis.LINEAR_ONLY:
            yield refusal(key, self.mistakes, elsewhere.seen, " on the slopes of its shortest steps")
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
        if seen.right_form and not self.instead.report.data["method"]:
            yield f"is not {key}; {seen.right_form}"
        if order.passed is not False:
            yield from self._beyond_the_bound(coefficients.passed, agrees)
        found: NonlinearAgreement | None = seen.outcomes[criteria.NONLINEAR_STEP].result
        if coefficients.passed and rounding.passed and found is not None and nonlinear.passed is False:
            names = f"{', '.join(found.worst.wrong)} {'is' if len(found.worst.wrong) == 1 else 'are'}"
            yield f"is not {key}: {agrees} on {found.problem}, {names} not what the coefficients give"

    def _beyond_the_bound(self, same_coefficients: bool | None, agrees: str) -> Iterator[str]:
        """Yield the verdicts on a step that is off by more than rounding: but for a habit, or by how many bounds."""
        seen, key = self.seen, self.seen.method.key
        if not seen.rounding or not (failing := seen.rounding.failing):
            return
        habit, checks = seen.rounding.but_for, self.instead.seen.checks
        if habit and (same_coefficients is not False or habit not in HABITS):
            yield f"is not {key} {seen.how_near}; it is, {habit}"
        if same_coefficients and failing.answer is not None:
            if any(check.key == MEMORY and check.is_fault for check in checks):
                yield f"is not {key}: {agrees} {CALL_BEFORE}"
            off, solved = failing.error_over_bound, seen.rounding.solver_tolerance
            as_if = f", as if its stages were solved to {off * solved:.1e} of 1 and of their size" if solved else ""
            still = [check.words for check in checks if check.what == ROUNDED]
            sums = "".join(f"; {words}, as weights of states that do not sum to 1 do" for words in still)
            yield f"is not {key} {seen.how_near}: {agrees} a step is off by {off:.3g} times the bound{as_if}{sums}"

    def _explanations(self) -> Iterator[str]:
        """Yield the verdicts by the name that the stepper has, or by a mistake that gives its steps."""
        seen, naming = self.seen, self.instead.seen.naming
        key, coefficients = seen.method.key, seen.of_step[1]
        if naming.basis is Basis.NO_ANSWER:
            yield self.instead.report.verdict
        reading, first = seen.outcomes[criteria.COEFFICIENTS].result, seen.failed[0]
        if coefficients.passed is None and isinstance(reading, ForceReading) and reading.refused:
            yield f"is not {key}: it is on q'' = F(q), but not on y' = f(t, y): {reading.refused}"
        named = key in naming.methods
        one_entry = len(coefficients.data.get("differences", ())) == 1 and naming.basis is Basis.NEAR and named
        by_linear_steps = naming.basis is Basis.LINEAR_ONLY and coefficients.passed is False
        unnamed = naming.basis in (Basis.UNKNOWN, Basis.UNDECIDED)
        on_another = seen.outcomes[criteria.ROUNDING].kind == NotOnOwnSystem.kind
        if self.mistakes and not (one_entry or on_another) and (by_linear_steps or unnamed or naming.reserved or named):
            yield refusal(key, self.mistakes)
        if self.instead.seen.read is None and (named or naming.basis is Basis.UNDECIDED):
            yield f"is not {key}: {first.lines[0 if first.title == criteria.ROUNDING else -1]}"
        if naming.basis is Basis.KNOWN and naming.methods[0] == key and not self.instead.doubts:
            yield f"is {key}, but not everywhere: {first.lines[0]}"

    @property
    def _other_method(self) -> str:
        coefficients, verdict, key = self.seen.of_step[1], self.instead.report.verdict, self.seen.method.key
        naming, doubts = self.instead.seen.naming, self.instead.doubts
        wrong = coefficients.data.get("differences", ())
        what = f": {'; '.join(wrong)}" if not {*wrong} <= {*naming.differences} else ""
        if naming.variant and naming.methods[0] == key and not what:
            return "; ".join([f"is not {key}, but a variant of it, {naming.variant}", *doubts])
        unread = self.seen.outcomes[criteria.COEFFICIENTS].kind == NotReadable.kind
        why = coefficients.lines if unread else self._faults
        if isinstance(self.seen.method, Splitting) and naming.basis is Basis.KNOWN and not (naming.variant or doubts):
            exchanged = dict(turned_over(self.seen.method))[EXCHANGED].parts
            same = getattr(METHODS[naming.methods[0]], "parts", ()) == exchanged
            verdict += f", which is {key} with {EXCHANGED}" * same
        return f"is not {key}{what}; {verdict}{f': {why[0]}' if why and verdict == NOT_KNOWN else ''}"

    @property
    def _faults(self) -> Sequence[str]:
        """The faults that may be why it is no known method, overflow as the least of them last."""
        seen = self.instead.seen
        found = [check for check in seen.checks if check.is_fault and check.what != DIVIDES]
        return [*seen.damps, *(check.words for check in sorted(found, key=lambda check: check.key == LARGE_STATES))]
