"""A linear multistep method on a linear system y' = Ay over Q: the h for which all its numerical solutions are bounded.

With m the minimal polynomial of an eigenvalue λ of A, the ζ of numerical solutions ζⁿ for λ and its conjugates are the
roots of Σᵢ mᵢ ρ(ζ)ⁱ (hσ(ζ))^(d - i), a rational polynomial for rational h. So the root condition is decided exactly. A
root that two conjugates shared would make λ = ρ/(hσ) equal for both, so that multiplicities are those of one λ.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property, reduce

from flint import acb, acb_poly, arb, ctx, fmpq_poly

from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.symbolic.algebra.certified import CertifiableReal, EnclosedReal, Uncertified, is_less
from driftproof.symbolic.algebra.polynomials import Polynomial, polynomial
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, Minimal, RealRoot, root_ratio
from driftproof.symbolic.linear.eigenvalues import Complex, Eigenvalue, Imaginary, eigenvalues
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.root_condition import all_inside, root_condition
from driftproof.symbolic.linear.stability_limits import ALWAYS, INFINITY, NEVER, Bound, Infinity, Limit
from driftproof.symbolic.linear.systems import EigenvalueLimit, LinearSystem, ball_of


class MultistepSystemFacts(LinearSystem):
    """The exact facts about a multistep method for y' = f on y' = Ay, A square with rational entries."""

    def __init__(self, method: Multistep, rows: Sequence[Sequence[Fraction]]) -> None:
        """Keep method and matrix, with the facts of the method alone."""
        self.method, self.rows, self._facts = method, rows, MultistepFacts(method)

    @cached_property
    def bounds(self) -> list[EigenvalueLimit]:
        """The eigenvalues of A, each with its bound."""
        return [EigenvalueLimit(eigenvalue, self._bound(eigenvalue)) for eigenvalue in eigenvalues(self.rows)]

    def part_is_bounded(self, eigenvalue: Eigenvalue, h: Fraction) -> bool:
        """True if solutions of one eigenvalue or pair are bounded. May raise UndecidedLimitError."""
        minimal = eigenvalue.place.minimal
        p = self._solutions(minimal, h)
        if p.degree() < self.method.steps * (len(minimal) - 1):
            return False  # hλ = ρₖ/σₖ: the step has no new value
        # On the circle dζ/dz = σ/(ρ' - zσ') is not 0, as ζ is no root of both; so a Jordan block makes n ζⁿ of it.
        return root_condition(p).holds if eigenvalue.block == 1 else all_inside(p)

    def factor_at(self, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
        """The largest |ζ| of solutions ζⁿ of one eigenvalue; 1 itself if one is on the unit circle and none outside."""
        minimal = eigenvalue.place.minimal
        if len(minimal) == 2 or (len(minimal) == 3 and not isinstance(eigenvalue.place, RealRoot)):
            p = self._solutions(minimal, h)
            if not all_inside(p) and root_condition(p, p.degree()).holds:
                return Fraction(1)

        def ball() -> arb:
            z = ball_of(eigenvalue) * as_fmpq(h)
            pairs = zip(self.method.rho, self.method.sigma, strict=True)
            return _largest_root([as_fmpq(r) - z * as_fmpq(s) for r, s in pairs])

        return ball

    def at_infinity(self) -> Fraction | Infinity | EnclosedReal:
        """The largest |ζ| in the limit of infinite hλ, where ζ are the roots of σ; infinite for an explicit method."""
        *earlier, newest = self.method.sigma
        if not newest or not any(earlier):
            return Fraction(0) if newest else INFINITY
        return EnclosedReal(lambda: _largest_root([acb(as_fmpq(x)) for x in self.method.sigma]))

    def _require_irreducible(self) -> None:
        if self._facts.common_factor is not None:
            raise UndecidedLimitError("rho and sigma have a common factor, whose solutions are not looked at")

    def _solutions(self, minimal: Minimal, h: Fraction) -> Polynomial:
        """The polynomial whose roots are the ζ of all roots λ of `minimal`. May raise UndecidedLimitError."""
        self._require_irreducible()
        rho, sigma, degree = polynomial(self.method.rho), polynomial(self.method.sigma) * as_fmpq(h), len(minimal) - 1
        return sum((c * rho**i * sigma ** (degree - i) for i, c in enumerate(minimal)), fmpq_poly())

    def _bound(self, eigenvalue: Eigenvalue) -> Bound | UndecidedLimitError:
        try:
            return self._decided_bound(eigenvalue)
        except (UndecidedLimitError, Uncertified) as reason:
            return UndecidedLimitError(str(reason))

    def _decided_bound(self, eigenvalue: Eigenvalue) -> Bound:
        """The bound; for an A-stable method also of a Jordan block, as every |ζ| < 1 inside the region of stability."""
        facts, place, block, real = self._facts, eigenvalue.place, eigenvalue.block, ball_of(eigenvalue).real
        self._require_irreducible()
        if not facts.zero_stable or (place == ZERO_ROOT and block > 1):
            return NEVER
        if place == ZERO_ROOT:
            return ALWAYS
        if facts.order < 1:
            raise UndecidedLimitError("the method is not consistent")
        if not isinstance(place, Imaginary) and real > 0:
            return NEVER  # the ζ that tends to 1 is 1 + hλ + O(h²)
        if isinstance(place, Imaginary):
            found = ALWAYS if facts.a_stable else self._scaled(facts.imaginary_limit, place.size, squared=True)
            if block > 1 and found != NEVER:
                raise UndecidedLimitError("a Jordan block of an undamped oscillation; each h is decided")
            return found
        if facts.a_stable:
            return ALWAYS
        if isinstance(place, RealRoot) and facts.real_limit is not None:
            found = self._scaled(facts.real_limit, place.negated(), squared=False)
            if block > 1 and found != NEVER:
                raise UndecidedLimitError("a Jordan block of a real eigenvalue; each h is decided")
            return found
        if isinstance(place, Complex) and facts.sector is not None and not isinstance(facts.sector.tan, Infinity):
            slope = lambda: abs(place.ball().imag / place.ball().real)
            if is_less(slope, facts.sector.tan.ball):
                return ALWAYS
        raise UndecidedLimitError("a complex eigenvalue outside every sector of A(alpha)-stability; each h is decided")

    def _scaled(self, limit: Limit, size: RealRoot, *, squared: bool) -> Bound:
        """The bound for h from that for h `size`; at a limit whose (squared) value is irrational it is not decided."""
        if isinstance(limit, Infinity) or limit == ZERO_ROOT:
            return ALWAYS if isinstance(limit, Infinity) else NEVER
        rho, sigma = polynomial(self.method.rho), polynomial(self.method.sigma)
        at, attained = limit.minimal, None
        if squared and len(at) == 3 and not at[1]:
            attained = root_condition(at[2] * rho * rho - at[0] * sigma * sigma).holds
        elif len(at) == 2:
            x = Fraction(-at[0], at[1])
            p = rho * rho + as_fmpq(x * x) * sigma * sigma if squared else rho + as_fmpq(x) * sigma
            attained = root_condition(p).holds
        return Bound(root_ratio(limit, size), attained)


def _largest_root(coefficients: Sequence[acb]) -> arb:
    """A ball around the largest |ζ| of the roots, constant term first; without an end if they are not told apart."""
    try:
        roots = acb_poly(coefficients).roots(tol=arb(2) ** (-ctx.prec // 2))
    except ValueError:
        return arb("nan")
    return reduce(arb.max, map(abs, roots))
