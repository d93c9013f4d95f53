"""Elements of number fields: arithmetic as in SymPy, equality and order exact, floats the nearest ones."""

from __future__ import annotations

import math
import pickle
import sys
from collections.abc import Callable
from fractions import Fraction as Q
from functools import reduce
from typing import Any

import pytest
import sympy
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.numbers.common_field import in_one_field
from driftproof.methods.numbers.number_field import (
    Algebraic,
    NumberField,
    UndecidedError,
    cube_root,
    real_root_balls,
    square_root,
)
from tests.looping import exactly

QUARTIC = NumberField("theta", (1, 0, -10, 0, 1), Q(3), Q(4))  # sqrt 2 + sqrt 3
SEXTIC = NumberField("eta", (-3, 0, 1, 0, 0, 0, 1), Q(1), Q(2))
ROOTS = [square_root(3).field, cube_root(2).field, QUARTIC, SEXTIC]

X = sympy.Symbol("x")


def smallest(field: NumberField) -> Any:
    """The generator in SymPy: the root of the minimal polynomial in the field's interval."""
    p = sympy.Poly(list(reversed(field.minimal)), X)
    (found,) = (r for r in p.real_roots() if field.low < r < field.high)
    return found


def fractions() -> st.SearchStrategy[Q]:
    return st.fractions(-20, 20, max_denominator=60)


def elements(field: NumberField) -> st.SearchStrategy[Algebraic]:
    size = st.integers(0, field.degree)
    return size.flatmap(lambda n: st.tuples(*n * [fractions()])).map(lambda c: Algebraic(field, c))


def fields_with_two() -> st.SearchStrategy[tuple[Algebraic, Algebraic]]:
    return st.sampled_from(ROOTS).flatmap(lambda field: st.tuples(elements(field), elements(field)))


def in_sympy(x: Algebraic) -> Any:
    """The element as a residue class of polynomials modulo the minimal polynomial."""
    return sympy.Poly(list(reversed(x.coefficients)) or [0], X, domain="QQ")


@pytest.mark.slow
@given(fields_with_two())
def test_arithmetic_is_that_of_residue_classes_in_sympy(two: tuple[Algebraic, Algebraic]) -> None:
    x, y = two
    modulus = sympy.Poly(list(reversed(x.field.minimal)), X, domain="QQ")
    p, q = in_sympy(x), in_sympy(y)
    assert in_sympy(x + y) == (p + q).rem(modulus)
    assert in_sympy(x - y) == (p - q).rem(modulus)
    assert in_sympy(x * y) == (p * q).rem(modulus)
    assert in_sympy(-x) == -p
    assert in_sympy(x**3) == (p**3).rem(modulus)
    if y:
        assert in_sympy(x / y) == (p * q.invert(modulus)).rem(modulus)
        assert in_sympy(1 / y) == q.invert(modulus)
        assert (y**-1, y**-2) == (1 / y, 1 / (y * y))
    assert (x - x) ** 0 == 1


@pytest.mark.slow
@given(fields_with_two())
def test_order_and_equality_are_those_of_balls(two: tuple[Algebraic, Algebraic]) -> None:
    x, y = two
    with ctx.workprec(200):
        difference = ball(x) - ball(y)
        assert (x == y) is (x - y == 0)
        assert (x < y) is bool(difference < 0)
        assert (x > y) is bool(difference > 0)
        # A nonzero element this small does not vanish in a ball of 200 bits; else the ball would say nothing.
        assert (x == y) is difference.contains(0)


def ball(x: Algebraic) -> arb:
    """The element by Horner's rule in balls, from SymPy's root isolation and not from Arb's."""
    root = arb(str(smallest_decimal(x.field)))
    return reduce(lambda value, c: value * root + fmpq(c.numerator, c.denominator), reversed(x.coefficients), arb(0))


def smallest_decimal(field: NumberField) -> str:
    if field not in _DECIMALS:
        _DECIMALS[field] = f"[{sympy.N(smallest(field), 90)} +/- 1e-85]"
    return _DECIMALS[field]


_DECIMALS: dict[NumberField, str] = {}


@given(fields_with_two())
def test_float_is_the_nearest_double(two: tuple[Algebraic, Algebraic]) -> None:
    """Proved by balls: the number lies between the midpoints to the two neighbouring doubles."""
    for x in exactly(2, two):
        nearest = float(x)
        with ctx.workprec(250):
            for other in (math.nextafter(nearest, -math.inf), math.nextafter(nearest, math.inf)):
                half_way = (arb(nearest) + arb(other)) / 2
                assert ball(x) >= half_way if other < nearest else ball(x) <= half_way


def test_float_near_a_tie_and_near_the_ends_of_the_doubles() -> None:
    root, tie = square_root(2), 1 + Q(1, 2**53)
    tiny = root / 10**60 / 2**200
    assert (float(tie + tiny), float(tie - tiny)) == (1 + sys.float_info.epsilon, 1.0)
    assert float(root * Q(1, 2**1074)) == 5e-324
    assert float(root * Q(1, 2**1076)) == 0.0
    assert math.copysign(1, float(-root * Q(1, 2**1080))) == -1
    assert float(root - root) == 0.0
    assert float(Algebraic(root.field, (Q(1, 3),))) == 1 / 3
    with pytest.raises(OverflowError):
        float(root * 2**1024)


WRONG_FIELDS = [
    (((-2, 0, 1), 2, 3), "a change of sign"), (((-4, 0, 1), 1, 2), "a change of sign"),
    (((-2, 0, 1), 2, 1), "a change of sign"), (((-2, 1), 1, 3), "degree 2 or more"),
    (((-2, 1, 0), 1, 3), "degree 2 or more"), (((0, -1, 0, 1), Q(-3, 2), Q(3, 2)), "several roots"),
    (((-9, 0, 4), 1, 2), "reducible"), (((2, -2, -1, 1), Q(5, 4), 2), "reducible"),
    (((4, 0, -4, 0, 1), 1, 2), "a change of sign"), (((-2, 0, 1), Q(3, 2), Q(8, 5)), "a change of sign"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "reason"), WRONG_FIELDS)
def test_what_is_no_field_is_refused(data: tuple[tuple[int, ...], Any, Any], reason: str) -> None:
    minimal, low, high = data
    with pytest.raises(ValueError, match=reason):
        NumberField("alpha", minimal, Q(low), Q(high))


def test_fields_do_not_mix_and_floats_do_not_enter() -> None:
    x = square_root(3)
    for other in (square_root(2), 0.5, "1", True, None, 1j):
        with pytest.raises(TypeError):
            x + other  # type: ignore[operator]
        assert (x == other) is False
    with pytest.raises(ZeroDivisionError):
        x / (x - x)
    with pytest.raises(ZeroDivisionError):
        x / 0


def test_rational_elements_are_equal_to_their_fractions_and_hash_alike() -> None:
    x = square_root(3) * square_root(3) / 6
    assert x == Q(1, 2)
    assert hash(x) == hash(Q(1, 2))
    assert {x, Q(1, 2)} == {Q(1, 2)}
    assert (x.is_rational, x.as_fraction()) == (True, Q(1, 2))
    assert (x - x).as_fraction() == 0
    with pytest.raises(ValueError, match="irrational"):
        square_root(3).as_fraction()
    assert bool(x - x) is False


@pytest.mark.parametrize(("n", "k"), [(n, k) for n in (-2, -1, 0, 1, 64) for k in (2, 3)])
def test_roots_that_are_rational_or_not_real_are_refused(n: int, k: int) -> None:
    with pytest.raises(ValueError, match=f"must exceed 1 and not be a {'square' if k == 2 else 'cube'}$"):
        (square_root if k == 2 else cube_root)(n)


@given(st.integers(2, 10**30))
def test_roots_are_roots(n: int) -> None:
    for root, k in ((square_root, 2), (cube_root, 3)):
        if not sympy.integer_nthroot(n, k)[1]:
            assert root(n) ** k == n
            assert root(n) > 0


def test_numbers_print_as_sums_of_powers() -> None:
    r, w = square_root(3), cube_root(2)
    assert str(Q(1, 2) - r / 6) == "1/2 - 1/6*sqrt(3)"
    assert str(-r) == "-sqrt(3)"
    assert str(w**2 - w + 1) == "1 - 2**(1/3) + (2**(1/3))**2"
    assert str(r - r) == "0"
    assert pickle.loads(pickle.dumps(r)) == r  # as methods are sent to isolated processes, also when they were shown
    both, cubic = (in_one_field([square_root(2), other]) for other in (square_root(6), w))
    assert str(both[0] * both[1] + both[1] - 1) == "-1 + sqrt(6) + sqrt(2)*sqrt(6)"
    assert str(cubic[0] * cubic[1] ** 2 / 3) == "1/3*sqrt(2)*(2**(1/3))**2"
    assert str(sum(in_one_field([r, square_root(2), square_root(6)]))) == "sqrt(2) + sqrt(3) + sqrt(2)*sqrt(3)"
    assert r.field == NumberField("sqrt(3)", (-3, 0, 1), Q(1), Q(2))


def test_field_of_too_large_a_degree_is_refused_and_large_numbers_are_not() -> None:
    with pytest.raises(UndecidedError, match="degree 13"):
        NumberField("alpha", (-2, *12 * [0], 1), Q(1), Q(2))
    assert NumberField("alpha", (-2, *11 * [0], 1), Q(1), Q(2)).degree == 12
    assert NumberField("alpha", (-(2**3001) - 2, 0, 0, 1), Q(0), Q(2**1200)).degree == 3


@pytest.mark.slow
@given(st.lists(st.integers(-6, 6), min_size=1, max_size=7).filter(any), st.sampled_from([8, 200]))
def test_real_roots_are_sympys_each_once(f: list[int], bits: int) -> None:
    p = sympy.Poly(list(reversed(f)), X, domain="ZZ")
    balls = real_root_balls(tuple(f), bits)
    expected = sorted(set(p.real_roots())) if p.degree() > 0 else []
    assert len(balls) == len(expected)
    for ball, root in zip(balls, expected, strict=True):
        with ctx.workprec(400):
            assert abs(arb(str(sympy.N(root, 90))) - ball) < arb(2) ** -min(bits // 2, 250)
        assert not (root.is_Integer and ball.rad() != 0)


def test_roots_of_two_factors_come_apart_however_near_they_are() -> None:
    """Of (x² - 2)(10⁴⁰x² - 2·10⁴⁰ - 1), which are 4·10⁻⁴¹ apart: one ball of 64 bits."""
    n = 10**40
    balls = real_root_balls((4 * n + 2, 0, -4 * n - 1, 0, n), 64)
    assert len(balls) == 4
    assert balls[2] < balls[3]


def test_methods_of_rational_coefficients_are_read_without_flint(modules_after: Callable[[str], set[str]]) -> None:
    read = "from driftproof.methods.catalogue import METHODS; METHODS[{!r}]"
    assert "flint" not in modules_after(read.format("rk4"))
    assert "flint" in modules_after(read.format("gauss2"))
    assert "flint" not in modules_after("import driftproof.numeric.run, driftproof.numeric.steps.engine")


def test_an_end_may_be_as_near_to_the_root_as_it_likes() -> None:
    near = Q(math.isqrt(2 * 10**200), 10**100)
    root = NumberField("root", (-2, 0, 1), near, Q(3, 2)).generator
    assert (root * root, root > near) == (2, True)
    with pytest.raises(ValueError, match="root"):
        NumberField("root", (-2, 0, 1), near + Q(1, 10**100), Q(3, 2))
