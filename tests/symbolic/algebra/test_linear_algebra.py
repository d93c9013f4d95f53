"""Polynomials over number fields, algebraic numbers, radicals, series: each against a second way to the same thing."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
import sympy
from flint import arb, ctx, fmpq, fmpq_poly
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.methods.number_field import Algebraic, NumberField, cube_root, square_root
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
    sign_changes,
    squarefree,
)
from driftproof.symbolic.algebra.radicals import integer_polynomial_text, radical_form, root_decimal
from driftproof.symbolic.algebra.rational_functions import fraction, polynomial_text, rational_function_text
from driftproof.symbolic.algebra.real_roots import (
    ZERO_ROOT,
    RealRoot,
    positive_roots,
    rational_root,
    samples,
    sign_at,
    vanishes_at,
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
    with pytest.raises(ValueError, match="remainder"):
        quotient(other, common)


def test_norm_is_the_product_of_the_conjugates() -> None:
    p = polynomial([ROOT_3, 1 - ROOT_3, 0, 1])
    conjugate = polynomial([-ROOT_3, 1 + ROOT_3, 0, 1])
    assert p * conjugate == p.norm()
    q = polynomial([-CUBE_2, 1])
    assert q.norm() == X**3 - 2
    assert interpolate([fmpq(k * k) for k in range(5)]) == X**2


def test_rational_coefficients_descend_to_q_and_two_fields_do_not_mix() -> None:
    square = polynomial([ROOT_3, 1]) * polynomial([-ROOT_3, 1])
    assert isinstance(square, FieldPolynomial)
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
    with pytest.raises(TypeError, match="no exact arithmetic"):
        scalar(ROOT_3) + 0.5
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


# ---- real algebraic numbers


@given(st.lists(st.integers(-6, 6), min_size=2, max_size=6))
def test_positive_roots_are_those_that_sympy_isolates(c: list[int]) -> None:
    assume(any(c))
    p = polynomial(c)
    ours = positive_roots([p])
    x = sympy.Symbol("x")
    poly = sympy.Poly(list(reversed(c)), x)
    theirs = sorted({r for r in poly.real_roots(radicals=False) if r.is_positive}) if poly.degree() > 0 else []
    assert len(ours) == len(theirs) <= sign_changes(p)
    for mine, other in zip(ours, theirs, strict=True):
        low, high = mine.interval()
        assert low <= other <= high
        assert sympy.minimal_polynomial(other, x) == sympy.Poly(list(reversed(mine.minimal)), x).as_expr()
        assert sign_at(p, mine) == 0


def test_positive_roots_merge_repeated_ones_and_are_sampled_between() -> None:
    roots = positive_roots([(X - 1) ** 3 * (X**2 - 2), X**2 - 2, X * (X + 5), X - 3])
    assert [root.minimal for root in roots] == [(-1, 1), (-2, 0, 1), (-3, 1)]
    inner = samples(roots)
    assert len(inner) == 4
    assert 0 < inner[0] < 1 < inner[1]
    assert inner[1] ** 2 < 2 < inner[2] ** 2
    assert inner[2] < 3 < inner[3]
    assert positive_roots([X + 1]) == []
    assert samples([]) == [1]


def test_two_roots_that_differ_by_a_tiny_amount_are_told_apart() -> None:
    tiny = fmpq(1, 10**60)
    first, second = positive_roots([X - 1, X - 1 - tiny])
    (middle,) = samples([first, second])[1:2]
    assert 1 < middle < 1 + tiny
    twins = positive_roots([(X**2 - 2) * 10**80 - 1, X**2 - 2])
    assert twins[0].minimal == (-2, 0, 1)
    assert len(twins) == 2


def test_square_root_of_an_algebraic_number() -> None:
    golden = positive_roots([X**2 - X - 1])[0]
    assert golden.square_root().minimal == (-1, 0, -1, 0, 1)
    assert rational_root(Q(9, 4)).square_root() == rational_root(Q(3, 2))
    assert RealRoot((-3, -2, 1), 0) != rational_root(Q(3))
    square = RealRoot((1, -3, 1), 1)  # golden ** 2
    assert square.square_root() == golden
    assert ZERO_ROOT.square_root() == ZERO_ROOT
    with pytest.raises(ValueError, match="negative"):
        rational_root(Q(-1)).square_root()


def test_zero_at_an_algebraic_number_is_decided_over_number_fields() -> None:
    root = RealRoot((-3, 0, 1), 1)
    p = polynomial([-ROOT_3, 1])
    assert vanishes_at(p, root)
    assert not vanishes_at(reflected(p), root)
    assert not vanishes_at(p, root.negated())
    assert not vanishes_at(p + Q(1, 10**50).numerator * scalar(Q(1, 10**50)), root)
    assert (sign_at(p, rational_root(Q(2))), sign_at(p, rational_root(Q(1)))) == (1, -1)
    assert vanishes_at(p * 0, root)


def test_zero_is_decided_between_conjugates_that_nearly_coincide() -> None:
    """1 ± 1e-30 sqrt(2): at 64 bits both look like roots of both factors of their minimal polynomial."""
    tiny = Q(1, 10**30)
    p = polynomial([-(1 + tiny * ROOT_2), 1])
    minimal = (10**60 - 2, -2 * 10**60, 10**60)
    divisor = 2
    lower, upper = (RealRoot(tuple(c // divisor for c in minimal), k) for k in range(2))
    assert positive_roots([p]) == [lower, upper]
    assert (vanishes_at(p, lower), vanishes_at(p, upper)) == (False, True)
    assert (sign_at(p, lower), sign_at(p, upper)) == (-1, 0)
    with ctx.workprec(300):
        assert lower.square_root().ball() ** 2 < upper.ball()
        assert upper.square_root().ball() ** 2 > lower.ball()


RADICALS = {
    (0, 1): "0",
    (-2, 1): "2",
    (-1, 3): "1/3",
    (-8, 0, 1): "2*sqrt(2)",
    (-8, 0, 3): "2*sqrt(6)/3",
    (-8, 0, 0, 3): "2*9**(1/3)/3",
    (-1, -1, 1): "1/2 + sqrt(5)/2",
    (1, -3, 1): "3/2 + sqrt(5)/2",
    (-3, 0, -6, 0, 1): "sqrt(3 + 2*sqrt(3))",
    (-24, 12, -4, 1): None,
}


@pytest.mark.parametrize("minimal", RADICALS)
def test_radical_form_is_the_number(minimal: tuple[int, ...]) -> None:
    largest = RealRoot(minimal, RealRoot(minimal, 0).count - 1)
    text = radical_form(largest)
    assert text == RADICALS[minimal]
    if text is not None:
        x = sympy.Symbol("x")
        value = sympy.parse_expr(text)
        assert sympy.minimal_polynomial(value, x) == sympy.Poly(list(reversed(minimal)), x).as_expr()
        assert value >= 0


def test_radical_form_of_the_smaller_and_of_a_negative_root() -> None:
    assert radical_form(RealRoot((1, -3, 1), 0)) == "3/2 - sqrt(5)/2"
    assert radical_form(RealRoot((-8, 0, 1), 0)) == "-2*sqrt(2)"
    assert radical_form(RealRoot((-1, -1, 1), 0)) == "1/2 - sqrt(5)/2"


def test_radicals_that_nobody_can_read_are_left_out() -> None:
    assert radical_form(RealRoot((-(10**40 + 7), 0, 1), 1)) is None


def test_decimals_are_correctly_rounded() -> None:
    assert root_decimal(RealRoot((-8, 0, 1), 1)) == "2.828427124746190097603377448419"
    assert root_decimal(ZERO_ROOT) == "0"
    assert root_decimal(rational_root(Q(2, 3)), 4) == "0.6667"


def test_polynomials_print_in_sympys_syntax() -> None:
    assert integer_polynomial_text((-8, 0, 1)) == "x**2 - 8"
    assert integer_polynomial_text((1, -1)) == "-x + 1"
    assert polynomial_text(polynomial([Q(1, 2), 0, Q(-1, 8)]), "h") == "1/2 - h**2/8"
    assert polynomial_text(polynomial([0, Q(-1, 2)]), "h") == "-h/2"
    assert polynomial_text(polynomial([0, 2 - ROOT_2]), "h") == "(2 - sqrt(2))*h"
    assert rational_function_text(fraction(1 - X**2 / 4, 1 + X**2 / 4), "h") == "(1 - h**2/4)/(1 + h**2/4)"
