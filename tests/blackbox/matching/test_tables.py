"""The parts that matching is made of: sizes beside exact sums, tables of variants, and the quick test before them."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.candidates import field_methods, force_methods
from driftproof.blackbox.matching.tables import (
    Fingerprint,
    bounded,
    induced_by_nystrom,
    induced_by_parts,
    induced_by_tableau,
    induced_repeated,
    tableau_of,
    tableau_repeated,
)
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.matching.readings import TOLD
from tests.looping import some


def test_sizes_add_up_where_values_cancel():
    x = bounded(Q(1, 3)) * bounded(Q(3)) - bounded(Q(1))
    assert not x
    assert x == 0
    assert (x.value, x.size) == (0, 2.0)


def test_reduction_keeps_sizes():
    third, rest = bounded(Q(1, 3)), bounded(Q(-1, 3))
    nothing = (bounded(0), bounded(0))
    ((merged,),) = reduced(StageCoefficients((nothing, nothing), ((third, rest),), nothing)).weights
    assert (merged.value, merged.size) == (0, 2 * (1 / 3))


def test_a_table_repeated_and_then_squared_is_one_squared_and_then_repeated():
    tableau = tableau_of(METHODS["kutta3"], Q)
    assert induced_by_tableau(tableau_repeated(tableau, 3)) == induced_repeated(induced_by_tableau(tableau), 3)


def test_a_splitting_without_kicks_drifts_and_does_nothing_else():
    nothing = StageCoefficients(((0,),), ((0,), (0,)), (Q(3, 4),))
    assert induced_by_parts([("drift", Q(1, 2)), ("kick", Q(0)), ("drift", Q(1, 4))], Q) == (nothing, Q(3, 4))


def test_a_nystrom_method_keeps_its_weights_apart():
    nystrom = METHODS["nystrom4"]
    table, drift = induced_by_nystrom(nystrom, Q)
    assert (table.weights, drift) == ((nystrom.b_position, nystrom.b_velocity), 1)
    assert (table.a, table.c) == (nystrom.a, nystrom.c)


def test_the_quick_test_lets_a_method_pass_for_itself_and_for_hardly_any_other():
    for methods in (field_methods(True), force_methods()):
        for one in some(methods, 40):
            rounding = Rounding(BINARY64, one.fingerprint.calls)
            passed = [other.key for other in methods if one.fingerprint.may_be(other.fingerprint, rounding)]
            assert one.key in passed
            assert len(passed) <= 4  # such as rk4, zonneveld43, gill4 and england45


CHAIN = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@pytest.mark.parametrize(("drift", "scale"), [(None, 1 + 1), (0.5, 1 + 1), (-3.0, 1 + 3)])
@pytest.mark.parametrize(("share", "may_be"), [(0.999, True), (1.001, False)])
def test_the_quick_test_allows_each_factor_of_its_longest_sum_what_rounding_does(drift, scale, share, may_be):
    rounding = Rounding(BINARY64, 1)
    off = share * rounding.of(2 * (11 + 4) * scale**3)
    one, less = (Fingerprint(StageCoefficients(((0.0,),), ((x,),), (0.0,)), drift) for x in (1.0, 1.0 - off))
    assert one.may_be(less, rounding) == less.may_be(one, rounding) == may_be


def test_the_quick_test_follows_slopes_over_two_stages_and_counts_no_stage_that_no_weight_reaches():
    last, doubled = ((0.0, 0.0, 1.0),), tuple(tuple((1 + (i == 1)) * x for x in row) for i, row in enumerate(CHAIN))
    one, other = (Fingerprint(StageCoefficients(a, last, (0.0,) * 3), 1.0) for a in (CHAIN, doubled))
    assert not one.may_be(other, Rounding(BINARY64, 3))
    assert (one.used, one.calls, one.scale) == (3, 3, 3.0)
    assert Fingerprint(StageCoefficients(CHAIN, ((0.0,) * 3,), (0.0,) * 3), 1.0).used == 1


def test_the_fingerprints_of_the_catalogue_are_what_they_were(as_before):
    tables = (*field_methods(True), *field_methods(False, implicit=True), *force_methods(), *force_methods(True))
    pairs = [(each.key, each.fingerprint) for each in tables if each.key in TOLD]
    as_before(*(f"{key} {one.calls} {one.used} {one.length:.9g} {one.scale:.9g}" for key, one in pairs))


def test_the_stages_that_count_are_counted_in_floats_as_they_are_exactly():
    for candidate in some((*field_methods(True), *force_methods()), 100):
        assert candidate.fingerprint.used == candidate.small.calls
