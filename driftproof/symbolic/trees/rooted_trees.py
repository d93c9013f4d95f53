"""Rooted trees: a table of all trees up to an order with their γ and σ, trees as nested tuples, bracket notation."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import repeat
from math import prod
from typing import TypeAlias

Column = tuple[int, ...]

# The most trees of one order. With one colour, order 15 (87,811 trees) fits; whoever asks for more has made a mistake.
MOST_TREES = 100_000


class TooManyTrees(ValueError):
    """The error for an order with more than MOST_TREES trees, too many to make or to read."""


@dataclass(frozen=True)
class TreeTable:
    """All rooted trees with at most `order` vertices, numbered from 0 by size, then largest branch, then the rest.

    Tree t is the tree `rest[t]` with the tree `branch[t]` joined to its root. No branch of `rest[t]` has a larger
    number than `branch[t]`, so each tree occurs once, and the trees of one size that may take a given branch have
    consecutive numbers. A single vertex has branch -1. Vertices have `kinds` colours, of which the first `internal` may
    carry branches; both are 1 for ordinary rooted trees. `first[n]` is the number of the first tree with n vertices.
    """

    kinds: int
    internal: int
    first: Column
    rest: Column
    branch: Column

    @property
    def order(self) -> int:
        """The largest number of vertices in the table."""
        return len(self.first) - 2

    def ids(self, vertices: int) -> range:
        """The numbers of the trees with `vertices` vertices."""
        return range(self.first[vertices], self.first[vertices + 1])

    @cached_property
    def kind(self) -> Column:
        """The colour of the root, numbered from 0, of every tree."""
        kind = list(range(self.kinds))
        for rest in self.rest[self.kinds :]:
            kind.append(kind[rest])
        return tuple(kind)

    @cached_property
    def density(self) -> Column:
        """γ(t) = r(t) Π γ(branch), of every tree (hairer-norsett-wanner-1993, II.2)."""
        below, density = [1] * self.kinds, [1] * self.kinds  # `below` is Π γ(branch)
        for n in range(2, self.order + 1):
            rest, branch = self._column(self.rest, n), self._column(self.branch, n)
            new = [below[r] * density[b] for r, b in zip(rest, branch, strict=True)]
            below += new
            density += [n * x for x in new]
        return tuple(density)

    @cached_property
    def symmetry(self) -> Column:
        """σ(t) = Π σ(branch) Π (multiplicity)!, of every tree (hairer-lubich-wanner-2006, III.1.2)."""
        symmetry = copies = (1,) * self.kinds  # `copies`: the multiplicity of the largest branch
        for n in range(2, self.order + 1):
            rest, branch = self._column(self.rest, n), self._column(self.branch, n)
            new = tuple(copies[r] + 1 if self.branch[r] == b else 1 for r, b in zip(rest, branch, strict=True))
            symmetry += tuple(symmetry[r] * symmetry[b] * k for r, b, k in zip(rest, branch, new, strict=True))
            copies += new
        return symmetry

    def _column(self, column: Column, vertices: int) -> Column:
        return column[self.first[vertices] : self.first[vertices + 1]]

    def join(self, root: int, branch: int) -> int:
        """The number of the tree u ∘ v: the tree `branch` joined by an edge to the root of the tree `root`.

        Butcher's product (hairer-lubich-wanner-2006, VI.7.2). Raises KeyError if that tree is not in the table.
        """
        found = self._joins.get((root, branch))
        if found is None:
            if self.branch[root] <= branch:
                raise KeyError(f"tree {root} with branch {branch} exceeds the table, which ends at order {self.order}")
            found = self.join(self.join(self.rest[root], branch), self.branch[root])
            self._joins[root, branch] = found
        return found

    @cached_property
    def _joins(self) -> dict[tuple[int, int], int]:
        pairs = zip(self.rest[self.kinds :], self.branch[self.kinds :], strict=True)
        return {pair: self.kinds + t for t, pair in enumerate(pairs)}

    @cached_property
    def cuts(self) -> tuple[tuple[tuple[int, int, int], ...], ...]:
        """For every tree, the results of cutting one edge: (tree with the root, tree cut off, number of such edges)."""
        result: list[dict[tuple[int, int], int]] = [{} for _ in range(self.kinds)]
        for rest, branch in zip(self.rest[self.kinds :], self.branch[self.kinds :], strict=True):
            found = {(self.join(left, branch), fallen): n for (left, fallen), n in result[rest].items()}
            found[rest, branch] = found.get((rest, branch), 0) + 1
            for (left, fallen), n in result[branch].items():
                pair = self.join(rest, left), fallen
                found[pair] = found.get(pair, 0) + n
            result.append(found)
        return tuple(tuple((left, fallen, n) for (left, fallen), n in found.items()) for found in result)


@cache
def tree_table(order: int, kinds: int = 1, internal: int = 1) -> TreeTable:
    """The table of all rooted trees with at most `order` vertices, in which those of lower order keep their numbers.

    There are 1, 1, 2, 4, 9, 20, 48, 115, 286, ... trees of order 1, 2, ... (hairer-norsett-wanner-1993, II.2). Raises
    TooManyTrees, and ValueError if `order` is below 1.
    """
    if order < 1:
        raise ValueError(f"trees have at least 1 vertex, not {order}")
    if order == 1:
        return TreeTable(kinds, internal, (0, 0, kinds), tuple(range(kinds)), (-1,) * kinds)
    smaller = tree_table(order - 1, kinds, internal)
    rests: list[int] = []
    branches: list[int] = []
    for size in range(1, order):
        # Single vertices that may not carry a branch are numbered after those that may.
        low, high = smaller.first[order - size], smaller.first[order - size + 1]
        high = internal if order - size == 1 else high
        for branch in smaller.ids(size):
            end = bisect_right(smaller.branch, branch, low, high)
            rests += range(low, end)
            branches += repeat(branch, end - low)
            if len(rests) > MOST_TREES:
                raise TooManyTrees(f"there are more than {MOST_TREES} trees of order {order}")
    first = (*smaller.first, len(smaller.rest) + len(rests))
    return TreeTable(kinds, internal, first, (*smaller.rest, *rests), (*smaller.branch, *branches))


# A rooted tree is the tuple of its branches, smallest first; () is the single vertex.
Tree: TypeAlias = tuple["Tree", ...]
# A tree whose vertices have colours: the colour of its root, and its branches.
ColouredTree: TypeAlias = tuple[str, tuple["ColouredTree", ...]]
AnyTree: TypeAlias = Tree | ColouredTree


@cache
def shapes(order: int) -> tuple[Tree, ...]:
    """All rooted trees with at most `order` vertices, in the numbering of `tree_table(order)`."""
    table = tree_table(order)
    trees: list[Tree] = [()]
    for rest, branch in zip(table.rest[1:], table.branch[1:], strict=True):
        trees.append((*trees[rest], trees[branch]))
    return tuple(trees)


@cache
def coloured_shapes(order: int, colours: tuple[str, ...], internal: int) -> tuple[ColouredTree, ...]:
    """All coloured trees with at most `order` vertices, numbered as by `tree_table(order, len(colours), internal)`."""
    table, kinds = tree_table(order, len(colours), internal), len(colours)
    trees: list[ColouredTree] = [(colour, ()) for colour in colours]
    for rest, branch in zip(table.rest[kinds:], table.branch[kinds:], strict=True):
        colour, branches = trees[rest]
        trees.append((colour, (*branches, trees[branch])))
    return tuple(trees)


def rooted_trees(vertices: int) -> tuple[Tree, ...]:
    """All rooted trees with `vertices` vertices (1, 1, 2, 4, 9, 20, ... of them), bush first and tall tree last."""
    return shapes(vertices)[tree_table(vertices).first[vertices] :]


def bush(vertices: int) -> Tree:
    """The tree [τ,...,τ], all vertices but the root being leaves at the root: the condition Σ bᵢ cᵢⁿ⁻¹ = 1/n."""
    return ((),) * (vertices - 1)


def tree_number(tree: Tree) -> int:
    """The number of a tree in every table that holds it; the branches may be given in any order."""
    return _numbers(vertices(tree))[canonical_tree(tree)]


def canonical_tree(tree: Tree) -> Tree:
    """The same tree with the branches at every vertex in the order of the tables, smallest first."""
    return tuple(sorted(map(canonical_tree, tree), key=_key))


def vertices(tree: Tree) -> int:
    """The number of vertices, r(t)."""
    return 1 + sum(map(vertices, tree))


def density(tree: Tree) -> int:
    """γ(t) = r(t) Π γ(branch): the exact solution's weight of the tree is 1/γ(t) (hairer-norsett-wanner-1993, II.2)."""
    return vertices(tree) * prod(map(density, tree))


def alternately_coloured(tree: Tree, root: str, other: str) -> ColouredTree:
    """The tree with colours that alternate from level to level: `root` at the root, then `other`."""
    return root, tuple(alternately_coloured(branch, other, root) for branch in tree)


def to_brackets(tree: AnyTree) -> str:
    """The tree in brackets: τ is one vertex, [τ,[τ]] has two branches at its root; colours follow, as in [τ_v]_q.

    The notation is that of hairer-lubich-wanner-2006, III.1.1 and III.2.1.
    """
    colour, branches = tree if tree and isinstance(tree[0], str) else ("", tree)
    body = f"[{','.join(map(to_brackets, branches))}]" if branches else "τ"
    return f"{body}_{colour}" if colour else body


@cache
def _numbers(order: int) -> dict[Tree, int]:
    return {tree: number for number, tree in enumerate(shapes(order))}


def _key(tree: Tree) -> tuple[object, ...]:
    """The sort key of the tables: the number of vertices, then the largest branch, then the next largest."""
    return vertices(tree), tuple(map(_key, reversed(tree)))
