"""The facts of a method as text: a rendering of the JSON that `symbolic.facts` gives."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from driftproof.text import table
from methods.catalogue import method_named
from methods.schemes import Method

Json = Any

# The variable in which each rational function is ascending; h where nothing is said.
VARIABLES = {"stability_function": "z", "order_reduction": "z", "energy_multiplier": "h^2"}
# A series or a list of trees longer than this is left to --format json.
MOST_SHOWN = 12


def method_of(name: str) -> Method:
    """The catalogue entry `name`, or the method in the TOML file `name` if it ends in .toml. Raises ValueError."""
    if name.endswith(".toml"):
        from methods.tableau_file import read_method

        return read_method(Path(name))
    return method_named(name)


def facts_text(facts: dict[str, Json]) -> str:
    """One line per fact: its name in words, its value."""
    return table([[name.replace("_", " "), fact_text(name, value)] for name, value in facts.items()])


def fact_text(name: str, value: Json) -> str:
    """One fact in one line."""
    if value is None or isinstance(value, bool):
        return {None: "none", True: "yes", False: "no"}[value]
    if isinstance(value, dict):
        return _dictionary(name, value)
    if isinstance(value, list):
        return _list(name, value)
    return str(value)


def _dictionary(name: str, value: dict[str, Json]) -> str:
    if not value:
        return "none"
    if "num" in value:
        return rational_function(value, VARIABLES.get(name, "h"))
    if "minpoly" in value and "decimal" in value:
        exact = value["exact"] or f"the root of {value['minpoly']} in ({', '.join(value['interval'])})"
        return f"{exact} = {value['decimal']}" if exact != value["decimal"] else exact
    if "power" in value and "coefficient" in value:
        return f"{value['coefficient']} h^{value['power']}"
    shown = [f"{key}: {fact_text(name, part)}" for key, part in list(value.items())[:MOST_SHOWN]]
    more = f", and {len(value) - MOST_SHOWN} more" if len(value) > MOST_SHOWN else ""
    return ", ".join(shown) + more


def _list(name: str, value: list[Json]) -> str:
    if all(isinstance(x, str) for x in value):
        return polynomial(value, VARIABLES.get(name, "h")) if name.endswith(("series", "rate")) else ", ".join(value)
    return "; ".join(fact_text(name, x) for x in value) or "none"


def polynomial(ascending: Sequence[str], variable: str) -> str:
    """1 - 1/2 h^2 + ..., from coefficients as text, constant first; terms that are zero are left out."""
    text = ""
    for power, coefficient in enumerate(ascending):
        if coefficient != "0":
            term, negative = _term(coefficient, power, variable)
            sign = ("-" if negative else "") if not text else (" - " if negative else " + ")
            text += sign + term
    return text or "0"


def rational_function(value: dict[str, Sequence[str]], variable: str) -> str:
    """(numerator)/(denominator), without the denominator where it is 1."""
    numerator = polynomial(value["num"], variable)
    return numerator if value["den"] == ["1"] else f"({numerator})/({polynomial(value['den'], variable)})"


def _term(coefficient: str, power: int, variable: str) -> tuple[str, bool]:
    """The term without its sign, and whether it is negative; sums in a number field stay in brackets."""
    simple = " " not in coefficient
    negative = simple and coefficient.startswith("-")
    size = coefficient.removeprefix("-") if simple else f"({coefficient})"
    if power == 0:
        return size, negative
    factor = _power(variable, power)
    return (factor if size == "1" else f"{size} {factor}"), negative


def _power(variable: str, power: int) -> str:
    base, _, exponent = variable.partition("^")
    power *= int(exponent or 1)
    return base if power == 1 else f"{base}^{power}"
