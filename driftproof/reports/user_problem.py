"""A user's own problem from a .toml file: its reference is the true solution, enclosed until its digits are settled."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from flint import arb, ctx

from driftproof.blackbox.stepper.opening import imported
from driftproof.enclosure.fields import rebound
from driftproof.enclosure.numbers import Refused
from driftproof.enclosure.solutions import BITS_AT_FIRST, enclose_solution
from driftproof.enclosure.text_fields import field_function
from driftproof.enclosure.traced_fields import field_of_function
from driftproof.methods.expressions import parse_number
from driftproof.methods.field_text import LONGEST_PROBLEM, PROBLEM_KEYS, energy_of_table, field_of_table, start_of_table
from driftproof.methods.schemes import MethodError
from driftproof.methods.vector_fields import VectorField
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.problem import CERTIFIED, Problem, Reference
from driftproof.support.progress import working
from driftproof.support.toml_tables import TomlTable, as_line, as_table, as_text, demand_keys, quoted, read_toml
from driftproof.symbolic.algebra.certified import Uncertified, significant

# As the references of our own problems have them.
ENCLOSED_DIGITS = 20
# The reference's times are so many equal parts of the interval.
PARTS = 10
# Each with half as many bits more: 128, 192, 288, 432, 648. 20 digits of most problems need one of the first two.
_MOST_ATTEMPTS = 5
_LONGEST_TITLE = 200


def problem_given(given: str | Path | Problem) -> Problem:
    """A problem by its key, or by a .toml file of its equations. Raises ValueError in one line, and Refused.

    The file has start and end, rates or in their place a Python function, "module:f", which is run once on names; and,
    if you like, parameters, of a function its keywords as doubles, a title and an energy:

    rates = ["y1", "-g * sin(y0)"]
    start = ["2", "0"]
    end = "10"
    energy = "y1^2/2 - g * cos(y0)"
    parameters.g = "9.81"
    """
    if isinstance(given, Problem):
        return given
    if not (name := str(given)).endswith(".toml"):
        return problem_named(name)

    def read(table: TomlTable) -> Problem:
        demand_keys(table, PROBLEM_KEYS, "a problem")
        start = tuple(_rational(x, f"start[{i}]") for i, x in enumerate(start_of_table(table)))
        end = _rational(table.get("end"), "end")
        field = _field(table, len(start))
        if end <= 0:
            raise ValueError(f"end is {end}; problems run from 0 to a time above it")
        title = as_line(table.get("title", name), "title", _LONGEST_TITLE)
        return Problem(
            key=name,
            title=title,
            field=field,
            start=start,
            reference=enclosed_reference(field, start, [end * k / PARTS for k in range(1, PARTS + 1)]),
            source=name,
            energy=energy_of_table(table),
            second_order=_is_second_order(field),
        )

    return read_toml(name, LONGEST_PROBLEM, read)


def _field(table: TomlTable, components: int) -> VectorField:
    if "function" in table:
        if "rates" in table:
            raise ValueError("function stands in the place of rates; give one of them")
        function = rebound(imported(as_text(table["function"], "function"), "function"))
        given = as_table(table.get("parameters", {}), "parameters")
        parameters = {name: float(_rational(x, f"parameters.{name}")) for name, x in given.items()}
        return field_of_function(lambda t, y: function(t, y, **parameters), components)
    field = field_of_table(table)
    if len(field.rates) != components:
        raise ValueError(f"start has {components} entries, {len(field.rates)} are needed")
    return field


@working("a problem of your own")
def enclosed_reference(field: VectorField, start: Sequence[Fraction], times: Sequence[Fraction]) -> Reference:
    """The solution from `start` at 0, to ENCLOSED_DIGITS digits at each time. Raises Refused."""
    f, bits, refusal = field_function(field), BITS_AT_FIRST, None
    for _ in range(_MOST_ATTEMPTS):
        try:
            found = enclose_solution(f, list(start), [Fraction(0), *times], bits)
            with ctx.workprec(bits):
                digits = tuple(tuple(map(_digits, row)) for row in found.states[1:])
            return Reference(tuple(times), digits, CERTIFIED, f"enclosed in {found.steps} steps, {bits} bits")
        except Refused as reason:
            if reason.t is None:  # more bits lead no further
                raise
            refusal = reason
        except Uncertified:
            refusal = None
        bits = bits * 3 // 2
    raise refusal or Refused(f"the solution is not known to {ENCLOSED_DIGITS} digits with {bits * 2 // 3} bits")


def _digits(x: arb) -> str:
    """Correctly rounded; of a ball around 0 a zero whose last place says how near it is. Raises Uncertified."""
    if not x.contains(0):
        return significant(lambda: x, ENCLOSED_DIGITS)
    if x.is_zero():
        return "0e-400"
    places = int((-(2 * arb(x.abs_upper())).log() / arb(10).log()).floor().unique_fmpz() or 0)
    if places < ENCLOSED_DIGITS:
        raise Uncertified("the ball around 0 is too wide")
    return f"0e-{places}"


def _rational(value: object, where: str) -> Fraction:
    if value is None or isinstance(value, bool | list | dict):
        shown = "missing" if value is None else quoted(value)
        raise ValueError(f'{where} is {shown}; write a number such as "1/3" or 0.1')
    number = parse_number(str(value), where)
    if not isinstance(number, Fraction):
        raise ValueError(f"{where}: {value} is irrational; a problem's times and starts are rational")
    return number


def _is_second_order(field: VectorField) -> bool:
    try:
        field.second_order()
    except MethodError:
        return False
    return True
