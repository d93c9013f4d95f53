"""Tables are compared stage by stage, in any order in which independent stages may be called."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.candidates import ExactTable
from driftproof.blackbox.matching.candidates import in_field as in_field_of
from driftproof.blackbox.matching.candidates import on_force as on_force_of
from driftproof.blackbox.matching.comparing import Comparison
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import stepper
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import TABLEAUX, TIES, counted, in_field, ties_of

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


@pytest.mark.parametrize("key", REORDERED)
def test_the_order_in_which_independent_stages_are_called_does_not_matter(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    assert set(in_field(codes.tableau(rows, weights, nodes)).keys) == ties_of(key)


@pytest.mark.parametrize("key", REORDERED)
def test_stages_called_in_another_order_without_their_weights_are_another_method(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    own = codes.floats(METHODS[key])[1]
    assert (key in in_field(codes.tableau(rows, own, nodes)).keys) == (own == weights)


def test_independent_stages_are_there_to_be_exchanged():
    assert len(REORDERED) >= 3


@pytest.mark.parametrize("key", ["rk4", "rk38", "dormand_prince54", "ssprk104"])
@pytest.mark.parametrize("off", [0.0, 3 * 2.0**-53, 200 * 2.0**-53, 1e-9])
def test_what_is_seen_of_two_tables_is_what_it_was(key, off, as_before):
    exact, rounding = in_field_of(METHODS[key], True), Rounding(BINARY64, METHODS[key].stages)
    rows, weights, nodes = codes.floats(METHODS[key])
    weights[-1], rows[-1][0], nodes[1] = weights[-1] - off, rows[-1][0] + off / 2, nodes[1] * (1 + off)
    reading = read_tableau(opened(codes.tableau(rows, weights, nodes), "field"))
    found = Comparison(ExactTable.of(reading.stages, None), exact.raw, rounding)
    order = tuple(range(found.read.calls))
    seen = [f"{p.name}: {p.seen!r} {p.exact.size:.9g} {p.scale:.9g}" for p in found.differences()]
    as_before(found.size, found.arrangement(), found.distance(order), *seen)


@pytest.mark.parametrize("key", ["ruth3", "velocity_verlet", "nystrom4"])
@pytest.mark.parametrize("off", [0.0, 5 * 2.0**-53, 1e-9])
def test_what_is_seen_of_two_tables_of_forces_is_what_it_was(key, off, as_before):
    exact, rounding = on_force_of(METHODS[key]), Rounding(BINARY64, 4)
    step = stepper(METHODS[key], float)
    reading = read_forces(opened(lambda force, q, v, h: step(lambda x: (1 + off) * force(x), q, v, h)))
    found = Comparison(ExactTable.of(reading.stages, Q(reading.drift)), exact.raw, rounding)
    order = tuple(range(found.read.calls))
    as_before(found.size, found.arrangement(), found.distance(order), *(p.name for p in found.differences()))
