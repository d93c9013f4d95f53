"""States to begin at, given by whoever knows where a step may be asked: their parts, and a range of each number."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import accumulate, pairwise
from math import cos, isfinite
from typing import Any

import numpy as np

from driftproof.blackbox.findings import BadInput, Misbehaviour, NothingReturned, UnlikeParts, WrongShape
from driftproof.blackbox.stepper.calling_conventions import (
    ANGULAR,
    FUNCTION,
    MAP,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    CallingConvention,
    reading_of,
    role_of,
    signature_text,
)
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, Foreign, as_array
from driftproof.blackbox.stepper.states.forms_by_values import state_names_of
from driftproof.blackbox.stepper.states.handed_slopes import with_own_slope
from driftproof.blackbox.stepper.states.step_forms import StepForm
from driftproof.blackbox.stepper.trial_steps import format_of_answers

AS_PARTS = "verify --system MODULE:f --start '1,0,0,0; 0.1,0.2,0.3', in Python system=f, domain=Domain(start='...')"
# A number without a range stands for those around it, up to this part of it; a 0, of the smallest other of its part,
# without which it stays 0.
_AROUND = 1 / 8
# So many states are seen, and so many more in the corners of the ranges, a bit within: a step there may lead out.
_STATES, _CORNERS, _WITHIN = 6, 3, 7 / 8
# Bodies in space, or in a plane, are rows of an array.
_ROWS = (3, 2)
# Numbers of which all are shown, such as those of an attitude and its rates; of more a line is hard to read.
_SHOWN = 7
# The first step is so long or, as a table may end nearer, is halved so often.
_LONGEST, _HALVINGS = 0.25, 60


@dataclass(frozen=True)
class Start:
    """The parts of a state, each one number (0) or an array of so many, and the range of each number.

    >>> Start.of("0:1; 2, -4, 0")
    Start(parts=(0, 3), ranges=((0.0, 1.0), (1.75, 2.25), (-4.5, -3.5), (-0.25, 0.25)))
    """

    parts: tuple[int, ...]
    ranges: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, text: str) -> Start:
        """The start in a text: parts between semicolons, numbers between commas. Raises ValueError."""
        parts, ranges = list[int](), list[tuple[float, float]]()
        for part in text.split(";"):
            texts = part.removesuffix(",").split(",")
            found = [_numbers(each) for each in texts]
            least = min((abs(x) for each in found for x in each if x), default=0.0)
            for each, shown in zip(found, texts, strict=True):
                low, high = each[0], each[-1]
                if len(each) == 1:
                    off = _AROUND * (abs(low) or least)
                    low, high = low - off, high + off
                if low > high or (len(each) > 1 and low == high):
                    raise ValueError(f"start: {shown.strip()!r} is no range of a number; write such as -1:1")
                ranges.append((low, high))
            parts.append(len(texts) if "," in part else 0)
        if all(low == high for low, high in ranges):
            raise ValueError(f"start: {text.strip()!r} is one state, which shows little; write such as -1:1")
        return cls(tuple(parts), tuple(ranges))

    @property
    def cuts(self) -> list[tuple[int, int]]:
        """The places among all numbers where each part begins and ends."""
        return [*pairwise(accumulate((max(1, n) for n in self.parts), initial=0))]

    @property
    def rows(self) -> list[int]:
        """How many numbers a row of its parts may have, 0 where these are no rows."""
        return [0, *(n for n in _ROWS if all(part % n == 0 for part in self.parts))]

    @property
    def words(self) -> str:
        """The ranges in words, of many the first."""
        shown = self.ranges if len(self.ranges) <= _SHOWN else self.ranges[:2]
        more = f", ... in {len(self.ranges)} numbers" * (len(shown) < len(self.ranges))
        return ", ".join(f"{low:.6g}" + f":{high:.6g}" * (low < high) for low, high in shown) + more

    @property
    def states(self) -> list[tuple[float, ...]]:
        """States all over the ranges."""
        return [self._at([cos(3 * i + n + 1) for i in range(len(self.ranges))]) for n in range(_STATES)]

    @property
    def corners(self) -> list[tuple[float, ...]]:
        """States near corners of the ranges."""
        signs = ([(-1) ** (i * n // 2 + n) for i in range(len(self.ranges))] for n in range(_CORNERS))
        return [self._at([_WITHIN * sign for sign in each]) for each in signs]

    def _at(self, places: Sequence[float]) -> tuple[float, ...]:
        return tuple((low + high + x * (high - low)) / 2 for x, (low, high) in zip(places, self.ranges, strict=True))

    def _given(self, y: Sequence[float], row: int) -> list[Any]:
        """The parts of a state, in rows of so many numbers, or as they are if it is 0."""
        cut = zip(self.parts, self.cuts, strict=True)
        given: list[Any] = [np.array(y[i:j]) if n else float(y[i]) for n, (i, j) in cut]
        return [part.reshape(-1, row) if row and np.ndim(part) else part for part in given]

    def opened(
        self, step: Callable[..., Any], before: Callable[[str], None], after: Callable[[], None]
    ) -> ForeignStepper:
        """The step, as one of a state that is one array, after a first step. Raises BadInput if it has no answer."""
        why, shaped = "", False
        for row in self.rows:
            given = self._given(self.states[0], row)
            own = with_own_slope(step, (given[0], given[1])) if len(given) == 2 else None
            form = self._form(own or step, {}, row)
            convention = CallingConvention(MAP, (STATE, TIME, STEP) if len(form.parameters) > 2 else (STATE, STEP))
            subject = ForeignStepper(form, convention, ARRAYS, before=before, after=after)
            for i in range(_HALVINGS):
                first = partial(ForeignStepper.step_state, y=self.states[0], h=_LONGEST / 2**i)
                try:
                    subject.begun = first, first(subject)
                except Misbehaviour as error:
                    why, shaped = why or str(error), isinstance(error, WrongShape)
                    continue
                subject.format, subject.log = format_of_answers(subject.log), CallLog()
                return subject
            if shaped:  # its answer, and not what it is given, has another form
                break
        names = state_names_of(step)[0]
        if called := [name for name in names if role_of(name, (FUNCTION,))]:
            raise _other(step, f"{called[0]} would be a function")
        single = f"; if {', '.join(names)} are one number each, part them by semicolons" * (self.parts == (len(names),))
        raise BadInput(f"{signature_text(step)} has no answer at the start: {why}{single}")

    def _speeds(self, names: Sequence[str]) -> tuple[list[int], list[str]]:
        """The places and names of parts that are velocities, by their names, or else each second; none of one part."""
        fast = [bool(role_of(each, (VELOCITY, ANGULAR))) for each in names]
        if len({*fast}) == 1:
            fast = [i % 2 == 1 and len(names) % 2 == 0 for i in range(len(names))]
        found = [(name, cut) for name, cut, of in zip(names, self.cuts, fast, strict=True) if of]
        return [i for _, cut in found for i in range(*cut)], [name for name, _ in found]

    def _form(self, step: Callable[..., Any], others: Mapping[str, float], row: int) -> StepForm:
        """The step(y, h) or step(y, t, h) of one array; what it takes besides is 1, unless among the `others`.

        Its parts are given in rows of so many numbers.
        """
        if hasattr(step, "of_all"):
            raise BadInput("a start has no effect on an object, which begins where it is made")
        names, size, times = state_names_of(step)
        known, beside = names[: len(self.parts)], dict.fromkeys(names[len(self.parts) :], 1.0) | {**others}
        if not size or len(known) < len(self.parts):
            raise _other(step, f"the start has {len(self.parts)}")

        def moved(y: Foreign, t: float, h: float) -> Foreign:
            given = self._given(y, row)
            answer = step(**dict(zip(known, given, strict=True)), **{size: h}, **dict.fromkeys(times, t), **beside)
            if answer is None and not all(self.parts):
                raise NothingReturned("it returns None")
            end = given if answer is None else [*answer] if len(given) > 1 else [answer]
            found = [as_array(part).ravel() for part in end]
            if sum(map(len, found)) == max(1, self.parts[0]) < len(y):  # the others are kept, and not returned
                found = [np.concatenate(found), *(as_array(part).ravel() for part in given[1:])]
            if [len(part) for part in found] != [max(1, n) for n in self.parts]:
                seen = ", ".join(str(len(part)) for part in found)
                unlike = UnlikeParts if sum(map(len, found)) > len(y) else WrongShape  # more, as of rows with masses
                raise unlike(f"it returns parts of {seen} numbers, which are not those of the start")
            return np.concatenate(found)

        later = zip(known[1:], self.parts[1:], self.cuts[1:], strict=True)
        speeds, speed_names = self._speeds(known)
        return StepForm(
            moved if times else lambda y, h: moved(y, 0.0, h),
            reading_of({"the state": known, "the time": times, "the step size": [size]}, step),
            step,
            others=beside,
            of_others=lambda others: self._form(step, others, row),
            in_rows=lambda: [self._form(step, others, other) for other in self.rows if other > row],
            later={name: slice(*cut) if n else cut[0] for name, n, cut in later},
            speeds=speeds,
            speed_names=speed_names,
        )


def _other(step: Callable[..., Any], what: str) -> BadInput:
    """What is said of a step that a start is not for."""
    meant = "a start is for a step that takes a step size and the parts of a state, and keeps its own system"
    return BadInput(f"{meant}; {signature_text(step)}: {what}")


def _numbers(text: str) -> list[float]:
    """The number, or the two ends of a range. Raises ValueError."""
    try:
        found = [float(x) for x in text.split(":")]
        if len(found) <= 2 and all(map(isfinite, found)):
            return found
    except ValueError:
        pass
    raise ValueError(
        f"start: {text.strip()!r} is no number, nor a range such as 280:400; commas part the numbers of an array, "
        "semicolons the parts of a state, as in '1,0,0,0; 0.1,0.2,0.3'"
    )
