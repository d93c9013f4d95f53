"""What a stepper is asked in order to be held to a method, and how each answer is judged: a criterion by its title."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from driftproof.blackbox.families.multistep_runs import later_steps
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall
from driftproof.blackbox.isolation import Probe
from driftproof.blackbox.judging.agreement import Agreement, Domain, rows_together
from driftproof.blackbox.judging.habits import explained
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE, NonlinearAgreement, nonlinear_agreement
from driftproof.blackbox.judging.state_objects import state_objects
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.judging.walks import back_and_on, walked
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.entries import mended, other_velocities, rational_method, side_by_side
from driftproof.blackbox.matching.estimates import JudgedEstimate, judged_estimate
from driftproof.blackbox.matching.match import Identity, match_method
from driftproof.blackbox.probes.dense import NotAlike
from driftproof.blackbox.probes.force import NO_TABLEAU, ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading, read_coefficients
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Criterion
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting

# Questions without an answer that say nothing against a stepper, and what would answer them.
UNDECIDING = {
    "unsupported_call": "a stepper that takes a force, step(force, q, v, h), or a right-hand side, step(f, t, y, h)",
    "not_readable": "a step without what refused the reading",
    NotAlike.kind: "a dense output that is a sum of slopes, alike in all numbers, as the step is",
    "crashes": "a step that does not end its process",
    **NO_EVIDENCE,
}
_READABLE_ESTIMATE = "an estimate that is a sum of the slopes of the pair's own stages, or one norm of such a sum"
# The titles of what a verdict speaks of by name.
ROUNDING, COEFFICIENTS, NONLINEAR_STEP, ORDER = "Rounding", "Coefficients", "Nonlinear step", "Order"
ERROR_ESTIMATE, DENSE_OUTPUT, STATE_FORMS = "Error estimate", "Dense output", "State"
# What decides whether it is the method, by what is seen of one step; all else has to be asked as well.
OF_ONE_STEP = (ROUNDING, COEFFICIENTS, NONLINEAR_STEP, ORDER)


class Question(NamedTuple):
    """A question, how its answer is judged, and how a verdict says that it alone is against a stepper: is rk4`only`.

    Questions with an `only` are of further steps, which say nothing of a map that is not the method's.
    """

    title: str
    ask: Probe
    judge: Callable[[Method, Outcome], Criterion]
    only: str = ""


def questions_of(method: Method, allowance: Allowance, domain: Domain, examples: int) -> list[Question]:
    """All that is asked of a stepper, in the order in which it is told."""
    of_method: dict[str, Any] = {"method": method, "allowance": allowance}
    within = {**of_method, "domain": domain}

    def further(title: str, ask: Probe, only: str) -> Question:
        return Question(title, ask, partial(_check_calls, title), only)

    return [
        Question(ROUNDING, partial(explained, **within, examples=examples), _check_rounding),
        Question(COEFFICIENTS, read_coefficients, partial(_check_coefficients, allowance=allowance)),
        Question(NONLINEAR_STEP, partial(nonlinear_agreement, **of_method), _check_nonlinear_step),
        Question(ORDER, measured_orders, _check_order),
        Question(ERROR_ESTIMATE, partial(judged_estimate, method=method), _check_estimate),
        Question(DENSE_OUTPUT, judged_dense, _check_dense),
        further("Steps elsewhere", partial(walked, **within), ", but not everywhere"),
        further("Steps back", partial(back_and_on, **within), " for h > 0 only"),
        further("Rows", partial(rows_together, **within), " for one state at a time only"),
        further("Later steps", later_steps, " for its first step only"),
        further(STATE_FORMS, partial(state_objects, **within), ", but not in the hands of every caller"),
    ]


def _unanswered(title: str, outcome: Outcome) -> Criterion:
    missing = UNDECIDING.get(outcome.kind or "")
    if missing is None:
        return Criterion(title, False, (f"{outcome.kind}: {outcome.seen}",), {})
    return Criterion(title, None, (outcome.seen,), {}, "" if outcome.kind == "unsupported_call" else missing)


def _check_rounding(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return _unanswered(ROUNDING, outcome)
    found: Agreement = outcome.result
    return Criterion(ROUNDING, found.holds, tuple(found.lines), found.data)


def _check_coefficients(method: Method, outcome: Outcome, allowance: Allowance) -> Criterion:
    """No refusal is dropped: what a force shows of a step that a right-hand side refutes is no tableau."""
    if outcome.failed:
        return _unanswered(COEFFICIENTS, outcome)
    reading: CoefficientReading = outcome.result
    solved = reading.solved
    if not method.explicit and solved is None:
        line = f"read as {reading.calls} explicit stages: iterations that are not counted by what they have come to"
        return Criterion(COEFFICIENTS, None, (line,), {}, "an iteration that ends where it has converged")
    identity = match_method(reading, method)
    if not identity.matches:
        return _other_coefficients(method, reading, identity)
    if isinstance(reading, ForceReading) and reading.refused and isinstance(method, RungeKutta):
        lines = (*identity.lines, f"{NO_TABLEAU}: {reading.refused}")
        return Criterion(COEFFICIENTS, None, lines, {}, UNDECIDING["not_readable"])
    if isinstance(reading, ForceReading) and reading.wrong_time:
        return Criterion(COEFFICIENTS, False, (f"called at wrong times: {reading.wrong_time}",), {})
    if isinstance(reading, ForceReading) and reading.a_velocity is not None:
        if isinstance(method, RungeKutta):
            found = other_velocities(method, reading)
            return Criterion(COEFFICIENTS, False, tuple(found), {"differences": found})
        if reading.velocities_limit_order and _claimed_order(method) > 1:
            lost = "order 1 where the force depends on the velocity"
            return Criterion(COEFFICIENTS, False, (lost, *reading.stale_velocities), {})
    if solved is not None:  # a solver that does not look has the method's coefficients, but not its step
        # One that stops early may be off by as much as on the nonlinear problem, numbers being of size 1.
        early = solved.power and solved.curved > BEYOND_TOLERANCE * float(allowance.solver_tolerance or 0)
        passed = False if early else None if solved.power else True
        missing = "" if passed is not None else "a solver that looks at what is left of its equations"
        lines = (*identity.lines, solved.words)
        return Criterion(COEFFICIENTS, passed, lines, {"stages": solved.words}, missing)
    return Criterion(COEFFICIENTS, True, tuple(identity.lines), {})


def _other_coefficients(method: Method, reading: CoefficientReading, identity: Identity) -> Criterion:
    differences = [f"those of {near.key} but for {'; '.join(near.differences)}" for near in identity.near]
    lines = differences or [f"not those of {method.key}"]
    if isinstance(method, RungeKutta | Collocation) and (reading.implicit or isinstance(reading, TableauReading)):
        lines += side_by_side(reading, method)
    if isinstance(method, RungeKutta | Collocation) and isinstance(reading, TableauReading):
        read = rational_method(reading, "read")
        lines += mended(read, method.claimed_order) if read is not None else []
    found = [difference for near in identity.near for difference in near.differences]
    return Criterion(COEFFICIENTS, False, tuple(lines), {"differences": list(dict.fromkeys(found))})


def _check_nonlinear_step(method: Method, outcome: Outcome) -> Criterion:
    if outcome.failed:
        return _unanswered(NONLINEAR_STEP, outcome)
    found: NonlinearAgreement = outcome.result
    return Criterion(NONLINEAR_STEP, found.holds, (found.words,), {"largest": f"{found.largest:.6g}"})


def _check_order(method: Method, outcome: Outcome) -> Criterion:
    """A splitting claims its order on q'' = F(q), a Runge-Kutta method on every problem."""
    if outcome.failed:
        return _unanswered(ORDER, outcome)
    measured: tuple[MeasuredOrder, ...] = outcome.result
    found = measured[-1 if isinstance(method, Splitting | Nystrom) else 0]
    order = _claimed_order(method)
    passed = None if found.order is None else found.order >= order
    lines = (f"{method.key} has order {order}", found.words)
    return Criterion(ORDER, passed, lines, {"measured": found.order}, "" if passed is False else "smaller rounding")


def _check_estimate(method: Method, outcome: Outcome) -> Criterion:
    """A pair claims both of its rows; of another method, what is returned beside y1 is nobody's claim."""
    claimed = isinstance(method, RungeKutta) and method.b_embedded is not None
    if outcome.failed:
        if claimed and outcome.kind == "not_readable":
            return Criterion(ERROR_ESTIMATE, None, (outcome.seen,), {}, _READABLE_ESTIMATE)
        return _beside_unanswered(ERROR_ESTIMATE, outcome)
    found: JudgedEstimate = outcome.result
    if not claimed:
        return Criterion(ERROR_ESTIMATE, None, (f"{method.key} has none", *found.lines, *found.faults), found.data)
    if found.faults or found.pair:
        return Criterion(ERROR_ESTIMATE, not found.faults, (*found.lines, *found.faults), found.data)
    unheld = f"it is not held to that of {method.key}: its step is not that of the stages of the pair in their order"
    return Criterion(ERROR_ESTIMATE, None, (*found.lines, unheld), found.data, _READABLE_ESTIMATE)


def _check_dense(method: Method, outcome: Outcome) -> Criterion:
    """Nobody claims a dense output by the name of a method: what fails is one that does not fit to the steps."""
    if outcome.failed:
        return _beside_unanswered(DENSE_OUTPUT, outcome)
    found: JudgedDense = outcome.result
    return Criterion(DENSE_OUTPUT, not found.faults, (*found.lines, *found.faults), found.data)


def _beside_unanswered(title: str, outcome: Outcome) -> Criterion:
    """Of what may be returned beside y1, and need not be readable: who returns nothing is not told so."""
    if outcome.kind in (*NO_EVIDENCE, NotAlike.kind, "crashes"):
        return _unanswered(title, outcome)
    return Criterion(title, None, () if outcome.kind == UnsupportedCall.kind else (outcome.seen,), {})


def _check_calls(title: str, method: Method, outcome: Outcome) -> Criterion:
    """Of calls that a stepper may refuse."""
    if outcome.kind in (*NO_EVIDENCE, "crashes"):
        return _unanswered(title, outcome)
    if outcome.failed:
        return Criterion(title, None, (outcome.seen,), {})
    passed, words, reproduction = outcome.result
    again = [f"to see it again: {reproduction}"] if reproduction else []
    return Criterion(title, passed, (words, *again), {})


def _claimed_order(method: Method) -> int:
    """The order claimed; where nobody claims one, the one derived."""
    from driftproof.symbolic.facts import general_order

    return method.claimed_order or general_order(method).order
