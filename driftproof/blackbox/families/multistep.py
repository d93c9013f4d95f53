"""Multistep steppers: which linear multistep method it is, how it starts, and the order that comes of it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb

from driftproof.blackbox.checks.determinism import MANY
from driftproof.blackbox.families import multistep_recurrence as recurrences
from driftproof.blackbox.families.imex import WELL_SOLVED
from driftproof.blackbox.families.multistep_runs import Across, MarkedRuns, course, order_across
from driftproof.blackbox.families.second_answers import WithEstimate, judged_second
from driftproof.blackbox.findings import Misbehaviour, StepFinding, UnsupportedCall
from driftproof.blackbox.judging.measured_order import CLEARANCE, order_seen, power_of_errors, slopes_text
from driftproof.blackbox.judging.nonlinear_problems import START, NonlinearProblem, field_problem, force_problem
from driftproof.blackbox.matching.match import match_tableau, matched
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, STANDARD_ORDER, CallingConvention
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber, as_array
from driftproof.blackbox.stepper.states.handed_slopes import HandedSlopes
from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.methods.names import BASHFORTH_MOULTON
from driftproof.support.plain_text import Json

# The step sizes h = 2**-k of first steps and of whole runs, and the length of these runs.
_FIRST, _WHOLE, _LENGTH = range(2, 10), range(4, 10), 0.5
# A power of two, over which differences are divided without rounding.
_SHORT = 2.0**-6


_HALVES = (Fraction(1, 2), Fraction(1, 2))


@dataclass(frozen=True)
class Corrected(Multistep):
    """The Adams-Moulton method `corrector`, corrected P(EC)ᵐE from the prediction of Adams-Bashforth of the same order.

    >>> Corrected.named("ABM4").key
    'adams_moulton3, corrected once from the prediction of adams_bashforth4 (PECE)'
    """

    corrector: Multistep | None = None

    @classmethod
    def named(cls, name: object) -> Corrected | None:
        """The method called abm4, Adams-Bashforth-Moulton 4 (PECE), abm4-PECECE or the like; None for another name."""
        if not (found := BASHFORTH_MOULTON.fullmatch(str(name).strip().lower())):
            return None
        order, often = int(found[1]), len(found[2] or "ec") // 2
        plain = FURTHER_METHODS[f"adams_moulton{order - 1}"] if order > 2 else None
        if not isinstance(plain, Multistep):
            plain = replace(recurrences.FORWARD_EULER, key="trapezoid", claimed_order=2, sigma=_HALVES)
        predictor = f"adams_bashforth{order}"
        given = {each.name: getattr(plain, each.name) for each in fields(plain)}
        key = recurrences.corrected_name(plain.key, predictor, often)
        return cls(**{**given, "key": key}, corrector=plain)


@dataclass(frozen=True)
class StartReading:
    """The methods of the first steps, "" for an unknown one, and the powers of h that the errors follow.

    `power` is that of the starting values, `order` that of the end of whole runs; None if none is seen. A method of
    order p needs the power p for both, and p + 1 for the starting values of y'' = F(y). There both are of positions,
    and `velocities` says what is seen of the velocities if that is less. They are `meant` if they are differences of
    positions, and may be, which is None, if they are right half a step beside.
    """

    methods: tuple[str, ...]
    power: int | None
    slopes: tuple[float, ...]
    order: int | None
    order_slopes: tuple[float, ...]
    problem: str
    velocities: str = ""
    meant: bool | None = False

    @property
    def name(self) -> str:
        """The methods of the first steps by name; "" if one is unknown."""
        named = list(dict.fromkeys(self.methods))
        return " and ".join(named) if named and all(named) else ""

    @property
    def lines(self) -> list[str]:
        """The methods and the powers as lines."""
        steps = [f"step {i} is {name or 'not a step of a known method'}" for i, name in enumerate(self.methods, 1)]
        power = "like no power of h" if self.power is None else f"like h^{self.power}"
        return [
            *steps,
            f"the errors of its first values fall {power} (slopes: {slopes_text(self.slopes)})",
            f"{order_seen(self.order)} in whole runs, the start included, on {self.problem} "
            f"(slopes: {slopes_text(self.order_slopes)})",
            *filter(None, [self.velocities]),
        ]

    def fault(self, order: int, derivative: int) -> str:
        """The fault of a start that is not accurate enough for a method of this order; "" if it is."""
        if self.power is None or self.power >= order + derivative - 1:
            return ""
        whole = f"whole runs have order {self.order}" if self.order is not None else "that limits whole runs"
        return f"its start is too inaccurate: first errors are like h^{self.power}, and {whole}, not {order}"


@dataclass(frozen=True)
class MultistepReading(WithEstimate):
    """The recurrence of a stepper's steps, and its start if that was seen.

    A stepper that is `handed` the slopes before its first step has no start of its own. `first_across` is the
    first step after a change of h.
    """

    recurrence: recurrences.RecurrenceReading
    start: StartReading | None
    handed: bool
    first_across: Across | None
    estimate: StepFinding | None = None

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
        elif self.recurrence.asked and facts and self.start and not found and (self.start.order or 9) < facts.order:
            found.append(f"{order_seen(self.start.order)} in whole runs, not {facts.order}")
        return found

    @property
    def _start_fault(self) -> str:
        facts = self.recurrence.facts
        if self.start is None or facts is None or facts.order < 1:
            return ""
        return self.start.fault(facts.order, self.recurrence.recurrence.derivative)

    @property
    def named(self) -> bool:
        """True if the verdict names a method, exactly or nearly."""
        return self.recurrence.named

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        started = f", started by {self.start.name}" if self.start is not None and self.start.name else ""
        name, slow = self.recurrence.name, [self.start.velocities.partition(" (")[0]] if self.start else []
        told = [*(fault for fault in self.faults if not name.endswith(fault)), *filter(None, slow)]
        left = self.recurrence.left
        solved = f", its equations solved to {left:.1e}" if left > WELL_SOLVED else ""
        return "; ".join([f"it is {name}{started}{solved}", *told, *self.of_estimate(None)])

    @property
    def across(self) -> str:
        """What is seen of steps of several lengths, in words."""
        if self.first_across is None:
            return recurrences.ONE_SIZE
        return f"the first step after a change of h has order {self.first_across.order}"

    @property
    def slow_across(self) -> str:
        """The same if the order is less than that of the recurrence; else ""."""
        facts, seen = self.recurrence.facts, self.first_across
        return self.across if facts is not None and seen is not None and seen.order < facts.order else ""

    @property
    def key(self) -> str | None:
        """The catalogue key of the method, or the short name of one that is corrected; None for another.

        If F is evaluated elsewhere, it is another.
        """
        found = self.recurrence
        if found.predictor is not None:
            short = f"abm{found.predictor.steps}{'-PECECE' * (found.corrections > 1)}"
            known = Corrected.named(short)
            return short if known is not None and known.key == found.name else None
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
            "remarks": [*filter(None, [self.start and self.start.velocities]), *self.of_estimate(None)],
        }

    def criteria(self, method: Multistep) -> list[Criterion]:
        """The criteria of a method: the recurrence, where F is evaluated, the start, the orders of whole runs.

        Velocities that are right half a step beside leave it open, as in a leapfrog that means them so; those that are
        differences of positions do not count.
        """
        found, start = self.recurrence, self.start
        same = found.method is not None and (found.method.rho, found.method.sigma) == (method.rho, method.sigma)
        near = found.recurrence.differences(method) if not same and found.untimed is None else None
        differences = [f"not that of {method.key}", *(near or ())]
        lines = [*([] if same else differences), *found.lines[:-1], self.across]
        checks = [Criterion("Recurrence", same, tuple(lines), {})]
        if not same:
            return checks
        at, placed = found.asked or "F is evaluated at the states that it returns", not found.asked
        if isinstance(method, Corrected):
            placed, at = found.name == method.key, at if found.predictor is None else f"it is {found.name}"
        checks.append(Criterion("Right-hand side", placed, (at,), {}))
        if self.slow_across and self.first_across and not self.first_across.plain:
            seen = f"{self.across}, though it takes account of the change"
            checks.append(Criterion(ACROSS, None, (seen,), {}, f"the order {method.claimed_order} there as well"))
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
ACROSS = "Change of h"
VELOCITIES, _AT_ITS_TIMES = "Velocities", "those at the times of the positions, such as (x[n+1] - x[n-1])/(2 h)"
_WITH_START = "a stepper that keeps its memory in an object of its own"


def read_multistep(subject: ForeignStepper, asked: Multistep | None = None) -> MultistepReading:
    """Read the recurrence and the start of a stepper. Raises NotReadable, UnsupportedCall, Misbehaviour."""
    runs = MarkedRuns.of(subject)
    recurrence = recurrences.read_recurrence(runs, asked)
    start, handed = None, isinstance(subject.function, HandedSlopes)
    across, estimate = None, None
    with suppress(Misbehaviour, UnsupportedCall):
        own = recurrence.recurrence
        across = order_across(subject, recurrence.facts.order if recurrence.facts else 0, own.rho, own.sigma)
    with suppress(Misbehaviour):
        start = read_start(runs, recurrence) if not handed and runs.begins_anew() else None
    with suppress(UnsupportedCall):
        alone = subject.fresh(subject.shortest)
        estimate = judged_second(alone, alone)
    return MultistepReading(recurrence, start, handed, across, estimate)


def read_start(runs: MarkedRuns, reading: recurrences.RecurrenceReading) -> StartReading:
    """Identify the first steps of runs that satisfy this recurrence later, and measure the errors that they leave.

    Raises the Misbehaviour that comes instead of a step.
    """
    length, subject = reading.recurrence.steps - 1 + reading.late, runs.subject
    trial = subject.fresh(subject.shortest)
    problem = force_problem(trial) if subject.convention.kind == FORCE else field_problem(trial)
    noise = CLEARANCE * float(subject.format.u)
    firsts = [_errors(subject, problem, 2.0**-k, max(length, 1))[0] for k in _FIRST]
    ends: list[list[float]] = []
    with suppress(Misbehaviour):  # a solver with a fixed number of steps makes no longer runs
        ends += (_errors(subject, problem, 2.0**-k, round(_LENGTH * 2**k)) for k in _WHOLE)
    power, slopes = power_of_errors(firsts, [noise] * len(firsts))
    (order, order_slopes), *rest = (power_of_errors(x, [noise] * len(x)) for x in [*zip(*ends, strict=True)] or [()])
    if not (order and rest and (rest[0][0] or 0) < order):
        return StartReading(_methods(runs, length), power, slopes, order, order_slopes, problem.words)
    times = zip(rest[1:], ("before", "after"), strict=True)
    when = next((f": those of half a step {word}" for (seen, _), word in times if (seen or 0) >= order), "")
    meant = None if when else False
    # Are they the differences of the positions over its short step, to the last bit?
    n, states = problem.positions, course(subject, problem, START, problem.start(START), _SHORT, MANY)
    pairs = [zip(a, b[:n], b[n:], strict=False) for a, b in pairwise(states)]
    if all((after - before) / _SHORT == v for each in pairs for before, after, v in each):
        meant, when = True, ": differences of positions"
    words = f"{order_seen(rest[0][0])} in its velocities{when} (slopes: {slopes_text(rest[0][1])})"
    return StartReading(_methods(runs, length), power, slopes, order, order_slopes, problem.words, words, meant)


def _methods(runs: MarkedRuns, length: int) -> tuple[str, ...]:
    """The method of each first step: that of the very first again, or a multistep method of fewer steps."""
    if not length:
        return ()
    first, steps = _one_step(runs.subject), runs.run(max(length + 1, runs.subject.shortest), bent=not runs.by_place)
    problem, found = runs.problem(1.0, 0.0, bent=not runs.by_place), [first]
    allowed = CLEARANCE * float(runs.subject.format.u)
    for n in range(1, length):
        shorter = [m for m in recurrences.candidates(runs.derivative) if m.steps == n + 1]
        left = [(recurrences.Recurrence.of(m, runs.subject.format), m) for m in shorter]
        kept = [m.key for r, m in left if r.left(steps)[0] <= max(r.rounding, recurrences.tolerance_of(m))]
        if not kept and runs.derivative == 1:
            state = [*steps.states[n], *([float(n)] if runs.clock else [])]
            alone = course(runs.subject, problem, float(n), state, 1.0, runs.subject.shortest)[1]
            pairs = zip(alone, steps.states[n + 1], strict=False)
            kept = [first] * all(abs(float(x) - y) <= allowed * max(1.0, abs(y)) for x, y in pairs)
        found += kept[:1] or [""]
    return tuple(found)


def _one_step(subject: ForeignStepper) -> str:
    """The method of the first step of a fresh copy; "" if it is not known."""
    steps = subject.shortest

    def first(*arguments: Any, **named: Any) -> Any:
        return subject.fresh().function(*arguments, **named)

    def begun(f: Callable[..., Any], t: AnyNumber, y: Any, h: AnyNumber) -> Any:
        fresh, adapter, size = subject.fresh(steps), subject.adapter, as_array(y).size
        fresh.step_field(lambda at, z: adapter.read(f(at, adapter.write(z)), size), t, adapter.read(y, size), h)
        return adapter.write(fresh.log.states[1])

    alone = replace(subject, function=first)
    if steps > 1:
        alone = replace(subject, function=begun, convention=CallingConvention(FIELD, STANDARD_ORDER[FIELD]))
    try:
        reading = read_coefficients(alone)
        found, times = matched(reading).matches, ""
        if not found and isinstance(reading, TableauReading) and reading.c is not None:
            found, times = match_tableau(replace(reading, c=None)).matches, " called at wrong times"
        # Of methods with the same step, the one with the fewest stages: a further call may serve later steps.
        return min(found, key=lambda m: getattr(METHODS[m.key], "stages", 0)).name + times if found else ""
    except (NotReadable, UnsupportedCall, Misbehaviour):
        return ""


def _errors(subject: ForeignStepper, problem: NonlinearProblem, h: float, steps: int) -> list[float]:
    """The largest errors after this many steps: of all components; or if y'' = F, of positions and of velocities.

    Those of velocities half a step before and after follow.
    """
    end = course(subject, problem, START, problem.start(START), h, max(steps, subject.shortest))[steps]
    now, *beside = (problem.solution(arb(START) + h * (steps + shift)) for shift in (0.0, -0.5, 0.5))
    at = problem.positions or len(end)
    pairs = [(end[:at], now[:at]), *((end[at:], exact[at:]) for exact in (now, *beside))]
    off = ([abs(float(x) - float(y.mid())) for x, y in zip(*pair, strict=True)] for pair in pairs)
    return [max(part) for part in off if part]
