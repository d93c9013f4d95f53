"""Signs of polynomials on intervals, decided by counting roots (Sturm), never by sampling."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy

from driftproof.symbolic.derivation.one_step import H, StepPolynomial, at_rational, expression, rational


def roots_between(polynomial: StepPolynomial, low: Fraction | None, high: Fraction | None) -> int:
    """The number of distinct real roots of a nonzero element of Q[h] in the open interval (low, high).

    None stands for an infinite end. Exact: a change of sign count along the Sturm chain
    (sturm-1835). Raises ValueError for the zero polynomial.
    """
    if polynomial == 0:
        raise ValueError("the zero polynomial has no finite number of roots")
    chain = sympy.Poly(expression(polynomial), expression(H)).sqf_part().sturm()
    inside = _sign_changes(chain, low, -1) - _sign_changes(chain, high, +1)
    return inside - (1 if high is not None and at_rational(polynomial, high) == 0 else 0)


def is_positive_between(polynomial: StepPolynomial, low: Fraction, high: Fraction | None) -> bool:
    """polynomial(h) > 0 for every h in the open interval (low, high); `high` None stands for infinity.

    Decided: no root inside, and a positive value at one inner point.
    """
    inner = (low + high) / 2 if high is not None else low + 1
    return roots_between(polynomial, low, high) == 0 and at_rational(polynomial, inner) > 0


def in_square_of_h(polynomial: StepPolynomial) -> StepPolynomial:
    """The p with p(h²) = polynomial(h), so that ends such as 2 sqrt 2 become rational (h² = 8).

    Raises ValueError if an odd power of h occurs.
    """
    halved = {}
    for (power,), coefficient in polynomial.terms():
        if power % 2:
            raise ValueError(f"{polynomial} is not a polynomial in h**2")
        halved[(power // 2,)] = coefficient
    return polynomial.ring(halved)


def _sign_changes(chain: list[sympy.Poly], x: Fraction | None, end: int) -> int:
    """Changes of sign along the chain at x, or at the infinite end -1 or +1; zeros are skipped."""
    if x is None:
        signs = [sympy.sign(p.LC() * (end ** p.degree())) for p in chain]
    else:
        signs = [sympy.sign(p.eval(sympy.Rational(rational(x).numerator, rational(x).denominator))) for p in chain]
    signs = [s for s in signs if s != 0]
    return sum(1 for a, b in pairwise(signs) if a != b)
