"""Polynomials and rational functions in SymPy's syntax."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.polynomials import Polynomial, coefficients
from driftproof.symbolic.algebra.rational_functions import RationalFunction


def polynomial_text(p: Polynomial, name: str) -> str:
    """The polynomial, constant term first, e.g. "1/2 - h**2/8" or "(2 - sqrt(2))*h"."""
    return sum_text(_term(c, power, name) for power, c in enumerate(coefficients(p)) if c != 0)


def sum_text(terms: Iterable[str]) -> str:
    """The sum of terms with their signs in front: "1 - h" from "1" and "-h"; "0" of none."""
    text = ""
    for term in terms:
        size = term.removeprefix("-")
        text += f" {'+' if size == term else '-'} {size}" if text else term
    return text or "0"


def rational_text(f: RationalFunction, name: str) -> str:
    """The rational function, e.g. "(1 - h**2/4)/(1 + h**2/4)"."""
    num, den = polynomial_text(f.num, name), polynomial_text(f.den, name)
    if den == "1":
        return num
    top = f"({num})" if " " in num else num
    return f"{top}/{den}" if den.replace("**", "").isidentifier() else f"{top}/({den})"


def _term(c: Exact, power: int, name: str) -> str:
    """c*name**power, with the sign in front."""
    monomial = "" if power == 0 else name if power == 1 else f"{name}**{power}"
    if not isinstance(c, Fraction):
        return f"({c})*{monomial}" if monomial else f"({c})"
    if not monomial:
        return str(c)
    sign, size = "-" if c < 0 else "", abs(c)
    factor = "" if size.numerator == 1 else f"{size.numerator}*"
    over = "" if size.denominator == 1 else f"/{size.denominator}"
    return f"{sign}{factor}{monomial}{over}"
