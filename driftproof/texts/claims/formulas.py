"""Decide whether two formulas are the same rational function, as 1 + h/2 and (2 + h)/2 are."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import comb
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from driftproof.methods import expression_tree as tree

# At most this many terms are written out; even facts of this package that are longer than a line need fewer.
_MOST_TERMS = 20_000
_GREEK = str.maketrans({"α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "θ": "theta", "λ": "lambda"})
_NAME = re.compile(r"(?<![\w.])[A-Za-z_][\w.]*")
_SUPERSCRIPT = re.compile(r"\^\{(-?[0-9]+)\}")
# An implied product: a number and a name, a bracket and its neighbour, or two names with a space between.
_SIDE_BY_SIDE = re.compile(
    r"(?<=[0-9)]) ?(?=[A-Za-z(])|(?<=[a-z]) (?=[A-Za-z(])|(?<=\)) ?(?=[0-9])|(?<![a-z])(?<=[a-z])(?=\()"
)


def same_formula(a: str, b: str) -> bool:
    """True if a = n₁/d₁ and b = n₂/d₂ are the same rational function: the polynomial n₁d₂ - n₂d₁ is exactly 0.

    b may have implied products, as on paper. Raises ValueError for another function and for too long a formula.
    """
    text = _SUPERSCRIPT.sub(r"^(\1)", b.translate(_GREEK))
    spelled = a, _SIDE_BY_SIDE.sub("*", text)
    try:
        formulas = [tree.parse_form(each) for each in spelled]
    except tree.ExpressionError as error:
        raise ValueError(f"{text[:60]!r} is not a formula: {error.reason}") from None
    names = sorted({name for each in spelled for name in _NAME.findall(each)})
    ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
    known = {name: (x, ring.constant(1)) for name, x in zip(names, ring.gens(), strict=True)}
    (n, d), (m, e) = (_ratio(formula, known, ring) for formula in formulas)
    _require_few(max(len(n) * len(e), len(m) * len(d)))
    return bool(d and e and n * e == m * d)


def _ratio(node: tree.ExpressionNode, known: Mapping[str, tuple[Any, Any]], ring: Any) -> tuple[Any, Any]:
    """Numerator and denominator, polynomials of the ring; nothing is divided. Raises ValueError if there are none."""
    match node:
        case tree.NumberNode(value=value):
            return ring.constant(fmpq(value.numerator, value.denominator)), ring.constant(1)
        case tree.NameNode(name=name):
            return known[name]
        case tree.NegatedNode(node=inner):
            num, den = _ratio(inner, known, ring)
            return -num, den
        case tree.PowerNode(base=base, exponent=exponent):
            if exponent.denominator > 1:
                raise ValueError("it contains a root; only rational functions are compared")
            num, den = _ratio(base, known, ring)
            n = abs(int(exponent))
            _require_few(comb(max(len(num), len(den), 1) + n - 1, n))
            return (num**n, den**n) if exponent >= 0 else (den**n, num**n)
        case tree.CallNode(function=function):
            raise ValueError(f"it contains {function}; only rational functions are compared")
    num, den = _ratio(node.first, known, ring)
    for sign, part in node.rest:
        a, b = _ratio(part, known, ring)
        _require_few(max(len(num), len(den)) * max(len(a), len(b)))
        if sign.text in "+-":
            num, den = num * b + a * den if sign.text == "+" else num * b - a * den, den * b
        else:
            num, den = (num * a, den * b) if sign.text == "*" else (num * b, den * a)
    return num, den


def _require_few(terms: int) -> None:
    if terms > _MOST_TERMS:
        raise ValueError(f"the formulas are too long to compare: {terms} terms")
