"""Quadratics that a step conserves on a linear problem: all of them, where they are definite, the modified energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

from driftproof.symbolic.algebra.matrices import StepMatrix, matrix_determinant
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    X,
    descend,
    greatest_common_divisor,
    quotient,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, positive_roots, vanishes_at
from driftproof.symbolic.linear.oscillator import area_factor as area_factor
from driftproof.symbolic.linear.oscillator import matrix_trace
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit, smallest

_NIL = fraction(ONE * 0)
_UNIT = fraction(ONE)


@dataclass(frozen=True)
class QuadraticForm:
    """Σ cᵢⱼ zᵢ zⱼ over i <= j, coefficients in Q[h] or K[h], without a common factor.

    `coefficients` in the order (0,0), (0,1), ..., (1,1), ...: for the oscillator those of q², qv, v².
    """

    coefficients: tuple[Polynomial, ...]
    size: int

    def symmetric(self) -> list[list[Polynomial]]:
        """The symmetric matrix S with zᵀSz twice the form."""
        rows: list[list[Polynomial]] = [[ONE * 0] * self.size for _ in range(self.size)]
        for c, (i, j) in zip(self.coefficients, _pairs(self.size), strict=True):
            rows[i][j] = rows[i][j] + c
            rows[j][i] = rows[j][i] + c
        return rows


def quadratic_invariants(m: StepMatrix) -> list[QuadraticForm]:
    """A basis over the field of rational functions of all quadratic forms I with I(M(h)z) = I(z): MᵀSM = S.

    For the oscillator: one for a step of determinant 1 that is not ±I, namely the area of z and Mz; a single one is
    scaled to be the energy (q² + v²)/2 at h = 0 where it can be.
    """
    if len(m) == 2 and (quick := _of_planar(m)) is not None:
        return quick
    return quadratics_by_elimination(m)


def quadratics_by_elimination(m: StepMatrix) -> list[QuadraticForm]:
    """The same basis by solving MᵀSM = S."""
    size = len(m)
    pairs = _pairs(size)
    equations = [[_pulled_back(m, i, j, k, n) for k, n in pairs] for i, j in pairs]
    for index in range(len(pairs)):
        equations[index][index] = equations[index][index] - _UNIT
    found = [QuadraticForm(_cleared(vector), size) for vector in _nullspace(equations)]
    return [_scaled(form) for form in found]


def definite_limit(form: QuadraticForm) -> Limit:
    """The largest H such that the form is positive definite for every h in (0, H): Sylvester's minors are all > 0."""
    rows = form.symmetric()
    minors = [matrix_determinant([row[:k] for row in rows[:k]]) for k in range(1, form.size + 1)]
    return smallest([_positive_limit(minor) for minor in minors])


@dataclass(frozen=True)
class ModifiedHamiltonian:
    """H̃(z) = (θ / sin θ) (q2 q² + qv qv + v2 v²) with cos θ = `cosine`: the step is its exact flow over time h.

    Valid for h in (0, `limit`), where |cos θ| < 1 and θ, continuous from 0, lies in (0, π).
    """

    cosine: RationalFunction
    q2: RationalFunction
    qv: RationalFunction
    v2: RationalFunction
    limit: Limit


def modified_hamiltonian(m: StepMatrix) -> ModifiedHamiltonian | None:
    """The quadratic Hamiltonian whose exact flow over time h is M(h), for det M = 1; None for another determinant.

    log M = (θ / sin θ)(M - cos θ I), and z' = J∇H̃ with J = [[0, 1], [-1, 0]] (hairer-lubich-wanner-2006, IX.3).
    None also where M is not elliptic for small h.
    """
    if area_factor(m) != _UNIT:
        return None
    (qq, qv), (vq, vv) = m
    cosine = matrix_trace(m) * fraction(ONE / 2)
    limit = _positive_limit((_UNIT - cosine * cosine).num)
    if limit == ZERO_ROOT:
        return None
    half_over_step = fraction(ONE / 2, X)
    q2, cross, v2 = (entry * half_over_step for entry in (-vq, qq - vv, qv))
    return ModifiedHamiltonian(cosine, q2, cross, v2, limit)


def _of_planar(m: StepMatrix) -> list[QuadraticForm] | None:
    """The basis where no eigenvalue is ±1 for all h: on quadratics M acts by λ₁², λ₁λ₂ and λ₂²."""
    area, turn = area_factor(m), matrix_trace(m)
    if _NIL in (_UNIT + area + turn, _UNIT + area - turn):
        return None
    if area != _UNIT:
        return []
    (qq, qv), (vq, vv) = m
    return [_scaled(QuadraticForm(_cleared((-vq, qq - vv, qv)), 2))]


def _pairs(size: int) -> list[tuple[int, int]]:
    return list(combinations_with_replacement(range(size), 2))


def _pulled_back(m: StepMatrix, i: int, j: int, k: int, n: int) -> RationalFunction:
    """The coefficient of zᵢzⱼ in (Mz)ₖ(Mz)ₙ."""
    first = m[k][i] * m[n][j]
    return first if i == j else first + m[k][j] * m[n][i]


def _nullspace(rows: list[list[RationalFunction]]) -> list[list[RationalFunction]]:
    """A basis of the vectors x with Σ rowₖ xₖ = 0, by elimination."""
    width = len(rows[0])
    pivots: list[int] = []
    for column in range(width):
        depth = len(pivots)
        found = next((r for r in range(depth, len(rows)) if rows[r][column] != _NIL), None)
        if found is None:
            continue
        rows[depth], rows[found] = rows[found], rows[depth]
        unit = fraction(rows[depth][column].den, rows[depth][column].num)
        rows[depth] = [x * unit for x in rows[depth]]
        for r in range(len(rows)):
            if r != depth and rows[r][column] != _NIL:
                factor = rows[r][column]
                rows[r] = [x - factor * y for x, y in zip(rows[r], rows[depth], strict=True)]
        pivots.append(column)
    return [_solution(rows, pivots, free, width) for free in range(width) if free not in pivots]


def _solution(rows: list[list[RationalFunction]], pivots: list[int], free: int, width: int) -> list[RationalFunction]:
    vector = [_NIL] * width
    vector[free] = _UNIT
    for depth, column in enumerate(pivots):
        vector[column] = -rows[depth][free]
    return vector


def _cleared(vector: Sequence[RationalFunction]) -> tuple[Polynomial, ...]:
    """The same direction with polynomial entries that have no common factor."""
    common: Polynomial = ONE
    for x in vector:
        common = common * quotient(x.den, greatest_common_divisor(common, x.den))
    entries = [descend(x.num * quotient(common, x.den)) for x in vector]
    content = entries[0] * 0
    for entry in entries:
        content = greatest_common_divisor(content, entry) if content != 0 else entry
    return tuple(quotient(entry, content) for entry in entries)


def _scaled(form: QuadraticForm) -> QuadraticForm:
    """Half the form whose first coefficient with a nonzero value at h = 0 has value 1 there."""
    at_zero = [c[0] for c in form.coefficients]
    unit: Scalar = next(x for x in at_zero if x != 0)
    return QuadraticForm(tuple(descend(c / (2 * unit)) for c in form.coefficients), form.size)


def _positive_limit(p: Polynomial) -> Limit:
    """The largest H with p > 0 on (0, H): the first positive root, if p is positive before it."""
    lowest = next((c for c in p.coeffs() if c != 0), None)
    if lowest is None or sign(lowest) < 0:
        return ZERO_ROOT
    return next((root for root in positive_roots([p]) if vanishes_at(p, root)), INFINITY)
