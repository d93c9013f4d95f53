"""All checks of a stepper and their results, including the checks that hung, crashed or were refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from driftproof.blackbox.checks import arguments, determinism, domain, geometry, homogeneity, step_size
from driftproof.blackbox.checks.trials import CheckResult, Unsteady
from driftproof.blackbox.findings import CRASHES, NO_EVIDENCE, Outcome, UnsupportedCall
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# The checks by their names, which are the keys of results where they give none.
CHECKS: Mapping[str, Callable[[ForeignStepper], tuple[CheckResult, ...]]] = {
    check.__name__: check
    for check in (
        *(determinism.repeats, arguments.arguments, arguments.types, determinism.several_states),
        *(homogeneity.digits, arguments.zero_step, arguments.negative_step, step_size.step_size, step_size.sub_steps),
        *(arguments.time_argument, geometry.reversal, geometry.area, domain.domain, homogeneity.homogeneity),
        *(arguments.not_a_number, arguments.infinity, arguments.not_a_number_step),
    )
}
# Results that compare answers bit by bit, and say nothing if the same call gives other bits again.
_BITWISE = frozenset(("time", "batches", "takes_integers"))


def checks_of(outcomes: Sequence[Outcome]) -> tuple[CheckResult, ...]:
    """The results of all checks in order; one result `answers` if none of them got an answer, for the same reason."""
    first, *others = outcomes
    if first.failed and all(outcome == first for outcome in others):
        holds = None if first.kind in (*NO_EVIDENCE, UnsupportedCall.kind) else False
        return (CheckResult("answers", holds, f"nothing could be tested: {first.seen}"),)
    found: list[CheckResult] = []
    for key, outcome in zip(CHECKS, outcomes, strict=True):
        if outcome.kind != Unsteady.kind:
            found += _unanswered(key, outcome) if outcome.failed else outcome.result
    if any(check.key == determinism.SAME and check.holds is False for check in found):
        found = [check for check in found if check.key not in _BITWISE]
    unsteady = {outcome.seen for outcome in outcomes if outcome.kind == Unsteady.kind}
    return (*found, *(CheckResult(Unsteady.kind, None, f"nothing else was tested: {seen}") for seen in unsteady))


def _unanswered(key: str, outcome: Outcome) -> tuple[CheckResult, ...]:
    """The results of a check without an answer: it stays open, and a crash is a fault as well."""
    title = key.replace("_", " ")
    if outcome.kind in NO_EVIDENCE:
        return (CheckResult(key, None, f"{title}: undecided: {outcome.seen}"),)
    if outcome.kind == CRASHES:
        crash = CheckResult("comes_back", False, f"{title}: the stepper crashes, {outcome.seen}")
        return crash, CheckResult(key, None, f"{title}: undecided: the stepper crashes")
    return (CheckResult(key, None, f"{title}: not tested: {outcome.seen}"),)
