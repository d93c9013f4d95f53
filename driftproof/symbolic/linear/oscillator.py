"""The exact one-step matrix M(h) of a method on the oscillator and on linear systems z' = Az."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta
from driftproof.symbolic.algebra.matrices import StepMatrix, of_matrix
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    ZERO,
    Polynomial,
    Scalar,
    X,
    deflate,
    from_scalars,
    modulus_squared_on_imaginary_axis,
    reflected,
    scalar,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction, reversed_sign
from driftproof.symbolic.linear.stability_function import (
    ScalarTableau,
    resolvent,
    stability_function,
)

# The rows of J in z' = Jz, the oscillator.
_TURN = [[scalar(0), scalar(1)], [scalar(-1), scalar(0)]]


def stability_function_of(method: str | Path | Method) -> RationalFunction | None:
    """R(z) of a Runge-Kutta or collocation method; None for splittings and Nyström methods.

    >>> from driftproof import METHODS, stability_function_of
    >>> stability_function_of(METHODS["forward_euler"]).num
    x + 1
    """
    method = method_of(method)
    return stability_function(method) if isinstance(method, RungeKutta | Collocation) else None


def oscillator_matrix(method: Method) -> StepMatrix:
    """M(h) with (q₁, v₁)ᵀ = M(h) (q₀, v₀)ᵀ for q' = v, v' = -q, entries in Q(h) or K(h); the method may be implicit."""
    r = stability_function_of(method)
    if r is not None:
        return of_matrix(r, _TURN)
    if isinstance(method, Nystrom) and not method.explicit:
        return _implicit_nystrom_matrix(method)
    step = stepper(method, scalar)
    columns = [step(oscillator, q, v, X) for q, v in ((ONE, ZERO), (ZERO, ONE))]
    return tuple(tuple(fraction(x) for x in row) for row in zip(*columns, strict=True))


def linear_step_matrix(method: Method, rows: Sequence[Sequence[Exact | int]]) -> StepMatrix:
    """M(h) with z₁ = M(h) z₀ for z' = Az, A given by its rows.

    It is R(hA) for Runge-Kutta and collocation methods; splittings and Nyström methods need A = [[0, I], [K, 0]], that
    is q' = v, v' = Kq. Raises ValueError for any other A, and for one that is not square.
    """
    exact_rows = [[scalar(x) for x in row] for row in rows]
    if not exact_rows or any(len(row) != len(exact_rows) for row in exact_rows):
        raise ValueError("the matrix of a linear system must be square")
    r = stability_function_of(method)
    return of_matrix(r, exact_rows) if r is not None else _partitioned(method, exact_rows)


def matrix_trace(m: StepMatrix) -> RationalFunction:
    """The trace of a 2x2 matrix."""
    return m[0][0] + m[1][1]


def area_factor(m: StepMatrix) -> RationalFunction:
    """The determinant of a 2x2 matrix, the factor by which one step scales area."""
    (qq, qv), (vq, vv) = m
    return qq * vv - qv * vq


def energy_factor(m: StepMatrix) -> RationalFunction | None:
    """The factor μ with E(Mz) = μ E(z) for every z, as a function of h²; None if it depends on the state."""
    (qq, qv), (vq, vv) = m
    gained = qq * qq + vq * vq
    if gained != qv * qv + vv * vv or (qq * qv + vq * vv).num:
        return None
    return RationalFunction(deflate(gained.num), deflate(gained.den))


def is_matrix_symmetric(m: StepMatrix) -> bool:
    """True if M(h) M(-h) = I: on the oscillator a step of -h undoes a step of h."""
    back = tuple(tuple(reversed_sign(x) for x in row) for row in m)
    (qq, qv), (vq, vv) = _product(m, back)
    one, nil = fraction(ONE), fraction(ZERO)
    return (qq, qv, vq, vv) == (one, nil, nil, one)


def _product(a: StepMatrix, b: StepMatrix) -> StepMatrix:
    (p, q), (r, s) = b
    return tuple((x * p + y * r, x * q + y * s) for x, y in a)


def energy_multiplier_of(r: RationalFunction) -> RationalFunction:
    """|R(ih)|² as a function of h², the factor by which one step multiplies the energy of the oscillator."""
    return fraction(modulus_squared_on_imaginary_axis(r.num), modulus_squared_on_imaginary_axis(r.den))


def inflated(p: Polynomial) -> Polynomial:
    """The polynomial p(z²)."""
    return from_scalars([x for c in p.coeffs() for x in (c, c * 0)])


def _implicit_nystrom_matrix(method: Nystrom) -> StepMatrix:
    """M(h) of an implicit Nyström method, from bᵀ(I - zA)⁻¹v at z = -h², as k = -(I + h²A)⁻¹ (1 q + hc v)."""
    a = tuple(tuple(scalar(x) for x in row) for row in method.a)
    nodes, weights, rates = (tuple(scalar(x) for x in row) for row in (method.c, method.b_position, method.b_velocity))

    def response(b: tuple[Scalar, ...], v: tuple[Scalar, ...]) -> RationalFunction:
        found = resolvent(ScalarTableau(a, b, nodes, method.field), v)
        return fraction(inflated(reflected(found.num)), inflated(reflected(found.den)))

    step, square = fraction(X), fraction(X * X)
    one, ones = fraction(ONE), (ONE[0],) * len(nodes)
    return (
        (one - square * response(weights, ones), step - step * square * response(weights, nodes)),
        (-(step * response(rates, ones)), one - square * response(rates, nodes)),
    )


def _partitioned(method: Method, rows: list[list[Scalar]]) -> StepMatrix:
    """M(h) on q' = v, v' = Kq: [[α(h²K), hβ(h²K)], [hKγ(h²K), δ(h²K)]].

    The functions are those of the oscillator, K = -1, whose M(h) is [[α(-h²), hβ(-h²)], [-hγ(-h²), δ(-h²)]].
    """
    stiffness = stiffness_of(rows)
    if stiffness is None:
        raise ValueError(f"{method.key} needs a system q' = v, v' = Kq: the matrix must be [[0, I], [K, 0]]")
    (qq, qv), (vq, vv) = oscillator_matrix(method)
    step, per_step = fraction(X), fraction(ONE, X)
    blocks = [
        [_of_square(qq, stiffness, fraction(ONE)), _of_square(qv * per_step, stiffness, step)],
        [_of_square(vq * step, stiffness, per_step), _of_square(vv, stiffness, fraction(ONE))],
    ]
    return tuple((*left, *right) for row in blocks for left, right in zip(*row, strict=True))


def stiffness_of(rows: Sequence[Sequence[Scalar]]) -> list[list[Scalar]] | None:
    """The block K of the matrix [[0, I], [K, 0]] of a system q' = v, v' = Kq; None for any other matrix."""
    half, odd = divmod(len(rows), 2)
    expected = [[int(j == i + half) for j in range(2 * half)] for i in range(half)]
    if odd or [list(row) for row in rows[:half]] != expected or any(x for row in rows[half:] for x in row[half:]):
        return None
    return [list(row[:half]) for row in rows[half:]]


def _of_square(f: RationalFunction, stiffness: list[list[Scalar]], factor: RationalFunction) -> StepMatrix:
    """factor(h) φ(h²K), where φ(-h²) = f(h) for an even f."""
    phi = fraction(*(reflected(deflate(p)) for p in (f.num, f.den)))
    found = of_matrix(phi, stiffness)
    return tuple(tuple(fraction(inflated(x.num), inflated(x.den)) * factor for x in row) for row in found)
