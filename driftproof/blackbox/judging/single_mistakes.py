"""Search for the one mistake in a method's program, a line or a coefficient, that gives the steps a code takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, islice, product
from math import isfinite
from operator import sub
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.nonlinear_problems import capped_exp, gives_force_times
from driftproof.blackbox.judging.programs import (
    Parameter,
    Program,
    StepSeen,
    Unsettled,
    edits,
    one_parameter,
    programs_of,
    unsettled,
)
from driftproof.blackbox.judging.specification import ORDINARY_DOMAIN, Specification
from driftproof.blackbox.judging.systems.own_steps import COMPARED, OwnSteps
from driftproof.blackbox.judging.systems.own_system import OwnSystem, own_system, system_of
from driftproof.blackbox.probes.coefficients import simple_rational
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting

# q, v and h, of ordinary size; h is so large that every coefficient of a method of high order matters.
_STEPS = ((0.6, -0.8, 1.0), (1.25, 0.5, 0.5), (-0.375, 0.9, 0.75))
# When steps start where times are passed: none of the method's own times is 0.
_START = 0.75
# Where no method moves, whatever its mistake; a stale slope that is kept does.
_REST = (0.0, 0.0, 1.0)
# The factor by which numbers inside a step may exceed its result: coefficients reach 50, and slopes 30.
_INSIDE = 64
# Iterations of the secant method for one coefficient, and its first offset; on linear problems one iteration is exact.
_ROUNDS, _ASIDE = 12, 0.125
# How near to the number that is found simpler ones are tried, of which the first to give the steps is named: where
# steps hardly change with a coefficient, they show few of its digits.
_NEAR = tuple(2.0**-bits for bits in range(8, 52, 4))
# Chosen: the most mistakes that are named.
MOST_SHOWN = 4
# Chosen: a longer program has more possible mistakes than can be tried in a second or two.
_MOST_STAGES = 13


def single_mistakes(subject: ForeignStepper, method: Method) -> tuple[str, ...]:
    """The mistakes, in words, each of which alone makes the method's program take the subject's steps.

    Steps are compared on the system that is built in, q'' = -q or else another one, or on q'' = exp(-2q), and at rest.
    At most MOST_SHOWN are returned; none if the method is very long, or implicit and no system is built in, or if its
    steps are the subject's. Raises OwnSystem if no slopes of a built-in system are seen.
    """
    built_in = subject.convention.kind == MAP
    found, system = (_usual(subject, method, built_in), own_system) if method.explicit else ((), system_of)
    if not built_in:
        return found
    with suppress(*[OwnSystem] * bool(found)):
        own = system(subject, ORDINARY_DOMAIN)
        if own is not None and (own.size > 2 or not found):  # one body of several may feel no force alone
            return mistakes_on(own, Specification(method))
    return found


def _usual(subject: ForeignStepper, method: Method, built_in: bool) -> tuple[str, ...]:
    """The mistakes on q'' = -q if that is built in, or on q'' = exp(-2q), which is driven if times are passed."""
    try:
        timed = not built_in and gives_force_times(subject)
        with suppress(UnsupportedCall):  # what an object keeps from steps of another force is none of the method's
            subject = subject.fresh(subject.convention.steps)
        taken = [*_taken(subject, built_in, timed)]
    except Misbehaviour:
        return ()
    rounding = Rounding(subject.format, _calls(method))

    def alike(y: Sequence[float], end: Sequence[float], made: Sequence[float]) -> bool:
        allowed = _INSIDE * rounding.of(1 + max(map(abs, (*end, *made))))
        return all(abs(gap) <= allowed for gap in map(sub, made, end))

    seen = _AllSeen(taken, alike, times_read=True)
    return _found(method, seen, timed=timed)


def mistakes_on(steps: OwnSteps, wanted: Specification) -> tuple[str, ...]:
    """The same for steps of another system, compared to half of their digits, at its times.

    None of a method of kicks and drifts unless q' = v, v' = F(q).
    """
    method, taken = of_one_state(wanted.method), list[StepSeen]()
    with suppress(ArithmeticError):
        if not isinstance(method, RungeKutta | Collocation) and (steps.size % 2 or not _of_second_order(steps)):
            return ()
        for t, share, y in product(steps.times, COMPARED, steps.states):
            h = share * min(steps.unit, wanted.domain.largest_step)  # of two sizes: at one, h**2/2 may be h
            with suppress(Misbehaviour, *[ArithmeticError] * (not method.explicit)):
                if not method.explicit:
                    steps.step(method, t, y, h)  # where its stages settle
                taken.append(StepSeen(steps.slopes, t, y, h, steps.end(t, y, h)))
        alike = lambda y, end, made: steps.apart(y, end, steps.put(made)) <= steps.half
        seen = _AllSeen(taken, alike)
        return _found(method, seen, steps.halves, steps.timed) if taken else ()
    return ()


def _of_second_order(steps: OwnSteps) -> bool:
    """True if q' = v, v' = F(q) to half of the digits. Raises ArithmeticError where its slopes are not smooth."""
    q, v = steps.halves
    for y in map(np.array, steps.states):
        faster = y.copy()
        faster[v] *= 2
        here, there = (np.array(steps.slopes(0.0, at.tolist())) for at in (y, faster))
        if not (np.allclose(here[q], y[v], steps.half) and np.allclose(here[v], there[v], steps.half)):
            return False
    return True


def _taken(subject: ForeignStepper, built_in: bool, timed: bool) -> Iterator[StepSeen]:
    """Yield steps on the system that is built in, or on a wall that moves if it is `timed`, and one at rest."""
    start = _START * timed

    def force(t: AnyNumber, q: AnyNumber) -> float:
        return -float(q) if built_in else float(capped_exp(-2 * q)) * (1 + float(t) * timed)

    for q, v, h in _STEPS:
        end = (
            subject.step(q, v, h) if built_in else subject.step_forced(lambda t, x: [force(t, *x)], start, [q], [v], h)
        )
        yield StepSeen(lambda t, y: [y[1], force(t, y[0])], start, (q, v), h, end)
    yield StepSeen(lambda t, y: [y[1], -y[0]], 0.0, _REST[:2], _REST[2], subject.step(*_REST))


def _found(method: Method, seen: _AllSeen, halves: Any = Program.halves, timed: bool = False) -> tuple[str, ...]:
    """The mistakes of the method's programs that give these steps; none if one of them gives them without any."""
    if _calls(method) > _MOST_STAGES:
        return ()
    programs, pair = [replace(each, halves=halves) for each in programs_of(method, timed)], len(seen.steps[0].y) == 2
    if any(map(seen.are_of, programs)):
        return ()
    # Times that are passed are read with the coefficients, which say more of them.
    read = ["c"] * (timed and seen.times_read and not isinstance(method, Nystrom))
    for program in programs:
        edited = (words for words, lines in edits(method, program, pair) if seen.are_of(replace(program, lines=lines)))
        solved = (seen.solved(each) for each in one_parameter(method, program) if each.name not in read)
        few = () if method.explicit else unsettled(method, program, len(seen.steps[0].y))
        stopped = (words for words, other in few if seen.are_of(other))
        # A number explains in the fewest words what a line explains as well.
        if found := tuple(islice(chain(filter(None, solved), edited, stopped), MOST_SHOWN)):
            return found  # in another form it would be the same mistake
    return ()


def _calls(method: Method) -> int:
    return len(method.parts) if isinstance(method, Splitting) else getattr(method, "stages", 0)


@dataclass(frozen=True)
class _AllSeen:
    """Steps that the subject takes, and whether an end that is made from y is alike."""

    steps: Sequence[StepSeen]
    alike: Callable[[Sequence[float], Sequence[float], Sequence[float]], bool]
    times_read: bool = False

    def are_of(self, program: Program | Unsettled) -> bool:
        """True if the program takes these steps."""
        with np.errstate(all="ignore"), suppress(ArithmeticError):
            return all(self.alike(each.y, each.end, program.end(each)) for each in self.steps)
        return False

    def solved(self, one: Parameter) -> str:
        """The x for which one step is the one seen, by the secant method, in words; "" if other steps differ.

        That is a step at a late time: at t = 0, forces such as cos(t) hardly change.
        """
        first = max(self.steps, key=lambda each: each.t)

        def gap(x: float, m: int) -> float:
            return one.at(x).end(first)[m] - first.end[m]

        start = 1.0 if one.scaled else float(one.row[one.chosen[0]])
        with np.errstate(all="ignore"), suppress(ArithmeticError):
            apart = np.abs(np.subtract(one.program.end(first), first.end))
            for m in np.argsort(-apart)[:2].tolist():
                x, before = start, start + _ASIDE
                off, off_before = gap(x, m), gap(before, m)
                for _ in range(_ROUNDS):
                    if off == off_before or not isfinite(off):
                        break
                    x, before = x - off * (x - before) / (off - off_before), x
                    off, off_before = gap(x, m), off
                if x != start and self.are_of(one.at(x)):
                    simpler = [y for near in _NEAR if (y := simple_rational(x, near)) is not None]
                    return one.words.format(next((y for y in simpler if self.are_of(one.at(float(y)))), f"{x:.12g}"))
        return ""
