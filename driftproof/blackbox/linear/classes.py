"""The catalogue as one-step matrices: methods that have the same one are one class, which no linear test can split.

For q' = a v, v' = -k q every method of the catalogue has, with s = a k h²,

    M_qq = A(s),   M_qv = a h B(s),   M_vq = k h C(s),   M_vv = D(s):

its terms alternate between position and velocity. So the four functions of the oscillator, a = k = 1, are enough, and
k may be negative. With damping only Runge-Kutta methods have a step of their own: M = R(hL), L = [[0, a], [-k, -g]].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from math import exp, factorial

import numpy as np
from numpy.typing import NDArray

from driftproof.blackbox.linear.arithmetics import FLOATS, SERIES, Arithmetic, Number, horner, inverse, printed
from driftproof.blackbox.linear.sizes import COEFFICIENT_ROUNDINGS, FORCE_ROUNDINGS, Sized, SizePolynomial, matrix_sizes
from driftproof.methods.catalogue import METHODS
from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method, Splitting
from driftproof.methods.stepping import stepper
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients, exact, in_square, odd_part
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.series import expand
from driftproof.symbolic.linear.oscillator import one_step_matrix, stability_function_of
from driftproof.symbolic.runs import Entries, multiply

# 16^128/128! < 2^-200.
LONGEST_SERIES = 128
# Coefficients of a numerator or a denominator, constant term first.
Coefficients = Sequence[Exact]


@dataclass(frozen=True)
class Rates:
    """a, k and g of q' = a v, v' = -k q - g v, as numbers of some arithmetic, and the step h."""

    h: Number
    position: Number
    stiffness: Number
    damping: Number


@dataclass(frozen=True, eq=False)
class MethodClass:
    """All `methods` with the one-step matrix `matrix` on the oscillator."""

    methods: tuple[Method, ...]
    matrix: StepMatrix

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the methods, in the catalogue's order."""
        return tuple(method.key for method in self.methods)

    @property
    def splittings(self) -> tuple[Splitting, ...]:
        """Those of them that are splittings."""
        return tuple(method for method in self.methods if isinstance(method, Splitting))

    @cached_property
    def stability(self) -> RationalFunction | None:
        """R(z), where the methods have one."""
        return stability_function_of(self.methods[0])

    @property
    def is_rational(self) -> bool:
        """True when all coefficients of the matrix are rational numbers."""
        return self.methods[0].field is None

    @property
    def degree(self) -> int:
        """The largest degree in h of a numerator or a denominator of the matrix."""
        return max(int(p.degree()) for row in self.matrix for entry in row for p in (entry.num, entry.den))

    @cached_property
    def explicit(self) -> tuple[Method, ...]:
        """Those of the methods that are explicit."""
        return tuple(method for method in self.methods if method.explicit)

    @cached_property
    def in_square(self) -> tuple[tuple[Coefficients, Coefficients], ...]:
        """Numerators and denominators of A, B, C, D in s."""
        (qq, qv), (vq, vv) = self.matrix
        numerators = in_square(qq.num), odd_part(qv.num), odd_part(vq.num), in_square(vv.num)
        denominators = (in_square(entry.den) for entry in (qq, qv, vq, vv))
        return tuple((_of(n), _of(d)) for n, d in zip(numerators, denominators, strict=True))

    @cached_property
    def _converted(self) -> dict[tuple[str, str], list[list[Number]]]:
        return {}

    def _numbers(self, arithmetic: Arithmetic, name: str) -> list[list[Number]]:
        """The coefficients of A, B, C, D ("entries") or of R ("stability") in an arithmetic, converted once."""
        key = (arithmetic.name, name)
        if key not in self._converted:
            parts = [p for pair in self.in_square for p in pair] if name == "entries" else self._stability_parts()
            self._converted[key] = [[arithmetic.number(c) for c in part] for part in parts]
        return self._converted[key]

    def _stability_parts(self) -> list[Coefficients]:
        return [_of(self.stability.num), _of(self.stability.den)] if self.stability else []

    def plain(self, arithmetic: Arithmetic, rates: Rates) -> Entries:
        """M for q' = a v, v' = -k q, in any arithmetic but that of sizes. As a series, of decimals as printed."""
        if arithmetic is SERIES and self.methods[0].decimal:
            return self._as_printed(rates)
        in_position, in_velocity = rates.position * rates.h, rates.stiffness * rates.h
        s = in_position * in_velocity
        parts = self._numbers(arithmetic, "entries")
        qq, qv, vq, vv = (
            horner(n, s) if len(d) == 1 else horner(n, s) / horner(d, s)
            for n, d in zip(parts[::2], parts[1::2], strict=True)
        )
        return qq, in_position * qv, in_velocity * vq, vv

    def _as_printed(self, rates: Rates) -> Entries:
        """M with balls for coefficients, so that series differ where their methods do, not for residuals of decimals.

        The step is run in q and w = a v: q' = w, w' = -a k q.
        """
        stiffness, step = rates.position * rates.stiffness, stepper(self.methods[0], printed)
        one, nil = SERIES.number(Fraction(1)), SERIES.number(Fraction(0))
        columns = [step(lambda q: -(stiffness * q), q, w, rates.h) for q, w in ((one, nil), (nil, one))]
        (qq, wq), (qw, ww) = columns
        return qq, rates.position * qw, wq / rates.position, ww

    def damped(self, arithmetic: Arithmetic, rates: Rates) -> Entries:
        """R(hL), in any arithmetic but that of sizes. Raises ValueError for a method without R."""
        if self.stability is None:
            raise ValueError(f"{self.keys[0]} has no stability function")
        num, den = self._numbers(arithmetic, "stability")
        zero = arithmetic.number(Fraction(0))
        top = _at_field(num, rates, zero)
        return top if len(den) == 1 else multiply(top, inverse(_at_field(den, rates, zero)))

    def plain_sizes(self, rates: Rates) -> Entries:
        """The sizes of M for q' = a v, v' = -k q: the largest ones of all methods of the class. `rates` are floats."""
        if not self.explicit:
            return self.damped_sizes(Rates(rates.h, rates.position, rates.stiffness, 0.0))
        x = abs(rates.h) * abs(rates.position * rates.stiffness) ** 0.5
        in_position, in_velocity = abs(rates.h * rates.position), abs(rates.h * rates.stiffness)
        qq, qv, vq, vv = self._sizes
        sizes = qq(x), in_position * _lowered(qv)(x), in_velocity * _lowered(vq)(x), vv(x)
        parameter = 0 if abs(rates.position) == 1 else COEFFICIENT_ROUNDINGS
        counts = [p.roundings + parameter * len(p.sizes) for p in self._sizes]
        return _sized(self.plain(FLOATS, rates), sizes, counts)

    def damped_sizes(self, rates: Rates) -> Entries:
        """The sizes of R(hL). `rates` are floats.

        Of an implicit method, R = P/Q, any program errs to first order by |Q(hL)^-1| (dP + dQ |M|), if it forms P and
        Q as sums of monomials in hL and divides; dP and dQ are of the size of P and Q with absolute values throughout.
        """
        above = Rates(abs(rates.h), abs(rates.position), -abs(rates.stiffness), -abs(rates.damping))
        values = self.damped(FLOATS, rates)
        if self.explicit:
            qq, qv, _, _ = self._sizes
            longest = max(len(qq.sizes), len(qv.sizes))
            powers = [float(sum(p.sizes[k] for p in (qq, qv) if k < len(p.sizes))) for k in range(longest)]
            count = max(qq.roundings, qv.roundings) + _PER_POWER * longest
            return _sized(values, _at_field(powers, above, 0.0), [count] * 4)
        num, den = self._numbers(FLOATS, "stability")
        top, bottom = (_at_field([abs(c) for c in p], above, 0.0) for p in (num, den))
        back = _absolute(inverse(_at_field(den, rates, 0.0)))
        spread = [x + y for x, y in zip(top, multiply(bottom, _absolute(values)), strict=True)]
        size = multiply(back, (spread[0], spread[1], spread[2], spread[3]))
        count = COEFFICIENT_ROUNDINGS + (_PER_POWER + FORCE_ROUNDINGS + 3) * (len(num) + len(den))
        return _sized(values, size, [count] * 4)

    def series(self, position: Fraction, stiffness: Fraction, terms: int) -> list[list[Exact]]:
        """The first Taylor coefficients in h of M_qq, M_qv, M_vq, M_vv for q' = a v, v' = -k q."""
        found = []
        for entry, factor in zip(
            (f for row in self.matrix for f in row), (Fraction(1), position, stiffness, Fraction(1)), strict=True
        ):
            coefficients_ = (exact(c) for c in expand(entry, terms))
            found.append([c * factor * (position * stiffness) ** (i // 2) for i, c in enumerate(coefficients_)])
        return found

    @cached_property
    def _sizes(self) -> tuple[SizePolynomial, ...]:
        """Of the explicit methods of the class, the largest sizes and counts."""
        found = [matrix_sizes(method) for method in self.explicit]
        return tuple(_largest(entries) for entries in zip(*found, strict=True))

    def float_parts(self) -> list[list[float]]:
        """Numerators and denominators of A, B, C, D in s, in turn."""
        return self._numbers(FLOATS, "entries")


# A power of hL more costs two products, with h and with a rate, and two sums of two.
_PER_POWER = 4


@cache
def method_classes() -> tuple[MethodClass, ...]:
    """The catalogue by one-step matrix on the oscillator, in the order of its first methods."""
    found: dict[str, tuple[StepMatrix, list[Method]]] = {}
    for method in METHODS.values():
        matrix = one_step_matrix(method)
        written = str([entry.data() for row in matrix for entry in row])
        found.setdefault(written, (matrix, []))[1].append(method)
    return tuple(MethodClass(tuple(methods), matrix) for matrix, methods in found.values())


@cache
def _float_parts() -> NDArray[np.float64]:
    """The coefficients of all classes: by power of s, by class, by numerator and denominator of A, B, C, D."""
    parts = [each.float_parts() for each in method_classes()]
    found = np.zeros((max(len(p) for eight in parts for p in eight), len(parts), 8))
    for i, eight in enumerate(parts):
        for j, p in enumerate(eight):
            found[: len(p), i, j] = p
    return found


def all_matrices(h: float, position: float, stiffness: float) -> NDArray[np.float64]:
    """M(h) of each class for q' = a v, v' = -k q, in floats: M_qq, M_qv, M_vq, M_vv. Poles are infinite or NaN."""
    in_position, in_velocity = position * h, stiffness * h
    with np.errstate(all="ignore"):
        total = np.asarray(np.polynomial.polynomial.polyval(in_position * in_velocity, _float_parts()))
        found: NDArray[np.float64] = total[:, ::2] / total[:, 1::2] * np.array([1.0, in_position, in_velocity, 1.0])
        return found


def class_named(key: str) -> MethodClass:
    """The class of one method of the catalogue. Raises KeyError."""
    return {k: each for each in method_classes() for k in each.keys}[key]


def exact_flow(arithmetic: Arithmetic, rates: Rates) -> Entries:
    """exp(hL) by its series, in any arithmetic but that of sizes: to 2^-100 for |hL| <= 16, where that matters."""
    return _at_field(_exponential_series(arithmetic), rates, arithmetic.number(Fraction(0)))


@cache
def _exponential_series(arithmetic: Arithmetic) -> list[Number]:
    """1/k!, as many as the largest argument needs."""
    return [arithmetic.number(Fraction(1, factorial(k))) for k in range(LONGEST_SERIES)]


def exact_flow_sizes(rates: Rates) -> Entries:
    """The sizes of exp(hL) as cosines and sines, or their hyperbolic sisters, times exp(-gh/2). `rates` are floats.

    With x = |h| (sqrt|ak| + |g|), an argument in error by u x moves each function by at most (1 + x) e^x of its series'
    first term, and there are three of them: root, function, exponential.
    """
    in_position, in_velocity = abs(rates.h * rates.position), abs(rates.h * rates.stiffness)
    turn, drag = (in_position * in_velocity) ** 0.5, abs(rates.h * rates.damping)
    oscillates = 4 * rates.position * rates.stiffness > rates.damping**2
    size = (1 + turn + drag) ** 3 * exp(drag if oscillates else turn + drag)
    sizes = [size * x for x in (1.0, in_position, in_velocity, 1.0)]
    return _sized(exact_flow(FLOATS, rates), sizes, [3 * (COEFFICIENT_ROUNDINGS + FORCE_ROUNDINGS)] * 4)


def _of(p: object) -> Coefficients:
    return coefficients(p) or (Fraction(0),)


def _at_field(powers: Sequence[Number], rates: Rates, zero: Number) -> Entries:
    """P(hL) by Horner's rule, for the coefficients of P."""
    a, k, g = (rates.h * x for x in (rates.position, rates.stiffness, rates.damping))
    qq, qv, vq, vv = powers[-1], zero, zero, powers[-1]
    for c in powers[-2::-1]:
        qq, qv, vq, vv = a * vq + c, a * vv, -(k * qq) - g * vq, -(k * qv) - g * vv + c
    return qq, qv, vq, vv


def _absolute(m: Entries) -> Entries:
    qq, qv, vq, vv = (abs(x) for x in m)
    return qq, qv, vq, vv


def _lowered(p: SizePolynomial) -> SizePolynomial:
    """p(x)/x, for p without constant term."""
    return SizePolynomial(p.sizes[1:], p.count, p.additions)


def _sized(values: Entries, sizes: Sequence[float], counts: Sequence[int]) -> Entries:
    qq, qv, vq, vv = (Sized(*each) for each in zip(values, sizes, counts, strict=True))
    return qq, qv, vq, vv


def _largest(entries: Sequence[SizePolynomial]) -> SizePolynomial:
    """The sizes and the roundings that are nowhere below those of any of the polynomials."""
    longest = max(len(p.sizes) for p in entries)
    padded = [np.pad(p.sizes, (0, longest - len(p.sizes))) for p in entries]
    return SizePolynomial(np.max(padded, axis=0), max(p.roundings for p in entries))
