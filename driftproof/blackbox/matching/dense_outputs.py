"""Which continuous extension was read, its degree and order between the steps, and how it fits to them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod

from driftproof.blackbox.matching.match import match_tableau
from driftproof.blackbox.matching.read_order import read_order
from driftproof.blackbox.probes.dense import BETWEEN, THETAS, DenseReading, read_dense
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import EXTENSIONS, METHODS
from driftproof.methods.continuous import ContinuousExtension, hermite
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.support.plain_text import Json

_HIGHEST_DEGREE = 12


@dataclass(frozen=True)
class JudgedDense:
    """What a dense output is, in `lines`, and what is wrong with it, in `faults`.

    `order` is the least at the sixteenths inside, `degree` None where it is no polynomial of a degree that is looked
    for, `extension` the key of the catalogue's that it is.
    """

    order: int
    degree: int | None
    extension: str | None
    lines: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def data(self) -> dict[str, Json]:
        """The same for programs."""
        found: dict[str, Json] = {"order": self.order, "degree": self.degree, "extension": self.extension}
        return {**found, "lines": list(self.lines), "faults": list(self.faults)}


def judged_dense(subject: ForeignStepper) -> JudgedDense:
    """The dense output of a step that returns one. Raises NotReadable, UnsupportedCall."""
    return judged_reading(read_dense(subject))


def judged_reading(reading: DenseReading) -> JudgedDense:
    """What a dense output is that was read."""
    polynomials = _Polynomials.of(reading)
    key = next((each.key for each in _candidates(reading) if _is(reading, each)), None)
    orders = {theta: read_order(reading.step_to(theta)).order for theta in THETAS[1:-1]}
    order, where = min(orders.values()), min(orders, key=lambda theta: orders[theta])
    step = read_order(replace(reading.step, b=reading.own)).order
    degree = None if polynomials is None else polynomials.degree
    named = "no continuous extension of the catalogue"
    if key is not None:
        named = (
            f"{key}: {EXTENSIONS[key].title if key in EXTENSIONS else 'the cubic through both ends with their slopes'}"
        )
    shape = f"of degree {degree}" if degree is not None else f"no polynomial of degree {_HIGHEST_DEGREE} or less"
    between = f"order {order} between the steps, at the sixteenths; the order of the steps is {step}"
    others = ", ".join(f"{float(theta):.3g}" for theta in BETWEEN)
    asked = f"asked at theta = 0, 1/16, ..., 1, and at {others}: what it is elsewhere was not seen"
    lines = [named, f"a function of {reading.argument}, {shape} in theta", between, asked]
    faults = [] if polynomials is None else [*polynomials.misfits(reading)]
    faults += [] if polynomials is None else [*polynomials.elsewhere(reading)]
    if polynomials is not None and not faults:
        lines.append(polynomials.smoothness(reading))
    if key is None and order < step - 1:
        only = f"order {order} only{f' at theta = {where}' if len({*orders.values()}) > 1 else ''}"
        faults.append(f"the dense output has {only}, the steps have order {step}")
    faults += [f"the dense output is not the same everywhere: {remark}" for remark in reading.step.remarks]
    return JudgedDense(order, degree, key, tuple(lines), tuple(faults))


def _candidates(reading: DenseReading) -> Iterator[ContinuousExtension]:
    yield from EXTENSIONS.values()
    for match in match_tableau(reading.step).matches:
        method = METHODS[match.key]
        if not match.relation and isinstance(method, RungeKutta):
            try:
                yield hermite(method)
            except MethodError:
                continue


def _is(reading: DenseReading, extension: ContinuousExtension) -> bool:
    """The stages in their order, and every weight at every theta, to what rounding may do to sums of its terms."""
    if len(extension.a) > reading.step.calls:
        return False
    rounding = Rounding(reading.step.format, reading.step.calls)
    largest = max(abs(float(x)) for row in extension.a for x in row)
    for exact, seen in zip(extension.a, reading.step.a, strict=False):
        if any(abs(float(x) - y) > rounding.of(1 + largest) for x, y in zip(exact, seen, strict=False)):
            return False
    sizes = [sum(abs(float(x)) for x in weight) for weight in extension.weights]
    for theta, row in zip(THETAS, reading.rows, strict=True):
        values = [float(sum(c * theta**k for k, c in enumerate(weight))) for weight in extension.weights]
        if any(abs(x - y) > rounding.of(1 + size) for x, y, size in zip(values, row, sizes, strict=False)):
            return False
    return not any(any(row[len(sizes) :]) for row in reading.rows)


@dataclass(frozen=True)
class _Polynomials:
    """The weights as polynomials of one degree, through their values at as many thetas, and how far off they may be."""

    degree: int
    nodes: tuple[Fraction, ...]
    weights: tuple[tuple[Fraction, ...], ...]  # of each stage, constant term first
    allowed: float

    @classmethod
    def of(cls, reading: DenseReading) -> _Polynomials | None:
        """Of the least degree whose polynomials pass through all other values, too; None for none."""
        rounding = Rounding(reading.step.format, reading.step.calls)
        columns = list(zip(*reading.rows, strict=True))
        for degree in range(1, _HIGHEST_DEGREE + 1):
            nodes = tuple(THETAS[k * 16 // degree] for k in range(degree + 1))
            basis = [_lagrange(nodes, k) for k in range(degree + 1)]
            weights = tuple(_combined(basis, [column[THETAS.index(x)] for x in nodes]) for column in columns)
            size = max(float(sum(map(abs, weight))) for weight in weights)
            # A value off by e moves the polynomial by at most e times the Lebesgue function.
            spread = max(float(sum(abs(_at(part, theta)) for part in basis)) for theta in THETAS)
            allowed = rounding.of(1 + size) * (1 + spread)
            through = all(
                abs(float(_at(weight, theta)) - seen) <= allowed
                for weight, column in zip(weights, columns, strict=True)
                for theta, seen in zip(THETAS, column, strict=True)
            )
            if through:
                return cls(degree, nodes, weights, allowed)
        return None

    def misfits(self, reading: DenseReading) -> Iterator[str]:
        """What is wrong at theta = 0 and at theta = 1, where it should be y and y1."""
        at_start, at_end = reading.rows[0], [x - y for x, y in zip(reading.rows[-1], reading.own, strict=True)]
        for place, off in (("y at theta = 0", at_start), ("y1 at theta = 1", at_end)):
            worst = max(range(len(off)), key=lambda j: abs(off[j]))
            if abs(off[worst]) > self.allowed:
                yield f"the dense output is not {place}: the weight of call {worst} is off by {off[worst]:.3g}"

    def elsewhere(self, reading: DenseReading) -> Iterator[str]:
        """Where it leaves its polynomial between the sixteenths, a time there being rounded, too."""
        for theta, row in reading.between:
            off = [abs(float(_at(weight, theta)) - seen) for weight, seen in zip(self.weights, row, strict=True)]
            slope = max(float(sum(abs(c) for c in _derived(weight))) for weight in self.weights)
            worst = max(range(len(off)), key=lambda j: off[j])
            if off[worst] > self.allowed * (1 + slope):
                place = f"at theta = {float(theta):.3g}, though not at the sixteenths"
                yield f"the dense output is another one {place}: the weight of call {worst} is off by {off[worst]:.3g}"
                return

    def smoothness(self, reading: DenseReading) -> str:
        """Whether the slopes at both ends are f(t, y) and f(t + h, y1), to what the polynomials are known to."""
        basis = [_lagrange(self.nodes, k) for k in range(self.degree + 1)]
        spread = max(float(sum(abs(_at(_derived(part), Fraction(end))) for part in basis)) for end in (0, 1))
        allowed = self.allowed * (1 + spread)
        last = [
            i
            for i, row in enumerate(reading.step.a)
            if reading.step.c is not None and abs(reading.step.c[i] - 1) <= self.allowed
            if max(abs(x - y) for x, y in zip(row, reading.own, strict=True)) <= self.allowed
        ]

        def is_slope(end: int, call: int) -> bool:
            values = [float(_at(_derived(weight), Fraction(end))) for weight in self.weights]
            return all(abs(value - (j == call)) <= allowed for j, value in enumerate(values))

        ends = ["f(t, y)"] * is_slope(0, 0) + ["f(t + h, y1)"] * any(is_slope(1, i) for i in last)
        slopes = (
            f"the slope there is {' and '.join(ends)}" if ends else "the slope at neither end is that of the solution"
        )
        return f"continuous: it is y at theta = 0 and y1 at theta = 1; {slopes}"


def _lagrange(nodes: Sequence[Fraction], k: int) -> tuple[Fraction, ...]:
    """The polynomial that is 1 at node k and 0 at the others."""
    others = [x for x in nodes if x != nodes[k]]
    polynomial = [1 / prod((nodes[k] - x for x in others), start=Fraction(1))]
    for x in others:
        pairs = zip([Fraction(0), *polynomial], [*polynomial, Fraction(0)], strict=True)
        polynomial = [high - x * low for high, low in pairs]
    return tuple(polynomial)


def _combined(basis: Sequence[Sequence[Fraction]], values: Sequence[float]) -> tuple[Fraction, ...]:
    exact = [Fraction(value) for value in values]
    columns = zip(*basis, strict=True)
    return tuple(sum((v * c for v, c in zip(exact, column, strict=True)), Fraction(0)) for column in columns)


def _at(polynomial: Sequence[Fraction], theta: Fraction) -> Fraction:
    total = Fraction(0)
    for c in reversed(polynomial):
        total = total * theta + c
    return total


def _derived(polynomial: Sequence[Fraction]) -> tuple[Fraction, ...]:
    return tuple(k * c for k, c in enumerate(polynomial) if k)
