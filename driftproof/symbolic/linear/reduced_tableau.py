"""The irreducible coefficients of a method, and what they decide: symplecticity, symmetry, stiff accuracy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations_with_replacement, groupby
from typing import NamedTuple, TypeAlias

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.polynomials import ONE, X, polynomial

_Row: TypeAlias = tuple[Exact, ...]


class StageCoefficients(NamedTuple):
    """A, c and the rows of weights: (b,) for a Runge-Kutta method, (b_position, b_velocity) for a Nyström method."""

    a: tuple[_Row, ...]
    weights: tuple[_Row, ...]
    c: _Row

    @property
    def b(self) -> _Row:
        """The weights b of a Runge-Kutta method, or b_velocity of a Nyström method."""
        return self.weights[-1]


def stages_of(method: RungeKutta | Nystrom) -> StageCoefficients:
    """The coefficients of `method` without b_embedded."""
    if isinstance(method, Nystrom):
        return StageCoefficients(method.a, (method.b_position, method.b_velocity), method.c)
    return StageCoefficients(method.a, (method.b,), method.c)


def reduced(stages: StageCoefficients) -> StageCoefficients:
    """The irreducible form: stages that do not affect the result removed, stages equal on every problem merged.

    The former make a method DJ-reducible, the latter S-reducible (hairer-wanner-1996, IV.12). Criteria that are
    necessary and sufficient for irreducible coefficients, such as that of symplecticity, apply to the result. Problems
    are autonomous: the c of a Runge-Kutta method are ignored.
    """
    while True:
        smaller = _merged(_restricted(stages))
        if len(smaller.a) == len(stages.a):
            return stages
        stages = smaller


@lru_cache
def reduced_stages_of(method: RungeKutta | Nystrom) -> StageCoefficients:
    """The irreducible coefficients of `method`, cached for the facts that use them."""
    return reduced(stages_of(method))


def matchings(
    stages: StageCoefficients, other: StageCoefficients, chosen: tuple[int, ...] = ()
) -> Iterator[tuple[int, ...]]:
    """Yield the permutations p such that stage pᵢ of `other` has the coefficients of stage i, by backtracking."""
    i = len(chosen)
    if i == len(stages.a):
        yield chosen
    for k in range(len(stages.a)):
        if k not in chosen and _fits(stages, other, (*chosen, k)):
            yield from matchings(stages, other, (*chosen, k))


def _fits(stages: StageCoefficients, other: StageCoefficients, chosen: tuple[int, ...]) -> bool:
    """True if the last chosen stage agrees in its weights, and in the entries of A that it shares with earlier ones."""
    i, k = len(chosen) - 1, chosen[-1]
    if any(row[i] != matched[k] for row, matched in zip(stages.weights, other.weights, strict=True)):
        return False
    if len(stages.weights) > 1 and stages.c[i] != other.c[k]:
        return False
    a, b = stages.a, other.a
    return all(a[i][j] == b[k][m] and a[j][i] == b[m][k] for j, m in enumerate(chosen))


def _restricted(stages: StageCoefficients) -> StageCoefficients:
    """The tableau of the stages that affect the result, by a chain of nonzero aᵢⱼ to a nonzero weight; at least one."""
    counted = found = {i for row in stages.weights for i, x in enumerate(row) if x}
    while found:
        found = {j for i in found for j, x in enumerate(stages.a[i]) if x} - counted
        counted = counted | found
    kept = sorted(counted) or [0]
    return StageCoefficients(
        tuple(tuple(stages.a[i][j] for j in kept) for i in kept),
        tuple(tuple(row[i] for i in kept) for row in stages.weights),
        tuple(stages.c[i] for i in kept),
    )


def _merged(stages: StageCoefficients) -> StageCoefficients:
    """The tableau with stages merged that are equal on every problem, those of one class of `_coarsest_partition`."""
    labels = _coarsest_partition(stages)
    if len({*labels}) == len(labels):
        return stages
    firsts = [i for i, k in enumerate(labels) if k == i]
    members = [[j for j, k in enumerate(labels) if k == i] for i in firsts]
    return StageCoefficients(
        tuple(tuple(total(stages.a[i][j] for j in group) for group in members) for i in firsts),
        tuple(tuple(total(row[j] for j in group) for group in members) for row in stages.weights),
        tuple(stages.c[i] for i in firsts),
    )


def _coarsest_partition(stages: StageCoefficients) -> list[int]:
    """For each stage the first of its class, in the coarsest partition in which equal stages share a class.

    Classes are split until Σⱼ aᵢⱼ over each class depends on the class of i only; for Nyström methods, c as well.
    """
    labels = _labels(stages.c if len(stages.weights) > 1 else (None,) * len(stages.a))
    rows = [[(j, x) for j, x in enumerate(row) if x] for row in stages.a]
    while True:
        shared = [(row, sorted({labels[j] for j, _ in row})) for row in rows]
        sums = [[(k, s) for k in ks if (s := total(x for j, x in row if labels[j] == k))] for row, ks in shared]
        refined = _labels(list(zip(labels, sums, strict=True)))
        if refined == labels:
            return labels
        labels = refined


def _labels(values: Sequence[object]) -> list[int]:
    """For each value, the index of the first one equal to it."""
    return [values.index(value) for value in values]


def is_symplectic(method: Method) -> bool:
    """True if symplectic for every Hamiltonian; for splittings and Nyström methods, every one of the form T(p) + V(q).

    Runge-Kutta: bᵢaᵢⱼ + bⱼaⱼᵢ = bᵢbⱼ; Nyström: b̄ᵢ = bᵢ(1 - cᵢ) and bᵢ(b̄ⱼ - aᵢⱼ) = bⱼ(b̄ᵢ - aⱼᵢ). These conditions are
    sufficient, and necessary for irreducible methods (hairer-lubich-wanner-2006, VI.4 and VI.7). For collocation
    methods they say that the quadrature is exact to degree 2s - 1, that is that the nodes are Gauss's.
    """
    if isinstance(method, Splitting):
        return True
    if isinstance(method, Collocation):
        return bool(polynomial(method.node_polynomial) == _gauss_polynomial(method.stages))
    return not any(symplectic_residuals(reduced_stages_of(method)))


def symplectic_residuals(stages: StageCoefficients) -> Iterator[Exact]:
    """Yield the residuals of the conditions of `is_symplectic` for the coefficients as given."""
    a, b, pairs = stages.a, stages.b, combinations_with_replacement(range(len(stages.a)), 2)
    if len(stages.weights) == 1:
        yield from (b[i] * a[i][j] + b[j] * a[j][i] - b[i] * b[j] for i, j in pairs)
    else:
        outer = stages.weights[0]
        yield from (outer[i] - b[i] + b[i] * c for i, c in enumerate(stages.c))
        yield from (b[i] * (outer[j] - a[i][j]) - b[j] * (outer[i] - a[j][i]) for i, j in pairs)


def is_symmetric(method: Method) -> bool:
    """True if the step of -h undoes the step of h on every problem, that is if the method is its own adjoint.

    This is decided by a permutation of the stages that turns the irreducible coefficients into those of the adjoint,
    bⱼ - aᵢⱼ for a Runge-Kutta method (hairer-lubich-wanner-2006, V.2). For a splitting the reduced word must be a
    palindrome; for a collocation method the nodes must be symmetric about 1/2.
    """
    if isinstance(method, Splitting):
        word = reduced_word(method)
        return word == word[::-1]
    if isinstance(method, Collocation):
        nodes = polynomial(method.node_polynomial)
        return bool(nodes(ONE - X) * (-1) ** method.stages == nodes)
    stages = reduced_stages_of(method)
    return next(matchings(stages, adjoint(stages)), None) is not None


def adjoint(stages: StageCoefficients) -> StageCoefficients:
    """The coefficients of the adjoint method, which exchanges h with -h and start with end; same order of stages."""
    a, c = stages.a, tuple(1 - x for x in stages.c)
    *outer, b = stages.weights
    size = range(len(b))
    if not outer:
        return StageCoefficients(tuple(tuple(b[j] - a[i][j] for j in size) for i in size), (b,), c)
    (position,) = outer
    rows = tuple(tuple(b[j] * c[i] - position[j] + a[i][j] for j in size) for i in size)
    return StageCoefficients(rows, (tuple(b[j] - position[j] for j in size), b), c)


def is_stiffly_accurate(method: Method) -> bool:
    """True if the last stage is the result, aₛⱼ = bⱼ for all j (hairer-wanner-1996, IV.3); False for other families."""
    if isinstance(method, Collocation):
        return bool(polynomial(method.node_polynomial)(1) == 0)
    return isinstance(method, RungeKutta) and method.a[-1] == method.b


def is_first_same_as_last(method: Method) -> bool:
    """True if the first slope of a step is the last one of the step before: a₁ⱼ = 0 and aₛⱼ = bⱼ for all j."""
    if isinstance(method, Collocation):
        return is_stiffly_accurate(method) and not method.node_polynomial[0]
    return isinstance(method, RungeKutta) and is_stiffly_accurate(method) and not any(method.a[0])


def reduced_word(method: Splitting) -> list[tuple[str, Exact]]:
    """The sub-steps with zeros removed and neighbours of one kind added, until nothing changes."""
    word = [(kind, c) for kind, c in method.parts if c]
    while True:
        grouped = [(kind, total(c for _, c in run)) for kind, run in groupby(word, key=lambda part: part[0])]
        shorter = [(kind, c) for kind, c in grouped if c]
        if shorter == word:
            return word
        word = shorter


def _gauss_polynomial(degree: int) -> object:
    """The monic Legendre polynomial on [0, 1], from the derivative of order `degree` of (x² - x)**degree."""
    found = (X * X - X) ** degree
    for _ in range(degree):
        found = found.derivative()
    return found / found.leading_coefficient()
