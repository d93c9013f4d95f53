"""What a code does to each state that it leaves: numbers are held at a limit or in a box, parts have the length 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.systems.whole_states import ROUGH
from driftproof.blackbox.matching.tables import Array
from driftproof.methods.schemes import Method

# A step of this part of the system's own time shows its slopes; a jump is sixteen times as far as it moves a state.
SHORT = 2.0**-12
_JUMP = 16 * SHORT
# What is held ends in the same number, or as far off, in a step that is longer or shorter by this part, from a state
# that is larger or smaller by it; other errors change by about as much of them, of which this is little.
_BESIDE, _SAME = 2.0**-20, 2.0**-28
_ROUNDINGS = 16  # in units of u, which a length of 1 may have


@dataclass(frozen=True)
class Held:
    """The parts that are divided by their length, as places where they begin and end, and numbers that have a limit."""

    divided: tuple[tuple[int, int], ...] = ()
    limits: frozenset[int] = frozenset()

    def put(self, end: Sequence[float]) -> list[float]:
        """The end of a step with these parts divided."""
        found = np.array(end, float)
        for i, j in self.divided:
            found[i:j] /= np.linalg.norm(found[i:j])
        return [float(x) for x in found]

    @property
    def words(self) -> str:
        """What is divided, in words."""
        return "".join(f", with numbers {i} to {j - 1} divided by their length at its end" for i, j in self.divided)


UNHELD = Held()


def jump_from(steps: Any, y: Sequence[float], t: float = 0.0) -> str:
    """How even a short step from a state ends far from it, as at a limit, in words; "" if it does not.

    A step of half the length ends as far, and one from a state that is larger by an eighth ends where it does. Small
    states are at no limit.
    """
    size = max(map(abs, y))
    if size < min(max(map(abs, each)) for each in steps.states):
        return ""
    with suppress(Misbehaviour, ArithmeticError):
        h = SHORT * min(steps.unit, size / max(map(abs, steps.slopes(t, y))))
        ends = [np.array(steps.end(t, z, x)) for z, x in ((y, h), (y, h / 2), ([x * 9 / 8 for x in y], h))]
        far, near, same = np.abs(ends[0] - y), np.abs(ends[1] - y), np.abs(ends[2] - ends[0])
        leaps = (far > _JUMP * size) & (near > 3 / 4 * far) & (same < _JUMP * size)
        for i in np.flatnonzero(leaps)[:1]:
            return f"number {i} jumps from {y[i]:.4g} to {ends[0][i]:.4g} in a step of {h:.1g}"
    return ""


def held_in(steps: Any, parts: Sequence[tuple[int, int]]) -> tuple[Held, list[tuple[float, ...]]]:
    """What is held of `OwnSteps`, and states from which short ones do not jump: of one that does, where it ends.

    At a limit a number goes as far in a step of half the length, and either not from every state, or not from its end,
    as what a code sets or multiplies does; a part with the length 1 may jump from every state, and is one of these
    `parts`, or else the least around all that jumps. States whose slopes lead out of a limit are left out.
    """
    shorter, jumped, onward = dict[tuple[float, ...], Array](), dict[tuple[float, ...], Array](), list[Array]()
    still, h = list[Array](), SHORT * steps.unit
    for y in steps.states:
        with suppress(Misbehaviour):
            far, near = (np.array(steps.end(0.0, y, x)) for x in (h, h / 2))
            onward.append(np.array(steps.end(0.0, near.tolist(), h)))
            moved, half = np.abs(far - y), np.abs(near - y)
            leaps = (moved > _JUMP * np.abs(y).max()) & (half > 3 / 4 * moved)
            shorter[y], jumped[y] = near, (far == near) & (moved > 0) | leaps
            still.append(far == near)
    places = [int(i) for i in np.flatnonzero(np.any([*jumped.values()], axis=0))] if jumped else []
    if not places:
        return UNHELD, [*steps.states]
    around = [(i, j) for i in range(places[0] + 1) for j in range(places[-1] + 1, steps.size + 1) if j > i + 1]
    rounding = _ROUNDINGS * float(steps.subject.format.u)
    divided = [part for part in parts if part[1] > part[0] + 1 and _are_units(shorter, *part, rounding)]
    shortest = sorted(around, key=lambda part: part[1] - part[0])
    divided = divided or [part for part in shortest if _are_units(shorter, *part, rounding)][:1]
    jumps, moves = np.array([*jumped.values()]), np.array(onward) != np.array([*shorter.values()])
    limits = jumps.any(axis=0) & (~jumps.all(axis=0) | moves.any(axis=0))
    states, seen = list[tuple[float, ...]](), set[int]()
    for (y, near), same, left in zip(shorter.items(), still, moves, strict=True):
        at_limit, end = jumped[y] & limits, tuple(near.tolist())
        seen |= {int(i) for i in np.flatnonzero(at_limit & same)}
        with suppress(ArithmeticError):
            if not (divided or at_limit.any()):
                states.append(y)
            elif not (at_limit & ~left & (np.array(steps.slopes(0.0, end)) != 0)).any():
                states.append(end)
    return Held(tuple(divided), frozenset(seen)), [*dict.fromkeys(states)]


def _are_units(ends: Mapping[tuple[float, ...], Array], i: int, j: int, rounding: float) -> bool:
    """True if from each state the numbers in these places end with length 1, in their direction."""
    for y, end in ends.items():
        part = np.array(y[i:j])
        turned = np.abs(end[i:j] - part / np.linalg.norm(part)).max()
        if abs(np.linalg.norm(end[i:j]) - 1) > rounding or turned > _JUMP:
            return False
    return True


def how_held(
    steps: Any, held: Held, method: Method, t: float, y: Sequence[float], h: float, allowed: Array | float
) -> tuple[str, float]:
    """The limit at which numbers end that are farther off the method's than allowed, in words, or a period; "" and 0.

    Beside this step one ends in the same number, between where it begins and the method's end, as the others do unless
    they bounce there; or they end as far off by whole periods, which change no slope.
    """
    allowed = np.full(steps.size, allowed) if isinstance(allowed, float) else allowed
    end, told, begun = np.array(steps.end(t, y, h)), np.array(steps.step(method, t, y, h)), np.array(y)
    beyond = [int(i) for i in np.flatnonzero(np.abs(end - told) > allowed)]
    off, size = (end - told)[beyond], max(np.abs(each[beyond]).max() for each in (begun, end, told))
    known = np.array([i in held.limits for i in range(steps.size)])
    period = common_length(np.abs(off).tolist(), steps.half * size)
    for by in (1 - _BESIDE, 1 + _BESIDE):
        z = [x * by for x in y]
        other, meant = np.array(steps.end(t, z, by * h)), np.array(steps.step(method, t, z, by * h))
        passed = known | (end != begun)
        for to in (told, meant):
            passed &= known | (np.minimum(begun, to) <= end) & (end <= np.maximum(begun, to))
        if stay := [i for i in beyond if passed[i] and other[i] == end[i] and meant[i] != told[i]]:
            moved = [i for i in beyond if not (other[i] == end[i] and meant[i] != told[i])]
            beside = f", and number {moved[0]} is changed there, as where it bounces" if moved else ""
            return f"number {stay[0]} ends at {end[stay[0]]:g}, a limit, where {method.key} goes on{beside}", 0.0
        change = (other - meant)[beyond] - off
        same = np.abs(change - (period and period * np.rint(change / period))) <= _SAME * np.abs(off) + allowed[beyond]
        if period > steps.half * size / ROUGH and same.all():
            slopes, others = steps.slopes(t + h, end.tolist()), steps.slopes(t + h, told.tolist())
            if np.allclose(slopes, others, steps.half, steps.half * max(map(abs, others))):
                return "", period
    return "", 0.0


def common_length(lengths: Sequence[float], least: float = 0.0) -> float:
    """The largest length of which all are multiples but for the `least`, or rounding, as Euclid finds it; 0 of none."""
    found = 0.0
    for x in lengths:
        while x > max(least, _SAME * found):
            found, x = x, abs(found - x * round(found / x))
    return found


def without_periods(periods: Sequence[float]) -> str:
    """What is said of steps that end elsewhere by these periods."""
    if not (period := common_length(periods)):
        return ""
    turns = period / (2 * pi)
    if turns > 1 / 2 and abs(turns - round(turns)) < _SAME:
        return "angles come back without whole turns"
    return f"numbers come back without whole periods of {period:.6g}"
