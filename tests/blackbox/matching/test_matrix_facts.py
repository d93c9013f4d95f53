"""Facts of a one-step matrix: its entries, determinant, energy and linear order."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb

from driftproof.blackbox.matching import matrix_facts as facts
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import oscillator_matrix

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


@pytest.mark.parametrize(("place", "order"), [(0, -1), (1, 0), (22, 21), (23, 22), (24, None)])
def test_the_order_is_that_of_the_first_power_in_which_any_entry_is_off(place, order):
    k, term, terms = Q(-2, 3), (Q(1), Q(0), Q(0), Q(1)), []
    for power in range(facts.SERIES_LENGTH + 1):
        terms.append(term)
        qq, qv, vq, vv = term
        term = tuple(x / (power + 1) for x in (vq, vv, -k * qq, -k * qv))
    for entry in range(4):
        series = [[arb(x.numerator) / x.denominator for x in each] for each in zip(*terms, strict=True)]
        assert facts.order_on_linear_system(series, k) is None
        series[entry][place] += 2.0**-40
        assert facts.order_on_linear_system(series, k) == order
    assert facts.order_on_linear_system([[arb(1)], [arb(0), arb(1)], [], [arb(1)]], Q(0)) is None


@pytest.mark.parametrize("key", ["velocity_verlet", "gauss2", "midpoint2"])
def test_the_matrix_and_the_facts_of_another_system_are_what_they_were(key, as_before):
    exact, systems = oscillator_matrix(METHODS[key]), ((1, Q(3)), (2, Q(-1, 3)))
    as_before(*(facts.matrix_facts(facts.scaled_matrix(exact, Q(a), k), k) for a, k in systems))
