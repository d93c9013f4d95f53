"""Exact step size limits for bounded powers of R(hλ), or of R(hJ) for a Jordan block J of λ."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from functools import lru_cache, reduce
from itertools import combinations
from math import comb
from operator import add
from typing import Any, TypeAlias

from flint import fmpq, fmpq_mat

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.algebra.certified import Uncertified, settled, sign_of_ball
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    ZERO,
    FieldPolynomial,
    Polynomial,
    Scalar,
    at_complex_ball,
    coefficients,
    descend,
    evaluate,
    interpolate,
    polynomial,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import Minimal, RealRoot, positive_roots, vanishes_at
from driftproof.symbolic.linear.eigenvalues import Complex
from driftproof.symbolic.linear.stability_limits import ALWAYS, NEVER, Bound, first_bound


def ray_bound(r: RationalFunction, total: Scalar, product: Scalar, block: int) -> Bound:
    """The bound of x > 0 for powers of R(xJ), J a Jordan block of size `block` for λ: λ + λ̄ = `total`, λλ̄ = `product`.

    They are bounded where |R(xλ)| < 1, and where |R(xλ)| = 1 and R(xJ) is a multiple of the identity. The latter means
    that R' and its derivatives of order below `block` - 1 vanish at xλ, equivalently those of P'Q - PQ'.
    """
    margin, obstacles = ray_conditions(r, total, product, block)
    if not margin:
        return ALWAYS if not any(obstacles) else NEVER
    return first_bound(
        positive_roots([margin]),
        lambda x: sign(evaluate(margin, x)) != -1,
        lambda root: not vanishes_at(margin, root) or all(vanishes_at(p, root) for p in obstacles),
    )


def ray_conditions(
    r: RationalFunction, total: Scalar, product: Scalar, block: int
) -> tuple[Polynomial, list[Polynomial]]:
    """|Q|² - |P|² at xλ, whose sign decides unless it is 0, and what must vanish where it is 0; polynomials in x."""
    margin = modulus_squared_along(r.den, total, product) - modulus_squared_along(r.num, total, product)
    return margin, [modulus_squared_along(p, total, product) for p in _slopes(r, block - 1)]


def at_rest(r: RationalFunction, block: int) -> Bound:
    """The bound for a Jordan block J of the eigenvalue 0, where R(xJ) must be the identity."""
    return NEVER if any(p[0] for p in _slopes(r, block - 1)) else ALWAYS


def modulus_squared_along(p: Polynomial, total: Scalar, product: Scalar) -> Polynomial:
    """|p(xλ)|² = Σ cⱼ cₖ xʲ⁺ᵏ λʲ λ̄ᵏ, as a polynomial in x, for λ + λ̄ = `total` and λλ̄ = `product`, p real."""
    scalars = p.coeffs()
    powers = _symmetric_powers(total, product, len(scalars))
    return descend(sum(((ONE * scalars[j] * scalars[k] * power).left_shift(j + k) for j, k, power in powers), ZERO))


def _slopes(r: RationalFunction, count: int) -> list[Polynomial]:
    """The first `count` of P'Q - PQ' and its derivatives."""
    p, found = r.num.derivative() * r.den - r.num * r.den.derivative(), []
    for _ in range(count):
        found.append(p)
        p = p.derivative()
    return found


# The largest degree of `pair_polynomial`; chosen: above it, factorisation takes minutes.
LARGEST_PAIR_DEGREE = 300
# The precision at which `margin_sign` gives up.
LAST_MARGIN_BITS = 1 << 14

# A square matrix over Q. FLINT's have no static types.
_Matrix: TypeAlias = Any
_Coefficients: TypeAlias = tuple[Exact, ...]


class UndecidedLimitError(ValueError):
    """Raised for a limit that is not decided here, with the reason in one line."""


def pair_bound(r: RationalFunction, place: Complex) -> Bound:
    """The bound for a semisimple λ: the largest h₀ with |R(hλ)| <= 1 for every h in (0, h₀].

    Between positive roots of `pair_polynomial` the sign of |Q(hλ)|² - |P(hλ)|² is constant and not zero, so a ball at
    one rational h decides it. Raises UndecidedLimitError if the polynomial is zero, or its degree above
    LARGEST_PAIR_DEGREE.
    """
    roots = _critical_steps(coefficients(r.num), coefficients(r.den), place.minimal)
    return first_bound(roots, lambda h: margin_sign(r, place, h) != -1)


@lru_cache
def _critical_steps(num: _Coefficients, den: _Coefficients, minimal: Minimal) -> list[RealRoot]:
    """The positive roots of `pair_polynomial`, cached, as all conjugates share them."""
    critical = pair_polynomial(RationalFunction(polynomial(num), polynomial(den)), minimal)
    if not critical:
        raise UndecidedLimitError("R(hλ)R(hμ) = 1 for every h for some pair of eigenvalues with λ + μ ≠ 0")
    return positive_roots([critical])


def margin_sign(r: RationalFunction, place: Complex, h: fmpq) -> int:
    """The sign of |Q(hλ)|² - |P(hλ)|², which must not be zero, by balls that shrink until they exclude zero.

    Raises UndecidedLimitError if they do not within LAST_MARGIN_BITS.
    """

    def read() -> int | None:
        num, den = (abs(at_complex_ball(p, place.ball() * h)) for p in (r.num, r.den))
        return sign_of_ball(den - num)

    try:
        return settled(read, last=LAST_MARGIN_BITS)
    except Uncertified:
        bits = LAST_MARGIN_BITS
        raise UndecidedLimitError(f"{bits} bits do not tell whether |R(hλ)| is below or above 1 at h = {h}") from None


def pair_polynomial(r: RationalFunction, minimal: Minimal) -> Polynomial:
    """Π (Q(hλ)Q(hμ) - P(hλ)P(hμ)) in Q[h], up to a constant, over unordered pairs of roots with λ + μ not 0.

    It is a determinant on the second exterior power for the companion matrix C. There u∧v, for eigenvectors u and v, is
    an eigenvector of S: u∧v ↦ Cu∧v + u∧Cv and of D: u∧v ↦ Cu∧Cv, and the factor of λ and μ is a polynomial in S and D.
    On the kernel of S, where R(z)R(-z) = 1 would make it 0, it is replaced by 1. Over a number field the norm is taken.
    """
    generator = _powers_of_generator(r)
    in_step = 2 * max(int(r.num.degree()), int(r.den.degree()))
    degree = in_step * comb(len(minimal) - 1, 2) * len(generator)
    if degree > LARGEST_PAIR_DEGREE:
        raise UndecidedLimitError(
            f"the polynomial in h of a complex eigenvalue has degree {degree} > {LARGEST_PAIR_DEGREE}"
        )
    companion = _companion(minimal)
    one = companion**0
    total, product = _on_pairs(companion, one) + _on_pairs(one, companion), _on_pairs(companion, companion)
    idle = _projection_on_kernel(total)
    kept = total**0 - idle
    terms = _margin_terms(r, total, product, len(generator))

    def at(h: int) -> fmpq:
        first, *others = (
            reduce(add, (row[i] * fmpq(h) ** n for n, row in terms.items())) * kept for i in range(len(generator))
        )
        return reduce(add, map(_kronecker, [first + idle, *others], generator)).det()

    return interpolate(at, degree)


def _margin_terms(r: RationalFunction, total: _Matrix, product: _Matrix, width: int) -> dict[int, list[_Matrix]]:
    """The coefficients of hⁿ in Q(hλ)Q(hμ) - P(hλ)P(hμ) as polynomials in S and D, each by its parts over the field."""
    terms: dict[int, list[_Matrix]] = defaultdict(lambda: [total * 0] * width)
    for p, factor in ((r.den, 1), (r.num, -1)):
        scalars = p.coeffs()
        for j, k, matrix in _symmetric_powers(total, product, len(scalars)):
            c = scalars[j] * scalars[k] * factor
            for i, x in enumerate([p[0] for p in c.parts] if isinstance(c, FieldPolynomial) else [c]):
                terms[j + k][i] = terms[j + k][i] + matrix * x
    return terms


def _symmetric_powers(total: Any, product: Any, count: int) -> Iterator[tuple[int, int, Any]]:
    """Yield (j, j, λʲμʲ) and (j, k, λʲμᵏ + λᵏμʲ), j < k < count, from `total` = λ + μ and `product` = λμ.

    The sums λⁿ + μⁿ satisfy the recurrence of x² - total x + product.
    """
    sums = [product**0 * 2, total]
    while len(sums) < count:
        sums.append(total * sums[-1] - product * sums[-2])
    for j in range(count):
        power = product**j
        yield j, j, power
        for k in range(j + 1, count):
            yield j, k, power * sums[k - j]


def _companion(minimal: Minimal) -> _Matrix:
    size = len(minimal) - 1
    last = [fmpq(-c, minimal[-1]) for c in minimal[:-1]]
    return fmpq_mat([[last[i] if j == size - 1 else fmpq(int(i == j + 1)) for j in range(size)] for i in range(size)])


def _on_pairs(a: _Matrix, b: _Matrix) -> _Matrix:
    """The matrix of eᵢ∧eⱼ ↦ Aeᵢ∧Beⱼ in the basis of the eᵢ∧eⱼ, i < j."""
    pairs = list(combinations(range(a.nrows()), 2))
    return fmpq_mat([[a[k, i] * b[m, j] - a[m, i] * b[k, j] for i, j in pairs] for k, m in pairs])


def _projection_on_kernel(s: _Matrix) -> _Matrix:
    """The projection q(S)/q(0), for a semisimple S with the characteristic polynomial xᵏq(x); 0 for k = 0."""
    coefficients = s.charpoly().coeffs()
    lowest = next(c for c in coefficients if c)
    value = s * 0
    for c in reversed(coefficients[coefficients.index(lowest) :]):
        value = value * s + s**0 * (c / lowest)
    return value


def _kronecker(a: _Matrix, b: _Matrix) -> _Matrix:
    rows = range(a.nrows()), range(b.nrows())
    return fmpq_mat([[a[i, j] * b[k, m] for j in rows[0] for m in rows[1]] for i in rows[0] for k in rows[1]])


def _powers_of_generator(r: RationalFunction) -> list[_Matrix]:
    """The matrices of multiplication by 1, α, α², ... below the degree of the field of R; [[1]] over Q."""
    fields = [p.field for p in (r.num, r.den) if isinstance(p, FieldPolynomial)]
    if not fields:
        return [fmpq_mat([[1]])]
    alpha = _companion(fields[0].minimal)
    return [alpha**k for k in range(alpha.nrows())]
