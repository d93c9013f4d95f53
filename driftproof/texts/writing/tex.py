"""The facts of a method as a TeX table, formulas in mathematics."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from driftproof.texts.writing.facts import VARIABLES, fact_text

Json = Any

DECIMALS_SHOWN = 10
# Our own exact numbers, written in SymPy's syntax, as TeX.
_NOTATION = (
    (re.compile(r"(\d+)\*\*\(1/(\d+)\)"), r"\\sqrt[\2]{\1}"),
    (re.compile(r"sqrt\((\d+)\)"), r"\\sqrt{\1}"),
    (re.compile(r"\*\*(\d+)"), r"^{\1}"),
    (re.compile(r"\*"), " "),
    (re.compile(r"\boo\b"), r"\\infty"),
    (re.compile(r"\b(alpha|beta|gamma|delta|theta|lambda|mu|omega|sigma|tau)\b"), r"\\\1"),
)
_SETS = (("{", r"\{"), ("}", r"\}"), (" U ", r" \cup "), ("empty", r"\emptyset"), ("~", r"\approx "))
_ESCAPED = str.maketrans({"_": r"\_", "^": r"\^{}", "#": r"\#", "&": r"\&", "%": r"\%", "τ": r"$\tau$"})


def facts_tex(facts: dict[str, Json]) -> str:
    """A tabular with one row per fact."""
    rows = [rf"  {name.replace('_', ' ')} & {fact_tex(name, value)} \\" for name, value in facts.items()]
    return "\n".join([r"\begin{tabular}{ll}", *rows, r"\end{tabular}"])


def number_tex(text: str) -> str:
    """A rational as a fraction, an element of a number field by its roots: what stands between dollar signs."""
    try:
        x = Fraction(text)
    except ValueError:
        for pattern, replacement in _NOTATION:
            text = pattern.sub(replacement, text)
        return text
    sign = "-" if x < 0 else ""
    return f"{sign}{abs(x)}" if x.denominator == 1 else rf"{sign}\frac{{{abs(x.numerator)}}}{{{x.denominator}}}"


def polynomial_tex(ascending: Sequence[str], variable: str) -> str:
    """1-\\frac{1}{2}h^{2}+..., from coefficients as text, constant first; terms that are zero are left out."""
    text = ""
    for power, coefficient in enumerate(ascending):
        if coefficient != "0":
            term = _term(coefficient, _power(variable, power))
            text += term if not text or term.startswith("-") else f"+{term}"
    return text or "0"


def _term(coefficient: str, factor: str) -> str:
    number = number_tex(coefficient)
    if not factor:
        return number
    if coefficient in ("1", "-1"):
        return number[:-1] + factor
    if " " in coefficient:
        return f"({number}){factor}"
    return f"{number} {factor}" if number[-1].isalpha() else number + factor


def _power(variable: str, power: int) -> str:
    base, _, exponent = variable.partition("^")
    power *= int(exponent or 1)
    return "" if power == 0 else base if power == 1 else f"{base}^{{{power}}}"


def fact_tex(name: str, value: Json) -> str:
    """The value of one fact; what has no form of its own, as plain text with TeX's own characters escaped."""
    if value == "oo":
        return r"$\infty$"
    if isinstance(value, dict):
        for keys, tex in _FORMS:
            if keys <= value.keys():
                return tex(name, value)
    if isinstance(value, list) and value and isinstance(value[0], list):
        return f"${_matrix(name, value)}$"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "; ".join(fact_tex(name, part) for part in value)
    return fact_text(name, value).replace("**", "^").translate(_ESCAPED)


def _fraction(name: str, value: Json) -> str:
    top, bottom = (polynomial_tex(value[part], VARIABLES.get(name, "h")) for part in ("num", "den"))
    return top if bottom == "1" else rf"\frac{{{top}}}{{{bottom}}}"


def _matrix(name: str, rows: Json) -> str:
    cells = ((number_tex(x) if isinstance(x, str) else _fraction(name, x) for x in row) for row in rows)
    body = r" \\ ".join(" & ".join(row) for row in cells)
    return rf"\begin{{pmatrix}}{body}\end{{pmatrix}}"


def _number(_: str, value: Json) -> str:
    """In radicals, else by its polynomial; with the first digits."""
    decimal = value["decimal"]
    if not value.get("exact"):
        place = rf"the root of ${number_tex(value['minpoly'])}$ in $({', '.join(value['interval'])})$"
        if "generator" in value:
            place = f"${number_tex(value['generator'])}$, {place}"
        return rf"{place}, $\approx {_digits(decimal)}$"
    exact = number_tex(value["exact"])
    short = value["exact"] in (decimal, decimal.rstrip("0").rstrip("."))
    return f"${exact}$" if short else rf"${exact} \approx {_digits(decimal)}$"


def _digits(decimal: str) -> str:
    """The first digits of the decimal, with its exponent if it has one."""
    mantissa, _, exponent = decimal.partition("e")
    power = rf" \cdot 10^{{{exponent}}}" if exponent else ""
    return mantissa[:DECIMALS_SHOWN] + power


def _complex(_: str, value: Json) -> str:
    if value["exact"]:
        return f"${number_tex(value['exact'])}$"
    parts = f"{_digits(value['real'])} + {_digits(value['imaginary'])} I"
    return rf"the root of ${number_tex(value['minpoly'])}$ near ${parts}$"


def _leading_term(_: str, value: Json) -> str:
    coefficient, power = value["coefficient"], _power("h", value["power"])
    return f"${_term(coefficient, power)}$" if isinstance(coefficient, str) else f"{_number('', coefficient)} ${power}$"


def _set(values: str) -> str:
    for plain, tex in _SETS:
        values = values.replace(plain, tex)
    return number_tex(values)


def _piece(_: str, value: Json) -> str:
    """One piece of a limit as a function of a parameter."""
    if value["curve"] is None:
        found = fact_tex("", value["limit"])
    else:
        solved = f"${number_tex(value['formula'])}$" if value["formula"] else ""
        found = solved or f"positive root {value['root']} of ${number_tex(value['curve'])}$"
    return f"{found} on ${_set(value['where'])}$"


def _eigenvalue(_: str, value: Json) -> str:
    return f"{fact_tex('', value['value'])}: limit {fact_tex('', value['limit'])}"


_FORMS: tuple[tuple[set[str], Callable[[str, Json], str]], ...] = (
    ({"num"}, lambda name, value: f"${_fraction(name, value)}$"),
    ({"minpoly", "decimal"}, _number),
    ({"minpoly", "imaginary"}, _complex),
    ({"power", "coefficient"}, _leading_term),
    ({"set", "order"}, lambda _, value: f"{value['order']} on ${_set(value['set'])}$"),
    ({"set"}, lambda _, value: f"${_set(value['set'])}$"),
    ({"where", "curve"}, _piece),
    ({"multiplicity", "limit"}, _eigenvalue),
)
