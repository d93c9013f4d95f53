"""Quadratic forms that a step conserves on the oscillator, where they are definite, and the modified Hamiltonian."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import ONE, Polynomial, X, descend, greatest_common_divisor, quotient, sign
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, positive_roots, vanishes_at
from driftproof.symbolic.linear.oscillator import area_factor, matrix_trace
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit, common_denominator

_NIL = fraction(ONE * 0)
_UNIT = fraction(ONE)


@dataclass(frozen=True)
class QuadraticForm:
    """The form a q² + b qv + c v² by its coefficients (a, b, c) in Q[h] or K[h], without a common factor."""

    coefficients: tuple[Polynomial, Polynomial, Polynomial]


def quadratic_invariants(m: StepMatrix) -> list[QuadraticForm]:
    """A basis of all quadratic forms I with I(M(h)z) = I(z), over the field of rational functions of h.

    M acts on quadratic forms by λ₁², λ₁λ₂ and λ₂². So M = ±I conserves all of them. Any other M with an eigenvalue 1 or
    -1 for all h conserves the square of its left eigenvector, a row of M - λI with the other eigenvalue λ. Otherwise M
    conserves one form if det M = 1, the area of z and Mz, scaled to the energy (q² + v²)/2 at h = 0 where possible.
    """
    (qq, qv), (vq, vv) = m
    area, turn = area_factor(m), matrix_trace(m)
    if (qv, vq) == (_NIL, _NIL) and qq == vv and qq * qq == _UNIT:
        return [_form(*(_UNIT if i == j else _NIL for i in range(3))) for j in range(3)]
    found = []
    for eigenvalue in (_UNIT, -_UNIT):
        if _UNIT + area - eigenvalue * turn == _NIL:
            other = turn - eigenvalue
            a, b = next(row for row in ((qq - other, qv), (vq, vv - other)) if row != (_NIL, _NIL))
            found.append(_form(a * a, a * b + a * b, b * b))
    return found if found or area != _UNIT else [_form(-vq, qq - vv, qv)]


def definite_limit(form: QuadraticForm) -> Limit:
    """The largest H such that the form is positive definite, a > 0 and 4ac - b² > 0, for every h in (0, H)."""
    a, b, c = form.coefficients
    return _positive_limit(a, 4 * a * c - b * b)


@dataclass(frozen=True)
class ModifiedHamiltonian:
    """H̃(z) = (θ / sin θ) (q2 q² + qv qv + v2 v²) with cos θ = `cosine`, whose exact flow over time h is the step.

    It is valid for h in (0, `limit`), where |cos θ| < 1 and θ, continuous from 0, lies in (0, π).
    """

    cosine: RationalFunction
    q2: RationalFunction
    qv: RationalFunction
    v2: RationalFunction
    limit: Limit


def modified_hamiltonian(m: StepMatrix) -> ModifiedHamiltonian | None:
    """The quadratic Hamiltonian whose flow over time h is M(h); None unless det M = 1 and M is elliptic for small h.

    log M = (θ / sin θ)(M - cos θ I), and z' = J∇H̃ with J = [[0, 1], [-1, 0]] (hairer-lubich-wanner-2006, IX.3).
    """
    if area_factor(m) != _UNIT:
        return None
    (qq, qv), (vq, vv) = m
    cosine = matrix_trace(m) * fraction(ONE / 2)
    limit = _positive_limit((_UNIT - cosine).num, (_UNIT + cosine).num)
    if limit == ZERO_ROOT:
        return None
    half_over_step = fraction(ONE / 2, X)
    q2, cross, v2 = (entry * half_over_step for entry in (-vq, qq - vv, qv))
    return ModifiedHamiltonian(cosine, q2, cross, v2, limit)


def _form(*vector: RationalFunction) -> QuadraticForm:
    """The form along `vector` with coprime polynomial coefficients; their first nonzero value at h = 0 is 1/2."""
    common = common_denominator([vector])
    entries = [descend(x.num * quotient(common, x.den)) for x in vector]
    content = reduce(greatest_common_divisor, entries)
    entries = [quotient(entry, content) for entry in entries]
    unit = next(c[0] for c in entries if c[0])
    a, b, c = (descend(entry / (2 * unit)) for entry in entries)
    return QuadraticForm((a, b, c))


def _positive_limit(*polynomials: Polynomial) -> Limit:
    """The largest H such that all polynomials are positive on (0, H): 0, or the first positive root of any, or `oo`."""
    lowest = [next(filter(bool, p.coeffs()), None) for p in polynomials]
    if any(c is None or sign(c) == -1 for c in lowest):
        return ZERO_ROOT
    roots = positive_roots(polynomials)
    return next((root for root in roots if any(vanishes_at(p, root) for p in polynomials)), INFINITY)
