"""Real algebraic numbers as roots of irreducible integer polynomials; the positive roots of polynomials, in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TypeAlias

from flint import arb, ctx, fmpq, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fmpq, dyadic
from driftproof.methods.numbers.number_field import Algebraic, Exact, NumberField, real_root_balls
from driftproof.symbolic.algebra.certified import (
    ISOLATING_BITS,
    decide_by_enclosure,
    settled,
    sign_of_ball,
    significant,
)
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    X,
    at_ball,
    greatest_common_divisor,
    interpolate,
    norm,
    quotient,
    reflected,
    scalar,
    sign_changes,
)
from driftproof.symbolic.algebra.rational_functions import monomial_text, sum_text

# Coefficients of a primitive polynomial over Z, constant term first, leading coefficient positive.
Minimal: TypeAlias = tuple[int, ...]


@dataclass(frozen=True)
class RealRoot:
    """The real root number `index` (from 0, ascending) of an irreducible primitive polynomial over Z.

    Equal numbers are equal objects: the minimal polynomial is unique, and so is the index.
    """

    minimal: Minimal
    index: int

    def __repr__(self) -> str:
        """The number's digits and its minimal polynomial; a rational number itself."""
        polynomial = sum_text(monomial_text(Fraction(c), k, "x") for k, c in reversed([*enumerate(self.minimal)]) if c)
        return f"{significant(self.ball, 20)}, a root of {polynomial}" if self.rational is None else str(self.rational)

    def __float__(self) -> float:
        """The double nearest to the number."""
        return decide_by_enclosure(self.ball if self.rational is None else self.rational, float)

    def ball(self) -> arb:
        """A ball around the number, at Arb's current precision or ISOLATING_BITS, whichever is higher."""
        return real_root_balls(self.minimal, max(ctx.prec, ISOLATING_BITS))[self.index]

    @property
    def polynomial(self) -> Polynomial:
        """The minimal polynomial, over Q."""
        return fmpq_poly(list(self.minimal))

    @property
    def degree(self) -> int:
        """The degree of the number over Q."""
        return len(self.minimal) - 1

    @property
    def rational(self) -> Fraction | None:
        """The number itself if it is rational, else None."""
        return Fraction(-self.minimal[0], self.minimal[1]) if self.degree == 1 else None

    def interval(self) -> tuple[Fraction, Fraction]:
        """Two short dyadic numbers between which lies this root, but no other real root of the minimal polynomial.

        For a rational number, both are the number itself.
        """
        if self.rational is not None:
            return self.rational, self.rational

        def apart() -> list[tuple[Fraction, Fraction]] | None:
            # lower() and upper() round outwards, so that balls that are apart may touch here
            ends = [(dyadic(b.lower()), dyadic(b.upper())) for b in real_root_balls(self.minimal, ctx.prec)]
            return ends if all(left[1] < right[0] for left, right in pairwise(ends)) else None

        ends = settled(apart)
        low, high = ends[self.index]
        before = max([low - 1, *(end for _, end in ends[: self.index])])
        after = min([high + 1, *(end for end, _ in ends[self.index + 1 :])])
        return simplest_between(before, low), simplest_between(high, after)

    def negated(self) -> RealRoot:
        """The negative of the number."""
        lead = (-1) ** self.degree
        minimal = tuple(lead * (-c if k % 2 else c) for k, c in enumerate(self.minimal))
        return every_real_root(minimal)[-1 - self.index]

    def square_root(self) -> RealRoot:
        """The non-negative square root. Raises ValueError for a negative number."""
        doubled = [c for coefficient in self.minimal for c in (coefficient, 0)][:-1]
        candidates = [root for m, _ in irreducible_factors_of(fmpq_poly(doubled)) for root in every_real_root(m)]
        try:
            return one_root(
                candidates, lambda r: sign_of_ball(r.ball()) != -1 and (r.ball() ** 2).overlaps(self.ball())
            )
        except ValueError:
            raise ValueError("a negative number has no real square root") from None


ZERO_ROOT = RealRoot((0, 1), 0)


def rational_root(x: Fraction) -> RealRoot:
    """The rational number x as a root of its minimal polynomial."""
    return RealRoot((-x.numerator, x.denominator), 0)


def every_real_root(minimal: Minimal) -> list[RealRoot]:
    """The real roots of an irreducible primitive polynomial over Z, ascending."""
    return [RealRoot(minimal, k) for k in range(len(real_root_balls(minimal, ISOLATING_BITS)))]


def positive_roots(polynomials: Iterable[Polynomial]) -> list[RealRoot]:
    """The positive real roots of the nonzero polynomials, ascending and without repetition.

    Over a number field, positive roots of the conjugate polynomials are in the list as well. FLINT isolates the roots
    in certified balls; distinct irreducible polynomials share no root, so enough precision separates them.
    """
    minimals = {m for p in polynomials if sign_changes(p) for m, _ in irreducible_factors_of(norm(p))}

    def ordered() -> list[RealRoot] | None:
        roots = [RealRoot(m, k) for m in minimals for k, b in enumerate(real_root_balls(m, ctx.prec)) if b > 0]
        roots.sort(key=lambda root: dyadic(root.ball().mid()))
        return roots if all(left.ball() < right.ball() for left, right in pairwise(roots)) else None

    return settled(ordered)


def samples(roots: list[RealRoot]) -> list[fmpq]:
    """Rational points, one inside each of the open intervals that the ascending positive roots cut (0, oo) into."""
    if not roots:
        return [fmpq(1)]

    def inner() -> list[Fraction] | None:
        ends = [(dyadic(r.ball().lower()), dyadic(r.ball().upper())) for r in roots]
        gaps = [(Fraction(0), ends[0][0]), *((a[1], b[0]) for a, b in pairwise(ends))]
        if any(low >= high for low, high in gaps):
            return None
        return [*(simplest_between(low, high) for low, high in gaps), Fraction(ends[-1][1] // 1 + 1)]

    return [as_fmpq(x) for x in settled(inner)]


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """The dyadic number of least denominator in the open interval (low, high), so that evaluating there is cheap."""
    unit = 1
    while True:
        candidate = Fraction(low * unit // 1 + 1, unit)
        if candidate < high:
            return candidate
        unit *= 2


def vanishes_at(p: Polynomial, root: RealRoot) -> bool:
    """True if p(root) = 0, decided exactly, also for p over a number field.

    Let d be the greatest common divisor of p and the minimal polynomial, which is d e with d and e coprime: the root is
    a root of exactly one of the two, and balls show which one does not vanish.
    """
    if not p:
        return True
    minimal = root.polynomial
    common = greatest_common_divisor(minimal, p)
    if common == ONE:
        return False
    if common.degree() == minimal.degree():
        return True
    rest = quotient(minimal, common)

    def is_of_common() -> bool | None:
        at_common, at_rest = (bool(at_ball(q, root.ball()).contains(0)) for q in (common, rest))
        return None if at_common and at_rest else at_common

    return settled(is_of_common)


def sign_at(p: Polynomial, root: RealRoot) -> int:
    """The sign of p(root): -1, 0 or 1, exact."""
    return 0 if vanishes_at(p, root) else settled(lambda: sign_of_ball(at_ball(p, root.ball())))


def irreducible_factors_of(p: Polynomial) -> list[tuple[Minimal, int]]:
    """The irreducible factors of a nonzero polynomial over Q, primitive over Z, each with its exponent."""
    return [(tuple(int(c) for c in f.coeffs()), int(exponent)) for f, exponent in p.numer().factor()[1]]


def root_as_number(root: RealRoot, name: str = "alpha") -> Exact:
    """The root as exact data of `methods`; `name` is that of the generator of its field.

    Raises `driftproof.methods.numbers.number_field.UndecidedError` for a degree above 12.
    """
    if root.rational is not None:
        return root.rational
    low, high = root.interval()
    return NumberField(name, root.minimal, low, high).generator


def root_of(x: Exact) -> RealRoot:
    """The number x as a root of its minimal polynomial, a factor of the norm of z - x."""
    if not isinstance(x, Algebraic):
        return rational_root(x)
    polynomial = norm(X - scalar(x))
    candidates = [*positive_roots([polynomial]), *(r.negated() for r in positive_roots([reflected(polynomial)]))]
    return one_root(candidates, lambda root: root.ball().overlaps(x.ball()))


def root_ratio(x: RealRoot, y: RealRoot) -> RealRoot:
    """x/y for positive x and y: a root of the product of m(yz) over the conjugates of y, m the polynomial of x."""
    monic = y.polynomial / y.minimal[-1]  # so that the values belong to one polynomial also where the degree drops
    # Up to a constant, the product over the conjugates is a resultant, interpolated here from its values at integers z.
    values = lambda z: monic.resultant(fmpq_poly([c * z**k for k, c in enumerate(x.minimal)]))
    product = interpolate(values, x.degree * y.degree)
    return one_root(positive_roots([product]), lambda root: (root.ball() * y.ball()).overlaps(x.ball()))


def one_root(candidates: Iterable[RealRoot], fits: Callable[[RealRoot], bool]) -> RealRoot:
    """The only candidate that `fits` at every precision. Raises ValueError if there is none."""
    left = list(candidates)

    def fitting() -> list[RealRoot] | None:
        left[:] = [root for root in left if fits(root)]
        return None if len(left) > 1 else left

    if (found := next(iter(settled(fitting)), None)) is None:
        raise ValueError("no root is the number")
    return found
