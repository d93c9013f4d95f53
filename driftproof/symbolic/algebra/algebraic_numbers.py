"""Real algebraic numbers in their two forms, as elements of a number field and as roots; quotients of roots."""

from __future__ import annotations

from flint import ctx, fmpq_poly

from driftproof.methods.number_field import Algebraic, Exact, NumberField
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.polynomials import Polynomial, X, interpolate, norm, reflected, scalar
from driftproof.symbolic.algebra.real_roots import FIRST_BITS, ZERO, RealRoot, positive_roots, rational_root
from driftproof.symbolic.linear.limits import Infinity, Limit


def number_of(root: RealRoot, name: str = "alpha") -> Exact:
    """The root as exact data of `methods`, `name` being the generator of its field.

    Raises `driftproof.methods.number_field.UndecidedError` for a degree above 12.
    """
    if root.rational is not None:
        return root.rational
    low, high = root.interval()
    return NumberField(name, root.minimal, low, high).generator


def root_of(x: Exact) -> RealRoot:
    """The number as a root of its minimal polynomial, a factor of the norm of z - x."""
    if not isinstance(x, Algebraic):
        return rational_root(x)
    polynomial = norm(X - scalar(x))
    candidates = [*positive_roots([polynomial]), *(r.negated() for r in positive_roots([reflected(polynomial)]))]
    bits = FIRST_BITS
    while True:
        with ctx.workprec(bits):
            found = [root for root in candidates if root.ball().overlaps(enclose(x))]
        if len(found) == 1:
            return found[0]
        bits *= 2


def scaled(limit: Limit, size: RealRoot) -> Limit:
    """limit/size for a size > 0: what the limit of y = h size says of h."""
    return limit if isinstance(limit, Infinity) or limit == ZERO else ratio(limit, size)


def ratio(x: RealRoot, y: RealRoot) -> RealRoot:
    """x/y for positive x and y: a root of the product, over the conjugates of y, of m(yz), m the polynomial of x."""
    candidates = positive_roots([_product_over_conjugates(x, y)])
    bits = FIRST_BITS
    while True:
        with ctx.workprec(bits):
            found = [root for root in candidates if (root.ball() * y.ball()).overlaps(x.ball())]
        if len(found) == 1:
            return found[0]
        bits *= 2


def _product_over_conjugates(x: RealRoot, y: RealRoot) -> Polynomial:
    """Π m(yᵢz) over the roots yᵢ of y's polynomial, up to a constant: a resultant, by its values at integers z."""
    monic = y.polynomial / y.minimal[-1]  # so that the values stay those of one polynomial where the degree drops
    points = range(x.degree * y.degree + 1)
    return interpolate([monic.resultant(fmpq_poly([c * z**k for k, c in enumerate(x.minimal)])) for z in points])
