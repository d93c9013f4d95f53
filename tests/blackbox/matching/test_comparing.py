"""Tables are compared stage by stage, in any order in which independent stages may be called."""

from __future__ import annotations

import pytest

from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import TABLEAUX, TIES, counted, in_field, ties_of
from tests.looping import some

TIES += [{"dop853", "dop853_third"}]


def in_another_order(method):
    """The method with two neighbours exchanged of which the later does not use the earlier; None if there are none."""
    rows, weights, nodes = codes.floats(method)
    for i in range(1, method.stages - 1):
        if not rows[i + 1][i] and i + 1 in counted(method):
            order = [*range(i), i + 1, i, *range(i + 2, method.stages)]
            return [[rows[k][m] for m in order] for k in order], [weights[k] for k in order], [nodes[k] for k in order]
    return None


REORDERED = [key for key in TABLEAUX if in_another_order(METHODS[key])]


@pytest.mark.parametrize("key", some(REORDERED, 3))
def test_the_order_in_which_independent_stages_are_called_does_not_matter(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    assert set(in_field(codes.tableau(rows, weights, nodes)).keys) == ties_of(key)


@pytest.mark.parametrize("key", REORDERED)
def test_stages_called_in_another_order_without_their_weights_are_another_method(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    own = codes.floats(METHODS[key])[1]
    assert (key in in_field(codes.tableau(rows, own, nodes)).keys) == (own == weights)
