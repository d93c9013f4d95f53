"""The notation of the tables, close to print: texts with rows of exact numbers, without zeros at the end of a row."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from driftproof.methods.formulas.expressions import parse_number
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta, Splitting


def row(text: str) -> tuple[Fraction, ...]:
    """The rational numbers of the text, separated by white space; "1/6", "0.1" and "2.5e-1" are exact."""
    return tuple(Fraction(word) for word in text.split())


def square(text: str) -> tuple[tuple[Exact, ...], ...]:
    """The square matrix with a row for each line of the text, filled up with zeros."""
    return padded(*(row(line) for line in text.strip().splitlines()))


def numbers(*values: Exact | int) -> tuple[Exact, ...]:
    """The values with integers converted to fractions, for rows that contain irrational numbers."""
    return tuple(Fraction(x) if isinstance(x, int) else x for x in values)


def padded(*rows: Sequence[Exact | int]) -> tuple[tuple[Exact, ...], ...]:
    """The square matrix with these rows, filled up with zeros."""
    return tuple(numbers(*given, *[0] * (len(rows) - len(given))) for given in rows)


def tableaux(text: str, *, decimal: bool = False) -> tuple[RungeKutta, ...]:
    """The methods of a text, separated by blank lines: each is a line of names, then the tableau as books print it.

        heun_euler21 | Heun-Euler 2(1) | 2(1) | hairer-norsett-wanner-1993, chapter II
        0 |
        1 | 1
          | 1/2 1/2
          | 1 0

    The names are the key, the title, the order with that of the embedded row in brackets, and the source. Rows are
    cᵢ | aᵢ₁ aᵢ₂ ..., without zeros at the end; then the weights and the embedded weights. Lines with # are comments.
    """
    lines = [line.strip() for line in text.splitlines() if not line.lstrip().startswith("#")]
    return tuple(_tableau(entry.splitlines(), decimal) for entry in "\n".join(lines).strip().split("\n\n"))


def heading(names: str) -> dict[str, Any]:
    """The fields in the line "key | title | order | source"; an order such as 4(3) is that of a pair."""
    key, title, orders, source = (" ".join(part.split()) for part in names.split(" | "))
    order, _, embedded = orders.removesuffix(")").partition("(")
    found = {"key": key, "title": title, "claimed_order": int(order), "source": source}
    return {**found, "embedded_order": int(embedded)} if embedded else found


def splitting(names: str, parts: tuple[tuple[str, Exact], ...], *, quadratic_kinetic: bool = False) -> Splitting:
    """The splitting with these parts, and with a line of names as in `tableaux`."""
    return Splitting(**heading(names), parts=parts, quadratic_kinetic=quadratic_kinetic)


def _tableau(lines: Sequence[str], decimal: bool) -> RungeKutta:
    nodes, rows = zip(*(map(exact_row, line.split("|")) for line in lines[1:]), strict=True)
    c = tuple(c for node in nodes for c in node)
    a, (b, *embedded) = padded(*rows[: len(c)]), rows[len(c) :]
    return RungeKutta(**heading(lines[0]), c=c, a=a, b=b, b_embedded=next(iter(embedded), None), decimal=decimal)


def exact_row(text: str) -> tuple[Exact, ...]:
    """The exact numbers of the text, separated by white space; they may contain roots, as in "1/2-sqrt(3)/6"."""
    return tuple(parse_number(word, "table") if "(" in word else Fraction(word) for word in text.split())
