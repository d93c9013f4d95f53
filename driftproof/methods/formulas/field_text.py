"""Users' right-hand sides, as text such as "y1; -sin(y0)" or as a table of TOML, read exactly into a `VectorField`."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from typing import Any

from driftproof.methods.formulas import expression_tree as tree
from driftproof.methods.formulas.expression_tree import ExpressionError
from driftproof.methods.formulas.expressions import parse_number
from driftproof.methods.formulas.vector_fields import FLOOR, FUNCTIONS, VectorField
from driftproof.methods.numbers.flint_rationals import ends_of
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import MethodError
from driftproof.support.plain_text import did_you_mean
from driftproof.support.toml_tables import (
    TomlTable,
    as_list,
    as_table,
    as_text,
    as_texts,
    quoted,
)

# Characters of a rate, chosen far above any published one: a power of a power of a sum is written out as products.
LONGEST_RATE = 100_000
# The bytes and the keys that the file of a problem may have; a right-hand side needs only the first two keys.
LONGEST_PROBLEM = 100_000
PROBLEM_KEYS = ("rates", "parameters", "function", "title", "start", "end", "energy")


class _Pi:
    """π as a parameter of rates: a call returns a ball at Arb's current precision, and float() the nearest double."""

    def __call__(self) -> Any:
        from flint import arb

        return arb.pi()

    def __float__(self) -> float:
        return math.pi  # the nearest double: CPython's literal has 36 digits

    def __repr__(self) -> str:
        return "pi"

    def enclosure(self, bits: int) -> tuple[Fraction, Fraction]:
        """Rational lower and upper bounds of π, closer for more bits."""
        from flint import ctx

        with ctx.workprec(bits):
            return ends_of(self())


# Other functions, in terms of FUNCTIONS and of choices.
_WRITTEN = {
    "tan": "(sin({0}) / cos({0}))",
    "tanh": "(1 - 2 / (exp(2 * ({0})) + 1))",
    "ln": "log({0})",
    FLOOR: "floor({0})",
}
# Functions of a sign, as choices by which of two numbers is the greater: a difference is compared by its terms.
_OF_SIGN = {
    "sign": "(1 if {0} > {1} else -1 if {0} < {1} else 0)",
    "heaviside": "(1 if {0} >= {1} else 0)",
}
_OF_ONE = (*FUNCTIONS, *_WRITTEN, *_OF_SIGN)
_OF_TWO = {
    "max": "({0} if {0} > {1} else {1})",
    "min": "({0} if {0} < {1} else {1})",
    "mod": "({0} - floor(({0}) / ({1})) * ({1}))",
}
# Not an element of a number field, and yet exact: a `VectorField` takes it as a parameter like those.
PI: Any = _Pi()
_WORD = re.compile(r"[A-Za-z_]\w*")
# A comma between digits may be meant as a decimal comma.
_BETWEEN = re.compile(r";|(?<!\d),|,(?!\d)")
_EQUATION = re.compile(r"\s*([A-Za-z_]\w*)\s*'\s*=(.*)", re.DOTALL)
_SETTING = re.compile(r"\s*([A-Za-z_]\w*)\s*=([^=']+)")
# Factors before a derivative, as in L C x'' = -x and 2*x' = 1: letters, and numbers with their sign.
LEAD = r"(?:(?<![\w.'])(?:[0-9.]+ ?\*|[A-Za-z](?:_\w)? ?(?:\*|(?<= ))) ?)"
_SECOND = re.compile(rf"({LEAD}*)\b([^\W\d]\w*)(?:['′’]{{2}}|[″\"]) ?(?:\(t\))?(?= ?=)")
_FACTOR = re.compile(r"(?<![A-Za-z_])(?:y[0-9]*\b|[A-Za-z_]\w*+(?! *\())")


def field_of_text(
    rates: str | Sequence[str] | Mapping[str, str],
    parameters: Mapping[str, Exact] | None = None,
    names: Mapping[str, str] | None = None,
) -> VectorField:
    """The field y' = f(t, y) from a text for each component, or from one text with ";" or "," between components.

    A text is an expression in t, y0, y1, ..., pi and the parameters, or an equation x' = v with names of your own.
    `names` maps further names to such expressions; without it, a single component is also called y. Numbers are exact:
    0.1 is 1/10. Exponents are whole numbers or halves of them. Raises ValueError in one line.

    >>> field_of_text("y1; -0.5 * y0^2").rates, field_of_text("x' = v, v' = -x").rates
    (('y1', '-(1 / 2) * (y0 * y0)'), ('y1', '-y0'))
    """
    texts, known = _rates(rates) if isinstance(rates, str) else rates, dict(parameters or {})
    spelled = {name: name for name in known} | dict(names or _names(texts, known))
    unknowns = tuple(texts) if isinstance(texts, Mapping) else ()
    given = [*texts.values()] if isinstance(texts, Mapping) else [*texts]
    written = tuple(rate_of_text(text, spelled) for text in given)
    if any("pi" in _WORD.findall(text) for text in written):
        known.setdefault("pi", PI)
    try:
        return VectorField(written, tuple(known.items()), unknowns)
    except MethodError as error:
        raise MethodError(_in_own_words(str(error), given, written, unknowns)) from None


def _in_own_words(said: str, texts: Sequence[str], written: Sequence[str], unknowns: tuple[str, ...]) -> str:
    """What a `VectorField` refuses, with the text and the name of the rate in place of what was written for it."""
    for i, (text, rate) in enumerate(zip(texts, written, strict=True)):
        which, rest = unknowns[i] if unknowns else i, said.removeprefix(f"rate {i}, {rate!r}: ")
        if rest != said:
            return f"rate {which}, {quoted(text)}: {VectorField(('0',), (), unknowns).in_own_words(rest)}"
    return said


def _names(rates: Sequence[str] | Mapping[str, str], parameters: Mapping[str, Any]) -> dict[str, str]:
    """The components y0, y1, ... by the names of the unknowns: those of a table, or y if there is one component."""
    if isinstance(rates, Mapping):
        for name in rates:
            if not _WORD.fullmatch(name) or name in ("t", "pi", *FUNCTIONS, FLOOR, *parameters):
                raise ValueError(f"rates: {quoted(name)} cannot name an unknown: not a valid name, or already in use")
        return {name: f"y{i}" for i, name in enumerate(rates)}
    return {"y": "y0"} if len(rates) == 1 and "y" not in parameters else {}


def rate_of_text(text: str, names: Mapping[str, str] | None = None) -> str:
    """The expression as a `VectorField` takes it: names replaced, no decimals, no powers. Raises ExpressionError."""
    writer = _Writer(re.sub(r"\by\[(\d+)\]", r"y\1", text), names or {})  # y[1] as in Python
    return writer.bare_text(writer.tree())


def field_of_table(table: TomlTable) -> VectorField:
    """The field of a TOML table with `rates`, a list for y0, y1, ... or one for each named unknown, and `parameters`.

    A parameter is a number, a number as text such as "sqrt(2)", or an expression in pi and earlier parameters such as
    "2*pi*f", which is substituted for its name. pi becomes a parameter even if only the `energy` reads it.
    """
    parameters, names = _parameters(table)
    rates = _rates(table.get("rates"))
    try:
        field = field_of_text(rates, parameters, names)
    except ValueError as error:
        said, more, named = str(error), "", isinstance(rates, dict)
        for which, text in rates.items() if isinstance(rates, dict) else enumerate(rates):
            place, rest = f"rates.{which}" if named else f"rates[{which}]", said.removeprefix(f"rate {which}")
            if rest != said or (isinstance(error, ExpressionError) and error.text == text):
                said = place + (rest if rest != said else f", {said}")
                break
        if not named and (isinstance(error, MethodError) or "'" in "".join(map(str, rates))):
            more = "; for names of your own: rates.x = ..., start.x = ..., parameters.k = ..."
        raise MethodError(said + more) from None
    pi = "pi" in _WORD.findall(energy_of_table(table) or "") and "pi" not in dict(field.parameters)
    return VectorField(field.rates, (*field.parameters, *[("pi", PI)] * pi), field.unknowns)


def energy_of_table(table: TomlTable) -> str | None:
    """The `energy` of a TOML table in the notation of its rates; None if it has none."""
    return rate_of_text(as_text(table["energy"], "energy"), _parameters(table)[1]) if "energy" in table else None


def start_of_table(table: TomlTable) -> list[Any]:
    """The `start` of a TOML table: a list, one number, or a number for each name of its rates. Raises ValueError."""
    start, rates = table.get("start"), _rates(table.get("rates", []))
    if isinstance(start, dict):
        if not isinstance(rates, dict) or set(start) != set(rates):
            wanted = "a function takes a list" if "function" in table else "rates must have the same names"
            raise ValueError(f"start has the names {', '.join(start)}; {wanted}")
        return [start[name] for name in rates]
    return [start] if isinstance(start, int | float | str) else as_list(start, "start")


def unknowns_of_table(table: TomlTable) -> tuple[str, ...]:
    """The names that the rates of a TOML table give to y0, y1, ...; none if they are a list or a function's."""
    rates = _rates(table.get("rates", []))
    return tuple(rates) if isinstance(rates, dict) else ()


def _rates(given: object) -> list[str] | dict[str, str]:
    """The rates in a list or one text; by the names of the unknowns in a table, or if all are equations as x' = v.

    Among equations a number may be given a name, as in x' = -k x, k = 2.
    """
    if isinstance(given, str):
        texts = _apart(of_first_order(given))
        equations = {found[1]: found[2] for text in texts if (found := _EQUATION.fullmatch(text))}
        settings = {found[1]: found[2] for text in texts if equations and (found := _SETTING.fullmatch(text))}
        velocities = {f"d{name}" for _, name in _SECOND.findall(given)}  # stand behind all positions
        names = sorted(equations, key=velocities.__contains__)
        known = {name: f"({setting})" for name, setting in settings.items()}
        rates = {name: _WORD.sub(lambda word: known.get(word[0], word[0]), equations[name]) for name in names}
        return rates if len(rates) + len(settings) == len(texts) else texts
    if isinstance(given, dict):
        return dict(zip(given, as_texts([*given.values()], "rates"), strict=True))
    return [*as_texts(given, "rates")]


def _apart(text: str) -> list[str]:
    """The texts between semicolons and commas, but for commas in brackets, which are those of a function."""
    cuts = _BETWEEN.finditer(text)
    ends = [m.span() for m in cuts if m[0] == ";" or text.count("(", 0, m.start()) == text.count(")", 0, m.start())]
    return [text[a:b] for (_, a), (b, _) in pairwise([(0, 0), *ends, (len(text), len(text))])]


def of_first_order(text: str) -> str:
    """The text with each equation of second order as two: x'' = -x as x'=dx, dx' = -x, and x'(0) as dx(0)."""
    if of_second := "|".join({name for _, name in _SECOND.findall(text)}):
        text = re.sub(rf"\b({of_second})['′’](?!['′’])", r"d\1", text)
    return _SECOND.sub(r"\2'=d\2, \1d\2'", text)


def _parameters(table: TomlTable) -> tuple[dict[str, Exact], dict[str, str]]:
    """The parameters that are numbers, and the replacements of all other names: y0, y1, ... and expressions."""
    given = as_table(table.get("parameters", {}), "parameters")
    names = _names(_rates(table.get("rates")), given)
    parameters: dict[str, Exact] = {}
    for name, value in given.items():
        try:
            parameters[name] = parse_number(str(value), f"parameters.{name}")
        except ValueError:
            later = [each for each in _WORD.findall(str(value)) if each in given and each not in {*parameters, *names}]
            if later and later[0] != name:
                raise ValueError(f"parameters.{name}: {later[0]} has to stand before it") from None
            if not {"pi", *FUNCTIONS, *parameters, *names}.issuperset(_WORD.findall(str(value))):
                raise
            names[name] = f"({rate_of_text(str(value), names)})"
    return parameters, names


def choices_as_functions(rate: str) -> str:
    """A rate of a `VectorField` with sign, heaviside, max and min in place of the choices that they are written as.

    >>> choices_as_functions(rate_of_text("max(y0, 1) - sign(y0 - 2)"))
    'max(y0, 1) - sign(y0 - 2)'
    """
    return ast.unparse(_Shown().visit(ast.parse(rate, mode="eval")))


class _Shown(ast.NodeTransformer):
    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        self.generic_visit(node)
        match node:
            case ast.IfExp(test=ast.Compare(left=a, ops=[op], comparators=[b]), body=one, orelse=other):
                apart = a if ast.unparse(b) == "0" else ast.BinOp(a, ast.Sub(), b)
                said, sides = [ast.unparse(x) for x in (one, other)], [ast.unparse(x) for x in (a, b)]
                otherwise = f"-1 if {sides[0]} < {sides[1]} else 0"
                known = {("1", otherwise, "Gt"): "sign", ("1", "0", "GtE"): "heaviside"}
                if (name := known.get((said[0], said[1], type(op).__name__))) is not None:
                    return ast.Call(ast.Name(name, ast.Load()), [apart], [])
                if said in (sides, sides[::-1]):
                    largest = isinstance(op, ast.Gt | ast.GtE) == (said == sides)
                    return ast.Call(ast.Name("max" if largest else "min", ast.Load()), [one, other], [])
        return node


class _Writer(tree.ExpressionParser):
    """A parser that rewrites an expression with sums, products, quotients and functions of names and whole numbers."""

    what, example = "a right-hand side", "write a rate such as y1 or -sin(y0)"

    def __init__(self, text: str, names: Mapping[str, str]) -> None:
        """Take the expression, and the texts by which its `names` are replaced."""
        super().__init__(text)
        self.names, self.numbers = names, ("t", "pi", *names, *_FACTOR.findall(text))

    def bare_text(self, node: Any) -> str:
        """The text of a node, without brackets around a chain."""
        return self._chain_text(node) if isinstance(node, tree.ChainNode) else self._text(node)

    def _chain_text(self, node: tree.ChainNode) -> str:
        parts = [self._text(node.first), *(f" {sign.text} {self._text(part)}" for sign, part in node.rest)]
        return self._short("".join(parts), node.column)

    def _text(self, node: Any) -> str:
        match node:
            case tree.NumberNode(value=value):
                return str(value.numerator) if value.denominator == 1 else f"({value.numerator} / {value.denominator})"
            case tree.NameNode(name=name):
                one, given = name in _OF_ONE, {"t", *self.names}
                if name not in given and name[1:] and (one or given.issuperset(name)):
                    hint = f"{name}(t)" if one else f"a product as {'*'.join(name)}"
                    raise ExpressionError(self.text, node.column, f"{name!r} is no number here; write {hint}")
                return self.names.get(name, str(name))
            case tree.NegatedNode(node=inner):
                return f"-{self._text(inner)}"
            case tree.ChainNode():
                return f"({self._chain_text(node)})"
            case tree.CallNode(function=name, arguments=(argument,)) if name in (*FUNCTIONS, *_WRITTEN):
                return self._short(_WRITTEN.get(name, f"{name}({{0}})").format(self.bare_text(argument)), node.column)
            case tree.CallNode(function=name, arguments=(argument,)) if name in _OF_SIGN:
                return self._short(_OF_SIGN[name].format(*self._compared(argument)), node.column)
            case tree.PowerNode():
                return self._power_text(node)
            case tree.CallNode(function=name, arguments=(_, _, *more)) if name in _OF_TWO and not (
                more and name == "mod"
            ):
                write = lambda one, other: self._short(_OF_TWO[name].format(one, other), node.column)
                return str(reduce(write, map(self.bare_text, node.arguments)))
        known = f"{', '.join(_OF_ONE)}, each of one argument, max, min, and mod of two"
        function, near = node.function, ""
        if function not in (*_OF_ONE, *_OF_TWO) and not (hasattr(math, function) or function.startswith("arc")):
            near = did_you_mean(function, (*_OF_ONE, *_OF_TWO))  # not of sinh, which is a function of its own
        raise ExpressionError(self.text, node.column, f"the functions are {known}{near}")

    def _compared(self, node: Any) -> tuple[str, str]:
        """Two texts, of which the first is the greater if the node is positive."""
        match node:
            case tree.ChainNode(first=first, rest=((sign, second),)) if sign.text == "-":
                return self._text(first), self._text(second)
        return self.bare_text(node), "0"

    def _power_text(self, node: tree.PowerNode) -> str:
        whole, rest = divmod(abs(node.exponent), 1)
        if rest not in (0, Fraction(1, 2)):
            raise ExpressionError(self.text, node.column, "an exponent must be a multiple of 1/2")
        base = self._text(node.base)
        base = f"({base})" if base.startswith("-") else base
        factors = [base] * int(whole) + ([f"sqrt({base})"] if rest else [])
        product = self._short(" * ".join(factors or ["1"]), node.column)
        return f"(1 / ({product}))" if node.exponent < 0 else f"({product})" if len(factors) > 1 else product

    def _short(self, text: str, column: int) -> str:
        if len(text) > LONGEST_RATE:
            raise ExpressionError(self.text, column, f"written out it has more than {LONGEST_RATE} characters")
        return text
