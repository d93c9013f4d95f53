"""Users' own methods from TOML files: tableaux, splittings and other families, read exactly, with nothing executed.

    family = "runge_kutta"                    # or "splitting", "nystrom", "collocation", "multistep", "rosenbrock",
                                              # "additive"
    A = [["1/4", "1/4 - s3/6"], ["1/4 + s3/6", "1/4"]]
    b = ["1/2", "1/2"]
    c = ["1/2 - s3/6", "1/2 + s3/6"]          # may be left out; it is then the row sums of A

    [roots]                                   # those of several fields are joined in one field, of degree 12 at most
    s3 = "sqrt(3)"                            # or "1 - cbrt(2)/2", or { minpoly = [-3, 0, 1], interval = ["1", "2"] }

A number is an integer, a decimal, which is exact, or an expression in a string. All families have the keys `key`,
`title`, `source`, `claimed_order` (0: nothing is claimed) and `decimal`. A pair has `b_embedded` with `embedded_order`,
a dense output `dense`, the polynomial in theta of each stage, constant term first; a splitting `parts = [["kick",
"1/2"], ["drift", 1], ...]`; a Nyström method `c`, `A`, `b_position` and `b_velocity`; a collocation method
`node_polynomial`, constant term first; a linear multistep method `rho` and `sigma`, from the oldest value to the new
one, and `derivative = 2` for y'' = F(y); a Rosenbrock method `alpha`, `gamma` and `b`, and the keys of a pair; an
additive (IMEX) method `A_explicit`, `A_implicit`, `b_explicit` and `b_implicit`. With `parameter = "gamma"` a
Runge-Kutta file is a family of methods, with entries that are rational functions of gamma, e.g. "1 - 2*gamma".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FurtherMethod
from driftproof.methods.families import Family, ParameterFunction, parameter_function, parse_function
from driftproof.methods.formulas.expressions import RADICALS, parse_exact, parse_number
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.common_field import common_field, element_of
from driftproof.methods.numbers.number_field import Algebraic, Exact, NumberField
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import SUBSTEPS, Collocation, Method, MethodError, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import did_you_mean
from driftproof.support.toml_tables import (
    TomlTable,
    as_choice,
    as_flag,
    as_line,
    as_list,
    as_table,
    as_whole,
    quoted,
    read_toml,
    require_keys,
)

# Chosen far above published methods: the limits keep the time and the memory that reading takes small.
LARGEST_FILE = 2_000_000
MOST_STAGES = 200
MOST_NODES = 50
MOST_PAST_VALUES = 30
LONGEST_INTEGER = 20_000
LONGEST_MINPOLY_INTEGER = 200
LONGEST_NAME = 200
_KEY = re.compile(r"[A-Za-z][A-Za-z0-9_.+-]{0,59}")
_NAME = re.compile(r"[A-Za-z_]\w{0,30}", re.ASCII)
_COMMON = ("family", "key", "title", "source", "claimed_order", "decimal", "roots")

# Maps an expression, and its place in the file, to the number that it spells.
Read = Callable[[str, str], Any]


def read_method(path: str | Path) -> Method | Family | FurtherMethod:
    """The method, or the family of methods, that the file defines.

    Raises MethodError with one line that names the file and the place in it.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from driftproof import read_method
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "ralston.toml"
    ...     _ = path.write_text('family = "runge_kutta"\\nA = [[0, 0], ["2/3", 0]]\\nb = ["1/4", "3/4"]')
    ...     read_method(path).b
    (Fraction(1, 4), Fraction(3, 4))
    """
    return read_toml(path, LARGEST_FILE, lambda table: _method(table, Path(path).stem), MethodError)


# Common other names of `b_embedded`.
_OF_PAIR = ("b_hat", "bhat", "b_star", "b_err", "b2", "b_tilde", "be")
# For each family, keys as papers have them, and what to write.
_OF_PAPERS = {
    "runge_kutta": (
        "B alpha beta stages",
        "a low-storage or convex form is written as its tableau, the weights of all slopes in each stage and the step",
    ),
    "splitting": ("a b c d", "write parts = [['kick', '1/2'], ['drift', 1], ...], the sub-steps in their order"),
    "multistep": ("alpha beta a b", "alpha is rho, beta is sigma, both from the oldest value to the new one"),
}


def _method(table: TomlTable, name: str) -> Method | Family | FurtherMethod:
    """The method or family that a TOML table defines; `name` is its key if the table has none. Raises ValueError."""
    meant = next((key for key in table if key != "family" and did_you_mean(key.lower(), ["family"])), None)
    if "family" not in table and meant is not None:
        raise MethodError(f"rename {quoted(meant)} to family")
    family = as_choice(table.get("family"), "family", _FAMILIES)
    parametric = "parameter" in table and family == "runge_kutta"
    entries, build = _PARAMETRIC if parametric else _FAMILIES[family]
    meant = next((key for key in table if key in _OF_PAIR and "b_embedded" in entries), None)
    if meant is not None:
        raise MethodError(f"rename {quoted(meant)} to b_embedded, and give embedded_order with it")
    theirs, instead = _OF_PAPERS.get(family, ("", ""))
    what = f"{'an' if family == 'additive' else 'a'} {family}"
    more = instead if {*theirs.split()} & {*table} else "`driftproof facts --help` shows one"
    require_keys(table, (*_COMMON, *entries), what, more)
    common, read = _common(table, name), _reader(table)
    seen: list[Exact] = []
    field: NumberField | None = None

    def remembered(text: str, where: str) -> Any:
        seen.append(read(text, where))
        return element_of(seen[-1], field)

    while True:
        try:
            return build(table, dict(common), remembered)
        except (MethodError, TypeError):  # perhaps numbers of several fields: join those read so far, and retry
            if (wider := common_field(seen)) == field:
                raise
            field = wider


def _reader(table: TomlTable) -> Read:
    """The reader of entries: numbers in the declared roots, or functions of the declared parameter."""
    if "parameter" in table:
        parameter = _parameter(table)
        return lambda text, where: parse_function(text, parameter, where)
    roots = _roots(table.get("roots", {}))
    return lambda text, where: parse_exact(text, roots, where)


def _parameter(table: TomlTable) -> str:
    name = table["parameter"]
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name in RADICALS:
        raise MethodError(f"parameter is {quoted(name)}; write a letter and up to 30 letters, digits or underscores")
    if "roots" in table:
        raise MethodError("parameter and [roots] exclude each other; with a parameter, all numbers must be rational")
    return name


def _common(table: TomlTable, name: str) -> dict[str, Any]:
    plain = re.sub(r"[^A-Za-z0-9_.+-]", "_", name)[:50]
    key = as_line(table.get("key", plain if _KEY.fullmatch(plain) else f"method_{plain}"), "key", LONGEST_NAME)
    if not _KEY.fullmatch(key):
        raise MethodError(f"key is {key!r}; write a letter, then letters, digits and _ . + -, 60 at most")
    return {
        "key": key,
        "title": as_line(table.get("title", key), "title", LONGEST_NAME),
        "source": as_line(table.get("source", "given by the user"), "source", LONGEST_NAME),
        "claimed_order": as_whole(table.get("claimed_order", 0), "claimed_order", 0, MOST_STAGES),
        "decimal": as_flag(table.get("decimal", False), "decimal"),
    }


def _roots(declared: object) -> dict[str, Exact]:
    declared = as_table(declared, "roots")
    roots: dict[str, Exact] = {}
    for name, definition in declared.items():
        if not _NAME.fullmatch(name):
            raise MethodError(f"roots.{name}: a name is a letter and up to 30 letters, digits or underscores")
        roots[name] = _root(name, definition, roots)
    return roots


def _root(name: str, definition: object, known: Mapping[str, Exact]) -> Exact:
    """What "sqrt(3)", "1 - g/2" with a g that is known, or a table of minimal polynomial and interval defines."""
    where = f"roots.{name}"
    if not isinstance(definition, dict):
        value: Exact = _number(definition, where, lambda text, where: parse_exact(text, known, where))
        return value
    if set(definition) != {"minpoly", "interval"}:
        raise MethodError(
            f"{where} is {quoted(definition)}; write {{ minpoly = [...], interval = [...] }} or 'sqrt(n)'"
        )
    try:
        low, high = _rationals(definition["interval"], "interval", parse_number, 2)
        return NumberField(name, _integers(definition["minpoly"]), low, high).generator
    except ValueError as error:
        raise MethodError(f"{where}: {error}") from None


def _integers(values: object) -> tuple[int, ...]:
    whole = _rationals(values, "minpoly", parse_number)
    if any(x.denominator != 1 or x.numerator.bit_length() > LONGEST_MINPOLY_INTEGER for x in whole):
        raise MethodError("minpoly: the coefficients are integers of at most 60 digits, constant term first")
    return tuple(int(x) for x in whole)


def _numbers(values: object, where: str, read: Read, length: int | None = None) -> tuple[Any, ...]:
    return tuple(_number(x, f"{where}[{i}]", read) for i, x in enumerate(as_list(values, where, length, MOST_STAGES)))


def _rationals(values: object, where: str, read: Read, length: int | None = None) -> tuple[Fraction, ...]:
    found = _numbers(values, where, read, length)
    for i, x in enumerate(found):
        if isinstance(x, Algebraic) and not x.is_rational:
            raise MethodError(f"{where}[{i}] is {x}; a rational number is needed")
    return tuple(x.as_fraction() if isinstance(x, Algebraic) else x for x in found)


def _number(value: object, where: str, read: Read) -> Any:
    if isinstance(value, int) and not isinstance(value, bool):
        if value.bit_length() > LONGEST_INTEGER:
            raise MethodError(f"{where} is an integer of {value.bit_length()} bits; at most {LONGEST_INTEGER} are read")
        return Fraction(value)
    if isinstance(value, str):
        return read(value, where)
    raise MethodError(f"{where} is {quoted(value)}; write an integer, a decimal or an expression in quotes")


def _square(table: TomlTable, read: Read, stages: int, name: str = "A") -> tuple[tuple[Any, ...], ...]:
    given = as_list(_entry(table, name), name, most=MOST_STAGES)
    if given and not isinstance(given[0], list):
        raise MethodError(f"{name}[0] is {quoted(given[0])}; {name} is a list of rows, as in [[0, 0], [1, 0]]")
    rows = [as_list(row, name, most=MOST_STAGES) for row in given]
    for diagonal in (0, 1):  # rows may end before the diagonal, or with it
        if all(len(row) == i + diagonal for i, row in enumerate(rows)):
            rows = [[*row, *[0] * (len(rows) - len(row))] for row in rows]
    for i, row in enumerate(rows):
        if len(row) != len(rows):
            raise MethodError(f"{name} is not square: {name}[{i}] has {len(row)} entries, {name} has {len(rows)} rows")
    if len(rows) != stages:
        raise MethodError(f"{name} has {len(rows)} rows, but there are {stages} weights; the numbers must agree")
    return tuple(_numbers(row, f"{name}[{i}]", read) for i, row in enumerate(rows))


def _entry(table: TomlTable, name: str) -> object:
    if name not in table:
        raise MethodError(f"{name} is missing")
    return table[name]


def _runge_kutta(table: TomlTable, common: dict[str, Any], read: Read) -> Method:
    b = _numbers(_entry(table, "b"), "b", read)
    a = _square(table, read, len(b))
    c, further = _nodes(table, a, read), _second_row(table, read, len(b))
    if "dense" in table:
        weights = as_list(table["dense"], "dense", len(b))
        further["dense"] = tuple(_numbers(weight, f"dense[{i}]", read) for i, weight in enumerate(weights))
    return RungeKutta(**common, a=a, b=b, c=c, **further)


def _second_row(table: TomlTable, read: Read, stages: int) -> dict[str, Any]:
    """The embedded weights of a pair and their order; {} if there are none."""
    if not {"b_embedded", "embedded_order"} & set(table):
        return {}
    weights = _numbers(_entry(table, "b_embedded"), "b_embedded", read, stages)
    order = as_whole(table.get("embedded_order", 0), "embedded_order", 0, MOST_STAGES)
    return {"b_embedded": weights, "embedded_order": order}


def _nodes(table: TomlTable, a: Sequence[Sequence[Any]], read: Read) -> tuple[Any, ...]:
    """The nodes c, or the row sums of A if c is left out."""
    return _numbers(table["c"], "c", read, len(a)) if "c" in table else tuple(sum(row, Fraction(0)) for row in a)


def _family(table: TomlTable, common: dict[str, Any], read: Read) -> Family:
    if common.pop("decimal"):
        raise MethodError("decimal = true is not allowed: a tableau with a parameter must be exact")
    b = _numbers(_entry(table, "b"), "b", read)
    a = _square(table, read, len(b))

    def functions(row: Sequence[Any]) -> tuple[ParameterFunction, ...]:
        return tuple(x if isinstance(x, ParameterFunction) else parameter_function((x,)) for x in row)

    rows, nodes = tuple(map(functions, a)), functions(_nodes(table, a, read))
    return Family(**common, parameter=_parameter(table), a=rows, b=functions(b), c=nodes)


def _splitting(table: TomlTable, common: dict[str, Any], read: Read) -> Method:
    parts = []
    for i, part in enumerate(as_list(_entry(table, "parts"), "parts", most=5 * MOST_STAGES)):
        if not isinstance(part, list) or len(part) != 2 or part[0] not in SUBSTEPS:
            raise MethodError(f"parts[{i}] is {quoted(part)}; write ['kick', number] or ['drift', number]")
        parts.append((part[0], _number(part[1], f"parts[{i}][1]", read)))
    return Splitting(**common, parts=tuple(parts))


def _nystrom(table: TomlTable, common: dict[str, Any], read: Read) -> Method:
    weights = _numbers(_entry(table, "b_velocity"), "b_velocity", read)
    c, b_position = (_numbers(_entry(table, name), name, read, len(weights)) for name in ("c", "b_position"))
    return Nystrom(**common, c=c, a=_square(table, read, len(weights)), b_position=b_position, b_velocity=weights)


def _collocation(table: TomlTable, common: dict[str, Any], read: Read) -> Method:
    if common.pop("decimal"):
        raise MethodError("decimal = true is not allowed: a rounded node polynomial would have other nodes")
    coefficients = as_list(_entry(table, "node_polynomial"), "node_polynomial", most=MOST_NODES + 1)
    return Collocation(**common, node_polynomial=_rationals(coefficients, "node_polynomial", read))


def _multistep(table: TomlTable, common: dict[str, Any], read: Read) -> Multistep:
    given = {name: as_list(_entry(table, name), name, most=MOST_PAST_VALUES + 1) for name in ("rho", "sigma")}
    rho, sigma = (_rationals(values, name, read) for name, values in given.items())
    derivative = as_whole(table.get("derivative", 1), "derivative", 1, 2)
    return Multistep(**common, rho=rho, sigma=sigma, derivative=derivative)


def _rosenbrock(table: TomlTable, common: dict[str, Any], read: Read) -> Rosenbrock:
    b = _numbers(_entry(table, "b"), "b", read)
    alpha, gamma = (_square(table, read, len(b), name) for name in ("alpha", "gamma"))
    return Rosenbrock(**common, alpha=alpha, gamma=gamma, b=b, **_second_row(table, read, len(b)))


def _additive(table: TomlTable, common: dict[str, Any], read: Read) -> Additive:
    b_explicit, b_implicit = (_numbers(_entry(table, name), name, read) for name in ("b_explicit", "b_implicit"))
    a_explicit, a_implicit = (_square(table, read, len(b_explicit), name) for name in ("A_explicit", "A_implicit"))
    return Additive(
        **common, a_explicit=a_explicit, a_implicit=a_implicit, b_explicit=b_explicit, b_implicit=b_implicit
    )


_Reader = Callable[[TomlTable, dict[str, Any], Read], Method | Family | FurtherMethod]
_FAMILIES: dict[str, tuple[tuple[str, ...], _Reader]] = {
    "runge_kutta": (("parameter", "A", "b", "c", "b_embedded", "embedded_order", "dense"), _runge_kutta),
    "splitting": (("parts",), _splitting),
    "nystrom": (("c", "A", "b_position", "b_velocity"), _nystrom),
    "collocation": (("node_polynomial",), _collocation),
    "multistep": (("rho", "sigma", "derivative"), _multistep),
    "additive": (("A_explicit", "A_implicit", "b_explicit", "b_implicit"), _additive),
    "rosenbrock": (("alpha", "gamma", "b", "b_embedded", "embedded_order"), _rosenbrock),
}
_PARAMETRIC: tuple[tuple[str, ...], _Reader] = (("parameter", "A", "b", "c"), _family)
