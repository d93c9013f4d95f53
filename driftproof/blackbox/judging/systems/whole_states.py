"""All numbers of a built-in system: the states at which they are seen, and whether they are so many oscillators."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain, cycle, islice, pairwise, product
from math import cos, log2

import numpy as np

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.agreement import ordinary_arguments
from driftproof.blackbox.judging.sampled_steps import Sizes, steps_within
from driftproof.blackbox.judging.specification import Domain, Specification
from driftproof.blackbox.judging.tolerance import KICKS, Tolerance
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.stepper.calling_conventions import MAP, STATE, STEP, CallingConvention
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import drifts
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS
from driftproof.blackbox.stepper.states.forms_by_values import further_numbers
from driftproof.blackbox.stepper.states.state_forms import BODIES

# The times at which a built-in system is seen, if its step takes one.
TIMES = (0.0, 0.75)
# What of a state changes by a smaller part, another number of it does not move; and the step in which it would.
ROUGH, _TRIED = 2.0**-10, 0.25
# Chosen: the further numbers of a state go through as many steps; the first two are tried in all.
_EXAMPLES = 100


def seen_at(
    subject: ForeignStepper, domain: Domain, size: int | None = None
) -> tuple[ForeignStepper, list[tuple[float, ...]]]:
    """The stepper as it takes all numbers of its built-in system, or `size` of them, and states at which it is seen."""
    if domain.begins:
        return subject, domain.begins.states
    (*_, (q, v)), _ = ordinary_arguments(subject, domain)
    begun = [*chain(*getattr(subject.function, "begun", ()))]
    if begun[2:]:  # of an object with further numbers
        of_all, alone = subject.function.of_all, CallingConvention(MAP, (STATE, STEP))  # type: ignore[attr-defined]
        subject = replace(subject, function=of_all, convention=alone, adapter=ARRAYS, log=CallLog())
        return subject, [tuple(x + cos(3 * i + place) / 8 for i, x in enumerate(begun)) for place in range(3)]
    subject, size = (subject, size or 2) if begun or size else _whole(subject)
    # None of them has a 0, where a friction jumps.
    first = [(q, v), (v / 2, q / 2), (-q, v / 4)]
    return subject, [(*y, *[v * cos(3 * i + place) for i in range(size - 2)])[:size] for place, y in enumerate(first)]


def _whole(subject: ForeignStepper) -> tuple[ForeignStepper, int]:
    """The subject as it takes all numbers of its system, and how many these are.

    They are more than q and v if arrays of one size hold them, or if coordinates move each other.
    """
    known = subject.adapter.together
    if STATE in subject.convention.order:
        return subject, max(2, known)
    for adapter, row in ((BODIES, 3),) * drifts(subject) + ((subject.adapter, known),):
        several = replace(subject, adapter=adapter)
        for size in (3 * row, 2 * row, row) if row else (3, 2):
            with suppress(Misbehaviour):
                y = [cos(i) for i in range(2 * size)]
                starts = (y[0], y[0] / 2, y[0])
                end, other, again = (np.array(several.step_state([x, *y[1:]], _TRIED)) for x in starts)
                moved = np.abs(end - other) > ROUGH * np.abs(end)
                if moved[[i for i in range(2 * size) if i % size]].any() and np.array_equal(end, again):
                    return several, 2 * size
    return subject, 2 * max(1, known)


def own_time(seen: Sequence[tuple[Array, Array]], slopes: Callable[[Array], Array] | None = None) -> float:
    """A power of two near to the own time of a system with these slopes at these states.

    That is one over the size of its Jacobian matrix J or, given all slopes, over the root of that of J^2: of a stiff
    spring with J = (0, 1; -k, 0), the root of k. J d is the difference of two slopes.
    """
    rates = list[float]()
    for (y, f), (z, g) in pairwise(seen):
        far, moved = float(np.linalg.norm(z - y)), float(np.linalg.norm(g - f))
        rates.append(moved / far)
        if slopes is None or not moved:
            continue
        part = ROUGH * far / moved
        with suppress(Misbehaviour, ArithmeticError):
            rates[-1] = (float(np.linalg.norm(slopes(y + part * (g - f)) - f)) / (part * far)) ** 0.5
    return 2.0 ** -round(log2(max(*rates, ROUGH)))


def pairs_of(subject: ForeignStepper, size: int) -> list[tuple[int, int]]:
    """The places of each position and its velocity among the numbers of a state; nothing if one is left over."""
    half, function = size // 2, getattr(subject.function, "__self__", subject.function)
    begun = getattr(function, "begun", ())
    apart = len(begun) == 2 if begun else STATE not in subject.convention.order
    return [] if size % 2 else [(i, i + half) if apart else (2 * i, 2 * i + 1) for i in range(half)]


def moves_more(subject: ForeignStepper, domain: Domain) -> bool:
    """True if a step of a built-in system moves further numbers of its state than q and v, and no clock or counter."""
    return _moves_more(subject, *seen_at(subject, domain))


def _moves_more(subject: ForeignStepper, whole: ForeignStepper, states: Sequence[tuple[float, ...]]) -> bool:
    first, size = states[0], len(states[0])
    places = (pairs_of(subject, size) or [(0, 1)])[0]

    def ends(q: float, v: float, given: Mapping[str, float]) -> Mapping[str, float]:
        start = {str(i): x for i, x in enumerate(first)} | dict(zip(map(str, places), (q, v), strict=True)) | {**given}
        end = whole.step_state([*start.values()], _TRIED, TIMES[q < 0])  # elsewhere it is another time as well
        return {str(i): x for i, x in enumerate(end) if i not in places}

    return size > 2 and bool(further_numbers(ends, {str(i): x for i, x in enumerate(first)}))


def oscillators(subject: ForeignStepper, wanted: Specification) -> int:
    """How many oscillators a step moves, in all numbers and at all times, as the method does; 0 if not all are such.

    Those of one state have all sizes of the domain; for an implicit method they have one, since a solver may stop by
    the largest.
    """
    whole, states = seen_at(subject, wanted.domain)
    size = len(states[0]) if _moves_more(subject, whole, states) else 2
    times = TIMES[: 1 + subject.takes_time]
    if not (pairs := pairs_of(subject, size)) or (size == 2 and times == TIMES[:1]):
        return len(pairs)
    tolerance = Tolerance.of(wanted, subject.format, KICKS)
    ordinary, steps = ordinary_arguments(subject, wanted.domain)
    tried = [([*islice(cycle(ordinary), len(pairs))], h) for h in steps]
    if wanted.method.explicit:
        drawn = steps_within(*(Sizes(*ends, subject.format) for ends in wanted.domain.ranges))
        for _ in range(_EXAMPLES):
            some = [*islice(drawn, len(pairs))]
            tried.append(([(q, v) for q, v, _ in some], some[0][2]))
    for (given, h), t in product(tried, times):
        state = [0.0] * size
        for (i, j), (q, v) in zip(pairs, given, strict=True):
            state[i], state[j] = q, v
        try:
            end = whole.step_state(state, h, t) if size > 2 else whole.step(*given[0], h, t)
        except Misbehaviour:
            return 0
        ends = ((end[i], end[j]) for i, j in pairs)
        if not all(tolerance.allows(*start, h, each) for start, each in zip(given, ends, strict=True)):
            return 0
    return len(pairs)
