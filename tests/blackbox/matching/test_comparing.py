"""Tables are compared stage by stage, in any order in which independent stages may be called."""

from __future__ import annotations

from fractions import Fraction as Q
from math import ceil

import pytest

from driftproof.blackbox.matching.candidates import ExactTable
from driftproof.blackbox.matching.comparing import Comparison
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients
from driftproof.symbolic.rounding.formats import BINARY16, BINARY64
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import TABLEAUX, counted, in_field, ties_of
from tests.looping import some


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


# Each number of a table, and the largest of its column: a kick moves a place by itself times what is drifted since.
NUMBERS = {
    "a[1][0]": (Q(1, 2), Q(1, 2)), "b_position[0]": (Q(1, 4), Q(1, 2)), "b_position[1]": (Q(3, 4), Q(3, 2)),
    "b_velocity[0]": (Q(1, 8), Q(1, 2)), "b_velocity[1]": (Q(1), Q(3, 2)), "c[0]": (Q(0), Q(3, 2)),
    "c[1]": (Q(3, 2), Q(3, 2)), "drift": (Q(1), Q(1)),
}  # fmt: skip


def table(name="", off=Q(0)):
    a, p, q, v, w, c, d, drift = (x + off * (key == name) for key, (x, _) in NUMBERS.items())
    return ExactTable.of(StageCoefficients(((Q(0), Q(0)), (a, Q(0))), ((p, q), (v, w)), (c, d)), drift)


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_number_is_the_same_up_to_the_roundings_of_its_column(name, sign):
    exact, rounding = table(), Rounding(BINARY16, 2)
    value, scale = NUMBERS[name]
    for roundings in some((rounding.most + Q(9, 10), rounding.most + Q(11, 10))):  # one more than a program's
        compared = Comparison(table(name, sign * roundings * BINARY16.u * scale), exact, rounding)
        same = roundings < rounding.most + 1
        assert [place.name for place in compared.differences()] == [name] * (not same)
        assert compared.arrangement() == ((0, 1) if same else None)
        own = ceil(roundings * scale / value) if value else rounding.most + 1
        assert compared.distance((0, 1)) == (own, ceil(roundings), name)
        assert compared.size == len(NUMBERS)


def chain(first, size=40):
    rows = tuple(tuple(Q(j == i - 1) for j in range(size)) for i in range(size))
    weights = tuple(Q(j == size - 1) for j in range(size))
    return ExactTable.of(StageCoefficients(rows, (weights, weights), (Q(first), *[Q(1)] * (size - 1))), None)


@pytest.mark.parametrize(("first", "tried"), [(1, 0), (0, 40)])
def test_long_chains_are_told_apart_without_trying_all_orders(first, tried, monkeypatch):
    trials, fits = [], Comparison._fits
    monkeypatch.setattr(Comparison, "_fits", lambda self, chosen: trials.append(chosen) or fits(self, chosen))
    arranged = Comparison(chain(1), chain(first), Rounding(BINARY64, 40)).arrangement()
    assert (arranged == tuple(range(40)), len(trials)) == (first == 1, tried)
