"""Elements of number fields: arithmetic as in SymPy, equality and order exact, floats the nearest ones."""

from __future__ import annotations

import math
import sys
from fractions import Fraction as Q
from functools import reduce
from typing import Any

import pytest
import sympy
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.irreducibility import UndecidedError, is_irreducible
from driftproof.methods.number_field import Algebraic, NumberField, cube_root, square_root
from driftproof.methods.polynomials import (
    count_real_roots,
    derivative,
    divide,
    is_square_free,
    primitive,
    product,
    real_roots_between,
    trimmed,
    value_at,
)

DISTINCT = list(dict.fromkeys(method.field for method in METHODS.values() if method.field))
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
        assert y**-2 == 1 / (y * y)


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
    """The element by Horner's rule in balls, from SymPy's root isolation and not from our bisection."""
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
    for x in two:
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


@pytest.mark.parametrize("field", DISTINCT, ids=lambda field: field.name)
def test_float_of_every_generator_in_the_tables_is_sympys_value_rounded(field: NumberField) -> None:
    value = sympy.N(smallest(field), 60)
    assert float(field.generator) == float(Q(str(value)))
    low, high = field.enclosure(100)
    assert low < Q(str(value)) < high
    assert high - low <= Q(1, 2**100)


@pytest.mark.parametrize("field", DISTINCT, ids=lambda field: field.name)
def test_minimal_polynomial_of_every_field_in_the_tables_is_irreducible(field: NumberField) -> None:
    assert sympy.Poly(list(reversed(field.minimal)), X, domain="ZZ").is_irreducible
    assert math.gcd(*field.minimal) == 1
    assert at_generator(field) == 0


def at_generator(field: NumberField) -> Algebraic:
    return sum((c * field.generator**k for k, c in enumerate(field.minimal)), 0 * field.generator)


WRONG_FIELDS = [
    (((-2, 0, 1), 2, 3), "a change of sign"),
    (((-4, 0, 1), 1, 2), "a change of sign"),
    (((-2, 0, 1), 2, 1), "a change of sign"),
    (((-2, 1), 1, 3), "degree 2 or more"),
    (((-2, 1, 0), 1, 3), "degree 2 or more"),
    (((0, -1, 0, 1), Q(-3, 2), Q(3, 2)), "several roots"),
    (((-9, 0, 4), 1, 2), "reducible"),
    (((2, -2, -1, 1), Q(5, 4), 2), "reducible"),
    (((4, 0, -4, 0, 1), 1, 2), "a change of sign"),
]


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
    assert x.is_rational
    assert x.as_fraction() == Q(1, 2)
    assert (x - x).as_fraction() == 0
    with pytest.raises(ValueError, match="irrational"):
        square_root(3).as_fraction()
    assert bool(x - x) is False
    assert square_root(3) is square_root(3)


@pytest.mark.parametrize(("n", "k"), [(n, k) for n in (-1, 0, 1, 4, 8, 64) for k in (2, 3) if n not in (4, 8)])
def test_roots_that_are_rational_or_not_real_are_refused(n: int, k: int) -> None:
    with pytest.raises(ValueError, match="must be above 1"):
        (square_root if k == 2 else cube_root)(n)


@given(st.integers(2, 10**30))
def test_roots_are_roots(n: int) -> None:
    for root, k in ((square_root, 2), (cube_root, 3)):
        if any(sympy.integer_nthroot(n, k)[1] for _ in [0]):
            continue
        assert root(n) ** k == n
        assert root(n) > 0


def test_numbers_print_as_sums_of_powers() -> None:
    r, w = square_root(3), cube_root(2)
    assert str(Q(1, 2) - r / 6) == "1/2 - 1/6*sqrt(3)"
    assert str(-r) == "-sqrt(3)"
    assert str(w**2 - w + 1) == "1 - 2**(1/3) + (2**(1/3))**2"
    assert str(r - r) == "0"


def integer_polynomials(degree: int) -> st.SearchStrategy[list[int]]:
    inner = st.integers(-9, 9)
    return st.tuples(st.lists(inner, min_size=1, max_size=degree), inner.filter(bool)).map(lambda t: [*t[0], t[1]])


@given(integer_polynomials(6))
def test_irreducibility_is_sympys(f: list[int]) -> None:
    assert is_irreducible(f) is sympy.Poly(list(reversed(f)), X, domain="QQ").is_irreducible


@given(integer_polynomials(4), integer_polynomials(4))
def test_products_are_reducible(f: list[int], g: list[int]) -> None:
    assert not is_irreducible([int(x) for x in product(f, g)])


HARD = [
    [1, 0, 0, 0, 1],  # reducible modulo every prime
    [1, 0, -10, 0, 1],
    [576, 0, -960, 0, 352, 0, -40, 0, 1],  # Swinnerton-Dyer: factors of degree 1 and 2 modulo every prime
    [-1, 9, -18, 6],
    [int(c) for c in reversed(sympy.Poly(sympy.cyclotomic_poly(13, X)).all_coeffs())],
    [2 * 10**40, 0, 0, 0, 0, 3],
]


@pytest.mark.parametrize("f", HARD, ids=range(len(HARD)))
def test_irreducible_though_reducible_modulo_primes(f: list[int]) -> None:
    assert is_irreducible(f)
    squared = [0] * (2 * len(f) - 1)
    squared[::2] = f  # f(x²): may or may not be irreducible, as SymPy says
    if len(squared) <= 13:
        assert is_irreducible(squared) is sympy.Poly(list(reversed(squared)), X, domain="QQ").is_irreducible


def test_irreducibility_refuses_what_it_does_not_decide() -> None:
    with pytest.raises(UndecidedError, match="degree 13"):
        is_irreducible([-2, *12 * [0], 1])
    with pytest.raises(UndecidedError, match="too large"):
        is_irreducible([2**3000 + 1, 1, 1, 1])
    with pytest.raises(ValueError, match="constant"):
        is_irreducible([3])
    assert is_irreducible([3, 5])
    assert not is_irreducible([0, 0, 1])


@given(st.lists(st.fractions(-5, 5, max_denominator=6), min_size=2, max_size=7).filter(lambda f: any(f[1:])))
def test_sturms_count_is_sympys(f: list[Q]) -> None:
    p = sympy.Poly([sympy.Rational(c.numerator, c.denominator) for c in reversed(f)], X, domain="QQ")
    trim = trimmed(f)
    distinct = p.quo(p.gcd(p.diff()))
    assert count_real_roots(trim) == distinct.count_roots()
    assert is_square_free(trim) is (p.gcd(p.diff()).degree() == 0)
    if value_at(trim, Q(-1, 7)) and value_at(trim, Q(22, 7)):
        ends = [sympy.Rational(-1, 7), sympy.Rational(22, 7)]
        assert real_roots_between(trim, Q(-1, 7), Q(22, 7)) == distinct.count_roots(*ends)


@given(st.lists(fractions(), max_size=6), st.lists(fractions(), max_size=4).filter(any))
def test_division_leaves_a_smaller_remainder(a: list[Q], b: list[Q]) -> None:
    divisor = trimmed(b)
    quotient, rest = divide(a, divisor)
    assert len(rest) < len(divisor)
    back = [0] * max(len(quotient) + len(divisor), len(rest), len(a))
    for k, x in [*enumerate(product(quotient, divisor)), *enumerate(rest)]:
        back[k] += x
    assert trimmed(back) == trimmed(a)


def test_polynomials_of_small_degree() -> None:
    assert derivative((Q(1), Q(2), Q(3))) == (2, 6)
    assert derivative((Q(1),)) == ()
    assert primitive((Q(1, 2), Q(-3, 4))) == (2, -3)
    assert primitive((Q(0),)) == ()
    assert trimmed((0, 1, 0, 0)) == (0, 1)
    assert value_at((1, 2, 3), Q(1, 2)) == Q(11, 4)
    assert product((), (1, 2)) == ()
