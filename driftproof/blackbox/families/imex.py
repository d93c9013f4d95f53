"""IMEX steppers, which solve for one of two right-hand sides: which method it is, and its order on their sum."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from driftproof.blackbox.families import family_walks as walks
from driftproof.blackbox.families.imex_step import IMEX_PARTS, ImexReading, read_imex_step
from driftproof.blackbox.families.second_answers import ESTIMATE, WithEstimate, embedded_row, judged_second
from driftproof.blackbox.findings import StepFinding
from driftproof.blackbox.judging.measured_order import MeasuredOrder, order_seen, slopes_text
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.walks import there_and_back
from driftproof.blackbox.probes.coefficients import coefficient_difference, coefficient_text
from driftproof.blackbox.probes.scripted_answers import CoefficientRow
from driftproof.blackbox.probes.stage_solutions import SOLVED
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.support.plain_text import Json
from driftproof.symbolic.additive import AdditiveFacts

# The step sizes at which errors are measured: h = 2**-k.
_HALVINGS = range(2, 9)
# In steps elsewhere a solver may leave this many times the error seen here, since it stops by the same change or
# residual; errors below the second number do not matter.
_SOLVER, WELL_SOLVED = 64, 2.0**-30


@dataclass(frozen=True)
class ImexIdentity(WithEstimate):
    """Both tables of a step, the key of the method that has them or "", the measured order, and a walk of steps."""

    reading: ImexReading
    known: str
    measured: MeasuredOrder
    walked: StepFinding | None = None
    estimate: StepFinding | None = None

    @property
    def faults(self) -> list[str]:
        """The faults under any method: nodes that are not the row sums of the tables, and a wrong error estimate."""
        return [*self._mistimed, *self.of_estimate(False)]

    @property
    def _mistimed(self) -> list[str]:
        reading, rounding = self.reading, self.reading.rounding
        if reading.c is None:
            return []
        found = []
        for i, (c, *rows) in enumerate(zip(reading.c, *reading.a, strict=True)):
            sums = [sum(row) for row in rows]
            if all(abs(x - c) > rounding.of(1 + sum(map(abs, row))) for x, row in zip(sums, rows, strict=True)):
                columns = ([*(row[i] for row in a), b[i]] for a, b in zip(reading.a, reading.b, strict=True))
                asked = [name for name, column in zip(IMEX_PARTS, columns, strict=True) if any(column)]
                which = f"the {asked[0]} function" if len(asked) == 1 else "stage"
                told = " and ".join(f"{x:.6g}" for x in dict.fromkeys(sums))
                found.append(f"{which} is evaluated at t + {c:.6g} h in stage {i}, whose rows add up to {told}")
        return found

    @property
    def key(self) -> str | None:
        """The catalogue key of the method, if it has no fault; else None."""
        return self.known if self.known and not self.faults else None

    @property
    def named(self) -> bool:
        """True if the verdict names a method."""
        return bool(self.known)

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        unknown = f"an IMEX method of {self.reading.stages} stages that is not in the catalogue"
        name = self.known or unknown
        solved = f", its stages solved to {self.reading.curved:.1e}" if self.reading.curved > WELL_SOLVED else ""
        words = f"it is {name}" + (solved if self.known else f", {self._orders[0]}")
        return "; ".join([words, *self.faults, *self.of_estimate(None)])

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence: titles with lines."""
        estimate = (ESTIMATE, self.of_estimate(True, False, None))
        return [("Coefficients", self._coefficients(self.known)), ("Order", self._orders), estimate]

    def _coefficients(self, key: str) -> list[str]:
        """Both tables as lines, for the method with this key, or for none if it is ""."""
        reading, slack = self.reading, self.reading.rounding.of(1.0)
        named = f"{key}: every entry within {slack:.1e}, the accuracy of its stage solver"
        rows: list[tuple[str, CoefficientRow]] = [] if reading.c is None else [("c", reading.c)]
        for part, a, b in zip(IMEX_PARTS, reading.a, reading.b, strict=True):
            rows += [(f"a_{part}[{i}]", row[: i + 1]) for i, row in enumerate(a) if any(row)]
            rows.append((f"b_{part}", b))
        texts = [f"{name} = {', '.join(coefficient_text(x, reading.format, slack) for x in row)}" for name, row in rows]
        curved = f"a step on nonlinear functions agrees with these stages to {reading.curved:.1e}"
        first = named if key else "no IMEX method of the catalogue"
        return [first, *texts, curved, *([] if reading.c else ["it receives no time"])]

    @property
    def _orders(self) -> list[str]:
        """The order by the tables (those of the method, or as read), together and alone, and the order measured."""
        known = next((m for m in _methods() if m.key == self.known), None)
        facts, measured = AdditiveFacts(known or _as_read(self.reading)), self.measured
        found = facts.orders_within(walks.NO_RESIDUAL) if facts.method.decimal else facts
        alone = f"its tables alone have order {found.explicit_order} and {found.implicit_order}"
        words = f"of order {found.order} on f + g, {alone}{', to the precision of its decimals' * facts.method.decimal}"
        if self._mistimed and measured.order is not None and measured.order < found.order:
            words += f", of order {measured.order} where g or f depends on t"
        slopes = f"(slopes of the local error: {slopes_text(measured.slopes)})"
        return [words, f"{order_seen(measured.order)} on {measured.problem}, split in two {slopes}"]

    @property
    def data(self) -> dict[str, Json]:
        """The tables and the order for programs."""
        reading, tables = self.reading, dict[str, Json]()
        for part, a, b in zip(IMEX_PARTS, reading.a, reading.b, strict=True):
            tables |= {f"a_{part}": [[repr(x) for x in row] for row in a], f"b_{part}": [repr(x) for x in b]}
        return {"method": self.key, **tables, "measured_order": self.measured.order, "remarks": self.of_estimate(None)}

    def criteria(self, method: Additive) -> list[Criterion]:
        """The criteria of a method: both tables, the nodes, the order, and how the steps go elsewhere."""
        found = _differences(method, self.reading)
        differing = [f"not those of {method.key}", *(found or [])[: walks.DIFFERENCES_SHOWN]]
        shown = self._coefficients(method.key) if found == [] else differing
        if found is None:
            shown.append(f"{method.key} has {len(_used(method))} stages with an effect, this one {self.reading.stages}")
        data: dict[str, Json] = {"differences": list(found or [])}
        order = self.measured.order
        reached = None if order is None else order >= method.claimed_order
        checks = [
            Criterion("Coefficients", found == [], tuple(shown), data),
            Criterion("Times", not self._mistimed, tuple(self._mistimed or ["the times are those of its stages"]), {}),
            Criterion("Order", reached, tuple(self._orders), {"measured": order}),
        ]
        if found == [] and self.reading.curved > SOLVED:
            early = f"its equations are solved to {self.reading.curved:.1e} only"
            checks.append(Criterion("Stages", False, (early,), {}))
        elif found == [] and not self._mistimed and self.walked is not None:
            checks.append(Criterion("Steps", self.walked.holds, (self.walked.words,), {}))
        return [*checks, *(self.criteria_of_estimate if found == [] else [])]


def read_imex(subject: ForeignStepper, asked: Additive | None = None) -> ImexIdentity:
    """Identify a step of two right-hand sides. Raises NotReadable, UnsupportedCall, or the stepper's Misbehaviour."""
    reading = _in_order(read_imex_step(subject))
    known, walked = next((m for m in _methods() if _differences(m, reading) == []), None), None
    if (method := asked or known) and _differences(method, reading) == []:
        solved = max(_SOLVER * reading.curved, WELL_SOLVED)
        walked = there_and_back(walks.ImexWalker(subject, Specification(method), solved))
    measured = walks.measured_of_two(subject, walks.WithDamping, _HALVINGS)
    return ImexIdentity(reading, known.key if known else "", measured, walked, _judged_estimate(subject, method))


def _judged_estimate(subject: ForeignStepper, method: Additive | None) -> StepFinding | None:
    """Judge what is returned besides y1 by the embedded rows of both tables."""
    alone = walks.alone(subject)
    if method is None or method.b_explicit_embedded is None:
        return judged_second(subject, alone, method.key if method else "")

    def differing(reading: ImexReading, factor: Fraction | None) -> list[str] | None:
        b = embedded_row(method.b_explicit, method.b_explicit_embedded or (), factor)
        b_implicit = embedded_row(method.b_implicit, method.b_implicit_embedded or (), factor)
        return _differences(replace(method, b_explicit=b, b_implicit=b_implicit), reading)

    return judged_second(subject, alone, method.key, lambda second: _in_order(read_imex_step(second)), differing)


def _methods() -> Iterator[Additive]:
    return (m for m in FURTHER_METHODS.values() if isinstance(m, Additive))


def _used(method: Additive) -> list[int]:
    """The stages that y₁ depends on."""
    used = {j for b in (method.b_explicit, method.b_implicit) for j, x in enumerate(b) if x != 0}
    tables = (method.a_explicit, method.a_implicit)
    while more := {j for i in used for a in tables for j, x in enumerate(a[i]) if x != 0} - used:
        used |= more
    return sorted(used)


def _differences(method: Additive, reading: ImexReading) -> list[str] | None:
    """The entries that are not the method's, in words; None if y₁ depends on another number of stages."""
    used = _used(method)
    if len(used) != reading.stages:
        return None
    pairs: list[tuple[str, float, Exact]] = []
    parts = ((method.a_explicit, method.b_explicit), (method.a_implicit, method.b_implicit))
    for part, (a, b), seen_a, seen_b in zip(IMEX_PARTS, parts, reading.a, reading.b, strict=True):
        for i, row in zip(used, seen_a, strict=True):
            pairs += [(f"a_{part}[{i}][{j}]", x, a[i][j]) for j, x in zip(used, row, strict=True)]
        pairs += [(f"b_{part}[{j}]", x, b[j]) for j, x in zip(used, seen_b, strict=True)]
    rounding, fmt = reading.rounding, reading.format
    return [
        coefficient_difference(name, x, exact, fmt, rounding.of(1.0))
        for name, x, exact in pairs
        if abs(x - float(exact)) > rounding.of(max(1.0, abs(float(exact))))
    ]


def _in_order(reading: ImexReading) -> ImexReading:
    """The stages sorted so that each comes after those that it needs, else in the order of their first call."""
    order: list[int] = []
    left = list(range(reading.stages))
    while left:
        ready = [i for i in left if not any(a[i][j] for a in reading.a for j in left if j != i)]
        order.append(next(iter(ready or left)))
        left.remove(order[-1])

    def sorted_row(row: Sequence[float]) -> CoefficientRow:
        return tuple(row[j] for j in order)

    a, a_implicit = (tuple(sorted_row(table[i]) for i in order) for table in reading.a)
    b, b_implicit = map(sorted_row, reading.b)
    c = None if reading.c is None else sorted_row(reading.c)
    return replace(reading, a=(a, a_implicit), b=(b, b_implicit), c=c)


def _as_read(reading: ImexReading) -> Additive:
    """The method with the floats read as exact entries, and 0 in place of rounding where a table has no entry."""
    (a, a_implicit), (b, b_implicit) = reading.a, reading.b
    exact = [
        [[Fraction(x) if j < i + diagonal else Fraction(0) for j, x in enumerate(row)] for i, row in enumerate(table)]
        for diagonal, table in enumerate((a, a_implicit))
    ]
    tables = [tuple(map(tuple, rows)) for rows in exact]
    weights = [tuple(map(Fraction, row)) for row in (b, b_implicit)]
    return Additive("read", "read", 0, "", tables[0], tables[1], weights[0], weights[1], decimal=True)
