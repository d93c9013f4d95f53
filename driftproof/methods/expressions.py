"""Exact numbers, functions of a parameter and linear systems from users' text, such as "1/4 - s3/6" or "0 1; -1 0"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.methods.common_field import in_one_field, rational_power
from driftproof.methods.expression_tree import (
    CallNode,
    ChainNode,
    ExpressionError,
    ExpressionNode,
    ExpressionParser,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
    Token,
)
from driftproof.methods.number_field import Algebraic, Exact, UndecidedError, cube_root, square_root
from driftproof.support.plain_text import shortened

# A power of a power of a power would ask for gigabytes; no published coefficient comes near.
LARGEST_BITS = 20_000
# Of a function of a parameter: numerator and denominator together.
MOST_COEFFICIENTS = 100
_LARGEST_RADICAND = 10**40
RADICALS = {"sqrt": square_root, "cbrt": cube_root}
LARGEST_SYSTEM = 12

# The rows of A in z' = Az.
System: TypeAlias = tuple[tuple[Fraction, ...], ...]
# A Fraction, an element of a number field, or a function of a parameter: whatever the names stand for.
_Value: TypeAlias = Any


def parse_exact(text: str, roots: Mapping[str, Exact], what: str) -> Exact:
    """The number that `text` spells, `roots` being the names that may occur in it. Raises ValueError, in one line.

    The line begins with `what`. All operations are exact: "0.1" is 1/10, and "(1 + s3)/2" an element of s3's field.
    """
    known = f"declared in [roots]: {', '.join(roots)}" if roots else "nothing is declared in [roots]"
    value: Exact = evaluate_expression(text, roots, what, f"is an unknown root; {known}")
    return value


def parse_number(text: str, what: str) -> Exact:
    """The number that `text` spells without names, e.g. "1 - sqrt(2)/2". Raises ValueError, in one line."""
    value: Exact = evaluate_expression(text, {}, what, "is a name; write numbers, sqrt(n) and cbrt(n)")
    return value


def parse_system(text: str) -> System:
    """The square matrix A that `text` spells, e.g. "0 1; -1 -1/10": rows by ";", entries by blanks or by ",".

    An entry is an expression in rational numbers, such as -1/10, 0.1 or, between commas also with blanks, 2*(3 + 1).
    Raises ValueError in one line that names the place.
    """
    rows = [line.split(",") if "," in line else line.split() for line in text.strip().removesuffix(";").split(";")]
    if len(rows) > LARGEST_SYSTEM:
        raise ValueError(f"the system has {len(rows)} rows; at most {LARGEST_SYSTEM} are read")
    for i, row in enumerate(rows, 1):
        if len(row) != len(rows):
            raise ValueError(f"the system is not square: row {i} of {len(rows)} has {len(row)} entries")
    return tuple(tuple(_entry(x, f"row {i}, entry {j}") for j, x in enumerate(row, 1)) for i, row in enumerate(rows, 1))


def _entry(text: str, where: str) -> Fraction:
    value = parse_number(text, where)
    if not isinstance(value, Fraction):
        raise ValueError(f"{where}: {value} is irrational; the entries of a system are rational")
    return value


def evaluate_expression(text: str, names: Mapping[str, _Value], what: str, unknown: str) -> _Value:
    """The value of the expression, `names` standing for numbers or functions, by their own exact arithmetic.

    Raises ValueError in one line that begins with `what` and names the column; of another name it says `unknown`.
    """
    try:
        return _Evaluation(text, names, unknown).value(ExpressionParser(text).tree())
    except ExpressionError as error:
        raise ValueError(f"{what}: {error}") from None


@dataclass(frozen=True)
class _Evaluation:
    """The value of a tree whose numbers stay small."""

    text: str
    names: Mapping[str, _Value]
    unknown: str

    def value(self, node: ExpressionNode) -> _Value:
        """The value of a node and all below it."""
        match node:
            case NumberNode():
                return node.value
            case NameNode():
                if node.name not in self.names:
                    raise self.error(node.column, f"{shortened(node.name)!r} {self.unknown}")
                return self.names[node.name]
            case NegatedNode():
                return -self.value(node.node)
            case CallNode():
                return self.radical(node)
            case PowerNode():
                return self.power(node)
            case ChainNode():
                total = self.value(node.first)
                for sign, part in node.rest:
                    total = self.combined(total, sign, self.value(part))
                return total

    def combined(self, a: _Value, sign: Token, b: _Value) -> _Value:
        """a sign b."""
        if sign.text == "/" and not b:
            raise self.error(sign.column, "division by zero")
        try:
            if isinstance(a, Algebraic) and isinstance(b, Algebraic) and a.field != b.field:
                a, b = in_one_field([a, b])
            value = a + b if sign.text == "+" else a - b if sign.text == "-" else a * b if sign.text == "*" else a / b
        except TypeError:
            raise self.error(sign.column, "irrational numbers cannot be combined with a parameter") from None
        except UndecidedError as error:
            raise self.error(sign.column, str(error)) from None
        return self.small(value, sign.column)

    def power(self, node: PowerNode) -> _Value:
        """A base to a whole power, or a positive rational one to a fractional power."""
        base, n = self.value(node.base), int(node.exponent)
        if n != node.exponent:
            if not isinstance(base, Fraction):
                raise self.error(node.column, "only a positive rational number may have a fractional exponent")
            try:
                return self.small(rational_power(base, node.exponent), node.column)
            except ValueError as error:
                raise self.error(node.column, str(error)) from None
        if n < 0:
            if not base:
                raise self.error(node.column, "division by zero")
            base = 1 / base
        value: _Value = Fraction(1)
        for _ in range(abs(n)):
            value = self.small(value * base, node.column)
        return value

    def radical(self, node: CallNode) -> _Value:
        """A root of a whole number."""
        name = node.function
        if name not in RADICALS:
            raise self.error(node.column, f"{shortened(name)!r} is not a function; use {' and '.join(RADICALS)}")
        match node.arguments:
            case (NumberNode(value=n),) if n.denominator == 1 and n < _LARGEST_RADICAND:
                try:
                    return RADICALS[name](int(n))
                except ValueError as error:
                    raise self.error(node.column, str(error)) from None
        raise self.error(node.column, f"{name} takes one integer, as in {name}(2)")

    def small(self, value: _Value, column: int) -> _Value:
        """The value, unless its numbers have grown beyond all reason."""
        parts = (value,) if isinstance(value, Fraction) else value.coefficients
        if len(parts) > MOST_COEFFICIENTS:
            raise self.error(column, "its degree in the parameter is too large")
        for part in parts:
            if part.numerator.bit_length() + part.denominator.bit_length() > LARGEST_BITS:
                raise self.error(column, "its numbers are too large")
        return value

    def error(self, column: int, reason: str) -> ExpressionError:
        """The refusal at a column."""
        return ExpressionError(self.text, column, reason)
