"""The parts that matching is made of: sizes beside exact sums, tables of variants, and the quick test before them."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.blackbox.matching.candidates import field_methods, force_methods
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
from driftproof.symbolic.rounding.formats import BINARY64
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
