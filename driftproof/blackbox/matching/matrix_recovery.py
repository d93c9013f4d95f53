"""Recovery of an unknown one-step matrix from its values: each entry as a polynomial or a rational function of h.

The values y at m steps determine m coefficients c = L y by a linear system, and errors e of the values change them by
at most |L| e. The program is assumed to round each monomial of the result at most _ROUNDINGS times for each power of h,
so that e = k u Σ |monomials|. Each coefficient is then read as the simplest rational within its error, and the function
must have the values at all other steps, some of which are not dyadic, up to the same k u Σ |monomials|.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq_mat

from driftproof.blackbox.probes.coefficients import simple_rational
from driftproof.blackbox.probes.linear_steps import LinearReading
from driftproof.symbolic.algebra.polynomials import polynomial, scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction

# About twice what a power of h costs: computing a coefficient, a force, one or two products, and one or two sums.
_ROUNDINGS = 18
# Steps that determine coefficients, in units of the reading's own time; the others check them.
NODES = tuple(Fraction(x) for x in ("1/8", "1/4", "1/2", "1", "2", "4", "16"))
BOTH_WAYS = tuple(sign * x for x in NODES[:-1] for sign in (1, -1))
# A denominator with more coefficients would need more steps than are read.
MOST_IN_DENOMINATOR = 4


@dataclass(frozen=True)
class Coefficient:
    """A coefficient with its possible error, which is 0 if it is taken to be a simple rational."""

    value: Fraction
    error: Fraction = Fraction(0)

    def __str__(self) -> str:
        """The number, with its error unless it is taken to be exact."""
        if self.error == 0:
            return str(self.value)
        return f"{float(self.value):.15g} (up to {float(self.error):.1g})"


_ZERO, _ONE = Coefficient(Fraction(0)), Coefficient(Fraction(1))


@dataclass(frozen=True)
class Recovered:
    """An entry of the matrix: coefficients of its numerator and denominator in powers of h, constant terms first."""

    num: tuple[Coefficient, ...]
    den: tuple[Coefficient, ...]

    @property
    def exact(self) -> bool:
        """True if all coefficients are simple rationals."""
        return all(c.error == 0 for c in (*self.num, *self.den))

    @property
    def function(self) -> RationalFunction:
        """The function, with the central values of coefficients that have an error."""
        num, den = (polynomial([c.value for c in part]) for part in (self.num, self.den))
        return fraction(num, den)


@dataclass(frozen=True)
class _Shape:
    """The powers of x = h/unit in numerator and denominator; the constant term of the denominator is always 1."""

    num: tuple[int, ...]
    den: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        return len(self.num) + len(self.den)


def recovered(reading: LinearReading) -> list[Recovered] | None:
    """The four entries of the matrix; None if one of them is no polynomial or quotient of few coefficients."""
    found = []
    for i in range(4):
        values = {Fraction(h) / Fraction(reading.unit): Fraction(m[i]) for h, m in reading.steps}
        entry = next(_fitting(values, reading.format.u), None)
        if entry is None:
            return None
        found.append(_in_seconds(entry, Fraction(reading.unit)))
    return found


def _fitting(values: dict[Fraction, Fraction], u: Fraction) -> Iterator[Recovered]:
    """Yield the functions with all these values: polynomials, then quotients, those with few coefficients first."""
    parity = _parity(values, u)
    nodes = [x for x in (BOTH_WAYS if parity is None else NODES) if x in values]
    for shape in _shapes(parity, len(nodes)):
        picked = [nodes[round(i * (len(nodes) - 1) / max(shape.size - 1, 1))] for i in range(shape.size)]
        entry = _solved(shape, picked, values, u)
        if entry is not None and _meets(entry, values, u):
            yield entry


def _parity(values: dict[Fraction, Fraction], u: Fraction) -> int | None:
    """The parity of the function with these values: 0 if it is even, 1 if it is odd, None if it is neither."""
    pairs = [(x, y, values[-x]) for x, y in values.items() if x > 0 and -x in values]
    for parity, sign in ((0, 1), (1, -1)):
        if pairs and all(abs(y - sign * z) <= _ROUNDINGS * u * (abs(y) + abs(z)) for _, y, z in pairs):
            return parity
    return None


def _shapes(parity: int | None, most: int) -> Iterator[_Shape]:
    """Yield the shapes with at most `most` coefficients: polynomials, then quotients."""
    first, stride = (0, 1) if parity is None else (parity, 2)
    powers = tuple(range(first, first + stride * most, stride))
    for size in range(1, most + 1):
        yield _Shape(powers[:size])
    below = tuple(range(stride, stride * (MOST_IN_DENOMINATOR + 1), stride))
    for size in range(most + 1):
        for q in range(1, min(size, MOST_IN_DENOMINATOR + 1)):
            yield _Shape(powers[: size - q], below[:q])


def _solved(
    shape: _Shape, nodes: Sequence[Fraction], values: dict[Fraction, Fraction], u: Fraction
) -> Recovered | None:
    """The function of a shape with Σ nᵢ xⁱ - y Σ dⱼ xʲ = y at the nodes and errors |L| e; None if it is not unique."""
    rows = [[*(x**i for i in shape.num), *(-values[x] * x**j for j in shape.den)] for x in nodes]
    matrix = fmpq_mat([[scalar(c) for c in row] for row in rows])
    if matrix.det() == 0:
        return None
    inverse = matrix.inv()
    column = inverse * fmpq_mat(shape.size, 1, [scalar(values[x]) for x in nodes])
    solution = [Fraction(int(c.p), int(c.q)) for c in column.entries()]
    first = _entry(shape, [Coefficient(c) for c in solution])
    errors = [_allowed(first, x, values[x], u) for x in nodes]
    table = [[abs(Fraction(int(c.p), int(c.q))) for c in row] for row in inverse.table()]
    spread = [sum((b * e for b, e in zip(row, errors, strict=True)), Fraction(0)) for row in table]
    simple = [simple_rational(x, e) for x, e in zip(solution, spread, strict=True)]
    triples = zip(simple, solution, spread, strict=True)
    return _entry(shape, [Coefficient(x, e) if s is None else Coefficient(s) for s, x, e in triples])


def _entry(shape: _Shape, coefficients: Sequence[Coefficient]) -> Recovered:
    num = dict(zip(shape.num, coefficients, strict=False))
    den = dict(zip(shape.den, coefficients[len(shape.num) :], strict=True)) | {0: _ONE}
    return Recovered(*(tuple(p.get(i, _ZERO) for i in range(max(p) + 1)) for p in (num, den)))


def _meets(entry: Recovered, values: dict[Fraction, Fraction], u: Fraction) -> bool:
    """True if the function has all the values, up to rounding."""
    num, den = ([c.value for c in part] for part in (entry.num, entry.den))
    return all(abs(_at(num, x) - y * _at(den, x)) <= _allowed(entry, x, y, u) for x, y in values.items())


def _allowed(entry: Recovered, x: Fraction, y: Fraction, u: Fraction) -> Fraction:
    """The bound k u (Σ|num| + |y| Σ|den|) of |num - y den| to first order, for y off by k u times its monomials."""
    k = _ROUNDINGS * (len(entry.num) + len(entry.den))
    above, below = (_at([abs(c.value) for c in part], abs(x)) for part in (entry.num, entry.den))
    return k * u * (above + (abs(y) * below if len(entry.den) > 1 else 0))


def _at(coefficients: Sequence[Fraction], x: Fraction) -> Fraction:
    """The polynomial with these coefficients, constant term first, at x."""
    return sum((c * x**i for i, c in enumerate(coefficients)), Fraction(0))


def _in_seconds(entry: Recovered, unit: Fraction) -> Recovered:
    """The entry in powers of h, from the entry in powers of h/unit."""
    num, den = (
        tuple(Coefficient(c.value / unit**i, c.error / unit**i) for i, c in enumerate(part))
        for part in (entry.num, entry.den)
    )
    return Recovered(num, den)
