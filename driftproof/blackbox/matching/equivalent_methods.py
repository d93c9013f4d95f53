"""The catalogue as one-step matrices: methods with the same one are linearly equivalent, no linear test splits them.

For q' = a v, v' = -k q every method of the catalogue has, with s = a k h²,

    M_qq = A(s),   M_qv = a h B(s),   M_vq = k h C(s),   M_vv = D(s):

its terms alternate between position and velocity. So the four functions of the oscillator, a = k = 1, are enough, and
k may be negative. With each class stands what any float program of it may err by. As in
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
from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method, Splitting
from driftproof.methods.stepping import stepper
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients, deflate, odd_part, reflected
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import (
    area_factor,
    is_matrix_symmetric,
    oscillator_matrix,
    stability_function_of,
)
from driftproof.symbolic.rounding.any_evaluation_order import ErrorTally
from driftproof.symbolic.rounding.formats import FloatFormat

# M_qq, M_qv, M_vq, M_vv.
Four: TypeAlias = Sequence[float]
# Balls of this precision are far narrower than any rounding error that is compared with them.
CERTIFYING_BITS = 256
# A program may work its coefficients out, as in 1/(2 - 2**(1/3)): four operations, each rounded.
_COEFFICIENT_ROUNDINGS = 4
# A program may turn its state into units of its own and back: two factors each way.
_SCALING_ROUNDINGS = 4
# A program's force may hold parameters, as in -(k/m) q: two operations more than a change of sign.
_FORCE_ROUNDINGS = 2
# Of an implicit method, a power of hL more costs two products, with h and with a rate, and two sums of two.
_PER_POWER = 4


@dataclass(frozen=True)
class Rates:
    """The step h, and a and k of q' = a v, v' = -k q."""

    h: float
    position: float
    stiffness: float

    @property
    def moves(self) -> tuple[float, float]:
        """|a h| and |k h|."""
        return abs(self.position * self.h), abs(self.stiffness * self.h)


@dataclass(frozen=True)
class CountedSizes:
    """A polynomial in |h| by its sums of |monomials|, constant first, and the most roundings that a monomial passes."""

    sizes: NDArray[np.float64]
    count: int = 0

    def __bool__(self) -> bool:
        """False for zero."""
        return self.sizes.size > 0

    def __call__(self, x: float) -> float:
        """The sum of |monomials| at x >= 0."""
        return float(np.polynomial.polynomial.polyval(x, self.sizes)) if self else 0.0

    def __add__(self, other: CountedSizes) -> CountedSizes:
        """Sizes are added; of the counts the larger is kept."""
        longer, shorter = sorted((self.sizes, other.sizes), key=len, reverse=True)
        total = longer.copy()
        total[: len(shorter)] += shorter
        return CountedSizes(total, max(self.count, other.count))

    def __mul__(self, other: CountedSizes) -> CountedSizes:
        """Sizes are multiplied and counts added; zero has no count."""
        if not self or not other:
            return CountedSizes(np.zeros(0))
        return CountedSizes(np.convolve(self.sizes, other.sizes), self.count + other.count)

    def __pow__(self, n: int) -> CountedSizes:
        """The product of n of them."""
        return self * self ** (n - 1) if n else CountedSizes(np.ones(1))


class FloatTally(ErrorTally):
    """The any-order tally in floats: one count for all monomials."""

    rounding = CountedSizes(np.ones(1), 1)
    __slots__ = ()


def tallies_of(method: Method) -> tuple[CountedSizes, ...]:
    """What is tallied of M_qq, M_qv, M_vq, M_vv of an explicit method on q' = v, v' = -q. Raises MethodError."""
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
    """All methods with the one-step matrix `matrix` on the oscillator; or, where `adjoint`, with M(-h)⁻¹ = `matrix`."""

    methods: tuple[Method, ...]
    matrix: StepMatrix
    adjoint: bool = False

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the methods, in the catalogue's order."""
        return tuple(method.key for method in self.methods)

    @cached_property
    def programs(self) -> tuple[Method, ...]:
        """Explicit methods that take the step: those of the class; of an adjoint class its splittings, reversed."""
        if not self.adjoint:
            return tuple(method for method in self.methods if method.explicit)
        return tuple(replace(m, parts=m.parts[::-1]) for m in self.methods if isinstance(m, Splitting))

    @cached_property
    def parts(self) -> list[list[Exact]]:
        """Numerators and denominators of A, B, C, D in s, in turn."""
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
        """M(h) for q' = a v, v' = -k q, in balls. Infinite at a pole."""
        with ctx.workprec(CERTIFYING_BITS):
            in_position, in_velocity = enclose(position * h), enclose(stiffness * h)
            s = in_position * in_velocity
            values = [p(s) for p in self._in_balls]
            factors = (arb(1), in_position, in_velocity, arb(1))
            return [f * n / d for f, n, d in zip(factors, values[::2], values[1::2], strict=True)]

    def allowances(self, rates: Rates, fmt: FloatFormat) -> Four:
        """What any program of q' = a v, v' = -k q may err by: the most of all methods of the class."""
        return self._of_programs(rates, fmt) if self.programs else self._of_solver(rates, fmt)

    def _of_programs(self, rates: Rates, fmt: FloatFormat) -> Four:
        x = abs(rates.h) * abs(rates.position * rates.stiffness) ** 0.5
        (in_position, in_velocity), (qq, qv, vq, vv) = rates.moves, self._tallies
        sizes = (
            qq(x),
            in_position * CountedSizes(qv.sizes[1:])(x),
            in_velocity * CountedSizes(vq.sizes[1:])(x),
            vv(x),
        )
        parameter = 0 if abs(rates.position) == 1 else _COEFFICIENT_ROUNDINGS
        counts = (tally.count + parameter * len(tally.sizes) for tally in self._tallies)
        return [_allowance(*each, fmt) for each in zip(sizes, counts, strict=True)]

    @cached_property
    def _tallies(self) -> tuple[CountedSizes, ...]:
        found = [tallies_of(method) for method in self.programs]
        return tuple(_largest(entries) for entries in zip(*found, strict=True))

    def _of_solver(self, rates: Rates, fmt: FloatFormat) -> Four:
        """Of R = P/Q, any program errs to first order by |Q(hL)^-1| (dP + dQ |M|), L = [[0, a], [-k, 0]].

        That is if it forms P and Q as sums of monomials in hL and divides; dP and dQ are of the size of P and Q with
        absolute values throughout.
        """
        num, den = self._stability
        s = rates.position * rates.stiffness * rates.h**2
        above, below = (_at_hl([abs(c) for c in p], abs(s), rates) for p in (num, den))
        q = _at_hl(den, -s, rates)
        with np.errstate(all="ignore"):
            inverse = np.abs(q / (q[0, 0] ** 2 + np.sign(s) * q[0, 1] * q[1, 0]))
            matrix = np.abs(all_matrices((self,), rates)).reshape(2, 2)
            size = (inverse @ (above + below @ matrix)).ravel().tolist()
        count = _COEFFICIENT_ROUNDINGS + (_PER_POWER + _FORCE_ROUNDINGS + 3) * (len(num) + len(den))
        return [_allowance(x, count, fmt) for x in size]

    @cached_property
    def _stability(self) -> tuple[list[float], list[float]]:
        """The coefficients of R = P/Q; of the adjoint, 1/R(-z)."""
        r = stability_function_of(self.methods[0])
        assert r is not None
        pair = (reflected(r.den), reflected(r.num)) if self.adjoint else (r.num, r.den)
        num, den = ([float(c) for c in coefficients(p)] for p in pair)
        return num, den


@dataclass(frozen=True)
class ExactFlowMap:
    """The exact solution of q' = a v, v' = -k q, cosines and sines or their hyperbolic sisters by the sign of -ak."""

    def matrix_at(self, h: Fraction, position: Fraction, stiffness: Fraction) -> list[arb]:
        """exp(hL), in balls."""
        with ctx.workprec(CERTIFYING_BITS):
            in_position, in_velocity = enclose(position * h), enclose(stiffness * h)
            turn = acb(-in_position * in_velocity).sqrt()
            cosine, over_turn = turn.cosh().real, (turn.sinh() / turn).real
            return [cosine, in_position * over_turn, -in_velocity * over_turn, cosine]

    def allowances(self, rates: Rates, fmt: FloatFormat) -> Four:
        """With x = |h| sqrt|ak|, an argument in error by u x moves a function by at most (1 + x) e^x of its first term.

        There are three such errors: of the root, of the function, and of the quotient.
        """
        in_position, in_velocity = rates.moves
        turn = (in_position * in_velocity) ** 0.5
        size = (1 + turn) ** 3 * (1.0 if rates.position * rates.stiffness > 0 else exp(turn))
        count = 3 * (_COEFFICIENT_ROUNDINGS + _FORCE_ROUNDINGS)
        return [_allowance(size * x, count, fmt) for x in (1.0, in_position, in_velocity, 1.0)]


# A one-step map of q' = a v, v' = -k q that a stepper may be.
LinearMap: TypeAlias = LinearlyEquivalentMethods | ExactFlowMap


@cache
def equivalent_methods() -> tuple[LinearlyEquivalentMethods, ...]:
    """The catalogue by one-step matrix on the oscillator, in the order of its first methods."""
    found: dict[str, tuple[StepMatrix, list[Method]]] = {}
    for method in METHODS.values():
        matrix = oscillator_matrix(method)
        found.setdefault(_written(matrix), (matrix, []))[1].append(method)
    return tuple(LinearlyEquivalentMethods(tuple(methods), matrix) for matrix, methods in found.values())


@cache
def adjoint_methods() -> tuple[LinearlyEquivalentMethods, ...]:
    """The adjoints of those that have another matrix than any method of the catalogue, themselves included.

    A method that is its own adjoint is not among them: called an adjoint, the same step had an allowance 13 to 38 times
    wider. Nor are Nyström methods alone: their adjoints are implicit, and nobody's.
    """
    known, found = {_written(each.matrix) for each in equivalent_methods()}, []
    for each in equivalent_methods():
        has_program = any(isinstance(m, Splitting) for m in each.methods)
        if is_matrix_symmetric(each.matrix) or not (has_program or stability_function_of(each.methods[0])):
            continue
        matrix = _adjoint(each.matrix)
        if _written(matrix) not in known:
            found.append(LinearlyEquivalentMethods(each.methods, matrix, adjoint=True))
    return tuple(found)


def _adjoint(matrix: StepMatrix) -> StepMatrix:
    """M(-h)⁻¹: M_qq and M_vv are even in h, as is det M, and M_qv and M_vq are odd."""
    (qq, qv), (vq, vv) = matrix
    area = area_factor(matrix)
    by_area = fraction(area.den, area.num)
    return (vv * by_area, qv * by_area), (vq * by_area, qq * by_area)


def _written(matrix: StepMatrix) -> str:
    return str([entry.data() for row in matrix for entry in row])


def all_matrices(classes: tuple[LinearlyEquivalentMethods, ...], rates: Rates) -> NDArray[np.float64]:
    """M(h) of each class in floats, one row of four for each. Poles are infinite or NaN."""
    in_position, in_velocity = rates.position * rates.h, rates.stiffness * rates.h
    with np.errstate(all="ignore"):
        total = np.asarray(np.polynomial.polynomial.polyval(in_position * in_velocity, _float_parts(classes)))
        found: NDArray[np.float64] = total[:, ::2] / total[:, 1::2] * np.array([1.0, in_position, in_velocity, 1.0])
        return found


@cache
def _float_parts(classes: tuple[LinearlyEquivalentMethods, ...]) -> NDArray[np.float64]:
    """The coefficients by power of s, by class, by numerator and denominator of A, B, C, D."""
    found = np.zeros((max(len(p) for each in classes for p in each.parts), len(classes), 8))
    for i, each in enumerate(classes):
        for j, p in enumerate(each.parts):
            found[: len(p), i, j] = [float(c) for c in p]
    return found


def _at_hl(p: Sequence[float], square: float, rates: Rates) -> NDArray[np.float64]:
    """The entries of p(hL) = p_e(z²) + hL p_o(z²) but for the signs of a and k, at z² = `square`."""
    even, odd = (np.polynomial.polynomial.polyval(square, part) if part else 0.0 for part in (p[::2], p[1::2]))
    in_position, in_velocity = rates.moves
    return np.array([[even, in_position * odd], [in_velocity * odd, even]])


def _allowance(size: float, count: int, fmt: FloatFormat) -> float:
    """((1 + u)^k - 1) times the size, and k of the smallest subnormals."""
    k = count + _SCALING_ROUNDINGS
    return expm1(k * log1p(float(fmt.u))) * size + k * float(fmt.eta) if size < inf else inf


def _largest(entries: Iterable[CountedSizes]) -> CountedSizes:
    """The sizes and the roundings that are nowhere below those of any of the polynomials."""
    tallies = list(entries)
    longest = max(len(p.sizes) for p in tallies)
    padded = [np.pad(p.sizes, (0, longest - len(p.sizes))) for p in tallies]
    return CountedSizes(np.max(padded, axis=0), max(p.count for p in tallies))
