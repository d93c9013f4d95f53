"""Write the facts of a method as text or TeX: one writer per language over the types of facts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence, Sized
from fractions import Fraction
from itertools import groupby
from typing import Any

from driftproof.methods.numbers.number_field import Algebraic, NumberField
from driftproof.support.plain_text import table
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.algebra.polynomials import coefficients, polynomial
from driftproof.symbolic.algebra.radicals import radical_form, root_decimal
from driftproof.symbolic.algebra.rational_functions import RationalFunction, exact_text, fraction, sum_text
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.facts import Reduction
from driftproof.symbolic.family_facts import FamilyFunction, FamilyTerm, LimitPiece, OrderSet
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary
from driftproof.symbolic.linear.fact_values import ExactFunction, Formula, RegionBoundary, TruncatedSeries
from driftproof.symbolic.linear.families import DIGITS_OF_ENDS, Interval, ParameterSet
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.stability_limits import INFINITY, Infinity
from driftproof.symbolic.linear.systems import EigenvalueLimit
from driftproof.texts.writing.markup import TEX, formula
from driftproof.texts.writing.records import is_long, parts, record

# Entries shown of a list of trees or points; --format json has all.
MOST_ITEMS_SHOWN = 12
# Characters of a formula, and of a coefficient in it; digits of coefficients in a longer one, which JSON has exactly.
LONGEST_FORMULA, LONGEST_COEFFICIENT, COEFFICIENT_DIGITS = 400, 100, 17
# Characters of an exact formula in TeX, which is pasted rather than read.
LONGEST_TEX = 20_000
# Characters of a decimal beside an exact form in TeX.
DECIMALS_IN_TEX = 10
_ESCAPED = str.maketrans({"_": r"\_", "^": r"\^{}", "#": r"\#", "&": r"\&", "%": r"\%", "τ": r"$\tau$"})


def facts_text(facts: Mapping[str, Any]) -> str:
    """One line per fact with its name and value; a list or a matrix takes a line per entry or row."""
    rows = []
    for name, value in facts.items():
        listed = _joined(value) if _is_list(value) and value else [value]
        lines = [*map(fact_text, listed[:MOST_ITEMS_SHOWN]), *filter(None, [_more(listed).removeprefix(", ")])]
        labels = [name.replace("_", " "), *[""] * (len(lines) - 1)]
        rows += [[label, line] for label, line in zip(labels, lines, strict=True)]
    return table(rows)


def facts_tex(facts: Mapping[str, Any]) -> str:
    """A LaTeX tabular with one row per fact and formulas in mathematics."""
    rows = [rf"  {name.replace('_', ' ')} & {fact_tex(value)} \\" for name, value in facts.items()]
    return "\n".join([r"\begin{tabular}{ll}", *rows, r"\end{tabular}"])


def fact_text(value: Any) -> str:
    """A fact, or a part of one, as one line of text."""
    return _Text().of(value)


def fact_tex(value: Any) -> str:
    """A fact, or a part of one, as TeX: formulas between dollar signs, special characters in words escaped."""
    return _Tex().of(value)


def _is_list(value: object) -> bool:
    """True for a list or a plain tuple, not for a named tuple."""
    return isinstance(value, list | tuple) and not hasattr(value, "_fields")


class _Text:
    """A writer of facts as plain text; `_Tex` overrides the formatting of formulas, numbers and intervals."""

    def of(self, value: Any) -> str:
        for kinds, method in _BY_TYPE:
            if isinstance(value, kinds):
                return str(getattr(self, method)(value))
        if value is None or isinstance(value, bool):
            return {None: "none", True: "yes", False: "no"}[value]
        if _is_list(value):
            return self.items(value)
        found = parts(value)
        if found is None:
            return self.words(str(record(value)))
        shown = [f"{self.words(name)}: {self.of(part)}" for name, part in list(found.items())[:MOST_ITEMS_SHOWN]]
        return ", ".join(shown) + _more(found) or "none"

    def words(self, text: str) -> str:
        return text

    def reduction(self, value: Reduction) -> str:
        """The stages that count, and which facts are of the table and which of the method without the others."""
        table, method = (self.words(", ".join(names)) or "none" for names in value[1:])
        return f"stages that count: {value[0]}; of the table as written: {table}; of the irreducible method: {method}"

    def form(self, value: Any) -> str:
        """A formula in SymPy's syntax, or a value whose record is one."""
        return str(record(value))

    def scalar(self, value: Fraction | Algebraic | Infinity | Formula) -> str:
        """A number or a formula; a long number, or one by a root without radicals, with its decimal; or that alone."""
        if isinstance(value, Formula) and len(value.text) > LONGEST_FORMULA:
            return self.function(value.function) if value.function else f"a formula of {len(value.text)} characters"
        if isinstance(value, Algebraic) and not value.is_rational and value.field.name.isidentifier():
            return self.radicals(self.form(value), significant(value, COEFFICIENT_DIGITS))
        if not is_long(value):
            return self.form(value)
        exact, digits = record(value).values()
        if len(exact) > LONGEST_FORMULA:
            return self.about(f"a number of {len(exact)} characters", digits)
        return self.radicals(exact, digits)

    def math(self, text: str) -> str:
        return text

    def items(self, values: Sequence[Any]) -> str:
        """Numbers and functions as a list in brackets, other values separated by semicolons."""
        if any(map(is_long, values)):
            return self.math(f"[{', '.join(_coefficients(values))}]")
        entries = [self.of(x) for x in _joined(values)]
        if all(isinstance(x, Fraction | Algebraic | RationalFunction) for x in values):
            return f"[{', '.join(entries)}]" if values else "none"
        return "; ".join(entries)

    def number(self, value: RealRoot | NumberField) -> str:
        """2*sqrt(2) = 2.828..., or the polynomial and the interval if there are no radicals."""
        found = record(value)
        if isinstance(found, str):
            return self.form(found)
        if found.get("exact"):
            return self.radicals(found["exact"], found["decimal"])
        minimal = found["minpoly"]
        short = len(minimal) <= LONGEST_FORMULA
        root = f"the root of {self.form(minimal) if short else f'a polynomial of {len(minimal)} characters'}"
        place = f"{root} in {self.math('(' + ', '.join(found['interval']) + ')')}"
        place = f"{self.form(found['generator'])}, {place}" if "generator" in found else place
        return self.about(place, found["decimal"])

    def radicals(self, exact: str, digits: str) -> str:
        """The exact form and the decimal; the exact form alone if the decimal adds nothing."""
        return exact if _says_all(exact, digits) else f"{exact} = {digits}"

    def about(self, place: str, real: str, imaginary: str = "") -> str:
        """A number without an exact form: a description and its decimal, which comes first if the other is long."""
        digits = f"{real} + {imaginary}*I" if imaginary else real
        return f"{place} = {digits}" if len(place) <= LONGEST_COEFFICIENT else f"{digits}, {place}"

    def complex_number(self, value: Imaginary | Complex) -> str:
        found = record(value)
        if found["exact"]:
            return self.form(found["exact"])
        return self.about(f"a root of {self.form(found['minpoly'])}", found["real"], found["imaginary"])

    def function(self, value: RationalFunction | ExactFunction | FamilyFunction) -> str:
        """(numerator)/(denominator), or the numerator alone if the denominator is 1."""
        if isinstance(value, FamilyFunction):
            num, den = (_polynomial(_coefficients(row), "z") for row in value)
        else:
            known = value if isinstance(value, ExactFunction) else ExactFunction(value, "h")
            rows = (_coefficients(coefficients(p)) for p in (known.f.num, known.f.den))
            num, den = (_polynomial(row, known.variable, known.power) for row in rows)
        return num if den == "1" else f"({num})/({den})"

    def series(self, value: TruncatedSeries) -> str:
        """The known terms, and the order of the remainder."""
        known = _polynomial(_coefficients(value.coefficients), value.variable)
        return f"{known} + O({_power(value.variable, len(value.coefficients))})"

    def term(self, value: LeadingTerm | FamilyTerm) -> str:
        coefficient, power = self.of((parts(value) or {})["coefficient"]), _power("h", value.power)
        return f"({coefficient}) {power}" if " " in coefficient else f"{coefficient} {power}"

    def interval(self, value: Interval | ParameterSet) -> str:
        return str(value)

    def order_set(self, value: OrderSet) -> str:
        return f"{value.order} on {self.of(value.values)}" if value.values.intervals else f"{value.order} nowhere"

    def piece(self, value: LimitPiece) -> str:
        found = self.of(value.limit)
        if value.curve is not None:
            found = f"positive root {value.root} of {self.form(value.curve)}"
            found = self.form(value.formula) if value.formula else found
        return f"{found} on {self.of(value.where)}"

    def eigenvalue(self, value: EigenvalueLimit) -> str:
        """The eigenvalue, its multiplicity, its block, and the h for which the powers of its part stay bounded."""
        eigenvalue, bound = value
        often = f", {eigenvalue.multiplicity} times" if eigenvalue.multiplicity > 1 else ""
        block = f", Jordan block of size {eigenvalue.block}" if eigenvalue.block > 1 else ""
        if isinstance(bound, Exception):
            until = self.words(str(bound))
        elif bound.limit in (ZERO_ROOT, INFINITY):
            until = "no h, however small" if bound.limit == ZERO_ROOT else f"every {self.math('h > 0')}"
        else:
            until = f"{self.below(bound.attained)} {self.of(bound.limit)}"
        return f"{self.of(eigenvalue.place)}{often}{block}: {until}"

    def below(self, attained: bool | None) -> str:
        """The left side and the relation of h <= limit."""
        return f"h {'<=' if attained else '<'}"

    def boundary(self, value: RegionBoundary) -> str:
        points = [f"{re} + {im}*I" for _, re, im in value.points[:MOST_ITEMS_SHOWN]]
        error = f"|error| < {record(value)['radius']}"
        return f"{', '.join(points)}{_more(value.points)}; {error}, and the conjugates"

    def undecided(self, value: Exception) -> str:
        return self.words(f"not decided: {value}")


class _Tex(_Text):
    def words(self, text: str) -> str:
        return text.replace("**", "^").translate(_ESCAPED)

    def form(self, value: Any) -> str:
        return f"${formula(record(value), TEX)}$"

    def math(self, text: str) -> str:
        return f"${text}$"

    def scalar(self, value: Fraction | Algebraic | Infinity | Formula) -> str:
        return super().scalar(value) if is_long(value) else self.form(value)

    def items(self, values: Sequence[Any]) -> str:
        if not any(map(_is_list, values)):
            return super().items(values)
        rows = r" \\ ".join(" & ".join(self.of(x).strip("$") for x in row) for row in values)
        return rf"$\begin{{pmatrix}}{rows}\end{{pmatrix}}$"

    def radicals(self, exact: str, digits: str) -> str:
        approximately = rf"${formula(exact, TEX)} \approx {_cut(digits)}$"
        return self.form(exact) if _says_all(exact, digits) else approximately

    def about(self, place: str, real: str, imaginary: str = "") -> str:
        digits = f"{_cut(real)} + {_cut(imaginary)} I" if imaginary else _cut(real)
        return rf"{place}, $\approx {digits}$"

    def function(self, value: RationalFunction | ExactFunction | FamilyFunction) -> str:
        if isinstance(value, FamilyFunction):
            num, den = (_polynomial(row, "z", 1, ("*", "**")) for row in (record(value)["num"], record(value)["den"]))
            return self.form(num if den == "1" else f"({num})/({den})")
        exact = str(ExactFunction(value, "h") if isinstance(value, RationalFunction) else value)
        return self.form(exact) if len(exact) <= LONGEST_TEX else self.math(_in_tex(super().function(value)))

    def series(self, value: TruncatedSeries) -> str:
        if len(str(record(value))) > LONGEST_TEX:
            return self.math(_in_tex(super().series(value)))
        known = self.form(_polynomial(record(value), value.variable, 1, ("*", "**")))
        return f"{known[:-1]}+O({value.variable}^{{{len(value.coefficients)}}})$"

    def term(self, value: LeadingTerm | FamilyTerm) -> str:
        coefficient, power = (parts(value) or {})["coefficient"], _power("h", value.power, "**")
        if isinstance(coefficient, RealRoot):
            return f"{self.of(coefficient)} {self.form(power)}"
        if isinstance(value, FamilyTerm):
            return self.form(f"({value.coefficient})*{power}")
        return self.function(fraction(polynomial([*value.power * [0], value.coefficient])))

    def interval(self, value: Interval | ParameterSet) -> str:
        if isinstance(value, ParameterSet):
            union = r" \cup ".join(self.interval(interval).strip("$") for interval in value.intervals)
            return self.math(union or r"\emptyset")
        if value.low is not None and value.low == value.high:
            return self.math(rf"\{{{_end(value.low)}\}}")
        low = r"-\infty" if value.low is None else _end(value.low)
        high = r"\infty" if value.high is None else _end(value.high)
        return self.math(f"{'[' if value.low_closed else '('}{low}, {high}{']' if value.high_closed else ')'}")

    def below(self, attained: bool | None) -> str:
        return r"$h \leq$" if attained else "$h <$"


_BY_TYPE: tuple[tuple[Any, str], ...] = (
    (Fraction | Algebraic | Infinity | Formula, "scalar"), (RealRoot | NumberField, "number"),
    (Imaginary | Complex, "complex_number"), (RationalFunction | ExactFunction | FamilyFunction, "function"),
    (TruncatedSeries, "series"), (LeadingTerm | FamilyTerm, "term"), (Interval | ParameterSet, "interval"),
    (OrderSet, "order_set"), (LimitPiece, "piece"), (EigenvalueLimit, "eigenvalue"), (RegionBoundary, "boundary"),
    (Exception, "undecided"), (Reduction, "reduction"),
)  # fmt: skip


def _joined(values: Sequence[Any]) -> Sequence[Any]:
    """The values; of a limit that is the same on several intervals, which only poles divide, once for all of them."""
    if not all(isinstance(x, LimitPiece) for x in values):
        return values
    runs = [list(run) for _, run in groupby(values, key=lambda x: x[1:])]
    return [run[0]._replace(where=ParameterSet(tuple(x.where for x in run))) for run in runs]


def _more(found: Sized) -> str:
    """The remark about entries beyond the first MOST_ITEMS_SHOWN; "" if there are none."""
    more = len(found) - MOST_ITEMS_SHOWN
    return f", and {more} more (JSON has all)" if more > 0 else ""


def _coefficients(values: Sequence[Any]) -> list[str]:
    """The coefficients as text; if together or one alone they are too long, long ones as decimals that end in "..."."""
    exact = [exact_text(x) if isinstance(x, Fraction) else str(x) for x in values]
    if sum(map(len, exact)) <= LONGEST_FORMULA and all(len(x) <= LONGEST_COEFFICIENT for x in exact):
        return exact
    pairs = zip(exact, values, strict=True)
    return [f"{significant(x, COEFFICIENT_DIGITS)}..." if is_long(x) else text for text, x in pairs]


def _in_tex(text: str) -> str:
    """The text of a polynomial with decimal coefficients as TeX."""
    return re.sub(r"e(-?\d+)", r" \\cdot 10^{\1}", re.sub(r"\^(\d+)", r"^{\1}", text)).replace("...", r"\ldots ")


def _says_all(exact: str, digits: str) -> bool:
    """True if the decimal adds nothing to the exact form, as for a whole number."""
    return exact in (digits, digits.rstrip("0").rstrip("."))


def _cut(digits: str) -> str:
    """The first digits of a decimal as TeX, with its exponent if it has one."""
    mantissa, _, exponent = digits.partition("e")
    return mantissa[:DECIMALS_IN_TEX] + (rf" \cdot 10^{{{exponent}}}" if exponent else "")


def _end(root: RealRoot) -> str:
    radicals = radical_form(root)
    return rf"\approx {root_decimal(root, DIGITS_OF_ENDS)}" if radicals is None else formula(radicals, TEX)


def _polynomial(ascending: Sequence[str], variable: str, step: int = 1, signs: tuple[str, str] = (" ", "^")) -> str:
    """The polynomial 1 - 1/2 h^2 + ... in variable^step, from its coefficients as text, the constant first.

    `signs` are the signs of products and of powers; a coefficient that is a sum is put in brackets.
    """
    terms = []
    for power, coefficient in enumerate(ascending):
        size = f"({coefficient})" if " " in coefficient else coefficient
        monomial = _power(variable, step * power, signs[1])
        if power and coefficient in ("1", "-1"):
            terms.append(coefficient[:-1] + monomial)
        elif coefficient != "0":
            terms.append(f"{size}{signs[0]}{monomial}" if power else size)
    return sum_text(terms)


def _power(variable: str, power: int, sign: str = "^") -> str:
    return variable if power == 1 else f"{variable}{sign}{power}"
