"""The facts of a method as text: a rendering of the JSON that `driftproof.symbolic.facts` gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from driftproof.methods.catalogue import method_named
from driftproof.methods.families import FAMILIES, Family
from driftproof.methods.schemes import Method
from driftproof.support.plain_text import table

Json = Any

# The variable in which each rational function is ascending; h where nothing is said.
VARIABLES = {"stability_function": "z", "function": "z", "modified_rate": "z", "energy_multiplier": "h^2"}
# A series or a list of trees longer than this is left to --format json.
MOST_SHOWN = 12


def method_of(name: str) -> Method:
    """The method `name`, or the one in the TOML file `name` if it ends in .toml. Raises ValueError, of a family too."""
    subject = subject_of(name)
    if isinstance(subject, Family):
        raise ValueError(f"{subject.key} is a family of methods, with {subject.parameter} free; one method is needed")
    return subject


def subject_of(name: str) -> Method | Family:
    """The method or the family `name`, or the one in the TOML file `name` if it ends in .toml. Raises ValueError."""
    if name.endswith(".toml"):
        from driftproof.methods.tableau_file import read_method

        return read_method(Path(name))
    return FAMILIES[name] if name in FAMILIES else method_named(name)


def facts_text(facts: dict[str, Json]) -> str:
    """One line per fact: its name in words, its value; a list of records or a matrix takes a line for each row."""
    rows = []
    for name, value in facts.items():
        lines = [fact_text(name, part) for part in value] if _is_long(value) else [fact_text(name, value)]
        labels = [name.replace("_", " "), *[""] * (len(lines) - 1)]
        rows += [[label, line] for label, line in zip(labels, lines, strict=True)]
    return table(rows)


def _is_long(value: Json) -> bool:
    return isinstance(value, list) and bool(value) and not isinstance(value[0], str)


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
    for keys, text in FORMS:
        if keys <= value.keys():
            return text(value)
    shown = [f"{key}: {fact_text(key, part)}" for key, part in list(value.items())[:MOST_SHOWN]]
    more = f", and {len(value) - MOST_SHOWN} more" if len(value) > MOST_SHOWN else ""
    return ", ".join(shown) + more


def _number(value: dict[str, Json]) -> str:
    """2*sqrt(2) = 2.828..., or the polynomial and the interval where there are no radicals."""
    place = f"the root of {value['minpoly']} in ({', '.join(value['interval'])})"
    exact = f"{value['generator']}, {place}" if "generator" in value else value["exact"] or place
    return f"{exact} = {value['decimal']}" if exact != value["decimal"] else exact


def _complex(value: dict[str, Json]) -> str:
    return value["exact"] or f"a root of {value['minpoly']} = {value['real']} + {value['imaginary']}*I"


def _leading_term(value: dict[str, Json]) -> str:
    coefficient = fact_text("coefficient", value["coefficient"])
    return f"({coefficient}) h^{value['power']}" if " " in coefficient else f"{coefficient} h^{value['power']}"


def _eigenvalue(value: dict[str, Json]) -> str:
    """The eigenvalue, how often it occurs, and for which h the powers of its part of the step stay bounded."""
    often = f", {value['multiplicity']} times" if value["multiplicity"] > 1 else ""
    block = f", Jordan block of size {value['largest_block']}" if value["largest_block"] > 1 else ""
    return f"{fact_text('value', value['value'])}{often}{block}: {_bound(value['limit'], value['attained'])}"


def _bound(limit: Json, attained: bool | None) -> str:
    if limit in ("0", "oo"):
        return "every h > 0" if limit == "oo" else "no h, however small"
    return f"h {'<=' if attained else '<'} {fact_text('limit', limit)}" if "refused" not in limit else limit["refused"]


def _piece(value: dict[str, Json]) -> str:
    """One piece of a limit as a function of a parameter."""
    if value["curve"] is None:
        return f"{fact_text('limit', value['limit'])} on {value['where']}"
    solved = value["formula"] or f"positive root {value['root']} of {value['curve']}"
    return f"{solved} on {value['where']}"


def _where(values: str) -> str:
    return "nowhere" if values == "empty" else f"on {values}"


def _boundary(value: dict[str, Json]) -> str:
    points = [f"{point['re']} + {point['im']}*I" for point in value["points"]]
    more = f", and {len(points) - MOST_SHOWN} more" if len(points) > MOST_SHOWN else ""
    return f"{', '.join(points[:MOST_SHOWN])}{more}; |error| < {value['radius']}, and the conjugates"


# A dictionary that has these keys is written so; the first that fits.
FORMS: tuple[tuple[set[str], Callable[[dict[str, Json]], str]], ...] = (
    ({"minpoly", "decimal"}, _number),
    ({"minpoly", "imaginary"}, _complex),
    ({"power", "coefficient"}, _leading_term),
    ({"set", "order"}, lambda value: f"{value['order']} {_where(value['set'])}"),
    ({"set"}, lambda value: str(value["set"])),
    ({"multiplicity", "limit"}, _eigenvalue),
    ({"where", "curve"}, _piece),
    ({"radius", "points"}, _boundary),
    ({"refused"}, lambda value: f"not decided: {value['refused']}"),
)


def _list(name: str, value: list[Json]) -> str:
    if not value:
        return "none"
    if name.endswith(("series", "rate")):
        variable = VARIABLES.get(name, "h")
        return f"{polynomial(value, variable)} + O({_power(variable, len(value))})"
    if all(isinstance(x, str) for x in value):
        return f"[{', '.join(value)}]"
    if any(isinstance(x, dict) and "num" in x for x in value):
        return f"[{', '.join(fact_text(name, x) for x in value)}]"
    return "; ".join(fact_text(name, x) for x in value)


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
