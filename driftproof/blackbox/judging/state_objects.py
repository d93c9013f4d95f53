"""Steps from different objects with the same state: arrays, lists, tuples, and the very object returned before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, RightInAnotherForm, StepFinding, WrongShape
from driftproof.blackbox.judging.agreement import ordinary_arguments
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.tolerance import KICKS, Tolerance
from driftproof.blackbox.judging.walks import NUDGE, Walker, walk_on
from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    POSITION,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    CallingConvention,
)
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, LISTS, SCALARS, TUPLES, ArrayAdapter, Foreign
from driftproof.blackbox.stepper.states.named_answers import clock_of, goes_on, parts_of
from driftproof.blackbox.stepper.states.state_forms import BODIES, IN_PLANE, OF_TWO_DIMENSIONS, WITH_GAPS
from driftproof.blackbox.stepper.wrappers.wrappers import turn_wrapper

_FORMS = (ARRAYS, LISTS, TUPLES)
# By what the state is multiplied before each of the successive steps from each form of state.
NUDGES = (1.0, 1.0, NUDGE)
_AGAIN = "one object overwritten between steps"
_STATE_ROLES = (POSITION, VELOCITY, STATE)


def state_objects(
    subject: ForeignStepper, wanted: Specification, tried: Callable[..., tuple[str, list[Any]]] | None = None
) -> StepFinding:
    """Compare steps from the very object that the step before returned, and from other forms of state, with the method.

    The words name the form that was given. The answer is None if the step is wrong in that form and in every other. If
    the form is an array, a list or a tuple, the other two must be right as well, unless they are refused. A step may
    overwrite an argument with its answer, and with nothing else. A step of a force is also given bodies in space.
    `tried` is how a few successive steps are looked at, if not on q'' = -q.
    """
    several = ", several positions as NumPy arrays" * (subject.adapter is SCALARS and subject.convention.kind == FORCE)
    back = ", and comes back as (v1, q1)" * subject.convention.velocity_first
    trial = partial(tried or _tried, wanted=wanted)
    given = f"the state is given as {subject.adapter.name}{several}{back}"
    keeping = _ReusingAnswers(subject.function, subject.convention)
    wrong, own = trial(_changed(subject, function=keeping))
    forms = [form for form in _FORMS if subject.adapter in _FORMS and form is not subject.adapter]
    if wrong and (from_copies := trial(subject)[0]):
        if trial(subject)[0] != from_copies:
            return StepFinding(None, f"{given}: the same steps, taken again, end elsewhere")
        if not trial(subject, nudges=NUDGES[:-1])[0]:
            return StepFinding(False, f"a step that begins in almost the state where one ended is wrong: {from_copies}")
        turned = {_turned(subject.adapter): turn_wrapper(subject)} if STATE in subject.convention.order else {}
        for form, wrapper in {**dict.fromkeys(forms, ""), **turned}.items():
            with suppress(Misbehaviour):
                if not trial(_in_form(subject, form))[0]:
                    words = f"it is where the state comes as {form.name}{wrapper}; {given}: {from_copies}"
                    return RightInAnotherForm(False, words)
        return StepFinding(None, given)
    if wrong:
        return StepFinding(False, f"a step from the object that the previous step returned is wrong: {wrong}")
    if keeping.clock:
        return StepFinding(False, keeping.clock)
    if keeping.spoilt and not subject.log.works_in_place:
        return StepFinding(False, "it changes its arguments to something other than its answer")
    found: dict[str, list[str]] = {}
    numbers = (SCALARS,) * (not subject.log.works_in_place)  # a float that is handed over cannot be changed
    rows = {FORCE: (BODIES, IN_PLANE), FIELD: (OF_TWO_DIMENSIONS, *numbers) * (subject.adapter is ARRAYS)}
    apart = (WITH_GAPS,) * bool(several or subject.adapter is ARRAYS)
    ways = {x.name: _in_form(subject, x) for x in (*forms, *rows.get(subject.convention.kind, ()), *apart)}
    overwriting = _Overwriting(subject.function, subject.convention)
    if apart or subject.adapter is LISTS:
        ways[_AGAIN] = _changed(subject, function=overwriting)
    for words, changed in ways.items():
        try:
            wrong, seen = trial(changed)
        except Misbehaviour:
            found.setdefault("are refused", []).append(words)
            continue
        if wrong:
            return StepFinding(False, f"{given}; with {words} it takes a different step: {wrong}")
        same = "give the same bits" if seen in ([], own) else "give the same up to rounding"
        if words != _AGAIN or overwriting.handed:
            found.setdefault(same, []).append(words)
    others = [f"{', '.join(names[:-1])}{' and ' * (names[1:] != [])}{names[-1]} {x}" for x, names in found.items()]
    handed = ["steps from the previous step's own object agree with those from a copy"] if keeping.handed else []
    return StepFinding(True, "; ".join([given, *others, *handed]))


def _in_form(subject: ForeignStepper, form: ArrayAdapter) -> ForeignStepper:
    single = subject.single or (form is SCALARS and subject.convention.kind == FIELD)
    return _changed(subject, adapter=form, single=single)


def _changed(subject: ForeignStepper, **parts: Any) -> ForeignStepper:
    """The subject with other parts, whose log knows only how its answers are read."""
    log = CallLog(works_in_place=subject.log.works_in_place, layout=subject.log.layout)
    return replace(subject, log=log, **parts)


def _turned(adapter: ArrayAdapter) -> ArrayAdapter:
    """The same form of state with the velocity first."""
    return replace(
        adapter,
        name=f"(v, q) in {adapter.name}",
        write=lambda numbers: adapter.write([*numbers][::-1]),
        read=lambda value, size: adapter.read(value, size)[::-1],
    )


# The numbers of components tried in two dimensions: those of whole rows, of a square or one body, and of parts of one.
_OF_ROWS = {BODIES: (15, 3, 5), IN_PLANE: (10, 2, 3), OF_TWO_DIMENSIONS: (33, 9, 5)}


class _SmallWalker(Walker):
    """A walker with problems of two components, or of one if two are refused; in rows of several."""

    @property
    def numbers(self) -> tuple[int, ...]:
        return (1,) if self.subject.single else _OF_ROWS.get(self.subject.adapter, (2, 1))


def _tried(
    subject: ForeignStepper, wanted: Specification, nudges: Sequence[float] = NUDGES
) -> tuple[str, list[tuple[float, float]]]:
    """What is wrong with a few successive steps, "" if nothing is, and the answers on q'' = -q.

    If a right-hand side can be given, a nonlinear problem is tried as well. Raises a Misbehaviour of the stepper.
    """
    tolerance, seen = Tolerance.of(wanted, subject.format, KICKS), list[tuple[float, float]]()
    (*_, (q, v)), (*_, h) = ordinary_arguments(subject, wanted.domain)
    for nudge in () if subject.single else nudges:
        q, v = (float(subject.format.nearest(Fraction(nudge * x))) for x in (q, v))
        answer = subject.step(q, v, h)
        if not tolerance.allows(q, v, h, answer):
            return f"from q={q!r}, v={v!r} with h={h!r} it goes to {answer}", seen
        seen.append(answer)
        q, v = answer
    if wanted.method.explicit and subject.adapter.with_parameters:  # the clock of a record goes back as well
        with suppress(Misbehaviour):
            subject.step(q, v, -h)
    if subject.convention.kind not in (FIELD, FORCE):
        return "", seen
    found = walk_on(_SmallWalker(subject, wanted), most=3 if subject.adapter in _OF_ROWS else 1)
    if found.holds is None and not seen:
        raise WrongShape(found.words)
    return (found.words if found.holds is False else ""), seen


class _ReusingAnswers:
    """A stepper that gets, in place of an array, a list or a record, the object of its numbers that its last step left.

    `handed` is True once it got one. `spoilt` is True once a position, a velocity or a state that it got is afterwards
    neither unchanged nor a part of the answer. `clock` says in words how the clock of a record goes wrong.
    """

    def __init__(self, function: Callable[..., Any], convention: CallingConvention) -> None:
        self.function = function
        self.order = convention.order
        self.roles = dict(zip(convention.names, convention.order, strict=False))
        self.known: list[Foreign] = []
        self.handed = self.spoilt = False
        self.clock = ""

    def __call__(self, *arguments: Foreign, **named: Foreign) -> Foreign:
        given = [self._known_as(x, place) for place, x in enumerate(arguments)]
        by_name = {name: self._known_as(x, name) for name, x in named.items()}
        roles = [*zip(self.order, given, strict=False), *((self.roles.get(name), x) for name, x in by_name.items())]
        moved = [x for role, x in roles if role in _STATE_ROLES and _can_be_written(x)]
        before, clocks = [_bits(x) for x in moved], filter(None, (clock_of(x) for x in moved))
        t = dict(roles).get(TIME, next(clocks, 0.0))
        answer = self.function(*given, **by_name)
        for mine, its in zip((*arguments, *named.values()), (*given, *by_name.values()), strict=True):
            if mine is not its:
                self.handed = True
                _copy_into(mine, its)  # which holds the answer of a step that returns nothing
        h, after = dict(roles).get(STEP, 0.0), next((x for x in map(clock_of, (answer, *moved)) if x is not None), t)
        if not goes_on(t, after, h):  # a clock should stand still, or go on by h
            self.clock = self.clock or f"its clock goes from {t:g} to {after:g} in a step of {h:g}"
        parts = [answer, *(answer if isinstance(answer, tuple | list) else ())]
        ends = b"".join(_bits(part) + b"|" for part in parts)
        changed = [new for old, new in zip(before, map(_bits, moved), strict=True) if new != old]
        self.spoilt |= answer is not None and any(new + b"|" not in ends for new in changed)
        self.known = [part for part in (*parts, *moved) if _can_be_written(part)]
        return answer

    def _known_as(self, x: Foreign, place: int | str) -> Foreign:
        if mine := _without_clock(x):
            return next((y for y in self.known if mine.items() <= _without_clock(y).items()), x)
        same = (y for y in self.known if type(y) is type(x) and np.shape(y) == np.shape(x) and _bits(y) == _bits(x))
        return next(same, x) if _can_be_written(x) else x


class _Overwriting(_ReusingAnswers):
    """A stepper that gets the same list or array at every call, with the numbers of that call."""

    def __init__(self, function: Callable[..., Any], convention: CallingConvention) -> None:
        super().__init__(function, convention)
        self.same: dict[tuple[int | str, ...], Foreign] = {}

    def _known_as(self, x: Foreign, place: int | str) -> Foreign:
        if not isinstance(x, np.ndarray | list) or not np.ndim(x):
            return x
        its = self.same.setdefault((place, *np.shape(x)), x)
        its[:] = x
        return its


def _can_be_written(x: Foreign) -> bool:
    return bool(parts_of(x)) or (hasattr(x, "__setitem__") and hasattr(x, "__len__"))


def _without_clock(x: Foreign) -> dict[str, Foreign]:
    """The numbers of a record by name, without its time; empty for anything else, and for arrays in a record."""
    parts = parts_of(x)
    return {} if any(map(np.ndim, parts.values())) else {name: y for name, y in parts.items() if y is not clock_of(x)}


def _copy_into(x: Foreign, other: Foreign) -> None:
    if isinstance(x, dict):
        x.update(other)
    elif parts_of(x):
        with suppress(Exception):  # a record that cannot be changed was not
            x.__dict__.update(vars(other))
    else:
        x[:] = other


def _bits(x: Foreign) -> bytes:
    """The bytes of the numbers in an object, as doubles; empty if it holds no numbers."""
    with suppress(Exception):  # ragged lists, tensors with a gradient, and the like
        return np.asarray(x, dtype=np.float64).tobytes()
    return b""
