"""Node polynomials of collocation: orthogonal, with the ends that their names say, and methods of the claimed order."""

from __future__ import annotations

from fractions import Fraction as Q
from itertools import product as pairs

import pytest

from driftproof.methods.tables.collocation import (
    gauss,
    gauss_nodes,
    lobatto_iiia,
    lobatto_nodes,
    radau_i,
    radau_iia,
    radau_left_nodes,
    radau_right_nodes,
)
from tests.looping import exactly
from tests.methods.tables.entries import product


def test_gauss_polynomials_are_orthogonal_to_each_other() -> None:
    polynomials = [gauss_nodes(s) for s in range(1, 11)]
    for p, q in pairs(polynomials, polynomials):
        integral = sum((x * Q(1, k + 1) for k, x in enumerate(product(p, q))), Q(0))
        assert (integral == 0) is (p != q)
    assert gauss_nodes(2) == (Q(1, 6), Q(-1), Q(1))
    assert radau_right_nodes(2) == (Q(1, 3), Q(-4, 3), Q(1))
    assert radau_left_nodes(2) == (Q(0), Q(-2, 3), Q(1))
    assert lobatto_nodes(3) == (Q(0), Q(1, 2), Q(-3, 2), Q(1))


def test_ends_are_nodes_where_the_names_say_so() -> None:
    for stages in (2, 3, 6):
        at_zero = [make(stages)[0] == 0 for make in (gauss_nodes, radau_left_nodes, radau_right_nodes, lobatto_nodes)]
        at_one = [sum(make(stages)) == 0 for make in (gauss_nodes, radau_left_nodes, radau_right_nodes, lobatto_nodes)]
        assert (at_zero, at_one) == ([False, True, False, True], [False, False, True, True])
    fewest = {gauss_nodes: 1, radau_left_nodes: 1, radau_right_nodes: 1, lobatto_nodes: 2}
    for make, stages in exactly(4, fewest.items()):
        assert len(make(stages)) == stages + 1
        with pytest.raises(ValueError, match=rf"{make.__name__}\({stages - 1}\): at least {stages} stages are needed"):
            make(stages - 1)


def test_tableau_of_given_precision_has_the_moments_of_its_order() -> None:
    """Σ bᵢ cᵢᵏ = 1/(k+1) up to the precision of the nodes: for k below the order, and not for the next."""
    for method, order in ((gauss(4), 8), (radau_i(3), 5), (radau_iia(4), 7), (lobatto_iiia(5), 8)):
        _, weights, nodes = method.tableau(200)
        off = [abs(sum(b * c**k for b, c in zip(weights, nodes, strict=True)) - Q(1, k + 1)) for k in range(order + 1)]
        assert max(off[:order]) < Q(1, 2**180)
        assert off[order] > Q(1, 2**30)
        assert method.claimed_order == order
