"""The facts of a method as a TeX table, formulas in mathematics."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from driftproof.facts import VARIABLES, fact_text

Json = Any

DECIMALS_SHOWN = 10
# Our own exact numbers, written in SymPy's syntax, as TeX.
_NOTATION = (
    (re.compile(r"(\d+)\*\*\(1/(\d+)\)"), r"\\sqrt[\2]{\1}"),
    (re.compile(r"sqrt\((\d+)\)"), r"\\sqrt{\1}"),
    (re.compile(r"\*\*(\d+)"), r"^{\1}"),
    (re.compile(r"\*"), " "),
    (re.compile(r"\boo\b"), r"\\infty"),
)
_ESCAPED = str.maketrans({"_": r"\_", "^": r"\^{}", "#": r"\#", "&": r"\&", "%": r"\%", "τ": r"$\tau$"})


def facts_tex(facts: dict[str, Json]) -> str:
    """A tabular with one row per fact."""
    rows = [rf"  {name.replace('_', ' ')} & {_tex(name, value)} \\" for name, value in facts.items()]
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
    return f"({number}){factor}" if " " in coefficient else number + factor


def _power(variable: str, power: int) -> str:
    base, _, exponent = variable.partition("^")
    power *= int(exponent or 1)
    return "" if power == 0 else base if power == 1 else f"{base}^{{{power}}}"


def _tex(name: str, value: Json) -> str:
    if isinstance(value, dict) and "num" in value:
        top, bottom = (polynomial_tex(value[part], VARIABLES.get(name, "h")) for part in ("num", "den"))
        return f"${top}$" if bottom == "1" else rf"$\frac{{{top}}}{{{bottom}}}$"
    if isinstance(value, dict) and value.get("exact") and "decimal" in value:
        exact = number_tex(value["exact"])
        return (
            f"${exact}$"
            if value["decimal"] == value["exact"]
            else rf"${exact} \approx {value['decimal'][:DECIMALS_SHOWN]}$"
        )
    if isinstance(value, dict) and "power" in value:
        return f"${_term(value['coefficient'], _power('h', value['power']))}$"
    return fact_text(name, value).replace("**", "^").translate(_ESCAPED)
