"""Facts of a one-step matrix: its entries, determinant, energy, linear order, and how it differs from a method's."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb

from driftproof.blackbox.matching import matrix_facts as facts
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import rk4, symplectic_euler
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from tests.blackbox.matching.linear_fits import fit, like_rk4
from tests.blackbox.transcripts import to_twelve_digits


def drag_in_the_kick(q, v, h):
    v = v + h * (-q - 0.25 * v)
    return q + h * v, v


STRANGERS = {
    "dragged": drag_in_the_kick,
    "two methods in turn": lambda force, q, v, h: rk4(force, *symplectic_euler(force, q, v, h / 2), h / 2),
    "a wrong weight": like_rk4(1 / 23),
    "a weight off by 1e-10": like_rk4(1 / 24 + 1e-10),
}


@pytest.mark.parametrize("name", STRANGERS)
def test_what_no_method_explains_is_recovered_and_told_from_its_nearest(name, as_before):
    found = fit(STRANGERS[name])
    assert found.best is None
    as_before(*map(to_twelve_digits, found.lines), found.damping, found.facts)


LONG = [
    ([Q("1" * 120)], [1], "1" * 120),
    ([Q("1" * 121)], [1], "1.111111111e+120"),
    ([Q("9" * 121), Q(-2, 3), 0, 1], [1], "1e+121 - 0.6666666667*h + 1*h**3"),
    ([Q("9" * 121), *[0] * 9, Q(-2, 3), 0, 1], [1], "1e+121 - 0.6666666667*h**10 + 1*h**12"),
    ([Q("8" * 121)], [1, Q(-1, 3)], "(8.888888889e+120)/(1 - 0.3333333333*h)"),
]


@pytest.mark.parametrize(("num", "den", "text"), LONG)
def test_a_function_is_written_exactly_up_to_a_line_and_in_decimals_beyond(num, den, text):
    assert facts.text_of(fraction(*(polynomial(list(map(Q, part))) for part in (num, den)))) == text


def test_a_fraction_is_shown_with_a_denominator_up_to_a_million():
    assert [facts._shown(Q(1, 10**6)), facts._shown(Q(1, 10**6 + 1))] == ["1/1000000", "9.99999000001e-07"]


@pytest.mark.parametrize(("place", "order"), [(0, -1), (1, 0), (22, 21), (23, 22), (24, None)])
def test_the_order_is_that_of_the_first_power_in_which_any_entry_is_off(place, order):
    k, g, term, terms = Q(-2, 3), Q(1, 5), (Q(1), Q(0), Q(0), Q(1)), []
    for power in range(facts.SERIES_LENGTH + 1):
        terms.append(term)
        qq, qv, vq, vv = term
        term = tuple(x / (power + 1) for x in (vq, vv, -k * qq - g * vq, -k * qv - g * vv))
    for entry in range(4):
        series = [[arb(x.numerator) / x.denominator for x in each] for each in zip(*terms, strict=True)]
        assert facts.order_on_linear_system(series, k, g) is None
        series[entry][place] += 2.0**-40
        assert facts.order_on_linear_system(series, k, g) == order
    assert facts.order_on_linear_system([[arb(1)], [arb(0), arb(1)], [], [arb(1)]], Q(0), Q(0)) is None


@pytest.mark.parametrize("key", ["velocity_verlet", "gauss2", "midpoint2"])
def test_the_matrix_and_the_facts_of_another_system_are_what_they_were(key, as_before):
    exact, systems = oscillator_matrix(METHODS[key]), ((1, Q(3), Q(0)), (2, Q(-1, 3), Q(1, 7)), (1, Q(0), Q(0)))
    as_before(*(facts.matrix_facts(facts.scaled_matrix(exact, Q(a), k), k, g) for a, k, g in systems))
