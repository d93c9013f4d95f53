"""Where roots lie relative to the unit circle: polynomials with roots that are known, and their neighbours."""

from fractions import Fraction as Q
from itertools import product

import pytest
from flint import fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.radicals import radical_form
from driftproof.symbolic.linear.root_condition import (
    half_plane_form,
    root_condition,
    root_condition_limit,
    valuation,
)
from driftproof.symbolic.linear.stability_limits import INFINITY
from tests.looping import some

# Factor | its largest root, as -1 inside, 0 on, 1 outside the circle.
FACTORS = {
    "-1 1": 0, "1 1": 0, "0 1": -1, "-1/2 1": -1, "-2 1": 1, "1 0 1": 0, "1 1 1": 0, "1 -6/5 1": 0, "1/2 1/2 1": -1,
    "2 1 1": 1, "1 -5/2 1": 1, "1 3 1": 1, "999/1000 1": -1, "1001/1000 1": 1,
}  # fmt: skip


def of(text):
    return polynomial([Q(word) for word in text.split()])


def test_products_of_known_factors_are_judged_by_their_roots():
    for first, second in some(product(FACTORS, repeat=2)):
        p = of(first) * of(second)
        found = root_condition(p)
        on = [name for name in (first, second) if FACTORS[name] == 0]
        outside = 1 in (FACTORS[first], FACTORS[second])
        assert found.holds == (not outside and len(set(on)) == len(on)), (first, second, found)
        assert found.strong == (found.holds and set(on) <= {"-1 1"})
        assert root_condition(p, 2).holds == (not outside)


@pytest.mark.parametrize(
    ("factors", "reason"),
    [
        (("-1 1", "-1 1"), "on the unit circle, 1 is a root of multiplicity 2"),
        (("1 1", "1 1", "1 1"), "on the unit circle, -1 is a root of multiplicity 3"),
        (("1 0 1", "1 0 1", "0 1"), "on the unit circle, a conjugate pair is a root of multiplicity 2"),
        (("1 3 1", "1 0 1"), "a root is outside the unit circle"),
        (("1 1", "-1 1", "1 0 1"), "no root is outside the unit circle; 1 and -1 and a conjugate pair"),
        (("-1 1", "0 1"), "no root is outside the unit circle; 1 is on it"),
        (("1 1", "0 1"), "no root is outside the unit circle; -1 is on it"),
        (("1 1", "1 0 1"), "no root is outside the unit circle; -1 and a conjugate pair are on it"),
        (("1 0 1", "1 1 1"), "no root is outside the unit circle; 2 conjugate pairs are on it"),
        (("1 0 1", "1 0 1", "1 1 1"), "on the unit circle, a conjugate pair is a root of multiplicity 2"),
        (("-1/2 1", "0 1"), "no root is outside the unit circle; none is on it"),
    ],
)
def test_the_reason_names_what_was_found(factors, reason):
    p = fmpq_poly([1])
    for factor in factors:
        p *= of(factor)
    assert root_condition(p).reason.startswith(reason)


@given(st.lists(st.fractions(-3, 3, max_denominator=20), min_size=1, max_size=5, unique=True))
def test_rational_roots_decide(roots):
    p = fmpq_poly([1])
    for root in roots:
        p *= polynomial([-root, Q(1)])
    assert root_condition(p).holds == all(abs(root) <= 1 for root in roots)


def test_a_limit_is_where_a_root_leaves_and_not_where_two_pass_inside():
    # ζ² - t leaves at 1; ζ - 1/2 + t/4 at 6; (ζ + t)² with its double root at 1; a circle root stays for ever.
    assert radical_form(root_condition_limit(of("0 0 1"), of("-1"))) == "1"
    assert radical_form(root_condition_limit(of("-1/2 1"), of("1/4"))) == "6"
    assert radical_form(root_condition_limit(of("1 -2 1"), of("0 1"))) == "4"
    assert root_condition_limit(of("0 1"), of("1/4 1")) is INFINITY
    assert radical_form(root_condition_limit(of("1 -1"), of("0 0 -1/2"))) == "0"
    with pytest.raises(ValueError, match="common root"):
        root_condition_limit(of("0 1"), of("0 1"))


def test_a_root_at_minus_one_lowers_the_degree_and_one_at_one_is_zero():
    form = half_plane_form(of("-1 0 1"), 2)
    assert (form.degree(), valuation(form)) == (1, 1)
