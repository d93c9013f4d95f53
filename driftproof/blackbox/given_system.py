"""A step with its system built in, held to the system that it should have: its slopes, and the method's steps on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import log2
from typing import Any

import numpy as np

from driftproof.blackbox.checks.determinism import first_call_again, stale_in
from driftproof.blackbox.checks.trials import CheckResult
from driftproof.blackbox.criteria import BACK, ELSEWHERE, FIRST_CALL, LATER, ONLY, STATE_FORMS
from driftproof.blackbox.families.multistep_runs import later_steps
from driftproof.blackbox.findings import (
    CRASHES,
    NO_EVIDENCE,
    BadInput,
    Misbehaviour,
    Outcome,
    Remarked,
    StaleSlope,
    StepFinding,
    arithmetic_of,
)
from driftproof.blackbox.isolation import IsolatedRunner, Probe
from driftproof.blackbox.judging.single_mistakes import mistakes_on
from driftproof.blackbox.judging.specification import Domain, Specification
from driftproof.blackbox.judging.state_objects import state_objects
from driftproof.blackbox.judging.systems.given_comparisons import Limited, back, elsewhere, few, near, of_two
from driftproof.blackbox.judging.systems.given_slopes import GivenSlopes
from driftproof.blackbox.judging.systems.given_steps import BEFORE, GivenSteps
from driftproof.blackbox.judging.systems.held_states import SHORT, held_in
from driftproof.blackbox.judging.systems.own_steps import SEEN_BENT, OwnSteps
from driftproof.blackbox.judging.systems.own_system import NotOnOwnSystem, OwnSystem
from driftproof.blackbox.judging.systems.stage_times import with_stage_times
from driftproof.blackbox.judging.systems.whole_states import own_time, seen_at
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.report import NO_ANSWER, UNDECIDED, Criterion, Report, criteria_parts, refusal, sections
from driftproof.blackbox.stepper.calling_conventions import (
    CARRIED,
    MAP,
    ROTATION,
    STATE,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.starts import AS_PARTS
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, SCALARS
from driftproof.blackbox.stepper.states.state_forms import BATCH, BODIES, IN_PLANE, SYSTEMS
from driftproof.methods.catalogue import METHODS, of_one_state
from driftproof.methods.schemes import MethodError, Splitting
from driftproof.support.plain_text import counted

# A short step shows the slopes, but for what the slopes given change in it and for the rounding of the state over it.
# Those of another system differ by a thousandth at least: steps tell smaller errors.
_ALIKE = 2.0**-10
_SHOWN = 7  # numbers, such as those of an attitude and its rates; of more a line is hard to read
_TAKES_ONE = (
    "a system is given for a step that takes its right-hand side: give a step that keeps its own, or leave the system "
    "out, and all but the right-hand side of the code is judged"
)


class LeftAtOne(OwnSystem):
    """Parameters of the step are set to 1, as the system given does not take them."""


class PushedUnusually(OwnSystem):
    """The force depends on the velocity, and is asked with none of the usual ones."""


class Unpaired(OwnSystem):
    """It has numbers that are neither positions nor velocities."""


class NoClock(OwnSystem):
    """The system given depends on a time that the step does not take."""


# What would decide a question that is open.
_MISSING = {
    OwnSystem.kind: "a method that goes on it, and states with slopes that change in a step of --largest-step or less",
    LeftAtOne.kind: "a system that takes them besides y, for other values",
    Limited.kind: "the states that it is for: --start, in Python Domain(start=...); or the step before its end is set",
    NoClock.kind: "a step that takes the time, such as step(t, y, h)",
    PushedUnusually.kind: "a step that takes its force, step(force, q, v, h), or a step and a system without the drag",
    Unpaired.kind: "a wrapper that takes and returns positions and velocities alone, and a system of these; or, if all "
    f"numbers are such, a step that takes each part by its name: {AS_PARTS}",
    CRASHES: "a step that leaves its process alone",
    **NO_EVIDENCE,
}


def _readings(subject: ForeignStepper, domain: Domain) -> Iterator[tuple[ForeignStepper, list[tuple[float, ...]]]]:
    """Yield the step as it takes all numbers of its system, with states; then of other numbers that it may take."""
    first, given = seen_at(subject, domain), subject.convention.order
    yield first
    if first[0].adapter is BODIES:  # of a code that knows not how many coordinates a body has
        yield seen_at(replace(first[0], adapter=IN_PLANE), domain, 2 * len(first[1][0]) // 3)
    if domain.begins:  # a force of flat arrays may be another one than that of bodies in rows
        yield from ((replace(subject, function=form), first[1]) for form in subject.form.in_rows())
    if domain.begins or hasattr(subject.function, "begun") or subject.adapter not in (ARRAYS, SCALARS, BATCH, *SYSTEMS):
        return
    for size in (1, 2, 3, 4, 6) if STATE in given else (2, 4, 6):
        function = subject.form.of_size(size) if subject.form.of_size else subject.function
        other = replace(subject, function=function, adapter=ARRAYS) if STATE in given else subject
        found = seen_at(other, domain, size)
        with suppress(Misbehaviour):
            if size != len(first[1][0]) and OwnSteps(*found).end(0.0, found[1][0], SHORT):
                yield found


def _unit(slopes: Mapping[tuple[float, ...], Array], given: GivenSlopes) -> float:
    """The system's own time or, if it is shorter, the longest in which these slopes move a state by its own size.

    A constant force has no time of its own.
    """
    own, moved = own_time([(np.array(y), told) for y, told in slopes.items()], given.at), list[float]()
    for y, told in slopes.items():
        if (size := np.abs(y).max()) and (speed := np.abs(told).max()):
            with suppress(ArithmeticError):
                changed = np.abs(given.at(y + size / speed * told) - told).max()
                moved += [size / speed] * bool(changed > SEEN_BENT * speed)
    return min(own, 2.0 ** round(log2(max(moved)))) if moved else own


def _unlike(subject: ForeignStepper, slopes: Mapping[tuple[float, ...], Array], given: GivenSlopes, unit: float) -> str:
    """How short steps differ from these slopes of the system given; "" if they agree."""
    h = SHORT * unit
    for y, told in slopes.items():
        with suppress(Misbehaviour, ArithmeticError):
            seen = (np.array(OwnSteps(subject, [y]).end(0.0, y, h)) - np.array(y)) / h
            changed = np.abs(np.subtract(given.rates(h, (np.array(y) + h * told).tolist()), told)).max()
            rounded = float(subject.format.u) * np.abs(y).max() / h
            if not np.allclose(seen, told, _ALIKE, _ALIKE * np.abs(told).max() + 2 * (changed + rounded)):
                return _slopes_in_words(y, seen, told)
    return ""


def _slopes_in_words(y: Sequence[float], seen: Array, told: Array) -> str:
    """The slopes of short steps beside those of a system, in words: of many numbers, the one that differs most."""
    if len(y) > _SHOWN:
        worst = int(np.abs(seen - told).argmax())
        return (
            f"from ({y[0]:g}, {y[1]:g}, ...) number {worst} goes in a short step as {seen[worst]:.6g} times h, and in "
            f"the system given as {told[worst]:.6g}"
        )
    at, goes, given_as = (", ".join(f"{x:.6g}" for x in numbers) for numbers in (y, seen, told))
    return f"from ({at}) a short step goes as ({goes}) times h, and the system given as ({given_as})"


def _held(
    subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str, anyway: bool = False
) -> tuple[GivenSteps, str]:
    """The steps of a built-in system beside the system f(t, y), or f(y), that it should be, which is told in words.

    Parameters of the step that the system takes by name are set to the same numbers in both. Raises BadInput for a step
    with a right-hand side among its arguments, and for slopes of another number; unless `anyway`, NotOnOwnSystem if the
    system is another one, and OwnSystem if that is open.
    """
    if subject.convention.kind == ROTATION:
        raise BadInput(f"{_TAKES_ONE}; of one that turns vectors say what they are: {AS_PARTS}")
    if subject.convention.kind != MAP or CARRIED in subject.convention.order:
        raise BadInput(_TAKES_ONE)
    given, refused, far, limited = GivenSlopes.of(system, subject), list[BadInput](), list[str](), False
    others = [given.halved(subject)] * bool(given.values) + [replace(given, by_parts=False)] * given.by_parts
    for each in (given, *others):  # if it has no slopes at numbers above 1, or of a complex state
        for place, (reading, states) in enumerate(_readings(each.on(subject), wanted.domain)):
            try:
                slopes = each.slopes(states)
            except BadInput as error:
                refused.append(error)
                continue
            unit = _unit(slopes, each)
            begins, steps = wanted.domain.begins, GivenSteps(reading, [*slopes], unit, each.rates)
            held, within = held_in(steps, begins.cuts if begins else ())
            if not within[1:]:
                limited = True
                continue
            if within != [*slopes]:
                slopes = each.slopes(within)
                unit = _unit(slopes, each)
            if (unlike := _unlike(reading, slopes, each, unit)) and not anyway:
                far.append(unlike)
                fixed = STATE in subject.convention.order and not subject.form.of_size
                if fixed and not wanted.domain.begins:
                    break  # of an array that it takes; the size of vectors is a guess
            elif far and not wanted.domain.begins:
                what = f"of {len(states[0])} numbers its system is the one given, but not of more"
                raise OwnSystem(f"{what}, where {far[0]}; write a step of y and h of as many as are meant")
            else:
                size = f" in {counted(len(states[0]), 'number')}" * bool(place)
                return GivenSteps(reading, [*slopes], unit, each.rates, held=held), each.words + size
        if far and each.beside:
            raise OwnSystem(
                f"its system is not the one given{each.words}, and one that takes masses is asked for: {far[0]}"
            )
        if far and (left := [name for name in subject.parameters if name not in each.values]):
            raise LeftAtOne(f"with {', '.join(left)} set to 1 its system is not the one given{each.words}: {far[0]}")
        if far:  # of an object that is made anew its first call does not tell
            stale = stale_in(subject) if getattr(subject.function, "anew", False) else ""
            raise NotOnOwnSystem(f"its system is not the one given{each.words}: {far[0]}{stale}")
        if limited:
            raise Limited("states jump, or end at a limit, however short the step")
    raise refused[0]


def steps_on_system(subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str) -> StepFinding:
    """Compare steps of a built-in system with the method's on the one given. Raises OwnSystem where that is open."""
    steps, words = _held(subject, wanted, system)
    method = of_one_state(wanted.method)
    try:
        found = with_stage_times(steps, wanted, near(steps, wanted, words))
    except MethodError as why_not:
        kind = Unpaired if steps.size % 2 and isinstance(method, Splitting) else OwnSystem
        raise kind(f"steps of {wanted.method.key} on it are not known: {why_not}") from None
    if not found.holds and steps.held.divided:
        stages = replace(steps, rates=lambda t, y: steps.rates(t, steps.held.put(y)))
        with suppress(MethodError):
            if (other := near(stages, wanted, words)).holds:
                raise OwnSystem(
                    f"its stages are divided by their length as well; with a system that does so it {other.words}"
                )
    if not found.holds and isinstance(method, Splitting) and steps.pushed:
        if otherwise := steps.moved_otherwise(method):
            raise NotOnOwnSystem(f"whatever velocities its force is asked with, {otherwise}")
        euler = replace(wanted, method=METHODS["forward_euler"])
        with suppress(MethodError):
            if near(steps, euler).holds:
                raise NotOnOwnSystem(f"its positions move by old velocities: {found.words}")
        order = ", where all positions come before all velocities" * (steps.size > 2 and steps.halves[0].step is None)
        raise PushedUnusually(f"its force depends on the velocity{order}, and with that {BEFORE} {found.words}")
    if found.holds and steps.untimed:
        seen = f"at t = 0, which alone is seen, it {found.words}"
        raise NoClock(f"the system given depends on t, which the step does not take: {seen}")
    left = [name for name in subject.parameters if name not in GivenSlopes.of(system, subject).values]
    if found.holds and left:
        names = ", ".join(left)
        raise LeftAtOne(f"with {names} set to 1, where a mistake in their use does not show, it {found.words}")
    return found


def _of(
    subject: ForeignStepper,
    wanted: Specification,
    system: Callable[..., Any] | str,
    ask: Callable[[GivenSteps, Specification], Any],
) -> Any:
    """The answer to a further question on the system given."""
    return ask(_held(subject, wanted, system)[0], wanted)


def _mistakes(subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str) -> tuple[str, ...]:
    """The mistakes in the method that give its steps on the system given, also where short steps go otherwise."""
    steps, _ = _held(subject, wanted, system, anyway=True)
    return mistakes_on(steps, wanted) or mistakes_on(replace(steps, newton=True), wanted)


def _named(subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str) -> str:
    """Another method of the same kind and order, or one that moves all by the slopes at its start, that it is."""
    (steps, _), kind = _held(subject, wanted, system), type(wanted.method)
    for key, other in METHODS.items():
        alike = isinstance(other, kind) and other.explicit and other.claimed_order == wanted.method.claimed_order
        if key != wanted.method.key and (alike or key == "forward_euler"):
            with suppress(MethodError):
                if near(steps, replace(wanted, method=other)).holds:
                    return key
    return ""


def _elsewhere(steps: GivenSteps, wanted: Specification) -> StepFinding:
    found = elsewhere(steps, wanted)
    limits = (
        f"--largest-step and {'--start' if wanted.domain.begins else '--largest-state'}, in Python domain=Domain(...)"
    )
    limits += ", say how far it is to be right"
    return found._replace(words=f"{found.words}; {limits}") if found.holds is False else found


def _forms(steps: GivenSteps, wanted: Specification) -> StepFinding:
    if wanted.domain.begins or hasattr(steps.subject.function, "begun"):
        return StepFinding(None, "an object, or a start, has one form of state")
    return state_objects(steps.subject, wanted, partial(few, steps))


def _checked(
    steps: GivenSteps, wanted: Specification, check: Callable[[ForeignStepper], Sequence[CheckResult]]
) -> Sequence[CheckResult]:
    return [] if wanted.domain.begins else check(of_two(steps))


def _later(steps: GivenSteps, wanted: Specification) -> StepFinding:
    return later_steps(of_two(steps), explicit=wanted.method.explicit)


# Further questions, by the titles of those that are asked without a system.
_FURTHER = {ELSEWHERE: _elsewhere, BACK: back, LATER: _later, STATE_FORMS: _forms}


def report_on_system(
    runner: IsolatedRunner,
    wanted: Specification,
    system: Callable[..., Any] | str,
    others: Sequence[Callable[[ForeignStepper], Sequence[CheckResult]]],
) -> Report:
    """The report of `verify` on a step that is held to a given system, which remarks on what `others` find.

    Raises ValueError for wrong input.
    """
    on = partial(partial, _of, wanted=wanted, system=system)
    again = partial(first_call_again, explicit=wanted.method.explicit)
    asked: list[Probe] = [partial(steps_on_system, wanted=wanted, system=system), again]
    asked += [on(ask=ask) for ask in (*_FURTHER.values(), *(partial(_checked, check=each) for each in others))]
    first, repeated, *found = replies = runner.run(asked)
    if first.kind == BadInput.kind:
        raise ValueError(first.seen)
    key, missing = wanted.method.key, _MISSING.get(first.kind or "", "")
    words = first.result.words if first.result else first.seen
    holds = first.result.holds if first.result else None if missing else False
    checks = [Criterion("Steps on the system given", holds, (words,), {}, missing)]
    if holds or first.kind in (LeftAtOne.kind, NoClock.kind):
        checks += map(_criterion, _FURTHER, found)
    if repeated.result is not None:
        checks.append(_criterion(FIRST_CALL, repeated))
    told = [reply.result.words for reply in found if isinstance(reply.result, Remarked)]
    told += [check.words for reply in found[len(_FURTHER) :] for check in reply.result or () if check.holds is False]
    refuted = first.kind == NotOnOwnSystem.kind or (first.result and not holds)
    search = partial(_mistakes, wanted=wanted, system=system)
    mistakes = (runner.outcome_of(search).result or ()) if refuted else ()
    passed, verdict = _verdict(key, checks, mistakes)
    if refuted and not mistakes and (other := runner.outcome_of(partial(_named, wanted=wanted, system=system)).result):
        verdict = f"{verdict}; on it its steps are those of {other}"
    remarks = [f"remark: {each}" for each in told if passed and each.partition("; ")[0] not in verdict]
    if holds is False and not first.result and first.kind not in (NotOnOwnSystem.kind, StaleSlope.kind):
        verdict = f"{NO_ANSWER}: {words}"
    verdict = "; ".join(filter(None, [verdict, *remarks, arithmetic_of(replies)]))
    parts, data = criteria_parts(checks, passed)
    parts.append(("One mistake that gives the same steps", mistakes))
    return Report(runner.target.name, verdict, passed, sections(*parts), {**data, "remarks": remarks})


def _verdict(key: str, checks: Sequence[Criterion], mistakes: Sequence[str]) -> tuple[bool | None, str]:
    """Whether a step passes, and what is said of it: the first that failed, or is open, if the step itself is right.

    These mistakes in the method give the steps that are not its own.
    """
    first, *further = checks
    again = [check for check in further if check.title == FIRST_CALL]
    failed = [check for check in (first, *again, *further) if check.passed is False]
    if failed[1:] and failed[1] in again and not mistakes:  # what it keeps may move its slopes as well
        return False, f"is not {key}: its answers change from call to call: {failed[1].lines[0]}; {failed[0].lines[0]}"
    if failed and failed[0] in (first, *again):
        return False, refusal(key, mistakes, failed[0].lines[0])
    if failed:
        return False, f"is {key} on the system given{ONLY[failed[0].title]}: {failed[0].lines[0]}"
    if not first.passed:
        return None, f"{UNDECIDED} whether it is {key}: {first.lines[0]}"
    if unknown := [check for check in further if check.missing]:
        return None, f"{UNDECIDED} whether it is {key}: {unknown[0].title.lower()}: {unknown[0].lines[0]}"
    return True, first.lines[0]


def _criterion(title: str, outcome: Outcome) -> Criterion:
    """The criterion of a further question, which is open if it is not known why it has no answer."""
    found = outcome.result or StepFinding(None, outcome.seen)
    return Criterion(title, found.holds, (found.words,), {}, _MISSING.get(outcome.kind or "", ""))
