"""The parts that matching is made of: sizes beside exact sums, tables of variants, and the quick test before them."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.candidates import field_methods, field_variants, force_methods, force_variants
from driftproof.blackbox.matching.tables import (
    bounded,
    induced_by_nystrom,
    induced_by_tableau,
    induced_repeated,
    tableau_of,
    tableau_repeated,
)
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced
from driftproof.symbolic.rounding.formats import BINARY16, BINARY64
from tests.blackbox.transcripts import checksum
from tests.looping import some


def test_sizes_add_up_where_values_cancel():
    x = bounded(Q(1, 3)) * bounded(Q(3)) - bounded(Q(1))
    assert not x
    assert x == 0
    assert (x.value, x.size) == (0, 2.0)


def test_reduction_keeps_sizes():
    third, rest = bounded(Q(1, 3)), bounded(Q(-1, 3))
    stages = StageCoefficients(
        ((bounded(0), bounded(0)), (bounded(0), bounded(0))), ((third, rest),), (bounded(0), bounded(0))
    )
    ((merged,),) = reduced(stages).weights
    assert (merged.value, merged.size) == (0, 2 * (1 / 3))


def test_a_table_repeated_and_then_squared_is_one_squared_and_then_repeated():
    tableau = tableau_of(METHODS["kutta3"], Q)
    assert induced_by_tableau(tableau_repeated(tableau, 3)) == induced_repeated(induced_by_tableau(tableau), 3)


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


def test_the_stages_that_count_are_counted_in_floats_as_they_are_exactly():
    for candidate in some((*field_methods(True), *force_methods()), 100):
        assert candidate.fingerprint.used == candidate.small.calls


@pytest.mark.parametrize("methods", [field_methods(True), field_methods(False), force_methods()])
def test_what_is_compared_of_tables_is_what_it_was(methods, as_before):
    few = [one for one in some(methods, 40) if one.fingerprint.calls < 5]
    said = [f"{p.calls} {p.used} {p.length:.12g} {p.scale:.12g}" for p in (one.fingerprint for one in methods)]
    small = [f"{one.small.scales.tolist()} {one.small.length} {one.raw.calls}" for one in few]
    sums = [f"{float(x):.12g}" for one in few for sums in one.fingerprint._sums(0.75) for x in sums]
    half = [(one, Rounding(BINARY16, one.fingerprint.calls)) for one in methods]
    passed = [[other.key for other in few if one.fingerprint.may_be(other.fingerprint, r)] for one, r in half]
    as_before(*(checksum(" ".join(map(str, each))) for each in (said, small, sums)), *filter(None, passed[::7]))


VARIED = [*field_variants(True, 4, Q(1, 2)), *field_variants(False, 6, Q(1))]
VARIED += [*field_variants(True, 3, Q(2), implicit=True), *force_variants(3, Q(1, 2)), *force_variants(4, Q(1))]


def test_the_variants_that_are_looked_for_are_what_they_were(as_before):
    shown = [f"{each.key}, {each.relation}: {each.fingerprint.scale:.9g}" for each in some(VARIED, 40)]
    as_before(*shown[::12], checksum(" ".join(shown)))
