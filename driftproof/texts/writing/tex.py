"""The facts of a method as a TeX table, formulas in mathematics."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import singledispatch
from typing import Any

from driftproof.methods.number_field import Algebraic, NumberField
from driftproof.symbolic.algebra.polynomials import polynomial as polynomial_of
from driftproof.symbolic.algebra.radicals import radical_form, root_decimal
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import RealRoot
from driftproof.symbolic.family_facts import FamilyFunction, FamilyTerm, OrderSet, Piece
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary
from driftproof.symbolic.linear.facts import ExactFunction, PowerSeries, RegionBoundary
from driftproof.symbolic.linear.families import DIGITS_SHOWN, Interval, ParameterSet
from driftproof.symbolic.linear.limits import Infinity
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent
from driftproof.symbolic.linear.systems import EigenvalueLimit
from driftproof.texts.writing.markup import TEX, formula
from driftproof.texts.writing.records import Formula, parts, record
from driftproof.texts.writing.text import MOST_SHOWN, fact_text, is_list, more, polynomial, power_text

# Of a decimal beside its exact form.
DECIMALS_SHOWN = 10
_ESCAPED = str.maketrans({"_": r"\_", "^": r"\^{}", "#": r"\#", "&": r"\&", "%": r"\%", "τ": r"$\tau$"})


def facts_tex(facts: Mapping[str, Any]) -> str:
    """A tabular with one row per fact."""
    rows = [rf"  {name.replace('_', ' ')} & {fact_tex(value)} \\" for name, value in facts.items()]
    return "\n".join([r"\begin{tabular}{ll}", *rows, r"\end{tabular}"])


@singledispatch
def fact_tex(value: Any) -> str:
    """One fact, or what facts consist of: formulas between dollar signs, words with TeX's own characters escaped."""
    if is_list(value) and value and is_list(value[0]):
        rows = r" \\ ".join(" & ".join(fact_tex(x).strip("$") for x in row) for row in value)
        return rf"$\begin{{pmatrix}}{rows}\end{{pmatrix}}$"
    if is_list(value) and value:
        return "; ".join(fact_tex(x) for x in value)
    found = None if isinstance(value, RegionBoundary) else parts(value)
    if not found:
        return fact_text(value).replace("**", "^").translate(_ESCAPED)
    shown = [f"{name.translate(_ESCAPED)}: {fact_tex(part)}" for name, part in list(found.items())[:MOST_SHOWN]]
    return ", ".join(shown) + more(found)


def _math(text: str) -> str:
    """A form in SymPy's syntax, between dollar signs."""
    return f"${formula(text, TEX)}$"


@fact_tex.register(Fraction | Algebraic | ExactFunction | Formula)
def _(value: Fraction | Algebraic | ExactFunction | Formula) -> str:
    return _math(str(value))


@fact_tex.register
def _(value: RationalFunction) -> str:
    return _math(str(ExactFunction(value, "h")))


@fact_tex.register
def _(value: Infinity) -> str:
    return _math(value.value)


@fact_tex.register
def _(value: FamilyFunction) -> str:
    num, den = (polynomial(record(value)[part], "z", 1, ("*", "**")) for part in ("num", "den"))
    return _math(f"({num})/({den})" if den != "1" else num)


@fact_tex.register
def _(value: PowerSeries) -> str:
    known = polynomial(record(value), value.variable, 1, ("*", "**"))
    return f"${formula(known, TEX)}+O({value.variable}^{{{len(value.coefficients)}}})$"


@fact_tex.register(LeadingTerm | FamilyTerm)
def _(value: LeadingTerm | FamilyTerm) -> str:
    coefficient = (parts(value) or {})["coefficient"]
    if isinstance(coefficient, RealRoot):
        return f"{fact_tex(coefficient)} {_math(power_text('h', value.power, '**'))}"
    if isinstance(value, FamilyTerm):
        return _math(f"({value.coefficient})*{power_text('h', value.power, '**')}")
    return fact_tex(fraction(polynomial_of([*value.power * [0], value.coefficient])))


@fact_tex.register(RealRoot | EnclosedTangent | NumberField)
def _(value: RealRoot | EnclosedTangent | NumberField) -> str:
    """In radicals, else by its polynomial; with the first digits."""
    found = record(value)
    if isinstance(found, str):
        return _math(found)
    digits, exact = found["decimal"], found.get("exact")
    if exact:
        short = exact in (digits, digits.rstrip("0").rstrip("."))
        return _math(exact) if short else rf"${formula(exact, TEX)} \approx {_digits(digits)}$"
    within = rf"in $({', '.join(found['interval'])})$, $\approx {_digits(digits)}$"
    root = f"the root of {_math(found['minpoly'])} {within}" if found["minpoly"] else f"a number {within}"
    return f"{_math(found['generator'])}, {root}" if "generator" in found else root


def _digits(text: str) -> str:
    """The first digits of a decimal, with its exponent if it has one."""
    mantissa, _, exponent = text.partition("e")
    power = rf" \cdot 10^{{{exponent}}}" if exponent else ""
    return mantissa[:DECIMALS_SHOWN] + power


@fact_tex.register(Imaginary | Complex)
def _(value: Imaginary | Complex) -> str:
    found = record(value)
    if found["exact"]:
        return _math(found["exact"])
    near = f"{_digits(found['real'])} + {_digits(found['imaginary'])} I"
    return f"the root of {_math(found['minpoly'])} near ${near}$"


@fact_tex.register
def _(value: Interval) -> str:
    if value.low is not None and value.low == value.high:
        return rf"$\{{{_end(value.low)}\}}$"
    low = r"-\infty" if value.low is None else _end(value.low)
    high = r"\infty" if value.high is None else _end(value.high)
    return f"${'[' if value.low_closed else '('}{low}, {high}{']' if value.high_closed else ')'}$"


def _end(root: RealRoot) -> str:
    radicals = radical_form(root)
    return rf"\approx {root_decimal(root, DIGITS_SHOWN)}" if radicals is None else formula(radicals, TEX)


@fact_tex.register
def _(value: ParameterSet) -> str:
    union = r" \cup ".join(fact_tex(interval).strip("$") for interval in value.intervals) or r"\emptyset"
    return f"${union}$"


@fact_tex.register
def _(value: OrderSet) -> str:
    return f"{value.order} on {fact_tex(value.values)}"


@fact_tex.register
def _(value: Piece) -> str:
    if value.curve is None:
        found = fact_tex(value.limit)
    else:
        found = _math(value.formula) if value.formula else f"positive root {value.root} of {_math(value.curve)}"
    return f"{found} on {fact_tex(value.where)}"


@fact_tex.register
def _(value: EigenvalueLimit) -> str:
    found = parts(value) or {}
    return f"{fact_tex(found['value'])}: limit {fact_tex(found['limit'])}"
