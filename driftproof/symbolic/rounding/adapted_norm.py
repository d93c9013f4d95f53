"""The norm in which a step is a rotation times a factor: |M z| = rho |z| for every z."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.rounding.polynomials import absolute_value, rational_above

# Rational upper bounds of square roots are good to about this many bits.
ROOT_BITS = 200


class NoAdaptedNorm(ValueError):
    """The step is not a rotation times a factor in any norm given by a quadratic form."""


@dataclass(frozen=True)
class AdaptedNorm:
    """The norm |z|² = qq·q² + qv·q·v + vv·v², positive definite, with |M z|² = rho_squared |z|² for every z, exactly.

    Quantities derived from the four numbers are rational; irrational ones are rounded up.
    """

    qq: Exact
    qv: Exact
    vv: Exact
    rho_squared: Exact

    @property
    def rho(self) -> Fraction:
        """rho, rounded up; exact where it is rational."""
        return root_above(self.rho_squared)

    def length(self, q: Fraction, v: Fraction) -> Fraction:
        """|(q, v)|, rounded up; exact where it is rational."""
        return root_above(self.qq * q * q + self.qv * q * v + self.vv * v * v)

    def largest_of_signs(self, q: Fraction, v: Fraction) -> Fraction:
        """An upper bound of the norm on the rectangle with corners (±q, ±v), for q, v >= 0."""
        return root_above(self.qq * q * q + absolute_value(self.qv) * q * v + self.vv * v * v)

    @property
    def euclidean_per_unit(self) -> Fraction:
        """The largest sqrt(q² + v²) with |(q, v)| = 1, rounded up: 1 over the root of the smaller eigenvalue."""
        half_trace, determinant = (self.qq + self.vv) / 2, self._determinant
        return root_above((half_trace + root_above(half_trace**2 - determinant)) / determinant)

    @property
    def component_per_unit(self) -> Fraction:
        """The largest max(|q|, |v|) with |(q, v)| = 1, rounded up."""
        return root_above(max(self.qq, self.vv) / self._determinant)

    def gain(self, error: tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]) -> Fraction:
        """c, the largest norm of E|z| with any signs relative to |z|, rounded up, for a non-negative matrix E.

        With S+ and S- the form's matrix with |qv| and -|qv|, that is the root of the largest eigenvalue of the pair
        (Eᵀ S+ E, S-): |z| is least, for given |q| and |v|, where the mixed term is negative.
        """
        (a, b), (c, d) = error
        mixed = absolute_value(self.qv) / 2
        first = self.qq * a * a + 2 * mixed * a * c + self.vv * c * c
        cross = self.qq * a * b + mixed * (a * d + b * c) + self.vv * c * d
        last = self.qq * b * b + 2 * mixed * b * d + self.vv * d * d
        # det(A - x S-) = determinant x² - 2 half x + (first last - cross²)
        half = (first * self.vv + last * self.qq) / 2 + mixed * cross
        discriminant = half**2 - self._determinant * (first * last - cross**2)
        return root_above((half + root_above(discriminant)) / self._determinant)

    @property
    def _determinant(self) -> Exact:
        return self.qq * self.vv - self.qv**2 / 4


def adapted_norm(matrix: tuple[Exact, Exact, Exact, Exact]) -> AdaptedNorm:
    """The norm in which the exact matrix (M_qq, M_qv, M_vq, M_vv) is rho times an isometry, rho² = det M.

    Its square is the signed area of the parallelogram on z and M z, z ∧ Mz = M_vq q² + (M_vv - M_qq) q v - M_qv v²: M
    scales areas by det M, so Mz ∧ MMz = det M (z ∧ Mz), and the form is definite exactly where M has no real
    eigenvector. It is scaled so that the larger of its q² and v² coefficients is 1; a multiple of the identity, which
    sweeps no area, has the Euclidean norm. Raises NoAdaptedNorm where M has a real eigenvector otherwise.
    """
    qq, qv, vq, vv = matrix
    determinant = qq * vv - qv * vq
    if not qv and not vq and qq == vv:
        return AdaptedNorm(Fraction(1), Fraction(0), Fraction(1), determinant)
    if (qq + vv) ** 2 - 4 * determinant >= 0:
        raise NoAdaptedNorm("the step has real eigenvalues, so in no norm is it a rotation times a factor")
    scale = max(vq, -qv, key=absolute_value)
    return AdaptedNorm(vq / scale, (vv - qq) / scale, -qv / scale, determinant)


def root_above(exact: Exact) -> Fraction:
    """A rational r >= sqrt(x) for x >= 0, within a relative 2**-ROOT_BITS, and exact where sqrt(x) is that short.

    For an irrational x, r is within a relative 2**-GUARD_BITS.
    """
    x = rational_above(exact)
    shift = max(0, ROOT_BITS - (x.numerator.bit_length() - x.denominator.bit_length()) // 2)
    scaled = -(-(x.numerator << (2 * shift)) // x.denominator)
    root = isqrt(scaled)
    return Fraction(root if root * root == scaled else root + 1, 1 << shift)
