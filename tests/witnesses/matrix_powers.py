"""Endpoints of collocation methods on q' = v, v' = -q by powers: M in whole numbers, rounded once, and squared."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import lcm
from operator import mul
from typing import NamedTuple

from driftproof.methods.schemes import Collocation


class Endpoint(NamedTuple):
    """A final state, and in `how` the way in which it was found, which is not by stepping."""

    q: float
    v: float
    how: str


def endpoint(method: Collocation, start: tuple[float, float], h: float, steps: int) -> Endpoint:
    """The state after so many steps, by squaring M: about 2 log₂ N products in place of N steps.

    M = ((ρ, σ), (-σ, ρ)), because (q - iv)' = i (q - iv), and Python multiplies the numbers ρ + iσ in the operations of
    such matrices. The rounding is another than that of a run; to look at the rounding of runs, run.
    """
    turn = float_turn(method, h)
    power = turn if steps else complex(1)
    for bit in bin(steps)[3:]:
        power = power * power
        if bit == "1":
            power = power * turn
    products = max(0, steps.bit_length() - 1 + steps.bit_count() - 1)
    how = f"power {steps} of the one-step matrix, in {products} products of floats; no step was taken"
    (q, v), rho, sigma = start, power.real, power.imag
    return Endpoint(rho * q + sigma * v, -sigma * q + rho * v, how)


def float_turn(method: Collocation, h: float) -> complex:
    """R(ih) = ρ + iσ at the exact value of the float h, each part rounded once: whole numbers divide so."""
    above, below = _stability_function(method)
    (p, w), last = h.as_integer_ratio(), len(below) - 1
    terms = [p**j * w ** (last - j) for j in range(last + 1)]
    (a, b), (c, d) = ([sum(map(mul, x[i::2], terms[i::2])) for i in (0, 1)] for x in (above, below))
    size = c * c + d * d
    return complex((a * c + b * d) / size, (b * c - a * d) / size)


@cache
def _stability_function(method: Collocation) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Numerator and denominator of R(iy) without their powers of i, constant term first, times one whole number.

    R(z) = Σ M⁽ˢ⁻ʲ⁾(1) zʲ / Σ M⁽ˢ⁻ʲ⁾(0) zʲ for the node polynomial M (hairer-wanner-1996, IV.3). Of iʲ the sign is kept,
    and that odd powers are imaginary.
    """
    derivatives = [[Fraction(c) for c in method.node_polynomial]]
    for _ in range(method.stages):
        derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    above = [(-1) ** (j // 2) * sum(p) for j, p in enumerate(reversed(derivatives))]
    below = [(-1) ** (j // 2) * p[0] for j, p in enumerate(reversed(derivatives))]
    common = lcm(*(c.denominator for c in (*above, *below)))
    return tuple(int(c * common) for c in above), tuple(int(c * common) for c in below)
