"""The rates of a field and their derivatives as functions of any kind of numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from driftproof.methods.formulas.vector_fields import VectorField, partial_derivative
from driftproof.methods.programs.program_text import indented, maker, maker_text

Numbers = Sequence[Any]


def rate(
    field: VectorField, lift: Callable[[Fraction], Any], functions: Mapping[str, Callable[..., Any]] | None = None
) -> Callable[[Any, Numbers], list[Any]]:
    """f(t, y), the parameters made numbers by `lift`."""
    return _made(field, f"[{', '.join(field.rates)}]", lift, functions)


def derivative(
    field: VectorField, lift: Callable[[Fraction], Any], functions: Mapping[str, Callable[..., Any]] | None = None
) -> Callable[[Any, Numbers], list[list[Any]]]:
    """The matrix of derivatives at (t, y), row by row. An entry that is a whole number stays an int."""
    rows = [[partial_derivative(rate, name) for name in field.components] for rate in field.rates]
    answer = ", ".join(f"[{', '.join(row)}]" for row in rows)
    return _made(field, f"[{answer}]", lift, functions)


def _made(field: VectorField, answer: str, lift: Callable[[Fraction], Any], functions: Any) -> Any:
    names = [name for name, _ in field.parameters]
    body = [f"{''.join(f'{y}, ' for y in field.components)}= y", f"return {answer}"]
    make = maker(maker_text(names, "f", ["def f(t, y):", *indented(body)]), "field", functions)
    return make(*(lift(value) for _, value in field.parameters))
