"""Whether powers of a step on z' = Az stay bounded at one given step size, exact; how far each part is damped."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial

from flint import acb, acb_poly, arb, fmpq

from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import CertifiableReal
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import ONE, Polynomial, Scalar, at_ball, exact, scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, rational_root, root_ratio, sign_at
from driftproof.symbolic.linear.bounded_powers import boundary_of, is_bounded
from driftproof.symbolic.linear.conjugate_pairs import UndecidedLimitError, margin_sign
from driftproof.symbolic.linear.eigenvalues import Complex, Eigenvalue, Imaginary, eigenvalues
from driftproof.symbolic.linear.oscillator import linear_step_matrix, one_step_matrix, stability_function_of
from driftproof.symbolic.linear.rays import ALWAYS, at_rest, ray_conditions
from driftproof.symbolic.linear.spectral_radius import spectral_radius
from driftproof.symbolic.linear.systems import SystemFacts


def bounded_at(found: SystemFacts, h: Fraction) -> bool:
    """The powers of M(h) are bounded, decided for each eigenvalue of A; h > 0. Raises UndecidedLimitError."""
    return all(part_is_bounded(found, eigenvalue, h) for eigenvalue, _ in found.bounds)


def part_is_bounded(found: SystemFacts, eigenvalue: Eigenvalue, h: Fraction) -> bool:
    """The same for the part of M(h) that belongs to one eigenvalue, or to a pair. Raises UndecidedLimitError."""
    r = stability_function_of(found.method)
    if r is None:
        return _partitioned(found, eigenvalue, h)
    place, block = eigenvalue.place, eigenvalue.block
    if isinstance(place, Imaginary):
        return _on_ray(r, fmpq(0), fmpq(1), block, times(place.size, h))
    if isinstance(place, Complex):
        if place.degree == 2:
            return _on_ray(r, *place.sum_and_product(), block, rational_root(h))
        if block > 1:
            raise UndecidedLimitError("a complex eigenvalue of degree 3 or more with a Jordan block is not decided")
        return margin_sign(r, place, fmpq(h.numerator, h.denominator)) > 0
    if place == ZERO_ROOT:
        return at_rest(r, block) == ALWAYS
    ahead = place.ball() > 0
    return _on_ray(r, fmpq(2 if ahead else -2), fmpq(1), block, times(place if ahead else place.negated(), h))


def _on_ray(r: RationalFunction, total: Scalar, product: Scalar, block: int, x: RealRoot) -> bool:
    margin, obstacles = ray_conditions(r, total, product, block)
    inside = sign_at(margin, x)
    return inside > 0 or (inside == 0 and all(sign_at(p, x) == 0 for p in obstacles))


def _partitioned(found: SystemFacts, eigenvalue: Eigenvalue, h: Fraction) -> bool:
    """On q' = v, v' = Kq: the oscillator's matrix at hω, or that of q' = v, v' = q at h|λ|, by its exact signs."""
    place = eigenvalue.place
    if eigenvalue.block > 1 or isinstance(place, Complex) or place == ZERO_ROOT:
        raise UndecidedLimitError("a method that is not Runge-Kutta: only simple real and imaginary eigenvalues")
    if isinstance(place, Imaginary):
        matrix, size = one_step_matrix(found.method), place.size
    else:
        matrix = linear_step_matrix(found.method, [[0, 1], [1, 0]])
        size = place if place.ball() > 0 else place.negated()
    return is_bounded(boundary_of(matrix), partial(sign_at, root=times(size, h)))


def times(size: RealRoot, h: Fraction) -> RealRoot:
    """h times a positive number, h > 0."""
    return root_ratio(size, rational_root(1 / h))


def largest_eigenvalue(rows: Sequence[Sequence[Fraction]]) -> Eigenvalue:
    """The eigenvalue of A that is largest in size: the stiffest part of z' = Az, if it decays."""
    return max(eigenvalues(rows), key=lambda e: float(abs(_ball(e)).mid()))


def factor_at(found: SystemFacts, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
    """The largest size of an eigenvalue of M(h) that belongs to this one of A: |R(hλ)|, or of the 2x2 matrix at h|λ|.

    A Fraction where it is found to be rational: there no ball would tell a size of 1, or of 0.
    """
    r = stability_function_of(found.method)
    return (
        _size_of_function(r, eigenvalue, h)
        if r is not None
        else _radius(_block(found.method, eigenvalue), eigenvalue, h)
    )


def _size_of_function(r: RationalFunction, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
    place = eigenvalue.place
    if isinstance(place, RealRoot) and place.rational is not None:
        value = exact(r(scalar(h * place.rational)))
        if isinstance(value, Fraction):
            return abs(value)

    def ball() -> arb:
        z = _ball(eigenvalue) * fmpq(h.numerator, h.denominator)
        return abs(_at(r.num, z) / _at(r.den, z))

    return ball


def _block(method: Method, eigenvalue: Eigenvalue) -> StepMatrix:
    """The step on q' = v, v' = -q, or v' = q where λ is real."""
    real = isinstance(eigenvalue.place, RealRoot)
    return linear_step_matrix(method, [[0, 1], [1, 0]]) if real else one_step_matrix(method)


def _radius(matrix: StepMatrix, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
    place = eigenvalue.place
    size = place.size if isinstance(place, Imaginary) else place
    if isinstance(size, RealRoot) and size.rational is not None:
        x = scalar(abs(h * size.rational))
        return spectral_radius([exact(entry(x)) for row in matrix for entry in row])

    def ball() -> arb:
        y = abs(_ball(eigenvalue)) * fmpq(h.numerator, h.denominator)
        (a, b), (c, d) = ([at_ball(e.num, y) / at_ball(e.den, y) for e in row] for row in matrix)
        half, root = acb(a + d) / 2, acb((a - d) * (a - d) + 4 * b * c).sqrt() / 2
        return abs(half + root).max(abs(half - root))

    return ball


def _ball(eigenvalue: Eigenvalue) -> acb:
    place = eigenvalue.place
    return acb(0, place.size.ball()) if isinstance(place, Imaginary) else acb(place.ball())


def _at(p: Polynomial, z: acb) -> acb:
    return acb_poly([at_ball(ONE * c, arb(0)) for c in p.coeffs()])(z)
