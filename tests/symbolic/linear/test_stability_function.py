"""R(z): Padé of the collocation families, and two formulas that agree."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.matrices import matrix_determinant
from driftproof.symbolic.algebra.polynomials import FieldPolynomial, exact, scalar
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.a_stability import a_stability, l_stability
from driftproof.symbolic.linear.stability_function import (
    ScalarTableau,
    prothero_robinson,
    resolvent,
    scalar_tableau,
    stability_function,
    stability_function_by_moments,
)
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import (
    GAUSS_2,
    GAUSS_3,
    LOBATTO_3,
    MIDPOINT,
    QIN_ZHANG,
    RADAU_3,
    RADAU_IIA_2,
    ROOT_2,
    ROOT_3,
    Z,
    by_determinants,
    gauss,
    pade,
    radau_iia,
    sdirk,
)


@pytest.mark.parametrize("stages", range(1, 11))
def test_gauss_and_radau_are_pade(stages: int) -> None:
    """R of Gauss and Radau IIA on the diagonal and below it."""
    r = stability_function(gauss(stages))
    assert r == pade(stages, stages)
    assert a_stability(r).reason.startswith("|R(iy)| = 1 for every y")
    below = stability_function(radau_iia(stages))
    assert below == pade(stages - 1, stages)
    assert l_stability(below)


# One γ over Q, and one over each of two fields.
GAMMAS = (Q(1, 4), Q(1, 2) + ROOT_3 / 6, 1 - ROOT_2 / 2)


@pytest.mark.parametrize("gamma", GAMMAS)
def test_two_formulas_for_r_agree_over_q_and_over_number_fields(gamma: Exact) -> None:
    data = scalar_tableau(sdirk(gamma))
    r = stability_function_by_moments(data)
    assert by_determinants(data) == r
    one = fraction(fmpq_poly([1]))
    assert one + fraction(Z) * resolvent(data, data.power(0)) == r


@pytest.mark.slow
def test_twelve_implicit_stages_over_a_number_field_take_no_division_with_remainder(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A Padé approximant by Euclid's algorithm took minutes here; the determinant by traces takes no remainder."""
    rows = [[ROOT_2 * Q(i - j, 1 + i * j) + Q(1 + i, 2 + j) for j in range(12)] for i in range(12)]
    weights = [ROOT_2 / (k + 1) - Q(k, 3) for k in range(12)]
    a, (b,) = (tuple(tuple(map(scalar, row)) for row in part) for part in (rows, [weights]))
    data = ScalarTableau(a, b, b, ROOT_2.field)
    with monkeypatch.context() as patch:
        patch.setattr(FieldPolynomial, "gcd", None)
        r = stability_function_by_moments(data)
    assert (r.num.degree(), r.den.degree()) == (12, 12)
    x = fmpq(1, 3)
    inner = [[int(i == j) - x * a for j, a in enumerate(row)] for i, row in enumerate(data.a)]
    shifted = [[a + x * w for a, w in zip(row, data.b, strict=True)] for row in inner]
    assert r(x) == matrix_determinant(shifted) / matrix_determinant(inner)


def test_order_reduction_functions_of_sdirk_and_radau() -> None:
    """ψₖ vanishes up to the stage order; Radau IIA is stiffly accurate: ψ tends to 0 as z grows."""
    zero = fraction(fmpq_poly())
    for power in (1, 2):
        assert prothero_robinson(RADAU_IIA_2, power) == zero
    third = prothero_robinson(RADAU_IIA_2, 3)
    assert third != zero
    assert third.at_infinity() == 0
    assert prothero_robinson(MIDPOINT, 1) == zero
    assert prothero_robinson(MIDPOINT, 2).at_infinity() == Q(1, 4)


@pytest.mark.parametrize("stages", [GAUSS_3, RADAU_3, LOBATTO_3])
def test_collocation_has_stage_order_s(stages: Collocation) -> None:
    zero = fraction(fmpq_poly())
    assert [prothero_robinson(stages, k) == zero for k in range(1, 5)] == [True, True, True, False]


def test_order_reduction_by_nodes_and_by_the_monomial_basis() -> None:
    by_nodes = Collocation("gauss2", "Gauss", 4, "x", (Q(1, 6), Q(-1), Q(1)))
    for power in range(1, 7):
        assert prothero_robinson(GAUSS_2, power) == prothero_robinson(by_nodes, power)


@pytest.mark.parametrize("method", [NINE["rk4"], RADAU_IIA_2, MIDPOINT, QIN_ZHANG])
def test_error_on_prothero_and_robinsons_problem(method: RungeKutta) -> None:
    """φ = t³ and a step from t = 1 by the stage equations, solved over Q: the error is Σ ψₖ(z) hᵏ φ⁽ᵏ⁾(1), exactly."""
    h, z, start = Q(1, 5), Q(-7, 3), Q(1)
    size, lam = method.stages, z / h
    times = [start + c * h for c in method.c]
    forcing = [3 * t**2 - lam * t**3 for t in times]
    # kᵢ = λ(y₀ + h Σ aᵢⱼ kⱼ) + forcingᵢ
    matrix = fmpq_mat([[scalar(Q(int(i == j)) - z * x) for j, x in enumerate(row)] for i, row in enumerate(method.a)])
    slopes = matrix.inv() * fmpq_mat(size, 1, [scalar(lam * start**3 + f) for f in forcing])
    end = start**3 + h * sum(b * exact(slopes[i, 0]) for i, b in enumerate(method.b))
    derivatives = {1: 3 * start**2, 2: 6 * start, 3: Q(6)}
    error = sum(exact(prothero_robinson(method, k)(scalar(z))) * h**k * d for k, d in derivatives.items())
    assert (start + h) ** 3 - end == error
    assert error != 0
