"""tan α of A(α)-stability by bisection, each step proved: for degrees at which its minimal polynomial is of no use."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from flint import acb, arb, ctx, fmpq

from driftproof.symbolic.algebra.polynomials import Polynomial, from_scalars, scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.linear.implicit_stability import negative_point
from driftproof.symbolic.linear.region import complex_roots


@dataclass(eq=False)
class EnclosedTangent:
    """The number tan α, known by enclosures as narrow as asked for; `margin` is that of `sector.ray_margin`.

    |R| <= 1 in the closed sector up to T = tan² if it is so on its two rays and no pole lies inside: by Phragmén and
    Lindelöf, as R is rational and bounded at infinity. Sectors are nested, so bisection in T finds the largest.
    """

    r: RationalFunction
    margin: list[Polynomial]
    low: Fraction = field(default=Fraction(0), init=False)
    high: Fraction = field(default=Fraction(1), init=False)

    def __post_init__(self) -> None:
        """Enclose T between a sector that holds and one that does not. Raises ValueError if the axis itself fails."""
        if not self.holds(self.low):
            raise ValueError("|R| > 1 somewhere on the negative real axis: there is no sector")
        while self.holds(self.high):
            self.low, self.high = self.high, 4 * self.high
        while self.low == 0:
            middle = self.high / 4
            self.low, self.high = (middle, self.high) if self.holds(middle) else (self.low, middle)

    def ball(self) -> arb:
        """A ball around tan α, at Arb's current precision."""
        while (self.high - self.low) * 2**ctx.prec > self.low:
            middle = (self.low + self.high) / 2
            self.low, self.high = (middle, self.high) if self.holds(middle) else (self.low, middle)
        low, high = (arb(fmpq(x.numerator, x.denominator)).sqrt() for x in (self.low, self.high))
        return low.union(high)

    def holds(self, square: Fraction) -> bool:
        """|R| <= 1 in the closed sector with tan² = square."""
        ray = from_scalars([c(scalar(square)) for c in self.margin])
        return negative_point(ray) is None and not self._has_pole_inside(square)

    def _has_pole_inside(self, square: Fraction) -> bool:
        """Some pole has Re < 0 and Im² <= square Re²; no pole has equality, as the margin would be negative there."""
        bits = 64
        while True:
            with ctx.workprec(bits):
                verdicts = [_is_inside(z, square) for z in complex_roots(self.r.den, bits)]
            if None not in verdicts:
                return any(verdicts)
            bits *= 2


def _is_inside(z: acb, square: Fraction) -> bool | None:
    """The pole z lies in the sector; None where the ball does not tell."""
    reach = z.real**2 * arb(fmpq(square.numerator, square.denominator)) - z.imag**2
    if z.real > 0 or reach < 0:
        return False
    return True if z.real < 0 and reach > 0 else None
