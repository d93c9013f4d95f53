"""Rooted trees as nested tuples, one colour or several: their numbers, and how they are written and read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from itertools import groupby
from math import factorial, prod
from typing import TypeAlias

from driftproof.symbolic.trees.table import tree_table

# A rooted tree is the tuple of the trees at its root, smallest first; () is the single vertex.
Tree: TypeAlias = tuple["Tree", ...]
# A tree whose vertices have colours: the colour of its root, and the coloured trees at its root.
ColouredTree: TypeAlias = tuple[str, tuple["ColouredTree", ...]]
AnyTree: TypeAlias = Tree | ColouredTree

VERTEX = "τ"


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
    """All trees with at most `order` vertices in the numbering of `tree_table(order, len(colours), internal)`."""
    table, kinds = tree_table(order, len(colours), internal), len(colours)
    trees: list[ColouredTree] = [(colour, ()) for colour in colours]
    for rest, branch in zip(table.rest[kinds:], table.branch[kinds:], strict=True):
        colour, branches = trees[rest]
        trees.append((colour, (*branches, trees[branch])))
    return tuple(trees)


def rooted_trees(vertices: int) -> tuple[Tree, ...]:
    """All rooted trees with so many vertices: 1, 1, 2, 4, 9, 20, ... of them; the bush first, the tall tree last."""
    return shapes(vertices)[tree_table(vertices).first[vertices] :]


def bush(vertices: int) -> Tree:
    """The tree with all but one of its vertices joined to its root, [τ,...,τ]: the condition Σ bᵢ cᵢⁿ⁻¹ = 1/n."""
    return ((),) * (vertices - 1)


def tall(vertices: int) -> Tree:
    """The tree without a fork, [[...[τ]...]]: the condition b Aⁿ⁻¹ 1 = 1/n!, the only one on linear problems."""
    tree: Tree = ()
    for _ in range(vertices - 1):
        tree = (tree,)
    return tree


def number_of(tree: Tree) -> int:
    """The number of a tree in every table of its order or more; its branches may be given in any order."""
    return _numbers(vertices(tree))[canonical(tree)]


def canonical(tree: Tree) -> Tree:
    """The same tree with its branches, and theirs, in the order of the tables: smallest first."""
    return tuple(sorted(map(canonical, tree), key=_key))


def vertices(tree: Tree) -> int:
    """The number of vertices, r(t)."""
    return 1 + sum(map(vertices, tree))


def density(tree: Tree) -> int:
    """γ(t) = r(t) Π γ(branch): the exact solution's weight of the tree is 1/γ(t) (hairer-norsett-wanner-1993, II.2)."""
    return vertices(tree) * prod(map(density, tree))


def symmetry(tree: Tree) -> int:
    """σ(t), the number of automorphisms: the elementary differential F(t) comes with h^r(t)/σ(t) in a B-series."""
    copies = Counter(map(canonical, tree))
    return prod(symmetry(branch) ** times * factorial(times) for branch, times in copies.items())


def alternating(tree: Tree, root: str, other: str) -> ColouredTree:
    """The tree with its root coloured `root`, the next vertices coloured `other`, and so on in turn."""
    return root, tuple(alternating(branch, other, root) for branch in tree)


def written(tree: AnyTree) -> str:
    """The tree in brackets: τ is one vertex, [τ,[τ]] has two branches at its root; colours follow, as in [τ_v]_q.

    The notation is that of hairer-lubich-wanner-2006, III.1.1 and III.2.1.
    """
    return _written(tree, VERTEX, "_{}", lambda text, copies: ",".join([text] * copies))


def tex(tree: AnyTree) -> str:
    r"""The tree in brackets, for TeX's mathematics mode, equal branches as powers: [\tau^{2},[\tau]]."""
    return _written(tree, r"\tau", "_{{{}}}", lambda text, copies: text if copies == 1 else f"{text}^{{{copies}}}")


def read(text: str) -> Tree:
    """The uncoloured tree that `written` writes so. Raises ValueError if the text is no tree."""
    tree, end = _read(text.replace(" ", ""), 0)
    if end != len(text.replace(" ", "")):
        raise ValueError(f"{text!r} is no tree: write τ for a vertex, [τ,[τ]] for branches at a root")
    return canonical(tree)


@cache
def _numbers(order: int) -> dict[Tree, int]:
    return {tree: number for number, tree in enumerate(shapes(order))}


def _key(tree: Tree) -> tuple[object, ...]:
    """Sorts as the tables do: by vertices, then by the largest branch, then by the next one."""
    return vertices(tree), tuple(map(_key, reversed(tree)))


def _parts(tree: AnyTree) -> tuple[str, Sequence[AnyTree]]:
    if tree and isinstance(tree[0], str):
        return tree[0], tree[1]
    return "", tree


def _written(tree: AnyTree, vertex: str, suffix: str, power: Callable[[str, int], str]) -> str:
    colour, branches = _parts(tree)
    inside = [_written(branch, vertex, suffix, power) for branch in branches]
    groups = [(text, len(list(group))) for text, group in groupby(inside)]
    body = f"[{','.join(power(*group) for group in groups)}]" if branches else vertex
    return body + (suffix.format(colour) if colour else "")


def _read(text: str, start: int) -> tuple[Tree, int]:
    if text[start : start + 1] == VERTEX:
        return (), start + 1
    branches: list[Tree] = []
    separator = "["
    while text[start : start + 1] == separator:
        branch, start = _read(text, start + 1)
        branches.append(branch)
        separator = ","
    if not branches or text[start : start + 1] != "]":
        raise ValueError(f"{text!r} is no tree: write τ for a vertex, [τ,[τ]] for branches at a root")
    return tuple(branches), start + 1
