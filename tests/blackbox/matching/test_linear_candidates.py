"""A map explains a reading within what its programs may err by, and a map that is nearly right does not."""

from __future__ import annotations

from fractions import Fraction as Q
from itertools import product

import numpy as np
import pytest

from driftproof.blackbox.matching import linear_candidates as candidates
from driftproof.blackbox.matching.equivalent_methods import equivalent_methods
from driftproof.blackbox.matching.linear_candidates import Error, LinearCandidate
from driftproof.blackbox.probes.linear_steps import LINEAR, LinearReading, read_linear_steps
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Collocation
from driftproof.numeric.steppers import rk4
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.catalogue_steppers import float_subject, with_one_changed
from tests.blackbox.matching.linear_fits import VARIANTS, fit
from tests.blackbox.matching.readings import EACH, TOLD
from tests.blackbox.transcripts import Asked
from tests.looping import some

CHANGES = (lambda c: c + Q(1, 10**10), lambda c: -c)


@pytest.mark.parametrize("key", EACH)
def test_a_method_with_one_coefficient_wrong_is_not_named_that_method(key, as_before):
    each, said = next(each for each in equivalent_methods() if key in each.keys), []
    # Nodes that change sign are no nodes of a collocation method.
    for change in some(CHANGES[: 1 if isinstance(METHODS[key], Collocation) else 2]):
        reading = read_linear_steps(float_subject(with_one_changed(METHODS[key], change)))
        explained = candidates.explained_by(each, reading, *candidates.rates_of(reading), known=True)
        assert explained.error.in_bounds > 1 or explained.restriction or not explained.rates_are_right
        said.append(f"{explained.words}, {explained.error.in_bounds:.3g} bounds")
    if key in TOLD:
        as_before(*said)


@pytest.mark.parametrize(("step", "words"), VARIANTS, ids=[words for _, words in VARIANTS])
def test_a_method_with_its_step_or_its_rates_wrong_is_named(step, words, as_before):
    asked = Asked(step)
    found = fit(asked.code)
    assert (found.best.words, found.best.extras) == (words, 1)
    assert found.best.error.in_bounds <= 1
    as_before(*found.lines, asked)


def test_a_map_whose_steps_are_all_beyond_binary32_is_named():
    def verlet(q, v, h, k=2.0**-300):
        v -= h / 2 * k * q
        q += h * v
        return q, v - h / 2 * k * q

    assert fit(verlet).best.words == "velocity_verlet"


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


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["pefrl", "vefrl", "nystrom4", "suzuki_umeno8"])
def test_of_many_methods_that_few_bits_leave_alike_the_first_are_told(key, as_before):
    half = stepper(METHODS[key], np.float16)

    def step(force, q, v, h):
        with np.errstate(all="ignore"):
            return half(lambda x: np.float16(force(x)), np.float16(q), np.float16(v), np.float16(h))

    found = candidates.linear_candidates(read_linear_steps(opened(step)), known=False)
    assert len(found) <= 4
    as_before(*(f"{each.words}, {each.error.in_bounds:.3g} bounds" for each in found))


# A tiny step, of 2**-20 of the unit, tells a rate to 8 of its squares; a tinier one to 256 roundings.
@pytest.mark.parametrize(("bits", "slack"), [(21, 8 * 2.0**-42), (40, 2.0**8 * 2.0**-53)])
@pytest.mark.parametrize(("share", "simple"), [(0.99, True), (1.01, False)])
def test_a_rate_is_the_simple_number_that_is_as_near_as_a_tiny_step_tells(bits, slack, share, simple):
    tiny, (a, k) = 2.0**-bits, (Q(1, 3) * (1 + Q(share * slack)), Q(-5, 7))
    for unit in (1.0, 4.0):
        h = unit * tiny
        reading = LinearReading(BINARY64, LINEAR, unit=unit, tiny=h, at_zero=(1.0, float(a) * h, -float(k) * h, 1.0))
        assert [x in (Q(1, 3), Q(-5, 7)) for x in candidates.rates_of(reading)] == [simple, True]


def test_without_steps_nothing_is_nearly_exact():
    nothing = LinearReading(BINARY64, LINEAR, tiny=0.5, at_zero=(1.0, 0.5, -0.5, 1.0))
    assert candidates.nearly_exact(nothing, known=True) is None


def test_a_map_may_hold_ahead_or_up_to_the_unit_of_time_and_at_it():
    steps, unit = (-4.0, -2.0, 2.0, 4.0), 2.0
    held = [tuple(h for h in steps if kept(h)) for _, kept in candidates._restrictions(unit)]
    assert held == [steps, steps[2:], (-unit, unit), (unit,)]


RATES = [(1, 1), (-1, -1), (-1, 4), (Q(1, 4), Q(1, 4)), (1, 3), (2, 2)]


def test_a_candidate_is_said_with_all_that_makes_it_differ(as_before):
    keys = ("heun3", "kutta3"), ("symplectic_euler",), ()
    kinds = product(keys, (False, True), RATES, (False, True), ("", "but so"))
    found = [LinearCandidate(keys, turned, *ak, known, Error(1.0, 0), less) for keys, turned, ak, known, less in kinds]
    as_before(*(f"{each.words}: {each.extras}{', right' * each.rates_are_right}" for each in found))
    assert (Error(0.99, 0.0).is_rounding, Error(1.01, 0.0).is_rounding) == (True, False)
