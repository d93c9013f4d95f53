"""A map explains a reading within what its programs may err by, and a map that is nearly right does not."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.equivalent_methods import equivalent_methods
from driftproof.blackbox.matching.linear_candidates import explained_by, rates_of
from driftproof.blackbox.probes.linear_steps import read_linear_steps
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation
from driftproof.numeric.steppers import rk4
from tests.blackbox.catalogue_steppers import float_subject, with_one_changed
from tests.blackbox.matching.linear_fits import VARIANTS, fit
from tests.blackbox.transcripts import Asked

CHANGES = {"off by 1e-10": lambda c: c + Q(1, 10**10), "sign flipped": lambda c: -c}
# Nodes that change sign are no nodes of a collocation method.
CHANGED = [
    pytest.param(key, change, id=f"{key} {name}")
    for key, method in METHODS.items()
    for name, change in CHANGES.items()
    if not (isinstance(method, Collocation) and name == "sign flipped")
]


@pytest.mark.parametrize(("key", "change"), CHANGED)
def test_a_method_with_one_coefficient_wrong_is_not_named_that_method(key, change, as_before):
    reading = read_linear_steps(float_subject(with_one_changed(METHODS[key], change)))
    each = next(each for each in equivalent_methods() if key in each.keys)
    explained = explained_by(each, reading, *rates_of(reading), known=True)
    assert explained.error.in_bounds > 1 or explained.restriction or not explained.rates_are_right
    as_before(explained.words, f"{explained.error.in_bounds:.3g} bounds")


@pytest.mark.parametrize(("step", "words"), VARIANTS, ids=[words for _, words in VARIANTS])
def test_a_method_with_its_step_or_its_rates_wrong_is_named(step, words, as_before):
    asked = Asked(step)
    found = fit(asked.code)
    as_before(*found.lines, asked)
    assert (found.best.words, found.best.extras) == (words, 1)
    assert found.best.error.in_bounds <= 1


def test_a_sloppy_solver_is_not_called_the_adjoint_of_a_method_that_is_its_own():
    def midpoint(q, v, h):
        d = 1 + h * h / 4
        q1, v1 = ((1 - h * h / 4) * q + h * v) / d, ((1 - h * h / 4) * v - h * q) / d
        return q1 * (1 + 300 * 2.0**-53), v1 * (1 - 300 * 2.0**-53)

    found = fit(midpoint)
    assert found.best is None
    assert found.nearest.methods[0] == "implicit_midpoint"


@pytest.mark.parametrize(("off", "named"), [(Q(1, 1024), True), (Q(-1, 1024), True), (Q(2, 2049), False)])
def test_a_rate_that_is_off_by_less_than_a_part_in_1024_is_no_factor_of_a_method(off, named):
    rate = float(1 + off)
    found = fit(lambda force, q, v, h: rk4(lambda x: rate * force(x), q, v, h))
    assert (found.best is not None) == named
