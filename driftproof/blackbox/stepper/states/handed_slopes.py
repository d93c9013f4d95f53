"""Steps that are handed earlier slopes, step(f, t, y, h, f_prev), or that of their start, step(q, v, a, h)."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from typing import Any

import numpy as np

from driftproof.blackbox.findings import StaleSlope
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.states.array_adapters import Foreign

# Names for the slope of the step before; with a number, for the slope that many steps before.
_PREVIOUS = re.compile(
    r"(f|fn|fy|rhs|slope|dydt|dydx|k)_?(prev|previous|old|last|before|nm|n_minus|minus|m)_?(\d*)"
    r"|(prev|previous|old|last)_(f|rhs|slope|dydt|k)(\d*)"
)
# How many slopes are kept.
_AT_FIRST = 8
# Slopes with a smaller relative difference count as the same.
_ALIKE = 2.0**-20
# The shapes of arrays in which the places of bodies may stand: each in a row, in space or in a plane, or on a line.
_SHAPES = (3, 3), (3, 2), (2,)


class _Decisions(dict[str, bool]):
    """What the first step showed of a stepper's answers, shared by all copies of the stepper."""

    def __deepcopy__(self, memo: dict[int, Any]) -> _Decisions:
        return self


class HandedSlopes:
    """The step without its arguments for earlier slopes, which are kept here.

    It keeps the slope at the start of each step, or what the step hands on: f1 of (y1, f1) or (q1, v1, f1). If f1 is
    the slope at the end of its step, each step is given the slope at its own start instead, and nothing is remembered.
    The first steps are given f at the first state for all earlier slopes: the stepper has no start of its own.
    """

    def __init__(self, step: Callable[..., Any], names: Sequence[str], slots: Sequence[str]) -> None:
        """Take the names of all arguments in order, and of those for earlier slopes."""
        self.step, self.slots = step, slots
        self.kept: Any = []
        self.returned = _Decisions()
        self.rest = [name for name in names if name not in slots]
        roles = (*calling.STANDARD_ORDER[calling.FIELD], calling.POSITION, calling.VELOCITY)
        self.roles = {role: next((x for x in self.rest if calling.role_of(x, (role,))), "") for role in roles}
        self.of_force = bool(self.roles[calling.POSITION] and self.roles[calling.VELOCITY])
        if self.of_force:
            self.roles[calling.STATE] = self.roles[calling.POSITION]
        calling.stand_in(self, step, self.rest)

    def __call__(self, *arguments: Foreign, **named: Foreign) -> Foreign:
        """Make one step, and keep the slope at its start or what the step hands on."""
        given = {**dict(zip(self.rest, arguments, strict=False)), **named}
        slope = self._slope(given)
        for back, name in enumerate(self.slots, 1):
            given[name] = self.kept[-back] if back <= len(self.kept) else slope
        answer = self.step(**given)
        if self._hands_on(answer, slope):
            answer, end = answer[:-1], answer[-1]
            if "of end" not in self.returned:
                state = answer[0 if self.of_force else -1]
                at_end = self._slope({**given, self.roles[calling.STATE]: state}, given[self.roles[calling.STEP]])
                of_end = np.allclose(end, at_end, _ALIKE) and not np.allclose(end, slope, _ALIKE)
                self.returned["of end"] = of_end
            slope = end
        if self.returned.get("of end"):
            return answer
        self.kept = [*self.kept, np.copy(slope) if isinstance(slope, np.ndarray) else slope][-_AT_FIRST:]
        return answer

    def _hands_on(self, answer: Foreign, slope: Foreign) -> bool:
        """True if the answer ends with a slope: at the first step, it is closer to the slope at the start than to 0.

        An error estimate is closer to 0, and so is another result, on a short step of the oscillator or of y' = -y.
        """
        parts = len(answer) if isinstance(answer, tuple) else 0
        if parts < 2 + self.of_force or np.shape(answer[-1]) != np.shape(slope):
            return False
        if "slope" not in self.returned and np.any(slope):
            end, start = (np.array(x, float) for x in (answer[-1], slope))
            self.returned["slope"] = bool(np.linalg.norm(end - start) < np.linalg.norm(end))
        return self.returned.get("slope", True)

    def _slope(self, given: Mapping[str, Foreign], later: Any = 0.0) -> Foreign:
        """f at the given state, `later` after the start of the step, called with t and y in the step's own order."""
        f, state, time = (given.get(self.roles[role]) for role in (calling.FUNCTION, calling.STATE, calling.TIME))
        assert f is not None
        if time is None:
            return f(state)
        order = [self.rest.index(self.roles[role]) for role in (calling.TIME, calling.STATE)]
        return f(time + later, state) if order[0] < order[1] else f(state, time + later)


def with_slopes_kept(step: Callable[..., Any]) -> Callable[..., Any]:
    """The step as one that remembers its earlier slopes, if its parameters include any; otherwise the step itself.

    >>> def step(f, t, y, h, f_prev):
    ...     return y + h * (1.5 * f(t, y) - 0.5 * f_prev)
    >>> kept = with_slopes_kept(step)
    >>> kept(lambda t, y: t, 0.0, 0.0, 1.0), kept(lambda t, y: t, 1.0, 0.0, 1.0)
    (0.0, 1.5)
    """
    names = list(calling.parameters_of(step) or {})
    words = {name: calling.word_of(name) for name in names}
    slots = [name for name in names if _PREVIOUS.fullmatch(words[name])]
    slots.sort(key=lambda name: int(re.sub(r"\D", "", words[name]) or 1))
    return HandedSlopes(step, calling.required_names(step) or (), slots) if slots else step


def with_own_slope(step: Callable[..., Any], start: tuple[Foreign, Foreign] | None = None) -> Callable[..., Any] | None:
    """The step(q, v, h) of a step(q, v, a, h) on a system that is built in, whose slope a step of 0 hands on.

    It is tried from a start (q, v), or else with numbers and with arrays of bodies. None unless it hands on the slope
    of the state at its end, as a step of 0 from there does, whatever it is given. Raises StaleSlope if the slope that
    it hands on is that of where it began.
    """
    wanted, found = {calling.POSITION, calling.VELOCITY, calling.CARRIED, calling.STEP}, list[Any]()
    with suppress(ValueError):  # it has no system built in
        found += (each for each in calling.conventions_of(step, calling.MAP) if {*each.order} == wanted)
    if not found or found[0].handed is None:
        return None
    named, handed = found[0].named(step), found[0].handed

    def parts(q: Foreign, v: Foreign, a: Foreign, h: Foreign) -> tuple[Any, list[Any]]:
        given = {calling.POSITION: q, calling.VELOCITY: v, calling.CARRIED: a, calling.STEP: h}
        answer = [*step(**{name: deepcopy(given[role]) for role, name in named}, **found[0].extra)]
        return answer.pop(handed), answer

    def begun(q: Foreign, v: Foreign, h: Foreign) -> tuple[Any, ...]:
        slope, _ = parts(q, v, 0.0 * q, 0.0)
        return tuple(parts(q, v, slope, h)[1])

    for q, v in [start] if start else [(1.0, 0.75), *map(_places, _SHAPES)]:
        with suppress(Exception):  # a user's function may raise anything
            here, again = (parts(q, v, other + 0.0 * q, 0.0)[0] for other in (0.0, 1.0))
            slope, end = parts(q, v, here, 0.25)
            there, kept = parts(end[0], end[1], 0.0 * q, 0.0)[0], parts(q, v, here + 1.0, 0.25)[0]
            if np.shape(end[0]) != np.shape(q):  # it makes more of a number, as by masses of several bodies
                continue
            if np.array_equal(here, again) and np.any(here != there):
                if np.allclose(slope, there, _ALIKE, 0):
                    return begun
                stale = "where its step began" if np.allclose(slope, here, _ALIKE, 0) else "another state"
                break
            if np.array_equal(kept, here + 1.0):
                stale = "the start of its step, which it was given"
                break
    else:
        return None
    raise StaleSlope(f"the slope that it hands on as that at its end is that of {stale}")


def _places(shape: tuple[int, ...]) -> tuple[Foreign, Foreign]:
    """Positions and velocities of several bodies."""
    q, v = np.cos(np.arange(2.0 * np.prod(shape))).reshape(2, *shape)
    return q, v
