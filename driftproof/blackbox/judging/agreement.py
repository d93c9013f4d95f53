"""A stepper beside the exact step of a method, over many steps: within the bound, or the simplest example beyond."""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import islice
from math import inf
from typing import TYPE_CHECKING, Any

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.sampled_steps import Arguments, Sizes, simplest_step, steps_within
from driftproof.blackbox.judging.tolerance import Allowance, Judgement, Tolerance
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.rounding.formats import BINARY64

if TYPE_CHECKING:
    from driftproof.methods.schemes import Method

COMPONENTS = ("q", "v")
# In a campaign of so many, an error that one state in 300 shows is missed once in 30; it takes 0.1 s.
EXAMPLES = 1000
# Of an exact value: three more than tell two neighbouring doubles apart.
_DIGITS = 20


@dataclass(frozen=True)
class Domain:
    """Where a stepper is tried: floats h > 0, q and v within these sizes; q and v are also tried at 0.

    The smallest ones keep what is tried away from underflow, where many a code that converts units loses digits that
    nobody misses; 0 tries all floats. In narrow formats they are raised to the root of the smallest normal number.

    >>> from driftproof import Domain, verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", domain=Domain(largest_step=0.5), examples=50, isolate=False).passed
    True
    """

    largest_step: float = 2.0
    largest_state: float = 1000.0
    smallest_step: float = 2.0**-20
    smallest_state: float = 2.0**-60

    def __post_init__(self) -> None:
        """Refuse what holds no step or no state."""
        for low, high in self.ranges:
            if not 0 <= low < high < inf:
                raise ValueError(f"from {low:g} to {high:g}: sizes go from 0 or more up to something larger and finite")

    @property
    def ranges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """From what to what sizes go: of steps, of states."""
        return (self.smallest_step, self.largest_step), (self.smallest_state, self.largest_state)

    @property
    def words(self) -> str:
        """The domain as inequalities."""
        return f"{self.smallest_step:.3g} <= h <= {self.largest_step:g}, |q|, |v| <= {self.largest_state:g}"


ORDINARY_DOMAIN = Domain()
NO_ALLOWANCE = Allowance()


@dataclass(frozen=True)
class Example:
    """One step: its arguments, the answer, and what was wrong with it, or how near the bound it came.

    `exact` and `error_over_bound` are of the worse component; `misbehaved` says what came instead of an answer;
    `reproduction` is the call as a line of Python.
    """

    q: float
    v: float
    h: float
    answer: tuple[float, float] | None
    component: str = ""
    exact: str = ""
    error_over_bound: float = 0.0
    scaled_error: float = 0.0
    misbehaved: str = ""
    reproduction: str = ""

    @property
    def call(self) -> str:
        """The arguments as one writes them."""
        return f"q={self.q!r}, v={self.v!r}, h={self.h!r}"

    @property
    def data(self) -> dict[str, Any]:
        """The same for programs; floats as text that gives them back to the last bit."""
        return {
            **{name: repr(getattr(self, name)) for name in ("q", "v", "h")},
            "answer": None if self.answer is None else [repr(x) for x in self.answer],
            "component": self.component or None,
            "exact": self.exact or None,
            "error_over_bound": f"{self.error_over_bound:.6g}",
            "misbehaved": self.misbehaved or None,
            "reproduction": self.reproduction,
        }

    @property
    def words(self) -> str:
        """What happened there."""
        if self.answer is None:
            return self.misbehaved
        got = self.answer[COMPONENTS.index(self.component)]
        error = f"error {self.error_over_bound:.3g} times the bound"
        return f"step({self.call}): {self.component} is {got!r}, exactly {self.exact}; {error}"


@dataclass(frozen=True)
class Agreement:
    """How a stepper compares with a method over `examples` steps.

    `worst` is the example with the largest error over its bound among those tried; `failing`, where there is one, the
    simplest found of those beyond their bound; `but_for` says in words with which allowance none is, if that was asked.
    `narrow` names the format of answers that are no doubles. Sampling is evidence, no proof; the bound is proved.
    """

    method: str
    domain: Domain
    examples: int
    worst: Example
    failing: Example | None
    largest_scaled_error: float
    but_for: str = ""
    narrow: str = ""

    @property
    def holds(self) -> bool:
        """True when no example was found beyond its bound."""
        return self.failing is None

    @property
    def lines(self) -> list[str]:
        """What was seen, and how to see it again."""
        if self.failing is not None:
            again = f"to see it again: {self.failing.reproduction}"
            why = [f"every error is within it {self.but_for}"] if self.but_for else []
            return [f"the simplest step beyond the bound: {self.failing.words}", again, *why]
        return [
            f"{self.examples} steps drawn from {self.domain.words}, every error within the derived bound",
            f"nearest to it: {self.worst.words}",
            f"largest error over the sum of |monomials|: {self.largest_scaled_error:.3g} u",
        ]

    @property
    def data(self) -> dict[str, Any]:
        """The same for programs."""
        return {
            "method": self.method,
            "examples": self.examples,
            "worst": self.worst.data,
            "failing": None if self.failing is None else self.failing.data,
            "largest_scaled_error": f"{self.largest_scaled_error:.6g}",
            "but_for": self.but_for or None,
        }


def agreement(
    subject: ForeignStepper,
    method: Method,
    allowance: Allowance = NO_ALLOWANCE,
    domain: Domain = ORDINARY_DOMAIN,
    examples: int = EXAMPLES,
) -> Agreement:
    """The stepper against the method on the oscillator, at `examples` floats drawn alike on every run.

    Raises ValueError where the method needs a solver tolerance, or takes none, and for a domain that leads to overflow;
    UnsupportedCall where the stepper takes one number only.
    """
    tolerance = Tolerance(method, subject.format, allowance)
    if subject.single:
        raise UnsupportedCall("it takes one number, and q'' = -q is of two")
    if domain != ORDINARY_DOMAIN:
        tolerance.demand_room(domain.largest_state, domain.largest_step)
    steps, states = (Sizes(*ends, subject.format) for ends in domain.ranges)
    seen = _Seen()

    def fails(step: Arguments) -> bool:
        return seen.add(_example(subject, tolerance, *step))

    for step in islice(steps_within(steps, states), examples):
        if fails(step):
            simplest_step(fails, step, steps, states)
            break
    return seen.summary(tolerance, domain, subject)


# Of ordinary size and of both signs, so that each entry of M(h) shows; steps with few bits and with many.
_STATES_BACK, _STEPS_BACK = ((1.0, 0.0), (0.0, 1.0), (-0.75, 1.25)), (0.25, 0.1)


def steps_back(
    subject: ForeignStepper, method: Method, allowance: Allowance = NO_ALLOWANCE, domain: Domain = ORDINARY_DOMAIN
) -> tuple[bool | None, str, str]:
    """Whether a few steps with h < 0 are those of M(h), in words and as a call; None where h < 0 is refused.

    Sizes of states and of steps are those of the domain, where it is a small one. Nothing is asked of
    implicit methods: at h < 0 their stages need not have a solution.
    """
    if not method.explicit:
        return None, f"{method.key} is implicit: steps back are not tried", ""
    tolerance, steps = Tolerance(method, subject.format, allowance), 0
    size, longest = min(1.0, domain.largest_state / 2), min(1.0, domain.largest_step)

    def number(x: float) -> float:
        return float(subject.format.nearest(Fraction(x)))

    for h in _STEPS_BACK:
        for q, v in _STATES_BACK:
            example = _example(subject, tolerance, number(size * q), number(size * v), -number(longest * h))
            steps += 1
            if example.answer is None:
                return None, f"h < 0 is refused: {example.misbehaved}", ""
            if _fails(example):
                example = _in_full(example, tolerance, subject)
                return False, f"h < 0 is no step back: {example.words}", example.reproduction
    return True, f"{steps} steps with h < 0 within the bound", ""


def rows_together(
    subject: ForeignStepper, method: Method, allowance: Allowance = NO_ALLOWANCE, domain: Domain = ORDINARY_DOMAIN
) -> tuple[bool | None, str, str]:
    """Whether each of several states in arrays takes the step M(h), as `steps_back` says it; None where one is taken.

    Raises UnsupportedCall where an array is one state.
    """
    tolerance, longest = Tolerance(method, subject.format, allowance), min(1.0, domain.largest_step)
    size, h = min(1.0, domain.largest_state / 2), float(subject.format.nearest(Fraction(longest * _STEPS_BACK[1])))
    states = [(size * q, size * v) for q, v in _STATES_BACK]
    try:
        answers = subject.step_batch([q for q, _ in states], [v for _, v in states], h)
    except Misbehaviour as refusal:
        return None, f"one state is taken at a time: {refusal}", ""
    for i, ((q, v), answer) in enumerate(zip(states, answers, strict=True)):
        if not all(component.allowed for component in tolerance.judge(q, v, h, answer)):
            seen = f"of {len(states)} states in arrays, row {i} goes from {(q, v)} to {answer} with h = {h!r}"
            return False, seen, ""
    return True, f"{len(states)} states in arrays, each within the bound", ""


class _Seen:
    """What a campaign has met; once an example fails, simpler ones follow, and the last that fails is the simplest."""

    def __init__(self) -> None:
        self.examples = 0
        self.worst: Example | None = None
        self.failing: Example | None = None
        self.scaled_errors = list[float]()

    def add(self, example: Example) -> bool:
        """Take note of it; whether it fails."""
        self.examples += self.failing is None
        self.scaled_errors.append(example.scaled_error)
        if _fails(example):
            self.failing = example
        if self.worst is None or example.error_over_bound > self.worst.error_over_bound:
            self.worst = example
        return self.failing is example

    def summary(self, tolerance: Tolerance, domain: Domain, subject: ForeignStepper) -> Agreement:
        assert self.worst is not None
        worst = _in_full(self.worst, tolerance, subject)
        failing = None if self.failing is None else _in_full(self.failing, tolerance, subject)
        narrow, largest = "" if tolerance.format is BINARY64 else tolerance.format.name, max(self.scaled_errors)
        return Agreement(tolerance.method.key, domain, self.examples, worst, failing, largest, narrow=narrow)


def _fails(example: Example) -> bool:
    return example.answer is None or example.error_over_bound > 1


def _example(subject: ForeignStepper, tolerance: Tolerance, q: float, v: float, h: float) -> Example:
    try:
        answer = subject.step(q, v, h)
    except Misbehaviour as error:
        return Example(q, v, h, None, misbehaved=str(error))
    judged = tolerance.judge(q, v, h, answer)
    worse = max((0, 1), key=lambda i: judged[i].ratio)
    judgement: Judgement = judged[worse]
    return Example(q, v, h, answer, COMPONENTS[worse], "", judgement.ratio, max(j.scaled for j in judged))


def _in_full(example: Example, tolerance: Tolerance, subject: ForeignStepper) -> Example:
    """The example with the exact value of its component written out, and its call."""
    example = replace(example, reproduction=call_text(subject, example.q, example.v, example.h))
    if example.answer is None:
        return example
    exact = tolerance.in_full(example.q, example.v, example.h)[COMPONENTS.index(example.component)]
    text = significant(exact, _DIGITS)
    return replace(example, exact=text if exact != Fraction(text) else f"{Decimal(text).normalize():f}")
