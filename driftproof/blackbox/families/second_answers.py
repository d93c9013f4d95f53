"""What a Rosenbrock, IMEX or multistep step returns besides y1: the error estimate of its pair, or why none is read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from driftproof.blackbox.findings import Misbehaviour, StepFinding, UnsupportedCall, first_taken
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.foreign_code import FieldFunction
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.methods.numbers.number_field import Exact

_Reading = TypeVar("_Reading")
ESTIMATE = "Error estimate"
# A start, a time and a step size that differ, so that a time and a norm among the answers are told apart.
_START, _TIME, _STEP, _SIZES = 5.0, 7.0, 0.375, (3, 2)
# The factors of b - b_hat that are tried: no convention fixes its sign, and other factors are mistakes.
_FACTORS = tuple(Fraction(x) for x in ("1", "-1", "2", "-2", "1/2", "-1/2"))


class WithEstimate:
    """What a reading of a step says of its `estimate`, which is None if nothing is returned besides y1."""

    estimate: StepFinding | None

    def of_estimate(self, *holds: bool | None) -> list[str]:
        """The words on what is returned besides y1, if it is judged as one of these: True, False, None."""
        return [self.estimate.words] if self.estimate is not None and self.estimate.holds in holds else []

    @property
    def criteria_of_estimate(self) -> list[Criterion]:
        """The criterion of what is returned besides y1; none if that is nothing."""
        words = tuple(self.of_estimate(True, False, None))
        return [Criterion(ESTIMATE, self.estimate.holds, words, {})] if self.estimate is not None else []


@dataclass(eq=False)
class _SecondAnswers(ForeignStepper):
    """The subject with steps that end where its second answer says: in the other result, or in y plus an estimate."""

    solution: bool = False

    def step_field(self, rate: FieldFunction, t: AnyNumber, y: Sequence[AnyNumber], h: AnyNumber) -> list[AnyNumber]:
        super().step_field(rate, t, y, h)
        found = self.log.beside
        if found is None or len(found) != len(y):
            raise NotReadable("it returns something besides y1 at some steps only")
        return found if self.solution else [a + b for a, b in zip(y, found, strict=True)]


def judged_second(
    subject: ForeignStepper,
    alone: ForeignStepper,
    key: str = "",
    read: Callable[[ForeignStepper], _Reading] | None = None,
    differing: Callable[[_Reading, Fraction | None], list[str] | None] = lambda reading, factor: [],
) -> StepFinding | None:
    """Judge what a step returns besides y1 and its time; None if that is nothing.

    `alone` is the subject as a step(f, t, y, h), `key` that of its method. If the method has an embedded row, `read`
    reads a step that ends in the second answer, and `differing` says where it is not factor (b - b_hat), or not b_hat
    if the factor is None. Otherwise the finding says that nothing was judged.
    """
    end, found = list[AnyNumber](), list[AnyNumber]()
    still = lambda n: alone.step_field(lambda t, y: [0.0 * x for x in y], _TIME, [_START] * n, _STEP)
    with suppress(Misbehaviour, UnsupportedCall):
        end = first_taken(still, _SIZES)
        found = alone.log.beside or []
    if not found or found == [_TIME + _STEP]:
        return None
    unjudged = "what it returns besides y1 is not judged"
    if len(found) != len(end):
        return StepFinding(None, f"{unjudged}: it is one number, such as a norm of an error estimate")
    if found != end and any(found):
        return StepFinding(None, f"{unjudged}: with all slopes 0 it is {found[0]:.6g}")
    if read is None:
        return StepFinding(None, f"{unjudged}: {f'{key} defines no error estimate' if key else 'no method defines it'}")
    solution = found == end
    try:
        reading = read(_SecondAnswers(**vars(subject), solution=solution))
    except (NotReadable, Misbehaviour) as refusal:
        return StepFinding(None, f"{unjudged}: {refusal}")
    told = {factor: differing(reading, factor) for factor in ((None,) if solution else _FACTORS)}
    factor, wrong = min(told.items(), key=lambda each: each[1] != [])
    if wrong != []:
        first = next(iter(told.values())) or ["it uses other stages"]
        return StepFinding(False, f"the error estimate is not that of {key}: {first[0]}")
    if factor is not None and abs(factor) != 1:
        return StepFinding(False, f"the error estimate is {factor} times that of {key}")
    what = "result of the other row" if solution else "error estimate"
    return StepFinding(True, f"besides y1 it returns the {what} of {key}{', with the opposite sign' * (factor == -1)}")


def embedded_row(b: Sequence[Exact], b_hat: Sequence[Exact], factor: Fraction | None) -> tuple[Any, ...]:
    """The row b_hat, or factor (b - b_hat)."""
    return tuple(z if factor is None else factor * (x - z) for x, z in zip(b, b_hat, strict=True))
