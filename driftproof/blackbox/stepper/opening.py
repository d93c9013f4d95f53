"""Opening a stepper: detect its calling convention, find the numbers it takes, and see its precision."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, product
from typing import Any

import numpy as np

from driftproof.blackbox import findings
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper import wrappers
from driftproof.blackbox.stepper.array_adapters import (
    ARRAYS,
    LISTS,
    SCALARS,
    ArrayAdapter,
    adapters_of,
    as_array,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.forms_by_values import form_of_more_numbers
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.handed_slopes import with_slopes_kept
from driftproof.blackbox.stepper.made_wrappers import scope_of
from driftproof.blackbox.stepper.named_forms import named_forms
from driftproof.blackbox.stepper.plain_forms import plain_forms
from driftproof.blackbox.stepper.records import record_forms
from driftproof.blackbox.stepper.second_functions import with_own_jacobian, zeros
from driftproof.blackbox.stepper.starts import AS_PARTS, Start
from driftproof.blackbox.stepper.state_forms import SYSTEMS, forms_of
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
from driftproof.support.environment import imported_object

# A short step where y' = 1 goes this many times as far as h at most, or the part of it at least.
_WITHIN = 8
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
    own = with_own_jacobian(step) if calls == calling.FIELD else step
    given, step, failures = step, with_slopes_kept(own), list[findings.Misbehaviour]()

    def first_of(attempts: Iterable[Callable[[], ForeignStepper]]) -> ForeignStepper | None:
        for attempt in attempts:
            try:
                return attempt()
            except (findings.OwnClock, findings.ArgumentsExchanged):
                raise
            except findings.Misbehaviour as failure:
                failures.append(failure)
            except findings.BadInput as refused:  # of a form, which another one may fit
                failures.append(findings.WrongShape(str(refused)))
        return None

    def as_plain() -> ForeignStepper | None:
        forms = chain(plain_forms(step), record_forms(step)) if calls is None else ()
        return first_of(partial(opened, form, None, array, before, after) for form in forms)

    def as_named() -> ForeignStepper | None:
        return first_of(partial(_read_by_values, form, calls, array, before, after) for form in named_forms(step))

    try:
        conventions = calling.conventions_of(step, calls)
    except ValueError as error:
        if found := as_plain() or as_named():
            return found
        if stale := [failure for failure in failures if isinstance(failure, findings.StaleSlope)]:
            raise stale[0] from None
        line = _tried_out(wrappers.wrapper_line(given, keeps), given)
        if calls is not None:
            raise findings.BadInput(f"{error}{line * line.startswith(':')}") from None
        raise findings.BadInput(f"{_unfitting(given)}{line or wrappers.template(given)}") from None
    if calling.MASSES[-1] in (calling.required_names(step) or ()) and (found := as_plain()):
        return found  # with unequal masses, before one of all
    made = partial(ForeignStepper, step, before=before, after=after, pristine=fresh_copy(step))
    trials = (
        partial(tried, made(convention, adapter, single=trial in (one_number_step, ONE_WITH_DERIVATIVE)), trial)
        for convention in conventions
        for adapters in _adapters(step, convention, array)
        for trial, adapter in product(TRIALS.get(convention.kind, (one_step,)), adapters)
    )
    found = first_of(trials)
    doubtful = calls in (None, calling.MAP) and array is None
    doubtful &= not found or found.convention.kind == calling.MAP
    if doubtful and (form := form_of_more_numbers(step, conventions[0])):
        return opened(form, None, None, before, after)
    if found and not _stands_still(found):
        alone = (
            found.convention.run if found.single else {*found.convention.extra} & {*calling.MASSES} and drifts(found)
        )
        return (as_plain() if alone else None) or found  # of n numbers, or of bodies that attract each other
    # Of three numbers, or of a grid.
    lacking = (
        found
        or isinstance(failures[0], findings.WrongShape)
        or isinstance(failures[0].__cause__, ValueError | IndexError)
    )
    states = (each for each in conventions if lacking and each.kind == calling.MAP and calling.STATE in each.order)
    systems = first_of(partial(tried, made(*each), one_step) for each in product(states, SYSTEMS))
    if systems and systems.adapter is SYSTEMS[0] and _moves_one(systems):  # as the cell between those at the borders
        systems = first_of([partial(tried, made(systems.convention, SYSTEMS[1]), one_step)]) or systems
    if found := systems if systems and not _stands_still(systems) else found:
        return found
    line = _tried_out(wrappers.wrapper_line(step, keeps), step) if inspect.isclass(step) else ""
    if inspect.isclass(step) and isinstance(failures[0], findings.NotANumber):  # its call makes an object
        line = line or wrappers.template(given)
    if line:
        raise findings.BadInput(f"{_unfitting(given)}{line}")
    if not any(isinstance(failure, findings.StaleSlope) for failure in failures) and (found := as_plain()):
        return found
    why = next((failure for failure in failures if isinstance(failure, findings.StaleSlope)), failures[0])
    asked = why.__cause__
    if isinstance(asked, findings.BadInput):
        raise asked
    if isinstance(asked, AttributeError) and isinstance(asked.obj, np.ndarray | list | tuple | float):
        theirs = f"asks what it is given for .{asked.name}, and what else that holds is not known; write"
        raise findings.BadInput(f"{calling.signature_text(given)} {theirs}{wrappers.OWN_STEP} that makes it") from asked
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
    """True if the state of a built-in system is where it was after its first step, as both ends of a grid are."""
    given = subject.convention
    still = subject.begun is not None and np.array_equal(subject.begun[1], TRIAL_STATE)
    return still and given.kind == calling.MAP and calling.STATE in given.order


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
        state = TRIAL_STATE[: 2 - subject.single] if kind == calling.FIELD else TRIAL_STATE[1:]
        steps = LONGER if subject.convention.run else 1
        subject = replace(subject, convention=subject.convention.of_steps(steps))
        with suppress(findings.UnsupportedCall):  # which the trial steps have not moved
            subject = subject.fresh(steps)
        if kind == calling.FIELD:
            ends = [subject.step_field(rate, 1.0, state, TINY) for rate in (lambda t, y: [1.0 for _ in y], zeros)]
        elif kind == calling.FORCE:
            ends = [
                [*subject.step_with(push, *TRIAL_STATE, TINY)] for push in (lambda q: 1.0 + 0.0 * q, lambda q: 0.0 * q)
            ]
        else:
            return line
    except (findings.StaleSlope, findings.OwnClock, findings.Exchanged, findings.Increment):
        return line
    except Exception as failure:
        if isinstance(failure, NameError) or "NameError" in str(failure):
            return line
        seen = " ".join(str((isinstance(failure, findings.BadInput) and failure.__cause__) or failure).split())
    else:
        end = ends[0][-len(state) :]
        moved = [abs(x - y) / TINY / steps for x, y in zip(end, state, strict=True)]
        # A step that stays where nothing moves, and is moved, is called as it should be, whatever its faults.
        called = np.allclose(ends[1][-len(state) :], state, rtol=0, atol=NEAR) and ends[0] != ends[1]
        if max(moved) < _WITHIN and (called or min(moved) > 1 / _WITHIN):
            return line
        seen = f"a step of {TINY:g} where y' = 1 goes from {list(state)} to {list(end)}"
    return f"{wrappers.OWN_STEP} that calls it; tried: {text}: {seen}"


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
class Target:
    """The stepper to examine, a callable or `package.module:name`, and its convention and array maker where needed.

    Where `keeps`, a wrapper in a message replaces nothing of its system. Where `anew`, a copy of an
    object makes each step. A `start` says which states it takes.
    """

    step: Callable[..., Any] | str
    calls: str | None = None
    array: Callable[[Any], Any] | str | None = None
    keeps: bool = False
    anew: bool = False
    start: Start | None = None

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
        """True if another interpreter can import the stepper and its array maker."""
        return isinstance(self.step, str) and not callable(self.array)

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
            line = f"; if these are its state, say so: {AS_PARTS}" * isinstance(unread, findings.UnlikeParts)
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
