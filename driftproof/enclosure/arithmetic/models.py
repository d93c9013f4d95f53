"""Taylor models on a disc: the first coefficients of an analytic function in balls, and a bound on all others.

Functions Σ c_k σ^k with a finite norm ‖c‖ = Σ |c_k| are analytic where |σ| < 1, and ‖ab‖ <= ‖a‖ ‖b‖. So norms bound
what a product has beyond its first coefficients. A function of a model starts from the coefficients that Arb's series
give. Substituted into an equation that the function solves, they leave an error ε of high order; ‖ε‖ < 1 proves that
the disc contains no pole and no branch point, and bounds the rest by a geometric series. Since the disc is no larger
than the step, norms are close to the sizes of the functions, and the bounds of tails are nearly sharp.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_poly, arb_series, ctx

from driftproof.enclosure.arithmetic.evaluations import Refused

Constant: TypeAlias = int | arb
# The real σ of a step that begins at the centre of the disc, and of one that has the centre in its middle.
STEP, BOTH_WAYS = arb(0.5, 0.5), arb(0, 1)
_NOTHING = arb(0)


class TaylorModel:
    """A function Σ c_k σ^k, real for real σ: its polynomial of k < length, and `tail`, a bound of Σ |c_k| beyond."""

    __slots__ = ("_norm", "length", "polynomial", "tail")

    def __init__(self, polynomial: arb_poly | Sequence[arb], length: int, tail: arb | int = 0) -> None:
        """Take polynomial and tail as they are; coefficients beyond the length go into the tail."""
        whole = polynomial if isinstance(polynomial, arb_poly) else arb_poly(list(polynomial))
        if whole.length() > length:
            tail = tail + beyond(whole, length)
            whole = whole.truncate(length)
        self.polynomial, self.length = whole, length
        self.tail = _upper(arb(tail)) if tail else _NOTHING
        self._norm: arb | None = None

    @property
    def norm(self) -> arb:
        """An upper bound of Σ |c_k|."""
        if self._norm is None:
            self._norm = _upper(beyond(self.polynomial, 0) + self.tail)
        return self._norm

    def range(self, sigma: arb = STEP) -> arb:
        """A ball that contains the values for all σ in the ball `sigma`, by default 0 <= σ <= 1."""
        return self.polynomial(sigma) + arb(0, self.tail)

    def ends(self) -> tuple[arb, arb]:
        """c_0 and a ball such that for each 0 <= σ <= 1 the value lies between c_0 and a number of the ball.

        That is c_0 + (x(σ) - c_0)/σ: what increases from a small positive value is thus seen to be positive.
        """
        first = self.coefficient(0)
        return first, first + arb_poly(self.polynomial.coeffs()[1:])(STEP) + arb(0, self.tail)

    def union(self, other: TaylorModel) -> TaylorModel:
        """A model that has, at each σ, all that is between the two: their coefficients are in its own."""
        pairs = ((self.coefficient(k), other.coefficient(k)) for k in range(self.length))
        return TaylorModel([x.union(y) for x, y in pairs], self.length, self.tail.max(other.tail))

    def mean(self) -> arb:
        """A ball of the mean over 0 <= σ <= 1, also of a function that the model contains at each σ only."""
        parts = (self.coefficient(k) / (k + 1) for k in range(self.length))
        return sum(parts, arb(0)) + arb(0, self.tail)

    def within(self, rest: arb) -> TaylorModel:
        """The model plus any function whose norm is at most `rest`."""
        around = arb(0, rest.upper())
        return TaylorModel(self.polynomial + arb_poly([around] * self.length), self.length, self.tail + rest)

    def coefficient(self, k: int) -> arb:
        """The coefficient c_k, k < length."""
        return arb(self.polynomial[k])

    def is_finite(self) -> bool:
        """True if the norm is finite."""
        return bool(self.norm.is_finite())

    def __add__(self, other: TaylorModel | Constant) -> TaylorModel:
        if isinstance(other, TaylorModel):
            return TaylorModel(self.polynomial + other.polynomial, self.length, self.tail + other.tail)
        return TaylorModel(self.polynomial + other, self.length, self.tail)

    __radd__ = __add__

    def __neg__(self) -> TaylorModel:
        return TaylorModel(-self.polynomial, self.length, self.tail)

    def __sub__(self, other: TaylorModel | Constant) -> TaylorModel:
        return self + -other

    def __rsub__(self, other: Constant) -> TaylorModel:
        return -self + other

    def __mul__(self, other: TaylorModel | Constant) -> TaylorModel:
        """The product, by (p + ρ)(q + τ) = pq + p τ + ρ (q + τ)."""
        if not isinstance(other, TaylorModel):
            return TaylorModel(self.polynomial * other, self.length, self.tail * abs(other))
        rest = self.norm * other.tail + self.tail * other.norm if self.tail or other.tail else 0
        return TaylorModel(self.polynomial * other.polynomial, self.length, rest)

    __rmul__ = __mul__

    def __rtruediv__(self, other: Constant) -> TaylorModel:
        """other/x; with a the series of 1/x, 1/x = a/(1 + ε), ε = x a - 1."""
        a = self._series("inv")
        tail = a.norm * _geometric((self * a).tail, "divides by a number that may be 0")
        return TaylorModel(a.polynomial, self.length, tail) * other

    def __gt__(self, other: Constant) -> bool:
        """True if the model is greater for all real σ of the disc."""
        return bool(self.range(BOTH_WAYS) > other)

    def __lt__(self, other: Constant) -> bool:
        """True if the model is less for all real σ of the disc."""
        return bool(self.range(BOTH_WAYS) < other)

    def _series(self, function: str) -> TaylorModel:
        """The first coefficients of a function of the polynomial, without a tail."""
        return TaylorModel(_along(self, function).coeffs(), self.length)

    def _variation(self) -> tuple[arb, arb]:
        """‖x - x_0‖, and the polynomial's part of it."""
        polynomial = _upper(beyond(self.polynomial, 1))
        return _upper(polynomial + self.tail), polynomial

    def sqrt(self) -> TaylorModel:
        """The square root; with a the series, sqrt x = a sqrt(1 + ε), ε = (x - a²)/a²."""
        a = self._series("sqrt")
        error = self.tail + beyond(a.polynomial * a.polynomial, self.length)
        inverse = 1 / a
        tail = a.norm * _geometric(error * inverse.norm * inverse.norm, "takes the root of a number that may be 0")
        return TaylorModel(a.polynomial, self.length, tail)

    def exp(self) -> TaylorModel:
        """exp x; p the polynomial, a the series, η = a' - p'a of order length - 1: exp p - a = -exp(p) ∫ exp(-p) η."""
        a = self._series("exp")
        error = beyond(self.polynomial.derivative() * a.polynomial, self.length - 1)
        whole, w = self._variation()
        first = self.coefficient(0).exp()
        tail = (2 * w).exp() * error / self.length + first * whole.exp() * self.tail
        return TaylorModel(a.polynomial, self.length, tail)

    def _sin_cos(self) -> tuple[TaylorModel, TaylorModel]:
        """Sine and cosine, as exp with exp(ip) for exp p: the errors of both equations add up to one of exp(ip)."""
        s, c = self._series("sin"), self._series("cos")
        slope = self.polynomial.derivative()
        error = beyond(slope * c.polynomial, self.length - 1) + beyond(slope * s.polynomial, self.length - 1)
        whole, w = self._variation()
        tail = (2 * w).exp() * error / self.length + whole.exp() * self.tail
        return TaylorModel(s.polynomial, self.length, tail), TaylorModel(c.polynomial, self.length, tail)

    def sin(self) -> TaylorModel:
        """The sine."""
        return self._sin_cos()[0]

    def cos(self) -> TaylorModel:
        """The cosine."""
        return self._sin_cos()[1]

    def erf(self) -> TaylorModel:
        """The error function; for the polynomial p, erf(p)' = p'g with g = 2 exp(-p²)/sqrt(π)."""
        a, p, two = self._series("erf"), TaylorModel(self.polynomial, self.length), 2 / arb.pi().sqrt()
        slope, g = self.polynomial.derivative(), two * (-p * p).exp()
        error = beyond(slope * g.polynomial, self.length - 1) + beyond(slope, 0) * g.tail
        (whole, _), first = self._variation(), self.coefficient(0)
        steepest = two * (whole * (2 * abs(first) + whole) - first * first).exp()
        return TaylorModel(a.polynomial, self.length, error / self.length + steepest * self.tail)

    def log(self) -> TaylorModel:
        """The logarithm; with a the series, log x = a + log(1 + ε), ε = x exp(-a) - 1."""
        a = self._series("log")
        tail = _geometric((self * (-a).exp()).tail, "takes the logarithm of a number that may be 0")
        return TaylorModel(a.polynomial, self.length, tail)

    def atan(self) -> TaylorModel:
        """The inverse tangent; with a the series, atan x = a + atan ε, ε = (x cos a - sin a)/(cos a + x sin a)."""
        a = self._series("atan")
        s, c = a._sin_cos()
        error = (self * c - s).tail * (1 / (c + self * s)).norm
        return TaylorModel(a.polynomial, self.length, _geometric(error, "takes an uncertain inverse tangent"))

    def asin(self) -> TaylorModel:
        """The inverse sine atan(x/sqrt(1 - x²)), for |x| < 1."""
        inverse: TaylorModel = 1 / (1 - self * self).sqrt()
        return (self * inverse).atan()

    def acos(self) -> TaylorModel:
        """The inverse cosine π/2 - asin x."""
        quarter: TaylorModel = arb.pi() / 2 - self.asin()
        return quarter


def beyond(polynomial: arb_poly, first: int) -> arb:
    """Σ |c_k| over k >= first."""
    return sum(map(abs, polynomial.coeffs()[first:]), _NOTHING)


def _along(x: TaylorModel, function: str) -> Any:
    cap, ctx.cap = ctx.cap, x.length
    try:
        series = arb_series(x.polynomial, x.length)
        return 1 / series if function == "inv" else getattr(series, function)()
    finally:
        ctx.cap = cap


def _upper(x: arb) -> arb:
    return arb(x.abs_upper())


def _geometric(error: arb, does: str) -> arb:
    """‖ε‖/(1 - ‖ε‖), a bound of 1/(1 + ε) - 1, sqrt(1 + ε) - 1, log(1 + ε) and atan ε. Refused unless ‖ε‖ < 1."""
    if not error < 1:
        raise Refused(f"f {does} within the step")
    return error / (1 - error)


def coefficients_of(models: Sequence[Sequence[TaylorModel | arb]]) -> tuple[list[arb_mat], arb_mat]:
    """The coefficients of a matrix of models and constants, one matrix for each power of σ, and that of the tails."""
    n, m = len(models), len(models[0])
    length = max((x.polynomial.length() for row in models for x in row if isinstance(x, TaylorModel)), default=1)
    found, tails = [arb_mat(n, m) for _ in range(max(length, 1))], arb_mat(n, m)
    for i, row in enumerate(models):
        for j, x in enumerate(row):
            if isinstance(x, TaylorModel):
                tails[i, j] = x.tail
                for k, c in enumerate(x.polynomial.coeffs()):
                    found[k][i, j] = c
            else:
                found[0][i, j] = x
    return found, tails


def value_at(coefficients: Sequence[arb_mat], sigma: arb) -> arb_mat:
    """The matrix Σ C_k σ^k."""
    value = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        value = value * sigma + c
    return value
