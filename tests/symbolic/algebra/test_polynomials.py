"""Polynomials over Q and over number fields: each verb against a second way to the same thing."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import Algebraic, NumberField, cube_root, square_root
from driftproof.symbolic.algebra.polynomials import (
    FieldPolynomial,
    at_ball,
    deflate,
    exact,
    from_scalars,
    greatest_common_divisor,
    interpolate,
    modulus_squared_on_imaginary_axis,
    polynomial,
    quotient,
    reflected,
    scalar,
    sign,
    squarefree,
)

ROOT_3, ROOT_2, CUBE_2 = square_root(3), square_root(2), cube_root(2)
GAMMA = NumberField("gamma", (-1, 9, -18, 6), Q(2, 5), Q(1, 2)).generator
X = fmpq_poly([0, 1])
RATIONAL = st.fractions(-5, 5, max_denominator=12)


def elements(generator: Algebraic) -> st.SearchStrategy[Any]:
    size = generator.field.degree
    return st.tuples(*size * [RATIONAL]).map(lambda c: Algebraic(generator.field, c))


ELEMENT = st.one_of(elements(ROOT_3), elements(CUBE_2), elements(GAMMA))
PAIR = st.sampled_from([ROOT_3, CUBE_2, GAMMA]).flatmap(lambda g: st.tuples(elements(g), elements(g)))


@given(PAIR)
def test_scalars_compute_as_the_data_do(pair: tuple[Algebraic, Algebraic]) -> None:
    a, b = pair
    x, y = scalar(a), scalar(b)
    assert (exact(x + y), exact(x - y), exact(x * y)) == (a + b, a - b, a * b)
    assert sign(x - y) == (a > b) - (a < b)
    assume(b != 0)
    assert exact(x / y) == a / b
    assert exact(1 / y) * b == 1


@pytest.mark.slow
@given(st.lists(elements(CUBE_2), min_size=1, max_size=5), st.lists(elements(CUBE_2), min_size=1, max_size=4))
def test_division_over_a_number_field_leaves_a_smaller_rest(a: list[Algebraic], b: list[Algebraic]) -> None:
    p, q = (scalar(CUBE_2) * 0 + polynomial(c) for c in (a, b))
    assume(q != 0)
    ratio, rest = divmod(p, q)
    assert ratio * q + rest == p
    assert rest.degree() < max(q.degree(), 1)
    assert (p // q, p % q) == (ratio, rest)


def test_gcd_over_a_number_field_finds_the_irrational_common_root() -> None:
    common, other = polynomial([-ROOT_3, 1]), polynomial([1, 2, 1])
    assert greatest_common_divisor(polynomial([-3, 0, 1]), common * other) == common
    assert greatest_common_divisor(polynomial([-3, 0, 1]), other).degree() == 0
    assert squarefree(common * common * other) == common * polynomial([1, 1])
    assert quotient(polynomial([-3, 0, 1]), common) == polynomial([ROOT_3, 1])
    with pytest.raises(ValueError, match="remainder"):
        quotient(other, common)


def test_norm_is_the_product_of_the_conjugates() -> None:
    p = polynomial([ROOT_3, 1 - ROOT_3, 0, 1])
    conjugate = polynomial([-ROOT_3, 1 + ROOT_3, 0, 1])
    assert p * conjugate == p.norm()
    q = polynomial([-CUBE_2, 1])
    assert q.norm() == X**3 - 2
    assert interpolate(lambda k: fmpq(k * k), 4) == X**2


def test_rational_coefficients_descend_to_q_and_two_fields_do_not_mix() -> None:
    square = polynomial([ROOT_3, 1]) * polynomial([-ROOT_3, 1])
    assert isinstance(square, FieldPolynomial)
    assert repr(polynomial([1, ROOT_3])) == "FieldPolynomial(1, sqrt(3))"
    assert from_scalars(square.coeffs()) == X**2 - 3
    assert not isinstance(from_scalars(square.coeffs()), FieldPolynomial)
    with pytest.raises(TypeError, match="no exact arithmetic"):
        scalar(ROOT_3) + scalar(ROOT_2)
    with pytest.raises(TypeError, match="no exact arithmetic"):
        polynomial([ROOT_3, ROOT_2])


@pytest.mark.parametrize("value", [0.5, True, "1/2", 1j, None])
def test_scalar_refuses_what_is_not_exact(value: Any) -> None:
    with pytest.raises(TypeError, match="exact arithmetic takes"):
        scalar(value)


def test_field_elements_refuse_floats_and_division_by_zero() -> None:
    for foreign in (0.5, True):
        with pytest.raises(TypeError, match="no exact arithmetic"):
            scalar(ROOT_3) + foreign
    with pytest.raises(ZeroDivisionError):
        scalar(ROOT_3) / 0
    with pytest.raises(ZeroDivisionError):
        (scalar(ROOT_3) * 0).inverse()
    with pytest.raises(ValueError, match="only an element"):
        polynomial([0, ROOT_3]).inverse()


@given(ELEMENT)
def test_sign_of_an_element_agrees_with_its_square_root_free_definition(x: Algebraic) -> None:
    assert sign(scalar(x)) == x.sign()
    assert sign(scalar(x) - scalar(x)) == 0


def test_generator_ball_lies_in_the_interval_and_on_the_polynomial() -> None:
    for generator in (ROOT_3, CUBE_2, GAMMA):
        with ctx.workprec(200):
            ball = generator.field.ball()
            low, high = (
                arb(fmpq(end.numerator, end.denominator)) for end in (generator.field.low, generator.field.high)
            )
            assert low < ball < high
            assert at_ball(polynomial(generator.field.minimal), ball).contains(0)
            assert ball.rad() < arb(2) ** -150


@given(st.lists(RATIONAL, min_size=1, max_size=6), RATIONAL)
def test_size_on_the_imaginary_axis_is_a_sum_of_two_squares(c: list[Q], y: Q) -> None:
    p = polynomial(c)
    real = sum(x * y**k * (1, 0, -1, 0)[k % 4] for k, x in enumerate(c))
    imaginary = sum(x * y**k * (0, 1, 0, -1)[k % 4] for k, x in enumerate(c))
    assert exact(modulus_squared_on_imaginary_axis(p)(scalar(y * y))) == real**2 + imaginary**2
    assert exact(reflected(p)(scalar(y))) == exact(p(scalar(-y)))


def test_in_square_refuses_odd_powers() -> None:
    assert deflate(polynomial([1, 0, 2])) == polynomial([1, 2])
    with pytest.raises(ValueError, match="odd power"):
        deflate(polynomial([1, 1]))


def test_coprime_polynomials_over_a_number_field_are_seen_to_be_so_by_their_norms(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Euclid's algorithm is left to what may have a common factor: its remainders double in length at every step."""
    asked = []
    divide = FieldPolynomial.__mod__
    monkeypatch.setattr(FieldPolynomial, "__mod__", lambda p, q: asked.append(q) or divide(p, q))
    p, q = (polynomial([k, CUBE_2 * Q(k, 7) + 1, *[CUBE_2 - n for n in range(k)], 1]) for k in (9, 10))
    assert greatest_common_divisor(p, q) == 1
    assert not asked
    common = polynomial([CUBE_2, 1])
    assert greatest_common_divisor(p * common, q * common) == common
    assert asked
    conjugates = polynomial([ROOT_3, 1]), polynomial([-ROOT_3, 1])  # of one norm, and coprime
    assert greatest_common_divisor(*conjugates) == 1
