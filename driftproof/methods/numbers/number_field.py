"""Exact real algebraic numbers: the elements of Q(α), for coefficients such as sqrt 3 or the cube root of 2.

The arithmetic is FLINT's, which is loaded when the first field is made: methods with rational coefficients need none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property, lru_cache, total_ordering
from itertools import pairwise
from math import copysign
from typing import TYPE_CHECKING, Any, Self, TypeAlias

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction, dyadic, ends_of

if TYPE_CHECKING:
    from flint import arb, fmpq

# Chosen far above any published method: the time of an operation grows with the square of the degree.
LARGEST_FIELD_DEGREE = 12
_FIRST_BITS = 64


class UndecidedError(ValueError):
    """The degree of a polynomial is too large for a number field."""


@dataclass(frozen=True)
class NumberField:
    """The field Q(α), where α is the one root of an irreducible polynomial over Q in a given rational interval.

    `minimal` has integer coefficients, constant term first; `low` < α < `high`, and the polynomial changes sign there.
    `name` is how α is written, e.g. "sqrt(3)"; `roots` are empty, or if α is a sum Σ mβ of other numbers β, the field,
    m and the coefficients in powers of α of each. Raises ValueError if the polynomial does not change sign, has several
    roots in the interval, or factors, since equality in the field would then not be equality of numbers; raises
    UndecidedError for a degree above LARGEST_FIELD_DEGREE.
    """

    name: str
    minimal: tuple[int, ...]
    low: Fraction
    high: Fraction
    roots: tuple[tuple[NumberField, int, tuple[Fraction, ...]], ...] = field(default=(), compare=False, repr=False)

    def __post_init__(self) -> None:
        """Raise ValueError or UndecidedError unless the polynomial and the interval define a field."""
        from flint import fmpz_poly

        p = fmpz_poly(list(self.minimal))
        change = p(as_fmpq(self.low)) * p(as_fmpq(self.high))
        if len(self.minimal) < 3 or not self.minimal[-1] or self.low > self.high or change >= 0:
            raise ValueError(f"{self.name}: needs degree 2 or more, and a change of sign on the interval")
        if len(_roots_between(self, _FIRST_BITS)) != 1:
            raise ValueError(f"{self.name}: several roots lie between {self.low} and {self.high}; narrow the interval")
        if self.degree > LARGEST_FIELD_DEGREE:
            raise UndecidedError(f"degree {self.degree}: irreducibility is decided up to degree {LARGEST_FIELD_DEGREE}")
        if [multiplicity for _, multiplicity in p.factor()[1]] != [1]:
            raise ValueError(f"{self.name}: the minimal polynomial is reducible over Q")

    @property
    def degree(self) -> int:
        """The dimension of the field over Q."""
        return len(self.minimal) - 1

    @property
    def generator(self) -> Algebraic:
        """The number α as an element of the field."""
        return Algebraic(self, (0, 1))

    @property
    def summands(self) -> tuple[tuple[NumberField, int, tuple[Fraction, ...]], ...]:
        """The `roots`, or α itself in their place."""
        return self.roots or ((self, 1, (Fraction(0), Fraction(1))),)

    @cached_property
    def basis(self) -> tuple[list[str], list[list[fmpq]]]:
        """A basis of products of powers of the summands, as text ("" for 1), and the matrix from 1, α, ... to it.

        Its rows are lists, since methods are sent to isolated processes, and matrices cannot be.
        """
        from flint import fmpq_mat

        names, rows = [""], [self.generator**0]
        for root, _, parts in self.summands:
            start = [*zip(names, rows, strict=True)]
            for power in range(1, root.degree):
                more = [x * Algebraic(self, parts) ** power for _, x in start]
                if fmpq_mat([x.parts for x in (*rows, *more)]).rank() < len(rows) + len(more):
                    break
                factor = root.name if power == 1 else f"({root.name})**{power}"
                names, rows = names + [f"{name}*{factor}".strip("*") for name, _ in start], rows + more
        rows_of_inverse: list[list[fmpq]] = fmpq_mat([x.parts for x in rows]).inv().table()
        return names, rows_of_inverse

    def ball(self) -> arb:
        """A ball around α, at Arb's current precision."""
        from flint import ctx

        (found,) = _roots_between(self, ctx.prec)
        return found

    @cached_property
    def reductions(self) -> list[list[fmpq]]:
        """The coefficients of α**d, α**(d + 1), ..., α**(2d - 2) in 1, α, ..., α**(d - 1), a row for each."""
        from flint import fmpq_poly

        d, modulus = self.degree, fmpq_poly(list(self.minimal))
        powers = [fmpq_poly([0] * k + [1]) % modulus for k in range(d, 2 * d - 1)]
        return [[power[i] for i in range(d)] for power in powers]

    def inverse(self, parts: Sequence[fmpq]) -> list[fmpq]:
        """The coefficients of 1/x in 1, α, α**2, ..., given those of x. Raises ZeroDivisionError for x = 0."""
        from flint import fmpq_poly

        element = fmpq_poly(list(parts))
        if element == 0:
            raise ZeroDivisionError("division by zero in a number field")
        inverse: list[fmpq] = element.xgcd(fmpq_poly(list(self.minimal)))[1].coeffs()
        return inverse


class ScalarExtension:
    """A sum Σ αⁱ pᵢ with i below the degree of K = Q(α) and pᵢ in a commutative ring R over Q: R with scalars from K.

    A subclass defines R by `part`. Arithmetic takes what `part` accepts, and its own kind over the same field; anything
    else raises TypeError. Equality is exact.
    """

    __slots__ = ("field", "parts")

    def __init__(self, field: NumberField, parts: Sequence[Any]) -> None:
        """Take at most d parts, d the degree of the field, or 2d - 1, whose powers from α**d on are then reduced."""
        d = field.degree
        low = [*parts[:d], *(self.part(0) for _ in range(d - len(parts)))]
        if len(parts) > d:
            for high, row in zip(parts[d:], field.reductions, strict=True):
                low = [p + high * c for p, c in zip(low, row, strict=True)]
        self.field = field
        self.parts: tuple[Any, ...] = tuple(low)

    @staticmethod
    def part(x: object) -> Any:
        """x as an element of R. Raises TypeError if it is none."""
        raise NotImplementedError

    def __neg__(self) -> Self:
        return self._map(lambda p: -p)

    def __add__(self, other: object) -> Self:
        return self._made([p + q for p, q in zip(self.parts, self._parts(other), strict=True)])

    __radd__ = __add__

    def __sub__(self, other: object) -> Self:
        return self._made([p - q for p, q in zip(self.parts, self._parts(other), strict=True)])

    def __rsub__(self, other: object) -> Self:
        return -(self - other)

    def __mul__(self, other: object) -> Self:
        factors = self._parts(other)
        if not isinstance(other, type(self)):
            return self._map(lambda p: p * factors[0])
        products = [self.part(0)] * (2 * len(factors) - 1)
        for i, p in enumerate(self.parts):
            for j, q in enumerate(factors):
                products[i + j] = products[i + j] + p * q
        return self._made(products)

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> Self:
        """An integer power; a negative one is a power of the inverse, which the subclass must have."""
        base: Any = self if exponent >= 0 else 1 / self  # type: ignore[operator]
        result = type(self)(self.field, [self.part(1)])
        for _ in range(abs(exponent)):
            result = result * base
        return result

    def __eq__(self, other: object) -> bool:
        """True if all parts are equal, which is exact equality because the minimal polynomial is irreducible."""
        try:
            return self.parts == tuple(self._parts(other))
        except TypeError:
            return NotImplemented

    __hash__: Any = None

    def __bool__(self) -> bool:
        return any(self.parts)

    def _map(self, change: Callable[[Any], Any]) -> Self:
        return self._made([change(p) for p in self.parts])

    def _made(self, parts: Sequence[Any]) -> Self:
        """An element over the same field, of parts that are in R already."""
        made = object.__new__(type(self))
        ScalarExtension.__init__(made, self.field, parts)
        return made

    def _parts(self, other: object) -> Sequence[Any]:
        if not isinstance(other, type(self)):
            try:
                return (self.part(other), *(self.part(0) for _ in self.parts[1:]))
            except TypeError:
                kind = type(other).__name__
                raise TypeError(f"no exact arithmetic between {self.field.name} and {other!r} ({kind})") from None
        if other.field != self.field:
            raise TypeError(f"no exact arithmetic between {self.field.name} and {other.field.name}")
        return other.parts


@total_ordering
class Algebraic(ScalarExtension):
    """An exact, hashable element of a real number field, stored by its coefficients in powers of the generator.

    Arithmetic takes int, Fraction, FLINT's fmpq and elements of the same field; anything else, such as a float or an
    element of another field, raises TypeError. Equality is exact, order is decided by enclosures.
    """

    __slots__ = ()

    def __init__(self, field: NumberField, coefficients: Sequence[Any]) -> None:
        """The sum of the rational coefficients times 1, α, α**2, ..."""
        super().__init__(field, [self.part(c) for c in coefficients])

    @staticmethod
    def part(x: object) -> fmpq:
        """The rational number as FLINT's fmpq."""
        return as_fmpq(x)

    @property
    def coefficients(self) -> tuple[Fraction, ...]:
        """The coefficients of 1, α, α**2, ..., without trailing zeros."""
        end = len(self.parts)
        while end and not self.parts[end - 1]:
            end -= 1
        return tuple(as_fraction(p) for p in self.parts[:end])

    @property
    def is_rational(self) -> bool:
        """True if no power of the generator occurs."""
        return not any(self.parts[1:])

    def as_fraction(self) -> Fraction:
        """The number as a Fraction. Raises ValueError for an irrational one."""
        if not self.is_rational:
            raise ValueError(f"{self} is irrational")
        return as_fraction(self.parts[0])

    def __truediv__(self, other: object) -> Algebraic:
        """The quotient, in the field. Raises ZeroDivisionError."""
        return self * Algebraic(self.field, self.field.inverse(self._parts(other)))

    def __rtruediv__(self, other: object) -> Algebraic:
        """The quotient, in the field. Raises ZeroDivisionError."""
        return Algebraic(self.field, self.field.inverse(self.parts)) * other

    def __hash__(self) -> int:
        """The hash of the number; a rational one has that of its Fraction."""
        return hash(self.as_fraction()) if self.is_rational else hash(self.parts)

    def __lt__(self, other: object) -> bool:
        """True if self is the smaller real number, decided by the sign of the difference."""
        return (self - other).sign() == -1

    def sign(self) -> int:
        """The sign of the number: -1, 0 or 1."""
        from flint import ctx

        bits = _FIRST_BITS
        while True:
            with ctx.workprec(bits):
                sign = self.ball().sgn().unique_fmpz()
            if sign is not None:
                return int(sign)
            bits *= 2

    def __float__(self) -> float:
        """The double nearest to the number: the enclosure shrinks until both its ends round to the same double.

        This ends because an irrational number lies strictly between two ties. Raises OverflowError beyond all doubles.
        """
        bits = _FIRST_BITS
        while True:
            low, high = (float(end) for end in self.enclosure(bits))
            if low == high and copysign(1, low) == copysign(1, high):
                return low
            bits *= 2

    def ball(self) -> arb:
        """A ball around the number, at Arb's current precision."""
        from flint import arb_poly

        return arb_poly(list(self.parts))(self.field.ball())

    def enclosure(self, bits: int) -> tuple[Fraction, Fraction]:
        """Rational lower and upper bounds of the number, closer for more bits; equal for a rational number."""
        from flint import ctx

        if self.is_rational:
            return self.as_fraction(), self.as_fraction()
        with ctx.workprec(bits):
            ball = self.ball()
        return ends_of(ball)

    def __str__(self) -> str:
        """The number in products of powers of the roots that generate the field, e.g. "1/2 - 1/6*sqrt(3)"."""
        from flint import fmpq_mat

        text, (names, change) = "", self.field.basis
        for c, root in zip((fmpq_mat([self.parts]) * fmpq_mat(change)).entries(), names, strict=True):
            if c:
                body = str(abs(c)) if not root else root if abs(c) == 1 else f"{abs(c)}*{root}"
                sign = "-" if c < 0 else "+"
                text += f" {sign} {body}" if text else f"{sign}{body}".removeprefix("+")
        return text or "0"

    def __repr__(self) -> str:
        """The number as in "Algebraic(1/2 - 1/6*sqrt(3))"."""
        return f"Algebraic({self})"


# An exact coefficient of a method.
Exact: TypeAlias = Fraction | Algebraic


def total(values: Iterable[Exact]) -> Exact:
    """The sum of the values, 0 if there are none."""
    return sum(values, Fraction(0))


def square_root(n: int) -> Algebraic:
    """The number sqrt(n) for an integer n > 1 that is no square. Raises ValueError for any other n."""
    return integer_root(n, 2)


def cube_root(n: int) -> Algebraic:
    """The number n ** (1/3) for an integer n > 1 that is no cube. Raises ValueError for any other n."""
    return integer_root(n, 3)


@cache
def integer_root(n: int, degree: int) -> Algebraic:
    """The number n ** (1/degree) for an integer n > 1 that is no such power. Raises ValueError for any other n."""
    from flint import fmpz

    name = f"sqrt({n})" if degree == 2 else f"{n}**(1/{degree})"
    if n < 2 or (floor := int(fmpz(n).root(degree))) ** degree == n:
        raise ValueError(
            f"{name}: the number must exceed 1 and not be a {({2: 'square', 3: 'cube'}).get(degree, 'power')}"
        )
    return NumberField(name, (-n, *[0] * (degree - 1), 1), Fraction(floor), Fraction(floor + 1)).generator


@lru_cache(maxsize=4096)
def real_root_balls(coefficients: tuple[int, ...], bits: int) -> tuple[arb, ...]:
    """Disjoint balls, of at least `bits` bits, around the distinct real roots of an integer polynomial, ascending.

    The constant term comes first. The ball of a rational root whose denominator is a power of two has radius 0.
    """
    from flint import arb, ctx, fmpq, fmpz_poly

    balls: list[arb] = []
    with ctx.workprec(bits):
        for factor, _ in fmpz_poly(list(coefficients)).factor()[1]:
            if factor.degree() == 1:
                balls.append(arb(fmpq(-factor[0], factor[1])))
            else:
                balls += [root.real for root, _ in factor.complex_roots() if root.imag.is_zero()]
    balls.sort(key=lambda ball: dyadic(ball.mid()))
    if any(left.overlaps(right) for left, right in pairwise(balls)):
        return real_root_balls(coefficients, 2 * bits)
    return tuple(balls)


@cache
def _roots_between(field: NumberField, bits: int) -> list[arb]:
    """Balls around the roots of the minimal polynomial between `low` and `high`, neither of which is a root."""
    from flint import arb, ctx

    with ctx.workprec(bits):
        low, high = arb(as_fmpq(field.low)), arb(as_fmpq(field.high))
        balls = real_root_balls(field.minimal, bits)
        if any(ball.overlaps(low) or ball.overlaps(high) for ball in balls):
            return _roots_between(field, 2 * bits)
        return [ball for ball in balls if low < ball < high]
