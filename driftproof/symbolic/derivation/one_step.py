"""The one-step matrix M(h) of a method on the oscillator, exact over Q[h], by running the step on polynomials.

An implicit method has a matrix over Q(h), which `stages` derives; the functions of a matrix here accept both.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, TypeAlias

import sympy
from sympy import QQ, ring
from sympy.polys.fields import FracElement
from sympy.polys.matrices import DomainMatrix

from driftproof.methods.programs.stepping import Force, Step, oscillator, stepper
from driftproof.methods.schemes import Method

# An element of Q[h], and one of Q[h] or of Q(h). SymPy's rings have no static types.
StepPolynomial: TypeAlias = Any
MatrixEntry: TypeAlias = Any

RING, H = ring("h", QQ)
MATRICES = RING.to_domain()
FRACTION_FIELD = MATRICES.get_field()
# A step run on these generators yields polynomials in the state and h.
STATE_RING, STATE_Q, STATE_V, STATE_H = ring("q, v, h", QQ)


def rational(x: Fraction | int) -> Any:
    """`x` in SymPy's field Q. Raises TypeError for a float, which SymPy's own conversion would replace by a guess."""
    if isinstance(x, bool) or not isinstance(x, Fraction | int):
        raise TypeError(f"{x!r} is {type(x).__name__}; exact arithmetic takes int or Fraction")
    return QQ(x.numerator, x.denominator)


def one_step_matrix(method: Method) -> DomainMatrix:
    """M(h) with (q₁, v₁)ᵀ = M(h) (q₀, v₀)ᵀ for q' = v, v' = -q: a 2x2 matrix over Q[h]."""
    return matrix_of(exact_stepper(method))


def exact_stepper(method: Method) -> Step:
    """The step function of `method` over Q[q, v, h], with its coefficients as constants of that ring."""
    return stepper(method, lambda c: STATE_RING.ground_new(rational(c)))


def symbolic_step(step: Step, force: Force = oscillator) -> tuple[StepPolynomial, StepPolynomial]:
    """(q₁, v₁) as polynomials in Q[q, v, h], by running the step on the generators q, v and h."""
    q1, v1 = step(force, STATE_Q, STATE_V, STATE_H)
    return q1, v1


def matrix_of(step: Step, force: Force = oscillator) -> DomainMatrix:
    """The matrix over Q[h] of a step function that is linear in (q, v), by running it on polynomials.

    Raises ValueError if the step is not linear in the state.
    """
    q1, v1 = symbolic_step(step, force)
    return DomainMatrix([_linear_coefficients(q1, "q"), _linear_coefficients(v1, "v")], (2, 2), MATRICES)


def matrix(rows: list[list[MatrixEntry]]) -> DomainMatrix:
    """The matrix with these entries over Q[h], or over Q(h) if one is a fraction; ints and Fractions are promoted."""
    entries = [[RING.ground_new(rational(x)) if isinstance(x, int | Fraction) else x for x in row] for row in rows]
    fractional = any(isinstance(x, FracElement) for row in entries for x in row)
    entries = [[FRACTION_FIELD.convert(x) for x in row] for row in entries] if fractional else entries
    return DomainMatrix.from_list(entries, FRACTION_FIELD if fractional else MATRICES)


def numerator_and_denominator(x: MatrixEntry) -> tuple[StepPolynomial, StepPolynomial]:
    """Coprime polynomials whose quotient is `x`; the denominator of a polynomial is 1."""
    return (x.numer, x.denom) if isinstance(x, FracElement) else (x, RING.one)


def over_common_denominator(m: DomainMatrix) -> tuple[DomainMatrix, StepPolynomial]:
    """(N, d) with M = N / d, N over Q[h] and d of the lowest degree."""
    parts = [numerator_and_denominator(x) for x in entries(m)]
    common = RING.one
    for _, denominator in parts:
        common = common.lcm(denominator)
    qq, qv, vq, vv = (top * common.exquo(bottom) for top, bottom in parts)
    return matrix([[qq, qv], [vq, vv]]), common


def entries(m: DomainMatrix) -> tuple[MatrixEntry, MatrixEntry, MatrixEntry, MatrixEntry]:
    """The entries (M_qq, M_qv, M_vq, M_vv)."""
    (qq, qv), (vq, vv) = m.to_list()
    return qq, qv, vq, vv


def trace(m: DomainMatrix) -> MatrixEntry:
    """The trace M_qq + M_vv."""
    qq, _, _, vv = entries(m)
    return qq + vv


def determinant(m: DomainMatrix) -> MatrixEntry:
    """The determinant M_qq M_vv - M_qv M_vq, the factor by which one step scales area."""
    qq, qv, vq, vv = entries(m)
    return qq * vv - qv * vq


def at_rational(entry: MatrixEntry, h: Fraction) -> Fraction:
    """The value of an element of Q[h] or of Q(h) at a rational h, as a Fraction. Raises ZeroDivisionError at a pole."""
    top, bottom = (p.evaluate(H, rational(h)) for p in numerator_and_denominator(entry))
    value = top / bottom
    return Fraction(int(value.numerator), int(value.denominator))


def matrix_at(m: DomainMatrix, h: Fraction) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """The entries (M_qq, M_qv, M_vq, M_vv) at a rational h."""
    qq, qv, vq, vv = (at_rational(entry, h) for entry in entries(m))
    return qq, qv, vq, vv


def expression(polynomial: MatrixEntry) -> sympy.Expr:
    """An element of Q[h] or of Q(h) as a SymPy expression in the symbol h, for printing and for algebraic numbers."""
    return polynomial.as_expr()


def _linear_coefficients(polynomial: StepPolynomial, name: str) -> list[StepPolynomial]:
    row = {"q": RING.zero, "v": RING.zero}
    for (in_q, in_v, in_h), coefficient in polynomial.terms():
        if in_q + in_v != 1:
            raise ValueError(f"the step is not linear in the state: its {name} has the term q**{in_q} * v**{in_v}")
        row["q" if in_q else "v"] += RING({(in_h,): coefficient})
    return [row["q"], row["v"]]
