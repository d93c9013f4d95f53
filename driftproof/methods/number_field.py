"""Exact real algebraic numbers: the elements of Q(α), for coefficients such as sqrt 3 or the cube root of 2."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache, total_ordering
from itertools import zip_longest
from math import copysign, isqrt
from typing import TypeAlias

from driftproof.methods.irreducibility import is_irreducible
from driftproof.methods.polynomials import Polynomial, divide, product, real_roots_between, trimmed, value_at


@dataclass(frozen=True)
class NumberField:
    """Q(α), for the one real root α of an irreducible polynomial over Q that lies in a given rational interval.

    `minimal` has integer coefficients, constant term first; `low` < α < `high`, and the polynomial changes sign there.
    `name` is how α is written, e.g. "sqrt(3)". Raises ValueError without a change of sign, for several roots in the
    interval, and for a polynomial that factors, with which equality in the field would not be equality of numbers.
    """

    name: str
    minimal: tuple[int, ...]
    low: Fraction
    high: Fraction

    def __post_init__(self) -> None:
        """Refuse an interval without a change of sign or with several roots, and a polynomial that factors."""
        changes = self.low < self.high and self._at(self.low) * self._at(self.high) < 0
        if len(self.minimal) < 3 or not self.minimal[-1] or not changes:
            raise ValueError(f"{self.name}: needs degree 2 or more, and a change of sign on the interval")
        if real_roots_between(self.minimal, self.low, self.high) != 1:
            raise ValueError(f"{self.name}: several roots lie between {self.low} and {self.high}; narrow the interval")
        if not is_irreducible(self.minimal):
            raise ValueError(f"{self.name}: the minimal polynomial is reducible, a product of two over Q")

    @property
    def degree(self) -> int:
        """The dimension of the field over Q."""
        return len(self.minimal) - 1

    @property
    def generator(self) -> Algebraic:
        """α itself."""
        return Algebraic(self, (Fraction(0), Fraction(1)))

    def enclosure(self, bits: int) -> tuple[Fraction, Fraction]:
        """Rational ends, at most 2**-bits apart, with α between them: by bisection on dyadic points."""
        return _bisected(self, bits)

    def _at(self, x: Fraction) -> Fraction:
        return value_at(self.minimal, x)


@lru_cache(maxsize=256)
def _bisected(field: NumberField, bits: int) -> tuple[Fraction, Fraction]:
    low, high = field.low, field.high
    rising = value_at(field.minimal, high) > 0
    while (high - low) * 2**bits > 1:
        middle = (low + high) / 2
        low, high = (low, middle) if (value_at(field.minimal, middle) > 0) == rising else (middle, high)
    return low, high


@total_ordering
@dataclass(frozen=True)
class Algebraic:
    """An element of a real number field, as a polynomial in its generator of smaller degree: exact, hashable.

    Arithmetic with int, Fraction and elements of the same field; equality is exact, order is decided by enclosures.
    Mixing fields raises TypeError, a float is refused like any other foreign number.
    """

    field: NumberField
    coefficients: Polynomial

    def __post_init__(self) -> None:
        """Reduce to the representative of least degree, so that equal numbers compare equal."""
        object.__setattr__(self, "coefficients", _remainder(self.coefficients, self.field.minimal))

    @property
    def is_rational(self) -> bool:
        """True when no power of the generator occurs."""
        return len(self.coefficients) <= 1

    def as_fraction(self) -> Fraction:
        """The number as a Fraction. Raises ValueError for an irrational one."""
        if not self.is_rational:
            raise ValueError(f"{self} is irrational")
        return self.coefficients[0] if self.coefficients else Fraction(0)

    def __add__(self, other: object) -> Algebraic:
        """The sum, in the field."""
        return self._combine(other, lambda a, b: tuple(x + y for x, y in zip_longest(a, b, fillvalue=Fraction(0))))

    __radd__ = __add__

    def __neg__(self) -> Algebraic:
        """The negative."""
        return Algebraic(self.field, tuple(-x for x in self.coefficients))

    def __sub__(self, other: object) -> Algebraic:
        """The difference, in the field."""
        return self._combine(other, lambda a, b: tuple(x - y for x, y in zip_longest(a, b, fillvalue=Fraction(0))))

    def __rsub__(self, other: object) -> Algebraic:
        """The difference, in the field."""
        return -(self - other)

    def __mul__(self, other: object) -> Algebraic:
        """The product, in the field."""
        return self._combine(other, product)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Algebraic:
        """The quotient, in the field. Raises ZeroDivisionError."""
        return self._combine(other, lambda a, b: product(a, _inverse(b, self.field.minimal)))

    def __rtruediv__(self, other: object) -> Algebraic:
        """The quotient, in the field. Raises ZeroDivisionError."""
        return self._combine(other, lambda a, b: product(b, _inverse(a, self.field.minimal)))

    def __pow__(self, exponent: int) -> Algebraic:
        """An integer power; negative ones by the inverse."""
        base = self if exponent >= 0 else 1 / self
        result = Algebraic(self.field, (Fraction(1),))
        for _ in range(abs(exponent)):
            result = result * base
        return result

    def __eq__(self, other: object) -> bool:
        """Equal as numbers, exactly."""
        try:
            return self.coefficients == self._coerce(other)
        except TypeError:
            return NotImplemented

    def __hash__(self) -> int:
        """Equal numbers hash alike, rational ones like their Fraction."""
        return hash(self.as_fraction()) if self.is_rational else hash(self.coefficients)

    def __bool__(self) -> bool:
        """False for zero."""
        return bool(self.coefficients)

    def __lt__(self, other: object) -> bool:
        """Less as real numbers, decided by enclosing the difference, which is zero only if it is the zero element."""
        return (self - other).sign() < 0

    def sign(self) -> int:
        """-1, 0 or 1."""
        if not self:
            return 0
        bits = 32
        while True:
            low, high = self.enclosure(bits)
            if low > 0 or high < 0:
                return 1 if low > 0 else -1
            bits *= 2

    def __float__(self) -> float:
        """The double nearest to the number: the enclosure shrinks until both its ends round to the same double.

        That happens, as an irrational number lies strictly between two ties. Raises OverflowError beyond the doubles.
        """
        bits = 64
        while True:
            low, high = (float(end) for end in self.enclosure(bits))
            if low == high and copysign(1, low) == copysign(1, high):
                return low
            bits *= 2

    def enclosure(self, bits: int) -> tuple[Fraction, Fraction]:
        """Rational ends with the number between them, the closer the higher `bits`: Horner's rule on intervals."""
        generator = self.field.enclosure(bits)
        low = high = Fraction(0)
        for coefficient in reversed(self.coefficients):
            ends = [x * y for x in (low, high) for y in generator]
            low, high = min(ends) + coefficient, max(ends) + coefficient
        return low, high

    def __str__(self) -> str:
        """E.g. "1/2 - 1/6*sqrt(3)"."""
        text = ""
        for power, coefficient in enumerate(self.coefficients):
            if coefficient:
                text += _term(coefficient, power, self.field.name, first=not text)
        return text or "0"

    def _coerce(self, other: object) -> Polynomial:
        if isinstance(other, Algebraic) and other.field == self.field:
            return other.coefficients
        if isinstance(other, int | Fraction) and not isinstance(other, bool):
            return (Fraction(other),) if other else ()
        raise TypeError(f"no exact arithmetic between {self.field.name} and {other!r} ({type(other).__name__})")

    def _combine(self, other: object, operation: Callable[[Polynomial, Polynomial], Polynomial]) -> Algebraic:
        return Algebraic(self.field, operation(self.coefficients, self._coerce(other)))


# An exact coefficient of a method.
Exact: TypeAlias = Fraction | Algebraic


@cache
def square_root(n: int) -> Algebraic:
    """sqrt n for an integer n > 1 that is no square. Raises ValueError for another n."""
    floor = isqrt(max(n, 0))
    if floor * floor == n or n < 2:
        raise ValueError(f"square_root({n}): n must be above 1 and no square")
    return NumberField(f"sqrt({n})", (-n, 0, 1), Fraction(floor), Fraction(floor + 1)).generator


@cache
def cube_root(n: int) -> Algebraic:
    """n ** (1/3) for an integer n > 1 that is no cube. Raises ValueError for another n."""
    floor = _integer_cube_root(max(n, 0))
    if floor**3 == n or n < 2:
        raise ValueError(f"cube_root({n}): n must be above 1 and no cube")
    return NumberField(f"{n}**(1/3)", (-n, 0, 0, 1), Fraction(floor), Fraction(floor + 1)).generator


def _integer_cube_root(n: int) -> int:
    low, high = 0, n + 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**3 <= n else (low, middle)
    return low


def _remainder(a: Sequence[Fraction], minimal: Sequence[int]) -> Polynomial:
    return trimmed(a) if len(a) < len(minimal) else divide(a, minimal)[1]


def _inverse(a: Polynomial, minimal: Sequence[int]) -> Polynomial:
    """The u with u a = 1 modulo the minimal polynomial, by Euclid's algorithm. Raises ZeroDivisionError for a = 0."""
    if not a:
        raise ZeroDivisionError("division by zero in a number field")
    r0, r1 = tuple(Fraction(x) for x in minimal), a
    u0, u1 = (), (Fraction(1),)  # type: tuple[Polynomial, Polynomial]
    while len(r1) > 1:
        quotient, rest = divide(r0, r1)
        step = product(quotient, u1)
        r0, r1 = r1, rest
        u0, u1 = u1, trimmed([x - y for x, y in zip_longest(u0, step, fillvalue=Fraction(0))])
    return tuple(x / r1[0] for x in u1)


def _term(coefficient: Fraction, power: int, name: str, *, first: bool) -> str:
    sign = "-" if coefficient < 0 else "+"
    size = abs(coefficient)
    root = name if power == 1 else f"({name})**{power}"
    body = str(size) if power == 0 else root if size == 1 else f"{size}*{root}"
    if first:
        return f"-{body}" if sign == "-" else body
    return f" {sign} {body}"
