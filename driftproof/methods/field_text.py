"""Right-hand sides as users write them, "y1; -sin(y0)" or a table of TOML, made a `VectorField`, exactly."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.methods import expression_tree as tree
from driftproof.methods.expression_tree import ExpressionError
from driftproof.methods.expressions import parse_number
from driftproof.methods.number_field import Exact, ends_of
from driftproof.methods.schemes import MethodError
from driftproof.methods.vector_fields import FUNCTIONS, VectorField
from driftproof.support.toml_tables import (
    TomlTable,
    as_list,
    as_table,
    as_text,
    as_texts,
    demand_keys,
    quoted,
    read_toml,
)

# A power of a power of a sum is written out as products, which no published right-hand side makes as long as this.
LONGEST_RATE = 100_000
# What a file may say of a problem, in bytes, and by which keys; a right-hand side needs the first two of them.
LONGEST_PROBLEM = 100_000
PROBLEM_KEYS = ("rates", "parameters", "function", "title", "start", "end", "energy")


class _Pi:
    """π as a number of rates: a call encloses it at Arb's precision, and float() is its nearest double."""

    def __call__(self) -> Any:
        from flint import arb

        return arb.pi()

    def __float__(self) -> float:
        return math.pi  # the nearest double: CPython's literal has 36 digits

    def __str__(self) -> str:
        return "pi"

    def enclosure(self, bits: int) -> tuple[Fraction, Fraction]:
        """Two rationals around it, the nearer to each other the more bits."""
        from flint import ctx

        with ctx.workprec(bits):
            return ends_of(self())


# No element of a number field, and yet exact: fields take it where they take those.
PI: Any = _Pi()
_WORD = re.compile(r"[A-Za-z_]\w*")
_FACTOR = re.compile(r"(?<![A-Za-z_])(?:y[0-9]*\b|[A-Za-z_]\w*+(?! *\())")


def field_of_text(
    rates: str | Sequence[str], parameters: Mapping[str, Exact] | None = None, names: Mapping[str, str] | None = None
) -> VectorField:
    """y' = f(t, y) of one text a component, or of one text parted by ";": in t, y0, y1, ..., pi and the parameters.

    `names` are other names of t, y0, y1, ...; a single component is also called y. Numbers are exact, 0.1 being 1/10;
    powers by whole numbers and by halves are taken. Raises ValueError, in one line.

    >>> field_of_text("y1; -0.5 * y0^2").rates
    ('y1', '-(1 / 2) * (y0 * y0)')
    """
    texts, known = rates.split(";") if isinstance(rates, str) else list(rates), dict(parameters or {})
    spelled = {name: name for name in known} | dict(names or _names(texts, known))
    written = tuple(rate_of_text(text, spelled) for text in texts)
    if any("pi" in _WORD.findall(text) for text in written):
        known.setdefault("pi", PI)
    return VectorField(written, tuple(known.items()))


def _names(rates: Sequence[str] | Mapping[str, str], parameters: Mapping[str, Any]) -> dict[str, str]:
    """What stands for the names of the unknowns: those that the rates have, and y where there is one."""
    if isinstance(rates, Mapping):
        return {name: f"y{i}" for i, name in enumerate(rates)}
    return {"y": "y0"} if len(rates) == 1 and "y" not in parameters else {}


def rate_of_text(text: str, names: Mapping[str, str] | None = None) -> str:
    """The expression as a `VectorField` takes it, with other names: no decimals, no powers. Raises ExpressionError."""
    writer = _Writer(text, names or {})
    return writer.bare_text(writer.tree())


def field_of_file(path: str | Path) -> VectorField:
    """The field of a .toml file, whose other keys are those of a problem. Raises ValueError in one line."""

    def read(table: TomlTable) -> VectorField:
        demand_keys(table, PROBLEM_KEYS, "a right-hand side")
        return field_of_table(table)

    return read_toml(path, LONGEST_PROBLEM, read)


def field_of_table(table: TomlTable) -> VectorField:
    """The `rates` and `parameters` of a table of TOML, with a name for each unknown or a list for y0, y1, ...

    A parameter is a number, one as text, "sqrt(2)" say, or an expression in pi and those before it, "2*pi*f", which is
    set in its place. Where only the `energy` reads pi, it is a parameter, too.
    """
    parameters, names = _parameters(table)
    rates = _rates(table)
    try:
        field = field_of_text(rates if isinstance(rates, list) else [*rates.values()], parameters, names)
    except MethodError as error:
        raise MethodError(f"{error}; names of your own: rates.x = ..., start.x = ..., parameters.k = ...") from None
    if "pi" in _WORD.findall(energy_of_table(table) or "") and "pi" not in dict(field.parameters):
        return VectorField(field.rates, (*field.parameters, ("pi", PI)))
    return field


def energy_of_table(table: TomlTable) -> str | None:
    """The `energy` of a table of TOML, written as its rates are; None where it has none."""
    return rate_of_text(as_text(table["energy"], "energy"), _parameters(table)[1]) if "energy" in table else None


def start_of_table(table: TomlTable) -> list[Any]:
    """The `start` of a table of TOML: a list, one number, or a number for each name that its rates have."""
    start, rates = table.get("start"), table.get("rates")
    if isinstance(start, dict):
        if not isinstance(rates, dict) or set(start) != set(rates):
            raise ValueError(f"start has the names {', '.join(start)}; rates have to have the same")
        return [start[name] for name in rates]
    return [start] if isinstance(start, int | float | str) else as_list(start, "start")


def _rates(table: TomlTable) -> list[str] | dict[str, str]:
    """The texts of the rates; by the names of the unknowns where they have names."""
    rates = table.get("rates")
    if isinstance(rates, dict):
        return dict(zip(rates, as_texts([*rates.values()], "rates"), strict=True))
    return rates.split(";") if isinstance(rates, str) else [*as_texts(rates, "rates")]


def _parameters(table: TomlTable) -> tuple[dict[str, Exact], dict[str, str]]:
    """The parameters that are numbers, and what stands for the other names: y0, y1, ..., and expressions."""
    given = as_table(table.get("parameters", {}), "parameters")
    names = _names(_rates(table), given)
    for name in names:
        if not _WORD.fullmatch(name) or name in ("t", "pi", *FUNCTIONS, *given):
            raise ValueError(f"rates: {quoted(name)} is no name for an unknown, or is something else already")
    parameters: dict[str, Exact] = {}
    for name, value in given.items():
        try:
            parameters[name] = parse_number(str(value), f"parameters.{name}")
        except ValueError:
            if not {"pi", *FUNCTIONS, *parameters, *names}.issuperset(_WORD.findall(str(value))):
                raise
            names[name] = f"({rate_of_text(str(value), names)})"
    return parameters, names


class _Writer(tree.ExpressionParser):
    """Reads an expression, and writes it in sums, products and quotients of names and whole numbers."""

    what, example = "a right-hand side", "write a rate such as y1 or -sin(y0)"

    def __init__(self, text: str, names: Mapping[str, str]) -> None:
        """A name that `names` has is written as its value."""
        super().__init__(text)
        self.names, self.numbers = names, ("t", "pi", *names, *_FACTOR.findall(text))

    def bare_text(self, node: Any) -> str:
        """Without brackets around a chain."""
        return self._chain_text(node) if isinstance(node, tree.ChainNode) else self._text(node)

    def _chain_text(self, node: tree.ChainNode) -> str:
        parts = [self._text(node.first), *(f" {sign.text} {self._text(part)}" for sign, part in node.rest)]
        return self._short("".join(parts), node.column)

    def _text(self, node: Any) -> str:
        match node:
            case tree.NumberNode(value=value):
                return str(value.numerator) if value.denominator == 1 else f"({value.numerator} / {value.denominator})"
            case tree.NameNode(name=name):
                return self.names.get(name, str(name))
            case tree.NegatedNode(node=inner):
                return f"-{self._text(inner)}"
            case tree.ChainNode():
                return f"({self._chain_text(node)})"
            case tree.CallNode(function=name, arguments=(argument,)) if name in FUNCTIONS:
                return f"{name}({self.bare_text(argument)})"
            case tree.PowerNode():
                return self._power_text(node)
        known = ", ".join(FUNCTIONS)
        raise ExpressionError(self.text, node.column, f"there are the functions {known}, of one number")

    def _power_text(self, node: tree.PowerNode) -> str:
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
