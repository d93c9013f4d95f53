"""`verify` and `assert_verified`: a stepper's coefficients, rounding errors and order against those of a method."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from driftproof.blackbox import criteria
from driftproof.blackbox.checks.arguments import ZERO_STEP, arguments, types
from driftproof.blackbox.checks.homogeneity import digits
from driftproof.blackbox.checks.step_size import IGNORED, STEP_SIZE
from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.families.damping import read_damping
from driftproof.blackbox.families.magnetic import BORIS_NAMES, Boris
from driftproof.blackbox.families.multistep import Corrected
from driftproof.blackbox.families.reports import GOES_ON, hand_jacobian, make_anew, turns, verify_family
from driftproof.blackbox.findings import BadInput, Remarked, UnsupportedCall, arithmetic_of
from driftproof.blackbox.given_system import report_on_system
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES
from driftproof.blackbox.judging.specification import NO_ALLOWANCE, ORDINARY_DOMAIN, Allowance, Domain, Specification
from driftproof.blackbox.judging.systems.own_system import NoSlopes, OwnSystem
from driftproof.blackbox.judging.tolerance import Tolerance
from driftproof.blackbox.probes.scripted_answers import REMEMBERS
from driftproof.blackbox.report import UNDECIDED, Report, criteria_parts, sections
from driftproof.blackbox.stepper.opening import Target, imported
from driftproof.blackbox.stepper.wrappers.wrappers import substeps_wrapper
from driftproof.blackbox.verification import Refutation, Verification
from driftproof.methods.catalogue import METHODS, FurtherMethod
from driftproof.methods.given_methods import method_of, subject_of
from driftproof.methods.schemes import Method
from driftproof.support.assertions import AssertedVerdict, RemarkWarning, assert_verdict, time_limit_of_test
from driftproof.symbolic.rounding.formats import BINARY64

# What a verdict of `verify` that passes remarks on, besides its criteria.
_REMARKS = (arguments, digits, types)
# What messages say to the shell, which a test leaves out.
_SHELL = re.compile(
    r"(?:--[a-z-]+(?: [^\s-]\S*)? ?)+, in Python |, on the command line --solver| of `driftproof verify --help`"
)


def verify(
    step: Callable[..., Any] | str,
    method: str | Path | Method | FurtherMethod,
    *,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    system: Callable[..., Any] | str | None = None,
    examples: int = EXAMPLES,
    domain: Domain = ORDINARY_DOMAIN,
    allowance: Allowance = NO_ALLOWANCE,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Verify that a float stepper is `method`: on q'' = -q to the method's any-order rounding bound, and elsewhere.

    `step` is a callable or "package.module:name"; `method` is a catalogue key, a .toml file, a method, "boris" for a
    step in a magnetic field, or "abm4" for Adams-Bashforth-Moulton (PECE) of order 4. The stepper is tried at
    `examples` floats from the `domain`; `allowance` adds to the bound. If it takes a force or a right-hand side, its
    coefficients are read, its steps of a nonlinear problem with t are compared with the method's own, and its order is
    measured there. A built-in system is q'' = -q, one read from short steps (then undecided), or the one given with
    `system`, f(t, y) or f(y): its steps are compared with the method's steps on that system; y holds the step's numbers
    in the step's order. `examples`, the smallest sizes and all allowances but `solver_tolerance` are then refused.

    The report's `passed` is True, False, or None for undecided, as when neither coefficients nor nonlinear steps were
    seen. If it is False, the report says what the stepper is instead; if it is None, what would decide it. `calls`
    ("map", "force" or "field") and `array` are for steppers whose parameters do not show how they are called. All
    questions together take at most `time_limit` seconds; those left without time count as not seen. If `isolate` is
    false, the stepper runs in this process, without a limit.

    Raises ValueError for a method, calls, examples or an allowance without a sense, and for a domain that overflows.

    >>> from driftproof import verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", examples=50, isolate=False).passed
    True
    """
    if not examples > 0:
        raise ValueError(f"examples={examples}: at least 1 step is tried")
    boris = Boris() if isinstance(method, str) and method.lower() in BORIS_NAMES else None
    found = boris or Corrected.named(method) or subject_of(method)
    if callable(system):  # which no other interpreter can import
        step = imported(step)
    if domain.begins:
        _refuse_with_a_start(system, domain, calls=calls, array=array)
    target = Target(step, calls, array, system is not None, start=domain.begins)
    with IsolatedRunner(target, time_limit, isolate) as runner:
        if isinstance(found, FurtherMethod | Boris):
            if system is not None:
                raise ValueError(f"{found.key} is no method of one step, which alone is held to a system")
            return verify_family(runner, found)
        asked = method_of(found)  # raises ValueError for a family
        if METHODS.get(asked.key, asked) != asked:  # a user's method under the key of another one
            asked = replace(asked, key=f"own_{asked.key}")
        wanted = Specification(asked, allowance, domain)
        Tolerance.of(wanted, BINARY64)  # an allowance without meaning is refused before anything runs
        if system is not None:
            _refuse_with_a_system(examples, domain, allowance)
            return report_on_system(runner, wanted, system, _REMARKS)
        return _report_on_one_step(runner, asked, criteria.questions_of(wanted, examples))


def assert_verified(
    step: Callable[..., Any] | str,
    method: str | Path | Method | FurtherMethod,
    *,
    allow_undecided: bool = False,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    system: Callable[..., Any] | str | None = None,
    examples: int = EXAMPLES,
    domain: Domain = ORDINARY_DOMAIN,
    allowance: Allowance = NO_ALLOWANCE,
    time_limit: float | None = None,
    isolate: bool = True,
) -> None:
    """Raise AssertionError with the whole report of `verify` unless the stepper passes: for a test.

    An undecided verdict fails as well, and the report says what would decide it, unless `allow_undecided` is true. A
    verdict that passes with a remark, such as answers rounded to binary32, is warned of (`RemarkWarning`). The
    default time limit is that of the test's mark, `@pytest.mark.driftproof(time_limit=30)`, or else that of `verify`.

    >>> from driftproof import assert_verified
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> assert_verified(step, method="forward_euler", examples=50, isolate=False)
    """
    __tracebackhide__ = True
    try:
        limit = (time_limit_of_test.get() or TIME_LIMIT) if time_limit is None else time_limit
        options: dict[str, Any] = {"examples": examples, "domain": domain, "allowance": allowance}
        report = verify(
            step, method, calls=calls, array=array, system=system, time_limit=limit, isolate=isolate, **options
        )
    except ValueError as error:  # so that pytest shows the user's line and the message
        raise ValueError(_SHELL.sub("", str(error))) from None
    if report.passed is None and not report.verdict.startswith(UNDECIDED):  # where a test fails for it
        report = replace(report, verdict=f"{UNDECIDED}: {report.verdict}")
    found = AssertedVerdict(report.target, report.verdict, report.passed, _SHELL.sub("", report.text()), report.data)
    assert_verdict(found, holds=report.passed is True or (report.passed is None and allow_undecided))
    if report.data.get("remarks"):
        warnings.warn(found.headline, RemarkWarning, stacklevel=2)


def _refuse_with_a_system(examples: int, domain: Domain, allowance: Allowance) -> None:
    """Raise ValueError for what has no effect where a system is given."""
    usual = replace(domain, smallest_step=ORDINARY_DOMAIN.smallest_step, smallest_state=ORDINARY_DOMAIN.smallest_state)
    plain = replace(NO_ALLOWANCE, solver_tolerance=allowance.solver_tolerance)
    given = {"examples": examples} if examples != EXAMPLES else {}
    for mine, other in ((domain, usual), (allowance, plain)):
        given |= {name: x for name, x in vars(mine).items() if x != getattr(other, name)}
    if given:
        name, x = next(iter(given.items()))
        raise ValueError(f"{name}={x} has no effect with a system")


def _refuse_with_a_start(system: Callable[..., Any] | str | None, domain: Domain, **others: Any) -> None:
    """Raise ValueError for a start without a system, or beside what has no effect with it."""
    if system is None:
        raise ValueError("a start has no effect without a system: give --system, in Python system=f")
    sized = {"largest_state": domain.largest_state} if domain.largest_state != ORDINARY_DOMAIN.largest_state else {}
    for name, x in {**others, **sized}.items():
        if x is not None:
            raise ValueError(f"{name}={x} has no effect with a start")


def _report_on_one_step(runner: IsolatedRunner, method: Method, questions: Sequence[criteria.Question]) -> Report:
    """The report on a stepper compared with a one-step method, or with one that turns if the stepper turns vectors."""
    from driftproof.symbolic.claimed_orders import false_claims

    replies = runner.run([*(question.ask for question in questions), *_REMARKS])
    seen = Verification(method, questions, dict(zip((each.title for each in questions), replies, strict=False)))
    rounding = seen.outcomes[criteria.ROUNDING]
    if rounding.kind == BadInput.kind:
        raise ValueError(rounding.seen)
    if rounding.kind == UnsupportedCall.kind:
        if runner.outcome_of(turns).result:
            return verify_family(runner, method)
        if handed := hand_jacobian(runner):
            report = _report_on_one_step(runner, method, questions)
            return replace(report, verdict=report.verdict + handed)
    target, made, arithmetic = runner.target.name, sum(reply.calls for reply in replies), arithmetic_of(replies)
    if REMEMBERS in seen.outcomes[criteria.COEFFICIENTS].traits and (found := _made_anew(runner, method, questions)):
        return found
    of_own = rounding.kind in (OwnSystem.kind, NoSlopes.kind) and seen.passed is None
    wrong, others = _faults_of_any_method(runner, rounding.kind == NoSlopes.kind) if of_own else ([], [])
    parts, data = criteria_parts([*seen.checks.values()], seen.passed if not wrong else False)
    data |= {"remarks": [], "calls_made": made}
    if wrong:
        parts.append(("Faults", [*wrong, *others]))
        return Report(target, f"is not {method.key}: {wrong[0]}", False, sections(*parts), {**data, "faults": wrong})
    if seen.passed is False:
        refuted = _refutation(runner, seen)
        data["instead"] = refuted.instead.report.data
        verdict = refuted.verdict if arithmetic in refuted.verdict else f"{refuted.verdict}; {arithmetic}"
        if refuted.instead.seen.naming.parted and not refuted.reason:
            verdict += runner.outcome_of(substeps_wrapper).result or ""
        return Report(target, verdict, False, sections(*parts, *refuted.parts), data)
    parts.append(("Faults", others))
    told = (reply.result for reply in replies if isinstance(reply.result, Remarked))
    checked = (check for reply in replies[len(questions) :] for check in reply.result or () if check.holds is False)
    remarks = [f"remark: {each.words}" for each in (*told, *checked)]
    remarks += [f"remark: {method.key} itself: {each}" for each in false_claims(method)]
    data["remarks"] = list(remarks)
    verdict = "; ".join(filter(None, [seen.verdict, *remarks, *seen.unjudged, arithmetic]))
    parts.append(("Calls made", [f"{made} calls of the stepper"] * bool(made)))  # a process that was ended counts none
    return Report(target, verdict, seen.passed, sections(*parts), data)


def _made_anew(runner: IsolatedRunner, method: Method, questions: Sequence[criteria.Question]) -> Report | None:
    """The report on a stepper that remembers, each step made by a copy; None if its first step is not the method's."""
    target = runner.target
    if not make_anew(runner):
        return None
    report = _report_on_one_step(runner, method, questions)
    if report.passed is False and criteria.FIRST_ONLY not in report.verdict:
        runner.turn_to(target)
        return None
    remarks = [GOES_ON] * bool(report.passed)
    data = {**report.data, "remarks": [*report.data["remarks"], *remarks]}
    return replace(report, verdict="; ".join([report.verdict, *remarks]), data=data)


def _faults_of_any_method(runner: IsolatedRunner, no_slopes: bool) -> tuple[list[str], list[str]]:
    """What a step with an unknown system does as no method does on any, and what else `identify` calls its faults.

    That is a damping or a turn in each step, however short; an h that is ignored; and where short steps show no slopes,
    a step of h = 0 that moves the state although every h is used as given.
    """
    damping, *answers = runner.run([read_damping, *CHECKS.values()])
    checks = checks_of(answers)
    used, faults = any(check.key == STEP_SIZE and check.holds for check in checks), [x for x in checks if x.is_fault]
    wrong = [check.words for check in faults if check.what == IGNORED]
    wrong += [] if damping.result is None or wrong else damping.result.faults
    wrong = wrong or [check.words for check in faults if check.key == ZERO_STEP and used and no_slopes]
    return wrong, [check.words for check in faults if check.words not in wrong]


def _refutation(runner: IsolatedRunner, seen: Verification) -> Refutation:
    """Ask the runner's stepper what it is instead; a stepper that passes loads nothing of this."""
    from driftproof.blackbox.identify import identification
    from driftproof.blackbox.judging.single_mistakes import single_mistakes

    titles = criteria.COEFFICIENTS, criteria.ORDER, criteria.DENSE_OUTPUT
    read, order, dense = (seen.outcomes[title] for title in titles)
    found = identification(runner, read, order, dense)
    mistakes = runner.outcome_of(partial(single_mistakes, method=seen.method)).result or ()
    return Refutation(seen, found, mistakes)
