"""R(z): Padé of the collocation families, the monomial tableau, and two formulas that agree."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import fmpq_poly

from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.polynomials import (
    coefficients,
    polynomial,
)
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.a_stability import (
    a_stability,
    l_stability,
)
from driftproof.symbolic.linear.stability_function import (
    NodeTableau,
    resolvent,
    scalar_tableau,
    stability_function_by_determinants,
    stability_function_by_moments,
    stability_function_of_collocation,
)
from tests.symbolic.linear.linear_examples import ROOT_2, ROOT_3, Z, pade, sdirk


def shifted_legendre(degree: int) -> Any:
    p = (Z**2 - Z) ** degree
    for _ in range(degree):
        p = p.derivative()
    return p


@pytest.mark.parametrize("stages", range(1, 11))
def test_gauss_radau_and_lobatto_are_pade(stages: int) -> None:
    """R of Gauss, Radau IIA and Lobatto IIIA on the diagonal, below it, and on the diagonal again."""
    below = shifted_legendre(stages - 1)
    gauss = stability_function_of_collocation(coefficients(shifted_legendre(stages)))
    assert gauss == pade(stages, stages)
    weight = shifted_legendre(stages)(1) / below(1)
    radau = stability_function_of_collocation(coefficients(shifted_legendre(stages) - below * weight))
    assert radau == pade(stages - 1, stages)
    assert a_stability(gauss).reason.startswith("|R(iy)| = 1 for every y")
    assert l_stability(radau)


@pytest.mark.parametrize("nodes", [(-1, 30, -210, 560, -630, 252), (0, 1), (-1, 1), (Q(2, 9), -1, 1), (1, -5, 5)])
def test_collocation_function_by_the_monomial_tableau(nodes: tuple[Q | int, ...]) -> None:
    """The second formula integrates in Q[x]/M and needs no node either."""
    monic = polynomial(nodes) / polynomial(nodes).leading_coefficient()
    assert stability_function_by_moments(NodeTableau.of(monic)) == stability_function_of_collocation(nodes)


def test_collocation_needs_a_node() -> None:
    with pytest.raises(ValueError, match="at least one node"):
        stability_function_of_collocation((3,))


# One γ over Q, and one over each of two fields.
GAMMAS = (Q(1, 4), Q(1, 2) + ROOT_3 / 6, 1 - ROOT_2 / 2)


@pytest.mark.parametrize("gamma", GAMMAS)
def test_two_formulas_for_r_agree_over_q_and_over_number_fields(gamma: Exact) -> None:
    data = scalar_tableau(sdirk(gamma))
    r = stability_function_by_moments(data)
    assert stability_function_by_determinants(data) == r
    one = fraction(fmpq_poly([1]))
    assert one + fraction(Z) * resolvent(data, data.power(0)) == r
