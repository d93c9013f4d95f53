"""The exact step of an implicit method in balls: stages by Newton's method, and Krawczyk's proof that they exist.

The slopes K of the stages solve G(K) = K - f(t + c h, y + h A K) = 0. With C near the inverse of G'(K̃), K̃ a point, and
X a box around it, let N = K̃ - C G(K̃) + (I - C G'(X)) (X - K̃), for all y of a ball at once. If N lies in the interior
of X, then each y of the ball has exactly one K in X, and it lies in N (krawczyk-1969).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_poly, ctx

from driftproof.enclosure.clocks import Clock
from driftproof.enclosure.fields import RightHandSide
from driftproof.enclosure.numbers import Evaluation, Refused, size
from driftproof.enclosure.steps import linearised
from driftproof.methods.schemes import Collocation, Method, RungeKutta, lagrange_integrals
from driftproof.symbolic.algebra.certified import enclose

# Convergence is quadratic near the solution, from 2⁻¹ to 2⁻⁴⁰⁹⁶ in 12 iterations; the others are for coming near.
_MOST_ITERATIONS = 40
# The box is this many times the first correction; a wider one is tried if its image is not inside it.
_WIDER = (2, 8, 64)

_Row: TypeAlias = Sequence[arb]
_Table: TypeAlias = tuple[list[list[arb]], list[arb], list[arb]]


def coefficient_balls(method: RungeKutta | Collocation) -> _Table:
    """A, b and c in balls of Arb's precision; for a collocation method, from the roots of its node polynomial."""
    if isinstance(method, RungeKutta):
        a = [[enclose(x) for x in row] for row in method.a]
        return a, [enclose(x) for x in method.b], [enclose(x) for x in method.c]
    nodes = method.node_balls(ctx.prec)
    integrals = lagrange_integrals(nodes, arb_poly)
    return [[p(node) for p in integrals] for node in nodes], [p(arb(1)) for p in integrals], list(nodes)


def implicit_step(method: Method, f: RightHandSide, n: int) -> Callable[[_Row, Fraction, Fraction], tuple[arb, ...]]:
    """A function step(y, t, h) -> y₁ in balls, which raises Refused; Newton's method starts from f(t, y)."""
    assert isinstance(method, RungeKutta | Collocation)
    a, b, c = coefficient_balls(method)
    stages = range(len(b))

    def step(y: _Row, t: Fraction, h: Fraction) -> tuple[arb, ...]:
        width = enclose(h)
        times = [enclose(t) + x * width for x in c]

        def equations(K: _Row, start: _Row) -> tuple[arb_mat, arb_mat]:
            """G(K) and G'(K)."""
            found, slopes = [], arb_mat(len(K), len(K))
            for i in stages:
                moved = [sum((a[i][j] * K[j * n + m] for j in stages), arb(0)) for m in range(n)]
                at_stage = [x + width * d for x, d in zip(start, moved, strict=True)]
                rates, rows = linearised(f, Clock(Evaluation(), times[i]), at_stage)
                found += [[K[i * n + m] - rates[m]] for m in range(n)]
                for j in stages:
                    for m in range(n):
                        for k in range(n):
                            own = int(i == j and m == k)
                            slopes[i * n + m, j * n + k] = own - width * a[i][j] * rows[m][k]
            return arb_mat(found), slopes

        K = _proved(equations, y, _newton(equations, f, enclose(t), [x.mid() for x in y], len(b)))
        return tuple(x + width * sum((b[i] * K[i * n + m] for i in stages), arb(0)) for m, x in enumerate(y))

    def proved_step(y: _Row, t: Fraction, h: Fraction) -> tuple[arb, ...]:
        try:
            return step(y, t, h)
        except ZeroDivisionError:
            raise Refused(f"the stage equations of {method.key} at t = {float(t):.9g} could not be solved") from None

    return proved_step


def _newton(equations: Any, f: RightHandSide, t: arb, y: _Row, stages: int) -> list[arb]:
    """A point near a solution. Raises ZeroDivisionError if a matrix is singular, or if there is no convergence."""
    rates, _ = linearised(f, Clock(Evaluation(), t), y, slopes=False)
    K = [x.mid() for x in rates] * stages
    for _ in range(_MOST_ITERATIONS):
        value, slopes = equations(K, y)
        moved = slopes.mid().solve(value.mid(), algorithm="approx").entries()
        K = [(x - d).mid() for x, d in zip(K, moved, strict=True)]
        if size(moved) <= size(K).max(arb(1)) * arb(2) ** (16 - ctx.prec):
            return K
    raise ZeroDivisionError


def _proved(equations: Any, y: _Row, point: list[arb]) -> list[arb]:
    """Krawczyk's N for all y of the ball. Raises ZeroDivisionError if no box tried contains its N."""
    value, slopes = equations(point, y)
    inverse = slopes.mid().inv().mid()
    first = inverse * value
    least = size(point).max(arb(1)) * arb(2) ** (8 - ctx.prec)
    for wider in _WIDER:
        around = [arb(0, (wider * arb(x.abs_upper()) + least).upper()) for x in first.entries()]
        box = [x + r for x, r in zip(point, around, strict=True)]
        _, on_box = equations(box, y)
        moved = (arb_mat(len(point), len(point), 1) - inverse * on_box) * arb_mat([[r] for r in around]) - first
        if all(r.contains_interior(x) for r, x in zip(around, moved.entries(), strict=True)):
            return [x + d for x, d in zip(point, moved.entries(), strict=True)]
    raise ZeroDivisionError
