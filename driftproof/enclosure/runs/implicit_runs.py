"""The exact step of an implicit method in balls: stages by Newton's method, and Krawczyk's proof that they exist.

The slopes K of the stages solve G(K) = K - f(t + c h, y + h A K) = 0. With C near the inverse of G'(K̃), K̃ a point, and
X a box around it, let N = K̃ - C G(K̃) + (I - C G'(X)) (X - K̃), for all y of a ball at once. If N lies in the interior
of X, then each y of the ball has exactly one K in X, and it lies in N (krawczyk-1969). As K'(y) = -(G_K)⁻¹ G_y, the
step is y₁ at the middle of the ball plus (I + h bᵀ K') (y - middle): stiff components contract in balls as in numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import accumulate
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_poly, ctx

from driftproof.enclosure.arithmetic.clocks import exact_time
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.fields.fields import RightHandSide, linearised
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting, lagrange_integrals
from driftproof.symbolic.algebra.certified import enclose

# Convergence is quadratic near the solution, from 2⁻¹ to 2⁻⁴⁰⁹⁶ in 12 iterations; the others are for coming near.
_MOST_ITERATIONS = 40
# Damping shortens no correction further than by this factor.
_SHORTEST = 2**20
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


def rational_nodes(method: Method) -> list[Fraction]:
    """All nodes of a method, each once; none if one is irrational."""
    nodes: set[Exact] = set()
    if isinstance(method, Splitting):
        drifts = [c if kind == "drift" else Fraction(0) for kind, c in method.parts]
        nodes = {*accumulate(drifts, initial=Fraction(0))}
    elif isinstance(method, RungeKutta | Nystrom):
        nodes = {*method.c}
    rational = [c for c in nodes if isinstance(c, Fraction)]
    return rational if len(rational) == len(nodes) else []


def implicit_step(method: Method, f: RightHandSide, n: int) -> Callable[[_Row, Fraction, Fraction], tuple[arb, ...]]:
    """A function step(y, t, h) -> y₁ in balls, which raises Refused."""
    assert isinstance(method, RungeKutta | Collocation)
    a, b, c = coefficient_balls(method)
    stages, nodes = range(len(b)), rational_nodes(method)

    def step(y: _Row, t: Fraction, h: Fraction) -> tuple[arb, ...]:
        width = enclose(h)
        times = [enclose(t) + x * width for x in c]
        known = [(at, enclose(at)) for at in (t + x * h for x in nodes)]

        def equations(K: _Row, start: _Row) -> tuple[arb_mat, arb_mat, arb_mat]:
            """G(K) and its derivatives by K and by the start."""
            found, slopes, by_start = [], arb_mat(len(K), len(K)), arb_mat(len(K), n)
            for i in stages:
                moved = [sum((a[i][j] * K[j * n + m] for j in stages), arb(0)) for m in range(n)]
                at_stage = [x + width * d for x, d in zip(start, moved, strict=True)]
                rates, rows = linearised(f, exact_time(Evaluation(), times[i], known), at_stage)
                found += [[K[i * n + m] - rates[m]] for m in range(n)]
                for m in range(n):
                    for k in range(n):
                        by_start[i * n + m, k] = -rows[m][k]
                for j in stages:
                    for m in range(n):
                        for k in range(n):
                            own = int(i == j and m == k)
                            slopes[i * n + m, j * n + k] = own - width * a[i][j] * rows[m][k]
            return arb_mat(found), slopes, by_start

        def moved(K: Sequence[Any], m: int) -> Any:
            return width * sum((b[i] * K[i * n + m] for i in stages), arb(0))

        middle = [x.mid() for x in y]
        K, at_middle, change = _proved(equations, y, middle, _newton(equations, middle, len(b) * n))
        ends = []
        for m, x in enumerate(y):
            end = middle[m] + moved(at_middle, m)
            for k in range(n):
                end += (int(m == k) + moved([row[k] for row in change], m)) * (y[k] - middle[k])
            ends.append(min(end, x + moved(K, m), key=lambda found: found.rad()))
        return tuple(ends)

    def proved_step(y: _Row, t: Fraction, h: Fraction) -> tuple[arb, ...]:
        try:
            return step(y, t, h)
        except ZeroDivisionError:
            raise Refused(f"the stage equations of {method.key} at t = {float(t):.9g} could not be solved") from None

    return proved_step


def _newton(equations: Any, y: _Row, unknowns: int) -> list[arb]:
    """A point near the solution that float runs come to: from slopes of 0, damped if whole corrections lead nowhere.

    Slopes f(t, y), which are huge where f is stiff, may lie beyond another solution. A correction is shortened until
    the next one, by the same matrix, is shorter than it (hairer-wanner-1996, IV.8). Raises ZeroDivisionError if a
    matrix is singular, or if there is no convergence.
    """
    for damped in (False, True):
        K = [arb(0)] * unknowns
        for _ in range(_MOST_ITERATIONS << 2 * damped):
            value, slopes, _ = equations(K, y)
            matrix, part = slopes.mid(), 1
            moved = matrix.solve(value.mid(), algorithm="approx").entries()
            trial = [(x - d).mid() for x, d in zip(K, moved, strict=True)]
            while damped and part < _SHORTEST:
                following = matrix.solve(equations(trial, y)[0].mid(), algorithm="approx").entries()
                if size(following) < size(moved):
                    break
                part *= 2
                trial = [(x - d / part).mid() for x, d in zip(K, moved, strict=True)]
            K = trial
            if size(moved) <= size(K).max(arb(1)) * arb(2) ** (16 - ctx.prec):
                return K
    raise ZeroDivisionError


def _proved(
    equations: Any, y: _Row, middle: _Row, point: list[arb]
) -> tuple[list[arb], list[arb], Sequence[Sequence[arb]]]:
    """Krawczyk's N for all y of the ball and for its middle, and K'(y). Raises ZeroDivisionError if no N is in X."""
    value, slopes, _ = equations(point, y)
    inverse = slopes.mid().inv().mid()
    first, at_middle = inverse * value, inverse * equations(point, middle)[0]
    least = size(point).max(arb(1)) * arb(2) ** (8 - ctx.prec)
    for wider in _WIDER:
        around = [arb(0, (wider * arb(x.abs_upper()) + least).upper()) for x in first.entries()]
        box = [x + r for x, r in zip(point, around, strict=True)]
        on_box = inverse * equations(box, y)[1]
        rest = (arb_mat(len(point), len(point), 1) - on_box) * arb_mat([[r] for r in around])
        found, central = ((rest - each).entries() for each in (first, at_middle))
        if all(r.contains_interior(x) for r, x in zip(around, found, strict=True)):
            K, K_at_middle = ([x + d for x, d in zip(point, each, strict=True)] for each in (found, central))
            _, slopes, by_start = equations(K, y)
            return K, K_at_middle, (inverse * slopes).solve(-(inverse * by_start)).tolist()
    raise ZeroDivisionError
