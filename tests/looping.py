"""Loops that look at something: `some` and `exactly` fail on less, and `idle_tests` are those that need one of them."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")


def some(items: Iterable[T], least: int = 1) -> list[T]:
    """The items, of which there are `least` at least: a loop over none of them would assert nothing."""
    found = list(items)
    assert len(found) >= least > 0, f"{len(found)} to look at, at least {max(least, 1)} expected"
    return found


def exactly(count: int, items: Iterable[T]) -> list[T]:
    """The items, of which there are as many as the test says."""
    found = list(items)
    assert len(found) == count > 0, f"{len(found)} to look at, {count} expected"
    return found


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def idle_tests(root: Path, path: Path) -> list[str]:
    """The functions of a test file whose every assert stands in a loop, or in `all`, over what might be empty."""
    found = []
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.FunctionDef):
            reading = _Reading(root, parsed(path), node)
            made = list(reading.surely_made(node.body, True))
            if made and not any(made):
                found.append(f"{path.name}:{node.lineno} {node.name}")
    return found


@cache
def _asserting(tree: ast.Module) -> set[str]:
    """The functions of a file that assert something."""
    defined = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    return {node.name for node in defined if any(isinstance(x, ast.Assert) for x in ast.walk(node))}


ALIKE = {"enumerate", "reversed", "sorted", "list", "tuple", "set", "dict", "frozenset", "iter", "map"}


@dataclass(frozen=True)
class _Reading:
    """What is surely asserted, and surely not empty, in one function of a file (or in the file, outside of all)."""

    root: Path
    tree: ast.Module
    function: ast.FunctionDef | None

    def surely_made(self, body: list[ast.stmt], surely: bool) -> Iterator[bool]:
        """Of every assert, demand for an error, and call of a helper of the file that asserts: whether surely made."""
        for node in body:
            if isinstance(node, ast.Assert):
                yield surely and not self.may_hold_of_nothing(node.test)
            if isinstance(node, ast.Expr) and _called(node.value) in _asserting(self.tree):
                yield surely
            if isinstance(node, ast.With) and any(_called(i.context_expr) in ("raises", "warns") for i in node.items):
                yield surely
            if not isinstance(node, ast.FunctionDef | ast.ClassDef):
                runs = surely and not (isinstance(node, ast.For) and not self.holds_something(node.iter))
                yield from self.surely_made(getattr(node, "body", []), runs)
                for inner in ("orelse", "finalbody", "handlers", "cases"):
                    yield from self.surely_made(getattr(node, inner, []), surely)

    def may_hold_of_nothing(self, test: ast.expr) -> bool:
        """True of all(...), not any(...), [... for ...] == [] and {... for ...} <= s over what might be empty."""
        match test:
            case ast.BoolOp(op=ast.And(), values=values):
                return all(map(self.may_hold_of_nothing, values))
            case ast.Call(func=ast.Name(id="all"), args=[items]):
                return not self.holds_something(items)
            case ast.UnaryOp(op=ast.Not(), operand=ast.Call(func=ast.Name(id="any"), args=[items])):
                return not self.holds_something(items)
            case ast.Compare(
                left=ast.ListComp() | ast.SetComp() | ast.DictComp() as left, ops=[op], comparators=[right]
            ):
                none = isinstance(op, ast.Eq) and ast.unparse(right) in ("[]", "()", "{}", "set()")
                # Where nothing is chosen from the innermost, that it is empty is what the assert says.
                looked_at = left.generators[: -1 if none and not left.generators[-1].ifs else None]
                return (none or isinstance(op, ast.LtE)) and not all(self.holds_something(x.iter) for x in looked_at)
        return False

    def holds_something(self, items: ast.expr) -> bool:
        """True of what surely has a member: a literal that shows one, `some(...)`, and what keeps a member of these."""
        held = self.holds_something
        match items:
            case ast.Constant(value=value):
                return bool(value)
            case ast.Tuple(elts=members) | ast.List(elts=members) | ast.Set(elts=members):
                return any(not isinstance(x, ast.Starred) or held(x.value) for x in members)
            case ast.Dict(keys=keys, values=values):
                return any(key is not None or held(value) for key, value in zip(keys, values, strict=True))
            case ast.BinOp(left=left, op=ast.Add() | ast.BitOr(), right=right):
                return held(left) or held(right)
            case ast.ListComp() | ast.SetComp() | ast.GeneratorExp() | ast.DictComp():
                return all(held(each.iter) and not each.ifs for each in items.generators)
            case ast.Name(id=name):
                return self._name_holds_something(name)
            case ast.Call(func=ast.Attribute(value=owner, attr="items" | "values" | "keys")):
                return held(owner)
            case ast.Call():
                return self._call_holds_something(items)
        return False

    def _call_holds_something(self, call: ast.Call) -> bool:
        name, given = _called(call), [self.holds_something(x) for x in call.args]
        if name == "range":
            with suppress(ValueError):  # of what is no number
                return len(range(*map(ast.literal_eval, call.args))) > 0
        if name in ALIKE:
            return bool(given) and given[-1]
        strict = any(option.arg == "strict" and ast.unparse(option.value) == "True" for option in call.keywords)
        if name in ("zip", "product"):
            return any(given) if strict else bool(given) and all(given)
        return name in ("some", "exactly") or (name == "chain" and any(given))

    def _name_holds_something(self, name: str) -> bool:
        """A name holds what it is assigned, in the function, in the file, or in the file it comes from.

        What Hypothesis draws is empty at times, and at others it is not.
        """
        if self.function is not None:
            if inner := list(_assigned(ast.walk(self.function), name)):
                return all(map(self.holds_something, inner))
            if any(argument.arg == name for argument in self.function.args.args):
                return any(_called(each) == "given" for each in self.function.decorator_list)
        outside = _Reading(self.root, self.tree, None)
        if outer := list(_assigned(iter(self.tree.body), name)):
            return all(map(outside.holds_something, outer))
        for node in self.tree.body:
            for alias in node.names if isinstance(node, ast.ImportFrom) else ():
                home = self.root.joinpath(*(getattr(node, "module", None) or "").split(".")).with_suffix(".py")
                if (alias.asname or alias.name) == name and home.exists():
                    return _Reading(self.root, parsed(home), None).holds_something(ast.Name(alias.name))
        return False


def _called(node: ast.expr) -> str | None:
    if not isinstance(node, ast.Call):
        return None
    return node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", None)


def _assigned(nodes: Iterator[ast.AST], name: str) -> Iterator[ast.expr]:
    for node in nodes:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        value = getattr(node, "value", None)
        if value and any(isinstance(target, ast.Name) and target.id == name for target in targets):
            yield value
