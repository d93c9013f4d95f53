"""Several roots in one field: a primitive element of Q(α, β), and fractional powers of rational numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache, reduce
from itertools import count
from math import floor
from typing import Any

from driftproof.methods.number_field import (
    LARGEST_FIELD_DEGREE,
    Algebraic,
    Exact,
    NumberField,
    UndecidedError,
    dyadic,
    integer_root,
    real_root_balls,
)

# Products of degrees beyond this are refused before anything is worked out: the field would rarely be a small one.
LARGEST_PRODUCT = 4 * LARGEST_FIELD_DEGREE


def in_one_field(values: Sequence[Exact]) -> list[Exact]:
    """The same numbers, all irrational ones in one field. Raises UndecidedError where its degree would be too large."""
    return [element_of(x, common_field(values)) for x in values]


def common_field(values: Iterable[Exact]) -> NumberField | None:
    """A field in which all of the numbers lie; None if all are rational."""
    fields = list(dict.fromkeys(x.field for x in values if isinstance(x, Algebraic)))
    return reduce(compositum, fields) if fields else None


def element_of(x: Exact, field: NumberField | None) -> Exact:
    """x as an element of a field that `common_field` made of its own and others; x itself where that was of others."""
    if not isinstance(x, Algebraic) or field is None or x.field not in _generators(field):
        return x
    lifted: Exact = _at(x, _generators(field)[x.field])
    return lifted


def _at(x: Algebraic, generator: Algebraic) -> Any:
    """x with this number in the place of its field's generator."""
    found: Any = Fraction(0)
    for c in reversed(x.coefficients):
        found = found * generator + c
    return found


@cache
def compositum(one: NumberField, other: NumberField) -> NumberField:
    """Q(α, β), by γ = α + kβ, whose powers span Q[x, y]/(p(x), q(y)) for almost every k.

    There x and y are polynomials in γ modulo γ's characteristic polynomial, and so they are modulo its factor that has
    the real number γ as a root, which is irrational. Raises UndecidedError for a degree above LARGEST_FIELD_DEGREE.
    """
    from flint import arb, ctx, fmpq, fmpq_mat, fmpq_poly

    d, e = one.degree, other.degree
    size = d * e
    if size > LARGEST_PRODUCT:
        raise UndecidedError(f"{one.name} and {other.name} together may have degree {size}; write one field")
    for k in count(1):
        rows, power = list[list[Any]](), {(0, 0): fmpq(1)}
        while len(rows) <= size:
            rows.append([power.get((i, j), fmpq(0)) for i in range(d) for j in range(e)])
            power = _times_sum(power, one, other, k)
        spanned = fmpq_mat(rows[:size]).transpose()
        if spanned.det() != 0:
            break
    units = [[fmpq(int(m == e)), fmpq(int(m == 1)), rows[size][m]] for m in range(size)]
    found = spanned.solve(fmpq_mat(units))
    alpha, beta, top = ([found[m, column] for m in range(size)] for column in range(3))
    characteristic = fmpq_poly([*(-c for c in top), 1]).numer()
    factors = [tuple(int(c) for c in factor.coeffs()) for factor, _ in characteristic.factor()[1]]
    bits, near = 32, list[tuple[int, ...]]()
    while len(near) != 1:  # no other root of the characteristic polynomial lies within the ends
        unit = 2**bits
        bits *= 2
        with ctx.workprec(bits):
            gamma = one.ball() + k * other.ball()
            low, high = floor(dyadic(gamma.lower()) * unit) - 1, floor(dyadic(gamma.upper()) * unit) + 2
            around = (arb(low) / unit).union(arb(high) / unit)
            near = [p for p in factors for ball in real_root_balls(p, bits) if ball.overlaps(around)]
    (minimal,) = near
    name = f"({one.name} + {other.name if k == 1 else f'{k}*{other.name}'})"
    field = NumberField(name, minimal, Fraction(low, unit), Fraction(high, unit))
    for old, parts in ((one, alpha), (other, beta)):
        generator = Algebraic(field, (fmpq_poly(parts) % fmpq_poly(list(minimal))).coeffs())
        _generators(field).update({known: _at(element, generator) for known, element in _generators(old).items()})
    return field


@cache
def _generators(field: NumberField) -> dict[NumberField, Algebraic]:
    """The generators of the fields of which this one was made, itself among them."""
    return {field: field.generator}


def _times_sum(power: dict[tuple[int, int], Any], one: NumberField, other: NumberField, k: int) -> dict[Any, Any]:
    """Times x + ky, reduced by both minimal polynomials."""
    found: dict[tuple[int, int], Any] = {}

    def add(i: int, j: int, c: Any) -> None:
        if i == one.degree:
            for m in range(i):
                add(m, j, -c * one.minimal[m] / one.minimal[-1])
        elif j == other.degree:
            for m in range(j):
                add(i, m, -c * other.minimal[m] / other.minimal[-1])
        else:
            found[i, j] = found.get((i, j), 0) + c

    for (i, j), c in power.items():
        add(i + 1, j, c)
        add(i, j + 1, k * c)
    return found


def rational_power(base: Fraction, exponent: Fraction) -> Exact:
    """base**exponent for a rational base > 0, exact. Raises ValueError for another base and a root above the 12th."""
    degree = exponent.denominator
    if base <= 0:
        raise ValueError("only a positive rational number may have a fractional exponent")
    if degree > LARGEST_FIELD_DEGREE:
        raise UndecidedError(f"a root of degree {degree}; at most {LARGEST_FIELD_DEGREE} is supported")
    from flint import fmpz

    power = base**exponent.numerator
    radicand, below = power.numerator * power.denominator ** (degree - 1), power.denominator
    for prime in (2, 3, 5, 7, 11):
        while degree % prime == 0 and (root := int(fmpz(radicand).root(prime))) ** prime == radicand:
            radicand, degree = root, degree // prime
    return Fraction(radicand, below) if degree == 1 else integer_root(radicand, degree) / Fraction(below)
