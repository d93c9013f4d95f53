"""Steps whose state shows by its values, as plain functions of it: it is what a very short step returns as it was."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.states.array_adapters import Foreign
from driftproof.blackbox.stepper.states.step_forms import StepForm

# Steps so short that nearly nothing moves by more than this, the second where a system is stiff; and one in which the
# system does.
_SHORT, _NEARLY_STILL, _LONG = (2.0**-20, 2.0**-40), 2.0**-10, 0.25
# A step of one number takes no more than so many parameters, and one of an array; of more the names have to tell.
_MOST_BESIDE_ONE, _MOST_BESIDE_AN_ARRAY = 2, 4
# Where arrays may hold cells that move each other, as in a wave, or a vector in space, they have so many.
_CELLS = 3
# Where numbers are taken for none of the state, its vectors may have so many, as those of a matrix that is built in.
_NUMBERS_OF_A_VECTOR = (3, 2)
# An array that is a state may hold so many numbers.
_NUMBERS_OF_AN_ARRAY = (2, 3, 4, 6)
# States in which numbers are sought that a step moves besides, the sign of the position telling them apart; and what of
# their changes is no difference.
_SOMEWHERE, _ELSEWHERE, _ALIKE = (1.0, 0.75), (-0.375, 1.75), 2.0**-16


def further_numbers(
    ends: Callable[[float, float, Mapping[str, float]], Mapping[str, Foreign]], begun: Mapping[str, Foreign]
) -> list[str]:
    """The names of the numbers besides q and v that a step moves on from where they are, and no clock or counter.

    `ends(q, v, given)` are all numbers after a step from there, which begins with some of them as `given`. A clock goes
    on by the same from everywhere; what is made of q and v, as an energy is, forgets where it was.
    """
    found, named = list[str](), dict[str, Foreign]()
    with suppress(Exception, SystemExit):
        named = dict(ends(*_SOMEWHERE, {}))
    others = {name: x + 0.5 for name, end in named.items() if isinstance(x := begun.get(name, end), int | float)}
    moving = {name: x for name, x in others.items() if named[name] != begun.get(name)}
    for name, end in named.items():
        with suppress(Exception, SystemExit):
            x = float(begun.get(name, end))
            starts = ((*_SOMEWHERE, x), (*_SOMEWHERE, x + 0.5), (*_ELSEWHERE, x))
            there = [float(ends(q, v, {name: at})[name]) for q, v, at in starts]
            by, near = np.subtract(there, [at for *_, at in starts]), _ALIKE * max(1.0, *map(abs, there))
            if not np.ptp(by) > near:  # it stays where it is, or goes on as a clock, unless another one moves it
                given = moving if np.abs(by).max() > near else others
                by = np.array([by[0], float(ends(*_ELSEWHERE, {**given, name: x})[name]) - x])
            if abs(there[1] - there[0]) > near and np.ptp(by) > near:
                found.append(name)
    return found


@dataclass(frozen=True)
class Numbers:
    """A step that takes and returns the numbers of its state one by one; these are its first arguments, by `names`.

    They are known not by their names, but because a very short step returns them. What it takes besides, as a rate, is
    in `others`, 1 unless a system is given. A step of one number is tried on each of several. Each may be an array of
    `cells` that move each other. Or the state is one array `whole`, which is complex if y holds it `by_parts`.
    """

    step: Callable[..., Any]
    names: tuple[str, ...]
    others: Mapping[str, float]
    size: str
    times: tuple[str, ...]
    cells: int = 1
    whole: bool = False
    by_parts: bool = False

    @classmethod
    def of(cls, step: Callable[..., Any]) -> Numbers | None:
        """The numbers of a step; None if it is not one of numbers.

        >>> Numbers.of(lambda m, p, dt: (m - dt * p, p + dt * m)).names
        ('m', 'p')
        """
        known, size, times = state_names_of(step)
        if not size:
            return None
        no_state = calling.matrices(known) or calling.launch(known)
        least = 1 if len(known) <= 1 + _MOST_BESIDE_ONE and not no_state else 2
        for cells, h in product((1, *_NUMBERS_OF_A_VECTOR), _SHORT):
            start = 1 / np.arange(2.0, 2 + len(known) * cells).reshape(len(known), cells)
            with suppress(Exception):
                given = start if cells > 1 else start[:, 0].tolist()
                end = np.atleast_1d(np.array(cls(step, known, {}, size, times)._called(given, 0.0, h), float))
                near = np.allclose(end.reshape(-1, cells), start[: len(end)], rtol=0, atol=_NEARLY_STILL)
                if max(least, min(cells, 2)) <= len(end) <= len(start) and end.size == len(end) * cells and near:
                    ones = dict.fromkeys(known[len(end) :], 1.0)
                    found = cls(step, known[: len(end)], ones, size, times, cells)
                    return found._of_cells() if cells == 1 else found
        return None

    def _of_cells(self) -> Numbers:
        """Itself, or with arrays of cells if a change of the first of these is seen in others."""
        with suppress(Exception):
            start = 1 / np.arange(2.0, 2 + len(self.names) * _CELLS).reshape(len(self.names), _CELLS)
            other = start * np.where(np.arange(_CELLS) == 0, 0.5, 1.0)
            ends, others = (np.array(self._called(y, 0.0, _LONG)).reshape(start.shape) for y in (start, other))
            if np.any(ends[:, 1:] != others[:, 1:]):
                return replace(self, cells=_CELLS)
        return self

    def _called(self, y: Foreign, t: float, h: float) -> Foreign:
        beside = {self.size: h} | dict.fromkeys(self.times, t) | {**self.others}
        if not self.whole:
            return self.step(**dict(zip(self.names, y, strict=True)), **beside)
        moved = as_complex(y) if self.by_parts else copy(y)
        answer = self.step(**{self.names[0]: moved}, **beside)
        end = moved if answer is None else answer
        return as_reals(end) if self.by_parts else end

    def _moved(self, y: Sequence[float], t: float, h: float) -> Foreign:
        if self.whole:
            return self._called(y, t, h)
        if self.cells > 1:
            rows: Any = np.reshape(y, (len(self.names), self.cells))
            return np.ravel(self._called(rows, t, h)).astype(float)
        if len(self.names) == 1:
            return np.array([float(self._called([x], t, h)) for x in y])
        return np.array(self._called([*y], t, h), dtype=float)

    @property
    def form(self) -> StepForm:
        """The step(y, h) of an array, with t before h if it takes a time."""
        step = self.step  # which the form itself holds, so that a copy has a copy of it
        moved: Callable[..., Foreign] = lambda y, t, h: replace(self, step=step)._moved(y, t, h)
        read = {"the state": self.names, "the time": self.times, "the step size": [self.size]}
        return StepForm(
            moved if self.times else lambda y, h: moved(y, 0.0, h),
            calling.reading_of(read, self.step),
            self.step,
            self.names if len(self.names) > 1 else [f"{self.names[0]}[{i}]" for i in range(2)],
            self.others,
            of_others=lambda others: replace(self, others=others).form,
            of_size=(lambda size: replace(self, cells=size // len(self.names)).form) if self.cells > 1 else None,
            by_parts=self.by_parts,
        )


def forms_of_an_array(step: Callable[..., Any]) -> Iterator[StepForm]:
    """Yield the step(y, h) of one whose first argument is an array that a very short step leaves nearly as it was.

    What it takes besides, as a control, is 1. Where the array is complex, y holds its real parts, then the others.
    """
    known, size, times = state_names_of(step)
    if not (known and size) or len(known) > 1 + _MOST_BESIDE_AN_ARRAY or calling.matrices(known):
        return
    found = Numbers(step, known[:1], dict.fromkeys(known[1:], 1.0), size, times, whole=True)
    for count, h in product(_NUMBERS_OF_AN_ARRAY, _SHORT):
        with suppress(Exception):
            start = np.array([1 / (i + 2) for i in range(count)])
            near, far = (found._called(start, 0.0, each) for each in (h, _LONG))
            if np.shape(near) == start.shape and np.allclose(near, start, 0, _NEARLY_STILL) and np.any(far != start):
                yield replace(found, by_parts=bool(np.iscomplexobj(far) and np.imag(far).any())).form
                return


def as_complex(y: Foreign) -> Foreign:
    """The complex numbers with these real parts, and then these imaginary parts."""
    real, imaginary = np.split(np.asarray(y, float), 2)
    return real + 1j * imaginary


def as_reals(z: Foreign) -> Foreign:
    """The real parts of complex numbers, and then the imaginary parts."""
    return np.concatenate([np.real(z), np.imag(z)])


def form_of_more_numbers(step: Callable[..., Any], found: calling.CallingConvention) -> StepForm | None:
    """The form of a step that returns, by their values, more of its arguments than those that names make its state.

    Only a step that takes something besides a state is tried, as a copy, so that a step does not notice it.
    """
    doubtful = found.kind in (calling.MAGNETIC, calling.ROTATION) or (found.kind == calling.MAP and found.extra)
    if not doubtful or (own := fresh_copy(step)) is None or (numbers := Numbers.of(own)) is None:
        return None
    roles = (calling.POSITION, calling.VELOCITY, calling.STATE)
    states = {name for role, name in found.named(step) if role in roles}
    return replace(numbers, step=step).form if states < {*numbers.names} else None


def state_names_of(step: Callable[..., Any]) -> tuple[tuple[str, ...], str, tuple[str, ...]]:
    """The names of a step's arguments besides the step size and the times, then these; T beside dt is a state."""
    names = calling.names_with_step(step) or []
    times = tuple(each for each in names if each != "T" and calling.role_of(each, (calling.TIME,)))
    size = calling.size_name(names)
    return tuple(each for each in names if each not in (size, *times)), size, times
