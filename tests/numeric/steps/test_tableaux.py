"""Tableaux in floats: published ones bit for bit, exact nodes, and an elimination that is exact."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import MethodError
from driftproof.methods.tables.collocation import gauss, lobatto_iiia, radau_iia
from driftproof.numeric.steps.tableaux import float_tableau, solved

U = Q(1, 2**53)


PAIRS = [(gauss(2), "gauss2"), (gauss(3), "gauss3"), (radau_iia(3), "radau_iia3"), (lobatto_iiia(4), "lobatto_iiia4")]


@pytest.mark.parametrize(("collocation", "key"), PAIRS, ids=lambda x: x if isinstance(x, str) else x.key)
def test_a_tableau_formed_of_nodes_is_the_published_one_bit_for_bit(collocation, key):
    formed, published = float_tableau(collocation), float_tableau(METHODS[key])
    for name in ("a", "b", "c"):
        assert (getattr(formed, name) == getattr(published, name)).all()
    assert formed.stiffly_accurate == published.stiffly_accurate
    assert (formed.d is None) == (published.d is None)


def test_nodes_zero_one_and_a_half_are_exact():
    assert float_tableau(lobatto_iiia(5)).c.tolist()[::2] == [0.0, 0.5, 1.0]
    assert float_tableau(gauss(5)).c.tolist()[2] == 0.5


def test_weights_of_moves_undo_a():
    """Radau IIA's last stage is the result: d = (0, ..., 0, 1). Gauss's d times A gives b back."""
    assert float_tableau(METHODS["radau_iia3"]).d.tolist() == [0, 0, 1]
    table = float_tableau(METHODS["gauss2"])
    assert np.abs(table.d @ table.a - table.b).max() < 8 * float(U) * np.abs(table.d).sum()
    assert float_tableau(METHODS["trapezoid"]).d is None


def test_elimination_is_exact_and_tells_a_singular_matrix():
    assert solved([[Q(0), Q(2)], [Q(3), Q(1)]], [Q(1), Q(1)]) == [Q(1, 6), Q(1, 2)]
    assert solved([[Q(1), Q(2)], [Q(2), Q(4)]], [Q(1), Q(1)]) is None


def test_a_splitting_has_no_tableau():
    with pytest.raises(MethodError, match="no tableau"):
        float_tableau(METHODS["velocity_verlet"])
