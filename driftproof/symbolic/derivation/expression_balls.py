"""Certified enclosures of real SymPy expressions by Arb balls."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial, reduce
from operator import add, mul
from typing import Any

import sympy
from flint import arb, ctx, fmpq

from driftproof.methods.numbers.number_field import real_root_balls
from driftproof.symbolic.algebra.certified import CertifiableReal


def certifiable(expr: sympy.Basic) -> CertifiableReal:
    """The real number `expr` as a CertifiableReal: a Fraction if it is rational, else a procedure that encloses it."""
    if isinstance(expr, sympy.Rational):
        return Fraction(int(expr.p), int(expr.q))
    return partial(enclose_expression, expr)


def enclose_expression(expr: sympy.Basic) -> arb:
    """An Arb ball that contains the real number `expr`, at Arb's current precision.

    Raises TypeError for a function that is not in `_FUNCTIONS`.
    """
    if isinstance(expr, sympy.Rational):
        return arb(fmpq(int(expr.p), int(expr.q)))
    if isinstance(expr, sympy.CRootOf):
        return real_root_balls(integer_coefficients(expr.poly), ctx.prec)[expr.index]  # ascending in both
    if expr == sympy.pi:
        return arb.pi()
    if expr == sympy.E:
        return arb(1).exp()
    if isinstance(expr, sympy.Pow):
        base, exponent = (enclose_expression(a) for a in expr.args)
        return base**exponent
    if expr.func not in _FUNCTIONS:
        raise TypeError(f"{expr.func.__name__} in {expr} cannot be enclosed in balls")
    return _FUNCTIONS[expr.func](*(enclose_expression(a) for a in expr.args))


def integer_coefficients(polynomial: sympy.Poly) -> tuple[int, ...]:
    """The coefficients of an integer multiple of a polynomial over Q, constant term first."""
    return tuple(int(c) for c in polynomial.clear_denoms()[1].all_coeffs()[::-1])


_FUNCTIONS: dict[Any, Callable[..., arb]] = {
    sympy.Add: lambda *balls: reduce(add, balls),
    sympy.Mul: lambda *balls: reduce(mul, balls),
    sympy.cos: arb.cos,
    sympy.sin: arb.sin,
    sympy.tan: arb.tan,
    sympy.acos: arb.acos,
    sympy.asin: arb.asin,
    sympy.atan: arb.atan,
    sympy.log: arb.log,
    sympy.exp: arb.exp,
    sympy.Abs: abs,
}
