"""Exact numbers, functions of a parameter and linear systems from users' text, such as "1/4 - s3/6" or "0 1; -1 0"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.methods.formulas.expression_tree import (
    CallNode,
    ExpressionError,
    ExpressionNode,
    ExpressionParser,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
    Token,
)
from driftproof.methods.numbers.common_field import in_one_field, rational_power
from driftproof.methods.numbers.number_field import Algebraic, Exact, UndecidedError, cube_root, square_root
from driftproof.support.plain_text import shortened

# Bits of a number, chosen far above any published coefficient: a power of a power of a power would need gigabytes.
LARGEST_BITS = 20_000
# Coefficients of a function of a parameter, in its numerator and denominator together.
MOST_COEFFICIENTS = 100
_LARGEST_RADICAND = 10**40
RADICALS = {"sqrt": square_root, "cbrt": cube_root}
LARGEST_SYSTEM = 12

# The rows of A in z' = Az.
System: TypeAlias = tuple[tuple[Fraction, ...], ...]
# A Fraction, an element of a number field, or a function of a parameter: whatever the names stand for.
_Value: TypeAlias = Any


def parse_exact(text: str, roots: Mapping[str, Exact], what: str) -> Exact:
    """The exact number that `text` spells, in which the names of `roots` may occur.

    "0.1" is 1/10, and "(1 + s3)/2" lies in the field of s3. Raises ValueError in one line that begins with `what`.
    """
    known = f"declares: {', '.join(roots)}" if roots else "declares, which is nothing"
    words = f"is unknown; write integers, decimals, sqrt(n), cbrt(n), and what [roots] {known}"
    value: Exact = evaluate_expression(text, roots, what, words)
    return value


def parse_number(text: str, what: str) -> Exact:
    """The exact number that `text` spells without names, e.g. "1 - sqrt(2)/2". Raises ValueError in one line."""
    value: Exact = evaluate_expression(text, {}, what, "is a name; write numbers, sqrt(n) and cbrt(n)")
    return value


def parse_system(text: str) -> System:
    """The square matrix A that `text` spells, e.g. "0 1; -1 -1/10", rows separated by ";", entries by blanks or ",".

    An entry is an expression in rational numbers, such as -1/10, 0.1 or 2*(3+1); between commas it may have blanks.
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
    """Evaluate the expression in the exact arithmetic of the numbers or functions that `names` stand for.

    Raises ValueError in one line that begins with `what` and names the column; of another name it says `unknown`.
    """
    try:
        return _Evaluation(text, names, unknown).value(ExpressionParser(text).tree())
    except ExpressionError as error:
        raise ValueError(f"{what}: {error}") from None


@dataclass(frozen=True)
class _Evaluation:
    """The evaluation of a tree; it raises ExpressionError if a number becomes too large."""

    text: str
    names: Mapping[str, _Value]
    unknown: str

    def value(self, node: ExpressionNode) -> _Value:
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
        total = self.value(node.first)
        for sign, part in node.rest:
            total = self.combined(total, sign, self.value(part))
        return total

    def combined(self, a: _Value, sign: Token, b: _Value) -> _Value:
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
        """The value of a power: a fractional exponent needs a positive rational base."""
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
        name = node.function
        if name not in RADICALS:
            raise self.error(node.column, f"{shortened(name)!r} is not a function; use {' and '.join(RADICALS)}")
        match node.arguments:
            case (NumberNode(value=n),) if n.denominator == 1 and n < _LARGEST_RADICAND:
                try:
                    return RADICALS[name](int(n))
                except ValueError as error:
                    raise self.error(node.column, str(error)) from None
        raise self.error(node.column, f"{name} takes one integer above 0, as in {name}(2)")

    def small(self, value: _Value, column: int) -> _Value:
        """Return the value. Raises ExpressionError if it has too many coefficients, or too many bits in one."""
        parts = (value,) if isinstance(value, Fraction) else value.coefficients
        if len(parts) > MOST_COEFFICIENTS:
            raise self.error(column, "its degree in the parameter is too large")
        for part in parts:
            if part.numerator.bit_length() + part.denominator.bit_length() > LARGEST_BITS:
                raise self.error(column, "its numbers are too large")
        return value

    def error(self, column: int, reason: str) -> ExpressionError:
        return ExpressionError(self.text, column, reason)
