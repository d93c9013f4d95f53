"""Judgement of an error estimate that was read: the pair that it belongs to, its order, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import fsum
from operator import sub
from typing import TypeAlias, TypeGuard

from driftproof.blackbox.matching.candidates import ExactTable
from driftproof.blackbox.matching.comparing import Comparison
from driftproof.blackbox.matching.read_order import HIGHEST_ORDER, BallTableaux, read_order
from driftproof.blackbox.matching.tables import exact_tableau, timed_stages
from driftproof.blackbox.probes.coefficients import coefficient_difference, coefficient_text, simple_rational
from driftproof.blackbox.probes.estimate import ABSOLUTE, NORM, EstimateReading, read_estimate
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.calling_conventions import TOLERANCE_NAMES, parameters_of, word_of
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import EMBEDDED_SUFFIX, METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.support.plain_text import Json
from driftproof.symbolic.known_methods import are_few
from driftproof.symbolic.linear.printed_digits import roundings
from driftproof.symbolic.trees.order_in_balls import Ball, vanishing_order
from driftproof.symbolic.trees.rooted_trees import to_brackets


@dataclass(frozen=True)
class JudgedEstimate:
    """An error estimate, described in `lines`, and what is wrong with it in `faults`: nothing for that of a pair.

    The row e read gives an estimate h Σ eⱼ kⱼ = O(h^(order + 1)); `order` is None if the estimate is relative to y.
    `other_order` is the order of the row that is not propagated, or None if there is no such row. `pair` is the key of
    the method whose row b - b_hat is the one read, up to a factor, or None.
    """

    order: int | None
    propagated_order: int
    other_order: int | None
    pair: str | None
    lines: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def data(self) -> dict[str, Json]:
        """The judgement as JSON data."""
        return {**vars(self), "lines": list(self.lines), "faults": list(self.faults)}


# The key of a pair, the factor of its row, the lines that describe the estimate, and its faults.
_Fit: TypeAlias = tuple[str | None, float, list[str], list[str]]


def judged_estimate(subject: ForeignStepper, method: Method | None = None) -> JudgedEstimate:
    """Judge the error estimate of a step that returns one, by its own tableau and by the pairs with that tableau.

    If `method` is given, it is the only pair considered. Raises NotReadable, and UnsupportedCall without an estimate.
    """
    subject = _unscaled(subject)
    estimate, reading = read_estimate(subject), read_tableau(subject)
    propagated = read_order(reading).order
    most, pairs = Rounding(estimate.format, len(estimate.row)).of(1.0), zip(estimate.row, estimate.sizes, strict=True)
    entries = (coefficient_text(float(e), estimate.format, most * x) for e, x in pairs)
    lines = [f"besides y1 it returns {estimate.form}: e = {', '.join(entries)}"]
    if not any(estimate.row):
        return JudgedEstimate(0, propagated, None, None, tuple(lines), ("the error estimate is always 0",))
    if estimate.relative:
        fault = "the error estimate is already relative: it is divided by the size of y before any tolerance"
        return JudgedEstimate(None, propagated, None, None, (f"besides y1 it returns {estimate.form}",), (fault,))
    pair, factor, described, faults = _pair_of(estimate, reading, method)
    if not estimate.power:
        faults = ["the error estimate is divided by h: an error per unit step, one order lower", *faults]
    faults += _mistimed(estimate, reading)
    if estimate.fault:
        faults = [f"the error estimate is not the same everywhere: {estimate.fault}", *faults]
    radius, pairs = Rounding(estimate.format, len(estimate.row)), zip(estimate.row, estimate.sizes, strict=True)
    balls = tuple(Ball(e, estimate.format.u * radius.most * Fraction(x)) if e else 0 for e, x in pairs)
    tableau = BallTableaux(reading, None).tableau(reading)._replace(b=balls)
    vanishing = vanishing_order(tableau, HIGHEST_ORDER)
    if vanishing.order == 0:
        total = sum(estimate.row, Fraction(0))
        slack = reading.rounding.of(max(estimate.sizes))
        shown = coefficient_text(float(total), reading.format, slack)
        faults.append(f"the error estimate is not a difference of two methods: its weights add up to {shown}, not to 0")
        return JudgedEstimate(0, propagated, None, pair, tuple(lines + described), tuple(faults))
    first = vanishing.failing_tree
    tree = "" if first is None else f": the first tree that contributes is {to_brackets(first)}"
    if pair is None and vanishing.order + 1 < propagated:
        faults.append(f"the error estimate is O(h^{vanishing.order + estimate.power}); the step has order {propagated}")
    # The other row is b - e or b + e, since no convention fixes the sign of e.
    weights = [(Fraction(b), Fraction(1 / factor) * e) for b, e in zip(reading.b, estimate.row, strict=True)]
    rows = (tuple(float(b - sign * e) for b, e in weights) for sign in (1, -1))
    other = max(read_order(replace(reading, b=row), None).order for row in rows)
    lines += [
        *described,
        f"the estimate is O(h^{vanishing.order + estimate.power}){tree}",
        f"the row of order {propagated} is propagated, the other one has order {other}",
    ]
    return JudgedEstimate(vanishing.order, propagated, other, pair, tuple(lines), tuple(faults))


def _unscaled(subject: ForeignStepper) -> ForeignStepper:
    """The stepper with the tolerances that it takes, by which it may divide its estimate, set to 0 |y| + 1."""
    names = [*(parameters_of(subject.function) or ())]
    held = {x: float(i) for i, words in enumerate(TOLERANCE_NAMES) for x in names if word_of(x) in words}
    return replace(subject, function=partial(subject.function, **held)) if 1.0 in held.values() else subject


def _mistimed(estimate: EstimateReading, reading: TableauReading) -> list[str]:
    """Lines on calls whose answers the estimate alone uses, and whose times are not those of their places."""
    if reading.c is None:
        return []
    alone = [j for j in reading.unused if estimate.row[j]]
    return [
        f"call {j}, which the error estimate alone uses, is made at t + {c:.6g} h with the place of t + {total:.6g} h"
        for j in alone
        if abs((c := reading.c[j]) - (total := fsum(reading.a[j]))) > reading.rounding.of(1.0)
    ]


def _pair_of(estimate: EstimateReading, reading: TableauReading, method: Method | None) -> _Fit:
    """The fit of a pair with the tableau read; of several pairs, that of the one whose estimate was read."""
    keys = (key + row for key, m in METHODS.items() if m.explicit and is_pair(m) for row in ("", EMBEDDED_SUFFIX))
    pairs = (pair for pair in ([method] if method else map(METHODS.__getitem__, keys)) if is_pair(pair))
    arranged = [(pair, order) for pair in pairs if (order := _stages_called(pair, reading)) is not None]
    found = [_compared(pair, _differences(pair, order), estimate) for pair, order in arranged]
    return min(found, key=lambda fit: (fit[0] is None, len(fit[3])), default=(None, 1.0, [], []))


def is_pair(method: Method) -> TypeGuard[RungeKutta]:
    """True if the method is a Runge-Kutta method with an embedded row of weights."""
    return isinstance(method, RungeKutta) and method.b_embedded is not None


def _stages_called(pair: RungeKutta, reading: TableauReading) -> Sequence[int] | None:
    """The stage of the pair that each call is; None if the tableau read is not that of the pair.

    Calls beyond the stages, such as the one for the first slope of the next step, must come after all stages.
    """
    if reading.calls < pair.stages:
        return None
    rows = [*zip(pair.a, reading.a, strict=False), (pair.b, reading.b)]
    allowed = reading.rounding.of(1 + max(abs(float(x)) for row, _ in rows for x in row))
    if all(abs(gap) <= allowed for exact, row in rows for gap in map(sub, map(float, exact), row)):
        return range(reading.calls)
    if reading.calls > pair.stages:
        return None
    called = reading.stages
    exact = timed_stages(exact_tableau(pair), len(called.weights) > 1)
    return Comparison(ExactTable.of(called, None), ExactTable.of(exact, None), reading.rounding).arrangement()


def _differences(pair: RungeKutta, order: Sequence[int]) -> list[Exact]:
    assert pair.b_embedded is not None
    row = dict(enumerate(x - y for x, y in zip(pair.b, pair.b_embedded, strict=True)))
    return [row.get(stage, Fraction(0)) for stage in order]


def _compared(pair: RungeKutta, exact: list[Exact], estimate: EstimateReading) -> _Fit:
    """Compare the row read with b - b̂ of a pair, up to a factor; where its source rounds, also to the digits there."""
    key = pair.key
    printed = [float(roundings(pair)(x)) if pair.decimal and x else 0.0 for x in exact]
    most = Rounding(estimate.format, len(exact)).of(1.0)
    largest = max(range(len(exact)), key=lambda j: abs(float(exact[j])))
    ratio = float(estimate.row[largest]) / float(exact[largest])
    size = max(estimate.sizes[largest], abs(float(estimate.row[largest])))
    simple = simple_rational(ratio, most * size / abs(float(exact[largest])))
    factor = ratio if simple is None else float(simple)
    if _off(exact, printed, estimate, most, factor):
        wrong = _off(exact, printed, estimate, most, 1.0)
        but = f"; it differs in {'; '.join(wrong)}" if are_few(wrong, len(exact), 0) else ""
        return None, 1.0, [], [f"the error estimate is not that of {key}{but}"]
    unsigned = estimate.form in (ABSOLUTE, NORM)
    if factor == 1 or (unsigned and factor == -1):
        return key, factor, [f"e = b - b_hat of {key}"], []
    if factor == -1:
        return key, factor, [f"e = b_hat - b of {key}: the opposite sign, which a norm does not show"], []
    shown = f"{factor:.6g}" if simple is None else str(simple)
    fault = [] if estimate.form == NORM else [f"the error estimate is {shown} times that of {key}"]
    return key, factor, [f"e = {shown} (b - b_hat) of {key}"], fault


def _off(exact: list[Exact], printed: list[float], estimate: EstimateReading, most: float, factor: float) -> list[str]:
    """The weights that differ from those of the pair times the factor by more than is `printed`, as text."""
    return [
        coefficient_difference(f"e[{j}]", float(e), x, estimate.format, most * size)
        for j, (e, x, size) in enumerate(zip(estimate.row, exact, estimate.sizes, strict=True))
        if abs(float(e) - factor * float(x)) > most * max(size, abs(factor * float(x))) + abs(factor) * printed[j]
    ]
