"""A user's own problem as a table of TOML: its field from rates or from a Python function, its start and its energy."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Refused, in_bits
from driftproof.enclosure.fields.fields import RightHandSide, time_first
from driftproof.enclosure.fields.text_fields import field_function, given_field
from driftproof.enclosure.fields.traced_fields import field_of_function
from driftproof.enclosure.invariants import enclosed_invariant
from driftproof.enclosure.reproduction import reproduced_field
from driftproof.methods.formulas.expressions import parse_number
from driftproof.methods.formulas.field_text import (
    LONGEST_PROBLEM,
    PROBLEM_KEYS,
    energy_of_table,
    field_of_table,
    field_of_text,
    rate_of_text,
    start_of_table,
    unknowns_of_table,
)
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.rationals import ExactNumber, brief, steps_of
from driftproof.methods.schemes import MethodError
from driftproof.support.environment import imported_object
from driftproof.support.plain_text import unknown
from driftproof.support.toml_tables import TomlTable, as_table, as_text, quoted, read_toml, require_keys
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose

# Bits with which an expression is evaluated, far more than the 53 of the double that is wanted.
_BITS = 256
_WORD = re.compile(r"[^\W\d]\w*")
# Of an end that is written as a number, and is not the double nearest to one, the denominator is less.
_OF_DOUBLES = 2**30
# Values of some parameters by name, as a mapping or as pairs.
GivenParameters: TypeAlias = Mapping[str, ExactNumber] | Sequence[tuple[str, ExactNumber]]


class ProblemTable(NamedTuple):
    """y' = f(t, y), y(0) = start, an energy in y0, y1, ... or None, and the names of the unknowns, if they have any."""

    field: VectorField
    start: tuple[Any, ...]
    energy: str | None = None
    unknowns: tuple[str, ...] = ()


def problem_table(table: TomlTable) -> ProblemTable:
    """The problem in a table with the keys of PROBLEM_KEYS. Raises Refused, and ValueError in one line.

    `function`, "module:f" or a Python function, is run once on symbols; it gets the parameters as keywords, as doubles.
    """
    if "family" in table:
        raise ValueError("it is a method, not a problem; methods are compared by --methods FILE on a problem")
    require_keys(table, PROBLEM_KEYS, "a problem")
    start = _start(table)
    field, unknowns = _field(table, [nearest(x) for x in start]), unknowns_of_table(table)
    return ProblemTable(field, start, _energy(table, replace(field, unknowns=unknowns)), unknowns)


class GivenTable(NamedTuple):
    """A right-hand side, and the start and the end that a table gives beside it, None where it gives none.

    Of irrational numbers they are the nearest doubles, as a run in floats has.
    """

    f: RightHandSide | VectorField
    start: tuple[Fraction, ...] | None = None
    end: Fraction | None = None


def given_problem(given: Any, parameters: GivenParameters = ()) -> GivenTable:
    """The right-hand side in a .toml file or in a dict like it; any other is taken as `given_field` does.

    `parameters` replace those of the table, or are keywords of a function.
    """
    if parameters and callable(given):
        return GivenTable(partial(time_first(given), **_arguments({"parameters": _by_name(parameters)})))
    if isinstance(given, Mapping):
        return _of_table(with_parameters(as_toml(given), parameters))
    if isinstance(given, str | Path) and str(given).endswith(".toml"):
        return read_toml(given, LONGEST_PROBLEM, lambda table: _of_table(with_parameters(table, parameters)))
    if parameters:
        raise ValueError("parameters are of a .toml file, a dict or a function; write them into the text, as in k=2")
    return GivenTable(given_field(given))


def with_parameters(table: TomlTable, parameters: GivenParameters, name: str = "") -> TomlTable:
    """The table with other values of some parameters, told in its title. Raises ValueError if it has no such one."""
    if not parameters:
        return table
    values = {each: as_toml(value) for each, value in _by_name(parameters).items()}
    held = as_table(table.get("parameters", {}), "parameters")
    if others := [each for each in values if each not in held and "function" not in table]:
        raise ValueError(unknown("parameter", others[0], held) if held else f"no parameter {others[0]!r}; it has none")
    told = ", ".join(f"{each} = {value}" for each, value in values.items())
    return table | {"parameters": held | values, "title": f"{table.get('title', name)} with {told}"}


def _by_name(given: GivenParameters) -> dict[str, ExactNumber]:
    """The values of the parameters by name. Raises ValueError for a name with several."""
    found = dict[str, ExactNumber]()
    for name, value in given.items() if isinstance(given, Mapping) else given:
        if name in found:
            raise ValueError(f"{name} has one value at a time, but is given {found[name]} and {value}")
        found[name] = value
    return found


def _of_table(table: TomlTable) -> GivenTable:
    require_keys(table, PROBLEM_KEYS, "a right-hand side")
    f = _function(table) if "function" in table else field_of_table(table)
    end = nearest(stated_number(table, table["end"], "end")) if "end" in table else None
    return GivenTable(f, tuple(map(nearest, _start(table))) if "start" in table else None, end)


def _start(table: TomlTable) -> tuple[CertifiableReal, ...]:
    given = start_of_table(table)
    return tuple(stated_number(table, x, where) for x, where in zip(given, places_of_start(table, given), strict=True))


def places_of_start(table: TomlTable, given: Sequence[object]) -> list[str]:
    """The name of each number of a start, as the table has it."""
    unknowns = unknowns_of_table(table)
    named = len(unknowns) == len(given)
    return [f"start.{unknowns[i]}" if named else f"start[{i}]" for i in range(len(given))]


def stated_number(table: TomlTable, value: object, where: str) -> CertifiableReal:
    """The number of a start or an end, as `number_entry` reads it; parameters of the table may stand in its text.

    Raises ValueError.
    """
    written = dict[str, str]()
    own: Callable[[str], str] = lambda text: _WORD.sub(lambda word: written.get(word[0], word[0]), text)
    for name, x in as_table(table.get("parameters", {}), "parameters").items():
        written[name] = f"({own(str(x))})"
    if not isinstance(value, str) or own(value) == value:
        return number_entry(value, where)
    return number_entry(own(value), f"{where}, {quoted(value)} with parameters,")


def as_toml(value: Any) -> Any:
    """The contents of a dict as TOML would give them: lists, and decimals as text."""
    if isinstance(value, Mapping):
        return {key: as_toml(each) for key, each in value.items()}
    if isinstance(value, tuple | list | np.ndarray):
        return [as_toml(each) for each in value]
    value = value.item() if isinstance(value, np.generic) else value
    return str(value) if isinstance(value, float | Fraction) else value


def _function(table: TomlTable) -> RightHandSide:
    """The function of (t, y) in a table, with its parameters as keywords."""
    if "rates" in table:
        raise ValueError("give either rates or function, not both")
    own = table["function"]
    if not callable(own):
        own = imported_object(as_text(own, "function"), "function")
    if not callable(own):
        raise ValueError(f"function is {type(own).__name__}, which cannot be called")
    return partial(time_first(own), **_keywords(own, table))


def _keywords(own: RightHandSide, table: TomlTable) -> dict[str, Any]:
    """The parameters for the function: without those that it does not take and other expressions are written in."""
    arguments = _arguments(table)
    with suppress(TypeError, ValueError):  # compiled code may have no signature
        taken = signature(own).parameters
        texts = [*map(str, table.get("parameters", {}).values()), str(table.get("energy", ""))]
        if not any(each.kind is each.VAR_KEYWORD for each in taken.values()):
            written = {name for text in texts for name in _WORD.findall(text)} - {*taken}
            return {name: value for name, value in arguments.items() if name not in written}
    return arguments


def _field(table: TomlTable, start: Sequence[Fraction]) -> VectorField:
    components = len(start)
    if "function" in table:
        f = _function(table)
        end = nearest(stated_number(table, table.get("end", 1), "end"))
        return reproduced_field(f, lambda: field_of_function(f, components), start, end)
    field = field_of_table(table)
    if len(field.rates) != components:
        raise ValueError(f"start has {components} entries, but the rates need {len(field.rates)}")
    return field


def _energy(table: TomlTable, field: VectorField) -> str | None:
    """The energy in terms of y0, y1, ...; if the rates are a function's, its parameters stand there as doubles."""
    if "energy" not in table:
        return None
    if "rates" in table:
        written = energy_of_table(table) or ""
    else:
        doubles = {name: Fraction(x) for name, x in _arguments(table).items()}
        names = {name: f"({x.numerator} / {x.denominator})" for name, x in doubles.items()}
        written = rate_of_text(as_text(table["energy"], "energy"), names)
    try:
        replace(field, rates=(written, *field.rates[1:]))
    except MethodError as error:
        reason = field.in_own_words(str(error).removeprefix(f"rate 0, {written!r}: "))
        raise ValueError(f"energy, {quoted(table['energy'])}: {reason}") from None
    return written


def _arguments(table: TomlTable) -> dict[str, Any]:
    """The parameters of a function: numbers of Python or NumPy as they are, of others the nearest doubles.

    An expression may have pi and earlier parameters in it, which are exact there.
    """
    given, found, written = as_table(table.get("parameters", {}), "parameters"), dict[str, Any](), dict[str, str]()
    for name, value in given.items():
        plain = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        found[name] = value if plain else _nearest_double(value, f"parameters.{name}", written)
        written[name] = f"({rate_of_text(str(value), written)})"
    return found


def _nearest_double(value: Any, where: str, names: Mapping[str, str]) -> float:
    """The double nearest to a number or to an expression in pi and the names."""
    with suppress(ValueError):
        return float(nearest(number_entry(value, where)))
    if not math.isfinite(found := _expression_in_doubles(str(value), names)):
        known = ", ".join(["pi", *names])
        raise ValueError(f"{where} is {quoted(value)}; write a number, or an expression in {known}")
    return found


def _expression_in_doubles(text: str, names: Mapping[str, str] | None = None) -> float:
    """The double nearest to an expression in pi and the names; NaN if it is none."""
    with suppress(ValueError, ArithmeticError, Refused), in_bits(_BITS):
        return float(_expression(text, names).mid())
    return math.nan


def _expression(text: str, names: Mapping[str, str] | None = None) -> arb:
    """A ball of an expression in pi and the names, at Arb's current precision. Raises ValueError, Refused."""
    function = field_function(field_of_text([text], names=names))
    return enclosed_invariant(lambda y: function(y[0] * 0, y), [arb("nan")], text)


def number_entry(value: object, where: str) -> CertifiableReal:
    """The number in an entry of a table, exact if it is rational or algebraic, else enclosed, as 2*pi is.

    Raises ValueError.
    """
    if value is None or isinstance(value, bool | list | dict):
        shown = "missing" if value is None else quoted(value)
        raise ValueError(f'{where} is {shown}; write a number such as "1/3" or 0.1')
    try:
        return parse_number(str(value), where)
    except ValueError as error:  # perhaps it is written as rates are, such as 2*pi
        if math.isfinite(_expression_in_doubles(str(value))):
            return partial(_expression, str(value))
        if "is a name" not in str(error):
            raise
        raise ValueError(f'{where} is {quoted(value)}; write a number such as "1/3", 0.1 or "2*pi"') from None


def nearest(number: CertifiableReal) -> Fraction:
    """The number, if it is rational, and else the double nearest to it."""
    if isinstance(number, Fraction):
        return number
    with in_bits(_BITS):
        return Fraction(float(enclose(number).mid()))


def steps_to(t: Fraction, given: ExactNumber | Sequence[ExactNumber]) -> list[Fraction]:
    """The step sizes of `steps_of`, where text may also be irrational: 2*pi/100 is t/100 for the double t of 2*pi.

    Raises ValueError unless t is the double nearest to a multiple of such a step size.
    """
    if not isinstance(given, str):
        return [h for each in (given if isinstance(given, Sequence) else [given]) for h in _steps_to(t, each)]
    return [h for text in given.split(",") for h in _steps_to(t, text)]


def _steps_to(t: Fraction, given: ExactNumber) -> list[Fraction]:
    number = number_entry(given, "h") if isinstance(given, str) and ":" not in given else Fraction(1)
    if isinstance(number, Fraction):
        found = steps_of(given)
        if t.denominator < _OF_DOUBLES or all((t / h).denominator == 1 for h in found):
            return found
    elif (steps := round(t / (nearest(number) or -t))) > 0 and nearest(lambda: steps * enclose(number)) == t:
        return [t / steps]
    remedy = "a part of the end as it is written does, such as 2*pi/100 of 2*pi"
    raise ValueError(f"h = {brief(given)} does not divide t = {float(t)!r}, the nearest double of its end; {remedy}")
