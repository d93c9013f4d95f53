"""The start of a multistep stepper: which method makes its first steps, and the order that their errors leave."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from flint import arb

from driftproof.blackbox.checks.determinism import MANY
from driftproof.blackbox.families.multistep_recurrence import Recurrence, RecurrenceReading, candidates, tolerance_of
from driftproof.blackbox.families.multistep_runs import MarkedRuns, course
from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.measured_order import CLEARANCE, order_seen, power_of_errors, slopes_text
from driftproof.blackbox.judging.nonlinear_problems import START, NonlinearProblem, field_problem, force_problem
from driftproof.blackbox.matching.match import match_tableau, matched
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.stepper.array_adapters import AnyNumber, as_array
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, STANDARD_ORDER, CallingConvention
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import METHODS

# The step sizes h = 2**-k of first steps and of whole runs, and the length of these runs.
_FIRST, _WHOLE, _LENGTH = range(2, 10), range(4, 10), 0.5
# A power of two, over which differences are divided without rounding.
_SHORT = 2.0**-6


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


def read_start(runs: MarkedRuns, reading: RecurrenceReading) -> StartReading:
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
    if _are_differences(course(subject, problem, START, problem.start(START), _SHORT, MANY), problem.positions):
        meant, when = True, ": differences of positions"
    words = f"{order_seen(rest[0][0])} in its velocities{when} (slopes: {slopes_text(rest[0][1])})"
    return StartReading(_methods(runs, length), power, slopes, order, order_slopes, problem.words, words, meant)


def _are_differences(states: Sequence[Sequence[AnyNumber]], positions: int) -> bool:
    """True if the velocities of a run are the differences of its positions over its short step, to the last bit."""
    pairs = [zip(a, b[:positions], b[positions:], strict=False) for a, b in pairwise(states)]
    return all((after - before) / _SHORT == v for each in pairs for before, after, v in each)


def _methods(runs: MarkedRuns, length: int) -> tuple[str, ...]:
    """The method of each first step: that of the very first again, or a multistep method of fewer steps."""
    if not length:
        return ()
    first, steps = _one_step(runs.subject), runs.run(max(length + 1, runs.subject.shortest), bent=not runs.by_place)
    problem, found = runs.problem(1.0, 0.0, bent=not runs.by_place), [first]
    allowed = CLEARANCE * float(runs.subject.format.u)
    for n in range(1, length):
        shorter = [m for m in candidates(runs.derivative) if m.steps == n + 1]
        left = [(Recurrence.of(m, runs.subject.format), m) for m in shorter]
        kept = [m.key for r, m in left if r.left(steps)[0] <= max(r.rounding, tolerance_of(m))]
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
