"""Whether steps on a driven system show the times of a method's stages: longer steps, where short ones do not.

Where a system is stiff, its own time is so short that in a step of that length nothing else changes with the time.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from itertools import product

from driftproof.blackbox.findings import Misbehaviour, StepFinding
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.systems.given_comparisons import SMALL, longer
from driftproof.blackbox.judging.systems.given_steps import GivenSteps
from driftproof.blackbox.judging.systems.own_steps import COMPARED, ends_in_words
from driftproof.blackbox.judging.systems.whole_states import TIMES
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta

# A stage that is a sixteenth of the step too early or too late should move its end by more than is allowed.
_SEEN = 16.0


def with_stage_times(steps: GivenSteps, wanted: Specification, found: StepFinding) -> StepFinding:
    """What was found of short steps, if the time moves their ends; else, what longer ones show as well.

    Raises MethodError if it is open whether the times of stages are the method's.
    """
    if not found.holds or steps.times != TIMES or not steps.driven or _is_seen(steps, wanted):
        return found
    holds, words = _by_longer_steps(steps, wanted)
    if holds is None:
        h = min(steps.unit * COMPARED[-1], wanted.domain.largest_step)
        raise MethodError(f"in a step of {h:.2g}, as are compared, the time hardly moves its end; {words}")
    return StepFinding(holds, f"{found.words}{words}" if holds else words)


def _is_seen(steps: GivenSteps, wanted: Specification) -> bool:
    """True if the time moves the end of one of the compared steps by so much that a wrong time of a stage shows."""
    for t, share, y in product(steps.times, COMPARED, steps.states):
        with suppress(Misbehaviour, ArithmeticError):
            if steps.beside(wanted, t, y, min(share * steps.unit, wanted.domain.largest_step)).by_time >= _SEEN:
                return True
    return False


def _by_longer_steps(steps: GivenSteps, wanted: Specification) -> tuple[bool | None, str]:
    """Whether longer steps, from small states as well, have the times of the method's stages; or why that is open.

    Newton's method solves stages that do not settle otherwise, and may find another root than the stepper does, so that
    another end of such a step is told, and is no fault.
    """
    method, shown = of_one_state(wanted.method), 0
    allowed = steps.half + BEYOND_TOLERANCE * float(wanted.allowance.solver_tolerance or 0)
    for t, at, by, h in product(steps.times, steps.states, (1.0, SMALL), longer(steps, wanted)):
        y = [steps.number(x * by) for x in at]
        with suppress(Misbehaviour, ArithmeticError):
            told, ahead = (_solved(each, method, t, y, h) for each in (steps, steps.later(h)))
            if steps.apart(y, told, ahead) <= _SEEN * allowed:
                continue
            seen, shown = [float(x) for x in steps.end(t, y, h)], shown + 1
            if steps.apart(y, seen, told) > allowed:
                with suppress(ArithmeticError):
                    if (one := steps.beside(wanted, t, y, h)).fails:
                        return False, one.fails
                return None, f"one of {h:g} at t = {t:g} from {ends_in_words(tuple(y), tuple(seen), method, told)}"
    words = f", and to half of the digits in {shown} longer ones, which show its times"
    return (True, words) if shown else (None, "no longer one shows it")


def _solved(steps: GivenSteps, method: Method, t: float, y: Sequence[float], h: float) -> list[float]:
    """The method's step, its stages by Newton's method if it is implicit. Raises ArithmeticError without a root."""
    if method.explicit or not isinstance(method, RungeKutta | Collocation):
        return steps.step(method, t, y, h)
    return steps.solved(method, t, y, h, steps.half / _SEEN)
