"""The eigenvalues of a rational matrix, exact, with their multiplicities and the sizes of Jordan blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TypeAlias

from flint import acb, ctx, fmpq, fmpq_mat, fmpz_poly

from driftproof.methods.numbers.flint_rationals import dyadic
from driftproof.symbolic.algebra.certified import ISOLATING_BITS, settled, sign_of_ball
from driftproof.symbolic.algebra.real_roots import Minimal, RealRoot, every_real_root, irreducible_factors_of

_Rows: TypeAlias = Sequence[Sequence[Fraction]]


@dataclass(frozen=True)
class Imaginary:
    """The pair ±iω of roots of an irreducible polynomial over Z, ω = `size` > 0."""

    minimal: Minimal
    size: RealRoot


@dataclass(frozen=True)
class Complex:
    """Two conjugate roots, neither real nor imaginary, of an irreducible polynomial over Z.

    `index` numbers such roots in the upper half-plane, from 0, in a fixed order.
    """

    minimal: Minimal
    index: int

    @property
    def degree(self) -> int:
        """The degree of the number over Q."""
        return len(self.minimal) - 1

    def ball(self) -> acb:
        """A ball around the root in the upper half-plane, at Arb's current precision."""
        return _upper_balls(self.minimal, ctx.prec)[self.index]

    def sum_and_product(self) -> tuple[fmpq, fmpq]:
        """The rational numbers λ + λ̄ and λλ̄ for degree 2. Raises ValueError for any other degree."""
        if self.degree != 2:
            raise ValueError("the sum and the product of these conjugates are not rational")
        c, b, a = self.minimal
        return fmpq(-b, a), fmpq(c, a)


RootPlace: TypeAlias = RealRoot | Imaginary | Complex


@dataclass(frozen=True)
class Eigenvalue:
    """A real eigenvalue or a conjugate pair, with its algebraic multiplicity.

    `block` is the size of its largest Jordan block, 1 if the eigenvalue is semisimple.
    """

    place: RootPlace
    multiplicity: int
    block: int


def eigenvalues(rows: _Rows) -> list[Eigenvalue]:
    """All eigenvalues of the matrix, conjugate pairs once, from the factors of the characteristic polynomial."""
    matrix = fmpq_mat([[fmpq(*x.as_integer_ratio()) for x in row] for row in rows])
    blocks = dict(irreducible_factors_of(matrix.minpoly()))
    found = sorted(irreducible_factors_of(matrix.charpoly()), key=lambda item: (len(item[0]), item[0]))
    return [Eigenvalue(place, exponent, blocks[m]) for m, exponent in found for place in root_places(m)]


def root_places(minimal: Minimal) -> list[RootPlace]:
    """Every root of an irreducible polynomial, conjugate pairs once: first real, then imaginary, then other roots."""
    imaginary = [Imaginary(minimal, size) for size in _on_imaginary_axis(minimal)]
    others = [Complex(minimal, k) for k in range(len(_upper_balls(minimal, ISOLATING_BITS)))]
    return [*every_real_root(minimal), *imaginary, *others]


def _on_imaginary_axis(minimal: Minimal) -> list[RealRoot]:
    """The ω > 0 with f(iω) = 0, ascending: an irreducible f with such a root is even, f(x) = g(x²), and g(-ω²) = 0."""
    if any(minimal[1::2]):
        return []
    below = reversed(every_real_root(minimal[::2]))
    return [root.negated().square_root() for root in below if sign_of_ball(root.ball()) == -1]


@lru_cache
def _upper_balls(minimal: Minimal, bits: int) -> tuple[acb, ...]:
    """Balls around the roots above the real axis and off the imaginary axis, in the same order for any `bits`."""
    on_axis = len(_on_imaginary_axis(minimal))
    first = () if bits == ISOLATING_BITS else _upper_balls(minimal, ISOLATING_BITS)

    def in_order() -> tuple[acb, ...] | None:
        roots = [root for root, _ in fmpz_poly(list(minimal)).complex_roots() if sign_of_ball(root.imag) == 1]
        apart = [root for root in roots if not root.real.contains(0)]
        if len(roots) - len(apart) != on_axis:
            return None
        if not first:
            return tuple(sorted(apart, key=lambda root: (dyadic(root.real.mid()), dyadic(root.imag.mid()))))
        matches = [root for ball in first for root in apart if root.overlaps(ball)]
        return tuple(matches) if len(matches) == len(first) else None

    return settled(in_order, bits)
