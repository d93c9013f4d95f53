"""Comparison of many steps of a stepper with the exact ones, and the simplest step beyond the bound if there is one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import cycle, islice, product
from typing import Any

import numpy as np

from driftproof.blackbox.checks.determinism import ALIKE
from driftproof.blackbox.findings import Misbehaviour, Remarked, StepFinding
from driftproof.blackbox.judging.sampled_steps import Arguments, Sizes, simplest_step, steps_within
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Domain, Specification
from driftproof.blackbox.judging.tolerance import AVERAGES, KICKS, Tolerance
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.rounding.formats import BINARY64

COMPONENTS = ("q", "v")
# Chosen: an error that one state in 300 shows is missed with probability 1/30; this many steps take 0.1 s.
EXAMPLES = 1000
# How many oscillators are stepped together, besides as many as there are ordinary states: with both remainders by two,
# and more than a block of eight, or of 32.
_TOGETHER = (2, 4, 7, 8, 9, 33)
# One position more than a vector of three, or four, holds.
_DRAGGED = 5
# The digits of an exact value shown: three more than distinguish two neighbouring doubles.
_DIGITS = 20


@dataclass(frozen=True)
class Example:
    """One step that was tried: its arguments, its answer, and how near to the bound its error is.

    `component` is "q" or "v", whichever is nearer to its bound or farther beyond; `exact` and `error_over_bound` are
    of this component. `scaled_error` is the largest error in units of u over the sum of |monomials|. `misbehaved` says
    what came instead of an answer, and `reproduction` is the call as a line of Python. `allowed`: it is no failure.
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
    allowed: bool = False

    @property
    def call(self) -> str:
        """The arguments as they are written in a call."""
        return f"q={self.q!r}, v={self.v!r}, h={self.h!r}"

    @property
    def data(self) -> dict[str, Any]:
        """The example as JSON data, with floats as text that restores them to the last bit."""
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
        """The example in one line: the answer, the exact value and the error; or what came instead of an answer."""
        if self.answer is None:
            return self.misbehaved
        got = self.answer[COMPONENTS.index(self.component)]
        error = f"error {self.error_over_bound:.3g} times the bound"
        return f"step({self.call}): {self.component} is {got!r}, exact value {self.exact}; {error}"


@dataclass(frozen=True)
class Agreement:
    """The comparison of a stepper with a method over `examples` steps.

    `worst` is the example tried with the largest error over its bound, `failing` the simplest one beyond its bound, or
    None. `but_for` says under which allowance none is, if that was tried, and `within` is the smaller domain in which
    none is, if beyond it an iteration does not converge. `narrow` is the format of answers that are not doubles.
    Errors of up to `times` the bound are allowed. One state holds so many `oscillators`. Sampling is evidence, not
    proof; the bound, proportional to a `solver_tolerance`, is proved.
    """

    method: str
    domain: Domain
    examples: int
    worst: Example
    failing: Example | None
    largest_scaled_error: float
    but_for: str = ""
    within: Domain | None = None
    narrow: str = ""
    solver_tolerance: float = 0.0
    times: int = 1
    oscillators: int = 1

    @property
    def holds(self) -> bool:
        """True if no example was found beyond its bound."""
        return self.failing is None

    @property
    def bound(self) -> str:
        """Within what all errors are if it holds."""
        if self.worst.error_over_bound <= 1:
            return "within the derived bound"
        why = "in averages of stages" if self.times == AVERAGES else "where kicks are added in parts"
        return f"within {self.times} times the derived bound, as {why}"

    @property
    def lines(self) -> list[str]:
        """The result as lines of text, with the call that shows a failure again."""
        if self.failing is not None:
            again = f"to reproduce: {self.failing.reproduction}"
            why = [f"every error is within it {self.but_for}"] if self.but_for else []
            if self.within is not None:
                within = f"h <= {self.within.largest_step:g} and |q|, |v| <= {self.within.largest_state:g}"
                diverges = f"its iteration does not converge at h = {self.failing.h:g}"
                why = [f"{diverges}; for {within} every error is within the bound"]
            return [f"the simplest step beyond the bound: {self.failing.words}", again, *why]
        return [
            f"{self.examples} steps drawn from {self.domain.words}, every error {self.bound}",
            f"closest to the bound: {self.worst.words}",
            f"largest error over the sum of |monomials|: {self.largest_scaled_error:.3g} u",
        ]

    @property
    def data(self) -> dict[str, Any]:
        """The result as JSON data."""
        return {
            "method": self.method,
            "examples": self.examples,
            "worst": self.worst.data,
            "failing": None if self.failing is None else self.failing.data,
            "largest_scaled_error": f"{self.largest_scaled_error:.6g}",
            "but_for": self.but_for or None,
        }


def agreement(subject: ForeignStepper, wanted: Specification, examples: int = EXAMPLES, kicks: int = 1) -> Agreement:
    """Compare the stepper with the method on the oscillator, at `examples` steps that are the same on every run.

    Its errors may be `kicks` times the bound, if these are added in parts.

    Raises ValueError if the allowance lacks the solver tolerance of an implicit method or has one for an explicit
    method, or if the domain leads to overflow; UnsupportedCall if the stepper takes one number only.
    """
    tolerance, domain = Tolerance.of(wanted, subject.format, kicks), wanted.domain
    if domain != ORDINARY_DOMAIN:
        tolerance.require_no_overflow(domain.largest_state, domain.largest_step)
    steps, states = (Sizes(*ends, subject.format) for ends in domain.ranges)
    tried = list[Example]()

    def fails(step: Arguments) -> bool:
        tried.append(_example(subject, tolerance, *step))
        return not tried[-1].allowed

    found = next(filter(fails, islice(steps_within(steps, states), examples)), None)
    count = len(tried)
    if found:
        simplest_step(fails, found, steps, states)  # after one that fails, only simpler ones: the last is the simplest
    failing = next((_in_full(each, tolerance, subject) for each in tried[::-1] if not each.allowed), None)
    worst = _in_full(max(tried, key=lambda each: each.error_over_bound), tolerance, subject)
    narrow, largest = "" if subject.format is BINARY64 else subject.format.name, max(x.scaled_error for x in tried)
    solved = float(wanted.allowance.solver_tolerance or 0)
    about = narrow, solved, tolerance.averages
    return Agreement(tolerance.method.key, domain, count, worst, failing, largest, "", None, *about)


# States of ordinary size and of both signs, so that each entry of M(h) shows; steps of few bits and of many.
_STATES_BACK, _STEPS_BACK = ((1.0, 0.0), (0.0, 1.0), (-0.75, 1.25)), (0.25, 0.1)
NOT_BACK = "it does not run backwards: h < 0 does nothing, the state is returned unchanged"


def ordinary_arguments(subject: ForeignStepper, domain: Domain) -> tuple[list[tuple[float, float]], list[float]]:
    """States (q, v) and step sizes of ordinary size, or smaller if the domain is, in the stepper's format."""
    size, longest = min(1.0, domain.largest_state / 2), min(1.0, domain.largest_step)

    def number(x: float) -> float:
        return float(subject.format.nearest(Fraction(x)))

    return [(number(size * q), number(size * v)) for q, v in _STATES_BACK], [number(longest * h) for h in _STEPS_BACK]


def steps_back(subject: ForeignStepper, wanted: Specification) -> StepFinding:
    """Compare a few steps with h < 0 with M(h); which the finding shows again if one is wrong.

    The answer is None if h < 0 is refused or does nothing, as in a run that ends before it begins, and for an implicit
    method, whose stages need not have a solution at h < 0. States and steps are of ordinary size, or smaller if the
    domain is. Of a step of one number nothing else is said.
    """
    if not wanted.method.explicit:
        return StepFinding(None, f"{wanted.method.key} is implicit: steps back are not tried")
    if subject.single:
        still = subject.step_field(lambda t, y: [1.0], 0.0, [1.0], -_STEPS_BACK[0]) == [1.0]
        return Remarked(None, NOT_BACK) if still else StepFinding(True, "")
    tolerance, (states, steps) = Tolerance.of(wanted, subject.format, KICKS), ordinary_arguments(subject, wanted.domain)
    for h, (q, v) in product(steps, states):
        example = _example(subject, tolerance, q, v, -h)
        if example.answer is None:
            return StepFinding(None, f"h < 0 is refused: {example.misbehaved}")
        if example.answer == (q, v) != subject.step(q, v, h):  # without a force, a state at rest stays there
            return Remarked(None, NOT_BACK)
        if not example.allowed:
            example = _in_full(example, tolerance, subject)
            return StepFinding(False, f"a step with h < 0 is wrong: {example.words}", example.reproduction)
    return StepFinding(True, f"{len(steps) * len(states)} steps with h < 0 within the bound")


def several_together(subject: ForeignStepper, wanted: Specification) -> StepFinding:
    """Compare the step of several oscillators at once, of all sizes in the domain, with M(h); return the finding.

    They are the numbers of one state, or states in arrays if the system is built in. For an implicit method they have
    one size, since a solver may stop by the largest. The answer is None if only one is taken at a time. Raises
    UnsupportedCall if an array is one state.
    """
    tolerance, taken, refused = Tolerance.of(wanted, subject.format, KICKS), list[int](), ""
    for states, h in _sets_together(subject, wanted):
        try:
            answers = subject.step_batch([q for q, _ in states], [v for _, v in states], h)
        except Misbehaviour as refusal:
            refused = refused or str(refusal)
            continue
        taken.append(len(states))
        for i, ((q, v), answer) in enumerate(zip(states, answers, strict=True)):
            if not tolerance.allows(q, v, h, answer):
                seen = f"number {i} goes from {(q, v)} to {answer} with h = {h!r}"
                return StepFinding(False, f"of {len(states)} oscillators together, {seen}")
    if not taken:
        return StepFinding(None, f"it takes one at a time: {refused}")
    if subject.gives_velocities and (seen := _pushed_apart(subject, wanted.domain)):
        return StepFinding(False, seen)
    return StepFinding(True, f"{', '.join(map(str, taken))} oscillators in one step, each within the bound")


def _pushed_apart(subject: ForeignStepper, domain: Domain) -> str:
    """A position that ends elsewhere with others than alone, under a force of its own velocity; "" if none does.

    A method for q'' = F(q) does not say which velocity a force is given, but it is that of the same position.
    """
    (*_, (q, v)), (h, _) = ordinary_arguments(subject, domain)
    states = [(q, v / 2**i) for i in range(_DRAGGED)]

    def stepped(*some: tuple[float, float]) -> list[float]:
        q, v = map(list, zip(*some, strict=True))
        drag = lambda t, q, v: [-x - y for x, y in zip(q, v, strict=True)]
        return subject.step_dragged(drag, subject.adapter.number(0.0), q, v, subject.adapter.number(h))

    with suppress(Misbehaviour):
        together = stepped(*states)
        for i, state in enumerate(states):
            ends = together[i :: len(states)], stepped(state)
            if not np.allclose(*ends, rtol=ALIKE, atol=0):
                where = f"of {len(states)} positions whose forces depend on velocities, number {i} goes from {state}"
                return f"{where} to {tuple(ends[0])}, and alone to {tuple(ends[1])}"
    return ""


def _sets_together(
    subject: ForeignStepper, wanted: Specification
) -> Iterator[tuple[Sequence[tuple[float, float]], float]]:
    """The states that are stepped together, and the step size: first the ordinary ones, then more, of all sizes.

    For an implicit method the ordinary ones are repeated.
    """
    ordinary, (_, step) = ordinary_arguments(subject, wanted.domain)
    yield ordinary, step
    drawn = steps_within(*(Sizes(*ends, subject.format) for ends in wanted.domain.ranges))
    for count in _TOGETHER:
        if wanted.method.explicit:
            (q, v, h), *others = islice(drawn, count)
            yield [(q, v), *((q, v) for q, v, _ in others)], h
        else:
            yield [*islice(cycle(ordinary), count)], step


def _example(subject: ForeignStepper, tolerance: Tolerance, q: float, v: float, h: float) -> Example:
    try:
        answer = subject.step(q, v, h)
    except Misbehaviour as error:
        return Example(q, v, h, None, misbehaved=str(error))
    judged = tolerance.judge(q, v, h, answer)
    worse = max((0, 1), key=lambda i: judged[i].ratio)
    allowed, scaled = all(component.allowed for component in judged), max(component.scaled for component in judged)
    return Example(q, v, h, answer, COMPONENTS[worse], "", judged[worse].ratio, scaled, allowed=allowed)


def _in_full(example: Example, tolerance: Tolerance, subject: ForeignStepper) -> Example:
    """The example with the exact value of its component and with the call that reproduces it."""
    example = replace(example, reproduction=call_text(subject, example.q, example.v, example.h))
    if example.answer is None:
        return example
    exact = tolerance.in_full(example.q, example.v, example.h)[COMPONENTS.index(example.component)]
    text = significant(exact, _DIGITS)
    return replace(example, exact=text if exact != Fraction(text) else f"{Decimal(text).normalize():f}")
