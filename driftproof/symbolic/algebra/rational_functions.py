"""Rational functions in lowest terms over Q or a real number field, power series, and their text in SymPy's syntax."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import fmpq, fmpz

from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    coefficients,
    descend,
    dot,
    evaluate,
    exact,
    greatest_common_divisor,
    quotient,
    reflected,
)


@dataclass(frozen=True)
class RationalFunction:
    """num/den in lowest terms, with den(0) = 1, or with den monic if 0 is a pole; `fraction` constructs it."""

    num: Polynomial
    den: Polynomial

    def data(self) -> dict[str, list[str]]:
        """{"num": [...], "den": [...]}: the coefficients as strings, constant term first."""
        num, den = ([exact_text(c) for c in coefficients(p)] or ["0"] for p in (self.num, self.den))
        return {"num": num, "den": den}

    def at_infinity(self) -> Exact | None:
        """The limit at infinity; None if there is a pole."""
        excess = self.num.degree() - self.den.degree()
        if excess > 0:
            return None
        return exact(self.num.leading_coefficient() / self.den.leading_coefficient()) if not excess else Fraction(0)

    def __call__(self, x: Scalar) -> Scalar:
        """The value at a scalar. Raises ZeroDivisionError at a pole."""
        return evaluate(self.num, x) / evaluate(self.den, x)

    def __add__(self, other: RationalFunction) -> RationalFunction:
        return fraction(self.num * other.den + other.num * self.den, self.den * other.den)

    def __neg__(self) -> RationalFunction:
        return RationalFunction(-self.num, self.den)

    def __sub__(self, other: RationalFunction) -> RationalFunction:
        return self + -other

    def __mul__(self, other: RationalFunction) -> RationalFunction:
        return fraction(self.num * other.num, self.den * other.den)


def fraction(num: Polynomial, den: Polynomial = ONE) -> RationalFunction:
    """num/den, reduced and normalised. Raises ZeroDivisionError if den is zero."""
    if not den:
        raise ZeroDivisionError("the denominator is the zero polynomial")
    if den != ONE:
        common = greatest_common_divisor(num, den)
        num, den = quotient(num, common), quotient(den, common)
    unit = den[0] or den.leading_coefficient()
    return RationalFunction(descend(num / unit), descend(den / unit))


def reversed_sign(f: RationalFunction) -> RationalFunction:
    """The function f(-z)."""
    return fraction(reflected(f.num), reflected(f.den))


PowerSeries: TypeAlias = list[Scalar]


def taylor(f: RationalFunction, terms: int) -> PowerSeries:
    """The first `terms` Taylor coefficients of f at 0. Raises ZeroDivisionError if 0 is a pole."""
    return series_quotient(_padded(f.num.coeffs(), terms), _padded(f.den.coeffs(), terms))


def exponential_series(terms: int) -> PowerSeries:
    """The first `terms` Taylor coefficients of exp: 1, 1, 1/2, 1/6, ..."""
    coefficients = [fmpq(1)]
    for k in range(1, terms):
        coefficients.append(coefficients[-1] / k)
    return coefficients[:terms]


def series_product(a: PowerSeries, b: PowerSeries) -> PowerSeries:
    """The product of two series, truncated to the length of a."""
    b = _padded(b, len(a))
    return [dot(a[: k + 1], b[k::-1]) for k in range(len(a))]


def series_quotient(a: PowerSeries, b: PowerSeries) -> PowerSeries:
    """The series a/b, truncated to the length of a. Raises ZeroDivisionError if b(0) = 0."""
    b = _padded(b, len(a))
    inverse, result = 1 / b[0], []  # type: tuple[Scalar, PowerSeries]
    for k, c in enumerate(a):
        result.append((c - dot(result, b[k:0:-1])) * inverse)
    return result


def series_logarithm(a: PowerSeries) -> PowerSeries:
    """The series log a, from a' = a (log a)'. Raises ValueError unless a(0) = 1."""
    _require_one(a)
    slope: PowerSeries = []  # the coefficients k lₖ of z (log a)'
    for k, c in enumerate(a):
        slope.append(c * k - dot(slope, a[k:0:-1]))
    return [c / k if k else c for k, c in enumerate(slope)]


def series_root(a: PowerSeries) -> PowerSeries:
    """The square root of a series, with constant term 1. Raises ValueError unless a(0) = 1."""
    _require_one(a)
    result: PowerSeries = [fmpq(1)]
    for k in range(1, len(a)):
        result.append((a[k] - dot(result[1:], result[:0:-1])) / 2)
    return result


def series_integral(a: PowerSeries) -> PowerSeries:
    """The antiderivative that vanishes at 0, one term longer."""
    return [fmpq(0), *(c / (k + 1) for k, c in enumerate(a))]


def series_derivative(a: PowerSeries) -> PowerSeries:
    """The derivative, one term shorter."""
    return [c * k for k, c in enumerate(a)][1:]


def _padded(a: Sequence[Scalar], terms: int) -> PowerSeries:
    return [*a[:terms], *[fmpq(0)] * (terms - len(a))]


def _require_one(a: PowerSeries) -> None:
    if not a or a[0] != 1:
        raise ValueError("the constant term must be 1")


def exact_text(x: Exact) -> str:
    """The number as text; FLINT also converts the integers of over 4300 digits that Python's `str` refuses."""
    return str(as_fmpq(x) if isinstance(x, Fraction) else x)


def polynomial_text(p: Polynomial, name: str) -> str:
    """The polynomial in SymPy's syntax, constant term first, e.g. "1/2 - h**2/8" or "(2 - sqrt(2))*h"."""
    return sum_text(monomial_text(c, power, name) for power, c in enumerate(coefficients(p)) if c)


def sum_text(terms: Iterable[str]) -> str:
    """The sum of terms that carry their signs in front: "1 - h" from "1" and "-h"; "0" without terms."""
    text = ""
    for term in terms:
        size = term.removeprefix("-")
        text += f" {'+' if size == term else '-'} {size}" if text else term
    return text or "0"


def rational_function_text(f: RationalFunction, name: str) -> str:
    """The rational function in SymPy's syntax, e.g. "(1 - h**2/4)/(1 + h**2/4)"."""
    num, den = polynomial_text(f.num, name), polynomial_text(f.den, name)
    if den == "1":
        return num
    top = f"({num})" if " " in num else num
    return f"{top}/{den}" if den.replace("**", "").isidentifier() else f"{top}/({den})"


def monomial_text(c: Exact, power: int, name: str) -> str:
    """The term c*name**power in SymPy's syntax, with its sign in front."""
    monomial = "" if not power else name if power == 1 else f"{name}**{power}"
    if not isinstance(c, Fraction):
        return f"({c})*{monomial}" if monomial else f"({c})"
    if not monomial:
        return exact_text(c)
    size = abs(c)
    sign = "" if c == size else "-"
    factor = "" if size.numerator == 1 else f"{fmpz(size.numerator)}*"
    over = "" if size.denominator == 1 else f"/{fmpz(size.denominator)}"
    return f"{sign}{factor}{monomial}{over}"
