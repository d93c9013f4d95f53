"""Judgement of a dense output that was read: the continuous extension it is, its degree, order and smoothness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod
from operator import sub

from driftproof.blackbox.matching.match import match_tableau
from driftproof.blackbox.matching.read_order import read_order
from driftproof.blackbox.probes.dense import BETWEEN, THETAS, DenseReading, read_dense
from driftproof.blackbox.probes.scripted_answers import CoefficientRow
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import EXTENSIONS, METHODS
from driftproof.methods.continuous import ContinuousExtension, hermite
from driftproof.methods.numbers.number_field import total
from driftproof.methods.schemes import RungeKutta
from driftproof.support.plain_text import Json
from driftproof.symbolic.algebra.polynomials import ONE, Polynomial, X, scalar

# The highest degree looked for: 13 of the 17 thetas then fix the polynomials, and four check them.
_HIGHEST_DEGREE = 12


@dataclass(frozen=True)
class JudgedDense:
    """A dense output, described in `lines`, and what is wrong with it in `faults`.

    `order` is the lowest at the inner sixteenths, `degree` is None if it is no polynomial of a degree looked for, and
    `extension` is the key of the continuous extension of the catalogue that it is, or None.
    """

    order: int
    degree: int | None
    extension: str | None
    lines: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def data(self) -> dict[str, Json]:
        """The judgement as JSON data."""
        return {**vars(self), "lines": list(self.lines), "faults": list(self.faults)}


def judged_dense(subject: ForeignStepper) -> JudgedDense:
    """Judge the dense output of a step that returns one. Raises NotReadable, and UnsupportedCall if there is none."""
    return judged_reading(read_dense(subject))


def judged_reading(reading: DenseReading) -> JudgedDense:
    """Judge a dense output that was read."""
    reading = reading.merged()
    polynomials = _Polynomials.of(reading)
    matched = [METHODS[match.key] for match in match_tableau(reading.step).matches if not match.relation]
    cubics = (hermite(m) for m in matched if isinstance(m, RungeKutta) and not any(m.a[0]))  # k₁ = f(t, y)
    key = next((each.key for each in (*EXTENSIONS.values(), *cubics) if _is(reading, each)), None)
    orders = {theta: read_order(reading.step_to(theta)).order for theta in THETAS[1:-1]}
    order, where = min(orders.values()), min(orders, key=lambda theta: orders[theta])
    step = read_order(replace(reading.step, b=reading.own)).order
    degree = None if polynomials is None else polynomials.degree
    named = "no continuous extension of the catalogue"
    if key is not None:
        cubic = "the cubic through both ends with their slopes"
        named = f"{key}: {EXTENSIONS[key].title if key in EXTENSIONS else cubic}"
    shape = f"of degree {degree}" if degree is not None else f"no polynomial of degree {_HIGHEST_DEGREE} or less"
    between = f"order {order} at theta = 1/16, ..., 15/16; the order of the steps is {step}"
    others = ", ".join(f"{float(theta):.3g}" for theta in BETWEEN)
    asked = f"evaluated at theta = 0, 1/16, ..., 1, and at {others}: other values of theta were not tested"
    lines = [named, f"a function of {reading.argument}, {shape} in theta", between, asked]
    faults = [] if polynomials is None else [*polynomials.misfits(reading), *polynomials.elsewhere(reading)]
    if polynomials is not None and not faults:
        lines.append(polynomials.smoothness(reading))
    bent = order == 1 == step - 1 and degree != 1  # the straight line from y to y1 has order 1
    if key is None and (order < step - 1 or bent):
        only = f"order {order} only{f' at theta = {where}' if len({*orders.values()}) > 1 else ''}"
        line = ", no more than the straight line from y to y1" * bent
        faults.append(f"the dense output has {only}{line}, the steps have order {step}")
    faults += [f"the dense output is not the same everywhere: {remark}" for remark in reading.step.remarks]
    return JudgedDense(order, degree, key, tuple(lines), tuple(faults))


def _is(reading: DenseReading, extension: ContinuousExtension) -> bool:
    """True if the stages, in their order, and all weights at every theta are the extension's, up to rounding."""
    count, rounding = len(extension.a), reading.step.rounding
    if count > reading.step.calls or any(any(row[count:]) for row in reading.rows):
        return False
    largest = max(abs(float(x)) for row in extension.a for x in row)
    rows = [(exact, seen, [largest] * count) for exact, seen in zip(extension.a, reading.step.a, strict=False)]
    sizes = [sum(abs(float(x)) for x in weight) for weight in extension.weights]
    for theta, seen in zip(THETAS, reading.rows, strict=True):
        rows.append((tuple(total(c * theta**k for k, c in enumerate(w)) for w in extension.weights), seen, sizes))
    triples = (triple for row in rows for triple in zip(*row, strict=False))
    return all(abs(float(x) - y) <= rounding.of(1 + size) for x, y, size in triples)


@dataclass(frozen=True)
class _Polynomials:
    """The weights as polynomials of one degree, which interpolate them, and how far off other values may be."""

    degree: int
    basis: tuple[Polynomial, ...]  # each of them 1 at one of these thetas, 0 at the others
    weights: tuple[Polynomial, ...]  # of each stage
    allowed: float

    @classmethod
    def of(cls, reading: DenseReading) -> _Polynomials | None:
        """The polynomials of the least degree that pass through the values at all thetas; None if there are none."""
        for degree in range(1, _HIGHEST_DEGREE + 1):
            places = [k * 16 // degree for k in range(degree + 1)]
            nodes = [scalar(THETAS[k]) for k in places]  # of Lagrange's polynomials
            basis = tuple(prod(((X - x) / (node - x) for x in nodes if x != node), start=ONE) for node in nodes)
            columns = zip(*(reading.rows[k] for k in places), strict=True)
            weights = tuple(
                sum(part * scalar(Fraction(value)) for part, value in zip(basis, column, strict=True))
                for column in columns
            )
            size = max(map(_size, weights))
            # A value off by e moves the polynomial by at most e times the Lebesgue function.
            spread = max(float(sum(abs(part(scalar(theta))) for part in basis)) for theta in THETAS)
            found = cls(degree, basis, weights, reading.step.rounding.of(1 + size) * (1 + spread))
            pairs = zip(THETAS, reading.rows, strict=True)
            if all(off <= found.allowed for theta, row in pairs for off in found._off(theta, row)):
                return found
        return None

    def _off(self, theta: Fraction, row: CoefficientRow) -> list[float]:
        return [abs(float(weight(scalar(theta))) - seen) for weight, seen in zip(self.weights, row, strict=True)]

    def misfits(self, reading: DenseReading) -> Iterator[str]:
        """Yield what is wrong at theta = 0 and at theta = 1, where the dense output should be y and y1."""
        at_start, at_end = reading.rows[0], [x - y for x, y in zip(reading.rows[-1], reading.own, strict=True)]
        for place, off in (("y at theta = 0", at_start), ("y1 at theta = 1", at_end)):
            size, weight = _worst(reading, off)
            if size > self.allowed:
                yield f"the dense output is not {place}: {weight}"

    def elsewhere(self, reading: DenseReading) -> Iterator[str]:
        """Yield the first theta between the sixteenths whose value, up to rounding, is not on the polynomials."""
        slope = max(_size(weight.derivative()) for weight in self.weights)
        for theta, row in reading.between:
            size, weight = _worst(reading, self._off(theta, row))
            if size > self.allowed * (1 + slope):
                place = f"differs from its polynomial at theta = {float(theta):.3g}, though not at multiples of 1/16"
                yield f"the dense output {place}: {weight}"
                return

    def smoothness(self, reading: DenseReading) -> str:
        """Say at which ends the slope is f(t, y) or f(t + h, y1), as precisely as the polynomials are known."""
        derived = [part.derivative() for part in self.basis]
        allowed = self.allowed * (1 + max(float(sum(abs(part(end)) for part in derived)) for end in (0, 1)))
        last = [
            i
            for i, (row, c) in enumerate(zip(reading.step.a, reading.step.c or (), strict=False))
            if abs(c - 1) <= self.allowed
            if max(map(abs, map(sub, row, reading.own))) <= self.allowed
        ]

        def is_slope(end: int, call: int) -> bool:
            values = [float(weight.derivative()(end)) for weight in self.weights]
            return all(abs(value - (j == call)) <= allowed for j, value in enumerate(values))

        ends = ["f(t, y)"] * is_slope(0, 0) + ["f(t + h, y1)"] * any(is_slope(1, i) for i in last)
        slopes = f"is {' and '.join(ends)}" if ends else "is not that of the solution at either end"
        return f"continuous: it is y at theta = 0 and y1 at theta = 1; the slope {'there ' * bool(ends)}{slopes}"


def _worst(reading: DenseReading, off: Sequence[float]) -> tuple[float, str]:
    """The size of the largest difference of weights, and the words for it."""
    worst = max(range(len(off)), key=lambda j: abs(off[j]))
    return abs(off[worst]), f"the weight of call {reading.stages[worst]} is off by {off[worst]:.3g}"


def _size(p: Polynomial) -> float:
    return float(sum(map(abs, p.coeffs())))
