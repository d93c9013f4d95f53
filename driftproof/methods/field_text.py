"""Right-hand sides as users write them, "y1; -sin(y0)" or a table of TOML, made a `VectorField`, exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.methods.expression_tree import (
    CallNode,
    ChainNode,
    ExpressionError,
    ExpressionParser,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
)
from driftproof.methods.expressions import parse_number
from driftproof.methods.number_field import Exact
from driftproof.methods.vector_fields import FUNCTIONS, VectorField
from driftproof.support.toml_tables import TomlTable, as_table, as_texts, demand_keys, read_toml

# A power of a power of a sum is written out as products, which no published right-hand side makes as long as this.
LONGEST_RATE = 100_000
# What a file may say of a problem, in bytes, and by which keys; a right-hand side needs the first two of them.
LONGEST_PROBLEM = 100_000
PROBLEM_KEYS = ("rates", "parameters", "function", "title", "start", "end", "energy")


def field_of_text(rates: str | Sequence[str], parameters: Mapping[str, Exact] | None = None) -> VectorField:
    """y' = f(t, y) of one text a component, or of one text parted by ";": in t, y0, y1, ... and the parameters.

    Numbers are exact, 0.1 being 1/10; powers by whole numbers and by halves are taken. Raises ValueError, in one line.

    >>> field_of_text("y1; -0.5 * y0^2").rates
    ('y1', '-(1 / 2) * (y0 * y0)')
    """
    texts = rates.split(";") if isinstance(rates, str) else list(rates)
    return VectorField(tuple(rate_of_text(text) for text in texts), tuple((parameters or {}).items()))


def rate_of_text(text: str) -> str:
    """The expression as a `VectorField` takes it: no decimals, no powers. Raises ExpressionError."""
    return _Writer(text).written()


def field_of_file(path: str | Path) -> VectorField:
    """The field of a .toml file, whose other keys are those of a problem. Raises ValueError in one line."""

    def read(table: TomlTable) -> VectorField:
        demand_keys(table, PROBLEM_KEYS, "a right-hand side")
        return field_of_table(table)

    return read_toml(path, LONGEST_PROBLEM, read)


def field_of_table(table: TomlTable) -> VectorField:
    """The `rates` and `parameters` of a table of TOML; a parameter is a number as text, "sqrt(2)" say, or a number."""
    given = as_table(table.get("parameters", {}), "parameters")
    parameters = {name: parse_number(str(value), f"parameters.{name}") for name, value in given.items()}
    return field_of_text(as_texts(table.get("rates"), "rates"), parameters)


class _Writer(ExpressionParser):
    """Reads an expression, and writes it in sums, products and quotients of names and whole numbers."""

    what, example = "a right-hand side", "write a rate such as y1 or -sin(y0)"

    def written(self) -> str:
        """The whole expression."""
        tree = self.tree()
        if isinstance(tree, ChainNode):
            return self._chain_text(tree)
        return self._text(tree)

    def _chain_text(self, node: ChainNode) -> str:
        parts = [self._text(node.first), *(f" {sign.text} {self._text(part)}" for sign, part in node.rest)]
        return self._short("".join(parts), node.column)

    def _text(self, node: Any) -> str:
        match node:
            case NumberNode(value=value):
                return str(value.numerator) if value.denominator == 1 else f"({value.numerator} / {value.denominator})"
            case NameNode(name=name):
                return str(name)
            case NegatedNode(node=inner):
                return f"-{self._text(inner)}"
            case ChainNode():
                return f"({self._chain_text(node)})"
            case CallNode(function=name, arguments=(argument,)) if name in FUNCTIONS:
                inner = self._chain_text(argument) if isinstance(argument, ChainNode) else self._text(argument)
                return f"{name}({inner})"
            case CallNode():
                raise ExpressionError(
                    self.text, node.column, f"there are the functions {', '.join(FUNCTIONS)}, of one number"
                )
            case PowerNode():
                return self._power_text(node)
        raise AssertionError(node)

    def _power_text(self, node: PowerNode) -> str:
        whole, rest = divmod(abs(node.exponent), 1)
        if rest not in (0, Fraction(1, 2)):
            raise ExpressionError(self.text, node.column, "an exponent is a whole number, or half of one")
        base = self._text(node.base)
        base = f"({base})" if base.startswith("-") else base
        factors = [base] * int(whole) + ([f"sqrt({base})"] if rest else [])
        product = self._short(" * ".join(factors or ["1"]), node.column)
        return f"(1 / ({product}))" if node.exponent < 0 else f"({product})" if len(factors) > 1 else product

    def _short(self, text: str, column: int) -> str:
        if len(text) > LONGEST_RATE:
            raise ExpressionError(self.text, column, f"written out it has more than {LONGEST_RATE} characters")
        return text
