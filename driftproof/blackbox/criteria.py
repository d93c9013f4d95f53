"""The questions by which `verify` compares a stepper with a method, and how each answer becomes a criterion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeAlias

from driftproof.blackbox.checks.determinism import first_call_again
from driftproof.blackbox.families.multistep_runs import later_steps
from driftproof.blackbox.findings import CRASHES, NO_EVIDENCE, Outcome, StepFinding, UnsupportedCall
from driftproof.blackbox.isolation import Probe
from driftproof.blackbox.judging.agreement import Agreement, several_together
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE, NonlinearAgreement, nonlinear_agreement
from driftproof.blackbox.judging.other_parameters import other_parameters
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.state_objects import state_objects
from driftproof.blackbox.judging.systems.own_system import AsOnOwnSystem, NoSlopes, OwnSystem, rounding_of
from driftproof.blackbox.judging.walks import back_and_on, walked
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.entries import other_velocities, rational_method, side_by_side
from driftproof.blackbox.matching.estimates import JudgedEstimate, is_pair, judged_estimate
from driftproof.blackbox.matching.match import Identity, match_method
from driftproof.blackbox.probes.dense import DenseOutputDiffers
from driftproof.blackbox.probes.force import NO_TABLEAU, ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Criterion
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting

_ARGUMENT = "a right-hand side or a force among its arguments: step(f, t, y, h) or step(force, q, v, h)"
_SYSTEM = f"the system that it should have: --system module:f, in Python system=f, of f(t, y); or {_ARGUMENT}"
# Outcomes that leave any question open, and what would decide it.
_OPEN = {
    DenseOutputDiffers.kind: "a dense output that is a sum of slopes, the same in all components, as the step is",
    CRASHES: "a step that leaves its process, and the pipes of it, alone",
    **dict.fromkeys((OwnSystem.kind, NoSlopes.kind, AsOnOwnSystem.kind), _SYSTEM),
    **NO_EVIDENCE,
}
# What would decide a question whose reading was refused.
_READABLE = "a step without the obstacle stated above"
_READABLE_ESTIMATE = "an estimate that is a sum of the slopes of the pair's own stages, or one norm of such a sum"
# The titles that verdicts refer to.
ROUNDING, COEFFICIENTS, NONLINEAR_STEP, ORDER = "Rounding", "Coefficients", "Nonlinear step", "Order"
ERROR_ESTIMATE, DENSE_OUTPUT, STATE_FORMS, FIRST_CALL = "Error estimate", "Dense output", "State", "First call"
ELSEWHERE, BACK, FIRST_ONLY = "Steps elsewhere", "Steps back", " for its first step only"
# How a verdict ends if one of these alone fails.
ONLY = {ELSEWHERE: ", but not everywhere", BACK: " for h > 0 only", STATE_FORMS: ", but not for every form of state"}
_UNUSUAL = (ERROR_ESTIMATE, DENSE_OUTPUT, "Parameters")  # most steppers have nothing of these, which needs no line
# The criteria of a single step, which decide whether it is the method's; the other criteria must not fail.
SINGLE_STEP_CRITERIA = (ROUNDING, COEFFICIENTS, NONLINEAR_STEP, ORDER)
# Whether an answer passes (None: not seen), the finding as lines and as JSON data, and what would decide it.
Judged: TypeAlias = tuple[bool | None, Sequence[str], dict[str, Any], str]


class Question(NamedTuple):
    """A question to a stepper, how its answer is judged, and how a verdict words it if this question alone fails.

    The verdict is then "is rk4" with `only` behind it. Questions with an `only` concern further steps, and say nothing
    if one step is not the method's. `readable` is what would decide the question where no coefficients could be read.
    """

    title: str
    ask: Probe
    judge: Callable[[Method, Any], Judged]
    only: str = ""
    readable: str = ""

    def criterion(self, method: Method, outcome: Outcome) -> Criterion:
        """The criterion. A refusal counts against the stepper only in a criterion of a single step."""
        kind, lines, of_step = outcome.kind, (outcome.seen,), self.title in SINGLE_STEP_CRITERIA
        if kind is None:
            passed, seen, data, missing = self.judge(method, outcome.result)
            return Criterion(self.title, passed, tuple(seen), data, missing)
        missing = _OPEN.get(kind, self.readable if kind == NotReadable.kind else "")
        if kind == UnsupportedCall.kind:  # a stepper that returns y1 alone needs no line
            return Criterion(self.title, None, () if self.title in _UNUSUAL else lines, {})
        if of_step and not missing:
            return Criterion(self.title, False, (outcome.said,), {})
        return Criterion(self.title, None, lines, {}, missing)


def questions_of(wanted: Specification, examples: int) -> list[Question]:
    """The questions that `verify` asks of a stepper, in the order of the report."""
    method, solved = of_one_state(wanted.method), wanted.allowance.solver_tolerance

    def against(ask: Callable[..., Any], **options: Any) -> Probe:
        return partial(ask, wanted=wanted, **options)

    coefficients = partial(_judge_coefficients, solver_tolerance=float(solved or 0))
    estimate, later = _READABLE_ESTIMATE * is_pair(method), partial(later_steps, explicit=method.explicit)
    again = partial(first_call_again, explicit=method.explicit)
    return [
        Question(ROUNDING, against(rounding_of, examples=examples), _judge_rounding),
        Question(COEFFICIENTS, read_coefficients, coefficients, "", _READABLE),
        Question(NONLINEAR_STEP, against(nonlinear_agreement), _judge_nonlinear_step),
        Question(ORDER, against(measured_orders, explicit=method.explicit), _judge_order),
        Question(ERROR_ESTIMATE, partial(judged_estimate, method=method), _judge_estimate, "", estimate),
        Question(DENSE_OUTPUT, judged_dense, _judge_dense),
        Question(ELSEWHERE, against(walked), _judge_calls, ONLY[ELSEWHERE]),
        Question(BACK, against(back_and_on), _judge_calls, ONLY[BACK]),
        Question("Several", against(several_together), _judge_calls, ", but not of several oscillators at once"),
        Question("Parameters", against(other_parameters), _judge_calls, ", but not for all parameters"),
        Question("Later steps", later, _judge_calls, FIRST_ONLY),
        Question(STATE_FORMS, against(state_objects), _judge_calls, ONLY[STATE_FORMS]),
        Question(FIRST_CALL, again, _judge_calls, ", but not in every call"),
    ]


def _judge_rounding(method: Method, found: Agreement) -> Judged:
    """An iteration that does not converge in long steps leaves it open whether the step is the method's."""
    if (within := found.within) is None:
        return found.holds, found.lines, found.data, ""
    h, state = (f"{size:g}" for size in (within.largest_step, within.largest_state))
    missing = f"--largest-step {h} --largest-state {state}, in Python domain=Domain({h}, {state})"
    return None, found.lines, found.data, missing


def _judge_coefficients(method: Method, reading: CoefficientReading, solver_tolerance: float) -> Judged:
    """Compare the coefficients; those read from a force are no tableau if a right-hand side could not be read."""
    solved = reading.solved
    if not method.explicit and solved is None:
        line = f"read as {reading.calls} explicit stages: its number of iterations does not depend on convergence"
        return None, [line], {}, "an iteration that stops when it has converged"
    identity = match_method(reading, method)
    if not identity.matches:
        return _other_coefficients(method, reading, identity)
    lines = [*identity.lines]
    if isinstance(reading, ForceReading):
        from driftproof.symbolic.claimed_orders import stated_order

        if reading.refused and isinstance(method, RungeKutta):
            return None, [*lines, f"{NO_TABLEAU}: {reading.refused}"], {}, _READABLE
        if reading.wrong_time:
            return False, [f"called at wrong times: {reading.wrong_time}"], {}, ""
        if reading.a_velocity is not None and isinstance(method, RungeKutta):
            found = other_velocities(method, reading)
            return False, found, {"differences": found}, ""
        if reading.velocities_limit_order and stated_order(method) > 1:
            return False, ["order 1 where the force depends on the velocity", *reading.stale_velocities], {}, ""
    if solved is None:
        return True, lines, {}, ""
    # A solver with a fixed number of iterations has the method's coefficients, but not its step. A solver that stops
    # early may leave the same error as on the nonlinear problem, where numbers have size 1.
    early = solved.power and solved.curved > BEYOND_TOLERANCE * solver_tolerance
    passed = False if early or solved.skipped else None if solved.power else True
    better = "a solver that checks the residual of its equations"
    return passed, [*lines, solved.words], {"stages": solved.words}, better


def _other_coefficients(method: Method, reading: CoefficientReading, identity: Identity) -> Judged:
    differences = [f"those of {near.key} except for {'; '.join(near.differences)}" for near in identity.near]
    lines = differences or [f"not those of {method.key}"]
    if isinstance(method, RungeKutta | Collocation) and (reading.implicit or isinstance(reading, TableauReading)):
        lines += side_by_side(reading, method)
    if isinstance(method, RungeKutta | Collocation) and isinstance(reading, TableauReading):
        from driftproof.symbolic.claimed_orders import restoring_entries

        read = rational_method(reading, "read")
        lines += restoring_entries(read, method.claimed_order) if read is not None else []
    found = [difference for near in identity.near for difference in near.differences]
    return False, lines, {"differences": list(dict.fromkeys(found))}, ""


def _judge_nonlinear_step(method: Method, found: NonlinearAgreement) -> Judged:
    return found.holds, [found.words], {"largest": f"{found.worst.off:.6g}"}, ""


def _judge_order(method: Method, measured: Sequence[MeasuredOrder]) -> Judged:
    """A splitting claims its order on q'' = F(q), a Runge-Kutta method on every problem."""
    from driftproof.symbolic.claimed_orders import stated_order

    found = measured[-1 if isinstance(method, Splitting | Nystrom) else 0]
    order = stated_order(method)
    passed = None if found.order is None else found.order >= order
    claimed = f", not {method.claimed_order} as its table claims" if 0 < method.claimed_order != order else ""
    lines = [f"{method.key} has order {order}{claimed}", found.words]
    return passed, lines, {"measured": found.order}, "smaller roundoff"


def _judge_estimate(method: Method, found: JudgedEstimate) -> Judged:
    """Judge both rows of a pair; for other methods the estimate is only described, since they define none."""
    lines = [*found.lines, *found.faults]
    if not is_pair(method):
        return None, [f"{method.key} defines no error estimate", *lines], found.data, ""
    if found.faults or found.pair:
        return not found.faults, lines, found.data, ""
    unheld = f"it is not compared with that of {method.key}: the step does not use the stages of the pair in order"
    return None, [*lines, unheld], found.data, _READABLE_ESTIMATE


def _judge_dense(method: Method, found: JudgedDense) -> Judged:
    """Fail a dense output that does not fit the steps; the name of a method implies nothing else about it."""
    return not found.faults, [*found.lines, *found.faults], found.data, ""


def _judge_calls(method: Method, found: StepFinding) -> Judged:
    return found.holds, [found.words, *[f"to reproduce: {found.reproduction}"] * bool(found.reproduction)], {}, ""
