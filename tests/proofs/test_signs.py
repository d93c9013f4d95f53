"""Root counts on open intervals, against polynomials whose roots are known because they were put there."""

from __future__ import annotations

from fractions import Fraction as Q
from math import prod

import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.symbolic.derivation.one_step import RING, H, rational
from proofs.derivations.signs import in_square_of_h, is_positive_between, rises_from_zero, roots_between

ROOTS = st.lists(st.fractions(-5, 5, max_denominator=6), max_size=5)
ENDS = st.none() | st.fractions(-6, 6, max_denominator=6)


@given(ROOTS, ENDS, ENDS)
def test_roots_are_counted_once_each_and_ends_not_at_all(roots: list[Q], low: Q | None, high: Q | None) -> None:
    if low is not None and high is not None:
        low, high = min(low, high), max(low, high)
    assume(low is None or low != high)
    polynomial = prod((H - rational(root) for root in roots), start=H**2 + 1)
    inside = {x for x in roots if (low is None or x > low) and (high is None or x < high)}
    assert roots_between(polynomial, low, high) == len(inside)


@given(ROOTS, st.fractions(-6, 6, max_denominator=6))
def test_sign_on_a_ray_is_that_beyond_the_last_root(roots: list[Q], low: Q) -> None:
    polynomial = prod((H - rational(root) for root in roots), start=RING.one)
    assert is_positive_between(polynomial, low, None) == all(x <= low for x in roots)


def test_touching_root_spoils_positivity_and_ends_do_not() -> None:
    assert not is_positive_between((H - 1) ** 2, Q(0), Q(2))
    assert is_positive_between((H - 1) ** 2, Q(1), Q(2))
    assert is_positive_between(H * (2 - H), Q(0), Q(2))
    assert not is_positive_between(-H * (2 - H), Q(0), Q(2))
    assert not is_positive_between(H * (2 - H), Q(0), Q(2) + Q(1, 10**40))


def test_root_between_ends_a_hair_apart_is_seen() -> None:
    near = Q(1) + Q(1, 10**50)
    assert roots_between((H - 1) * (H - rational(near)), Q(1), near) == 0
    assert roots_between(2 * H - 1 - rational(near), Q(1), near) == 1


def test_difference_to_a_taylor_polynomial_of_the_cosine_rises_from_zero_on_one_side_only() -> None:
    x = sympy.Symbol("x")
    above = sympy.cos(x) - 1 + x**2 / 2
    for difference, rises in ((above, True), (-above, False), (above + 1, False), (x**4 / 24 - above, True)):
        assert rises_from_zero(difference, x) is rises


def test_constant_has_no_roots_and_zero_has_no_count() -> None:
    assert roots_between(RING.one * 3, None, None) == 0
    with pytest.raises(ValueError, match="zero polynomial"):
        roots_between(RING.zero, Q(0), Q(1))


def test_even_polynomial_is_halved_and_an_odd_power_refused() -> None:
    assert in_square_of_h(1 - H**6 / 72 + H**8 / 576) == 1 - H**3 / 72 + H**4 / 576
    assert in_square_of_h(RING.zero) == 0
    with pytest.raises(ValueError, match=r"not a polynomial in h\*\*2"):
        in_square_of_h(1 + H**3)
