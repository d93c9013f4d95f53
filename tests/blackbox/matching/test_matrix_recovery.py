"""A matrix of no known method is recovered where it is simple, and told apart from its nearest method in words."""

from __future__ import annotations

from fractions import Fraction as Q
from math import sin

import numpy as np
import pytest

from driftproof.blackbox.matching.matrix_recovery import _shapes, recovered
from driftproof.blackbox.probes.linear_steps import DYADIC, LINEAR, NOT_DYADIC, LinearReading, read_linear_steps
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.algebra.polynomials import scalar
from driftproof.symbolic.rounding.formats import BINARY32
from tests.blackbox.matching.linear_fits import fit, like_rk4


def rational(q, v, h):
    d = 1 + h * h / 5
    return ((1 - h * h / 3) * q + h * v) / d, ((1 - h * h / 3) * v - h * q) / d


def odd_and_even(q, v, h):
    return q + h * v - h * h * q / 3 + h**3 * v / 7, v - h * q - h * v / 5 + 2 * h * h * v / 9


RECOVERED = {
    "a quotient": rational,
    "odd powers": odd_and_even,
    "another unit of time": lambda q, v, h: (q + h * v - h**2 * 10**6 * q / 3, v - h * 10**6 * q),
}


@pytest.mark.parametrize("name", RECOVERED)
def test_a_matrix_is_recovered_with_its_denominator_its_odd_powers_and_its_unit(name, as_before):
    found = fit(RECOVERED[name])
    assert found.best is None
    as_before(found.facts, found.damping, found.stiffness)


def test_what_is_no_function_of_low_degree_is_not_recovered():
    reading = read_linear_steps(opened(lambda q, v, h: (q + sin(h) * v, v - sin(3 * h) * q)))
    assert recovered(reading) is None


def test_polynomials_are_tried_before_quotients_and_small_ones_first():
    told = [[(shape.num, shape.den) for shape in _shapes(*given)] for given in ((None, 3), (1, 3))]
    assert told == [
        [((0,), ()), ((0, 1), ()), ((0, 1, 2), ()), ((0,), (1,)), ((0, 1), (1,)), ((0,), (1, 2))],
        [((1,), ()), ((1, 3), ()), ((1, 3, 5), ()), ((1,), (2,)), ((1, 3), (2,)), ((1,), (2, 4))],
    ]
    assert max(len(shape.den) for shape in _shapes(0, 9)) == 4


@pytest.mark.parametrize("step", [rational, like_rk4(1 / 23), odd_and_even])
def test_what_is_recovered_is_the_matrix_at_steps_that_were_not_read(step):
    entries = recovered(read_linear_steps(opened(step)))
    h = 0.37
    columns = step(1.0, 0.0, h), step(0.0, 1.0, h)
    for entry, x in zip(entries, (columns[0][0], columns[1][0], columns[0][1], columns[1][1]), strict=True):
        assert entry.exact
        exact = Q(str(entry.function(scalar(Q(h)))))
        assert abs(exact - Q(x)) <= Q(1, 2**50)


def irrational(q, v, h):
    """Entries that are even, odd, a quotient, and of all powers, of coefficients that no program prints."""
    s = h * h
    quotient = h * (1 - s * 0.2718281828459045) / (1 + s * 0.5772156649015329)
    vv = (1 + h * 0.1414213562373095) / (1 + h * 0.1732050807568877)
    qq = 1 - s * 0.3141592653589793 + s * s * 0.0223606797749979
    return qq * q + quotient * v, -h * (1 + s * 0.1098612288668110) * q + vv * v


@pytest.mark.parametrize("unit", [1.0, 64.0])
@pytest.mark.parametrize("array", [None, np.float32])
def test_a_coefficient_that_is_no_simple_number_is_known_up_to_an_error(unit, array, as_before):
    def slower(q, v, h):
        q1, v1 = irrational(q, v * unit, h / unit)
        return q1, v1 / unit

    entries = recovered(read_linear_steps(opened(slower, array=array)))
    shown = [[f"{float(c.value):.6g} {float(c.error):.6g}" for c in (*each.num, *each.den)] for each in entries]
    as_before(*("; ".join(each) for each in shown), *fit(slower).lines)


# Off at a step from which no coefficient is read, by so many roundings of its monomials; 3 are in 1 + h/3 - h**2/5.
@pytest.mark.parametrize(("share", "met"), [(0.999, True), (1.001, False)])
def test_all_other_values_are_met_to_18_roundings_for_each_power_of_h(share, met):
    tiny, steps = 2.0**-40, [Q(x) for x in (*DYADIC, *NOT_DYADIC, "2", "4", "16", "-2", "-4")]
    off = share * 18 * (3 + 1) * 2.0**-24
    values = {h: 1 + h / 3 - h * h / 5 for h in steps}
    values[Q(3, 10)] += Q(off) * (1 + Q(1, 10) + Q(9, 500))
    pairs = tuple((h, (y, 1 + h, -h, Q(1))) for h, y in values.items())
    reading = LinearReading(BINARY32, LINEAR, tiny=tiny, at_zero=(1.0, tiny, -tiny, 1.0), steps=pairs)
    found = recovered(reading)
    assert (found is not None and len(found[0].num) == 3) == met
