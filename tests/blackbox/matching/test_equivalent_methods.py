"""What any program of a method may err by is its definition's any-order bound, or wider; adjoints are the inverses."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest
from flint import arb, ctx

from driftproof.blackbox.judging.nonlinear_step import error_above
from driftproof.blackbox.matching import equivalent_methods as classes
from driftproof.blackbox.matching.equivalent_methods import CountedSizes, ExactFlowMap, FloatTally, Rates
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.probes.linear_steps import LINEARITY_ROUNDINGS, LINEARITY_STEP
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.linear.reduced_tableau import is_symmetric
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from tests.blackbox.matching.readings import EXPLICIT, TOLD
from tests.looping import exactly, some
from tests.witnesses.any_order import any_order

MAPS = (*classes.equivalent_methods(), *classes.adjoint_methods(), ExactFlowMap())


@pytest.mark.parametrize("key", ["symplectic_euler", "velocity_verlet", "midpoint2", "rk4", "heun3", "nystrom4"])
@pytest.mark.parametrize("h", [0.25, 2.0])
def test_the_bound_of_a_method_is_nowhere_below_its_any_order_bound(key, h):
    each = next(each for each in classes.equivalent_methods() if key in each.keys)
    bound = any_order(METHODS[key])
    columns = bound.error_of(Q(h), Q(1), Q(0)), bound.error_of(Q(h), Q(0), Q(1))
    its = columns[0][0], columns[1][0], columns[0][1], columns[1][1]
    allowed = each.allowances(Rates(h, 1.0, 1.0), BINARY64)
    assert all(x <= y for x, y in zip(its, allowed, strict=True))


def matrix_by_stages(method, h):
    """M(h) in floats, from one linear system for the slopes of all stages."""
    rows, weights, _ = exact_tableau(method)
    a, b, field = np.array(rows, dtype=float), np.array(weights, dtype=float), np.array([[0.0, 1.0], [-1.0, 0.0]])
    slopes = np.linalg.solve(np.eye(2 * len(b)) - h * np.kron(a, field), np.tile(field, (len(b), 1)))
    return (np.eye(2) + h * np.kron(b, np.eye(2)) @ slopes).ravel()


def test_a_program_of_an_implicit_method_errs_by_no_more_than_its_bound_and_not_by_far_less():
    """The systems of sdirk4 are the worst conditioned, with entries of A up to 5."""
    seen = dict[str, float]()
    for each in (each for each in classes.equivalent_methods() if not each.programs):
        for h in (0.3, 0.7, 1.1, 2.0):
            exact, allowed = each.matrix_at(Q(h), Q(1), Q(1)), each.allowances(Rates(h, 1.0, 1.0), BINARY64)
            entries = exactly(4, zip(matrix_by_stages(each.methods[0], h), exact, allowed, strict=True))
            off = max(error_above(x, ball) / most for x, ball, most in entries)
            seen[each.keys[0]] = max(off, seen.get(each.keys[0], 0.0))
    assert len(seen) > 20
    assert max(seen.values()) <= 1
    assert min(seen.values()) > 1 / 200


X = FloatTally(CountedSizes(np.array([0.75, 0.5]), 3), additions=2)
Y = FloatTally(CountedSizes(np.array([4.0]), 1))
NOTHING, ONE = FloatTally(CountedSizes(np.zeros(0))), FloatTally(CountedSizes(np.ones(1)), factor=1)


@pytest.mark.parametrize(
    ("made", "sizes", "roundings"),
    [
        (X + Y, [4.75, 0.5], 3 + 2 + 0 + 1), (X * Y, [3.0, 2.0], 5 + 1 + 1), (X + NOTHING, [0.75, 0.5], 5),
        (X * NOTHING, [], 0), (X * ONE, [0.75, 0.5], 5),
    ],
)  # fmt: skip
def test_each_operation_adds_up_sizes_and_roundings(made, sizes, roundings):
    assert (made.finished.sizes.tolist(), made.finished.count) == (sizes, roundings)


def test_every_map_has_the_same_values_in_floats_and_balls_up_to_what_it_allows():
    h, a, k = Q(1, 4), Q(1), Q(5, 4)
    rates = Rates(float(h), float(a), float(k))
    for each in some(MAPS[:-1], 60):
        (in_floats,), in_balls = classes.all_matrices((each,), rates).tolist(), each.matrix_at(h, a, k)
        allowed = each.allowances(rates, BINARY64)
        entries = exactly(4, zip(in_floats, in_balls, allowed, strict=True))
        assert all(abs(x - float(ball.mid())) <= most for x, ball, most in entries)


def test_the_exact_flow_is_that_of_a_long_series_for_both_signs_of_the_stiffness():
    for k in (Q(5, 4), Q(-3, 2)):
        a, h, term, total = Q(2), Q(1, 2), np.eye(2, dtype=object), np.zeros((2, 2), dtype=object)
        field = np.array([[Q(0), a], [-k, Q(0)]], dtype=object) * h
        for i in range(1, 40):
            total, term = total + term, term.dot(field) / i
        seen = ExactFlowMap().matrix_at(h, a, k)
        assert all(abs(float(x) - float(y)) < 1e-15 for x, y in exactly(4, zip(seen, total.ravel(), strict=True)))


def test_self_adjoint_methods_are_never_called_the_adjoint_of():
    adjoints = {key for each in classes.adjoint_methods() for key in each.keys}
    assert "ruth3" in adjoints
    assert not {key for key, method in METHODS.items() if is_symmetric(method)} & adjoints
    assert not {"gauss3", "implicit_midpoint", "lobatto_iiib4", "yoshida6_position_first"} & adjoints


def test_an_adjoint_is_the_inverse_of_the_step_back_and_no_method_of_the_catalogue():
    h, one = Q(3, 2), Q(1)
    known = {each.keys: each for each in classes.equivalent_methods()}
    assert classes.adjoint_methods()
    for each in classes.adjoint_methods():
        a, b, c, d = each.matrix_at(h, one, one)
        back = known[each.keys].matrix_at(-h, one, one)
        with ctx.workprec(classes.CERTIFYING_BITS):
            product = [a * back[0] + b * back[2], a * back[1] + b * back[3], c * back[0] + d * back[2]]
        assert all(x.overlaps(arb(y)) and x.rad() < 1e-60 for x, y in zip(product, (1, 0, 0), strict=True))
        values = classes.all_matrices(classes.equivalent_methods(), Rates(float(h), 1.0, 1.0))
        assert np.abs(values - [float(x) for x in (a, b, c, d)]).max(axis=1).min() > 1e-13


# The second is of a repelling force and goes back in time; without a rate, underflow is all that is allowed.
RATES = {"of h": Rates(0.75, 1.0, 1.0), "of all": Rates(-0.375, 2.0, -0.8), "of no position": Rates(0.3, 0.0, 5.0)}


@pytest.mark.parametrize("name", RATES)
def test_what_a_map_allows_is_what_it_was(name, as_before):
    allowed = [
        (each, each.allowances(RATES[name], BINARY32)) for each in MAPS if {*getattr(each, "keys", TOLD)} & {*TOLD}
    ]
    as_before(*(f"{getattr(each, 'keys', 'exact')[0]} {' '.join(f'{x:.6g}' for x in most)}" for each, most in allowed))


@pytest.mark.parametrize("key", EXPLICIT)
def test_no_program_of_the_catalogue_is_taken_for_nonlinear(key):
    each = next(each for each in classes.equivalent_methods() if key in each.keys)
    rates = Rates(float(LINEARITY_STEP), 1.0, 1.0)
    allowed, values = each.allowances(rates, BINARY64), classes.all_matrices((each,), rates)[0].tolist()
    u = float(BINARY64.u)
    assert all(s <= LINEARITY_ROUNDINGS * u * (1 + abs(x)) for s, x in exactly(4, zip(allowed, values, strict=True)))


def test_methods_with_one_matrix_are_one_class():
    found = [each.keys for each in classes.equivalent_methods() if "rk38" in each.keys]
    assert [keys[0] for keys in found] == ["rk4"]
    assert sorted(key for each in classes.equivalent_methods() for key in each.keys) == sorted(METHODS)
