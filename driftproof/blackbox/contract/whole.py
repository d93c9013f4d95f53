"""The whole contract: its experiments, and what they find, with a clause for each that hung, crashed or was refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from driftproof.blackbox.contract.area import area
from driftproof.blackbox.contract.arguments import arguments, types
from driftproof.blackbox.contract.batches import batches
from driftproof.blackbox.contract.bench import Unsteady
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.contract.clock import clock
from driftproof.blackbox.contract.digits import digits
from driftproof.blackbox.contract.domain import domain
from driftproof.blackbox.contract.repeats import SAME, repeats
from driftproof.blackbox.contract.reversal import reversal
from driftproof.blackbox.contract.scale import scale
from driftproof.blackbox.contract.specials import infinity, not_a_number, not_a_number_step
from driftproof.blackbox.contract.step_size import step_size
from driftproof.blackbox.contract.sub_steps import sub_steps
from driftproof.blackbox.contract.zero_and_back import negative_step, zero_step
from driftproof.blackbox.findings import Outcome
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.stepper.subject import Subject

# By the key of the clause that stands for an experiment without result.
EXPERIMENTS: Mapping[str, Callable[[Subject], tuple[Clause, ...]]] = {
    experiment.__name__: experiment
    for experiment in (
        *(
            repeats,
            arguments,
            types,
            batches,
            digits,
            zero_step,
            negative_step,
            step_size,
            sub_steps,
            clock,
            reversal,
            area,
        ),
        *(domain, scale, not_a_number, infinity, not_a_number_step),
    )
}
# Of a few steps each, where a loop may have no end.
BRIEF = frozenset((not_a_number, infinity, not_a_number_step))
# These compare answers bit by bit: where the same call gives other bits again, they tell nothing.
_BITWISE = frozenset(("time", "batches", "takes_integers"))


def contract(runner: IsolatedRunner) -> tuple[Clause, ...]:
    """All clauses of a stepper's contract, its manners first and what it does to areas and sizes last."""
    return clauses_of(runner.run(list(EXPERIMENTS.values()), BRIEF))


def clauses_of(outcomes: Sequence[Outcome]) -> tuple[Clause, ...]:
    """The clauses found by the experiments, in their order; one clause `answers` where none of them got an answer."""
    if all(outcome == outcomes[0] for outcome in outcomes) and outcomes[0].failed:
        return (Clause("answers", False, f"no question could be put: {outcomes[0].seen}"),)
    found: list[Clause] = []
    for key, outcome in zip(EXPERIMENTS, outcomes, strict=True):
        if outcome.kind != Unsteady.kind:
            found += (_unanswered(key, outcome),) if outcome.failed else outcome.result
    if any(clause.key == SAME and clause.holds is False for clause in found):
        found = [clause for clause in found if clause.key not in _BITWISE]
    unsteady = next((outcome for outcome in outcomes if outcome.kind == Unsteady.kind), None)
    return (*found, Clause(Unsteady.kind, None, f"nothing else was asked: {unsteady.seen}")) if unsteady else (*found,)


def _unanswered(key: str, outcome: Outcome) -> Clause:
    """A hang or a crash is a fault, whatever was asked; any other failure leaves the question open."""
    title = key.replace("_", " ")
    if outcome.kind in ("hangs", "crashes"):
        return Clause(key, False, f"{title}: the stepper {outcome.kind}, {outcome.seen}")
    return Clause(key, None, f"{title}: not asked: {outcome.seen}")
