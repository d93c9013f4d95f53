"""Steppers with another system built in than q'' = -q: its slopes by short steps, and the method's steps on it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.agreement import EXAMPLES, Agreement
from driftproof.blackbox.judging.habits import explain_by_habits
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Domain, Specification
from driftproof.blackbox.judging.systems.own_steps import HALF_THE_DIGITS, OwnSteps
from driftproof.blackbox.judging.systems.whole_states import ROUGH, moves_more, oscillators, seen_at
from driftproof.blackbox.matching.linear_match import LinearFit, linear_fit
from driftproof.blackbox.stepper.calling_conventions import CARRIED, MAP, POSITION
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import MethodError


class OwnSystem(Misbehaviour):
    """Its system is built in and is not q'' = -q: its steps do not show all of a method."""


class NoSlopes(OwnSystem):
    """Not even the slopes of its system are seen."""


class AsOnOwnSystem(OwnSystem):
    """The steps of a stepper are those of the method on the system that it has built in; no more of it is seen."""


class NotOnOwnSystem(Misbehaviour):
    """The steps of a stepper are not those of the method on the system that it has built in."""

    kind = "another_method"


def rounding_of(subject: ForeignStepper, wanted: Specification, examples: int = EXAMPLES) -> Agreement:
    """The agreement with the method on q'' = -q, with the habit that explains errors.

    Raises OwnSystem, or NotOnOwnSystem, if another system is built in, which may be one of further numbers or of times.
    """
    found, given = explain_by_habits(subject, wanted, examples), subject.convention
    if not found.holds:
        system = own_system(subject, wanted.domain)
    elif given.kind != MAP or CARRIED in given.order:
        return found
    elif count := oscillators(subject, wanted):
        return replace(found, oscillators=count)
    else:
        system = system_of(subject, wanted.domain)
        one_by_one = POSITION in given.order and not subject.takes_time and not hasattr(subject.function, "begun")
        if system is not None and one_by_one and system.oscillates(HALF_THE_DIGITS):
            return found  # a step of several is made wrong, which another question shows
    if system is not None:
        _compare(system, wanted)
    elif clock := _reset_clock(subject):
        raise OwnSystem(clock)
    return found


def _compare(system: OwnSteps, wanted: Specification) -> None:
    """Raise OwnSystem or, if a step is not the method's, NotOnOwnSystem."""
    key = wanted.method.key
    try:
        off, far = system.off(wanted)
    except MethodError as why:
        raise OwnSystem(f"{system.words}: steps of {key} on it are not known: {why}") from None
    if not far:
        on_it = f"is {key} on its own system ({system.law}), to {f'{off:.0e}' if off else 'the last digit'}"
        raise AsOnOwnSystem(f"{on_it}; with another force it cannot be tried")
    if clock := _reset_clock(system.subject):
        raise OwnSystem(f"{clock}; without it, {far}")
    raise NotOnOwnSystem(f"{system.words}: {far}")


def _reset_clock(subject: ForeignStepper) -> str:
    """What is not seen of an object whose steps all begin at one time of a clock of its own; "" of any other."""
    return str(getattr(getattr(subject.function, "__self__", subject.function), "reset", ""))


def own_system(subject: ForeignStepper, domain: Domain) -> OwnSteps | None:
    """The system that a stepper has built in, if it is not q'' = -q. Raises OwnSystem if no slopes of it are seen."""
    given = subject.convention
    if given.kind != MAP or given.extra or CARRIED in given.order:
        return None
    system = system_of(subject, domain)
    return None if system is None or system.oscillates(ROUGH) else system


def linear_fit_of_all(subject: ForeignStepper) -> LinearFit:
    """The linear steps of q and v. Raises OwnSystem if these are not the whole state, or if other times move them."""
    given = subject.convention
    if given.kind == MAP and CARRIED not in given.order:
        more = moves_more(subject, ORDINARY_DOMAIN)
        system = system_of(subject, ORDINARY_DOMAIN) if more or subject.takes_time else None
        if system is not None and (more or system.timed) and not system.alike:
            raise OwnSystem(system.words)
    return linear_fit(subject)


def system_of(subject: ForeignStepper, domain: Domain) -> OwnSteps | None:
    """The system that a stepper has built in; None if short steps show none of two numbers. Raises NoSlopes of more."""
    system = OwnSteps.of(*(found := seen_at(subject, domain)))
    if system is None:  # of numbers that a code keeps above 0, it is seen there
        system = OwnSteps.of(found[0], [tuple(map(abs, y)) for y in found[1]])
    if system is None and len(found[1][0]) > 2:
        raise NoSlopes(f"its system of {len(found[1][0])} numbers is built in, and short steps show no slopes of it")
    return system


class OwnMethods(NamedTuple):
    """A built-in system, and the methods whose steps a stepper takes there; None if they may be of one without."""

    system: str
    keys: tuple[str, ...] | None


def own_methods(subject: ForeignStepper) -> OwnMethods | None:
    """The system that a stepper has built in, with its methods there. Raises OwnSystem if no slopes of it are seen."""
    if (system := own_system(subject, ORDINARY_DOMAIN)) is None:
        return None
    far = dict[str, str]()
    for key, method in METHODS.items():
        with suppress(MethodError):
            far[key] = system.off(Specification(method))[1]
    keys = tuple(key for key, words in far.items() if not words)
    return OwnMethods(system.words, keys if keys or len(far) == len(METHODS) else None)
