"""Decide whether two formulas are the same rational function, as 1 + h/2 and (2 + h)/2 are."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any

from driftproof.methods import expression_tree as tree

# At most this many points are compared; even facts of this package that are longer than a line need fewer.
_MOST_POINTS = 20_000
_GREEK = str.maketrans(
    {"α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "θ": "theta", "λ": "lambda", "·": "*", "×": "*"}
)
_SUPERSCRIPT = re.compile(r"\^\{(-?[0-9]+)\}")
# An implied product: a number and a name, a bracket and its neighbour, or two names with a space between.
_SIDE_BY_SIDE = re.compile(
    r"(?<=[0-9)]) ?(?=[A-Za-z(])|(?<=[a-z]) (?=[A-Za-z(])|(?<=\)) ?(?=[0-9])|(?<![a-z])(?<=[a-z])(?=\()"
)


def same_formula(a: str, b: str) -> bool:
    """True if a = n₁/d₁ and b = n₂/d₂ are the same rational function: the polynomial n₁d₂ - n₂d₁ is exactly 0.

    A polynomial of degree at most D in each name is 0 if it vanishes on a grid of D + 1 values of each. b may have
    implied products, as on paper. Raises ValueError for another function and for formulas that are too long.

    >>> same_formula("1 - h**6/72 + h**8/576", "(576 - 8h^6 + h^8)/576"), same_formula("1 + h**2", "1 + h^3")
    (True, False)
    """
    first, second = tree.parse_form(a), _parsed(b)
    names = sorted(_names(first) | _names(second))
    ranges = []
    for name in names:
        degrees = {each: _Degree(each == name) for each in names}
        (n, d), (m, e) = (_ratio(formula, degrees, lambda _: _Degree(0)) for formula in (first, second))
        ranges.append(range(int(max(n * e, m * d)) + 1))
    if (count := prod(map(len, ranges))) > _MOST_POINTS:
        raise ValueError(f"the formulas are too long to compare: {count} points")
    defined = [False, False]
    for point in product(*ranges):
        values = dict(zip(names, map(Fraction, point), strict=True))
        (n, d), (m, e) = _ratio(first, values, Fraction), _ratio(second, values, Fraction)
        if n * e != m * d:
            return False
        defined = [defined[0] or d != 0, defined[1] or e != 0]
    return all(defined)


def _parsed(text: str) -> tree.ExpressionNode:
    text = _SUPERSCRIPT.sub(r"^(\1)", text.translate(_GREEK))
    try:
        return tree.parse_form(_SIDE_BY_SIDE.sub("*", text))
    except tree.ExpressionError as error:
        raise ValueError(f"{text[:60]!r} is not a formula: {error.reason}") from None


def _names(node: tree.ExpressionNode) -> set[str]:
    match node:
        case tree.NameNode(name=name):
            return {name}
        case tree.ChainNode(first=first, rest=rest):
            return _names(first).union(*(_names(part) for _, part in rest))
        case tree.NegatedNode(node=inner) | tree.PowerNode(base=inner):
            return _names(inner)
        case tree.CallNode(function=function):
            raise ValueError(f"it contains {function}; only rational functions are compared")
    return set()


class _Degree(int):
    """A degree bound with the arithmetic of polynomials: + and - take the maximum, * adds, ** multiplies."""

    def __add__(self, other: int) -> _Degree:
        return _Degree(max(self, other))

    __sub__ = __add__

    def __mul__(self, other: int) -> _Degree:
        return _Degree(int(self) + int(other))

    def __pow__(self, n: int) -> _Degree:  # type: ignore[override]
        return _Degree(int(self) * n)


def _ratio(node: tree.ExpressionNode, values: Mapping[str, Any], number: Callable[[Fraction], Any]) -> tuple[Any, Any]:
    """Numerator and denominator at `values`, without any division, so that degree bounds serve as values as well.

    A function call does not occur: `_names` has refused it. Raises ValueError for a root.
    """
    match node:
        case tree.NumberNode(value=value):
            return number(value), number(Fraction(1))
        case tree.NameNode(name=name):
            return values[name], number(Fraction(1))
        case tree.NegatedNode(node=inner):
            num, den = _ratio(inner, values, number)
            return number(Fraction(-1)) * num, den
        case tree.PowerNode(base=base, exponent=exponent):
            if exponent.denominator > 1:
                raise ValueError("it contains a root; only rational functions are compared")
            num, den = _ratio(base, values, number)
            n = abs(int(exponent))
            return (num**n, den**n) if exponent >= 0 else (den**n, num**n)
        case tree.ChainNode(first=first, rest=rest):
            num, den = _ratio(first, values, number)
            for sign, part in rest:
                a, b = _ratio(part, values, number)
                if sign.text in "+-":
                    num, den = num * b + a * den if sign.text == "+" else num * b - a * den, den * b
                else:
                    num, den = (num * a, den * b) if sign.text == "*" else (num * b, den * a)
            return num, den
    raise AssertionError(node)
