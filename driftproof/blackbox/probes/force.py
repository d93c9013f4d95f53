"""The coefficients of a step for q'' = F(q), read from its floats by answering its force with 0 and 1."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby
from math import fsum
from typing import Any, NamedTuple, TypeAlias

from driftproof.blackbox.probes import scripted_answers as scripted
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.tableau import StageSolution, is_explicit, unless_long
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced
from driftproof.symbolic.rounding.formats import FloatFormat

# Kicks and drifts in the order in which they are made, as in `driftproof.methods.schemes.Splitting`.
SubSteps: TypeAlias = tuple[tuple[str, float], ...]
NO_TABLEAU = "as a method for y' = f(t, y), it has no tableau"


@dataclass(frozen=True)
class ForceReading:
    """The step's own float coefficients on q'' = F(q), calls being stages, in the order in which they are made.

    Fᵢ is taken at q + cᵢhv + h² Σ aᵢⱼ Fⱼ; q₁ = q + drift·hv + h² Σ b_positionⱼ Fⱼ, v₁ = v + h Σ b_velocityⱼ Fⱼ. The
    drift of a method is 1. `amplitude` is the size of the numbers that went in. `refused` is the reason why there is no
    tableau, if one was asked for; `wrong_time` describes a call that is given another time than t + cᵢh, if times are
    given. For a force of position and velocity, `a_velocity` are the rows ãᵢⱼ of the velocities v + h Σ ãᵢⱼ Fⱼ that it
    is given. `solved` and `stage_error` are those of implicit stages, as in a `TableauReading`.
    """

    c: scripted.CoefficientRow
    a: tuple[scripted.CoefficientRow, ...]
    b_position: scripted.CoefficientRow
    b_velocity: scripted.CoefficientRow
    drift: float
    format: FloatFormat
    remarks: tuple[str, ...] = ()
    amplitude: float = 1.0
    refused: str = ""
    wrong_time: str = ""
    a_velocity: tuple[scripted.CoefficientRow, ...] | None = None
    stage_error: float = 0.0
    solved: StageSolution | None = None

    @property
    def calls(self) -> int:
        """How often the force is called in a step."""
        return len(self.c)

    @property
    def rounding(self) -> scripted.Rounding:
        """How far the coefficients may be off."""
        return scripted.Rounding(self.format, self.calls, 4 * self.stage_error)

    @property
    def implicit(self) -> bool:
        """True if positions are solved for; velocities alone may be solved for as well."""
        return self.solved is not None and not is_explicit(self.a)

    @property
    def unused(self) -> tuple[int, ...]:
        """The calls, from 0, whose answers this step does not use: those for a next step, say."""
        rows = (*self.a, self.b_position, self.b_velocity)
        return tuple(j for j in range(self.calls) if not any(row[j] for row in rows))

    @property
    def stages(self) -> StageCoefficients:
        """The coefficients without the drift, as exact numbers."""
        rows = [tuple(map(Fraction, row)) for row in (*self.a, self.b_position, self.b_velocity)]
        return StageCoefficients(tuple(rows[:-2]), (rows[-2], rows[-1]), tuple(map(Fraction, self.c)))

    @property
    def parts(self) -> SubSteps | None:
        """The step as kicks v ← v + x·h·F(q) and drifts q ← q + x·h·v, or None if it is not a composition of these.

        Neighbours of one kind are merged, zeros are left out. The drift after a kick is a quotient of coefficients.
        """
        if self.implicit:
            return None
        stages: Any = reduced(self.stages)  # its entries are fractions, not numbers of a field
        b_position, kicks = stages.weights
        ends = [*zip(stages.c, stages.a, strict=True), (Fraction(self.drift), b_position)]
        length = max(1, *(abs(c) for c, _ in ends))
        for i, (end, row) in enumerate(ends):
            for node, moved, kick in list(zip(stages.c, row, kicks, strict=True))[:i]:
                # A kick y at time c moves each later place by y times the drift since: aᵢⱼ = yⱼ (cᵢ - cⱼ).
                if abs(moved - kick * (end - node)) > self.rounding.of(float(4 * length * abs(kick))):
                    return None
        word = groupby((part for part in _word(kicks, ends) if part[1]), key=lambda part: part[0])
        return tuple((kind, fsum(x for _, x in run)) for kind, run in word)

    @property
    def lines(self) -> list[str]:
        """The reading as lines, each coefficient as the fraction that it is the rounding of, if that is convincing."""
        shown = self.a if self.implicit else tuple(row[:i] for i, row in enumerate(self.a))
        rows = [("c", self.c), *((f"a[{i}]", row) for i, row in enumerate(shown))]
        rows += [("b_position", self.b_position), ("b_velocity", self.b_velocity)]
        lines = [f"{name} = {', '.join(map(self._text, row))}" for name, row in rows if row]
        lines = unless_long(lines, self.calls)
        if self.parts is not None:
            steps = ", ".join(f"{kind} {coefficient_text(x, self.format)}" for kind, x in self.parts)
            lines = [f"sub-steps: {steps or 'none'}"]
        lines += [] if self.solved is None else [self.solved.words]
        lines += [f"call {j} is made, and its answer is not used" for j in self.unused]
        if abs(self.drift - 1) > self.rounding.of(1.0):
            lines.append(f"without a force the position moves by {self._text(self.drift)} h v, not by h v")
        lines += [f"call {i} is given the velocity {self._velocity(i)}" for i, _ in enumerate(self.a_velocity or ())]
        lines += [f"wrong times: {self.wrong_time}"] if self.wrong_time else []
        return [*lines, *self.remarks, *([f"{NO_TABLEAU}: {self.refused}"] if self.refused else [])]

    def _text(self, x: float) -> str:
        return coefficient_text(x, self.format, self.rounding.besides)

    def _velocity(self, i: int) -> str:
        """The velocity that call i is given, as "v + 1/2 h F[0]"."""
        row = enumerate(self.a_velocity[i] if self.a_velocity else ())
        terms = [f"{self._text(x)} h F[{j}]" for j, x in row if x]
        return " + ".join(["v", *terms]).replace("+ -", "- ").replace(" 1 h", " h")

    @property
    def velocities_limit_order(self) -> bool:
        """True if the order is 1 on forces of velocity, and at least 2 on q'' = F(t, q).

        The conditions of order 2 are Σ b̃ᵢ = 1, Σ b̃ᵢ cᵢ = Σ bᵢ = 1/2, and, for forces of velocity, Σ b̃ᵢ dᵢ = 1/2 with
        dᵢ = Σ ãᵢⱼ, because the velocity of call i is that of the time t + dᵢh.
        """
        if self.a_velocity is None:
            return False
        nodes, weights = [fsum(row) for row in self.a_velocity], self.b_velocity
        sums = [fsum(weights) / 2, _dot(weights, self.c), fsum(self.b_position), _dot(weights, nodes)]
        allowed = self.rounding.of(1 + sum(map(abs, (*weights, *self.c, *nodes, *self.b_position))))
        *others, of_velocity = [abs(x - 0.5) <= allowed for x in sums]
        return all(others) and not of_velocity

    @property
    def stale_velocities(self) -> list[str]:
        """A line on each call that is given a velocity of another time than its position."""
        found = []
        for i, (row, node) in enumerate(zip(self.a_velocity or (), self.c, strict=False)):
            if self.b_velocity[i] and abs(fsum(row) - node) > self.rounding.of(1 + abs(node) + sum(map(abs, row))):
                at = f"t + {self._text(node)} h" if node else "t"
                place = at.replace(" 1 h", " h")
                found.append(f"call {i} is given the position of {place} and the velocity {self._velocity(i)}")
        return found


def read_forces(subject: ForeignStepper) -> ForceReading:
    """The coefficients of a step(force, q, v, h), or of a step(f, t, y, h) with y = [q, v], as exact floats.

    With h = 1, one of q, v and the answers is 1 and all others are 0. Products by h and by that number and sums with
    zeros are then exact, and the places of the calls and the result are the coefficients, up to the roundings of
    products among themselves. Further steps check that the coefficients account for everything.

    Raises NotReadable, saying what was seen, for a step that is adaptive, iterates, limits or remembers, or that has
    drag or a force of its own; UnsupportedCall if the stepper takes no force.
    """
    reading, remarks = scripted.read_at_some_size(lambda amplitude: _Probe(subject, amplitude).reading())
    return replace(reading, remarks=(*remarks, *reading.remarks))


class _Run(NamedTuple):
    """The places at which one step called the force, and its result; times are None if none were passed on.

    `velocities` are those that the force was given, minus the one that the step starts with.
    """

    places: list[float]
    q: float
    v: float
    times: list[float | None]
    velocities: list[float]

    @property
    def numbers(self) -> list[float]:
        return [*self.places, self.q, self.v, *self.velocities]


class _Probe:
    """Steps of one subject with scripted forces."""

    def __init__(self, subject: ForeignStepper, amplitude: float) -> None:
        self.subject, self.amplitude = subject, amplitude
        silent = self._run(0.0, 0.0, [])
        self.calls = len(silent.places)
        if not self.calls:
            raise scripted.NotReadable("the force is never called")
        scripted.require_same(self._rounding, silent.numbers, self._run(0.0, 0.0, []).numbers)
        for number in silent.numbers:
            if number:
                raise scripted.NotReadable(
                    f"at rest at 0 and without a force, the step does not stay: it shows {number:.6g}"
                )

    def reading(self) -> ForceReading:
        still, moving = self._answered(1.0, 0.0, []), self._answered(0.0, 1.0, [])
        self._require_plain(still, moving)
        columns = [self._column(j) for j in range(self.calls)]
        a = tuple(tuple(column.places[i] for column in columns) for i in range(self.calls))
        b_position, b_velocity = tuple(x.q for x in columns), tuple(x.v for x in columns)
        first = self._controlled(scripted.CONTROLS[0])  # after the last column, then after a step without forces
        self._answered(0.0, 0.0, [])
        scripted.require_same(self._rounding, first.numbers, self._controlled(scripted.CONTROLS[0]).numbers)
        c, fmt = tuple(moving.places), self.subject.format
        a_velocity = None
        if self.subject.gives_velocities:
            a_velocity = tuple(tuple(column.velocities[i] for column in columns) for i in range(self.calls))
        reading = ForceReading(c, a, b_position, b_velocity, moving.q, fmt, (), self.amplitude, a_velocity=a_velocity)
        for control in scripted.CONTROLS:
            self._check(reading, control)
        wrong = (self._wrong_time(reading, control) for control in (scripted.AT_REST, *scripted.CONTROLS))
        remarks = scripted.remarks_of(lambda: self._check(reading, scripted.BACKWARD))
        return replace(reading, remarks=remarks, wrong_time=next(filter(None, wrong), ""))

    def _run(self, q: float, v: float, forces: Sequence[float], control: scripted.Control = scripted.AT_REST) -> _Run:
        size, clock, times = self.amplitude, float(control.time), list[float | None]()
        script, velocities = scripted.Script([size * force for force in forces], 0.0), list[float]()

        def force(t: float, x: Sequence[float], moving: Sequence[float] = ()) -> Sequence[float]:
            # If the stepper passes on no time, t is the very object `clock`.
            times.append(None if t is clock else t)
            velocities.extend(y / size - v for y in moving[:1])
            return [script(*x)]

        start, subject = ([size * q], [size * v]), self.subject
        stepped = subject.step_dragged if subject.gives_velocities else subject.step_forced
        q1, v1 = scripted.result_of(lambda: stepped(force, clock, *start, control.h))
        return _Run([x / size for x in script.calls], q1 / size, v1 / size, times, velocities)

    def _answered(
        self, q: float, v: float, forces: Sequence[float], control: scripted.Control = scripted.AT_REST
    ) -> _Run:
        run = self._run(q, v, forces, control)
        scripted.require_calls(self.calls, len(run.places))
        return run

    def _column(self, j: int) -> _Run:
        """What the answer 1 to call j adds to the place of each call and to the result."""
        run = self._answered(0.0, 0.0, scripted.unit(self.calls, j))
        if any(run.places[: j + 1]) or any(run.velocities[: j + 1]):
            raise scripted.NotReadable(
                f"call {j} or an earlier one depends on the answer to call {j}: the step remembers"
            )
        return run

    def _require_plain(self, still: _Run, moving: _Run) -> None:
        """Raise NotReadable if q or v is not kept without a force: by drag, a spring or a wall of its own."""
        allowed = self._rounding.of(1.0)
        weights = [(f"call {i} is made at", x, "q", 1.0) for i, x in enumerate(still.places)]
        weights += [("the new position is", still.q, "q", 1.0), ("the new velocity holds", still.v, "q", 0.0)]
        weights += [("the new velocity is", moving.v, "v", 1.0)]
        weights += [(f"call {i} is given the velocity", 1 + x, "v", 1.0) for i, x in enumerate(moving.velocities)]
        found = [f"{what} {x:.6g} {of}, not {said:g} {of}" for what, x, of, said in weights if abs(x - said) > allowed]
        if found:
            raise scripted.NotReadable(f"with h = 1 and without a force, {'; '.join(found)}")

    def _controlled(self, control: scripted.Control) -> _Run:
        return self._answered(*_start(control), scripted.varied(self.calls, control.salt), control)

    def _check(self, reading: ForceReading, control: scripted.Control) -> None:
        """Raise NotReadable unless one more step goes as the coefficients say."""
        (q, v), h, forces = _start(control), control.h, scripted.varied(self.calls, control.salt)
        run = self._controlled(control)
        in_position, in_velocity = self._allowed(reading, q, v, h, forces)
        rows = [*zip(reading.c, reading.a, strict=True), (reading.drift, reading.b_position)]
        for i, ((node, row), seen) in enumerate(zip(rows, [*run.places, run.q], strict=True)):
            name = f"the position of call {i}" if i < self.calls else "the new position"
            scripted.require_predicted(control, name, seen, q + h * (node * v + h * _dot(row, forces)), in_position)
        said = v + h * _dot(reading.b_velocity, forces)
        scripted.require_predicted(control, "the new velocity", run.v, said, in_velocity)
        for i, row in enumerate(reading.a_velocity or ()):
            name, added = f"the velocity of call {i}", h * _dot(row, forces)
            scripted.require_predicted(control, name, run.velocities[i] + v, v + added, in_velocity)

    def _wrong_time(self, reading: ForceReading, control: scripted.Control) -> str:
        """A line on the first call that is given another time than that of its position; "" if there is none."""
        allowed = self._rounding.of(2 * (abs(control.time) + abs(control.h) * max(map(abs, reading.c))))
        for i, (node, seen) in enumerate(zip(reading.c, self._controlled(control).times, strict=True)):
            if seen is not None and not abs(seen - control.time - control.h * node) <= allowed:
                said = control.time + control.h * node
                step = f"in a step of {control.h:g} from t = {control.time:g}"
                return f"{step}, call {i} passes the time {seen:.6g} with the position of the time {said:.6g}"
        return ""

    def _allowed(
        self, reading: ForceReading, q: float, v: float, h: float, forces: Sequence[float]
    ) -> tuple[float, float]:
        """How far a control's positions and its velocity may be off; the velocity may be formed from positions."""
        length = max(1.0, abs(reading.drift), *map(abs, reading.c))
        rows = (*reading.a, reading.b_position)
        pushes = [max(length * abs(kick), *(abs(row[j]) for row in rows)) for j, kick in enumerate(reading.b_velocity)]
        size = abs(q) + abs(h) * length * abs(v) + h * h * sum(x * abs(f) for x, f in zip(pushes, forces, strict=True))
        # Twice: the coefficients read are rounded as much as the step that is compared with them.
        return self._rounding.of(2 * size), self._rounding.of(2 * (abs(v) + 2 * size / abs(h)))

    @property
    def _rounding(self) -> scripted.Rounding:
        return scripted.Rounding(self.subject.format, self.calls)


def _start(control: scripted.Control) -> tuple[float, float]:
    return control.start, 3 - control.start / 2


def _dot(row: Sequence[float], forces: Sequence[float]) -> float:
    return fsum(x * f for x, f in zip(row, forces, strict=True))


def _word(kicks: Sequence[Any], ends: Sequence[tuple[Any, Any]]) -> Iterator[tuple[str, float]]:
    yield "drift", float(ends[0][0])
    for j, kick in enumerate(kicks):
        yield "kick", float(kick)
        # A quotient of two roundings is closer to the drift than a difference of two places, which may cancel.
        (start, _), (end, row) = ends[j : j + 2]
        yield "drift", float(row[j] / kick if kick else end - start)
