"""Signs, decided and not sampled: of polynomials on intervals, by counting roots (Sturm), and of cosines by Taylor."""

from __future__ import annotations

from fractions import Fraction

import sympy

from driftproof.symbolic.derivation.one_step import H, StepPolynomial, at_rational, expression


def roots_between(polynomial: StepPolynomial, low: Fraction | None, high: Fraction | None) -> int:
    """The number of distinct real roots of a nonzero element of Q[h] in the open interval (low, high).

    None stands for an infinite end. The number is exact: SymPy counts the roots in [low, high] by Sturm's theorem
    (sturm-1835), and roots at the ends are subtracted. Raises ValueError for the zero polynomial.
    """
    if not polynomial:
        raise ValueError("the zero polynomial has infinitely many roots")
    low_end, high_end = (None if x is None else sympy.Rational(x.numerator, x.denominator) for x in (low, high))
    counted = int(sympy.Poly(expression(polynomial), expression(H)).sqf_part().count_roots(low_end, high_end))
    return counted - sum(not at_rational(polynomial, x) for x in {low, high} if x is not None)


def is_positive_between(polynomial: StepPolynomial, low: Fraction, high: Fraction | None) -> bool:
    """True if polynomial(h) > 0 for every h in the open interval (low, high); `high` None stands for infinity.

    That is the case if there is no root inside and the value at one inner point is positive.
    """
    inner = (low + high) / 2 if high is not None else low + 1
    return not roots_between(polynomial, low, high) and at_rational(polynomial, inner) > 0


def rises_from_zero(difference: sympy.Expr, at: sympy.Symbol) -> bool:
    """True if the `difference` is positive wherever the symbol is, because one derivative is 1 - cos and all before 0.

    All before vanish at 0. As 1 - cos is positive but at isolated points, so is, from the last of them on, each.
    """
    while difference != 0 and difference.subs(at, 0) == 0:
        if sympy.expand(difference - 1 + sympy.cos(at)) == 0:
            return True
        difference = difference.diff(at)
    return False


def in_square_of_h(polynomial: StepPolynomial) -> StepPolynomial:
    """The polynomial p with p(h²) = polynomial(h), for which ends such as h = 2 sqrt 2 become rational (h² = 8).

    Raises ValueError if an odd power of h occurs.
    """
    halved = {}
    for (power,), coefficient in polynomial.terms():
        if power % 2:
            raise ValueError(f"{polynomial} is not a polynomial in h**2")
        halved[(power // 2,)] = coefficient
    return polynomial.ring(halved)
