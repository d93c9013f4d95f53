"""Multistep steppers: which linear multistep method it is, how it starts, and the order that comes of it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

from driftproof.blackbox.families.imex import WELL_SOLVED
from driftproof.blackbox.families.multistep_recurrence import ONE_SIZE, RecurrenceReading, read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns, order_across
from driftproof.blackbox.families.multistep_start import StartReading, read_start
from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.handed_slopes import HandedSlopes
from driftproof.methods.multistep import Multistep
from driftproof.support.plain_text import Json


@dataclass(frozen=True)
class MultistepReading:
    """The recurrence of a stepper's steps, and its start if that was seen.

    A stepper that is `handed` the slopes before its first step has no start of its own. `order_across` is the order of
    the first step after a change of h.
    """

    recurrence: RecurrenceReading
    start: StartReading | None
    handed: bool = False
    order_across: int | None = None

    @property
    def faults(self) -> list[str]:
        """The faults, whatever method it is meant to be."""
        facts, own = self.recurrence.facts, self.recurrence.recurrence
        found = [self._start_fault] if self._start_fault else []
        if facts is not None and not facts.zero_stable:
            found.append(f"it is not zero-stable: {facts.root_condition.reason}")
        if facts is not None and facts.order < 1:
            what = ", ".join(f"{name} = {x}" for name, x in facts.inconsistencies.items())
            found.append(f"it is not consistent: {what}")
        if self.recurrence.asked and self.recurrence.predictor is None and not own.sigma[-1]:
            found.append(self.recurrence.asked)
        return found

    @property
    def _start_fault(self) -> str:
        facts = self.recurrence.facts
        if self.start is None or facts is None or facts.order < 1:
            return ""
        return self.start.fault(facts.order, self.recurrence.recurrence.derivative)

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        started = f", started by {self.start.name}" if self.start is not None and self.start.name else ""
        name, slow = self.recurrence.name, [self.start.velocities.partition(" (")[0]] if self.start else []
        told = [*(fault for fault in self.faults if not name.endswith(fault)), *filter(None, slow)]
        left = self.recurrence.left
        solved = f", its equations solved to {left:.1e}" if left > WELL_SOLVED else ""
        return "; ".join([f"it is {name}{started}{solved}", *told])

    @property
    def across(self) -> str:
        """What is seen of steps of several lengths, in words."""
        if self.order_across is None:
            return ONE_SIZE
        return f"the first step after a change of h has order {self.order_across}"

    @property
    def slow_across(self) -> str:
        """The same if the order is less than that of the recurrence; else ""."""
        facts, seen = self.recurrence.facts, self.order_across
        return self.across if facts is not None and seen is not None and seen < facts.order else ""

    @property
    def key(self) -> str | None:
        """The catalogue key of the method; None if it is none, or if F is evaluated elsewhere."""
        found = self.recurrence
        return found.method.key if found.method is not None and not found.asked else None

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence: titles with lines."""
        facts, orders = self.recurrence.facts, []
        if facts is not None:
            power, left = facts.order_fails
            orders = [f"order {facts.order} of the recurrence: on y = t^{power}/{power}! it leaves the residual {left}"]
        return [
            ("Recurrence", [*self.recurrence.lines[:-1], self.across]),
            ("Order", orders),
            ("Start", self.start.lines if self.start else [_HANDED if self.handed else _NO_START]),
        ]

    @property
    def data(self) -> dict[str, Json]:
        """The recurrence, its order and its start for programs."""
        own, facts = self.recurrence.recurrence, self.recurrence.facts
        return {
            "method": self.key,
            "rho": [repr(x) for x in own.rho],
            "sigma": [repr(x) for x in own.sigma],
            "derivative": own.derivative,
            "order": None if facts is None else facts.order,
            "start": None if self.start is None else list(self.start.methods),
            "measured_order": None if self.start is None else self.start.order,
            "remarks": [self.start.velocities] if self.start is not None and self.start.velocities else [],
        }

    def criteria(self, method: Multistep) -> list[Criterion]:
        """The criteria of a method: the recurrence, where F is evaluated, the start, the orders of whole runs.

        Velocities that are right half a step beside leave it open, as in a leapfrog that means them so; those that are
        differences of positions do not count.
        """
        found, start = self.recurrence, self.start
        same = found.method is not None and (found.method.rho, found.method.sigma) == (method.rho, method.sigma)
        near = found.recurrence.differences(method) if not same else None
        differences = [f"not that of {method.key}", *(near or ())]
        lines = [*([] if same else differences), *found.lines[:-1], self.across]
        checks = [Criterion("Recurrence", same, tuple(lines), {})]
        if not same:
            return checks
        at = found.asked or "F is evaluated at the states that it returns"
        checks.append(Criterion("Right-hand side", not found.asked, (at,), {}))
        if self.handed:
            return [*checks, Criterion("Start", True, (_HANDED,), {})]
        if start is None:
            return [*checks, Criterion("Start", None, (_NO_START,), {}, _WITH_START)]
        fault, order, needed = self._start_fault, method.claimed_order, "smaller roundoff"
        lines = [*filter(None, [fault]), *start.lines]
        begun = False if fault else None if start.power is None else True
        reached = None if start.order is None else start.order >= order
        line = f"{method.key} has order {order}; in whole runs order {start.order} is observed"
        ends = Criterion("Order", reached, (line,), {"measured": start.order}, needed)
        speeds = (
            [Criterion(VELOCITIES, start.meant, (start.velocities,), {}, _AT_ITS_TIMES)] if start.velocities else []
        )
        return [*checks, Criterion("Start", begun, tuple(lines), {}, needed), ends, *speeds]


# The lines for copies that share their memory, so that no run begins anew, and for slopes handed in.
_NO_START = "its start was not seen: copies share its memory, as with a module variable, or it cannot be restarted"
_HANDED = "its start is left to the caller, who hands it the earlier slopes from the first step on"
VELOCITIES, _AT_ITS_TIMES = "Velocities", "those at the times of the positions, such as (x[n+1] - x[n-1])/(2 h)"
_WITH_START = "a stepper that keeps its memory in an object of its own"


def read_multistep(subject: ForeignStepper, asked: Multistep | None = None) -> MultistepReading:
    """Read the recurrence and the start of a stepper. Raises NotReadable, UnsupportedCall, Misbehaviour."""
    runs = MarkedRuns.of(subject)
    recurrence = read_recurrence(runs, asked)
    start, handed, across = None, isinstance(subject.function, HandedSlopes) and subject.function.handed, None
    with suppress(Misbehaviour, UnsupportedCall):
        across = order_across(subject, recurrence.facts.order if recurrence.facts else 0)
    with suppress(Misbehaviour):
        start = read_start(runs, recurrence) if not handed and runs.begins_anew() else None
    return MultistepReading(recurrence, start, handed, across)
