"""A step with its system built in, held to the system that it should have: its slopes, and the method's steps on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import cycle
from math import cos
from typing import Any

import numpy as np
from flint import arb

from driftproof.blackbox.checks.determinism import first_call_again
from driftproof.blackbox.findings import NO_EVIDENCE, BadInput, Misbehaviour, StepFinding
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem
from driftproof.blackbox.judging.own_system import OwnSteps, OwnSystem, own_time, seen_at
from driftproof.blackbox.judging.specification import Domain, Specification
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.report import UNDECIDED, Criterion, Report, criteria_parts, sections
from driftproof.blackbox.stepper.array_adapters import ARRAYS, SCALARS, AnyNumber
from driftproof.blackbox.stepper.calling_conventions import (
    CARRIED,
    MAP,
    MASSES,
    STATE,
    TIME,
    parameters_of,
    required_names,
    role_of,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.forms_by_values import as_complex, as_reals
from driftproof.blackbox.stepper.opening import imported
from driftproof.blackbox.stepper.state_forms import BATCH, SYSTEMS
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Method, MethodError, Splitting
from driftproof.support.plain_text import counted

# States beside those at which a built-in system is seen, as parts of them; how short a step shows slopes, to what part.
_BESIDE, _SHORT, _ALIKE = 2, 2.0**-20, 2.0**-10
_TAKES_ONE = (
    "a system is given for a step that takes its right-hand side: give a step that keeps its own, or leave the system "
    "out, and all but the right-hand side of the code is judged"
)
# What parameters of a step are set to: other than 1 and unlike each other, and products of them exact.
_VALUES = tuple(n / 16 for n in (20, 14, 22, 13, 18, 23, 15, 19, 17, 21))
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

    @property
    def times(self) -> Sequence[float]:
        """A step that takes no time begins at 0, if it has a clock."""
        return super().times if TIME in self.subject.convention.order else (0.0,)

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


@dataclass(frozen=True)
class _Given:
    """A system as a function, and its arguments: the time if it takes one, the state, and parameters of the step.

    If it is `by_parts`, y holds the parts of a complex state, which the system takes. `beside` are numbers of the step
    that the system does not take.
    """

    function: Callable[..., Any]
    plain: Sequence[str]
    values: Mapping[str, Any]
    by_parts: bool = False
    beside: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, system: Callable[..., Any] | str, subject: ForeignStepper) -> _Given:
        """The system, with a value for each parameter of the step that it takes by name: those of defaults are kept."""
        function, kept = imported(system, "system"), _defaults(subject)
        masses = getattr(subject.function, "masses", None)
        taken = [each for each in parameters_of(function) or () if each in {**kept, **subject.parameters}]
        plain = [each for each in required_names(function) or ("t", "y") if each not in taken]
        if len(plain) == 2 and role_of(plain[0], (STATE,)) and not role_of(plain[1], (STATE, TIME)):
            raise BadInput(f"the system given takes {plain[1]}, which is no parameter of the step")
        values = zip((each for each in taken if each not in kept), cycle(_VALUES))
        held = {each: kept[each] for each in taken if each in kept}
        beside = {} if {*MASSES} & {*held} or masses is None else {"the masses of its bodies": masses}
        return cls(function, plain, {**held, **dict(values)}, getattr(subject.function, "by_parts", False), beside)

    @property
    def words(self) -> str:
        """The values in words; "" if it takes no parameters."""
        shown = {**self.beside, **self.values}
        texts = (f"{name} = {', '.join(f'{each:g}' for each in np.ravel(x))}" for name, x in shown.items())
        return f" with {'; '.join(texts)}" if shown else ""

    def halved(self, subject: ForeignStepper) -> _Given:
        """The same system with half of each value that is not a default."""
        kept = _defaults(subject)
        return replace(self, values={name: x if name in kept else x / 2 for name, x in self.values.items()})

    def on(self, subject: ForeignStepper) -> ForeignStepper:
        """The step with these values."""
        return subject.with_parameters({name: x for name, x in self.values.items() if name in subject.parameters})

    def rates(self, t: float, y: Sequence[float]) -> list[float]:
        """The slopes. Raises ArithmeticError where it has none, and BadInput if they are not as many as the numbers."""
        state: Any = as_complex(y) if self.by_parts else np.array(y, float)
        given = [t, state] if len(self.plain) > 1 else [state]
        if len(given) == 2 and role_of(self.plain[1], (TIME,)) and not role_of(self.plain[0], (TIME,)):
            given.reverse()
        try:
            named = dict(zip(self.plain, given, strict=True)) if self.values else {}
            slopes = self.function(*([] if named else given), **named, **self.values)
            found = np.ravel(np.asarray(as_reals(slopes) if self.by_parts else slopes, float))
        except Exception as error:
            raise ArithmeticError(f"the system given raises {type(error).__name__}: {error}") from None
        if found.size != len(y):
            raise BadInput(f"the system given has {found.size} slopes where a step has {len(y)} numbers")
        if not np.isfinite(found).all():
            raise ArithmeticError("the system given is not finite there")
        return [float(x) for x in found]

    def at(self, y: Array) -> Array:
        """The slopes of a state at the time 0."""
        return np.array(self.rates(0.0, y.tolist()))

    def slopes(self, states: Sequence[tuple[float, ...]]) -> dict[tuple[float, ...], Array]:
        """The slopes at the states at which there are some. Raises BadInput if these are less than two."""
        slopes, why = dict[tuple[float, ...], Array](), ""
        for y in states:
            try:
                slopes[y] = self.at(np.array(y))
            except ArithmeticError as error:
                why = str(error)
        if len(slopes) < 2:
            raise BadInput(why)
        return slopes


def _defaults(subject: ForeignStepper) -> dict[str, Any]:
    """The numbers that are defaults of the step's parameters, and the masses of bodies, under each of their names."""
    given = parameters_of(getattr(subject.function, "step", subject.function)) or {}
    masses = dict.fromkeys(MASSES, getattr(subject.function, "masses", None))  # of bodies that attract each other
    known = {name: x for name, x in masses.items() if x is not None}
    return {**known, **{name: x.default for name, x in given.items() if isinstance(x.default, int | float)}}


def _readings(subject: ForeignStepper, domain: Domain) -> Iterator[tuple[ForeignStepper, list[tuple[float, ...]]]]:
    """Yield the step as it takes all numbers of its system, with states; then of other numbers that it may take."""
    first, given = seen_at(subject, domain), subject.convention.order
    yield first
    if hasattr(subject.function, "begun") or subject.adapter not in (ARRAYS, SCALARS, BATCH, *SYSTEMS):
        return
    for size in (1, 2, 3, 4, 6) if STATE in given else (2, 4, 6):
        of_size = getattr(subject.function, "of_size", lambda size: subject.function)
        other = replace(subject, function=of_size(size), adapter=ARRAYS) if STATE in given else subject
        found = seen_at(other, domain, size)
        with suppress(Misbehaviour):
            if size != len(first[1][0]) and OwnSteps(*found).end(0.0, found[1][0], _SHORT):
                yield found


def _unlike(subject: ForeignStepper, slopes: Mapping[tuple[float, ...], Array], unit: float) -> str:
    """How short steps differ from these slopes; "" if they agree."""
    for y, told in slopes.items():
        with suppress(Misbehaviour):
            seen = (np.array(OwnSteps(subject, [y]).end(0.0, y, _SHORT * unit)) - np.array(y)) / (_SHORT * unit)
            if not np.allclose(seen, told, _ALIKE, _ALIKE * np.abs(told).max()):
                shown = [", ".join(f"{x:.6g}" for x in numbers) for numbers in (y, seen, told)]
                return f"from ({shown[0]}) a short step goes as ({shown[1]}) times h, and it as ({shown[2]})"
    return ""


def steps_on_system(subject: ForeignStepper, wanted: Specification, system: Callable[..., Any] | str) -> StepFinding:
    """Compare steps of a built-in system with the method's on the system f(t, y), or f(y), that it should be.

    Parameters of the step that the system takes by name are set to the same numbers in both. Raises BadInput for a step
    with a right-hand side among its arguments, and for slopes of another number; OwnSystem if the method's steps are
    not known.
    """
    if subject.convention.kind != MAP or CARRIED in subject.convention.order:
        raise BadInput(_TAKES_ONE)
    given, refused, far = _Given.of(system, subject), list[BadInput](), list[str]()
    others = [given.halved(subject)] * bool(given.values) + [replace(given, by_parts=False)] * given.by_parts
    for each in (given, *others):  # if it has no slopes at numbers above 1, or of a complex state
        for place, (reading, states) in enumerate(_readings(each.on(subject), wanted.domain)):
            try:
                slopes = each.slopes(states)
            except BadInput as error:
                refused.append(error)
                continue
            unit = own_time([(np.array(y), slopes[y]) for y in slopes], each.at)
            if unlike := _unlike(reading, slopes, unit):
                far.append(unlike)
                if STATE in subject.convention.order and not hasattr(subject.function, "of_size"):
                    break  # of an array that it takes; the size of vectors is a guess
            elif far:
                what = f"of {len(states[0])} numbers its system is the one given, but not of more"
                raise OwnSystem(f"{what}, where {far[0]}; write a step of y and h of as many as are meant")
            else:
                size = f" in {counted(len(states[0]), 'number')}" * bool(place)
                return _compared(reading, wanted, each.words + size, each.rates, unit, [*slopes])
        if far and each.beside:
            raise OwnSystem(
                f"its system is not the one given{each.words}, and one that takes masses is asked for: {far[0]}"
            )
        if far:
            return StepFinding(False, f"its system is not the one given{each.words}: {far[0]}")
    raise refused[0]


def _compared(
    subject: ForeignStepper,
    wanted: Specification,
    words: str,
    rates: Callable[[float, Sequence[float]], list[float]],
    unit: float,
    states: Sequence[tuple[float, ...]],
) -> StepFinding:
    """Compare steps from these states, and from some beside them, with the method's; the system as its `words` say."""
    key = wanted.method.key
    beside = [tuple(x * (1 + cos(7 * i + 3 * k) / 4) for k, x in enumerate(y)) for i in range(_BESIDE) for y in states]
    steps = _StepsOn(subject, [*states, *beside], unit, rates)
    try:
        off, far = steps.off(wanted)
    except MethodError as why_not:
        raise OwnSystem(f"steps of {key} on it are not known: {why_not}") from None
    pushed = ", its force asked with the velocity before each kick" * steps.pushed(of_one_state(wanted.method))
    if far and pushed:
        raise OwnSystem(f"its force depends on the velocity, and with that before each kick {far}")
    counted = f"to {f'{off:.0e}' if off else 'the last digit'} in {2 * len(steps.times) * len(steps.states)} steps"
    return StepFinding(not far, far or f"is {key} on the system given{words}{pushed}, {counted}")


def left_at_one(subject: ForeignStepper, system: Callable[..., Any] | str) -> tuple[str, ...]:
    """The parameters of the step that are 1 because the system does not take them."""
    return tuple(name for name in subject.parameters if name not in _Given.of(system, subject).values)


def report_on_system(runner: IsolatedRunner, wanted: Specification, system: Callable[..., Any] | str) -> Report:
    """The report of `verify` on a step that is held to a given system. Raises ValueError for wrong input."""
    asked = partial(steps_on_system, wanted=wanted, system=system), partial(left_at_one, system=system)
    repeated = partial(first_call_again, explicit=wanted.method.explicit)
    steps, left, again = runner.run([*asked, repeated])
    if steps.kind == BadInput.kind:
        raise ValueError(steps.seen)
    is_open = steps.kind in (OwnSystem.kind, *NO_EVIDENCE)
    words, key = steps.result.words if steps.result else steps.seen, wanted.method.key
    missing = NO_EVIDENCE.get(steps.kind or "", _NEEDED) if is_open else ""
    holds = steps.result.holds if steps.result else None if is_open else False
    if holds and left.result:
        names = ", ".join(left.result)
        words = f"with {names} set to 1, where a mistake in their use does not show, it {words}"
        holds, missing = None, f"a system that takes {names} besides y, for other values"
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
