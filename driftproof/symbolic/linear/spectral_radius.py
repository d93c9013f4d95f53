"""The spectral radius of a 2x2 matrix with exact entries, exact."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt

from driftproof.methods.number_field import Algebraic
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.symbolic.algebra.polynomials import exact, scalar, sign


def spectral_radius(entries: Sequence[Fraction | Algebraic]) -> CertifiableReal:
    """The largest |λ| of a 2x2 matrix, its entries in the order of reading; a Fraction if it is rational.

    sqrt(det) for complex eigenvalues, else (|tr| + sqrt(tr² - 4 det))/2.
    """
    qq, qv, vq, vv = entries
    trace, area = (exact(scalar(x)) for x in (qq + vv, qq * vv - qv * vq))
    discriminant = exact(scalar(trace * trace - 4 * area))
    if sign(scalar(discriminant)) < 0:
        return _root(area)
    trace = trace if sign(scalar(trace)) >= 0 else -trace
    root = _root(discriminant)
    if isinstance(trace, Fraction) and isinstance(root, Fraction):
        return (trace + root) / 2
    return lambda: (enclose(trace) + enclose(root)) / 2


def _root(x: Fraction | Algebraic) -> CertifiableReal:
    """The square root of x >= 0."""
    if isinstance(x, Fraction):
        root = Fraction(isqrt(x.numerator), isqrt(x.denominator))
        if root * root == x:
            return root
    return lambda: enclose(x).sqrt()
