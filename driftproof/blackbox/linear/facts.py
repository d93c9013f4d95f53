"""What follows from a one-step matrix: its text, determinant, energy multiplier, linear order; and how two differ."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb

from driftproof.blackbox.linear.arithmetics import FUNCTIONS, SERIES, SERIES_LENGTH, precise, step_function, step_series
from driftproof.blackbox.linear.classes import MethodClass, Rates
from driftproof.blackbox.linear.parts import Model
from driftproof.blackbox.linear.recovery import Recovered
from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import ONE, Polynomial, coefficients, exact, polynomial
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.series import expand
from driftproof.symbolic.algebra.text import rational_text as function_text
from driftproof.symbolic.linear.oscillator import determinant
from driftproof.symbolic.runs import Entries

# An exchange of the entries of a matrix.
Undo: TypeAlias = Callable[[Any], Entries]
ENTRIES = ("M_qq", "M_qv", "M_vq", "M_vv")
# An exact text longer than this says less than decimals do.
LONGEST_EXACT = 120
POWERS_COMPARED = 12
LONGEST_DENOMINATOR = 10**6


@dataclass(frozen=True)
class MatrixFacts:
    """The entries as text in h, M_qq, M_qv, M_vq, M_vv; None, as the determinant, where they are not rational in h.

    `energy_multiplier` is the factor by which a step multiplies k q² + v², None if it depends on the state.
    `linear_order` is the p with M(h) - exp(hA) = O(h^(p+1)) and no better for q' = v, v' = -k q - g v; -1 for M(0) ≠ I.
    """

    entries: tuple[str, str, str, str] | None
    determinant: str | None
    energy_multiplier: str | None
    linear_order: int | None


def facts_of_model(
    model: Model, rates: Sequence[Fraction], system: tuple[Fraction, Fraction], undo: Undo
) -> MatrixFacts:
    """The facts of a model with the rates a, k, g, and with `undo` applied, for a system with `system` = k, g."""
    with precise():
        m = undo(model.matrix(SERIES, Rates(step_series(), *(SERIES.number(x) for x in rates))))
        order = linear_order([series.coeffs() for series in m], *system)
    if not model.has_short_matrix:
        return MatrixFacts(None, None, None, order)
    return replace(facts_of(_undone(_matrix(model, rates), undo), *system), linear_order=order)


def facts_of(matrix: StepMatrix, stiffness: Fraction, damping: Fraction) -> MatrixFacts:
    """The facts of an exact matrix, for the system that it should solve."""
    qq, qv, vq, vv = (text_of(entry) for row in matrix for entry in row)
    multiplier = _energy_multiplier(matrix, stiffness)
    series = [[exact(c) for c in expand(entry, SERIES_LENGTH)] for row in matrix for entry in row]
    with precise():
        order = linear_order([[enclose(c) for c in each] for each in series], stiffness, damping)
    return MatrixFacts(
        (qq, qv, vq, vv), text_of(determinant(matrix)), text_of(multiplier) if multiplier else None, order
    )


def _matrix(model: Model, rates: Sequence[Fraction]) -> StepMatrix:
    """The exact matrix of a model."""
    if model.as_method and rates[0] == rates[1] == 1:
        return model.as_method.matrix
    qq, qv, vq, vv = model.matrix(FUNCTIONS, Rates(step_function(), *(FUNCTIONS.number(x) for x in rates)))
    return (qq.value, qv.value), (vq.value, vv.value)


def _undone(matrix: StepMatrix, undo: Undo) -> StepMatrix:
    (qq, qv), (vq, vv) = matrix
    a, b, c, d = undo((qq, qv, vq, vv))
    return (a, b), (c, d)


def linear_order(series: Sequence[Sequence[arb]], stiffness: Fraction, damping: Fraction) -> int | None:
    """The order on q' = v, v' = -k q - g v; None where the first SERIES_LENGTH powers of h may agree.

    `series` are balls around the coefficients of M_qq, M_qv, M_vq, M_vv.
    """
    term = [Fraction(1), Fraction(0), Fraction(0), Fraction(1)]
    for power in range(SERIES_LENGTH):
        found = [each[power] if power < len(each) else arb(0) for each in series]
        if not all(c.overlaps(enclose(x)) for c, x in zip(found, term, strict=True)):
            return power - 1
        term = _next_term(term, stiffness, damping, power + 1)
    return None


def _differ(x: Exact, y: Exact, by_more_than: Fraction) -> bool:
    return bool(x - y > by_more_than or y - x > by_more_than)


def damping_of(velocities: RationalFunction) -> Fraction:
    """g, for M_vv = 1 - g h + O(h²) over Q."""
    return -Fraction(str(expand(velocities, 2)[1]))


def _next_term(m: Sequence[Fraction], stiffness: Fraction, damping: Fraction, power: int) -> list[Fraction]:
    """A m / power, for A = [[0, 1], [-k, -g]]."""
    qq, qv, vq, vv = m
    moved = vq, vv, -stiffness * qq - damping * vq, -stiffness * qv - damping * vv
    return [x / power for x in moved]


def _energy_multiplier(matrix: StepMatrix, stiffness: Fraction) -> RationalFunction | None:
    if stiffness == 0:
        return None
    (qq, qv), (vq, vv) = matrix
    k, inverse = (fraction(polynomial([x])) for x in (stiffness, 1 / stiffness))
    gained = qq * qq + inverse * vq * vq
    lost = gained != k * qv * qv + vv * vv or (k * qq * qv + vq * vv).num != 0
    return None if lost else gained


def text_of(f: RationalFunction) -> str:
    """The function in SymPy's syntax, or with rounded decimals where its coefficients are long."""
    text = function_text(f, "h")
    if len(text) <= LONGEST_EXACT:
        return text
    num = _decimals(f.num)
    return num if f.den == ONE else f"({num})/({_decimals(f.den)})"


def _decimals(p: Polynomial) -> str:
    terms = [(power, float(c)) for power, c in enumerate(coefficients(p)) if c != 0]
    shown = (f"{c:.10g}{f'*h**{power}' * (power > 0)}".replace("h**1", "h") for power, c in terms)
    return " + ".join(shown).replace("+ -", "- ")


def differences(read: Sequence[Recovered], other: MethodClass, position: Fraction, stiffness: Fraction) -> list[str]:
    """Where a recovered matrix certainly differs from that of a method for q' = a v, v' = -k q, in words.

    Power by power of the series in h: of polynomials every coefficient, of other entries the first that differs.
    """
    theirs = other.series(position, stiffness, POWERS_COMPARED)
    polynomial_ = all(entry.den == ONE for row in other.matrix for entry in row)
    found: list[tuple[int, str]] = []
    for name, entry, series in zip(ENTRIES, read, theirs, strict=True):
        told = [
            (power, f"h^{power} coefficient of {name} is {ours}, {other.keys[0]} has {_shown(its)}")
            for power, ours, its in _differing(entry, series)
        ]
        found += told if polynomial_ and len(entry.den) == 1 else told[:1]
    return [words for _, words in sorted(found, key=lambda difference: difference[0])]


def _differing(entry: Recovered, theirs: Sequence[Exact]) -> Iterator[tuple[int, str, Exact]]:
    """The powers at which the series differ, for certain, with both coefficients."""
    if len(entry.den) > 1 and not entry.exact:
        return
    known = dict(enumerate(entry.num)) if len(entry.den) == 1 else {}
    ours = (exact(c) for c in expand(entry.function, len(theirs)))
    for power, (x, y) in enumerate(zip(ours, theirs, strict=True)):
        if _differ(x, y, known[power].error if power in known else Fraction(0)):
            yield power, str(known[power]) if power in known else _shown(x), y


def _shown(x: Exact) -> str:
    return str(x) if isinstance(x, Fraction) and x.denominator <= LONGEST_DENOMINATOR else f"{float(x):.15g}"
