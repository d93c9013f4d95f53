"""Does this code do what its name says, to roundoff? Coefficients, rounding and order against the exact method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial, update_wrapper
from typing import Any, ParamSpec

from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, arithmetic_of
from driftproof.blackbox.identify import identified
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import EXAMPLES, NO_ALLOWANCE, ORDINARY_DOMAIN, Agreement, Domain
from driftproof.blackbox.judging.habits import ROUNDED, explained
from driftproof.blackbox.judging.pendulum_order import MeasuredOrder, measured_order
from driftproof.blackbox.judging.tolerance import Allowance, Tolerance
from driftproof.blackbox.matching.entries import mended, rational_method, side_by_side
from driftproof.blackbox.matching.match import match_method
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Report, sections
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tableau_file import method_of
from driftproof.support.plain_text import Json

_P = ParamSpec("_P")
# Where a stepper's calls do not allow a question, nothing follows from it; nor from a lapse of time.
NOT_ASKED = ("unsupported_call", "not_readable", *NO_EVIDENCE)


@dataclass(frozen=True)
class Criterion:
    """One way to hold a stepper to a method: whether it passed (None: it could not be asked), and what was seen."""

    title: str
    passed: bool | None
    lines: tuple[str, ...]
    data: dict[str, Json]


def verify(
    step: Callable[..., Any] | str,
    method: Method | str,
    *,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    examples: int = EXAMPLES,
    domain: Domain = ORDINARY_DOMAIN,
    allowance: Allowance = NO_ALLOWANCE,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Whether a float stepper is `method` on q'' = -q to the definition's any-order rounding bound, and no other one.

    `step` is a callable or "package.module:name", `method` a catalogue key, a .toml file or a method. It is tried at
    `examples` floats of the `domain`, with what `allowance` adds to the bound. Where it takes a force or a right-hand
    side, its coefficients are read, too, and its order on the pendulum is measured. If it does not pass, the report
    says what it is instead. `calls` ("map", "force" or "field") and `array` are for steppers whose
    parameters do not tell how they are called. The whole of it takes `time_limit` seconds at most; what they do not
    suffice for is undecided, and `passed` then None. With `isolate` false it runs in this process, without a limit.

    Raises ValueError for a method, calls or an allowance that makes no sense, and for a domain that overflows.

    >>> from driftproof import verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", examples=50, isolate=False).passed
    True
    """
    asked = method_of(method) if isinstance(method, str) else method
    Tolerance(asked, allowance=allowance)  # a question without sense is refused before anything runs
    runner = IsolatedRunner(Target(step, calls, array), time_limit, isolate)
    agreed = partial(explained, method=asked, allowance=allowance, domain=domain, examples=examples)
    outcomes = runner.run([agreed, read_coefficients, measured_order])
    if outcomes[0].kind == "bad_input":
        raise ValueError(outcomes[0].seen)
    checks = [check(asked, outcome) for check, outcome in zip(CRITERIA, outcomes, strict=True)]
    failed = [check for check in checks if check.passed is False]
    arithmetic, unseen = arithmetic_of(outcomes), [o.seen for o in outcomes if o.kind in NO_EVIDENCE]
    if failed:
        instead = identified(runner)
        refuted = _refuted(asked, checks, outcomes[0].result, instead)
        named = refuted if arithmetic in refuted else f"{refuted}; {arithmetic}"
        return _report(runner.target, named, checks, instead)
    verdict = f"undecided whether it is {asked.key}: {unseen[0]}" if unseen else _agreed(asked, outcomes[0].result)
    return _report(runner.target, "; ".join(filter(None, [verdict, arithmetic])), checks, decided=not unseen)


def _takes_what(check: Callable[_P, object]) -> Callable[[Callable[..., None]], Callable[_P, None]]:
    """For type checkers and for help(): the function that follows has the parameters of `check`."""
    return lambda function: update_wrapper(function, check, assigned=(), updated=())


@_takes_what(verify)
def assert_verified(*arguments: Any, **conditions: Any) -> None:
    """`verify`, for a test: raises AssertionError with the whole report unless the stepper passes.

    >>> from driftproof import assert_verified
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> assert_verified(step, method="forward_euler", examples=50, isolate=False)
    """
    __tracebackhide__ = True
    report = verify(*arguments, **conditions)
    if not report.passed:
        raise AssertionError(f"\n{report.text()}")


def _check_rounding(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return Criterion(
            "Rounding", None if outcome.kind in NO_EVIDENCE else False, (f"{outcome.kind}: {outcome.seen}",), {}
        )
    found: Agreement = outcome.result
    return Criterion("Rounding", found.holds, tuple(found.lines), found.data)


def _check_coefficients(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return Criterion("Coefficients", None if outcome.kind in NOT_ASKED else False, (outcome.seen,), {})
    identity = match_method(outcome.result, method)
    if identity.matches:
        return Criterion("Coefficients", True, tuple(identity.lines), {})
    differences = [f"those of {near.key} but for {'; '.join(near.differences)}" for near in identity.near]
    lines = differences or [f"not those of {method.key}"]
    if isinstance(outcome.result, TableauReading) and isinstance(method, RungeKutta) and method.explicit:
        read = rational_method(outcome.result, "read")
        lines += side_by_side(outcome.result, method)
        lines += mended(read, method.claimed_order) if read is not None else []
    found = [difference for near in identity.near for difference in near.differences]
    return Criterion("Coefficients", False, tuple(lines), {"differences": list(dict.fromkeys(found))})


def _check_order(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return Criterion("Order", None if outcome.kind in NOT_ASKED else False, (outcome.seen,), {})
    found: MeasuredOrder = outcome.result
    order = method.claimed_order or _derived_order(method)
    passed = None if found.order is None else found.order >= order
    claim = f"{method.key} has order {order}"
    return Criterion("Order", passed, (claim, found.words), {"measured": found.order})


def _derived_order(method: Method) -> int:
    """Of a method for which nobody claims one."""
    from driftproof.symbolic.facts import general_order

    return general_order(method).order


CRITERIA: Sequence[Callable[[Method, Outcome], Criterion]] = (_check_rounding, _check_coefficients, _check_order)


def _agreed(method: Method, found: Agreement) -> str:
    return (
        f"is {method.key} to roundoff: {found.examples} steps within the derived bound, "
        f"the largest error {found.worst.error_over_bound:.2f} of it"
    )


def _refuted(method: Method, checks: Sequence[Criterion], found: Agreement | None, instead: Report) -> str:
    """What it is not, and why; where nothing but the rounding errors is wrong, how they come, as far as is known."""
    coefficients, order = checks[1:]
    if found is not None and found.failing is not None and order.passed is not False:
        if found.but_for and (coefficients.passed is not False or found.but_for.startswith(ROUNDED)):
            return f"is not {method.key} to roundoff; it is, {found.but_for}"
        if coefficients.passed and found.failing.answer is not None:
            off = f"a step is off by {found.failing.error_over_bound:.3g} times the bound"
            return f"is not {method.key} to roundoff: its coefficients are, but {off}"
    wrong = ", ".join(coefficients.data.get("differences", ()))
    what = f": {wrong}" if wrong and wrong not in instead.verdict else ""
    return f"is not {method.key}{what}; {instead.verdict}"


def _report(
    target: Target, verdict: str, checks: Sequence[Criterion], instead: Report | None = None, *, decided: bool = True
) -> Report:
    marks = {True: "passed", False: "FAILED", None: "not asked"}
    parts = [(f"{check.title}: {marks[check.passed]}", check.lines) for check in checks]
    data = {check.title.lower(): {"passed": check.passed, "seen": list(check.lines), **check.data} for check in checks}
    if instead is not None:
        read = instead.section("Coefficients") or instead.section("One-step matrix")
        shown = [section for section in (read, instead.section("Faults"), instead.section("Not answered")) if section]
        parts += [(f"What it is: {section.title.lower()}", section.lines) for section in shown]
        data["instead"] = instead.data
    passed = all(check.passed is not False for check in checks) if decided else None
    return Report(target.name, verdict, passed, sections(*parts), data)
