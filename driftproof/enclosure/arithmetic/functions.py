"""Functions of balls, Taylor series and Taylor models, each with its derivative."""

from __future__ import annotations

from collections.abc import Callable

from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Refused, Value, analytic
from driftproof.enclosure.arithmetic.models import TaylorModel

# More terms than numbers up to 40 need; wider ranges come from steps that are too long.
_MOST_TERMS = 300


def quotient_of(x: Value, name: str, *, slope: bool = False) -> Value:
    """ "exprel", (exp x - 1)/x, or "sinc", sin(x)/x, or its derivative; near 0 by its Taylor series.

    Those of both are Σ cₖ xᵏ/(k + 1)! with |cₖ| <= 1; their rest is bounded in balls and models. Series need no bound:
    they make the polynomial of a step, whose defect is then bounded.
    """
    ball, model = isinstance(x, arb), isinstance(x, TaylorModel)
    centre = x if ball else x.coefficient(0) if model else x[0]
    signs = (1, 1, 1, 1) if name == "exprel" else (1, 0, -1, 0)
    if abs(centre) > 1:
        inverse, whole, rate = inverse_of(x), *((x.sin(), x.cos()) if name == "sinc" else (x.exp() - 1, x.exp()))
        first = whole * inverse
        return (rate - first) * inverse if slope else first
    reach = arb((x.norm if model else abs(centre)).abs_upper())
    terms, rest = 1, reach * reach.exp()
    while not rest < arb(2) ** -ctx.prec:
        terms += 1
        rest = rest * reach / terms
        if terms > _MOST_TERMS:
            raise Refused(f"f takes {name} of a number in a wide range")
    if not (ball or model):
        terms += ctx.cap
    factors = [signs[(k + slope) % 4] * arb(k + 1 if slope else 1) / arb(k + 1 + slope).fac() for k in range(terms)]
    total = x * 0
    for c in reversed(factors):
        total = total * x + c
    return total + arb(0, rest.upper()) if ball else total.within(rest) if model else total


def power_of(x: Value, n: int) -> Value:
    """x^n by squaring; python-flint takes the logarithm of a ball or series, which fails where x may be 0."""
    if n == 0:
        return arb(1)
    result = x
    for bit in f"{n:b}"[1:]:
        result = result * result * x if bit == "1" else result * result
    return result


def inverse_of(x: Value, does: str = "divides by a number that may be 0") -> Value:
    """1/x. Raises Refused, with what f does, where x may be 0."""
    try:
        return 1 / x
    except (ValueError, ZeroDivisionError):
        raise Refused(f"f {does}") from None


# NumPy's names of functions; FLINT's, and the derivative from the argument and the value.
ANALYTIC: dict[str, tuple[str, Callable[[Value, Value], Value]]] = {
    "sin": ("sin", lambda x, _: x.cos()),
    "cos": ("cos", lambda x, _: -x.sin()),
    "exp": ("exp", lambda _, y: y),
    "log": ("log", lambda x, _: inverse_of(x)),
    "erf": ("erf", lambda x, _: (-(x * x)).exp() * (2 / arb.pi().sqrt())),
    "sqrt": ("sqrt", lambda _, y: inverse_of(2 * y, "takes the root of a number that may be 0")),
    "arctan": ("atan", lambda x, _: inverse_of(1 + x * x)),
    "arcsin": ("asin", lambda x, _: inverse_of(analytic("sqrt", 1 - x * x))),
    "arccos": ("acos", lambda x, _: -inverse_of(analytic("sqrt", 1 - x * x))),
}
