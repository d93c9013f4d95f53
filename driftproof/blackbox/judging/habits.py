"""Explanations of a step that is beyond the bound of its method: a habit of codes, or an iteration that diverges."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import product
from typing import Any

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.agreement import EXAMPLES, Agreement, Example, agreement
from driftproof.blackbox.judging.specification import Allowance, Domain, Specification
from driftproof.blackbox.judging.tolerance import KICKS, Tolerance
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Splitting

# What some codes do besides rounding the method's sums and products; y' = f(t, y) has no positions.
_OF_POSITIONS = "if the velocity is a difference of positions over h"
HABITS: dict[str, Callable[[Allowance], Allowance]] = {
    "if h is rounded to binary32 first": lambda given: replace(given, step_in_binary32=True),
    _OF_POSITIONS: lambda given: replace(given, velocity_from_positions=True),
}
# Parts of a step's size that the step before it may have.
_OTHER_SIZES = (0.5, 2.0**-4, 2.0**-8)
# Step sizes at which the iteration of an implicit stage converges, the largest first.
_CONVERGING = (0.5, 0.25)


def explain_by_habits(subject: ForeignStepper, wanted: Specification, examples: int = EXAMPLES) -> Agreement:
    """The agreement; if it does not hold, `but_for` names the first habit with which it does.

    If it holds `within` a smaller domain, beyond which an iteration does not converge, that is said instead. Raises the
    ValueError of `agreement`.
    """
    found = agreement(subject, wanted, examples)
    if found.failing is None:
        return found
    if (after := _after_another(subject, wanted, found.failing)) and agreement(
        replace(subject, function=_made_anew(subject)), wanted, examples
    ).holds:
        failing = replace(found.failing, reproduction=f"{after}; {found.failing.reproduction}")
        return replace(found, failing=failing, but_for="if a new object makes each step")
    if not of_one_state(wanted.method).explicit and subject.convention.kind != MAP:
        smaller = (each for each in _smaller(wanted.domain) if _diverges(subject, wanted, found.failing, each))
        for domain in smaller:
            if agreement(subject, replace(wanted, domain=domain), examples).holds:
                return replace(found, within=domain)
    q, v, h, answer = found.failing.q, found.failing.v, found.failing.h, found.failing.answer
    # No habit explains a step without an answer, or one that goes elsewhere when it is made again.
    if answer is None or subject.step(q, v, h) != answer:
        return found
    # Of a force, whose coefficients are read as well: no rounding of these is taken for that of sums.
    by_force = subject.convention.kind == FORCE and isinstance(wanted.method, Splitting)
    if by_force and found.worst.error_over_bound <= KICKS:
        in_parts = agreement(subject, wanted, examples, KICKS)
        if in_parts.holds:
            return in_parts
    for words, habit in HABITS.items():
        allowing = replace(wanted, allowance=habit(wanted.allowance))
        if words == _OF_POSITIONS and subject.convention.kind == FIELD:
            continue
        if allowing != wanted and agreement(subject, allowing, examples).holds:
            return replace(found, but_for=words)
    return found


def _made_anew(subject: ForeignStepper) -> Callable[..., Any]:
    """The step of a new object each time."""
    return lambda *arguments, **named: subject.fresh().function(*arguments, **named)


def _after_another(subject: ForeignStepper, wanted: Specification, failing: Example) -> str:
    """The call of a step of another size, by a new object, after which its failing step goes elsewhere; "" if none."""
    tolerance, (q, v, h) = Tolerance.of(wanted, subject.format), (failing.q, failing.v, failing.h)
    with suppress(Misbehaviour, UnsupportedCall):
        if tolerance.allows(q, v, h, subject.fresh().step(q, v, h)):
            for before in (h * x for x in _OTHER_SIZES):
                (made := subject.fresh()).step(q, v, before)
                if not tolerance.allows(q, v, h, made.step(q, v, h)):
                    return call_text(subject, q, v, before)
    return ""


def _smaller(domain: Domain) -> Iterator[Domain]:
    """Yield smaller domains, in which iterations for the oscillator gain a bit or two a round."""
    for size, h in product((domain.largest_state, 1.0), _CONVERGING):
        if size <= domain.largest_state and h < domain.largest_step:
            yield replace(domain, largest_step=h, largest_state=size)


def _diverges(subject: ForeignStepper, wanted: Specification, failing: Example, domain: Domain) -> bool:
    """True if a step that fails iterates on, unlike the longest step of a domain from a state of size 1.

    It calls f more often, or its last calls, of as many iterations, differ by more than the tolerance.
    """
    stages, tolerance = getattr(of_one_state(wanted.method), "stages", 1), float(wanted.allowance.solver_tolerance or 0)

    def calls(q: float, v: float, h: float) -> Sequence[float]:
        asked = list[float]()
        with suppress(Misbehaviour):
            subject.step_with(lambda x: asked.append(x) or -x, q, v, h)  # type: ignore[func-returns-value]
        return asked

    def settled(asked: Sequence[float], period: int) -> bool:
        size, last = tolerance * max(map(abs, asked), default=0.0), asked[-3 * stages :]
        return all(abs(x - y) <= size for x, y in zip(last, last[period:], strict=False))

    long, short = calls(failing.q, failing.v, failing.h), calls(0.0, 1.0, domain.largest_step)
    periods = [period for period in range(1, stages + 1) if settled(short, period)]  # of one stage, 2 is no solution
    return len(long) > len(short) or (len(long) > 3 * stages and periods != [] and not settled(long, periods[0]))
