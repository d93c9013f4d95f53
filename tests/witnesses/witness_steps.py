"""The one-step matrix without a step and without R(z): stage equations solved in any field, and shears multiplied."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction as Q
from typing import Any, TypeAlias

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import Force, Lift, Number, Step, oscillator
from driftproof.methods.schemes import Collocation, Method, Nystrom, Splitting
from driftproof.symbolic.algebra.polynomials import X, polynomial
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction

Row: TypeAlias = Sequence[Number]
Pair: TypeAlias = tuple[Number, Number]


def tableau(method: Any) -> tuple[Sequence[Row], Row, Row]:
    """A, b and 1. Of collocation without its nodes: stages are polynomials modulo M, by their coefficients; A
    integrates from 0, b from 0 to 1, and 1 is the polynomial 1.
    """
    s = range(method.stages)
    if not isinstance(method, Collocation):
        return method.a, method.b, [Q(1) for _ in s]
    images = [(X ** (j + 1) / (j + 1)) % polynomial(method.node_polynomial) for j in s]
    rows = [[Q(int(image[i].p), int(image[i].q)) for image in images] for i in s]
    return rows, [Q(1, j + 1) for j in s], [Q(k == 0) for k in s]


def as_second_order(method: Any) -> tuple[Sequence[Row], Row, Row, Number, Row, Row]:
    """(Ā, 1, c, w, b̄, b): k = F(q 1 + h c v + h² Ā k), q₁ = q + h w v + h² b̄·k, v₁ = v + h b·k, for a linear F.

    Of a Runge-Kutta method these are (A², 1, A1, b·1, bA, b).
    """
    if isinstance(method, Nystrom):
        return method.a, [Q(1)] * method.stages, method.c, Q(1), method.b_position, method.b_velocity
    a, b, ones = tableau(method)
    columns = list(zip(*a, strict=True))
    squared = [[_dot(row, column) for column in columns] for row in a]
    return squared, ones, [_dot(row, ones) for row in a], _dot(b, ones), [_dot(b, column) for column in columns], b


def stage_equations(method: Any, lift: Lift) -> Step:
    """The step on the oscillator by solving (I + h²Ā) k = -(q 1 + h c v), whose pivots are 1 + O(h²)."""
    a, *vectors = as_second_order(method)
    rows = [[lift(x) for x in row] for row in a]
    ones, c, (w,), in_q, in_v = ([lift(x) for x in row] for row in (*vectors[:2], [vectors[2]], *vectors[3:]))

    def step(_: Force, q: Number, v: Number, h: Number) -> Pair:
        system = [
            [h * h * x for x in row] + [-(one * q + h * x * v)] for row, one, x in zip(rows, ones, c, strict=True)
        ]
        for i, row in enumerate(system):
            row[i] = row[i] + lift(Q(1))
        k = _solved(system)
        return q + h * w * v + h * h * _dot(in_q, k), v + h * _dot(in_v, k)

    return step


def _solved(rows: list[list[Number]]) -> list[Number]:
    """The solution of a system in any field, its right-hand side the last column."""
    for i in range(len(rows)):
        inverse = _inverse(rows[i][i])
        rows[i] = [x * inverse for x in rows[i]]
        for j, other in enumerate(rows):
            if j != i and not _is_zero(other[i]):
                rows[j] = [x - other[i] * y for x, y in zip(other, rows[i], strict=True)]
    return [row[-1] for row in rows]


def _inverse(x: Number) -> Number:
    return fraction(x.den, x.num) if isinstance(x, RationalFunction) else 1 / x


def _is_zero(x: Number) -> bool:
    return bool(x.num == 0 if isinstance(x, RationalFunction) else x == 0)


def _dot(a: Row, b: Row) -> Number:
    total, *rest = [x * y for x, y in zip(a, b, strict=True) if not _is_zero(x)] or [a[0] * b[0]]
    for x in rest:
        total = total + x
    return total


def shears(method: Splitting, lift: Lift) -> Step:
    """The step by the product of [[1, 0], [-ch, 1]] for a kick and [[1, ch], [0, 1]] for a drift, the last leftmost."""

    def step(_: Force, q: Number, v: Number, h: Number) -> Pair:
        (a, b), (c, d) = (lift(Q(1)), lift(Q(0))), (lift(Q(0)), lift(Q(1)))
        for kind, x in method.parts:
            s = lift(x) * h
            (a, b), (c, d) = ((a, b), (c - s * a, d - s * b)) if kind == "kick" else ((a + s * c, b + s * d), (c, d))
        return a * q + b * v, c * q + d * v

    return step


def as_function(x: Exact) -> RationalFunction:
    """A number as a function of h."""
    return fraction(polynomial([x]))


def witness_matrix(method: Method) -> tuple[Pair, Pair]:
    """M(h) on the oscillator, over Q(h) or K(h)."""
    step = (shears if isinstance(method, Splitting) else stage_equations)(method, as_function)
    one, nil = as_function(Q(1)), as_function(Q(0))
    (qq, vq), (qv, vv) = (step(oscillator, *column, fraction(X)) for column in ((one, nil), (nil, one)))
    return (qq, qv), (vq, vv)
