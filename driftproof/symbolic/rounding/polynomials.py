"""The polynomials of a rounding bound: exact ones have coefficients in Q or a number field, bounding ones in Q.

An irrational coefficient enters a bound as a rational just above it, within a relative 2**-GUARD_BITS.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from typing import Any, TypeAlias

from flint import fmpq_mpoly, fmpq_mpoly_ctx

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction
from driftproof.methods.numbers.number_field import Algebraic, Exact, ScalarExtension
from driftproof.symbolic.rounding.formats import exponent, power_of_two

# An element of BOUNDS, or an OverField. FLINT has no static types.
ErrorPolynomial: TypeAlias = Any
Powers: TypeAlias = tuple[int, ...]

# Bounds are polynomials in d, eta, |h|, |q|, |v| with non-negative coefficients, exact values polynomials in h, q, v;
# one ring holds both.
BOUNDS = fmpq_mpoly_ctx.get(("d", "eta", "h", "q", "v"))
D, ETA, H, Q, V = BOUNDS.gens()
ZERO, ONE = BOUNDS.constant(0), BOUNDS.constant(1)

# The rational ends of an irrational x are at most 2**-GUARD_BITS |x| apart: bounds are quoted to far fewer digits.
GUARD_BITS = 128


class OverField(ScalarExtension):
    """A polynomial with coefficients in K = Q(alpha): the powers of alpha times elements of BOUNDS."""

    __slots__ = ()

    @staticmethod
    def part(x: object) -> ErrorPolynomial:
        """An integer, a rational or an element of BOUNDS, as an element of BOUNDS."""
        return x if isinstance(x, fmpq_mpoly) else BOUNDS.constant(as_fmpq(x))


def constant_polynomial(x: Exact) -> ErrorPolynomial:
    """`x` as a constant polynomial."""
    if isinstance(x, Algebraic):
        return OverField(x.field, [BOUNDS.constant(c) for c in x.parts])
    return BOUNDS.constant(as_fmpq(x))


def terms(p: ErrorPolynomial) -> list[tuple[Powers, Any]]:
    """The powers of (d, eta, h, q, v) in p, each with its coefficient: a Fraction, or an Algebraic if irrational."""
    if not isinstance(p, OverField):
        return [(tuple(map(int, powers)), as_fraction(c)) for powers, c in p.terms()]
    found: dict[Powers, list[Any]] = {}
    for i, part in enumerate(p.parts):
        for powers, c in part.terms():
            found.setdefault(tuple(map(int, powers)), [0] * p.field.degree)[i] = c
    elements = {powers: Algebraic(p.field, row) for powers, row in found.items()}
    return [(powers, x.as_fraction() if x.is_rational else x) for powers, x in elements.items()]


def from_terms(found: Iterable[tuple[Powers, Fraction]]) -> ErrorPolynomial:
    """The element of BOUNDS with these terms, in which no powers occur twice."""
    return BOUNDS.from_dict({powers: as_fmpq(c) for powers, c in found})


def constant_term(p: ErrorPolynomial) -> Exact:
    """The coefficient of 1."""
    found: Exact = dict(terms(p)).get((0,) * BOUNDS.nvars(), Fraction(0))
    return found


def majorant(p: ErrorPolynomial) -> ErrorPolynomial:
    """The sum of |monomials|, irrational coefficients rounded up: at (|h|, |q|, |v|) it bounds |p| at (h, q, v)."""
    if isinstance(p, OverField):
        return from_terms((powers, rational_above(absolute_value(c))) for powers, c in terms(p))
    return BOUNDS.from_dict({powers: abs(c) for powers, c in p.terms()})


def near_rational(p: ErrorPolynomial) -> tuple[ErrorPolynomial, ErrorPolynomial]:
    """(m, r) in BOUNDS with |p - m| at (h, q, v) at most r at (|h|, |q|, |v|); p and 0 where p is over Q."""
    if not isinstance(p, OverField):
        return p, ZERO
    balls = [(powers, middle_and_radius(c)) for powers, c in terms(p)]
    middle, radius = (from_terms((powers, pair[i]) for powers, pair in balls) for i in range(2))
    return middle, radius


def absolute_value(x: Exact) -> Exact:
    """|x|."""
    return max(x, -x)


@lru_cache(maxsize=1 << 12)
def rational_ends(x: Exact) -> tuple[Fraction, Fraction]:
    """Rationals low <= x <= high, at most 2**-GUARD_BITS |x| apart; both are x where it is rational."""
    if not isinstance(x, Algebraic):
        return x, x
    if x.is_rational:
        return x.as_fraction(), x.as_fraction()
    bits = 2 * GUARD_BITS
    while True:
        low, high = x.enclosure(bits)
        if high:
            # At most three units apart after rounding outwards, and |x| >= 2**exponent - unit.
            unit = power_of_two(exponent(high) - GUARD_BITS - 2)
            if high - low <= unit:
                return low // unit * unit, -(-high // unit) * unit
        bits *= 2


def rational_above(x: Exact) -> Fraction:
    """A rational at or just above x."""
    return rational_ends(x)[1]


def middle_and_radius(x: Exact) -> tuple[Fraction, Fraction]:
    """A rational m and an r >= 0 with |x - m| <= r; x itself and 0 where it is rational."""
    low, high = rational_ends(x)
    return (low + high) / 2, (high - low) / 2
