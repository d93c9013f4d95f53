"""The order that a stepper shows on nonlinear problems, from how its local error falls with h: evidence, no proof."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, log2
from typing import Any

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.findings import Misbehaviour, NoAnswer, NotANumber, NotFinite, StepRaised, WrongShape
from driftproof.blackbox.judging import nonlinear_problems as problems
from driftproof.blackbox.judging.nonlinear_step import error_above
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber, ArrayAdapter
from driftproof.symbolic.rounding.formats import BINARY32

# At h = 2**-8 a method of order 12 errs by some 2**-110: balls of this precision are far narrower.
_BITS = 256
HALVINGS = range(-1, 9)  # h = 2**-k
# An error counts if it is this many times u: the rounding of some dozens of operations of ordinary size is below that.
CLEARANCE = 128
# A slope this near to a whole number shows it; half way to the next would be 0.5. For the methods of the catalogue the
# last slopes are within 0.2. The last two slopes have to agree.
SLACK = 0.3


@dataclass(frozen=True)
class MeasuredOrder:
    """The order p that a local error like C h^(p+1) shows, or None if none is seen above the noise.

    `slopes` are log2 of the factor by which the error falls at each halving of h, as far as errors are above the noise;
    `arithmetic` names the numbers that the code ran on.
    """

    order: int | None
    slopes: tuple[float, ...]
    arithmetic: str
    problem: str

    @property
    def words(self) -> str:
        """The finding in one line."""
        slopes = slopes_text(self.slopes)
        return f"{order_seen(self.order)} on {self.problem} (slopes of the local error: {slopes}; in {self.arithmetic})"


def order_seen(order: int | None) -> str:
    """The words "order 4 is observed", or "no order is observed"."""
    return "no order is observed" if order is None else f"order {order} is observed"


def slopes_text(slopes: Sequence[float]) -> str:
    """The slopes as text, or "none above the noise"."""
    return ", ".join(f"{slope:.2f}" for slope in slopes) or "none above the noise"


def measured_orders(
    subject: ForeignStepper, wanted: Specification | None = None, *, explicit: bool = True
) -> tuple[MeasuredOrder, ...]:
    """The orders on y' = f(t, y), if the stepper takes a right-hand side, and on q'' = F(q) or q'' = F(q, v).

    The force depends on v if the stepper gives it velocities. A stepper that runs on balls is measured in balls, where
    only its own constants are rounded, and any other in its own floats. Balls are for `explicit` steps: iterations may
    keep one as their next first guess. If it is `wanted` to be a method, its steps lie in the domain. A splitting that
    is written for a right-hand side has the second order, but seldom the first. Raises UnsupportedCall if the system
    is built in.
    """
    longest = wanted.domain.largest_step if wanted else inf
    if subject.convention.kind != FIELD:
        problem = problems.dragged_problem(subject) if subject.gives_velocities else problems.force_problem(subject)
        return (measured_on(subject, problem, longest, explicit),)
    found = [measured_on(subject, problems.field_problem(subject), longest, explicit)]
    with suppress(Misbehaviour):
        found += [] if subject.single else [measured_on(subject, problems.force_problem(subject), longest, explicit)]
    return tuple(found)


def measured_on(
    subject: ForeignStepper, problem: problems.NonlinearProblem, longest: float = inf, explicit: bool = True
) -> MeasuredOrder:
    """The order on a problem. Raises a Misbehaviour, or UnsupportedCall if the problem cannot be given."""
    least = CLEARANCE * float(subject.format.u)
    steps = [h for k in HALVINGS if (h := 2.0**-k) <= longest or k == HALVINGS[-1]]
    with ctx.workprec(_BITS):
        for adapter in (BALLS, ARRAYS_OF_BALLS) * explicit:
            with suppress(Misbehaviour, NoAnswer):  # no code has to run, or to end, on balls
                errors = _errors(replace(subject, adapter=adapter, log=CallLog()), problem, steps, [])
                found = _fitted(errors, [least * h for h in steps], "Arb balls", problem)
                if found.slopes:  # balls become infinitely wide in an iteration
                    return found
    return measured_in_floats(subject, problem, steps)


def measured_in_floats(
    subject: ForeignStepper, problem: problems.NonlinearProblem, steps: Sequence[float], slack: float = 0.0
) -> MeasuredOrder:
    """The order that steps of these sizes h show in the stepper's own floats; errors up to `slack` h² are noise."""
    answers = list[AnyNumber]()
    try:
        with ctx.workprec(_BITS):
            errors = _errors(subject, problem, steps, answers)
    except (StepRaised, NotFinite, NotANumber):  # the iteration for an implicit stage, in a long step
        if len(steps) == 1:
            raise
        return measured_in_floats(subject, problem, steps[1:], slack)
    # A code may work in binary32 and return doubles, whose noise is that of binary32.
    seen = BINARY32 if all(float(np.float32(x)) == x for x in answers) else subject.format
    noise = [CLEARANCE * float(max(seen.u, subject.format.u)) + slack * h * h for h in steps]
    return _fitted(errors, noise, seen.name, problem)


def _errors(
    subject: ForeignStepper, problem: problems.NonlinearProblem, steps: Sequence[float], seen: list[AnyNumber]
) -> list[float]:
    """The error of one step in its worst component, for each h, its ends being `seen`; floats start from floats."""
    start: list[AnyNumber] = problem.solution(arb(problems.START))
    if subject.adapter not in (BALLS, ARRAYS_OF_BALLS):
        start = [float(x.mid()) for x in start]
    found = []
    for h in steps:
        answer = problem.stepped(subject, problems.START, start, h)
        exact = problem.solution(arb(problems.START) + h)
        found.append(max(map(error_above, answer, exact)))
        seen += answer
    return found


def _fitted(
    errors: Sequence[float], noise: Sequence[float], arithmetic: str, problem: problems.NonlinearProblem
) -> MeasuredOrder:
    """The order that local errors show, which is one less than their power of h."""
    power, slopes = power_of_errors(errors, noise)
    return MeasuredOrder(None if power is None else power - 1, slopes, arithmetic, problem.words)


def power_of_errors(errors: Sequence[float], noise: Sequence[float]) -> tuple[int | None, tuple[float, ...]]:
    """The power of h that errors at halved steps show, or None; and the slopes before the first error in the noise.

    A single slope shows no power: between two long steps it may be anything.
    """
    clear = next((i for i, (e, n) in enumerate(zip(errors, noise, strict=True)) if not n < e < inf), len(errors))
    slopes = tuple(log2(a / b) for a, b in pairwise(errors[:clear]))
    powers = {round(slope) if abs(slope - round(slope)) <= SLACK else None for slope in slopes[-2:]}
    return (powers.pop() if len(powers) == 1 < len(slopes) else None), slopes


def _balls_in(value: Any, size: int) -> list[AnyNumber]:
    """The balls in a ball or in an array of balls. Raises WrongShape if they are not `size`, or NotANumber."""
    balls = list(np.asarray(value, dtype=object).ravel())
    if len(balls) != size:
        raise WrongShape(f"{size} balls went in, {len(balls)} came out")
    if not all(isinstance(x, arb) for x in balls):
        raise NotANumber(f"{type(balls[0]).__name__} where a ball went in")
    return balls


BALLS = ArrayAdapter("Arb balls", lambda numbers: numbers[0], _balls_in, arb)
ARRAYS_OF_BALLS = ArrayAdapter("arrays of Arb balls", lambda numbers: np.array(numbers, dtype=object), _balls_in, arb)
