"""The polynomials of a rounding bound: what is exact has coefficients in Q or a number field, what bounds in Q."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, TypeAlias

from sympy import QQ, ring

from driftproof.methods.number_field import Algebraic, Exact, NumberField
from driftproof.symbolic.derivation.one_step import rational
from driftproof.symbolic.rounding.irrational import above, middle_and_radius, size

# An element of RING, or an OverField. SymPy's rings have no static types.
Polynomial: TypeAlias = Any
Powers: TypeAlias = tuple[int, ...]

# Bounds are polynomials in d, eta, |h|, |q|, |v| with non-negative coefficients, exact values polynomials in h, q, v;
# one ring holds both.
RING, D, ETA, H, Q, V = ring("d, eta, h, q, v", QQ)


class OverField:
    """Σ αⁱ pᵢ with pᵢ in RING, i below the degree of K = Q(α): a polynomial with coefficients in K.

    Arithmetic with integers, elements of RING and its own kind over the same field; another field raises TypeError.
    """

    __slots__ = ("field", "parts")

    def __init__(self, field: NumberField, parts: Sequence[Polynomial]) -> None:
        """Reduce the powers of α from the field's degree on by its minimal polynomial."""
        degree = field.degree
        low = [*parts[:degree], *[RING.zero] * (degree - len(parts))]
        for high, row in zip(parts[degree:], _reductions(field), strict=False):
            low = [p + high * c for p, c in zip(low, row, strict=True)]
        self.field = field
        self.parts: tuple[Polynomial, ...] = tuple(low)

    def __neg__(self) -> OverField:
        """The negative."""
        return self._map(lambda p: -p)

    def __add__(self, other: Any) -> OverField:
        """The sum."""
        return OverField(self.field, [p + q for p, q in zip(self.parts, self._parts(other), strict=True)])

    __radd__ = __add__

    def __sub__(self, other: Any) -> OverField:
        """The difference."""
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> OverField:
        """The difference."""
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> OverField:
        """The product."""
        if not isinstance(other, OverField):
            return self._map(lambda p: p * other)
        products = [RING.zero] * (2 * self.field.degree - 1)
        for i, p in enumerate(self.parts):
            for j, q in enumerate(self._parts(other)):
                products[i + j] = products[i + j] + p * q
        return OverField(self.field, products)

    __rmul__ = __mul__

    def __bool__(self) -> bool:
        """False for zero, decided exactly."""
        return any(self.parts)

    def terms(self) -> list[tuple[Powers, Exact]]:
        """The powers of (d, eta, h, q, v) that occur, with their coefficients."""
        found: dict[Powers, list[Fraction]] = {}
        for i, part in enumerate(self.parts):
            for powers, c in terms(part):
                found.setdefault(powers, [Fraction(0)] * len(self.parts))[i] = c
        elements = {powers: Algebraic(self.field, tuple(row)) for powers, row in found.items()}
        return [(powers, x.as_fraction() if x.is_rational else x) for powers, x in elements.items()]

    def _map(self, change: Callable[[Polynomial], Polynomial]) -> OverField:
        return OverField(self.field, [change(p) for p in self.parts])

    def _parts(self, other: Any) -> Sequence[Polynomial]:
        if not isinstance(other, OverField):
            return (RING.zero + other, *[RING.zero] * (self.field.degree - 1))
        if other.field != self.field:
            raise TypeError(f"no exact arithmetic between {self.field.name} and {other.field.name}")
        return other.parts


def polynomial(x: Exact) -> Polynomial:
    """`x` as a constant polynomial."""
    if isinstance(x, Algebraic):
        return OverField(x.field, [polynomial(c) for c in x.coefficients])
    return RING.ground_new(rational(x))


def terms(p: Polynomial) -> list[tuple[Powers, Any]]:
    """The powers of (d, eta, h, q, v) that occur, with their coefficients: Fractions, where irrational Algebraics."""
    if isinstance(p, OverField):
        return p.terms()
    return [(powers, Fraction(int(c.numerator), int(c.denominator))) for powers, c in p.terms()]


def constant_term(p: Polynomial) -> Exact:
    """The coefficient of 1."""
    found: Exact = dict(terms(p)).get((0,) * RING.ngens, Fraction(0))
    return found


def majorant(p: Polynomial) -> Polynomial:
    """The sum of |monomials|, irrational coefficients rounded up: at (|h|, |q|, |v|) it bounds |p| at (h, q, v)."""
    if isinstance(p, OverField):
        return RING.from_dict({powers: rational(above(size(c))) for powers, c in p.terms()})
    return RING.from_dict({powers: abs(c) for powers, c in p.terms()})


def nearly(p: Polynomial) -> tuple[Polynomial, Polynomial]:
    """(m, r) in RING with |p - m| at (h, q, v) at most r at (|h|, |q|, |v|); p and 0 where p is over Q."""
    if not isinstance(p, OverField):
        return p, RING.zero
    balls = {powers: middle_and_radius(c) for powers, c in p.terms()}
    middle, radius = ({powers: rational(pair[i]) for powers, pair in balls.items() if pair[i]} for i in range(2))
    return RING.from_dict(middle), RING.from_dict(radius)


@cache
def _reductions(field: NumberField) -> list[list[Any]]:
    """Rows: the coefficients of α**d, α**(d + 1), ..., α**(2d - 2) in 1, α, ..., α**(d - 1)."""
    rows = ((field.generator**k).coefficients for k in range(field.degree, 2 * field.degree - 1))
    return [[rational(c) for c in (*row, *[Fraction(0)] * (field.degree - len(row)))] for row in rows]
