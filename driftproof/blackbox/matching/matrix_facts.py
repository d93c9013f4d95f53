"""Facts of a one-step matrix: text, determinant, energy multiplier and linear order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, arb_series, ctx

from driftproof.blackbox.matching.equivalent_methods import CERTIFYING_BITS, LinearlyEquivalentMethods
from driftproof.methods.programs.stepping import stepper
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import ONE, Polynomial, coefficients, exact, polynomial
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction, taylor
from driftproof.symbolic.algebra.rational_functions import rational_function_text as function_text
from driftproof.symbolic.linear.oscillator import area_factor
from driftproof.symbolic.rounding.formats import BINARY64

# Powers of h in a series: enough for every order below this number; the highest in the catalogue is 20 (gauss10).
SERIES_LENGTH = 24
ENTRY_NAMES = ("M_qq", "M_qv", "M_vq", "M_vv")
# Exact texts longer than a line are replaced by decimals, which are easier to read.
LONGEST_EXACT = 120


@dataclass(frozen=True)
class MatrixFacts:
    """The entries M_qq, M_qv, M_vq, M_vv and the determinant as text in h, None of the exact solution; and other facts.

    `energy_multiplier` is the factor by which a step multiplies k q² + v², None if that depends on the state.
    `linear_order` is the largest p with M(h) - exp(hA) = O(h^(p+1)) for q' = v, v' = -k q; it is -1 if M(0) ≠ I,
    and None if no difference is seen in the first SERIES_LENGTH powers of h.
    """

    entries: tuple[str, str, str, str] | None
    determinant: str | None
    energy_multiplier: str | None
    linear_order: int | None


def facts_of_class(
    each: LinearlyEquivalentMethods, position: Fraction, stiffness: Fraction, system: Fraction
) -> MatrixFacts:
    """The facts of a class applied to q' = a v, v' = -k q, as a solution of q' = v, v' = -`system` q.

    If its coefficients are decimals, its order is that of balls around them, right to a rounding of binary64.
    """
    found = matrix_facts(scaled_matrix(each.matrix, position, stiffness), system)
    if not (each.programs and each.programs[0].decimal) or {position, stiffness, system} != {Fraction(1)}:
        return found
    terms, ctx.cap = ctx.cap, SERIES_LENGTH
    try:
        with ctx.workprec(CERTIFYING_BITS):
            printed = lambda x: arb_series([enclose(x) * arb(1, float(BINARY64.u))])
            step, one, nil = stepper(each.programs[0], printed), arb_series([1]), arb_series([0])
            columns = [step(lambda q: -q, q, v, arb_series([0, 1])) for q, v in ((one, nil), (nil, one))]
            series = [entry.coeffs() for row in zip(*columns, strict=True) for entry in row]
            return replace(found, linear_order=order_on_linear_system(series, system))
    finally:
        ctx.cap = terms


def matrix_facts(matrix: StepMatrix, stiffness: Fraction) -> MatrixFacts:
    """The facts of an exact matrix that should solve q' = v, v' = -stiffness q."""
    qq, qv, vq, vv = (text_of(entry) for row in matrix for entry in row)
    multiplier = _energy_multiplier(matrix, stiffness)
    series = [[exact(c) for c in taylor(entry, SERIES_LENGTH)] for row in matrix for entry in row]
    with ctx.workprec(CERTIFYING_BITS):
        order = order_on_linear_system([[enclose(c) for c in each] for each in series], stiffness)
    energy = text_of(multiplier) if multiplier else None
    return MatrixFacts((qq, qv, vq, vv), text_of(area_factor(matrix)), energy, order)


def order_on_linear_system(series: Sequence[Sequence[arb]], stiffness: Fraction) -> int | None:
    """The order on q' = v, v' = -k q; None if no difference is certain in the first SERIES_LENGTH powers of h.

    `series` are balls around the coefficients of M_qq, M_qv, M_vq, M_vv.
    """
    term = [Fraction(1), Fraction(0), Fraction(0), Fraction(1)]
    for power in range(SERIES_LENGTH):
        found = [each[power] if power < len(each) else arb(0) for each in series]
        if not all(c.overlaps(enclose(x)) for c, x in zip(found, term, strict=True)):
            return power - 1
        qq, qv, vq, vv = term  # the next one is A m / power of exp(hA), for A = [[0, 1], [-k, 0]]
        term = [x / (power + 1) for x in (vq, vv, -stiffness * qq, -stiffness * qv)]
    return None


def _energy_multiplier(matrix: StepMatrix, stiffness: Fraction) -> RationalFunction | None:
    (qq, qv), (vq, vv) = matrix
    k, inverse = (fraction(polynomial([x])) for x in (stiffness, 1 / stiffness))
    gained = qq * qq + inverse * vq * vq
    lost = gained != k * qv * qv + vv * vv or (k * qq * qv + vq * vv).num != 0
    return None if lost else gained


def scaled_matrix(matrix: StepMatrix, position: Fraction, stiffness: Fraction) -> StepMatrix:
    """The matrix of a method for q' = a v, v' = -k q, from its matrix for the oscillator, a = k = 1."""
    product = position * stiffness

    def scaled(f: RationalFunction, factor: Fraction) -> RationalFunction:
        num, den = (
            polynomial([c * product ** (i // 2) for i, c in enumerate(coefficients(p))]) for p in (f.num, f.den)
        )
        return fraction(num * polynomial([factor]), den)

    (qq, qv), (vq, vv) = matrix
    one = Fraction(1)
    return (scaled(qq, one), scaled(qv, position)), (scaled(vq, stiffness), scaled(vv, one))


def text_of(f: RationalFunction) -> str:
    """The function in SymPy's syntax, with rounded decimals if it would be longer than LONGEST_EXACT."""
    text = function_text(f, "h")
    if len(text) <= LONGEST_EXACT:
        return text
    num = _decimals(f.num)
    return num if f.den == ONE else f"({num})/({_decimals(f.den)})"


def _decimals(p: Polynomial) -> str:
    terms = [(power, float(c)) for power, c in enumerate(coefficients(p)) if c != 0]
    shown = (f"{c:.10g}{('', '*h')[power] if power < 2 else f'*h**{power}'}" for power, c in terms)
    return " + ".join(shown).replace("+ -", "- ")
