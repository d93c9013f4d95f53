"""Does this code do what its name says, to roundoff? Coefficients, rounding and order against the exact method."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from driftproof.blackbox.checks.arguments import RETURNS_NOTHING, arguments
from driftproof.blackbox.checks.determinism import CALL_BEFORE
from driftproof.blackbox.families.multistep_runs import later_steps
from driftproof.blackbox.families.reports import turns, verify_family
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, Examined, IsolatedRunner
from driftproof.blackbox.judging.agreement import (
    EXAMPLES,
    NO_ALLOWANCE,
    ORDINARY_DOMAIN,
    Agreement,
    Domain,
    rows_together,
)
from driftproof.blackbox.judging.habits import ROUNDED, explained
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE, NonlinearAgreement, nonlinear_agreement
from driftproof.blackbox.judging.tolerance import Allowance, Tolerance
from driftproof.blackbox.judging.walks import back_and_on, walked
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.entries import mended, other_velocities, rational_method, side_by_side
from driftproof.blackbox.matching.estimates import JudgedEstimate, judged_estimate
from driftproof.blackbox.matching.match import Identity, match_method
from driftproof.blackbox.probes.force import NO_TABLEAU, ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading, read_coefficients
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import NO_ANSWER, Criterion, Report, criteria_parts, sections
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import FactsOnly
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.methods.tableau_file import method_of, subject_of
from driftproof.support.assertions import AssertedVerdict, demand, time_limit_of_test

# Questions without an answer that say nothing against a stepper, and what would answer them.
UNDECIDING = {
    "unsupported_call": "a stepper that takes a force, step(force, q, v, h), or a right-hand side, step(f, t, y, h)",
    "not_readable": "a step without what refused the reading",
    **{kind: "a longer time limit" if kind == "time_limit" else "a report to us" for kind in NO_EVIDENCE},
}


# Of what a stepper does besides one step, as a verdict says that it was not judged.
_BESIDES = (
    *("the error estimate is", "the dense output is", "steps with h < 0 are", "states in arrays are"),
    *("later steps of a run are", "other sizes and times are"),
)


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
    """Whether a float stepper is `method`: on q'' = -q to the definition's any-order rounding bound, and elsewhere.

    `step` is a callable or "package.module:name", `method` a catalogue key, a .toml file or a method. It is tried at
    `examples` floats of the `domain`, with what `allowance` adds to the bound. Where it takes a force or a right-hand
    side, its coefficients are read, it is held to the method's own step on a nonlinear problem with t, and its order is
    measured there; where its system is built in, its step of q'' = -q is all that is seen, and all that is said.

    The report's `passed` is True, False, or None: undecided, because neither the coefficients nor the nonlinear steps
    were seen. If it is False, the report says what the stepper is instead; if it is None, what would decide it. `calls`
    ("map", "force" or "field") and `array` are for steppers whose parameters do not tell how they are called.
    The whole of it takes `time_limit` seconds at most; what they do not suffice for was not seen. With `isolate` false
    it runs in this process, without a limit.

    Raises ValueError for a method, calls or an allowance that makes no sense, and for a domain that overflows.

    >>> from driftproof import verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", examples=50, isolate=False).passed
    True
    """
    if isinstance(found := subject_of(method), FactsOnly):
        with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
            return verify_family(runner, found)
    asked = method_of(found)  # which refuses a family
    Tolerance(asked, allowance=allowance)  # a question without sense is refused before anything runs
    agreed = partial(explained, method=asked, allowance=allowance, domain=domain, examples=examples)
    beside = partial(nonlinear_agreement, method=asked, allowance=allowance)
    back = partial(back_and_on, method=asked, allowance=allowance, domain=domain)
    rows = partial(rows_together, method=asked, allowance=allowance, domain=domain)
    elsewhere = partial(walked, method=asked, allowance=allowance, domain=domain)
    estimate = partial(judged_estimate, method=asked)
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        further: list[Callable[[Any], Any]] = [estimate, judged_dense, back, rows, later_steps, elsewhere, arguments]
        outcomes = runner.run([agreed, read_coefficients, beside, measured_orders, *further])
        if outcomes[0].kind == "bad_input":
            raise ValueError(outcomes[0].seen)
        if outcomes[0].kind == UnsupportedCall.kind and runner.run([turns])[0].result:
            return verify_family(runner, asked)
        checks = [criterion(asked, outcome) for criterion, outcome in zip(CRITERIA, outcomes, strict=False)]
        checks[1] = _held_to_tolerance(checks[1], outcomes[1], allowance)
        # Of an unknown map, or another one, further steps say no more.
        if checks[0].passed is False or checks[0].missing:
            del checks[6:]
        passed, arithmetic = _decided(checks), arithmetic_of(outcomes)
        if passed is False:
            from driftproof.blackbox.identify import identified
            from driftproof.blackbox.judging.single_mistakes import single_mistakes

            instead = identified(runner, outcomes[1], outcomes[3], outcomes[5])
            mistakes = runner.run([partial(single_mistakes, method=asked)])[0].result or ()
            refuted = _refuted(asked, checks, outcomes, instead, mistakes)
            named = refuted if arithmetic in refuted else f"{refuted}; {arithmetic}"
            return _report(runner.target, named, passed, checks, instead, mistakes)
    verdict = _agreed(asked, outcomes[0].result, checks) if passed else _not_decided(asked, checks)
    besides = [*_besides(outcomes), arithmetic]
    return _report(runner.target, "; ".join(filter(None, [verdict, *besides])), passed, checks)


def _besides(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """What is not of the step itself, and what of that could not be judged."""
    found = outcomes[-1].result or ()
    yield from (check.words for check in found if check.holds is False and not check.words.endswith(RETURNS_NOTHING))
    for name, outcome in zip(_BESIDES, outcomes[4:], strict=False):
        if outcome.failed and outcome.kind != UnsupportedCall.kind:
            yield f"{name} not judged: {outcome.seen}"


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
    """`verify`, for a test: raises AssertionError with the whole report unless the stepper passes.

    What is undecided fails, too, and the report says what would decide it; not so with `allow_undecided`. The time
    limit is that of the test's mark, `@pytest.mark.driftproof(time_limit=30)`, where none is given.

    >>> from driftproof import assert_verified
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> assert_verified(step, method="forward_euler", examples=50, isolate=False)
    """
    __tracebackhide__ = True
    report = verify(
        step,
        method,
        calls=calls,
        array=array,
        examples=examples,
        domain=domain,
        allowance=allowance,
        time_limit=time_limit or time_limit_of_test.get() or TIME_LIMIT,
        isolate=isolate,
    )
    found = AssertedVerdict(report.target, report.verdict, report.passed, report.text(), report.data)
    demand(found, holds=report.passed is True or (report.passed is None and allow_undecided))


def _decided(checks: Sequence[Criterion]) -> bool | None:
    """False where one failed. True where all that could be asked for was seen; coefficients or nonlinear steps will do.

    A stepper with its system built in shows its steps of that system alone, and no more is said of it.
    """
    rounding, coefficients, nonlinear, *_ = checks
    if any(check.passed is False for check in checks):
        return False
    if rounding.mark == "not asked":  # of one number only
        return coefficients.passed and nonlinear.passed
    built_in = not (coefficients.missing or nonlinear.missing)
    seen = rounding.passed and (built_in or coefficients.passed or nonlinear.passed)
    return True if seen else None


def _unanswered(title: str, outcome: Outcome) -> Criterion:
    missing = UNDECIDING.get(outcome.kind or "")
    if missing is None:
        return Criterion(title, False, (f"{outcome.kind}: {outcome.seen}",), {})
    return Criterion(title, None, (outcome.seen,), {}, "" if outcome.kind == "unsupported_call" else missing)


def _check_rounding(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return _unanswered("Rounding", outcome)
    found: Agreement = outcome.result
    return Criterion("Rounding", found.holds, tuple(found.lines), found.data)


def _check_coefficients(method: Method, outcome: Outcome) -> Criterion:
    """No refusal is dropped: what a force shows of a step that a right-hand side refutes is no tableau."""
    if outcome.failed:
        return _unanswered("Coefficients", outcome)
    reading: CoefficientReading = outcome.result
    solved = reading.solved
    if not method.explicit and solved is None:
        line = f"read as {reading.calls} explicit stages: iterations that are not counted by what they have come to"
        return Criterion("Coefficients", None, (line,), {}, "an iteration that ends where it has converged")
    identity = match_method(reading, method)
    if not identity.matches:
        return _other_coefficients(method, reading, identity)
    if isinstance(reading, ForceReading) and reading.refused and isinstance(method, RungeKutta):
        lines = (*identity.lines, f"{NO_TABLEAU}: {reading.refused}")
        return Criterion("Coefficients", None, lines, {}, UNDECIDING["not_readable"])
    if isinstance(reading, ForceReading) and reading.wrong_time:
        return Criterion("Coefficients", False, (f"called at wrong times: {reading.wrong_time}",), {})
    if isinstance(reading, ForceReading) and reading.a_velocity is not None:
        if isinstance(method, RungeKutta):
            found = other_velocities(method, reading)
            return Criterion("Coefficients", False, tuple(found), {"differences": found})
        if reading.velocities_limit_order and _claimed_order(method) > 1:
            lost = "order 1 where the force depends on the velocity"
            return Criterion("Coefficients", False, (lost, *reading.stale_velocities), {})
    if solved is not None:  # a solver that does not look has the method's coefficients, but not its step
        missing = "a solver that looks at what is left of its equations" if solved.power else ""
        lines = (*identity.lines, solved.words)
        return Criterion("Coefficients", None if missing else True, lines, {"stages": solved.words}, missing)
    return Criterion("Coefficients", True, tuple(identity.lines), {})


def _held_to_tolerance(check: Criterion, outcome: Outcome, allowance: Allowance) -> Criterion:
    """Failed where a solver stops early, and farther from the solution than the tolerance stated.

    It may be off by as much as on the nonlinear problem, numbers being of size 1.
    """
    reading: CoefficientReading | None = outcome.result
    solved = None if reading is None else reading.solved
    if check.passed is not None or solved is None or not solved.power:
        return check
    beyond = solved.curved > BEYOND_TOLERANCE * float(allowance.solver_tolerance or 0)
    return replace(check, passed=False, missing="") if beyond else check


def _other_coefficients(method: Method, reading: CoefficientReading, identity: Identity) -> Criterion:
    differences = [f"those of {near.key} but for {'; '.join(near.differences)}" for near in identity.near]
    lines = differences or [f"not those of {method.key}"]
    if isinstance(method, RungeKutta | Collocation) and (reading.implicit or isinstance(reading, TableauReading)):
        lines += side_by_side(reading, method)
    if isinstance(method, RungeKutta | Collocation) and isinstance(reading, TableauReading):
        read = rational_method(reading, "read")
        lines += mended(read, method.claimed_order) if read is not None else []
    found = [difference for near in identity.near for difference in near.differences]
    return Criterion("Coefficients", False, tuple(lines), {"differences": list(dict.fromkeys(found))})


def _check_nonlinear_step(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return _unanswered("Nonlinear step", outcome)
    found: NonlinearAgreement = outcome.result
    return Criterion("Nonlinear step", found.holds, (found.words,), {"largest": f"{found.largest:.6g}"})


def _check_order(method: Method, outcome: Outcome) -> Criterion:
    """A splitting claims its order on q'' = F(q), a Runge-Kutta method on every problem."""
    if outcome.failed:
        return _unanswered("Order", outcome)
    measured: tuple[MeasuredOrder, ...] = outcome.result
    found = measured[-1 if isinstance(method, Splitting | Nystrom) else 0]
    order = _claimed_order(method)
    passed = None if found.order is None else found.order >= order
    lines = (f"{method.key} has order {order}", found.words)
    return Criterion("Order", passed, lines, {"measured": found.order}, "" if passed is False else "smaller rounding")


def _check_estimate(method: Method, outcome: Outcome) -> Criterion:
    """A pair is both of its rows; of another method, what is returned beside y1 is nobody's claim."""
    if outcome.failed:  # who returns no estimate is not told so
        lines = () if outcome.kind == "unsupported_call" else (outcome.seen,)
        return Criterion("Error estimate", None, lines, {})
    found: JudgedEstimate = outcome.result
    if not isinstance(method, RungeKutta) or method.b_embedded is None:
        return Criterion("Error estimate", None, (f"{method.key} has none", *found.lines, *found.faults), found.data)
    passed = False if found.faults else None if found.pair is None else True
    return Criterion("Error estimate", passed, (*found.lines, *found.faults), found.data)


def _check_dense(method: Method, outcome: Outcome) -> Criterion:
    """Nobody claims a dense output by the name of a method: what fails is one that does not fit to the steps."""
    if outcome.failed:
        lines = () if outcome.kind == "unsupported_call" else (outcome.seen,)
        return Criterion("Dense output", None, lines, {})
    found: JudgedDense = outcome.result
    return Criterion("Dense output", not found.faults, (*found.lines, *found.faults), found.data)


def _check_calls(title: str, method: Method, outcome: Outcome) -> Criterion:
    """Of calls that a stepper may refuse."""
    if outcome.failed:
        return Criterion(title, None, (outcome.seen,), {})
    passed, words, reproduction = outcome.result
    again = [f"to see it again: {reproduction}"] if reproduction else []
    return Criterion(title, passed, (words, *again), {})


def _claimed_order(method: Method) -> int:
    """The order claimed; where nobody claims one, the one derived."""
    from driftproof.symbolic.facts import general_order

    return method.claimed_order or general_order(method).order


CRITERIA: Sequence[Callable[[Method, Outcome], Criterion]] = (
    _check_rounding,
    _check_coefficients,
    _check_nonlinear_step,
    _check_order,
    _check_estimate,
    _check_dense,
    partial(_check_calls, "Steps back"),
    partial(_check_calls, "Rows"),
    partial(_check_calls, "Later steps"),
    partial(_check_calls, "Steps elsewhere"),
)


def _agreed(method: Method, found: Agreement | None, checks: Sequence[Criterion]) -> str:
    if found is None:
        return f"is {method.key} of one number: its coefficients are, and {checks[2].lines[0]}"
    where = " on q'' = -q" if checks[1].mark == checks[2].mark == "not asked" else ""
    return (
        f"is {method.key}{where} {_how_near(method)}: {found.examples} steps within the derived bound, "
        f"the largest error {found.worst.error_over_bound:.2f} of it"
    )


def _how_near(method: Method) -> str:
    return "to roundoff" if method.explicit else "to the tolerance stated"


def _not_decided(method: Method, checks: Sequence[Criterion]) -> str:
    unseen = next(check for check in checks if check.mark == "undecided")
    return f"undecided whether it is {method.key}: {unseen.lines[-1]}"


def _refuted(
    method: Method, checks: Sequence[Criterion], outcomes: Sequence[Outcome], instead: Report, mistakes: Sequence[str]
) -> str:
    """What it is not, and why; where nothing but the rounding errors is wrong, how they come, as far as is known."""
    (rounding, coefficients, nonlinear, order), beside, back = checks[:4], checks[4:6], checks[6:]
    found: Agreement | None = outcomes[0].result
    others = all(check.passed is not False for check in (coefficients, nonlinear, order, *beside))
    stages = coefficients.data.get("stages")
    if stages and False in (coefficients.passed, nonlinear.passed):
        return f"is not {method.key} {_how_near(method)}: its coefficients are, but {stages}"
    wrong_beside = [str(check.data["faults"][0]) for check in beside if check.passed is False]
    if wrong_beside and coefficients.passed:
        return f"is {method.key}, but {'; '.join(wrong_beside)}"
    if others and back[3:] and back[3].passed is False:
        return f"is {method.key}, but not everywhere: {back[3].lines[0]}"
    for check, only in zip(back, ("h > 0", "one state at a time", "its first step"), strict=False):
        if others and check.passed is False:
            return f"is {method.key} for {only} only: {check.lines[0]}"
    if found is not None and found.failing is not None and order.passed is not False:
        if found.but_for and (coefficients.passed is not False or found.but_for.startswith(ROUNDED)):
            return f"is not {method.key} to roundoff; it is, {found.but_for}"
        faults = instead.section("Faults")
        if coefficients.passed and found.failing.answer is not None:
            if faults is not None and CALL_BEFORE in faults.lines:
                return f"is not {method.key}: its coefficients are, but {CALL_BEFORE}"
            off = f"a step is off by {found.failing.error_over_bound:.3g} times the bound"
            return f"is not {method.key} {_how_near(method)}: its coefficients are, but {off}"
    if coefficients.passed and rounding.passed and outcomes[2].result is not None and nonlinear.passed is False:
        seen: NonlinearAgreement = outcomes[2].result
        wrong = f"{', '.join(seen.wrong)} {'is' if len(seen.wrong) == 1 else 'are'} not what they say"
        return f"is not {method.key}: its coefficients are, but on {seen.problem}, {wrong}"
    if instead.verdict.startswith(NO_ANSWER):
        return instead.verdict
    linear = coefficients.passed is False and "as far as linear steps tell" in instead.verdict
    vague = linear or re.search(rf"\b{method.key}\b|it is no method|, but |\bnearly |with a drag", instead.verdict)
    reading = outcomes[1].result
    if coefficients.passed is None and isinstance(reading, ForceReading) and reading.refused:
        return f"is not {method.key}: it is on q'' = F(q), but not on y' = f(t, y): {reading.refused}"
    differences = coefficients.data.get("differences", ())
    one_entry = len(differences) == 1 and instead.verdict.startswith(f"it is {method.key} but for ")
    if mistakes and not one_entry and (vague or not instead.verdict.startswith("it is")):
        link = "but for" if " instead of " in mistakes[0] else "with one mistake:"
        return f"is not {method.key}; it is {method.key} {link} {mistakes[0]}"
    if instead.section("Coefficients") is None and re.search(rf"\b{method.key}\b", instead.verdict):
        failed = next(check for check in checks if check.passed is False)
        return f"is not {method.key}: {failed.lines[0 if failed is rounding else -1]}"
    wrong = "; ".join(differences)
    if linear and wrong:
        return f"is not {method.key}: {wrong}"
    if re.fullmatch(rf"it is {method.key}(, the same step as [\w, ]*)?", instead.verdict):
        failed = next(check for check in checks if check.passed is False)
        return f"is {method.key}, but not everywhere: {failed.lines[0]}"
    what = f": {wrong}" if wrong and wrong not in instead.verdict else ""
    faults = instead.section("Faults")
    why = [*coefficients.lines] if outcomes[1].kind == "not_readable" else [*(faults.lines if faults else ())]
    cause = f": {why[0]}" if why and "it is no method" in instead.verdict else ""
    return f"is not {method.key}{what}; {instead.verdict}{cause}"


def _report(
    target: Examined,
    verdict: str,
    passed: bool | None,
    checks: Sequence[Criterion],
    instead: Report | None = None,
    mistakes: Sequence[str] = (),
) -> Report:
    parts, data = criteria_parts(checks, passed)
    if instead is not None:
        read = instead.section("Coefficients") or instead.section("One-step matrix")
        shown = [section for section in (read, instead.section("Faults"), instead.section("Not answered")) if section]
        parts.append(("What it is: one mistake that takes the same steps", tuple(mistakes)))
        parts += [(f"What it is: {section.title.lower()}", section.lines) for section in shown]
        data["instead"] = instead.data
    return Report(target.name, verdict, passed, sections(*parts), data)
