"""The steps of a stepper with its system built in: its slopes by short steps, and the steps of a method on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import pairwise, product
from math import ceil, hypot, log2

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem
from driftproof.blackbox.judging.nonlinear_step import BEYOND_TOLERANCE, BITS, own_step
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.systems.held_states import UNHELD, how_held
from driftproof.blackbox.judging.systems.whole_states import ROUGH, TIMES, own_time, pairs_of
from driftproof.blackbox.matching.tables import Array, exact_tableau
from driftproof.blackbox.probes.stage_solutions import advanced, step_by_iteration
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta
from driftproof.support.plain_text import counted

# Slopes are extrapolated from steps of 2**-8 of the system's own time and halves of these: what is cut off is below
# 2**-50, and rounding, divided by the shortest, below 2**-36. Half of the digits leave room for a step made of them.
_LONGEST, _HALVINGS, _ERROR, HALF_THE_DIGITS = 2.0**-8, 5, 2.0**-36, 2.0**-26
# Slopes that agree no better than ROUGH are none of a system, or another system's; the step sizes with which they are
# sought, the smaller ones for rates of a million or more: 2^-40 rounds slopes of the state's size to 2^-13, and 2^-50
# those that are a thousand times as large.
_FIRST = (2.0**-20, 2.0**-30, 2.0**-40, 2.0**-50)
# A state with slopes so many times as large as at the others, as where bodies nearly touch, would make all steps short.
_STEEP = 64
# How near to (0, 0) the linear part of a system shows, to as many digits as rounding leaves there.
_NEAR = 2.0**-18
# Where methods are compared: at steps in units of the system's own time, long enough to tell methods of one order
# apart, if slopes change by more than a part. Stages should contract by 3/4 or better in each round.
COMPARED, SEEN_BENT, _CONTRACTS = (0.25, 1.0), 2.0**-16, 0.75
# Systems with a shorter time are looked at again, as it may be that of a stiff spring.
_FAST = 2.0**-8


@dataclass(frozen=True)
class OwnSteps:
    """The system of a stepper, the states at which it is seen, and a power of two near to its own time.

    A state y is [q, v], or has as many numbers as the stepper needs; of a splitting, half of them are positions.
    """

    subject: ForeignStepper
    states: Sequence[tuple[float, ...]]
    unit: float = 1.0

    @cached_property
    def problem(self) -> NonlinearProblem:
        """The system, its slopes as floats show them. Raises ArithmeticError where they are not smooth."""

        def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            place = [*map(float, y)]
            found, off = self._seen(float(t), *place)
            if not off <= HALF_THE_DIGITS * max(*map(abs, place), hypot(*found)):
                raise ArithmeticError("its slopes are not smooth")
            return [arb(float(x)) for x in found]

        return NonlinearProblem("its own system", rate, lambda t: [arb(0)] * self.size, self.size // 2)

    @property
    def times(self) -> Sequence[float]:
        """The times at which steps are compared; a step that takes none begins at 0."""
        return TIMES[: 1 + self.subject.takes_time]

    @property
    def size(self) -> int:
        """How many numbers a state has."""
        return len(self.states[0])

    @property
    def halves(self) -> tuple[slice, slice]:
        """The places of the positions among the numbers of a state, and those of the velocities."""
        return slice(None, self.size // 2), slice(self.size // 2, None)

    def end(self, t: float, y: Sequence[float], h: float) -> Sequence[float]:
        """The end of a step."""
        return self.subject.step_state(y, h, t) if self.size != 2 else self.subject.step(y[0], y[1], h, t)

    def slopes(self, t: float, y: Sequence[float]) -> list[float]:
        """The slopes as floats."""
        return [float(x) for x in self.problem.rate(t, [*y])]

    @cached_property
    def _seen(self) -> Callable[..., tuple[Array, float]]:
        """The slopes at (t, *y), `_measured` once at each place, and their last change."""
        return cache(lambda t, *y: self._measured(t, y, self.unit * _LONGEST, _HALVINGS))

    def _measured(self, t: float, y: Sequence[float], h: float, count: int) -> tuple[Array, float]:
        """The slopes, extrapolated from steps of h and its halves, and by how much the last of these changed them."""
        steps = [h / 2**i for i in range(count)]
        rows = [(np.array(self.end(t, y, step)) - np.array(y)) / step for step in steps]
        for power in range(1, count):
            last = rows[-1]
            rows = [after + (after - before) / (2**power - 1) for before, after in pairwise(rows)]
        return rows[0], float(np.abs(rows[0] - last).max())

    def _seen_with(self, h: float) -> list[tuple[Array, Array]] | None:
        """The states that have an answer, with their slopes; None if these are not smooth, as where each step jumps."""
        seen = list[tuple[Array, Array]]()
        for y in self.states:
            with suppress(Misbehaviour):
                slopes, off = self._measured(0.0, y, h, 2)
                if not off <= ROUGH * (1 + hypot(*slopes)):
                    return None
                seen.append((np.array(y), slopes))
        return seen

    @classmethod
    def of(cls, subject: ForeignStepper, states: Sequence[tuple[float, ...]]) -> OwnSteps | None:
        """The system at the states with an answer; None if short steps have no slopes there."""
        first = cls(subject, states)
        smooth = (seen for h in _FIRST if (seen := first._seen_with(h)) is not None)
        if (seen := next(smooth, None)) is None:
            return None
        sizes = [float(np.linalg.norm(slopes)) for _, slopes in seen]
        seen = [each for each, size in zip(seen, sizes, strict=True) if size <= _STEEP * sorted(sizes)[len(sizes) // 2]]
        if not seen[1:]:
            return None
        unit = own_time(seen)
        if unit < _FAST:
            unit = own_time(seen, lambda y: first._measured(0.0, y.tolist(), unit * _LONGEST, _HALVINGS)[0])
        return cls(subject, [tuple(y.tolist()) for y, _ in seen], unit)

    def oscillates(self, near: float) -> bool:
        """True if all numbers move as so many oscillators q'' = -q do, or turned the other way, at every time.

        Then q'' = -q is that of a state (v, q), for which there are words of their own.
        """
        seen, pairs = list[bool](), pairs_of(self.subject, self.size)
        for t, y in product(self.times, self.states):
            with suppress(Misbehaviour):
                slopes, _ = self._seen(t, *y)
                turned = [x for i, j in pairs for x in (-slopes[j], slopes[i])]
                at = [x for i, j in pairs for x in (y[i], y[j])]
                seen.append(any(np.allclose(turned, np.multiply(way, at), near, near) for way in (1, -1)))
        return bool(pairs and seen) and all(seen)

    @property
    def alike(self) -> bool:
        """True if its numbers are oscillators that take the same step. Raises a Misbehaviour."""
        pairs, (q, v, *_) = pairs_of(self.subject, self.size), self.states[0]
        y = [q if any(i == place for i, _ in pairs) else v for place in range(self.size)]
        ends = (np.array([end[i], end[j]]) for end in [self.end(0.0, y, COMPARED[0])] for i, j in pairs)
        return self.oscillates(ROUGH) and all(np.allclose(*both, HALF_THE_DIGITS) for both in pairwise(ends))

    @property
    def words(self) -> str:
        """The system in words, as it is near (0, 0), if it has slopes there."""
        if self.oscillates(ROUGH):
            return f"its system is built in, {counted(self.size // 2, 'oscillator')} q'' = -q"
        return f"its system is built in, not q'' = -q but {self.law}"

    @property
    def law(self) -> str:
        """The right-hand sides, as they are near (0, 0); of more than two numbers only how many these are."""
        if self.size > 2:
            return f"one of {self.size} numbers"
        names = self.subject.form.state_names
        tiny = self.unit * _NEAR
        try:
            (push, *moved) = (np.array(self.slopes(0.0, y)) for y in ((0.0, 0.0), (tiny, 0.0), (0.0, tiny)))
            around = [
                [(np.array(self.slopes(0.0, y)) - push) / by for y in ((by, 0.0), (0.0, by))]
                for by in (-tiny, 2 * tiny)
            ]
            here, timed = [np.array(self.slopes(0.0, y)) for y in self.states], self.timed
        except (Misbehaviour, ArithmeticError):
            return "another one"
        rows = np.array([*((each - push) / tiny for each in moved), push]).T
        size = np.abs(rows[:, :2]).max()
        if size * self.unit * ROUGH > 1 or not np.allclose(around, rows[:, :2].T, 0, ROUGH * size):  # a jump, or a kink
            return "another one"
        # Where q' = v, a velocity is as large as a position by the system's own time: -1e6 q - 10 v is not -1e6 q.
        sizes = (1.0, 1 / self.unit if abs(rows[0, 0]) * self.unit < _NEAR else 1.0, 1.0)
        texts = [f"{name}' = {_sum_text(row, names, sizes)}" for name, row in zip(names, rows.tolist(), strict=True)]
        text = ", ".join(texts)
        linear = np.allclose(here, [rows @ [*y, 1] for y in self.states], ROUGH, ROUGH)
        text += ", a constant force" * (linear and text.startswith("q' = v") and not set(text[11:]) & set("qv"))
        return text + " near (0, 0)" * (not linear) + " at t = 0" * timed

    @property
    def timed(self) -> bool:
        """True if its slopes depend on the time that the step takes, at a state where they are smooth."""
        for y in self.states if self.subject.takes_time else ():
            with suppress(ArithmeticError):
                here, later = (self.slopes(t, y) for t in self.times)
                if not np.allclose(here, later, ROUGH, ROUGH):
                    return True
        return False

    def off(self, wanted: Specification) -> tuple[float, str]:
        """How far steps are off the method's, and the first that is too far off in words.

        Positions and velocities are compared each with their own size. Steps without an answer, those whose stages do
        not settle, and those that end at a limit, or in a box, are left out. Raises MethodError if all are, or if
        slopes hardly change in the others.
        """
        method, found, why, bent = of_one_state(wanted.method), list[float](), "", 0.0
        allowed = HALF_THE_DIGITS + BEYOND_TOLERANCE * float(wanted.allowance.solver_tolerance or 0)
        for t, share, y in product(self.times, COMPARED, self.states):
            h = min(share * self.unit, wanted.domain.largest_step)
            try:
                seen, told = tuple(self.end(t, y, h)), self.step(method, t, y, h)
                slopes = self.slopes(t, y), self.slopes(t + h, told)
            except (Misbehaviour, ArithmeticError) as left_out:
                why = str(left_out)
                continue
            apart = self.apart(y, seen, told)
            with suppress(Misbehaviour, ArithmeticError):
                if not apart <= allowed and any(how_held(self, UNHELD, method, t, y, h, allowed)):
                    continue
            found.append(apart)
            bent = max(bent, h * self.apart(y, *slopes))
            if not found[-1] <= allowed:
                return found[-1], f"a step of {h:g} from {ends_in_words(y, seen, method, told)}"
        if bent < SEEN_BENT:
            raise MethodError(why or "in a step of it slopes hardly change")
        return max(found), ""

    def put(self, end: Sequence[float]) -> Sequence[float]:
        """The end of a step, which nothing is known to hold elsewhere."""
        return end

    def apart(self, y: Sequence[float], ends: Sequence[float], others: Sequence[float]) -> float:
        """The largest difference of two ends, each half of a state relative to its own size."""
        halves = self.halves[self.size < 2 :]
        sizes = [max(map(abs, y[half])) or max(map(abs, y)) for half in halves]
        return float(
            max(np.abs(np.subtract(ends[x], others[x])).max() / size for x, size in zip(halves, sizes, strict=True))
        )

    @property
    def half(self) -> float:
        """The part to which its steps are known: half of their digits."""
        return HALF_THE_DIGITS

    def step(self, method: Method, t: float, y: Sequence[float], h: float) -> list[float]:
        """The method's step. Raises MethodError, or ArithmeticError if its stages do not settle."""
        if not isinstance(method, RungeKutta | Collocation):
            half, odd = divmod(self.size, 2)
            if odd:
                raise MethodError(f"{self.size} numbers are not as many positions as velocities")
            seen = (np.array(self.slopes(t, [*y[:half], *[v] * half])) for v in (1.0, -1.0, 2.0))
            up, down, twice = ((each[:half], each[half:]) for each in seen)
            off = [*(up[0] + down[0]), *(twice[0] - 2 * up[0]), *(up[1] - down[1])]
            share = np.abs(off).sum() / (1 + np.abs(up).sum())
            if not all(up[0]) or share > ROUGH:
                raise MethodError(f"it is not q' = c v, v' = F(q){', all q before all v' * (self.size > 2)}")
            if share > HALF_THE_DIGITS:
                raise MethodError("rounding leaves open whether it is q' = c v, v' = F(q), or not quite")
            rates = np.where(np.abs(up[0] - 1) < HALF_THE_DIGITS, 1.0, up[0]).tolist()
            with ctx.workprec(BITS):  # in q and q' = c v, where v is a momentum, say

                def rate(t: AnyNumber, z: Sequence[AnyNumber]) -> list[AnyNumber]:
                    _, pushes = np.split(np.array(self.problem.rate(t, [*z[:half], *[0.0] * half])), 2)
                    return [arb(0)] * half + [c * push for c, push in zip(rates, pushes, strict=True)]

                z = [*y[:half], *(x * c for x, c in zip(y[half:], rates, strict=True))]
                end = [float(x) for x in own_step(method, replace(self.problem, rate=rate), t, z, h)]
            return [*end[:half], *(x / c for x, c in zip(end[half:], rates, strict=True))]
        return table_step(method, self.slopes, t, y, h, _ERROR)


def table_step(
    method: RungeKutta | Collocation,
    slopes: Callable[[float, Sequence[float]], Sequence[float]],
    t: float,
    y: Sequence[float],
    h: float,
    error: float,
) -> list[float]:
    """The step of a table in floats: explicit stages in turn, others by iteration until slopes change by this part.

    Raises ArithmeticError if they do not settle.
    """
    a, b, c = (np.array(part, dtype=float).tolist() for part in exact_tableau(method))
    if method.explicit:
        found = list[Sequence[float]]()
        for node, row in zip(c, a, strict=True):
            found.append(slopes(t + node * h, advanced(y, h, [row], [found])))
        return [float(x) for x in advanced(y, h, [b], [found])]
    settled = lambda new, old: bool(np.abs(np.subtract(new, old)).max() <= error * np.abs(new).max())
    rounds = ceil(log2(error) / log2(_CONTRACTS))
    end, done = step_by_iteration([a], [b], lambda i, z, _: slopes(t + c[i] * h, z), y, h, rounds, settled)
    if not done:
        raise ArithmeticError(f"the stages of {method.key} could not be solved there")
    return [float(x) for x in end]


def ends_in_words(y: Sequence[float], seen: Sequence[float], method: Method, told: Sequence[float]) -> str:
    """The ends of a step from y and of that of a method, in words: of many numbers, those that differ most."""
    if len(y) <= 3:
        return f"{y} ends in {seen}, where {method.key} ends in {tuple(told)}"
    worst = max(range(len(y)), key=lambda i: abs(seen[i] - told[i]))
    return f"({y[0]:g}, {y[1]:g}, ...): number {worst} becomes {seen[worst]}, in {method.key} {told[worst]}"


def _sum_text(factors: Sequence[float], names: Sequence[str], sizes: Sequence[float]) -> str:
    """The sum of multiples of the names and of 1 as text, such as "10 v - q", without terms that the others hide."""
    terms, text = [abs(x) * size for x, size in zip(factors, sizes, strict=True)], ""
    for x, name, term in zip(factors, (*names, ""), terms, strict=True):
        if term > 4 * _NEAR * max(terms):
            size = f"{abs(x):.6g}"
            part = " ".join(filter(None, [size if size != "1" or not name else "", name]))
            text += f" {'-+'[x > 0]} {part}" if text else f"{'-' * (x < 0)}{part}"
    return text or "0"
