"""The matrix of derivatives of a field, as text of the same kind, in which only zeros and ones are simplified."""

from __future__ import annotations

import ast
from collections.abc import Callable

from driftproof.methods.fields import Field

Rows = tuple[tuple[str, ...], ...]


def jacobian(field: Field) -> Rows:
    """df_i/dy_j of y' = f(t, y), row i and column j: texts in t, y0, y1, ... and the names of the parameters."""
    return tuple(tuple(derivative(rate, name) for name in field.components) for rate in field.rates)


def derivative(expression: str, name: str) -> str:
    """The derivative of a rate of a `Field` with respect to one of its names, the others held fixed."""
    return ast.unparse(_derivative(ast.parse(expression, mode="eval").body, name))


ZERO, ONE = ast.Constant(0), ast.Constant(1)


def _derivative(x: ast.expr, name: str) -> ast.expr:
    if isinstance(x, ast.Name):
        return ONE if x.id == name else ZERO
    if isinstance(x, ast.UnaryOp):
        return _negative(_derivative(x.operand, name))
    if isinstance(x, ast.BinOp):
        return _OF_OPERATION[type(x.op)](x.left, x.right, _derivative(x.left, name), _derivative(x.right, name))
    if isinstance(x, ast.Call) and isinstance(x.func, ast.Name):
        inner = _derivative(x.args[0], name)
        return ZERO if _is(inner, 0) else _product(_OF_FUNCTION[x.func.id](x.args[0]), inner)
    return ZERO


def _is(x: ast.expr, value: int) -> bool:
    return isinstance(x, ast.Constant) and x.value == value


def _sum(a: ast.expr, b: ast.expr) -> ast.expr:
    return b if _is(a, 0) else a if _is(b, 0) else ast.BinOp(a, ast.Add(), b)


def _difference(a: ast.expr, b: ast.expr) -> ast.expr:
    return _negative(b) if _is(a, 0) else a if _is(b, 0) else ast.BinOp(a, ast.Sub(), b)


def _product(a: ast.expr, b: ast.expr) -> ast.expr:
    if _is(a, 0) or _is(b, 0):
        return ZERO
    return b if _is(a, 1) else a if _is(b, 1) else ast.BinOp(a, ast.Mult(), b)


def _quotient(a: ast.expr, b: ast.expr) -> ast.expr:
    return ZERO if _is(a, 0) else ast.BinOp(a, ast.Div(), b)


def _negative(a: ast.expr) -> ast.expr:
    return ZERO if _is(a, 0) else ast.UnaryOp(ast.USub(), a)


def _call(function: str, x: ast.expr) -> ast.expr:
    return ast.Call(ast.Name(function, ast.Load()), [x], [])


# (a, b, a', b') -> the derivative of a op b.
_OF_OPERATION: dict[type[ast.operator], Callable[[ast.expr, ast.expr, ast.expr, ast.expr], ast.expr]] = {
    ast.Add: lambda a, b, da, db: _sum(da, db),
    ast.Sub: lambda a, b, da, db: _difference(da, db),
    ast.Mult: lambda a, b, da, db: _sum(_product(da, b), _product(a, db)),
    # a'/b - (a/b)(b'/b): no square, which would overflow where the quotient does not.
    ast.Div: lambda a, b, da, db: _difference(_quotient(da, b), _product(_quotient(a, b), _quotient(db, b))),
}
_OF_FUNCTION: dict[str, Callable[[ast.expr], ast.expr]] = {
    "sin": lambda x: _call("cos", x),
    "cos": lambda x: _negative(_call("sin", x)),
    "exp": lambda x: _call("exp", x),
    "log": lambda x: _quotient(ONE, x),
    "sqrt": lambda x: _quotient(ONE, _product(ast.Constant(2), _call("sqrt", x))),
}
