"""The steps of a stepper beside a method's own on a system whose slopes are given, to the rounding of both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from math import sqrt
from random import Random
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE
from driftproof.blackbox.judging.programs import MOST_UNKNOWNS, StepSeen, Unsettled
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.systems.held_states import UNHELD, Held, how_held
from driftproof.blackbox.judging.systems.own_steps import COMPARED, OwnSteps, ends_in_words, table_step
from driftproof.blackbox.judging.systems.whole_states import TIMES
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.stepper.calling_conventions import STATE
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta, Splitting

# What rounding may cost is seen on the method's own step: it is made again so many times, with each number that f gets
# and gives, and each that the step begins with, off at random by up to so many u, as after sums and products in a row.
# Such errors hardly ever add up as they might: the farthest end of eight counts four times, which is more than the sum
# of all of them in their worst signs as long as they are fewer than some forty.
_SAMPLES, _ROUNDED, _WORST = 8, 16, 4
# Stages are iterated until they change by no more: far above the rounding of sums, and below the tolerance of solvers.
_SETTLED = 2.0**-44
# Newton's iterations: from a state at which an exponential is 2**64, each gains a factor e; and where they settle.
_ROUNDS_OF_NEWTON, _SOLVED = 48, 2.0**-40
# A force that depends on a velocity shows it in one that is larger by this part, which a start hardly leaves.
_FASTER = 2.0**-6
_LEAST = 2.0**-1022  # the smallest normal double: what is allowed may be 0
# The velocities with which forces that depend on them are usually asked: the first is tried first.
BEFORE, _PREDICTED = "before each kick", "that the first force predicts for each kick"
_AFTER, _ROUNDS = "before each kick but the last, and there with that after it", 100
# Positions end at q + h v + c h**2 F and further powers of h, of which steps of this part of the system's own time, its
# half and its quarter show two: what these leave is less than what the second of them changes.
_HALVED = 2.0**-8


class Beside(NamedTuple):
    """The end of a step and that of the method's; how far it is off, and in words if that is too far, else "".

    It is `rough` if its own rounding explains that, and that of the method's step does not. `by_time` is how far, in
    units of what is allowed, the method's step would end from there with a clock that is a step ahead. `limit` says at
    which limit the code holds numbers that end elsewhere, and `period` is that of which they are whole ones off.
    """

    end: list[float]
    told: list[float]
    off: float
    wrong: str
    rough: bool
    by_time: float
    limit: str
    period: float

    @property
    def fails(self) -> str:
        """What is wrong, "" if nothing is or if the code holds what ends elsewhere."""
        return "" if self.limit or self.period else self.wrong


@dataclass(frozen=True)
class GivenSteps(OwnSteps):
    """The steps of a stepper, and the slopes of the system that it should have.

    With `newton` implicit stages are solved by Newton's method where iterations do not settle.
    """

    rates: Callable[[float, Sequence[float]], list[float]] = lambda t, y: [*y]
    asked: str = ""
    held: Held = UNHELD
    newton: bool = False

    @cached_property
    def problem(self) -> NonlinearProblem:
        """The system that is given."""

        def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            return [arb(x) for x in self.rates(float(t), [float(x) for x in y])]

        return NonlinearProblem("the system given", rate, lambda t: [arb(0)] * self.size, self.size // 2)

    def slopes(self, t: float, y: Sequence[float]) -> list[float]:
        """The slopes, which nothing measures."""
        return self.rates(t, y)

    @property
    def half(self) -> float:
        """The root of u: what is known to it has half of its digits."""
        return sqrt(self.subject.format.u)

    @property
    def driven(self) -> bool:
        """True if the slopes depend on the time."""
        with suppress(ArithmeticError):
            pairs = product(self.states, (TIMES[1], *(self.unit * share for share in COMPARED)))
            return any(self.rates(t, y) != self.rates(0.0, y) for y, t in pairs)
        return False

    @property
    def untimed(self) -> bool:
        """True if the slopes depend on a time that the step does not take."""
        return self.times != TIMES and self.driven

    @cached_property
    def halves(self) -> tuple[slice, slice]:
        """The even and the odd places of an array, if these alone are such that q' = v; else the halves."""
        apart, turns = super().halves, (slice(0, None, 2), slice(1, None, 2))
        if STATE not in self.subject.convention.order or self.size % 2:
            return apart
        slopes = [(y, self.rates(0.0, y)) for y in self.states]
        here, there = (all(np.allclose(to[q], y[v], self.half, 0) for y, to in slopes) for q, v in (apart, turns))
        return turns if there and not here else apart

    @cached_property
    def sides(self) -> tuple[Any, Any]:
        """The places of positions and of velocities: those of parts of a start, by names, or else the halves."""
        speeds = self.subject.form.speeds
        return ([i for i in range(self.size) if i not in speeds], speeds) if speeds else self.halves

    @cached_property
    def pushed(self) -> bool:
        """True if forces depend on velocities, or velocities on positions: a splitting does not say which."""
        q, v = self.sides
        faster = [1.0 + _FASTER * (i in np.arange(self.size)[v]) for i in range(self.size)]
        with suppress(ArithmeticError):
            for y in self.states:
                here, pushed, moved = (
                    np.array(self.rates(0.0, [x * by for x, by in zip(y, way, strict=True)]))
                    for way in ([1.0] * self.size, faster, [2.0 + _FASTER - by for by in faster])
                )
                if (here[v] != pushed[v]).any() or (here[q] != moved[q]).any():
                    return True
        return False

    def later(self, h: float) -> GivenSteps:
        """The same steps with a clock of the system that is h ahead."""
        return replace(self, rates=lambda t, y: self.rates(t + h, y))

    def put(self, end: Sequence[float]) -> Sequence[float]:
        """The end of a step with the parts divided by their length that the code divides."""
        return self.held.put(end)

    def step(self, method: Method, t: float, y: Sequence[float], h: float) -> list[float]:
        """The method's step, its end put where the code holds it."""
        return self.held.put(self._made(method, t, y, h))

    def _made(self, method: Method, t: float, y: Sequence[float], h: float) -> list[float]:
        """The method's step; of a splitting, each part asks where the one before it ends, with the usual velocity."""
        if isinstance(method, RungeKutta | Collocation):
            try:
                return table_step(method, self.rates, t, y, h, _SETTLED)
            except ArithmeticError:  # of a stiff system iterations run away, to states without slopes
                if not self.newton:
                    raise
                return self.solved(method, t, y, h, _SOLVED)
        if not isinstance(method, Splitting):
            return super().step(method, t, y, h)
        if self.size % 2 and self.sides is self.halves:
            raise MethodError(f"{self.size} numbers are not as many positions as velocities")
        moved, v, way = t, self.sides[1], self.way(method)
        end: Array = np.array(y, dtype=float)
        last = max((i for i, (kind, _) in enumerate(method.parts) if kind == "kick"), default=0)
        for i, (kind, share) in enumerate(method.parts):
            part, at = self.sides[kind == "kick"], end.copy()
            if kind == "kick" and way == _PREDICTED:
                at[v] = np.array(y)[v] + (moved - t) * np.array(self.rates(t, y))[v]
            new = end[part] + float(share) * h * np.array(self.rates(moved, at.tolist()))[part]
            for _ in range(_ROUNDS if way == _AFTER and i == last else 0):
                at[v], before = new, new
                new = end[v] + float(share) * h * np.array(self.rates(moved, at.tolist()))[v]
                if np.abs(new - before).max() <= _SETTLED * np.abs(new).max():
                    break
            end[part] = new
            moved += float(share) * h * (kind != "kick")
        return [float(x) for x in end]

    def solved(
        self, method: RungeKutta | Collocation, t: float, y: Sequence[float], h: float, enough: float
    ) -> list[float]:
        """The step with its stages solved by Newton's method, to where one more iteration changes it by less.

        Raises ArithmeticError without a root, and where there are too many numbers to solve for.
        """
        if method.explicit or method.stages * self.size > MOST_UNKNOWNS:
            raise ArithmeticError(f"the stages of {method.key} could not be solved there")
        taken = StepSeen(self.rates, t, y, h, [])
        solver = Unsettled(method, _ROUNDS_OF_NEWTON, predicted=False, anew=True, called=False, timed=True)
        ends = [each.end(taken) for each in (solver, replace(solver, rounds=_ROUNDS_OF_NEWTON + 1))]
        if not self.apart(y, *ends) <= enough:
            raise ArithmeticError(f"the stages of {method.key} could not be solved there")
        return ends[1]

    def way(self, method: Splitting) -> str:
        """The velocities that its force is asked with, if it depends on them: the first that a step agrees with."""
        return self.asked or (self._way(method) if self.pushed else BEFORE)

    @cached_property
    def _way(self) -> Callable[[Splitting], str]:
        return cache(self._fitting)

    def _fitting(self, method: Splitting) -> str:
        for way in (BEFORE, _PREDICTED, _AFTER):
            with suppress(Misbehaviour, ArithmeticError):
                h, y = self.unit * COMPARED[0], self.states[0]
                if self.apart(y, self.end(0.0, y, h), replace(self, asked=way).step(method, 0.0, y, h)) <= self.half:
                    return way
        return BEFORE

    def moved_otherwise(self, method: Splitting) -> str:
        """How positions end otherwise than in q + h v + c h**2 F of the method, whatever velocities F is asked with.

        What F has less at rest may enter with another weight than c, the same for all positions, as where it is a part
        of its own. "" if positions end so, or if that is not seen.
        """
        (q, v), kicked, c = self.sides, 0.0, 0.0
        for kind, part in method.parts:
            kicked += float(part) * (kind == "kick")
            c += float(part) * kicked * (kind != "kick")
        rows, h = list[tuple[Array, ...]](), self.unit * _HALVED
        with suppress(Misbehaviour, ArithmeticError):
            for y in self.states:
                at, rest = np.array(y), np.array(y)
                rest[v] = 0
                slopes, force = np.array(self.rates(0.0, y)), np.array(self.rates(0.0, rest.tolist()))[v]
                if not np.array_equal(slopes[q], at[v]):  # as of a quaternion
                    return ""
                thrice = (h, h / 2, h / 4)
                first, second, third = ((np.array(self.end(0.0, y, x))[q] - at[q] - x * at[v]) / x**2 for x in thrice)
                once, again = 2 * second - first, 2 * third - second
                rows.append(((4 * again - once) / 3, np.abs(again - once), force, slopes[v] - force))
            seen, unsure, plain, drag = (np.array(each) for each in zip(*rows, strict=True))
            left = seen - c * plain
            off = left - drag * (left * drag).sum() / ((drag**2).sum() or 1.0)
            rounded = 16 * float(self.subject.format.u) * np.abs(self.states).max() / thrice[-1] ** 2
            if np.linalg.norm(off) > 4 * np.linalg.norm(unsure) + rounded * off.size:
                n = int(np.abs(off).max(axis=1).argmax())
                shown = (self.states[n], seen[n], c * (plain[n] + drag[n]))
                start, here, told = (", ".join(f"{x:.4g}" for x in numbers) for numbers in shown)
                return f"from ({start}) positions move by h v + h**2 ({here}), in {method.key} by h v + h**2 ({told})"
        return ""

    def number(self, x: float) -> float:
        """The number of the stepper's format nearest to x."""
        return float(self.subject.format.nearest(Fraction(x)))

    def _rounded(self, method: Method, t: float, y: Sequence[float], h: float, draw: Random) -> list[float]:
        """The method's step with all numbers off at random."""
        u = _ROUNDED * float(self.subject.format.u)

        def off(numbers: Iterable[float]) -> list[float]:
            return [x * (1 + u * draw.uniform(-1, 1)) for x in numbers]

        way = self.way(method) if isinstance(method, Splitting) else ""
        unsure = replace(self, rates=lambda t, y: off(self.rates(off([t])[0], off(y))), asked=way)
        return off(unsure.step(method, t, off(y), h))

    def _jumps(self, method: Method, t: float, y: Sequence[float], h: float, off: Array, draw: Random) -> Array:
        """The largest jump of the difference from the method's step, from a state to its neighbours.

        A code that computes with larger numbers than f does, such as degrees above the absolute zero, rounds more than
        f; that jumps from state to state, while what is wrong hardly changes between states that agree in half of their
        digits.
        """
        jumps, size = np.zeros(len(y)), max(map(abs, self.states[0]))
        for _ in range(_SAMPLES):
            z = [self.number(x + self.half * draw.uniform(-1, 1) * max(abs(x), size)) for x in y]
            jumps = np.maximum(jumps, np.abs(np.subtract(self.end(t, z, h), self.step(method, t, z, h)) - off))
        return jumps

    def beside(self, wanted: Specification, t: float, y: Sequence[float], h: float) -> Beside:
        """One step beside the method's.

        Raises ArithmeticError where the method has none, or where rounding leaves less than half of its digits.
        """
        method, draw = of_one_state(wanted.method), Random(0)
        with np.errstate(all="ignore"):
            told = self.step(method, t, y, h)
            ends = [self._rounded(method, t, y, h, draw) for _ in range(_SAMPLES)]
            allowed = _WORST * np.abs(np.subtract(ends, told)).max(axis=0)
        size = max(map(abs, (*y, *told)))
        if not allowed.max() <= self.half * size:
            raise ArithmeticError("rounding leaves less than half of its digits")
        tolerated = ""
        if not method.explicit:
            solved = BEYOND_TOLERANCE * float(wanted.allowance.solver_tolerance or 0)
            allowed = allowed + _SETTLED * size + solved * (1 + size)
        seen = [float(x) for x in self.end(t, y, h)]
        off = np.subtract(seen, told)
        if not method.explicit and solved:
            part, stated = np.abs(off).max() / (1 + size), float(wanted.allowance.solver_tolerance or 0)
            tolerated = f", off by {part:.1e} of 1 + its largest number; the solver tolerance is {stated:.1e} of that"
        right = within = bool((np.abs(off) <= allowed).all())
        if not within:
            with suppress(Misbehaviour, ArithmeticError):
                jumps = _WORST * self._jumps(method, t, y, h, off, draw)
                small = jumps.max() <= self.half * max(size, *map(abs, self.states[0]))
                right = small and bool((np.abs(off) <= np.maximum(allowed, jumps)).all())
        at = f" at t = {t:g}" * bool(t)
        wrong = f"a step of {h:g}{at} from {ends_in_words(tuple(y), tuple(seen), method, told)}{tolerated}"
        apart = self.apart(np.maximum(np.abs(y), np.abs(told)).tolist(), seen, told)
        by_time = np.abs(np.subtract(self.later(h).step(method, t, y, h), told)) / np.maximum(allowed, _LEAST)
        limit, period = "", 0.0
        if not right:
            with suppress(Misbehaviour, ArithmeticError):
                limit, period = how_held(self, self.held, method, t, y, h, allowed)
        wrong *= not right
        apart *= not period
        return Beside(seen, told, apart, wrong, right and not within, by_time.max(), limit, period)
