"""Orders by trees against orders measured: on power series exactly, and in ball arithmetic at two small steps."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q

import pytest
from flint import arb, ctx, fmpq, fmpq_poly

from methods.number_field import Algebraic, Exact
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from symbolic.trees.alternating import nystrom_order, separable_order
from symbolic.trees.order import order
from tests.test_trees_catalogue import DECIMAL, EVERY, EXACT, runge_kutta, splitting

# --- power series in h: what a step and the solution agree in is counted, not measured --------------------------------

LENGTH = 9  # one more than the highest power compared: enough for order 7
Vector = tuple[fmpq_poly, fmpq_poly]


def cut(p: fmpq_poly) -> fmpq_poly:
    return p.truncate(LENGTH)


def reciprocal(p: fmpq_poly) -> fmpq_poly:
    """1/p, by Newton's iteration, each pass right to twice as many terms."""
    q = fmpq_poly([1 / p(0)])
    for _ in range(4):
        q = cut(q * (2 - cut(p * q)))
    return q


def field(y: Vector) -> Vector:
    """A vector field all of whose derivatives are there, and no two alike."""
    u, v = y
    return cut(reciprocal(cut(2 - u + cut(u * v))) + v), cut(u * u) - 2 * cut(v * cut(u * v)) + reciprocal(1 + u + v)


def number(x: Exact) -> fmpq:
    assert isinstance(x, Q)
    return fmpq(x.numerator, x.denominator)


START: Vector = (fmpq_poly([fmpq(1, 3)]), fmpq_poly([fmpq(-1, 2)]))


def solution(field: Callable[[Vector], Vector]) -> Vector:
    """Picard's iteration, each pass right to one term more."""
    y = START
    for _ in range(LENGTH):
        y = tuple(cut(a + f.integral()) for a, f in zip(START, field(y), strict=True))  # type: ignore[assignment]
    return y


def runge_kutta_step(method: RungeKutta) -> Vector:
    """One step with h the variable of the series; implicit stages by iteration, which gains a term a pass."""

    def advanced(row: tuple[Exact, ...], slopes: list[Vector]) -> Vector:
        weights = list(map(number, row))
        u, v = (sum((w * k[i] for w, k in zip(weights, slopes, strict=True)), fmpq_poly()) for i in (0, 1))
        return cut(START[0] + u.left_shift(1)), cut(START[1] + v.left_shift(1))

    slopes = [field(START)] * method.stages
    for _ in range(LENGTH):
        slopes = [field(advanced(row, slopes)) for row in method.a]
    return advanced(method.b, slopes)


def agreement(one: Vector, other: Vector) -> int:
    """The power of h up to which both components agree."""
    return next(k - 1 for k in range(LENGTH) if any(a[k] != b[k] for a, b in zip(one, other, strict=True)))


RATIONAL = [
    key
    for key, method in EXACT.items()
    if isinstance(method, RungeKutta) and method.field is None and method.claimed_order < 8 and method.stages < 14
]


@pytest.mark.parametrize("key", RATIONAL)
def test_order_by_trees_is_where_the_series_of_step_and_solution_part(key: str) -> None:
    method = runge_kutta(key)
    assert agreement(runge_kutta_step(method), solution(field)) == order(method).order


def separable(y: Vector) -> Vector:
    """q' = f(v), v' = g(q)."""
    q, v = y
    return reciprocal(1 - v + cut(v * v)), reciprocal(2 + q) - cut(q * cut(q * q))


def second_order(y: Vector) -> Vector:
    """q' = v, v' = F(q)."""
    return y[1], separable(y)[1]


def splitting_step(method: Splitting, field: Callable[[Vector], Vector]) -> Vector:
    q, v = START
    for kind, c in method.parts:
        step = fmpq_poly([0, number(c)])
        if kind == "kick":
            v = cut(v + step * field((q, v))[1])
        else:
            q = cut(q + step * field((q, v))[0])
    return q, v


SPLITTINGS = [key for key, m in EVERY.items() if isinstance(m, Splitting) and m.field is None]


@pytest.mark.parametrize("key", SPLITTINGS)
def test_orders_of_a_splitting_are_where_its_series_part_on_either_class_of_problems(key: str) -> None:
    """Rounded tables included: their exact order is that of the rounded numbers."""
    method = splitting(key)
    assert agreement(splitting_step(method, separable), solution(separable)) == separable_order(method).order
    assert agreement(splitting_step(method, second_order), solution(second_order)) == nystrom_order(method).order


@pytest.mark.parametrize("key", [key for key, method in EVERY.items() if isinstance(method, Nystrom)])
def test_order_of_a_nystrom_method_is_where_its_series_parts(key: str) -> None:
    method = EVERY[key]
    assert isinstance(method, Nystrom)
    (q, v), h = START, fmpq_poly([0, 1])
    forces: list[fmpq_poly] = []
    for c, row in zip(method.c, method.a, strict=True):
        inner = sum((number(a) * k for a, k in zip(row, forces, strict=False)), fmpq_poly())
        forces.append(second_order((cut(q + number(c) * h * v + h * h * inner), v))[1])
    weighted = [
        sum((number(b) * k for b, k in zip(row, forces, strict=True)), fmpq_poly())
        for row in (method.b_position, method.b_velocity)
    ]
    step = cut(q + h * v + h * h * weighted[0]), cut(v + h * weighted[1])
    assert agreement(step, solution(second_order)) == nystrom_order(method).order


def test_series_tell_a_method_from_its_neighbour() -> None:
    """The comparison can fail: Kutta's third-order method is not mistaken for one of order 2 or 4."""
    assert agreement(runge_kutta_step(runge_kutta("kutta3")), solution(field)) == 3
    assert agreement(runge_kutta_step(runge_kutta("heun2")), runge_kutta_step(runge_kutta("kutta3"))) == 2


# --- balls: the errors of one step at h and h/2, on problems with a solution in closed form ---------------------------

BITS, SMALL = 2000, 2**-40


def ball(x: Exact) -> arb:
    """An enclosure at the current precision."""
    if isinstance(x, Algebraic):
        low, high = x.enclosure(BITS)
        return arb(fmpq(low.numerator, low.denominator)).union(arb(fmpq(high.numerator, high.denominator)))
    return arb(fmpq(x.numerator, x.denominator))


def cubic(y: tuple[arb, arb]) -> tuple[arb, arb]:
    """q'' = 2q³, solved by q = 1/(1 - t)."""
    return y[1], 2 * y[0] ** 3


def step_on_balls(method: RungeKutta | Splitting, h: arb) -> tuple[arb, arb]:
    q, v = arb(1), arb(1)
    if isinstance(method, Splitting):
        for kind, c in method.parts:
            q, v = (q, v + h * ball(c) * cubic((q, v))[1]) if kind == "kick" else (q + h * ball(c) * v, v)
        return q, v
    slopes: list[tuple[arb, arb]] = []
    for row in method.a:
        slopes.append(cubic(tuple(y + h * _dot(row, slopes, i) for i, y in enumerate((q, v)))))  # type: ignore[arg-type]
    return q + h * _dot(method.b, slopes, 0), v + h * _dot(method.b, slopes, 1)


def _dot(row: tuple[Exact, ...], slopes: list[tuple[arb, arb]], i: int) -> arb:
    return sum((ball(w) * k[i] for w, k in zip(row, slopes, strict=False)), arb(0))


def local_error(method: RungeKutta | Splitting, h: arb) -> arb:
    """The larger of the errors of q and v after one step from (1, 1)."""
    q, v = step_on_balls(method, h)
    return abs(q - 1 / (1 - h)).max(abs(v - 1 / (1 - h) ** 2))


MEASURED = ["forward_euler", "heun3", "rk4", "gill4", "ralston4", "cash_karp54", "butcher6", "butcher7", "fehlberg78"]
MEASURED += ["cooper_verner8", "velocity_verlet", "ruth3", "forest_ruth", "yoshida4", "suzuki4", "mclachlan4"]


@pytest.mark.parametrize("key", MEASURED)
def test_measured_order_in_balls_is_the_order_by_trees(key: str) -> None:
    """error(h)/error(h/2) = 2ᵖ⁺¹ (1 + O(h)): with h = 2⁻⁴⁰ its logarithm is an integer to nine digits, and certain."""
    method = EVERY[key]
    assert isinstance(method, RungeKutta | Splitting)
    with ctx.workprec(BITS):
        h = arb(SMALL)
        measured = (local_error(method, h) / local_error(method, h / 2)).log() / arb.const_log2()
        fact = nystrom_order(method).order if isinstance(method, Splitting) else order(method).order
        assert measured.rad() < arb(2) ** -100
        assert abs(measured - (fact + 1)) < arb(2) ** -30
        assert not abs(measured - fact) < arb(2) ** -30


@pytest.mark.parametrize("key", ["rk4", "fehlberg78", "forest_ruth"])
def test_measured_order_in_balls_notices_a_coefficient_off_by_little(key: str) -> None:
    """At h = 2⁻⁴⁰ an error of 10⁻³⁰ h outweighs one of h⁵: the measured order drops to 0, as the exact one does."""
    method = EVERY[key]
    if isinstance(method, Splitting):
        (kind, c), *rest = method.parts
        broken: RungeKutta | Splitting = Splitting("x", "X", 0, "test", ((kind, c + Q(1, 10**30)), *rest))
    else:
        assert isinstance(method, RungeKutta)
        weights = (method.b[0] + Q(1, 10**30), *method.b[1:])
        broken = RungeKutta("x", "X", 0, "test", method.a, weights, method.c)
    with ctx.workprec(BITS):
        ratio = local_error(broken, arb(SMALL)) / local_error(broken, arb(SMALL) / 2)
        assert abs(ratio.log() / arb.const_log2() - 1) < arb(2) ** -20
    assert (nystrom_order(broken) if isinstance(broken, Splitting) else order(broken)).order == 0


def test_every_kind_of_method_is_measured_somewhere() -> None:
    assert len(RATIONAL) > 20
    assert set(SPLITTINGS) & set(DECIMAL)
    assert not any(isinstance(EVERY[key], Collocation) for key in MEASURED)
