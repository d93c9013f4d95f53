"""Comparison of steps with another mass, stiffness or frequency; parameters left at their defaults are named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import inf
from typing import Any, NamedTuple

from driftproof.blackbox.findings import Misbehaviour, StepFinding, UnsupportedCall, WrongShape
from driftproof.blackbox.judging.agreement import ordinary_arguments
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.tolerance import KICKS, Tolerance
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper


def other_parameters(subject: ForeignStepper, wanted: Specification) -> StepFinding:
    """Compare steps with another mass, stiffness or frequency with M(h), and return as `steps_back` does.

    The answer is None if it has none of these; its words then name the parameters that were left at their defaults.
    Raises UnsupportedCall if it has no further parameters at all.
    """
    tolerance, (states, steps) = Tolerance.of(wanted, subject.format, KICKS), ordinary_arguments(subject, wanted.domain)
    known = {*subject.convention.extra, *subject.adapter.parameters}
    left = [name for name in _optional(subject) if name not in known]
    held = list[str]()
    for readings in _with_other_parameters(subject):
        wrong = list[str]()
        for reading in readings:
            left = [name for name in left if name not in reading.values]
            try:
                wrong.append(reading.off(tolerance, states, steps))
            except WrongShape as lost:
                return StepFinding(False, str(lost))
            except Misbehaviour:  # such as whole numbers that are refused
                continue
        shown = ", ".join(f"{name} = {x:g}" for name, x in readings[0].values.items())
        if wrong and all(wrong):
            rate = readings[0].rate
            system = f"-{f'{rate**2:g} ' * (rate != 1)}q"
            return StepFinding(False, f"with {shown} its step of q'' = {system} is wrong: {wrong[0]}")
        held += [f"{len(steps) * len(states)} steps with {shown} within the bound"] * bool(wrong)
    unseen = [f"{', '.join(left)} left at the default"] * bool(left)
    if not held and not unseen:
        raise UnsupportedCall("its oscillator has no frequency or stiffness among its parameters")
    return StepFinding(True if held else None, "; ".join([*held, *unseen]))


class _Reading(NamedTuple):
    """A stepper with other parameters, as a step of q'' = -rate² q that takes `scale` times the velocity over rate."""

    values: Mapping[str, float]
    subject: ForeignStepper
    rate: float
    scale: float

    def off(self, tolerance: Tolerance, states: Sequence[tuple[float, float]], steps: Sequence[float]) -> str:
        """The first step by h/rate that is not M(h), in words; "" if there is none."""
        for (q, v), h in product(states, steps):
            q1, v1 = self.subject.step(q, self.scale * v, h / self.rate)
            if not tolerance.allows(q, v, h, (q1, v1 / self.scale)):
                return f"from {(q, self.scale * v)} with h = {h / self.rate!r} it goes to {(q1, v1)}"
        return ""


def _optional(subject: ForeignStepper) -> dict[str, Any]:
    """The parameters with a default, by name, without those that are passed."""
    given, parameters = subject.convention.names, (calling.parameters_of(subject.function) or {}).values()
    return {p.name: p.default for p in parameters if p.default is not p.empty and p.name not in given}


def _with_other_parameters(subject: ForeignStepper) -> Iterator[list[_Reading]]:
    """Yield for each set of parameters what the step may be with it: one of these has to be right.

    A mass alone may be a label, and what is called a momentum, or has no name, may be a velocity. A
    parameter with a default of 1 is one of the oscillator if its name says so.
    """
    found, adapter = subject.convention, subject.adapter
    named = {float: 1, int: 2}  # the fewest letters: m = 1 may count something
    ones = [n for n, x in _optional(subject).items() if len(n) >= named.get(type(x), inf) and x == 1]
    given = {name: calling.word_of(name) for name in (*found.extra, *adapter.parameters, *ones)}
    masses = [name for name, word in given.items() if word in calling.MASSES]
    others = {name: word for name, word in given.items() if word in calling.UNIT_PARAMETERS and name not in masses}
    names = {*(calling.parameters_of(subject.function) or ()), *adapter.parts}
    momentum = bool(masses and (names & {*calling.MOMENTA} or (calling.STATE in found.order and not adapter.parts)))
    if found.kind == calling.FORCE and masses:
        yield _of_forces(subject, masses, momentum)
    elif found.kind == calling.MAP and (masses or others):
        yield from _of_oscillators(subject, masses, others, momentum)


def _reading(
    subject: ForeignStepper, values: Mapping[str, float], rate: float, scale: float, factor: float = 1.0
) -> _Reading:
    changed = subject.with_parameters(values)
    convention = replace(changed.convention, factor=factor * subject.convention.factor)
    return _Reading(values, replace(changed, convention=convention), rate, scale)


def _of_forces(subject: ForeignStepper, masses: Sequence[str], momentum: bool) -> list[_Reading]:
    """What a step that takes its force may be with another mass."""
    found = subject.convention
    if masses[0] in found.extra:
        mass = found.extra[masses[0]] / 4
        convention = replace(found.scaled(masses, 0.25) or found, momentum=1.0 if found.momentum == 1 else mass)
        return [_Reading({masses[0]: mass}, replace(subject, convention=convention), 1.0, 1.0)]
    sizes, factors = (1.0, *[2.0] * momentum), (2.0, 1.0)
    return [_reading(subject, {masses[0]: 2.0}, 1.0, scale, factor) for factor, scale in product(factors, sizes)]


def _of_oscillators(
    subject: ForeignStepper, masses: Sequence[str], others: Mapping[str, str], momentum: bool
) -> Iterator[list[_Reading]]:
    """What a step of an oscillator may be with another mass, stiffness or frequency; then with whole numbers."""
    mass, rates = (1.0 + bool(masses), (2.0,)) if others else (4.0, (0.5, 1.0))
    values = dict.fromkeys(masses, mass)
    values |= {x: 4 * mass if word in calling.STIFFNESSES else 2.0 for x, word in others.items()}
    scales = [(rate, rate * m) for rate in rates for m in (1.0, *[mass] * momentum)]
    yield [_reading(subject, values, *each) for each in scales]
    if masses and {*others.values()} <= {*calling.STIFFNESSES}:  # whole numbers, whose quotient is 1/4
        heavy, rates = (8, (0.5,)) if others else (4, rates)
        whole = dict.fromkeys(masses, heavy) | dict.fromkeys(others, 2)
        yield [_reading(subject, whole, rate, rate * m) for rate in rates for m in (1.0, *[heavy] * momentum)]
