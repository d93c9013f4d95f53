"""Steps on a system that is given, compared with the method's: ordinary ones, elsewhere, back in time, and in a row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import product
from math import cos

from driftproof.blackbox.findings import Misbehaviour, Remarked, StepFinding
from driftproof.blackbox.judging.agreement import NOT_BACK
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.state_objects import NUDGES
from driftproof.blackbox.judging.systems.given_steps import Beside, GivenSteps
from driftproof.blackbox.judging.systems.held_states import common_length, jump_from, without_periods
from driftproof.blackbox.judging.systems.own_steps import COMPARED, SEEN_BENT
from driftproof.blackbox.judging.systems.own_system import OwnSystem
from driftproof.blackbox.judging.systems.whole_states import TIMES
from driftproof.blackbox.stepper.calling_conventions import STATE
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.starts import Start
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, SCALARS
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import MethodError, Splitting
from driftproof.support.plain_text import counted

# How many sizes of states, and of steps, are tried from the ordinary ones to the largest of the domain, in equal
# ratios; and the size of small states, where one with a smallest speed, or one above 0, shows.
_FARTHER, SMALL = 4, 2.0**-10
# A common length of many is no smaller part of them, while Euclid goes on to the rounding of others.
_COMMON = 2.0**-24
_FEW = 4  # numbers of a state, which a line shows


class Limited(OwnSystem):
    """Some states jump, or end at a limit, in every step, however short: these are not what it is for."""


def near(own: GivenSteps, wanted: Specification, about: str = "") -> StepFinding:
    """Compare steps of ordinary size with the method's; `about` is the system in words.

    Steps without an answer, and those that the method does not have, are left out. Raises MethodError if all are,
    or if slopes hardly change in the others.
    """
    found, bent, why = list[Beside](), 0.0, ""
    # Besides the states at which the system was seen, as many near them, so that none fits by chance.
    near = [tuple(x * (1 + cos(7 + 3 * k) / 4) for k, x in enumerate(y)) for y in own.states]
    start, refused, held = wanted.domain.begins, list[str](), list[Beside]()
    for t, share, y in product(own.times, COMPARED, [*own.states, *([] if start or own.held.limits else near)]):
        h = min(share * own.unit, wanted.domain.largest_step)
        try:
            one = _beside(own, wanted, t, y, h)
            held.append(one)
            if one.limit:
                continue
            if one.fails:
                if jump := jump_from(own, y, t):
                    refused.append(f"from ({_shown(y)}) {jump}")
                    continue
                return StepFinding(False, one.fails)
            found.append(one)
            bent = max(bent, h * own.apart(y, own.rates(t, y), own.rates(t + h, one.told)))
        except (Misbehaviour, ArithmeticError) as left_out:
            why = str(left_out)
            refused.append(why)
    if wrong := _of_no_period(held):
        return StepFinding(False, wrong)
    if bent < SEEN_BENT:
        longest = wanted.domain.largest_step
        words = f"; write --largest-step {own.unit:g}, in Python domain=Domain({own.unit:g})"
        longer = words * (longest < own.unit and bent * own.unit >= SEEN_BENT * longest)
        none = why or next(iter(_held(held)), "")
        still = f"in a step of it slopes hardly change{longer}" + f"; of others {none}" * bool(none)
        raise MethodError(still if found else none or still)
    splits = isinstance(of_one_state(wanted.method), Splitting)
    pushed = ""
    if isinstance(method := of_one_state(wanted.method), Splitting) and own.pushed:
        pushed = f", its force asked with the velocity {own.way(method)}"
    off = max(one.off for one in found)
    digits = f"to {off:.0e} in {len(found)} steps" if off else f"to the last digit in {len(found)} steps"
    turns = ", with velocities between positions" * (splits and own.halves[0].step == 2)
    if splits and own.size % 2:
        turns = f", its velocities being {' and '.join(own.subject.form.speed_names)}"
    rough = ", with more rounding than sums of these slopes have" * any(one.rough for one in found)
    told = f"is {wanted.method.key} on the system given{about}{turns}{pushed}{own.held.words}, {digits}{rough}"
    left = f"; {counted(len(refused), 'step')} cannot be compared: {refused[0]}" if refused else ""
    told += (_within(own, start) if start else "") + left
    return StepFinding(True, "; ".join([told, *_held(held)]))


def _beside(own: GivenSteps, wanted: Specification, t: float, y: Sequence[float], h: float) -> Beside:
    """A step beside the method's; its stages are solved by Newton's method where iterations do not settle."""
    try:
        return own.beside(wanted, t, y, h)
    except ArithmeticError:
        return replace(own, newton=True).beside(wanted, t, y, h)


def _within(own: GivenSteps, start: Start) -> str:
    """The states of a start from which steps are compared, and what is not seen of these, in words."""
    unseen = len(start.states) - len(own.states)
    told = f", from states in {start.words}"
    return told + (
        f"; the system given has no slopes at {unseen} of {len(start.states)} states there" if unseen else ""
    )


def longer(own: GivenSteps, wanted: Specification) -> list[float]:
    """Step sizes from the system's own time to the largest of the domain, in equal ratios; none if that is less."""
    h, longest = own.unit * COMPARED[0], wanted.domain.largest_step
    return [h * (longest / h) ** (i / _FARTHER) for i in range(1, _FARTHER + 1)] if h < longest else []


def _steps_elsewhere(own: GivenSteps, wanted: Specification) -> Iterator[tuple[float, Sequence[float], float]]:
    """Yield steps (t, y, h) from small and from larger states, and longer ones, up to the largest of the domain."""
    far, longest, h = wanted.domain.largest_state, wanted.domain.largest_step, own.unit * COMPARED[0]
    start = wanted.domain.begins
    for t, y in product(own.times, start.corners if start else own.states):
        ratio = max(1.0, far / (max(map(abs, y)) or far))
        for by in (1.0,) if start else (SMALL, *(ratio ** (i / _FARTHER) for i in range(1, _FARTHER + 1))):
            yield t, [own.number(x * by) for x in y], min(h, longest)
        for h_longer in longer(own, wanted):
            yield t, y, h_longer


def elsewhere(own: GivenSteps, wanted: Specification) -> StepFinding:
    """Compare steps from small and large states, and long ones; None if none of them can be compared.

    Raises Limited if there are states which the code puts elsewhere, however short the step, and all others agree.
    """
    states, steps, refused, held, jumps = list[float](), list[float](), list[str](), list[Beside](), ""
    for t, y, h in _steps_elsewhere(own, wanted):
        try:
            one = own.beside(wanted, t, y, h)
        except Misbehaviour as error:
            refused.append(str(error))
        except ArithmeticError:
            pass
        else:
            if one.fails and (jump := jump_from(own, y, t)):
                jumps = jumps or f"from ({_shown(y)}) {jump}"
                continue
            if one.fails:
                return StepFinding(False, one.fails)
            held.append(one)
            if one.limit:
                continue
            states.append(max(map(abs, y)))
            steps.append(h)
    if wrong := _of_no_period(held):
        return StepFinding(False, wrong)
    told = [f"no answer to {counted(len(refused), 'step')} elsewhere: {refused[0]}"] if refused else []
    told += (kept := _held(held))
    if jumps:
        seen = f"; {counted(len(steps), 'other step')} elsewhere agree" * bool(steps)
        asked = (
            "as at a limit of the code, or by a mistake; --start, in Python Domain(start=...), says where it is asked"
        )
        raise Limited(f"{jumps}, {asked}{seen}")
    if steps:
        reach = f"from states of {min(states):.3g} to {max(states):.3g}, of h up to {max(steps):.3g}"
        told += [f"{counted(len(steps), 'step')} elsewhere agree, {reach}"]
    words = "; ".join(told) or f"{wanted.method.key} has no steps with half of their digits elsewhere"
    return (Remarked if refused or kept else StepFinding)(steps != [] or None, words)


def back(own: GivenSteps, wanted: Specification) -> StepFinding:
    """Compare steps with h < 0, as `steps_back` does of q'' = -q."""
    if not wanted.method.explicit:
        return StepFinding(None, f"{wanted.method.key} is implicit: steps back are not tried")
    h, found, held = -min(own.unit * COMPARED[0], wanted.domain.largest_step), 0, list[Beside]()
    for t, y in product(own.times, own.states):
        try:
            one = own.beside(wanted, t, y, h)
        except Misbehaviour as error:
            return StepFinding(None, f"h < 0 is refused: {error}")
        except ArithmeticError:
            continue
        if one.fails:
            return Remarked(None, NOT_BACK) if one.end == [*y] else StepFinding(False, one.fails)
        found += not one.limit
        held.append(one)
    told = "; ".join([*(kept := _held(held)), f"{found} steps with h < 0 agree"])
    return (Remarked if kept else StepFinding)(found > 0 or None, told)


def few(
    own: GivenSteps, subject: ForeignStepper, wanted: Specification, nudges: Sequence[float] = NUDGES
) -> tuple[str, list[tuple[float, ...]]]:
    """What is wrong with a few successive steps of the stepper in some form, "" if nothing is; and their ends."""
    steps, y, seen = replace(own, subject=subject), [*own.states[-1]], list[tuple[float, ...]]()
    h, t = min(own.unit * COMPARED[0], wanted.domain.largest_step), 0.0
    for nudge in nudges:
        try:
            one = steps.beside(wanted, t, [own.number(nudge * x) for x in y], h)
        except ArithmeticError:  # the method has no step there
            break
        if one.fails:
            return one.fails, seen
        y = one.end
        seen.append(tuple(y))
        t += h * (own.times == TIMES)  # which the clock of a record returned shows
    if wanted.method.explicit and subject.adapter.at:  # whose clock goes back as well
        with suppress(Misbehaviour):
            steps.end(t, y, -h)
    return "", seen


def of_two(own: GivenSteps) -> ForeignStepper:
    """The stepper with its first two numbers alone, or the first position and velocity; the others are kept."""
    subject, taken = own.subject, 2 if STATE in own.subject.convention.order else 1
    rest = [*own.states[0]][taken : None if taken == 2 else own.size // 2]
    if not rest:
        return subject
    adapter = ARRAYS if subject.adapter is SCALARS else subject.adapter
    first = replace(
        adapter,
        name=f"the first of {adapter.name}",
        write=lambda numbers: adapter.write([*numbers, *rest]),
        read=lambda value, size: adapter.read(value, size + len(rest))[:size],
    )
    return replace(subject, adapter=first)


def _shown(y: Sequence[float]) -> str:
    """A state in words, of many numbers the first."""
    return ", ".join(f"{x:.4g}" for x in y[:_FEW]) + ", ..." * (len(y) > _FEW)


def _of_no_period(steps: Sequence[Beside]) -> str:
    """What is wrong with steps that end elsewhere by lengths which have no common one; "" if these are periods."""
    lengths, wrong = [one.period for one in steps], next((one.wrong for one in steps if one.period), "")
    return wrong * (common_length(lengths) < _COMMON * max(lengths, default=0.0))


def _held(steps: Sequence[Beside]) -> list[str]:
    """What steps show of a limit and of periods, in words."""
    limit = next((one.limit for one in steps if one.limit), "")
    return [*filter(None, [limit, without_periods([one.period for one in steps])])]
