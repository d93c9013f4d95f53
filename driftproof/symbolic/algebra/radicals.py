"""Real algebraic numbers as text: short radicals, minimal polynomials, certified decimals."""

from __future__ import annotations

from fractions import Fraction
from math import gcd

from flint import arb, fmpz

from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.symbolic.algebra.certified import settled, sign_of_ball, significant
from driftproof.symbolic.algebra.rational_functions import monomial_text, sum_text
from driftproof.symbolic.algebra.real_roots import Minimal, RealRoot

# Significant digits of a printed number that is not rational; chosen: as many as a double-double holds.
PRINTED_DIGITS = 31
# Radicands beyond this are neither readable nor quick to split into prime factors.
LARGEST_RADICAND = 10**30


def radical_form(root: RealRoot) -> str | None:
    """The number in radicals, in SymPy's syntax, if some power of it is rational or quadratic; else None.

    E.g. "2*sqrt(2)", "1/2 + sqrt(5)/2", "sqrt(3 + 2*sqrt(3))", "2*3**(1/3)"; None also if a radicand is too long.
    """
    power = gcd(*(k for k, c in enumerate(root.minimal) if c))
    if power > 1 and sign_of_ball(root.ball()) == -1:
        text = radical_form(root.negated())
        return text and f"-{text}"
    reduced = root.minimal[::power]
    if len(reduced) == 2:
        return _rational_power(Fraction(-reduced[0], reduced[1]), power)
    inner = _quadratic(reduced, root, power) if len(reduced) == 3 else None
    if inner is None or power == 1:
        return inner
    return f"sqrt({inner})" if power == 2 else f"({inner})**(1/{power})"


def integer_polynomial_text(coefficients: Minimal, name: str = "x") -> str:
    """The polynomial in SymPy's syntax, highest power first, e.g. "x**2 - 8"."""
    return sum_text(monomial_text(Fraction(c), k, name) for k, c in reversed([*enumerate(coefficients)]) if c)


def is_readable(x: Exact) -> bool:
    """True for a rational number, and for an element of a field whose generator has short coefficients."""
    return not isinstance(x, Algebraic) or max(map(abs, x.field.minimal)) <= LARGEST_RADICAND


def root_decimal(root: RealRoot, digits: int = PRINTED_DIGITS) -> str:
    """The number correctly rounded to `digits` significant digits, certified by balls; "0" for zero."""
    return significant(root.ball if root.rational is None else root.rational, digits)


def _rational_power(x: Fraction, power: int) -> str | None:
    """x**(1/power) with perfect powers taken out of the root, by p/q = p q**(power - 1) / q**power; x > 0 for roots."""
    if power == 1:
        return str(x)
    split = perfect_part(x.numerator * x.denominator ** (power - 1), power)
    if split is None:
        return None
    outer, inner = split
    surd = f"sqrt({inner})" if power == 2 else f"{inner}**(1/{power})"
    return _times(Fraction(outer, x.denominator), surd)


def _quadratic(minimal: Minimal, root: RealRoot, power: int) -> str | None:
    """root**power = (-b ± sqrt(b² - 4ac)) / 2a, as "p + q*sqrt(n)"; the sign is the one that balls do not exclude."""
    c, b, a = minimal
    split = perfect_part(b * b - 4 * a * c, 2)
    if split is None:
        return None
    outer, inner = split
    middle, half = Fraction(-b, 2 * a), Fraction(outer, 2 * a)

    def sign() -> str | None:
        target, reach = root.ball() ** power, arb(inner).sqrt() * arb(as_fmpq(half))
        above, below = ((arb(as_fmpq(middle)) + s * reach).overlaps(target) for s in (1, -1))
        return None if above and below else "+" if above else "-"

    return f"{middle} {settled(sign)} {_times(half, f'sqrt({inner})')}"


def perfect_part(n: int, power: int) -> tuple[int, int] | None:
    """(m, r) with n = m**power r and r free of such powers, for n > 0; None if n is above LARGEST_RADICAND."""
    if n > LARGEST_RADICAND:
        return None
    outer, inner = 1, 1
    for prime, exponent in fmpz(n).factor():
        outer *= int(prime) ** (exponent // power)
        inner *= int(prime) ** (exponent % power)
    return outer, inner


def _times(factor: Fraction, surd: str) -> str:
    """factor*surd for a positive factor, in SymPy's order: "2*sqrt(6)/3"."""
    over = f"/{factor.denominator}" if factor.denominator > 1 else ""
    return f"{surd}{over}" if factor.numerator == 1 else f"{factor.numerator}*{surd}{over}"
