"""The facts of a method as text: a line for each, or for each row of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from fractions import Fraction
from functools import singledispatch
from typing import Any

from driftproof.methods.number_field import Algebraic, NumberField
from driftproof.support.plain_text import table
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.family_facts import FamilyFunction, FamilyTerm, OrderSet, Piece
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary
from driftproof.symbolic.linear.facts import ExactFunction, PowerSeries, RegionBoundary
from driftproof.symbolic.linear.families import ParameterSet
from driftproof.symbolic.linear.limits import INFINITY
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent
from driftproof.symbolic.linear.systems import EigenvalueLimit
from driftproof.texts.writing.records import parts, record

# A list of trees or of points longer than this is left to --format json.
MOST_SHOWN = 12


def facts_text(facts: Mapping[str, Any]) -> str:
    """One line per fact: its name in words, its value; a list of records or a matrix takes a line for each row."""
    rows = []
    for name, value in facts.items():
        lines = [fact_text(part) for part in value] if is_list(value) and value else [fact_text(value)]
        labels = [name.replace("_", " "), *[""] * (len(lines) - 1)]
        rows += [[label, line] for label, line in zip(labels, lines, strict=True)]
    return table(rows)


def is_list(value: object) -> bool:
    """True for a list, and for a tuple whose entries have no names."""
    return isinstance(value, list | tuple) and not hasattr(value, "_fields")


@singledispatch
def fact_text(value: Any) -> str:
    """One fact, or what facts consist of, in one line."""
    if value is None or isinstance(value, bool):
        return {None: "none", True: "yes", False: "no"}[value]
    if is_list(value):
        return _row(value)
    found = parts(value)
    if found is None:
        return str(record(value))
    shown = [f"{name}: {fact_text(part)}" for name, part in list(found.items())[:MOST_SHOWN]]
    return ", ".join(shown) + more(found) or "none"


def more(found: Sized) -> str:
    """What follows the first MOST_SHOWN of these."""
    return f", and {len(found) - MOST_SHOWN} more" if len(found) > MOST_SHOWN else ""


def _row(values: Sequence[Any]) -> str:
    """Numbers and functions in brackets, other things one after the other."""
    entries = [fact_text(x) for x in values]
    if all(isinstance(x, Fraction | Algebraic | RationalFunction) for x in values):
        return f"[{', '.join(entries)}]" if values else "none"
    return "; ".join(entries)


@fact_text.register
def _(value: Exception) -> str:
    return f"not decided: {value}"


@fact_text.register(RealRoot | EnclosedTangent | NumberField)
def _(value: RealRoot | EnclosedTangent | NumberField) -> str:
    """2*sqrt(2) = 2.828..., or the polynomial and the interval where there are no radicals."""
    found = record(value)
    if isinstance(found, str):
        return found
    root = f"the root of {found['minpoly']}" if found["minpoly"] else "a number"
    exact = found.get("exact") or f"{root} in ({', '.join(found['interval'])})"
    if "generator" in found:
        exact = f"{found['generator']}, {exact}"
    return f"{exact} = {found['decimal']}" if exact != found["decimal"] else exact


@fact_text.register(Imaginary | Complex)
def _(value: Imaginary | Complex) -> str:
    found = record(value)
    return found["exact"] or f"a root of {found['minpoly']} = {found['real']} + {found['imaginary']}*I"


@fact_text.register(RationalFunction | ExactFunction | FamilyFunction)
def _(value: RationalFunction | ExactFunction | FamilyFunction) -> str:
    """(numerator)/(denominator), without the denominator where it is 1."""
    found = record(value)
    variable, step = "z" if isinstance(value, FamilyFunction) else "h", 1
    if isinstance(value, ExactFunction):
        variable, step = value.variable, value.power
    numerator, denominator = (polynomial(found[part], variable, step) for part in ("num", "den"))
    return numerator if denominator == "1" else f"({numerator})/({denominator})"


@fact_text.register
def _(value: PowerSeries) -> str:
    return f"{polynomial(record(value), value.variable)} + O({power_text(value.variable, len(value.coefficients))})"


@fact_text.register(LeadingTerm | FamilyTerm)
def _(value: LeadingTerm | FamilyTerm) -> str:
    coefficient, power = fact_text((parts(value) or {})["coefficient"]), power_text("h", value.power)
    return f"({coefficient}) {power}" if " " in coefficient else f"{coefficient} {power}"


@fact_text.register
def _(value: ParameterSet) -> str:
    return str(value)


@fact_text.register
def _(value: OrderSet) -> str:
    return f"{value.order} on {value.values}" if value.values.intervals else f"{value.order} nowhere"


@fact_text.register
def _(value: Piece) -> str:
    on_curve = value.formula or f"positive root {value.root} of {value.curve}"
    return f"{fact_text(value.limit) if value.curve is None else on_curve} on {value.where}"


@fact_text.register
def _(value: EigenvalueLimit) -> str:
    """The eigenvalue, how often it occurs, and for which h the powers of its part of the step stay bounded."""
    eigenvalue, bound = value
    often = f", {eigenvalue.multiplicity} times" if eigenvalue.multiplicity > 1 else ""
    block = f", Jordan block of size {eigenvalue.block}" if eigenvalue.block > 1 else ""
    if isinstance(bound, Exception):
        until = str(bound)
    elif bound.limit in (ZERO_ROOT, INFINITY):
        until = "no h, however small" if bound.limit == ZERO_ROOT else "every h > 0"
    else:
        until = f"h {'<=' if bound.attained else '<'} {fact_text(bound.limit)}"
    return f"{fact_text(eigenvalue.place)}{often}{block}: {until}"


@fact_text.register
def _(value: RegionBoundary) -> str:
    points = [f"{re} + {im}*I" for _, re, im in value.points[:MOST_SHOWN]]
    return f"{', '.join(points)}{more(value.points)}; |error| < {record(value)['radius']}, and the conjugates"


def polynomial(ascending: Sequence[str], variable: str, step: int = 1, signs: tuple[str, str] = (" ", "^")) -> str:
    """1 - 1/2 h^2 + ..., from coefficients of powers of variable^step as text, constant first, zeros left out.

    `signs` are written for a product and for a power; sums in a number field stand in brackets.
    """
    text = ""
    for power, coefficient in enumerate(ascending):
        if coefficient != "0":
            simple = " " not in coefficient
            negative = simple and coefficient.startswith("-")
            size = coefficient.removeprefix("-") if simple else f"({coefficient})"
            monomial = power_text(variable, step * power, signs[1])
            term = size if power == 0 else monomial if size == "1" else f"{size}{signs[0]}{monomial}"
            text += (f" {'-' if negative else '+'} " if text else "-" if negative else "") + term
    return text or "0"


def power_text(variable: str, power: int, sign: str = "^") -> str:
    """The power, e.g. "h^3"."""
    return variable if power == 1 else f"{variable}{sign}{power}"
