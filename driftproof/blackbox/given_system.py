"""A step with its system built in, held to the system that it should have: its slopes, and the method's steps on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from math import cos
from typing import Any

import numpy as np
from flint import arb

from driftproof.blackbox.checks.determinism import first_call_again
from driftproof.blackbox.findings import NO_EVIDENCE, BadInput, Misbehaviour, StepFinding
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem
from driftproof.blackbox.judging.own_system import OwnSteps, OwnSystem, own_time, seen_at
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.report import UNDECIDED, Criterion, Report, criteria_parts, sections
from driftproof.blackbox.stepper.array_adapters import AnyNumber
from driftproof.blackbox.stepper.calling_conventions import CARRIED, MAP, required_names
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import imported
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Method, MethodError, Splitting

# States beside those at which a built-in system is seen, as parts of them; how short a step shows slopes, to what part.
_BESIDE, _SHORT, _ALIKE = 2, 2.0**-20, 2.0**-10
_NEEDED = "a method that goes on it, and states with slopes that change in a step"


@dataclass(frozen=True)
class _StepsOn(OwnSteps):
    """The steps of a stepper, and the slopes of the system that it should have."""

    rates: Callable[[float, Sequence[float]], list[float]] = lambda t, y: [*y]

    @cached_property
    def problem(self) -> NonlinearProblem:
        """The system that is given."""

        def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            return [arb(x) for x in self.rates(float(t), [float(x) for x in y])]

        return NonlinearProblem("the system given", rate, lambda t: [arb(0)] * self.size, self.size // 2)

    def pushed(self, method: Method) -> bool:
        """True of a splitting whose force depends on the velocity: where that is asked its definition does not say."""
        with suppress(MethodError):
            super().step(method, 0.0, self.states[0], self.unit / 4)
            return False
        return isinstance(method, Splitting) and not self.size % 2

    def step(self, method: Method, t: float, y: Sequence[float], h: float) -> list[float]:
        """The method's step; of a splitting with such a force, each part asks where the one before it ends."""
        if not isinstance(method, Splitting) or not self.pushed(method):
            return super().step(method, t, y, h)
        half, moved = self.size // 2, t
        end: Array = np.array(y, dtype=float)
        for kind, share in method.parts:
            part = slice(half, None) if kind == "kick" else slice(half)
            end[part] += float(share) * h * np.array(self.rates(moved, end.tolist()))[part]
            moved += float(share) * h * (kind != "kick")
        return [float(x) for x in end]


def steps_on_system(subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str) -> StepFinding:
    """Compare steps of a built-in system with the method's on the system f(t, y), or f(y), that it should be.

    Raises BadInput for a step with a right-hand side among its arguments, and for slopes of another number; OwnSystem
    if the method's steps are not known.
    """
    if subject.convention.kind != MAP or CARRIED in subject.convention.order:
        raise BadInput("a system is given for a step that takes its right-hand side: leave it out, and all is judged")
    rates, (subject, states), key = (
        _rates_of(imported(system, "system")),
        seen_at(subject, wanted.domain),
        wanted.method.key,
    )
    slopes, why = dict[tuple[float, ...], Array](), ""
    for y in states:
        try:
            slopes[y] = np.array(rates(0.0, y))
        except ArithmeticError as error:
            why = str(error)
    if len(slopes) < 2:
        raise BadInput(why)
    unit = own_time([(np.array(y), slopes[y]) for y in slopes], lambda y: np.array(rates(0.0, [*y])))
    for y, told in slopes.items():
        with suppress(Misbehaviour):
            seen = (np.array(OwnSteps(subject, [y]).end(0.0, y, _SHORT * unit)) - np.array(y)) / (_SHORT * unit)
            if not np.allclose(seen, told, _ALIKE, _ALIKE * np.abs(told).max()):
                shown = [", ".join(f"{x:.6g}" for x in numbers) for numbers in (y, seen, told)]
                where = f"from ({shown[0]}) a short step goes as ({shown[1]}) times h, and it as ({shown[2]})"
                return StepFinding(False, f"its system is not the one given: {where}")
    beside = [tuple(x * (1 + cos(7 * i + 3 * k) / 4) for k, x in enumerate(y)) for i in range(_BESIDE) for y in slopes]
    steps = _StepsOn(subject, [*slopes, *beside], unit, rates)
    try:
        off, far = steps.off(wanted)
    except MethodError as why_not:
        raise OwnSystem(f"steps of {key} on it are not known: {why_not}") from None
    pushed = ", its force asked with the velocity before each kick" * steps.pushed(of_one_state(wanted.method))
    if far and pushed:
        raise OwnSystem(f"its force depends on the velocity, and with that before each kick {far}")
    counted = f"to {f'{off:.0e}' if off else 'the last digit'} in {4 * len(steps.states)} steps"
    return StepFinding(not far, far or f"is {key} on the system given{pushed}, {counted}")


def _rates_of(system: Callable[..., Any]) -> Callable[[float, Sequence[float]], list[float]]:
    """The slopes of a user's system. They raise ArithmeticError where it has none, BadInput if they are not as many."""
    timed = len(required_names(system) or "ty") > 1

    def rates(t: float, y: Sequence[float]) -> list[float]:
        try:
            found = np.ravel(np.asarray(system(*[t] * timed, np.array(y, float)), float))
        except Exception as error:
            raise ArithmeticError(f"the system given raises {type(error).__name__}: {error}") from None
        if found.size != len(y):
            raise BadInput(f"the system given has {found.size} slopes where a step has {len(y)} numbers")
        if not np.isfinite(found).all():
            raise ArithmeticError("the system given is not finite there")
        return [float(x) for x in found]

    return rates


def report_on_system(runner: IsolatedRunner, wanted: Specification, system: Callable[..., Any] | str) -> Report:
    """The report of `verify` on a step that is held to a given system. Raises ValueError for wrong input."""
    steps, again = runner.run([partial(steps_on_system, wanted=wanted, system=system), first_call_again])
    if steps.kind == BadInput.kind:
        raise ValueError(steps.seen)
    is_open = steps.kind in (OwnSystem.kind, *NO_EVIDENCE)
    words, key = steps.result.words if steps.result else steps.seen, wanted.method.key
    missing = NO_EVIDENCE.get(steps.kind or "", _NEEDED) if is_open else ""
    holds = steps.result.holds if steps.result else None if is_open else False
    checks = [Criterion("Steps on the system given", holds, (words,), {}, missing)]
    if again.result is not None:
        checks.append(Criterion("First call", again.result.holds, (again.result.words,), {}))
    failed = [check.lines[0] for check in checks if check.passed is False]
    passed = False if failed else holds
    verdict = (
        words if passed else f"is not {key}: {failed[0]}" if failed else f"{UNDECIDED} whether it is {key}: {words}"
    )
    parts, data = criteria_parts(checks, passed)
    return Report(runner.target.name, verdict, passed, sections(*parts), {**data, "remarks": []})
