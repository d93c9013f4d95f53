"""The oscillator q' = v, v' = -q without a run: one-step matrices, exact and then rounded once, and their powers."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias

from methods.number_field import Exact
from methods.polynomials import derivative, value_at
from methods.problems import oscillator
from methods.schemes import Collocation, Method, MethodError, RungeKutta
from methods.stepping import stepper
from numeric.tableaux import solved

# The rows of M in z₁ = M z.
Matrix: TypeAlias = tuple[tuple[Any, Any], tuple[Any, Any]]


class Endpoint(NamedTuple):
    """A final state, and in `how` the way in which it was found, which is not by stepping."""

    q: float
    v: float
    how: str


def exact_matrix(method: Method, h: Fraction) -> Matrix:
    """M(h), exact, in Q or in the number field of the method: of an implicit method by solving its linear stages.

    Of a collocation method from its node polynomial, without any root. Raises MethodError for an implicit method of
    another family, ZeroDivisionError for an h at which the stages of an implicit method have no solution.
    """
    if isinstance(method, Collocation):
        return _of_stability_function(method, h)
    if method.explicit:
        step = stepper(method, lambda c: c)
        (qq, vq), (qv, vv) = (step(oscillator, *z, h) for z in ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))))
        return (qq, qv), (vq, vv)
    if not isinstance(method, RungeKutta):
        raise MethodError(f"{method.key} is implicit and no Runge-Kutta method; its stages are not solved here")
    return _of_stages(method, h)


def float_matrix(method: Method, h: float) -> Matrix:
    """M at the exact value of the float h, each entry rounded once: what a linear solve without rounding would give.

    Not the matrix of the method's float program, whose every operation is rounded. Raises as `exact_matrix`.
    """
    (a, b), (c, d) = exact_matrix(method, Fraction(h))
    return (float(a), float(b)), (float(c), float(d))


def endpoint(method: Method, start: tuple[float, float], h: float, steps: int) -> Endpoint:
    """The state after so many steps, by squaring M: about 2 log₂ N products of matrices in place of N steps.

    Its rounding is another than that of a run; to look at the rounding of runs, run. Raises as `exact_matrix`.
    """
    matrix, power, products = float_matrix(method, h), ((1.0, 0.0), (0.0, 1.0)), 0
    for bit in bin(steps)[2:] if steps else "":
        power, products = _product(power, power), products + 1
        if bit == "1":
            power, products = _product(power, matrix), products + 1
    (a, b), (c, d) = power
    q, v = start
    how = f"power {steps} of the one-step matrix, in {products} products of floats; no step was taken"
    return Endpoint(a * q + b * v, c * q + d * v, how)


def _product(x: Matrix, y: Matrix) -> Matrix:
    (a, b), (c, d) = x
    (e, f), (g, h) = y
    return (a * e + b * g, a * f + b * h), (c * e + d * g, c * f + d * h)


def _of_stages(method: RungeKutta, h: Fraction) -> Matrix:
    """From k_q = v + h A k_v, k_v = -q - h A k_q: (I + h²A²) k_q = v - h q A 1, for (q, v) = (1, 0), then (0, 1)."""
    a, stages = method.a, range(method.stages)
    square = [[_dot(row, [r[j] for r in a]) for j in stages] for row in a]
    matrix = [[(1 if i == j else 0) + h * h * square[i][j] for j in stages] for i in stages]
    columns = []
    for q, v in ((1, 0), (0, 1)):
        k_q = solved(matrix, [v - h * q * sum(row, Fraction(0)) for row in a])
        if k_q is None:
            raise ZeroDivisionError(f"{method.key}: at h = {h} the stage equations of the oscillator are singular")
        k_v = [-q - h * _dot(row, k_q) for row in a]
        columns.append((q + h * _dot(method.b, k_q), v + h * _dot(method.b, k_v)))
    (qq, vq), (qv, vv) = columns
    return (qq, qv), (vq, vv)


def _dot(x: Any, y: Any) -> Exact:
    return sum((a * b for a, b in zip(x, y, strict=True)), Fraction(0))


def _of_stability_function(method: Collocation, h: Fraction) -> Matrix:
    """((ρ, σ), (-σ, ρ)) for R(ih) = ρ + iσ, because (q - iv)' = i (q - iv).

    R(z) = Σ M⁽ˢ⁻ʲ⁾(1) zʲ / Σ M⁽ˢ⁻ʲ⁾(0) zʲ for the node polynomial M (hairer-wanner-1996, IV.3).
    """
    derivatives = [method.node_polynomial]
    for _ in range(method.stages):
        derivatives.append(derivative(derivatives[-1]))
    above, below = (_at_ih([value_at(p, Fraction(x)) for p in reversed(derivatives)], h) for x in (1, 0))
    size = below[0] * below[0] + below[1] * below[1]
    rho = (above[0] * below[0] + above[1] * below[1]) / size
    sigma = (above[1] * below[0] - above[0] * below[1]) / size
    return (rho, sigma), (-sigma, rho)


def _at_ih(coefficients: list[Fraction], h: Fraction) -> tuple[Fraction, Fraction]:
    """Real and imaginary part of Σ cⱼ (ih)ʲ."""
    parts = [Fraction(0), Fraction(0)]
    for j, c in enumerate(coefficients):
        parts[j % 2] += (-1) ** (j // 2) * c * h**j
    return parts[0], parts[1]
