"""R(z) of a Runge-Kutta method: the factor by which one step multiplies the solution of y' = λy, z = hλ."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq_mat, fmpq_poly

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.matrices import characteristic_and_adjugate
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    descend,
    evaluate,
    from_scalars,
    polynomial,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.linear.tableaux import Tableau, tableau


def stability_function(method: RungeKutta) -> RationalFunction:
    """R(z) = 1 + z bᵀ(I - zA)⁻¹1 in lowest terms (hairer-wanner-1996, IV.3).

    Over Q an implicit method goes through characteristic polynomials, every other through moments.
    """
    data = tableau(method)
    if data.explicit or data.field:
        return stability_function_by_moments(data)
    return stability_function_by_determinants(data)


def stability_function_by_moments(data: Tableau) -> RationalFunction:
    """R(z) from 1 + Σ zᵏ⁺¹ bᵀAᵏ1: a polynomial of degree s for an explicit method, else P/Q with degrees at most s.

    2s + 1 coefficients of the series determine P/Q; Euclid's algorithm finds it (Padé).
    """
    one = ONE[0]
    if data.explicit:
        return RationalFunction(from_scalars([one, *data.moments(data.power(0), data.stages)]), ONE)
    return rational_from_series([one, *data.moments(data.power(0), 2 * data.stages)], data.stages)


def stability_function_by_determinants(data: Tableau) -> RationalFunction:
    """R(z) = det(I - zA + z1bᵀ) / det(I - zA) (hairer-wanner-1996, IV.3)."""
    ones = data.power(0)
    shifted = [[x - one * y for x, y in zip(row, data.b, strict=True)] for row, one in zip(data.a, ones, strict=True)]
    return fraction(_reversed_characteristic(data, shifted), _reversed_characteristic(data, data.a))


def stability_function_of_collocation(node_polynomial: Sequence[Exact | int]) -> RationalFunction:
    """R(z) = Σ M⁽ˢ⁻ʲ⁾(1) zʲ / Σ M⁽ˢ⁻ʲ⁾(0) zʲ for collocation at the roots of M (hairer-wanner-1996, IV.3).

    M has degree s; its coefficients are given constant term first, so no node need be known. Raises ValueError for a
    constant M.
    """
    nodes = polynomial(node_polynomial)
    if nodes.degree() < 1:
        raise ValueError("a collocation method has at least one node")
    derivatives = [nodes]
    for _ in range(nodes.degree()):
        derivatives.append(derivatives[-1].derivative())
    derivatives.reverse()
    at_one, at_zero = (from_scalars([_value(p, x) for p in derivatives]) for x in (1, 0))
    return fraction(at_one, at_zero)


def resolvent(data: Tableau, start: Sequence[Scalar]) -> RationalFunction:
    """bᵀ(I - zA)⁻¹v for v = start, in lowest terms."""
    if data.explicit:
        return RationalFunction(from_scalars(data.moments(start, data.stages)), ONE)
    return rational_from_series(data.moments(start, 2 * data.stages + 1), data.stages)


def rational_from_series(series: Sequence[Scalar], degree: int) -> RationalFunction:
    """The P/Q with deg P, deg Q <= degree whose Taylor series begins with these 2 degree + 1 coefficients.

    Remainders of Euclid's algorithm for (z**(2 degree + 1), series), stopped at that degree; P/Q is unique.
    """
    before, now = fmpq_poly([0] * len(series) + [1]), from_scalars(series)
    cofactor_before, cofactor = now * 0, now * 0 + 1
    before = now * 0 + before
    while now.degree() > degree:
        quotient, rest = divmod(before, now)
        before, now = now, rest
        cofactor_before, cofactor = cofactor, cofactor_before - quotient * cofactor
    return fraction(descend(now), descend(cofactor))


def _value(p: Polynomial, x: int) -> Scalar:
    return evaluate(p, p[0] * 0 + x) if p != 0 else ONE[0] * 0


def _reversed_characteristic(data: Tableau, rows: Sequence[Sequence[Scalar]]) -> Polynomial:
    """det(I - zA) for the matrix with these rows: its characteristic polynomial, coefficients reversed."""
    if data.field:
        return from_scalars([x + ONE[0] * 0 for x in characteristic_and_adjugate(rows)[0]])
    return fmpq_poly(fmpq_mat([list(row) for row in rows]).charpoly().coeffs()[::-1])
