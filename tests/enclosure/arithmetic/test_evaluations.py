"""Runs of a right-hand side: comparisons and floors are decided, recorded and replayed; constants are exact."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_series

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused, Replay
from driftproof.enclosure.arithmetic.models import TaylorModel
from driftproof.enclosure.arithmetic.numbers import Enclosed


def test_comparisons_are_decided_recorded_and_replayed():
    evaluation = Evaluation()
    x = Enclosed(evaluation, arb(1, 0.5))
    assert [x > 0, x < 0, x >= 2, x <= 2, x == 3, bool(x)] == [True, False, False, True, False, True]
    assert evaluation.taken == [True, False, False, True, False, True, False]  # != 0 asks >= and <=
    replayed = Replay(outcomes=[False])
    assert not Enclosed(replayed, arb(1, 0.5)) > 0
    with pytest.raises(Refused, match="a different branch"):
        _ = Enclosed(replayed, arb(1)) > 0
    with pytest.raises(Refused, match="whose enclosures overlap"):
        _ = x > 1


@pytest.mark.parametrize("x", [math.inf, math.nan, 1j, "1", None])
def test_constant_that_is_no_real_number_is_refused(x):
    with pytest.raises(Refused):
        Evaluation().constant(x)


def test_constants_are_exact_and_doubles_are_kept():
    evaluation = Evaluation()
    third = evaluation.constant(Fraction(1, 3))
    assert (3 * third - 1).contains(0)
    assert [float(evaluation.constant(x)) for x in (0.1, 2.0, np.float32(0.5), True)] == [0.1, 2.0, 0.5, 1.0]
    assert evaluation.doubles == {0.1, 0.5}


JUST_AFTER = (Fraction(0), None)


@pytest.mark.parametrize(
    ("x", "span", "found"),
    [
        (arb(2.5, 0.25), None, 2),
        (arb(-0.5, 0.25), JUST_AFTER, -1),
        (arb(2), None, 2),
        (arb(2), JUST_AFTER, "whose enclosures overlap"),
        (arb(2, 0.25), None, "whose enclosures overlap"),
        (arb(2.5, 1), None, "in a wide range, from 1"),
        (arb("nan"), None, "may be infinite"),
        (TaylorModel([arb(2.25), arb(0.5)], 3), JUST_AFTER, 2),
        (TaylorModel([arb(2.25), arb(-0.5)], 3), JUST_AFTER, "whose enclosures overlap"),
    ],
)
def test_floor_is_one_integer_or_refused(x, span, found):
    evaluation = Evaluation(span=span, forward=True)
    if isinstance(found, str):
        with pytest.raises(Refused, match=found):
            evaluation.floor(x)
    else:
        assert evaluation.floor(x) == found
        assert evaluation.taken == [found]
        assert Replay(outcomes=[found]).floor(x + 7) == found


def test_model_is_floored_both_ways_unless_it_goes_forward():
    falls_before = TaylorModel([arb(2.25), arb(0.5)], 3)
    with pytest.raises(Refused, match="overlap"):
        Evaluation(span=JUST_AFTER).floor(falls_before)


def test_a_model_is_positive_if_it_is_at_both_ends_of_its_time_and_a_series_where_it_begins():
    model = TaylorModel([arb(-1), arb(3)], 5)
    assert [Evaluation(forward=True).is_positive(x) for x in (model, -model, model + 2)] == [False, False, True]
    assert [Evaluation().is_positive(arb_series([arb(x), arb(-x)], 5)) for x in (1, 0, -1)] == [True, False, False]
