"""SymPy expressions are enclosed as mpmath values them; broken enclosures are noticed, unknown functions refused."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import mpmath
import pytest
import sympy
from flint import arb, ctx
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.certified import Uncertified, certified_sign, fixed, is_less, significant
from driftproof.symbolic.derivation import expression_balls
from driftproof.symbolic.derivation.expression_balls import certifiable, enclose_expression

WIDE = mpmath.mp.clone()
WIDE.dps = 60


def test_rational_expression_is_a_fraction_so_that_its_ties_are_seen() -> None:
    assert certifiable(sympy.Rational(-1, 8)) == Q(-1, 8)
    assert fixed(certifiable(sympy.Rational(1, 8)), 2) == "0.12"
    assert certified_sign(certifiable(sympy.Integer(0))) == 0
    with pytest.raises(Uncertified):
        is_less(certifiable(sympy.sqrt(2)), certifiable(sympy.sqrt(2)))


def test_almost_integer_is_read_correctly() -> None:
    """Ramanujan's exp(pi sqrt 163) is an integer less 7.5e-13."""
    almost = certifiable(sympy.exp(sympy.pi * sympy.sqrt(163)))
    assert fixed(almost, 12) == "262537412640768743.999999999999"
    assert fixed(almost, 11) == "262537412640768744.00000000000"


def test_unknown_function_is_refused() -> None:
    with pytest.raises(TypeError, match="besselj"):
        fixed(certifiable(sympy.besselj(0, sympy.Integer(1))), 3)


def test_enclosure_of_a_root_contains_it_and_shrinks() -> None:
    root = sympy.CRootOf(sympy.Symbol("x") ** 5 - sympy.Symbol("x") - 1, 0)
    with ctx.workprec(400):
        x = enclose_expression(root)
        assert (x**5 - x - 1).contains(0)
        assert x.rad() < arb(2) ** -350  # nine tenths of the precision asked for
    assert fixed(certifiable(root), 30) == WIDE.nstr(WIDE.findroot(lambda x: x**5 - x - 1, 1.2), 31)


SMALL = st.fractions(-3, 3, max_denominator=50).filter(bool)
LEAVES = SMALL.map(lambda x: sympy.Rational(x.numerator, x.denominator)) | st.just(sympy.pi) | st.just(sympy.E)
# exp and log of bounded arguments only: towers of exponentials need more memory than there is, in mpmath too.
FUNCTIONS = (
    sympy.sin, sympy.cos, sympy.atan,
    lambda x: sympy.exp(sympy.sin(x)),
    lambda x: sympy.log(2 + sympy.cos(x)),
    lambda x: sympy.sqrt(1 + x**2),
)  # fmt: skip
EXPRESSIONS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds(lambda f, x: f(x), st.sampled_from(FUNCTIONS), inner),
        st.builds(lambda x, y: x + y, inner, inner),
        st.builds(lambda x, y: x * y, inner, inner),
    ),
    max_leaves=5,
)


def by_mpmath(expression: Any, context: Any) -> Any:
    """The value by mpmath, a second opinion: Arb and mpmath share no code."""
    if isinstance(expression, sympy.Rational):
        return context.mpf(int(expression.p)) / int(expression.q)
    if expression in (sympy.pi, sympy.E):
        return +(context.pi if expression == sympy.pi else context.e)
    values = [by_mpmath(argument, context) for argument in expression.args]
    if isinstance(expression, sympy.Add | sympy.Mul):
        return (context.fsum if isinstance(expression, sympy.Add) else context.fprod)(values)
    name = "power" if isinstance(expression, sympy.Pow) else expression.func.__name__
    return getattr(context, name)(*values)


def assert_thirty_digits(expression: Any) -> None:
    value = by_mpmath(expression, WIDE)
    # 30 correctly rounded digits are within half a unit of the 30th, at most 5e-30 of the value.
    assert abs(WIDE.mpf(significant(certifiable(expression), 30)) - value) <= abs(value) * 5 * WIDE.mpf(10) ** -30


@given(EXPRESSIONS)
def test_thirty_digits_agree_with_mpmath_at_sixty(expression: Any) -> None:
    # A smaller value is a sum that cancelled, of which mpmath's 60 digits may leave fewer than the 30 compared.
    assume(abs(by_mpmath(expression, WIDE)) > WIDE.mpf(10) ** -25)
    assert_thirty_digits(expression)


def test_enclosure_that_is_off_by_a_little_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    one = sympy.sin(sympy.Integer(1))
    assert_thirty_digits(one)
    fifteen = significant(certifiable(one), 15)
    broken = expression_balls._FUNCTIONS | {sympy.sin: lambda x: x.sin() + arb(10) ** -20}
    monkeypatch.setattr(expression_balls, "_FUNCTIONS", broken)
    assert significant(certifiable(one), 15) == fifteen  # 15 digits do not show it
    with pytest.raises(AssertionError):
        assert_thirty_digits(one)
