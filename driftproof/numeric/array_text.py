"""Rewrite the program text of a step as calls of NumPy's ufuncs into given buffers, so that nothing is allocated.

An expression of arrays allocates a new array for each operation, which costs more than the operation. Here every result
goes into a free buffer, and values that depend on coefficients and h only are computed before the loop. The operations
and their order stay the same.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from driftproof.methods.program_text import indented, maker_text
from driftproof.methods.stepping import Source

UFUNCS = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
STATE = {"q": "q1", "v": "v1"}
LOST = ("e_q", "e_v")


def array_run(source: Source) -> tuple[str, int]:
    """Return the text of make(coefficients...) -> run(q, v, h, steps, buffers), and how many buffers it needs.

    run overwrites the arrays q and v. `buffers` are arrays of their shape and format. A compensated run uses the first
    two for what additions have lost; they must start as zeros.
    """
    writer = _Writer({*source.names, "h"})
    fixed = LOST if source.compensated else ()
    writer.places = {name: name for name in (*STATE, *fixed)}
    lines = _without_last_names(source.lines)
    for i, line in enumerate(lines):
        name, _, text = line.partition(" = ")
        writer.assign(name, ast.parse(text, mode="eval").body, lines[i + 1 :])
    for old, new in STATE.items():
        if writer.places.get(new, old) != old:
            writer.lines.append(f"copyto({old}, {writer.places[new]})")
    names = [*fixed, *(f"b{i}" for i in range(writer.made))]
    unpacked = [f"{', '.join(names)}, = buffers"] if names else []
    body = [*unpacked, *writer.before, "for _ in range(steps):", *indented(writer.lines)]
    return maker_text(source.names, "run", ["def run(q, v, h, steps, buffers):", *indented(body)]), len(names)


def _without_last_names(lines: Sequence[str]) -> list[str]:
    """The lines without copies such as "q1 = q_4": q_4 is called q1 wherever it stands."""
    lines = list(lines)
    for new in STATE.values():
        for match in filter(None, [re.fullmatch(rf"{new} = (\w+)", line) for line in lines]):
            lines.remove(match[0])
            if match[1] not in STATE:
                lines = [re.sub(rf"\b{match[1]}\b", new, line) for line in lines]
    return lines


@dataclass
class _Writer:
    scalars: set[str]
    lines: list[str] = field(default_factory=list)
    before: list[str] = field(default_factory=list)
    # The buffer or array that holds each named array; `free` lists the buffers that may be overwritten.
    places: dict[str, str] = field(default_factory=dict)
    free: list[str] = field(default_factory=list)
    made: int = 0
    formed: dict[str, str] = field(default_factory=dict)

    def assign(self, name: str, tree: ast.expr, later: Sequence[str]) -> None:
        """Write name = tree, then release the buffers of those names in `tree` that no later line reads."""
        read = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        dead = [x for x in read if x in self.places and not _occurs(x, later)]
        own = next((old for old, new in STATE.items() if new == name and not _occurs(old, later)), None)
        target = name if name in LOST else own
        if isinstance(tree, ast.Name):  # copied, because a buffer with two names could not be released with one of them
            place = target or self.new()
            self.lines.append(f"copyto({place}, {self.value(tree)})")
        else:
            place = self.value(tree, target)
        self.places[name] = place
        for x in dead:
            if x != name and self.places[x] != place:
                self.release(self.places.pop(x))

    def value(self, tree: ast.expr, target: str | None = None) -> str:
        """Write the operations of an expression; return where its value is: a name, `target`, or a buffer."""
        if self.is_scalar(tree):
            return self.scalar(tree)
        if isinstance(tree, ast.Name):
            return self.places[tree.id]
        ufunc, operands = _operation(tree)
        places = [self.value(operand) for operand in operands]
        for place in places:
            if place not in self.places.values():
                self.release(place)
        result = target or (self.free.pop() if self.free else self.new())
        self.lines.append(f"{ufunc}({', '.join([*places, result])})")
        return result

    def new(self) -> str:
        self.made += 1
        return f"b{self.made - 1}"

    def release(self, place: str) -> None:
        """Mark a buffer as free; arrays of the state are not buffers."""
        if re.fullmatch(r"b\d+", place):
            self.free.append(place)

    def is_scalar(self, tree: ast.expr) -> bool:
        return all(node.id in self.scalars for node in ast.walk(tree) if isinstance(node, ast.Name))

    def scalar(self, tree: ast.expr) -> str:
        """Return a name or number for a scalar expression, which is computed before the loop."""
        text = ast.unparse(tree)
        if isinstance(tree, ast.Name | ast.Constant):
            return text
        if text not in self.formed:
            self.formed[text] = f"s{len(self.formed)}"
            self.before.append(f"{self.formed[text]} = {text}")
        return self.formed[text]


def _occurs(name: str, lines: Sequence[str]) -> bool:
    """True if a line reads the name; always True for the new state, which is read at the end."""
    return name in STATE.values() or any(re.search(rf"\b{name}\b", line.partition(" = ")[2]) for line in lines)


def _operation(tree: Any) -> tuple[str, list[ast.expr]]:
    """The ufunc and the operands of an operation in a step: a + b and its like, -a, or f(a)."""
    if isinstance(tree, ast.BinOp):
        return UFUNCS[type(tree.op)], [tree.left, tree.right]
    if isinstance(tree, ast.UnaryOp):
        return "negative", [tree.operand]
    return tree.func.id, tree.args
