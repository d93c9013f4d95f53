"""The coefficients of a Runge-Kutta step, read from its floats by answering its right-hand side with 0 and 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain
from math import fsum
from typing import Any, NamedTuple

from driftproof.blackbox.findings import first_taken
from driftproof.blackbox.probes import scripted_answers as scripted
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients
from driftproof.symbolic.rounding.formats import FloatFormat

NO_POWER = -1
# No method of the catalogue makes more calls in a step; a fixed number of iterations often does.
_MOST_SHOWN = 40


def unless_long(lines: list[str], calls: int) -> list[str]:
    """The lines of a table, or what is said in their place if a step makes too many calls."""
    return lines if calls <= _MOST_SHOWN else [f"A, b and c are not shown: a step makes {calls} calls"]


@dataclass(frozen=True)
class StageSolution:
    """How far a step is off because its stages are not solved: for an f linear in y, and for a nonlinear one.

    `power` is 0 unless the number of calls is the same however nonlinear f is. The error is then like that power of the
    nonlinearity, or `power` is NO_POWER if too little is left to tell. `skipped` if a slope of exactly 0 ends the step.
    """

    linear: float
    curved: float
    power: int = 0
    skipped: bool = False

    @property
    def words(self) -> str:
        """The finding in one line."""
        if self.skipped:
            return "where the slope of a stage is exactly 0, its stages are not solved"
        if not self.power:
            return f"its stages are solved to {max(self.linear, self.curved):.1e}, also on nonlinear problems"
        early = f"its solver stops early: where f is nonlinear, a step is off by {self.curved:.1e}, and"
        if self.power == NO_POWER:
            return f"{early} the number of calls does not depend on the nonlinearity"
        newton = {1: "one iteration of Newton's method", 3: "two iterations of Newton's method"}.get(self.power, "")
        kept = f"{self.power} with one Jacobian" if self.power > 1 else ""
        after = " or ".join(filter(None, [newton, kept]))
        return f"{early} that is like the power {self.power} of the nonlinearity, as after {after}"


@dataclass(frozen=True)
class TableauReading:
    """The step's own float coefficients: call i is made at t + cᵢh and y + h Σ aᵢⱼ kⱼ, the result is y + h Σ bⱼ kⱼ.

    kⱼ is the answer to call j; calls are stages, in the order in which they are made. `c` is None if the right-hand
    side is given no time. `probes.estimate` reads an embedded row of weights from what a step returns after y1.
    `remarks` are lines on what else was seen, `amplitude` is the size of the numbers that went in. For implicit stages,
    which are not single calls, `solved` says how well they are solved, and `stage_error` how far the coefficients may
    be off for that reason.
    """

    a: tuple[scripted.CoefficientRow, ...]
    b: scripted.CoefficientRow
    c: scripted.CoefficientRow | None
    format: FloatFormat
    remarks: tuple[str, ...] = ()
    amplitude: float = 1.0
    stage_error: float = 0.0
    solved: StageSolution | None = None

    @property
    def calls(self) -> int:
        """How often the right-hand side is called in a step; for implicit stages, their number."""
        return len(self.b)

    @property
    def implicit(self) -> bool:
        """True if the stages are solved for."""
        return self.solved is not None

    @property
    def rounding(self) -> scripted.Rounding:
        """How far coefficients may be off, including four times the difference of two readings of implicit stages."""
        return scripted.Rounding(self.format, self.calls, 4 * self.stage_error)

    @property
    def unused(self) -> tuple[int, ...]:
        """The calls, from 0, whose answers this step does not use: those for a next step or an error estimate."""
        columns = range(self.calls)
        return tuple(j for j in columns if not self.b[j] and not any(row[j] for row in self.a))

    @property
    def stages(self) -> StageCoefficients:
        """The coefficients as exact numbers; if times are given, the weights stand twice, so that c counts as well."""
        *a, b = (tuple(map(Fraction, row)) for row in (*self.a, self.b))
        if self.c is None:
            return StageCoefficients(tuple(a), (b,), tuple(Fraction(0) for _ in b))
        return StageCoefficients(tuple(a), (b, b), tuple(map(Fraction, self.c)))

    @property
    def lines(self) -> list[str]:
        """The reading as lines, each coefficient as the fraction that it is the rounding of, if that is convincing."""
        shown = self.a if self.implicit else tuple(row[:i] for i, row in enumerate(self.a))
        named = [*([] if self.c is None else [("c", self.c)]), *((f"a[{i}]", row) for i, row in enumerate(shown))]
        text = lambda x: coefficient_text(x, self.format, self.rounding.besides)
        rows = [f"{name} = {', '.join(map(text, row))}" for name, row in [*named, ("b", self.b)] if row]
        rows = unless_long(rows, self.calls)
        unused = [f"call {j} is made, and its answer is not used" for j in self.unused]
        clock = ["the right-hand side receives no time"] if self.c is None else []
        solved = [] if self.solved is None else [self.solved.words]
        return [*rows, *unused, *clock, *solved, *self.remarks]


def read_tableau(subject: ForeignStepper) -> TableauReading:
    """The A, b and c of a step(f, t, y, h), exactly the floats that the code multiplies by.

    From t = 0, y = 0 with h = 1, call j is answered by 1 and every other one by 0. Products by h and by the answer and
    sums with zeros are then exact, and the places of the calls and the result are the coefficients. A code that
    multiplies first and divides later, such as h(k₁ + 2k₂ + 2k₃ + k₄)/6, has the quotients as its coefficients. Further
    steps check that the coefficients account for everything.

    Raises NotReadable, saying what was seen, for a step that is adaptive, iterates, limits or remembers, and
    UnsupportedCall if the stepper takes no right-hand side.
    """
    reading, remarks = scripted.read_at_some_size(lambda amplitude: TableauProbe(subject, amplitude).reading())
    return replace(reading, remarks=(*remarks, *reading.remarks))


def is_explicit(a: Sequence[Sequence[float]]) -> bool:
    """True if no stage depends on itself, directly or through others."""
    left = set(range(len(a)))
    while ready := {i for i in left if not any(a[i][j] for j in left)}:
        left -= ready
    return not left


class ScriptedStep(NamedTuple):
    """The times (None if none was passed on) and places of one step's calls, and its result."""

    times: list[float | None]
    places: list[list[float]]
    result: list[float]

    @property
    def numbers(self) -> list[float]:
        """All numbers seen."""
        return [*(t for t in self.times if t is not None), *(x for y in (*self.places, self.result) for x in y)]


class TableauProbe:
    """Steps of one subject with scripted answers, on as many numbers of y as it takes, at most four."""

    def __init__(self, subject: ForeignStepper, amplitude: float) -> None:
        """Make a first step with all slopes 0. Raises NotReadable if it calls nothing, or moves."""
        self.subject, self.amplitude = subject, amplitude
        sizes = range(len(_PARTS), 0, -1)
        self.size, self.silent = first_taken(lambda size: (size, self.run(size, [], scripted.AT_REST)), sizes)
        self.calls = len(self.silent.places)
        if not self.calls:
            raise scripted.NotReadable("the right-hand side is never called")
        scripted.require_same(self.rounding, self.silent.numbers, self.run(self.size, [], scripted.AT_REST).numbers)
        for number in chain(*self.silent.places, self.silent.result):
            if number:
                through = f"the step goes through {number:.6g}"
                raise scripted.NotReadable(f"with all slopes 0, y = 0 does not stay 0: {through}", scripted.MOVES)

    def reading(self) -> TableauReading:
        """The coefficients, after all controls."""
        columns = [self._column(j) for j in range(self.calls)]
        *a, b = (tuple(column[i] for column in columns) for i in range(self.calls + 1))
        clock = tuple(t for t in self.silent.times if t is not None)
        c = clock if len(clock) == self.calls else None
        first = self._controlled(scripted.CONTROLS[0])  # after the last column, then after a step with all slopes 0
        self.run(self.size, [], scripted.AT_REST)
        scripted.require_same(self.rounding, first.numbers, self._controlled(scripted.CONTROLS[0]).numbers)
        reading = TableauReading(tuple(a), b, c, self.subject.format, amplitude=self.amplitude)
        for control in scripted.CONTROLS:
            self._check(reading, control)
        return replace(reading, remarks=scripted.remarks_of(lambda: self._check(reading, scripted.BACKWARD)))

    def run(self, size: int, answers: Sequence[Sequence[float]], control: scripted.Control) -> ScriptedStep:
        """One step on `size` numbers, in which call j is answered by answers[j], and later calls by 0."""
        script = scripted.Script([[self.amplitude * x for x in k] for k in answers], [0.0] * size)
        clock = float(control.time)

        def rate(t: float, y: Sequence[float]) -> Any:
            # If the stepper passes on no time, t is the very object `clock`.
            return script((None if t is clock else t, list(y)))

        start = [self.amplitude * y for y in starts(control, size)]
        result = scripted.result_of(lambda: self.subject.step_field(rate, clock, start, control.h))
        places = [[x / self.amplitude for x in y] for _, y in script.calls]
        return ScriptedStep([t for t, _ in script.calls], places, [x / self.amplitude for x in result])

    def _column(self, j: int) -> list[float]:
        """What the answer 1 to call j adds to the place of each call and to the result."""
        answers = [[x, *[0.0] * (self.size - 1)] for x in scripted.unit(self.calls, j)]
        run = self.run(self.size, answers, scripted.AT_REST)
        scripted.require_calls(self.calls, len(run.places))
        column = [numbers[0] for numbers in (*run.places, run.result)]
        if any(column[: j + 1]):
            raise scripted.NotReadable(
                f"call {j} or an earlier one depends on the answer to call {j}: the step remembers"
            )
        if any(number for numbers in (*run.places, run.result) for number in numbers[1:]):
            raise scripted.NotReadable("the slope of one component of y moves another one")
        return column

    def _controlled(self, control: scripted.Control) -> ScriptedStep:
        run = self.run(self.size, list(zip(*self.slopes(control), strict=True)), control)
        scripted.require_calls(self.calls, len(run.places))
        return run

    def slopes(self, control: scripted.Control) -> list[list[float]]:
        """The answers of a control: for each number of y, those to all calls."""
        first = scripted.varied(self.calls, control.salt)
        return [[part * k for k in first] for part in _PARTS[: self.size]]

    def _check(self, reading: TableauReading, control: scripted.Control) -> None:
        """Raise NotReadable unless one more step goes as the coefficients say."""
        run, slopes = self._controlled(control), self.slopes(control)
        seen = [*run.places, run.result]
        for component, (y, answers) in enumerate(zip(starts(control, self.size), slopes, strict=True)):
            asked = control._replace(broken=_UNLIKE) if component else control
            self._compare(reading, asked, y, answers, [numbers[component] for numbers in seen])
        if reading.c:
            self._compare_times(reading.c, control, run)

    def _compare(
        self,
        reading: TableauReading,
        control: scripted.Control,
        y: float,
        answers: Sequence[float],
        seen: Sequence[float],
    ) -> None:
        rows = (*reading.a, reading.b)
        terms = [max(abs(row[j]) for row in rows) * abs(k) for j, k in enumerate(answers)]
        # Twice: the coefficients read are rounded as much as the step that is compared with them.
        allowed = self.rounding.of(2 * (abs(y) + abs(control.h) * sum(terms)))
        for i, (row, number) in enumerate(zip(rows, seen, strict=True)):
            said = y + control.h * fsum(x * k for x, k in zip(row, answers, strict=True))
            name = f"y of call {i}" if i < self.calls else "the result"
            scripted.require_predicted(control, name, number, said, allowed)

    def _compare_times(self, nodes: Sequence[float], control: scripted.Control, run: ScriptedStep) -> None:
        allowed = self.rounding.of(2 * (abs(control.time) + abs(control.h) * max(map(abs, nodes))))
        for i, (node, seen) in enumerate(zip(nodes, run.times, strict=False)):
            said = control.time + control.h * node
            scripted.require_predicted(control, f"the time of call {i}", said if seen is None else seen, said, allowed)

    @property
    def rounding(self) -> scripted.Rounding:
        """How far rounding may carry a number of this step."""
        return scripted.Rounding(self.subject.format, self.calls)


_UNLIKE = "the components of y are not advanced alike, or not linearly in their slopes"
# Each number of y as a multiple of the first, and so its slopes: powers of two keep all products exact.
_PARTS = (1.0, -1.0, 0.5, -0.25)


def starts(control: scripted.Control, size: int) -> list[float]:
    """The numbers of y from which a control starts."""
    return [part * control.start + 0.0 for part in _PARTS[:size]]  # 0.0, not -0.0
