"""The catalogue by one-step matrix: methods with the same matrix are linearly equivalent; no linear test splits them.

For q' = a v, v' = -k q, and with s = a k h², the matrix of every method of the catalogue is

    M_qq = A(s),   M_qv = a h B(s),   M_vq = k h C(s),   M_vv = D(s):

because its terms alternate between position and velocity. So the four functions of the oscillator, a = k = 1, are
enough, and k may be negative. Each class also gives a bound on the error of any float program of it. As in
`symbolic.rounding.any_evaluation_order`, a monomial that passes k roundings in the worst order of evaluation errs by at
most ((1 + u)^k - 1) times its size; here k is the largest one of all monomials, and sizes are floats.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import chain
from math import exp, expm1, inf, log1p
from typing import TypeAlias

import numpy as np
from flint import acb, arb, arb_poly, ctx
from numpy.typing import NDArray

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Method, Splitting
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients, deflate, odd_part
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import area_factor, oscillator_matrix, stability_function_of
from driftproof.symbolic.rounding.any_evaluation_order import ErrorTally
from driftproof.symbolic.rounding.formats import FloatFormat

# M_qq, M_qv, M_vq, M_vv.
Four: TypeAlias = Sequence[float]
# Balls of this precision are far narrower than any rounding error that is compared with them.
CERTIFYING_BITS = 256
# A program may compute its coefficients: 1/(2 - 2**(1/3)) takes four operations, each of them rounded.
_COEFFICIENT_ROUNDINGS = 4
# A program may convert its state to units of its own and back, with two factors each way.
_SCALING_ROUNDINGS = 4
# A program's force may hold parameters, as in -(k/m) q: two operations more than a change of sign.
_FORCE_ROUNDINGS = 2
# Each further power of hL costs two products, by h and by a rate, and a sum. Dividing by Q in two components, by
# Cramer's rule, costs a determinant, which is a sum of two products, and a quotient.
_PER_POWER, _PER_DIVISION = 3, 3


@dataclass(frozen=True)
class Rates:
    """The step size h, and the a and k of q' = a v, v' = -k q."""

    h: float
    position: float
    stiffness: float

    @property
    def moves(self) -> tuple[float, float]:
        """The sizes |a h| and |k h|."""
        return abs(self.position * self.h), abs(self.stiffness * self.h)


@dataclass(frozen=True)
class CountedSizes:
    """The sums of |monomials| for each power of |h|, constant first, and the most roundings that a monomial passes."""

    sizes: NDArray[np.float64]
    count: int = 0

    def __bool__(self) -> bool:
        """False for the zero polynomial."""
        return self.sizes.size > 0

    def __call__(self, x: float) -> float:
        """The sum of |monomials| at x >= 0."""
        return float(np.polynomial.polynomial.polyval(x, self.sizes)) if self else 0.0

    def __add__(self, other: CountedSizes) -> CountedSizes:
        """The sum of the sizes, with the larger of the counts."""
        longer, shorter = sorted((self.sizes, other.sizes), key=len, reverse=True)
        total = longer.copy()
        total[: len(shorter)] += shorter
        return CountedSizes(total, max(self.count, other.count))

    def __mul__(self, other: CountedSizes) -> CountedSizes:
        """The product of the sizes, with the sum of the counts, which is 0 for a zero product."""
        if not self or not other:
            return CountedSizes(np.zeros(0))
        return CountedSizes(np.convolve(self.sizes, other.sizes), self.count + other.count)

    def __pow__(self, n: int) -> CountedSizes:
        """The product of n equal factors."""
        return self * self ** (n - 1) if n else CountedSizes(np.ones(1))


class FloatTally(ErrorTally):
    """The tally for any order of evaluation in floats, with one count of roundings for all monomials."""

    rounding = CountedSizes(np.ones(1), 1)
    __slots__ = ()


def tallies_of(method: Method) -> tuple[CountedSizes, ...]:
    """The sizes and counts of M_qq, M_qv, M_vq, M_vv for q' = v, v' = -q. Raises MethodError for an implicit method."""
    one, step_size = FloatTally(CountedSizes(np.ones(1)), factor=1), FloatTally(CountedSizes(np.array([0.0, 1.0])))
    nothing = FloatTally(CountedSizes(np.zeros(0)))

    def number(c: object) -> FloatTally:
        size = abs(float(c))  # type: ignore[arg-type]
        return FloatTally(CountedSizes(np.array([size]), _COEFFICIENT_ROUNDINGS))

    def force(q: FloatTally) -> FloatTally:
        return FloatTally(CountedSizes(q.size.sizes, q.size.count + _FORCE_ROUNDINGS), q.additions) if q.size else q

    step = stepper(method, number)
    columns = [step(force, q, v, step_size) for q, v in ((one, nothing), (nothing, one))]
    return tuple(entry.finished for row in zip(*columns, strict=True) for entry in row)


@dataclass(frozen=True, eq=False)
class LinearlyEquivalentMethods:
    """All methods with the one-step matrix `matrix` on the oscillator; or, if `adjoint`, with M(-h)⁻¹ = `matrix`."""

    methods: tuple[Method, ...]
    matrix: StepMatrix
    adjoint: bool = False

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the methods, in the catalogue's order."""
        return tuple(method.key for method in self.methods)

    @cached_property
    def programs(self) -> tuple[Method, ...]:
        """The explicit methods with this matrix: those of the class, or the reversed splittings of an adjoint class."""
        if not self.adjoint:
            return tuple(method for method in self.methods if method.explicit)
        return tuple(replace(m, parts=m.parts[::-1]) for m in self.methods if isinstance(m, Splitting))

    @cached_property
    def parts(self) -> list[list[Exact]]:
        """The numerators and denominators of A, B, C and D in powers of s, alternating."""
        (qq, qv), (vq, vv) = self.matrix
        numerators = deflate(qq.num), odd_part(qv.num), odd_part(vq.num), deflate(vv.num)
        denominators = (deflate(entry.den) for entry in (qq, qv, vq, vv))
        pairs = zip(numerators, denominators, strict=True)
        return [list(coefficients(p)) for p in chain.from_iterable(pairs)]

    @cached_property
    def _in_balls(self) -> list[arb_poly]:
        with ctx.workprec(CERTIFYING_BITS):
            return [arb_poly([enclose(c) for c in part]) for part in self.parts]

    def matrix_at(self, h: Fraction, position: Fraction, stiffness: Fraction) -> list[arb]:
        """M(h) for q' = a v, v' = -k q, in balls that are infinite at a pole."""
        with ctx.workprec(CERTIFYING_BITS):
            in_position, in_velocity = enclose(position * h), enclose(stiffness * h)
            s = in_position * in_velocity
            values = [p(s) for p in self._in_balls]
            factors = (arb(1), in_position, in_velocity, arb(1))
            return [f * n / d for f, n, d in zip(factors, values[::2], values[1::2], strict=True)]

    def allowances(self, rates: Rates, fmt: FloatFormat) -> Four:
        """The most that a float program for q' = a v, v' = -k q may err in each entry, whichever method it takes."""
        return self._of_programs(rates, fmt) if self.programs else self._of_solver(rates, fmt)

    def _of_programs(self, rates: Rates, fmt: FloatFormat) -> Four:
        x = abs(rates.h) * abs(rates.position * rates.stiffness) ** 0.5
        (in_position, in_velocity), (qq, qv, vq, vv) = rates.moves, self._tallies
        upper, lower = (CountedSizes(p.sizes[1:])(x) for p in (qv, vq))
        sizes = qq(x), in_position * upper, in_velocity * lower, vv(x)
        parameter = 0 if abs(rates.position) == 1 else _COEFFICIENT_ROUNDINGS
        counts = (tally.count + parameter * len(tally.sizes) for tally in self._tallies)
        return [_allowance(*each, fmt) for each in zip(sizes, counts, strict=True)]

    @cached_property
    def _tallies(self) -> tuple[CountedSizes, ...]:
        found = [tallies_of(method) for method in self.programs]
        return tuple(_largest(entries) for entries in zip(*found, strict=True))

    def _of_solver(self, rates: Rates, fmt: FloatFormat) -> Four:
        """The most that a program for Q(hL) M = P(hL) errs to first order: |Q^-1| (dP + dQ |M|), L = [[0, a], [-k, 0]].

        The program forms P and Q as sums of monomials in hL, and divides. A monomial of degree d passes the roundings
        of its coefficient, its product with it, and those of d powers, so that with k = k(d) roundings dP is at most
        k u times P with absolute values throughout; so is dQ. Dividing adds to the k of either: |M| <= |Q^-1| |Q| |M|,
        and the same is true of the determinant's terms over the determinant.
        """
        r = stability_function_of(self.methods[0])
        assert r is not None
        num, den = ([float(c) for c in coefficients(p)] for p in (r.num, r.den))
        s = rates.position * rates.stiffness * rates.h**2
        above, below = (_at_hl([abs(c) for c in p], abs(s), rates) for p in (num, den))
        q = _at_hl(den, -s, rates)
        with np.errstate(all="ignore"):
            inverse = np.abs(q / (q[0, 0] ** 2 + np.sign(s) * q[0, 1] * q[1, 0]))
            matrix = np.abs(all_matrices((self,), rates)).reshape(2, 2)
            size = (inverse @ (above + below @ matrix)).ravel().tolist()
        degree = max(len(num), len(den)) - 1
        count = _COEFFICIENT_ROUNDINGS + 1 + (_PER_POWER + _FORCE_ROUNDINGS) * degree + _PER_DIVISION
        return [_allowance(x, count, fmt) for x in size]


@dataclass(frozen=True)
class ExactFlowMap:
    """The exact solution of q' = a v, v' = -k q, by cosines and sines, or hyperbolic ones if ak is negative."""

    def matrix_at(self, h: Fraction, position: Fraction, stiffness: Fraction) -> list[arb]:
        """The matrix exp(hL) in balls, for L = [[0, a], [-k, 0]]."""
        with ctx.workprec(CERTIFYING_BITS):
            in_position, in_velocity = enclose(position * h), enclose(stiffness * h)
            turn = acb(-in_position * in_velocity).sqrt()
            cosine, over_turn = turn.cosh().real, (turn.sinh() / turn).real
            return [cosine, in_position * over_turn, -in_velocity * over_turn, cosine]

    def allowances(self, rates: Rates, fmt: FloatFormat) -> Four:
        """The most that a float program may err in each entry.

        With x = |h| sqrt|ak|, an error u x of the argument changes a function by at most (1 + x) e^x times its first
        term. There are three such errors: those of the root, of the function, and of the quotient.
        """
        in_position, in_velocity = rates.moves
        turn = (in_position * in_velocity) ** 0.5
        size = (1 + turn) ** 3 * (1.0 if rates.position * rates.stiffness > 0 else exp(turn))
        count = 3 * (_COEFFICIENT_ROUNDINGS + _FORCE_ROUNDINGS)
        return [_allowance(size * x, count, fmt) for x in (1.0, in_position, in_velocity, 1.0)]


# A one-step map of q' = a v, v' = -k q that a stepper may compute.
LinearMap: TypeAlias = LinearlyEquivalentMethods | ExactFlowMap


@cache
def equivalent_methods() -> tuple[LinearlyEquivalentMethods, ...]:
    """The catalogue grouped by one-step matrix on the oscillator, in the order of the first method of each class."""
    found: dict[str, tuple[StepMatrix, list[Method]]] = {}
    for method in METHODS.values():
        matrix = oscillator_matrix(method)
        found.setdefault(_written(matrix), (matrix, []))[1].append(method)
    return tuple(LinearlyEquivalentMethods(tuple(methods), matrix) for matrix, methods in found.values())


@cache
def adjoint_methods() -> tuple[LinearlyEquivalentMethods, ...]:
    """The adjoint classes of splittings whose matrix is that of no method of the catalogue.

    The adjoint of an explicit Runge-Kutta or Nyström method is implicit; it and those of implicit methods are either in
    the catalogue or not in use.
    """
    known, split = {_written(each.matrix) for each in equivalent_methods()}, list[LinearlyEquivalentMethods]()
    for each in equivalent_methods():
        if any(isinstance(m, Splitting) for m in each.methods):
            split.append(LinearlyEquivalentMethods(each.methods, _adjoint(each.matrix), adjoint=True))
    return tuple(each for each in split if _written(each.matrix) not in known)


def _adjoint(matrix: StepMatrix) -> StepMatrix:
    """The matrix M(-h)⁻¹, given that M_qq, M_vv and det M are even in h, and M_qv and M_vq odd."""
    (qq, qv), (vq, vv) = matrix
    area = area_factor(matrix)
    by_area = fraction(area.den, area.num)
    return (vv * by_area, qv * by_area), (vq * by_area, qq * by_area)


def _written(matrix: StepMatrix) -> str:
    return str([entry.data() for row in matrix for entry in row])


def all_matrices(classes: tuple[LinearlyEquivalentMethods, ...], rates: Rates) -> NDArray[np.float64]:
    """M(h) of each class in floats, as one row of four entries, which are infinite or NaN at a pole."""
    in_position, in_velocity = rates.position * rates.h, rates.stiffness * rates.h
    with np.errstate(all="ignore"):
        total = np.asarray(np.polynomial.polynomial.polyval(in_position * in_velocity, _float_parts(classes)))
        found: NDArray[np.float64] = total[:, ::2] / total[:, 1::2] * np.array([1.0, in_position, in_velocity, 1.0])
        return found


@cache
def _float_parts(classes: tuple[LinearlyEquivalentMethods, ...]) -> NDArray[np.float64]:
    """The coefficients indexed by power of s, class, and numerator or denominator of A, B, C, D, alternating."""
    found = np.zeros((max(len(p) for each in classes for p in each.parts), len(classes), 8))
    for i, each in enumerate(classes):
        for j, p in enumerate(each.parts):
            found[: len(p), i, j] = [float(c) for c in p]
    return found


def _at_hl(p: Sequence[float], square: float, rates: Rates) -> NDArray[np.float64]:
    """The entries of p(hL) = p_e(z²) + hL p_o(z²) at z² = `square`, without the signs of a and k."""
    even, odd = (np.polynomial.polynomial.polyval(square, part) if part else 0.0 for part in (p[::2], p[1::2]))
    in_position, in_velocity = rates.moves
    return np.array([[even, in_position * odd], [in_velocity * odd, even]])


def _allowance(size: float, count: int, fmt: FloatFormat) -> float:
    """The bound ((1 + u)^k - 1) times the size, plus k smallest subnormals, with k from `count`."""
    k = count + _SCALING_ROUNDINGS
    return expm1(k * log1p(float(fmt.u))) * size + k * float(fmt.eta) if size < inf else inf


def _largest(entries: Iterable[CountedSizes]) -> CountedSizes:
    """The largest size of each power in any of the polynomials, with their largest count."""
    tallies = list(entries)
    longest = max(len(p.sizes) for p in tallies)
    padded = [np.pad(p.sizes, (0, longest - len(p.sizes))) for p in tallies]
    return CountedSizes(np.max(padded, axis=0), max(p.count for p in tallies))
