"""Many steps at once: squaring against stepping, the closed form against both, and the short powers of long runs."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import reduce

import pytest
import sympy
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.symbolic.algebra.certified import endpoints
from driftproof.symbolic.derivation.closed_form import STEPS, closed_form
from driftproof.symbolic.derivation.one_step import one_step_matrix
from driftproof.symbolic.n_steps import apply, as_balls, matrix_at, multiply, power, short_power
from tests.nine import NINE

IDENTITY = (1, 0, 0, 1)
MATRICES = st.tuples(*4 * [strategies.rationals(max_size=3, max_denominator=9)])


@given(MATRICES, st.integers(0, 20))
def test_power_is_repeated_multiplication(matrix: tuple[Q, Q, Q, Q], n: int) -> None:
    assert power(matrix, n) == reduce(multiply, [matrix] * n, IDENTITY)


@given(MATRICES, MATRICES, strategies.rational_states())
def test_product_applies_the_right_factor_first(a: tuple[Q, ...], b: tuple[Q, ...], state: tuple[Q, Q]) -> None:
    assert apply(multiply(a, b), *state) == apply(a, *apply(b, *state))


def test_order_of_factors_matters() -> None:
    shear, other = (1, 1, 0, 1), (1, 0, 1, 1)
    assert multiply(shear, other) != multiply(other, shear)


@given(MATRICES, st.integers(0, 40), st.integers(1, 200))
def test_short_power_is_the_power_or_nothing(matrix: tuple[Q, Q, Q, Q], n: int, bits: int) -> None:
    short, full = short_power(matrix, n, bits), power(matrix, n)
    length = max(max(abs(x.numerator), x.denominator).bit_length() for x in map(Q, full))
    assert short == full if short else length > bits or n > 0
    assert short is None or length <= bits or n == 0


def test_matrix_of_finite_order_has_short_powers_for_ever() -> None:
    sixth_of_a_turn = matrix_at(one_step_matrix(NINE["symplectic_euler"]), Q(1))
    assert short_power(sixth_of_a_turn, 6 * 10**100 + 1, 1) == sixth_of_a_turn
    growing = matrix_at(one_step_matrix(NINE["forward_euler"]), Q(1, 4))
    assert short_power(growing, 10**100, 4000) is None


@pytest.mark.parametrize("key", NINE)
@pytest.mark.parametrize("n", [0, 1, 2, 7, 100])
def test_closed_form_is_the_power(key: str, n: int) -> None:
    m, h = one_step_matrix(NINE[key]), Q(1, 2)
    exact = power(matrix_at(m, h), n)
    assert all(_encloses(form, x) for form, x in zip(_closed(key, n), exact, strict=True))


def test_closed_form_notices_one_step_too_few() -> None:
    exact = power(matrix_at(one_step_matrix(NINE["rk4"]), Q(1, 2)), 7)
    assert not all(_encloses(form, x) for form, x in zip(_closed("rk4", 6), exact, strict=True))


def _closed(key: str, n: int) -> list[sympy.Expr]:
    form = closed_form(one_step_matrix(NINE[key]))
    return list(form.subs({STEPS: n, sympy.Symbol("h"): sympy.Rational(1, 2)}))


def _encloses(form: sympy.Expr, x: Q) -> bool:
    """The two agree to 10^-40, certified. A tie of both cannot be decided by balls, so a distance is."""
    from driftproof.symbolic.algebra.certified import enclose

    with ctx.workprec(300):
        return bool(abs(enclose(form) - enclose(Q(x))) < arb(10) ** -40)


@given(MATRICES, st.integers(0, 50))
def test_balls_enclose_the_exact_power(matrix: tuple[Q, Q, Q, Q], n: int) -> None:
    for ball, exact in zip(power(as_balls(matrix), n), power(matrix, n), strict=True):
        low, high = endpoints(arb(ball))
        assert low <= exact <= high


def test_squaring_keeps_balls_narrow_where_stepping_does_not() -> None:
    matrix = as_balls(matrix_at(one_step_matrix(NINE["symplectic_euler"]), Q(1, 10)))
    stepped = reduce(lambda state, _: apply(matrix, *state), range(2000), (arb(1), arb(0)))
    squared = apply(power(matrix, 2000), arb(1), arb(0))
    assert squared[0].rad() < arb(10) ** -8
    assert stepped[0].rad() > 1
