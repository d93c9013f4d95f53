"""The oscillator q' = v, v' = -q without a run: one-step matrices, exact and then rounded once, and their powers."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import lcm
from operator import mul
from typing import Any, NamedTuple, TypeAlias

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta
from driftproof.methods.stepping import oscillator, stepper
from driftproof.numeric.tableaux import solved

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
        rho, sigma, size = _turn(method, h)
        return _rotation(Fraction(rho, size), Fraction(sigma, size))
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
    if isinstance(method, Collocation):
        rho, sigma, size = _turn(method, h)
        return _rotation(rho / size, sigma / size)  # whole numbers divide with one rounding
    (a, b), (c, d) = exact_matrix(method, Fraction(h))
    return (float(a), float(b)), (float(c), float(d))


def endpoint(method: Method, start: tuple[float, float], h: float, steps: int) -> Endpoint:
    """The state after so many steps, by squaring M: about 2 log₂ N products of matrices in place of N steps.

    Its rounding is another than that of a run; to look at the rounding of runs, run. Raises as `exact_matrix`.
    """
    (a, b), (c, d), products = *_power(float_matrix(method, h), steps), _products(steps)
    q, v = start
    how = f"power {steps} of the one-step matrix, in {products} products of floats; no step was taken"
    return Endpoint(a * q + b * v, c * q + d * v, how)


def _power(matrix: Matrix, n: int) -> Matrix:
    """matrix**n, by the binary digits of n, the leading one first.

    The matrix of a Runge-Kutta method is ((ρ, σ), (-σ, ρ)), and Python multiplies the numbers ρ + iσ in the operations
    of such matrices, in a tenth of the time.
    """
    (a, b), (c, d) = matrix
    if a == d and b == -c:
        power = complex(a, b) if n else complex(1)
        for bit in bin(n)[3:]:
            power = power * power
            if bit == "1":
                power = power * complex(a, b)
        return _rotation(power.real, power.imag)
    result = matrix if n else ((1.0, 0.0), (0.0, 1.0))
    for bit in bin(n)[3:]:
        result = _product(result, result)
        if bit == "1":
            result = _product(result, matrix)
    return result


def _products(n: int) -> int:
    """How many products that takes."""
    return max(0, n.bit_length() - 1 + n.bit_count() - 1)


def _rotation(rho: Any, sigma: Any) -> Matrix:
    return (rho, sigma), (-sigma, rho)


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


def _turn(method: Collocation, h: Fraction | float) -> tuple[int, int, int]:
    """Whole numbers (nρ, nσ, n) with R(ih) = ρ + iσ, where M = ((ρ, σ), (-σ, ρ)), because (q - iv)' = i (q - iv).

    In whole numbers, because fractions would be reduced after every operation.
    """
    above, below = _stability_function(method)
    (p, w), last = h.as_integer_ratio(), len(below) - 1
    terms = [p**j * w ** (last - j) for j in range(last + 1)]
    (a, b), (c, d) = ([sum(map(mul, x[i::2], terms[i::2])) for i in (0, 1)] for x in (above, below))
    return a * c + b * d, b * c - a * d, c * c + d * d


@cache
def _stability_function(method: Collocation) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Numerator and denominator of R(iy) without their powers of i, constant term first, times one whole number.

    R(z) = Σ M⁽ˢ⁻ʲ⁾(1) zʲ / Σ M⁽ˢ⁻ʲ⁾(0) zʲ for the node polynomial M (hairer-wanner-1996, IV.3). Of iʲ the sign is kept,
    and that odd powers are imaginary.
    """
    derivatives = [method.node_polynomial]
    for _ in range(method.stages):
        derivatives.append(tuple(k * x for k, x in enumerate(derivatives[-1]))[1:])
    above = [(-1) ** (j // 2) * sum(p) for j, p in enumerate(reversed(derivatives))]
    below = [(-1) ** (j // 2) * p[0] for j, p in enumerate(reversed(derivatives))]
    common = lcm(*(c.denominator for c in (*above, *below)))
    return tuple(int(c * common) for c in above), tuple(int(c * common) for c in below)
