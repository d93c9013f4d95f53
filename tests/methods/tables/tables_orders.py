"""Exact residuals of order conditions, for the tests of the tables: rooted trees, words, Nyström trees, quadrature.

Nothing here runs a step. With a residual comes its `slack`: how far rounding every non-zero coefficient by at most
`unit` can move it. Each condition is a polynomial P with non-negative coefficients in the entries of the table, so
that slack = P(|entries| + unit) - P(|entries|) is enough; a residual above it is no effect of rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction as Q
from functools import cache
from math import factorial, floor, prod
from typing import Any

from driftproof.methods.schemes import SUBSTEPS, Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.trees.rooted_trees import Tree, density, rooted_trees
from tests.methods.tables.entries import of_type

# How far each non-zero coefficient may be from the one that was rounded.
# Fractions: a convergent p/q of a number is within 1/q² of it, and q > 1.5e8 in every rounded one of this table.
UNITS = {"prince_dormand87": Q(1, 150_000_000**2)}
# 15 and more digits, the largest entry 12.9; the first column is what is left of c after at most four of them.
UNITS["tsitouras54"] = 5 * Q("0.5e-14")
# 30 digits, the largest entry 43.5; the embedded rows are differences of two such.
UNITS["dop853"] = UNITS["dop853_third"] = 2 * Q("0.5e-28")
# As recomputed in test_tables_facts.py, Table 1 is right to within 2e-14, Table 2 to 1.1e-12, not to all 15 digits;
# the middle weight is 1 minus twice all others.
UNITS |= dict.fromkeys(["yoshida6", "yoshida6_position_first", "yoshida6_b", "yoshida6_c"], 2 * 3 * Q("2e-14"))
UNITS |= dict.fromkeys(["yoshida8", "yoshida8_position_first", "yoshida8_a"], 2 * 7 * Q("1.1e-12"))
UNITS |= dict.fromkeys(["kahan_li6", "kahan_li8", "suzuki_umeno8"], Q("1e-26"))
UNITS |= dict.fromkeys(["mclachlan_atela3", "mclachlan_atela4", "mclachlan_atela5"], Q("1e-18"))
# 15 decimal places, the middle one 1 minus twice all (7 at most) others.
UNITS |= {method.key: 2 * 7 * Q("0.5e-15") for method in of_type(Splitting) if method.key[:7] in ("pefrl", "blanes_")}
UNITS["vefrl"] = 2 * 2 * Q("0.5e-14")

Number = Any
Residuals = Iterator[tuple[str, Number, Number]]


def hold(residuals: Iterable[tuple[str, Any, Q]]) -> bool:
    """All conditions hold, exactly where the table is not rounded, else up to what rounding can do."""
    return all(residual == 0 or -slack <= residual <= slack for _, residual, slack in residuals)


def residuals_of_claim(method: Method, order: int) -> Residuals:
    """Those of the conditions of this order on the class of problems that the source claims its order for."""
    unit = UNITS.get(method.key, Q(0))
    if isinstance(method, RungeKutta):
        return tree_residuals(method, order, unit)
    if isinstance(method, Collocation):
        # The order is that of the quadrature: M is orthogonal to the powers below p - s.
        power = order - method.stages - 1
        return iter([(f"x**{power}", quadrature_residual(method, power), Q(0))] if power >= 0 else [])
    if isinstance(method, Splitting) and not method.quadratic_kinetic:
        return word_residuals(method, order, unit)
    return force_tree_residuals(method, order, unit)


def meets_claim(method: Method) -> bool:
    """Every condition holds up to the claimed order; asked for lowest orders first."""
    return all(hold(residuals_of_claim(method, p)) for p in range(1, method.claimed_order + 1))


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return sum((x * y for x, y in zip(a, b, strict=True) if x and y), Q(0))


class TreeWeights:
    """Φ(t) of a tableau; the stage weights of every tree are computed once."""

    def __init__(self, a: Sequence[Sequence[Number]], b: Sequence[Number]) -> None:
        self.a, self.b = a, b
        self.stages: dict[Tree, list[Number]] = {(): [Q(1)] * len(b)}
        self.sums: dict[Tree, list[Number]] = {}

    def stage(self, tree: Tree) -> list[Number]:
        if tree not in self.stages:
            rest, last = self.stage(tree[:-1]), self.summed(tree[-1])
            self.stages[tree] = [x * y for x, y in zip(rest, last, strict=True)]
        return self.stages[tree]

    def summed(self, tree: Tree) -> list[Number]:
        if tree not in self.sums:
            inner = self.stage(tree)
            self.sums[tree] = [dot(row, inner) for row in self.a]
        return self.sums[tree]

    def weight(self, tree: Tree) -> Number:
        return dot(self.b, self.stage(tree))


def widened(values: Sequence[Number], unit: Q) -> tuple[Q, ...]:
    """|x| + unit for each x that is not zero, rounded up to 160 binary places to keep the numbers short."""
    return tuple(-floor(-(abs(x) + unit) * 2**160) * Q(1, 2**160) if x else Q(0) for x in values)


def sizes(values: Sequence[Number]) -> tuple[Q, ...]:
    """|x|, rounded down to 160 binary places."""
    return tuple(floor(abs(x) * 2**160) * Q(1, 2**160) for x in values)


def tree_residuals(method: RungeKutta, order: int, unit: Q = Q(0), *, embedded: bool = False) -> Residuals:
    """(tree, Φ(t) - 1/γ(t), slack) for each tree with `order` vertices."""
    b = method.b_embedded if embedded else method.b
    assert b is not None
    plain = _weights(method.a, b)
    for tree in rooted_trees(order):
        slack = Q(0)
        if unit:
            wide = _weights(tuple(widened(row, unit) for row in method.a), widened(b, unit))
            slack = wide.weight(tree) - _weights(tuple(map(sizes, method.a)), sizes(b)).weight(tree)
        yield str(tree), plain.weight(tree) - Q(1, density(tree)), slack


@cache
def _weights(a: tuple[tuple[Number, ...], ...], b: tuple[Number, ...]) -> TreeWeights:
    return TreeWeights(a, b)


Words = dict[str, Number]


def words_of(parts: Sequence[tuple[str, Number]], longest: int) -> Words:
    """The product of exp(c K) and exp(c D) in their order, K and D without relations, up to words of that length."""
    series: Words = {"": Q(1)}
    for kind, c in parts:
        letter = kind[0]
        grown: Words = {}
        for word, coefficient in series.items():
            power = coefficient
            for k in range(longest - len(word) + 1):
                grown[word + k * letter] = grown.get(word + k * letter, 0) + power
                power = power * c / (k + 1)
        series = grown
    return series


def word_residuals(method: Splitting, order: int, unit: Q = Q(0)) -> Residuals:
    """(word, residual, slack) for each word of `order` letters.

    A composition has order p for every Hamiltonian T(p) + V(q) if and only if it agrees with exp(K + D) in the words
    of at most p letters, because the kicks and drifts of all of them satisfy no common relation.

    The slack is that of the larger polynomial (Σ|k|)^i/i! (Σ|d|)^j/j!, i and j the numbers of letters, in which each
    monomial of the word's coefficient occurs, with the same factor.
    """
    plain = _words(method.parts, method.claimed_order + 1)
    low, high = (
        {kind: _total(method, kind, change) for kind in SUBSTEPS} if unit else {} for change in (sizes, _widening(unit))
    )
    for index in range(2**order):
        word = "".join("kd"[index >> i & 1] for i in range(order))
        slack = _power_bound(high, word) - _power_bound(low, word) if unit else Q(0)
        yield word, plain.get(word, Q(0)) - Q(1, factorial(order)), slack


def _total(method: Splitting, kind: str, change: Callable[[Sequence[Number]], Sequence[Q]]) -> Q:
    return sum(change([c for k, c in method.parts if k == kind]), Q(0))


def _widening(unit: Q) -> Callable[[Sequence[Number]], Sequence[Q]]:
    return lambda values: widened(values, unit)


def _power_bound(totals: dict[str, Q], word: str) -> Q:
    counts = [(kind, word.count(kind[0])) for kind in SUBSTEPS]
    return prod((totals[kind] ** n * Q(1, factorial(n)) for kind, n in counts), start=Q(1))


@cache
def _words(parts: tuple[tuple[str, Number], ...], longest: int) -> Words:
    return words_of(parts, longest)


# A force F(q + ...) differentiated m times in the direction of v and once for each force inside: (m, inner trees).
Force = tuple[int, tuple["Force", ...]]


@cache
def force_trees(order: int) -> tuple[Force, ...]:
    """All force trees of the given order: the power of h, m for v and two more than its own for each inner tree."""
    trees = []
    for m in range(order + 1):
        trees += [(m, forest) for forest in _force_forests(order - m, order)]
    return tuple(trees)


@cache
def _force_forests(order: int, largest: int) -> tuple[tuple[Force, ...], ...]:
    """Every multiset of force trees whose orders + 2 add to `order`, none of more than `largest`."""
    if order == 0:
        return ((),)
    found = set()
    for size in range(min(order - 2, largest) + 1):
        for tree in force_trees(size):
            for rest in _force_forests(order - size - 2, largest):
                found.add(tuple(sorted((tree, *rest))))
    return tuple(sorted(found))


def force_order(tree: Force) -> int:
    m, inner = tree
    return m + sum(2 + force_order(t) for t in inner)


def force_value(tree: Force) -> Q:
    """The coefficient of t**order for the exact solution, q(t) = q + tv + ∫(t - s) F(q(s)) ds."""
    return prod((force_value(t) * Q(1, (force_order(t) + 1) * (force_order(t) + 2)) for t in tree[1]), start=Q(1))


class NystromWeights:
    """The coefficients of the force trees in every kᵢ, each computed once."""

    def __init__(self, method: Nystrom) -> None:
        self.method, self.known = method, dict[Force, list[Number]]()

    def stage(self, tree: Force) -> list[Number]:
        if tree not in self.known:
            m, inner = tree
            weights = [prod([c] * m, start=Q(1)) for c in self.method.c]
            for t in inner:
                below = self.stage(t)
                weights = [w * dot(row, below) for w, row in zip(weights, self.method.a, strict=True)]
            self.known[tree] = weights
        return self.known[tree]


def force_tree_residuals(method: Nystrom | Splitting, order: int, unit: Q = Q(0)) -> Residuals:
    """(tree, residual, slack) of every condition of the given order on q'' = F(q), those of v and those of q."""
    plain = _force_weights(as_nystrom(method) if isinstance(method, Splitting) else method)
    wide = size = plain
    if unit:
        assert isinstance(method, Splitting)  # the Nyström tables of the catalogue are rational
        kinds, values = zip(*method.parts, strict=True)
        wide, size = (
            _force_weights(as_nystrom(replace(method, parts=tuple(zip(kinds, changed, strict=True)))))
            for changed in (widened(values, unit), sizes(values))
        )
    for name, lost in (("b_velocity", 1), ("b_position", 2)):
        for tree in force_trees(order - lost) if order >= lost else ():
            exact = force_value(tree) / (order if lost == 1 else order * (order - 1))
            value, low, high = (dot(getattr(w.method, name), w.stage(tree)) for w in (plain, size, wide))
            yield f"{name} {tree}", value - exact, high - low


@cache
def _force_weights(method: Nystrom) -> NystromWeights:
    return NystromWeights(method)


def as_nystrom(method: Splitting) -> Nystrom:
    """The same map on q'' = F(q): kᵢ is the force at the i-th kick, aᵢⱼ = bⱼ (cᵢ - cⱼ), c the drift before it."""
    drifted: Number = Q(0)
    kicks: list[tuple[Number, Number]] = []
    for kind, coefficient in method.parts:
        if kind == "drift":
            drifted = drifted + coefficient
        else:
            kicks.append((drifted, coefficient))
    return Nystrom(
        *(method.key, method.title, method.claimed_order, method.source),
        c=tuple(c for c, _ in kicks),
        a=tuple(
            tuple(b * (c - other) if j < i else Q(0) for j, (other, b) in enumerate(kicks))
            for i, (c, _) in enumerate(kicks)
        ),
        b_position=tuple(b * (drifted - c) for c, b in kicks),
        b_velocity=tuple(b for _, b in kicks),
    )


def quadrature_residual(method: Collocation, power: int) -> Q:
    """∫₀¹ M(x) x^power dx: all of them vanish for power < p - s, and no more, exactly if the order is p.

    (hairer-norsett-wanner-1993, II.7: a collocation method has the order of its quadrature formula.)
    """
    return sum((x * Q(1, k + power + 1) for k, x in enumerate(method.node_polynomial)), Q(0))


def stability_series(method: RungeKutta, order: int) -> list[Number]:
    """The coefficients 1, bᵀ1, bᵀA1, ... of R(z) in powers of z, up to the order, b the propagated row."""
    series: list[Number] = [Q(1)]
    stages: list[Number] = [Q(1)] * method.stages
    for _ in range(order):
        series.append(dot(method.b, stages))
        stages = [dot(row, stages) for row in method.a]
    return series
