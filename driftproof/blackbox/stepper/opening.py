"""Opening a stepper: detect its calling convention, find the numbers it takes, and see its precision."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import chain, product
from typing import Any

import numpy as np

from driftproof.blackbox import findings
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.second_functions import with_own_jacobian, zeros
from driftproof.blackbox.stepper.starts import AS_PARTS, Start
from driftproof.blackbox.stepper.states.array_adapters import (
    ARRAYS,
    LISTS,
    SCALARS,
    ArrayAdapter,
    adapters_of,
    as_array,
)
from driftproof.blackbox.stepper.states.forms_by_values import form_of_more_numbers, state_names_of
from driftproof.blackbox.stepper.states.handed_slopes import with_own_slope, with_slopes_kept
from driftproof.blackbox.stepper.states.plain_forms import plain_forms
from driftproof.blackbox.stepper.states.records import record_forms
from driftproof.blackbox.stepper.states.state_forms import SYSTEMS, forms_of
from driftproof.blackbox.stepper.trial_steps import (
    LONGER,
    NEAR,
    ONE_WITH_DERIVATIVE,
    TINY,
    TRIAL_STATE,
    TRIAL_STEP,
    TRIALS,
    one_number_step,
    one_step,
    tried,
)
from driftproof.blackbox.stepper.wrappers import wrappers
from driftproof.blackbox.stepper.wrappers.made_wrappers import scope_of
from driftproof.blackbox.stepper.wrappers.named_forms import named_forms
from driftproof.support.environment import imported_object

# A short step where y' = 1 goes this many times as far as h at most, or the part of it at least.
_WITHIN = 8
_PARTS = (calling.POSITION, calling.VELOCITY, calling.QUATERNION, calling.ANGULAR)  # of a state of bodies
# The arguments of a wrapper that is a function, and names in it.
_HEAD, _WORD = re.compile(r"def wrapped\((.*?)\): "), re.compile(r"[A-Za-z_]\w*")


def opened(
    step: Callable[..., Any],
    calls: str | None = None,
    array: Callable[[Any], Any] | None = None,
    before: Callable[[str], None] = lambda call: None,
    after: Callable[[], None] = lambda: None,
    keeps: bool = False,
) -> ForeignStepper:
    """Open the stepper: return it as a `ForeignStepper`, with the first adapter in which it answers.

    `array` makes the stepper's own numbers from a list of floats (torch.tensor, ...) or from one float (numpy.float32).
    `before` receives each call as text before it is made; `after` is called when it is over. Where `keeps`, a
    wrapper in a message keeps the system that is built in. Raises ValueError if no
    calling convention fits, and OwnClock. If no adapter gets an answer, raises StaleSlope if there was one, else the
    `Misbehaviour` of the most natural adapter.
    """
    return _Opening(step, calls, array, before, after, keeps).subject()


@dataclass
class _Opening:
    """The readings of one stepper, tried from the most natural one on, and why each that failed did."""

    given: Callable[..., Any]
    calls: str | None
    array: Callable[[Any], Any] | None
    before: Callable[[str], None]
    after: Callable[[], None]
    keeps: bool
    failures: list[findings.Misbehaviour] = field(default_factory=list)

    @cached_property
    def step(self) -> Callable[..., Any]:
        """The stepper itself, given the slopes and the Jacobian that it asks for."""
        own = with_own_jacobian(self.given) if self.calls == calling.FIELD else self.given
        return with_slopes_kept(own)

    def subject(self) -> ForeignStepper:
        """The stepper as the first reading has it in which it answers and moves its state."""
        try:
            conventions = calling.conventions_of(self.step, self.calls)
        except ValueError as error:
            return self._without_convention(error)
        if calling.MASSES[-1] in (calling.required_names(self.step) or ()) and (found := self._as_plain()):
            return found  # with unequal masses, before one of all
        found = self._first_of(self._trials(conventions))
        doubtful = self.calls in (None, calling.MAP) and self.array is None
        doubtful &= not found or found.convention.kind == calling.MAP
        if doubtful and (form := form_of_more_numbers(self.step, conventions[0])):
            return opened(form, None, None, self.before, self.after)
        if found and not _stands_still(found):
            return (self._as_plain() if _of_many(found) else None) or found
        if system := self._as_system(conventions, found):
            return system
        if inspect.isclass(self.step):
            self._refuse_class()
        return found or self._last_resort()

    def _first_of(self, attempts: Iterable[Callable[[], ForeignStepper]]) -> ForeignStepper | None:
        """What the first attempt gives that does not fail."""
        for attempt in attempts:
            try:
                return attempt()
            except (findings.OwnClock, findings.ArgumentsExchanged):
                raise
            except findings.Misbehaviour as failure:
                self.failures.append(failure)
            except findings.BadInput as refused:  # of a form, which another one may fit
                self.failures.append(findings.WrongShape(str(refused)))
        return None

    def _made(self, convention: calling.CallingConvention, adapter: ArrayAdapter, **more: Any) -> ForeignStepper:
        return ForeignStepper(
            self.step, convention, adapter, before=self.before, after=self.after, pristine=self._pristine, **more
        )

    @cached_property
    def _pristine(self) -> Any:
        return fresh_copy(self.step)

    def _trials(self, conventions: Iterable[calling.CallingConvention]) -> Iterator[Callable[[], ForeignStepper]]:
        """The stepper in each convention and with each form of a state, tried by a step."""
        for convention in conventions:
            for adapters in _adapters(self.step, convention, self.array):
                for trial, adapter in product(TRIALS.get(convention.kind, (one_step,)), adapters):
                    single = trial in (one_number_step, ONE_WITH_DERIVATIVE)
                    yield partial(tried, self._made(convention, adapter, single=single), trial)

    def _as_plain(self) -> ForeignStepper | None:
        """The stepper as a form of numbers one by one, of lists or of records, if nothing says how it is called."""
        forms = chain(plain_forms(self.step), record_forms(self.step)) if self.calls is None else ()
        return self._first_of(partial(opened, form, None, self.array, self.before, self.after) for form in forms)

    def _as_named(self) -> ForeignStepper | None:
        """The stepper with one name of its own, which its values must bear out."""
        options = self.calls, self.array, self.before, self.after
        return self._first_of(partial(_read_by_values, form, *options) for form in named_forms(self.step))

    def _without_convention(self, error: ValueError) -> ForeignStepper:
        """The stepper whose names fit no calling convention; raises what is to be written where no form fits."""
        if found := self._as_plain() or self._as_named():
            return found
        for stale in self._stale:
            raise stale from None
        roles = {calling.role_of(name, _PARTS) for name in state_names_of(self.given)[0]}
        if len(roles) > 2 and self.calls is None and None not in roles:
            its_state = f"if {', '.join(state_names_of(self.given)[0])} are its state, say so: {AS_PARTS}"
            raise findings.BadInput(f"{calling.signature_text(self.given)}: {its_state}")
        line = _tried_out(wrappers.wrapper_line(self.given, self.keeps), self.given)
        if self.calls is not None:
            raise findings.BadInput(f"{error}{line * line.startswith(':')}") from None
        raise findings.BadInput(f"{_unfitting(self.given)}{line or wrappers.template(self.given)}") from None

    @property
    def _stale(self) -> list[findings.Misbehaviour]:
        return [failure for failure in self.failures if isinstance(failure, findings.StaleSlope)]

    def _as_system(
        self, conventions: Iterable[calling.CallingConvention], found: ForeignStepper | None
    ) -> ForeignStepper | None:
        """The stepper of three numbers, or of a grid, whose system is built in, if two numbers do not move or fit."""
        first = self.failures[0] if self.failures else None
        lacking = found or isinstance(first, findings.WrongShape)
        if not lacking and not isinstance(first and first.__cause__, ValueError | IndexError):
            return None
        states = (each for each in conventions if each.kind == calling.MAP and calling.STATE in each.order)
        read = self._first_of(partial(tried, self._made(*each), one_step) for each in product(states, SYSTEMS))
        if read and read.adapter is SYSTEMS[0] and _moves_one(read):  # as the cell between those at the borders
            read = self._first_of([partial(tried, self._made(read.convention, SYSTEMS[1]), one_step)]) or read
        return read if read and not _stands_still(read) else None

    def _refuse_class(self) -> None:
        """Raises BadInput with the wrapper that a class needs, if one is known."""
        line = _tried_out(wrappers.wrapper_line(self.step, self.keeps), self.step)
        line = line or _tried_out(wrappers.built_in_wrapper(self.step), self.step)
        if not self.failures or isinstance(self.failures[0], findings.NotANumber):  # its call makes an object
            line = line or wrappers.template(self.given)
        if line:
            raise findings.BadInput(f"{_unfitting(self.given)}{line}")

    def _last_resort(self) -> ForeignStepper:
        """The stepper as a plain form, unless a slope was stale; raises why its most natural reading failed."""
        if not self._stale and (found := self._as_plain()):
            return found
        if self.calls in (None, calling.MAP) and (form := with_own_slope(self.step)):
            return opened(form, None, self.array, self.before, self.after)
        why = [*self._stale, *self.failures][0]
        asked = why.__cause__
        if isinstance(asked, findings.BadInput):
            raise asked
        if isinstance(asked, AttributeError) and isinstance(asked.obj, np.ndarray | list | tuple | float):
            theirs = f"asks what it is given for .{asked.name}, and what else that holds is not known; write"
            made = f"{calling.signature_text(self.given)} {theirs}{wrappers.OWN_STEP} that makes it"
            raise findings.BadInput(made) from asked
        raise why


def _read_by_values(form: Callable[..., Any], *options: Any) -> ForeignStepper:
    """The subject of a form whose names are a guess: a step moves its state, and a short one leaves it where it is."""
    found = opened(form, *options)
    for trial in TRIALS.get(found.convention.kind, (one_step,)):
        with suppress(findings.Misbehaviour):
            far, end = (trial(found, h) for h in (TRIAL_STEP, TINY**2))
            start = TRIAL_STATE[: len(end)]
            if not np.array_equal(far, start) and np.allclose(end, start, rtol=0, atol=NEAR):
                return found
    raise findings.WrongShape("a short step does not leave its state where it is, or no step moves it")


def _stands_still(subject: ForeignStepper) -> bool:
    """True if the state of a class, or of a built-in system as at the ends of a grid, is where it was after a step."""
    given = subject.convention
    still = subject.begun is not None and np.array_equal(subject.begun[1], TRIAL_STATE[: len(subject.begun[1])])
    return still and (inspect.isclass(subject.function) or (given.kind == calling.MAP and calling.STATE in given.order))


def _of_many(subject: ForeignStepper) -> bool:
    """True if it may be a step of n numbers, read by one, or of bodies that attract each other, read as one body."""
    convention = subject.convention
    return convention.run if subject.single else bool({*convention.extra} & {*calling.MASSES}) and drifts(subject)


def _moves_one(subject: ForeignStepper) -> bool:
    """True if a step of a built-in system moves one of its numbers alone."""
    start = as_array(subject.adapter.write(TRIAL_STATE)).tolist()
    return int(np.count_nonzero(np.subtract(subject.step_state(start, TRIAL_STEP), start))) == 1


def drifts(subject: ForeignStepper) -> bool:
    """True if no force acts in the system that is built in, as on one body where bodies attract each other."""
    (q, v), end = TRIAL_STATE, subject.begun and subject.begun[1]
    return subject.convention.kind == calling.MAP and np.array_equal(end or (), (q + TRIAL_STEP * v, v))


def _tried_out(line: str, step: Callable[..., Any]) -> str:
    """The wrapper, if it makes a short step of y' = 1 or q'' = 1 when it is pasted after the code; else what it lacks.

    One that leaves something to write cannot be tried. What is wrong with the code itself is told when it is pasted.
    """
    text, _, said = line.removeprefix(": ").partition("  # ")
    if "wrapped" not in text:
        return line
    if "built in" in said:
        return f"{wrappers.OWN_STEP}: {said}"
    head = _HEAD.match(text)
    if head and {"y", "q", "v"} & {*head[1].split(", ")} - {*_WORD.findall(text, head.end())}:
        return f"{wrappers.OWN_STEP} that calls it with its state"
    try:
        exec(compile(text, "<wrapper>", "exec"), known := scope_of(step))
        kind = calling.conventions_of(known["wrapped"])[0].kind
        subject = opened(known["wrapped"], kind)
        seen = _misled(subject) if kind in (calling.FIELD, calling.FORCE) else ""
    except (findings.StaleSlope, findings.OwnClock, findings.Exchanged, findings.Increment):
        return line
    except Exception as failure:
        if isinstance(failure, NameError) or "NameError" in str(failure):
            return line
        seen = " ".join(str((isinstance(failure, findings.BadInput) and failure.__cause__) or failure).split())
    return f"{wrappers.OWN_STEP} that calls it; tried: {text}: {seen}" if seen else line


def _misled(subject: ForeignStepper) -> str:
    """What a short step of y' = 1 or q'' = 1 does that no step does which is called as it should be; "" if nothing."""
    steps = LONGER if subject.convention.run else 1
    subject = replace(subject, convention=subject.convention.of_steps(steps))
    with suppress(findings.UnsupportedCall):  # which the trial steps have not moved
        subject = subject.fresh(steps)
    if subject.convention.kind == calling.FIELD:
        start = TRIAL_STATE[: 2 - subject.single]
        end, still = (subject.step_field(rate, 1.0, start, TINY) for rate in (lambda t, y: [1.0 for _ in y], zeros))
    else:
        pushes = (lambda q: 1.0 + 0.0 * q, lambda q: 0.0 * q)
        start, (end, still) = TRIAL_STATE[1:], ([*subject.step_with(push, *TRIAL_STATE, TINY)] for push in pushes)
    speeds = [abs(x - y) / TINY / steps for x, y in zip(end[-len(start) :], start, strict=True)]
    # A step that stays where nothing moves, and is moved, is called as it should be, whatever its faults.
    called = np.allclose(still[-len(start) :], start, rtol=0, atol=NEAR) and end != still
    if max(speeds) < _WITHIN and (called or min(speeds) > 1 / _WITHIN):
        return ""
    return f"a step of {TINY:g} where y' = 1 goes from {list(start)} to {list(end[-len(start) :])}"


def _unfitting(step: Callable[..., Any]) -> str:
    """The refusal that stands before a wrapper; it is short, because a summary of tests cuts the line."""
    return f"{calling.signature_text(step)} does not fit any calling convention of `driftproof verify --help`; write"


def _adapters(
    step: Callable[..., Any], convention: calling.CallingConvention, array: Callable[[Any], Any] | None
) -> Iterator[Iterable[ArrayAdapter]]:
    """Yield the usual adapters; then, to be tried if none of them gets an answer, other forms of a state."""
    if array is not None:
        yield adapters_of(array)
        return
    vectors = convention.kind in TRIALS or (convention.kind == calling.MAP and calling.STATE in convention.order)
    yield (ARRAYS, LISTS, SCALARS) if vectors else (SCALARS, ARRAYS)
    yield list(forms_of(step, convention))


@dataclass(frozen=True)
class NamedCode:
    """Code to examine, a callable or `package.module:name`."""

    step: Callable[..., Any] | str

    @property
    def name(self) -> str:
        """The name that reports use."""
        if isinstance(self.step, str):
            return self.step
        module = getattr(self.step, "__module__", None)
        name: str = getattr(self.step, "__qualname__", type(self.step).__name__)
        return f"{module}:{name}" if module else name

    @property
    def by_name(self) -> bool:
        """True if another interpreter can import all of it."""
        return isinstance(self.step, str)


@dataclass(frozen=True)
class Target(NamedCode):
    """The stepper to examine, and its convention and array maker where needed.

    Where `keeps`, a wrapper in a message replaces nothing of its system. Where `anew`, a copy of an
    object makes each step. A `start` says which states it takes.
    """

    calls: str | None = None
    array: Callable[[Any], Any] | str | None = None
    keeps: bool = False
    anew: bool = False
    start: Start | None = None

    @property
    def by_name(self) -> bool:
        """True if another interpreter can import the stepper and its array maker."""
        return super().by_name and not callable(self.array)

    def open(
        self, before: Callable[[str], None] = lambda call: None, after: Callable[[], None] = lambda: None
    ) -> ForeignStepper:
        """Open the stepper, or a method of a copy of its object. Raises ValueError or a `Misbehaviour`.

        An answer that is there, but not understood, is no fault of the stepper, and raises BadInput.
        """
        array, step = None if self.array is None else imported(self.array), imported(self.step)
        if self.start:
            return self.start.opened(step, before, after)
        own = fresh_copy(step) if inspect.ismethod(step) else None
        try:
            subject = opened(own or step, self.calls, array, before, after, self.keeps)
            return subject.with_copies() if self.anew and own else subject
        except (findings.NothingReturned, findings.AskedAtNoState, findings.WrongAnswer):
            raise
        except (findings.WrongShape, findings.NotANumber) as unread:
            bodies = isinstance(unread, findings.UnlikeParts) or with_own_slope(step)  # of several, by its arrays
            line = f"; if these are its state, say so: {AS_PARTS}" if bodies else ""
            with suppress(ValueError):  # a form that is no convention by itself has no wrapper of a line
                convention = calling.conventions_of(step, self.calls)[0]
                line = line or wrappers.answer_wrapper(ForeignStepper(step, convention, ARRAYS))
            raise findings.BadInput(f"{calling.signature_text(step)} cannot be read: {unread}{line}") from unread


def imported(named: Callable[..., Any] | str, what: str = "stepper") -> Callable[..., Any]:
    """The callable that `package.module:name` names, also found from the current directory; a callable as it is.

    Raises ValueError, with a message of one line, for a text of another form and for what cannot be imported or called.
    """
    if not isinstance(named, str):
        return _callable(named, "what was given", what)
    try:
        found = imported_object(named, what)
    except ValueError as error:
        raise findings.BadInput(str(error)) from error.__cause__
    return _callable(found, named, what)


def _callable(found: Any, named: str, what: str) -> Callable[..., Any]:
    """The callable that was found; raises BadInput for anything else, with a wrapper if an object has a step."""
    if not callable(found):
        shown = "None" if found is None else f"{type(found).__name__}, which cannot be called"
        raise findings.BadInput(f"{named} is {shown}{wrappers.uncalled(found) if what == 'stepper' else ''}")
    function: Callable[..., Any] = found
    return function
