"""Small methods of every family, over Q and over number fields, and helpers: for the tests of symbolic.linear."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction as Q
from functools import cache
from math import comb, factorial
from typing import Any

from flint import acb, acb_poly, arb, fmpq_poly

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.expressions import parse_system
from driftproof.methods.numbers.number_field import cube_root, square_root
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.matrices import faddeev_leverrier
from driftproof.symbolic.algebra.polynomials import at_ball, from_scalars, polynomial
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.linear.stability_function import ScalarTableau
from driftproof.symbolic.linear.stability_limits import Limit
from driftproof.symbolic.linear.systems import SystemFacts
from driftproof.texts.writing.records import record
from tests.nine import NINE

Z = fmpq_poly([0, 1])
ONE, NIL = fraction(fmpq_poly([1])), fraction(fmpq_poly())
ROOT_2, ROOT_3 = square_root(2), square_root(3)


def runge_kutta(a: Any, b: Any) -> RungeKutta:
    """The method with these rows and weights, c the sums of the rows."""
    rows = tuple(tuple(x + Q(0) for x in row) for row in a)
    return RungeKutta("given", "Given", 0, "x", rows, tuple(b), tuple(sum(row, Q(0)) for row in rows))


def sdirk(gamma: Any) -> RungeKutta:
    """Two stages with equal diagonal entries, order 2."""
    return runge_kutta(((gamma, 0), (1 - 2 * gamma, gamma)), (Q(1, 2), Q(1, 2)))


def pade(num: int, den: int) -> RationalFunction:
    """The approximant of exp with these degrees, from its closed form (hairer-wanner-1996, IV.3)."""
    total = num + den
    p = [Q(factorial(total - k) * comb(num, k), factorial(total)) for k in range(num + 1)]
    q = [Q((-1) ** k * factorial(total - k) * comb(den, k), factorial(total)) for k in range(den + 1)]
    return fraction(polynomial(p), polynomial(q))


def by_determinants(data: ScalarTableau) -> RationalFunction:
    """R(z) = det(I - zA + z1bᵀ) / det(I - zA) (hairer-wanner-1996, IV.3), by characteristic polynomials."""
    shifted = [
        [x - e * y for x, y in zip(row, data.b, strict=True)] for row, e in zip(data.a, data.power(0), strict=True)
    ]
    return fraction(*(from_scalars(faddeev_leverrier(matrix)[0]) for matrix in (shifted, data.a)))


def chebyshev(degree: int, argument: Any) -> Any:
    """T of that degree at a polynomial, by its recurrence."""
    before, now = argument * 0 + 1, argument
    for _ in range(degree - 1):
        before, now = now, 2 * argument * now - before
    return now


def limit_text(limit: Limit) -> str:
    """The limit in radicals, or its polynomial; "0" and "oo"."""
    return record_text(record(limit))


def record_text(record: Any) -> str:
    """The same, of a limit as JSON has it."""
    return str(record if isinstance(record, str) else record["exact"] or record["minpoly"])


def modulus(r: RationalFunction, z: acb) -> arb:
    """|R(z)| as a ball, at Arb's current precision."""
    return abs(value(r, z))


def value(r: RationalFunction, z: acb) -> acb:
    """R(z) as a ball, at Arb's current precision."""
    num, den = (acb_poly([ball(c) for c in p.coeffs()]) for p in (r.num, r.den))
    return num(z) / den(z)


def at(f: RationalFunction, x: arb) -> arb:
    """f(x) for a real ball x, at Arb's current precision."""
    return at_ball(f.num, x) / at_ball(f.den, x)


def ball(c: Any) -> arb:
    """A ball around a scalar, at Arb's current precision."""
    return at_ball(fmpq_poly([1]) * c, arb(0))


def nodes_method(nodes: Iterable[Q]) -> Collocation:
    return Collocation("x", "X", 0, "test", tuple(nodes))


def legendre(s: int) -> list[Q]:
    """The Legendre polynomial on [0, 1], constant term first, by its closed formula."""
    return [Q((-1) ** (s - k) * comb(s, k) * comb(s + k, k)) for k in range(s + 1)]


def combined(s: int, lower: int, factor: int) -> Collocation:
    padded = legendre(lower) + [Q(0)] * (s - lower)
    return nodes_method((x + factor * y for x, y in zip(legendre(s), padded, strict=True)))


def gauss(s: int) -> Collocation:
    return nodes_method(legendre(s))


def radau_iia(s: int) -> Collocation:
    return combined(s, s - 1, -1)


def lobatto_iiia(s: int) -> Collocation:
    return combined(s, s - 2, -1)


BACKWARD = runge_kutta(((1,),), (1,))
MIDPOINT = runge_kutta(((Q(1, 2),),), (1,))
TRAPEZOID = runge_kutta(((0, 0), (Q(1, 2), Q(1, 2))), (Q(1, 2), Q(1, 2)))
# One point three times over: the last stage counts for nothing, the first two are the midpoint rule's.
MIDPOINT_THRICE = runge_kutta(((Q(1, 2), 0, 0), (Q(1, 3), Q(1, 6), 0), (0, 7, 7)), (Q(1, 4), Q(3, 4), 0))
LOBATTO_IIIB_2 = runge_kutta(((Q(1, 2), 0), (Q(1, 2), 0)), (Q(1, 2), Q(1, 2)))
RADAU_IIA_2 = runge_kutta(((Q(5, 12), Q(-1, 12)), (Q(3, 4), Q(1, 4))), (Q(3, 4), Q(1, 4)))
QIN_ZHANG = runge_kutta(((Q(1, 4), 0), (Q(1, 2), Q(1, 4))), (Q(1, 2), Q(1, 2)))
SDIRK = runge_kutta(((1 - ROOT_2 / 2, 0), (ROOT_2 / 2, 1 - ROOT_2 / 2)), (ROOT_2 / 2, 1 - ROOT_2 / 2))
GAUSS_2 = runge_kutta(((Q(1, 4), Q(1, 4) - ROOT_3 / 6), (Q(1, 4) + ROOT_3 / 6, Q(1, 4))), (Q(1, 2), Q(1, 2)))
GAUSS_3 = Collocation("gauss3", "Gauss", 6, "x", (Q(-1, 20), Q(3, 5), Q(-3, 2), Q(1)))
RADAU_3 = Collocation("radau3", "Radau", 5, "x", (Q(-1, 10), Q(9, 10), Q(-9, 5), Q(1)))
LOBATTO_3 = Collocation("lobatto3", "Lobatto", 4, "x", (Q(0), Q(1, 2), Q(-3, 2), Q(1)))
STORMER = Nystrom("stormer", "Störmer", 2, "x", (Q(0), Q(1)), ((0, 0), (Q(1, 2), 0)), (Q(1, 2), 0), (Q(1, 2), Q(1, 2)))
NYSTROM_4 = Nystrom(
    "nystrom4", "Nyström", 4, "x", (Q(0), Q(1, 2), Q(1)), ((0, 0, 0), (Q(1, 8), 0, 0), (0, Q(1, 2), 0)),
    (Q(1, 6), Q(1, 3), Q(0)), (Q(1, 6), Q(4, 6), Q(1, 6)),
)  # fmt: skip
# The implicit midpoint rule for q'' = F(q): Ā = A², b̄ = bA.
MIDPOINT_NYSTROM = Nystrom("nystrom", "Nyström", 2, "x", (Q(1, 2),), ((Q(1, 4),),), (Q(1, 2),), (Q(1),))


def triple_jump() -> Splitting:
    """Three Verlet steps with the weights w, 1 - 2w, w over Q(2**(1/3))."""
    w = 1 / (2 - cube_root(2))
    lengths = (w / 2, w, (1 - w) / 2, 1 - 2 * w, (1 - w) / 2, w, w / 2)
    kinds = ("drift", "kick", "drift", "kick", "drift", "kick", "drift")
    return Splitting("triple_jump", "Triple jump", 4, "x", tuple(zip(kinds, lengths, strict=True)))


EVERY: dict[str, Method] = {
    **NINE, "gauss2": GAUSS_2, "midpoint": MIDPOINT, "backward": BACKWARD, "gauss3": GAUSS_3,
    "triple_jump": triple_jump(), "nystrom_implicit": MIDPOINT_NYSTROM, "nystrom_explicit": NYSTROM_4,
}  # fmt: skip

# Systems z' = Az, by their rows.
SPRINGS = "0 0 1 0; 0 0 0 1; -2 1 0 0; 1 -2 0 0"
CHAIN = "0 0 1 0; 0 0 0 1; -3 1 0 0; 2 -5/2 0 0"
STUCK = "0 0 1 0; 0 0 0 1; -1 1 0 0; 0 -1 0 0"  # a Jordan block for i
TWISTED = "0 0 1 0; 0 0 0 1; -1 1 0 0; -1 -1 0 0"  # K has complex eigenvalues
DAMPED = "0 1; -1 -1/10"
COUPLED = "0 0 1 0; 0 0 0 1; -2 1 -1/10 0; 1 -3 0 -1/5"


@cache
def facts(key: str, text: str) -> SystemFacts:
    """The facts of a method of the catalogue on a system."""
    return SystemFacts(METHODS[key], parse_system(text))
