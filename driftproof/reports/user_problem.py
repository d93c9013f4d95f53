"""A user's own problem, from a file or a dict: its reference is the solution, enclosed until its digits are certain."""

from __future__ import annotations

import re
from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from decimal import Decimal
from fractions import Fraction
from functools import cache
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

import flint
import numpy as np
from flint import arb, ctx, fmpq_mat

import driftproof
from driftproof.enclosure.arithmetic.evaluations import TWO_RUNS, Refused
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.certificate import decimal
from driftproof.enclosure.fields.text_fields import field_function, linear_part
from driftproof.enclosure.invariants import enclosed_invariant
from driftproof.enclosure.problem_tables import (
    GivenParameters,
    as_toml,
    nearest,
    places_of_start,
    problem_table,
    stated_number,
    with_parameters,
)
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST, enclose_solution
from driftproof.enclosure.solution.steps import DensePiece
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.field_text import LONGEST_PROBLEM
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.rationals import brief
from driftproof.methods.schemes import MethodError
from driftproof.numeric.problems.catalogue import PROBLEMS, problem_named
from driftproof.numeric.problems.problem import CERTIFIED, DenseSolution, Problem, Reference
from driftproof.numeric.reference_errors import ENERGY, floors
from driftproof.support import kept
from driftproof.support.plain_text import counted
from driftproof.support.progress import working
from driftproof.support.toml_tables import TomlTable, as_line, quoted, read_toml
from driftproof.symbolic.algebra.certified import Uncertified, enclose, significant
from driftproof.symbolic.linear.stability_limits import ALWAYS
from driftproof.symbolic.linear.systems import SystemFacts

# As many as the references of our own problems have.
ENCLOSED_DIGITS = 20
# The reference's times divide the interval into this many equal parts.
PARTS = 10
# A linear problem of more components gets no proof of its stability: the eigenvalues of twice as many take minutes.
MOST_PROVED = 20
# A ball so many digits narrower than the digits of the largest component is of a component that has died out: errors of
# floats are some 1e-16 of the largest component or more, of which 1e-30 is 1e-14.
DEEPER_DIGITS = 10
# Each attempt has half as many bits more: 128, 192, 288, 432, 648. For most problems one of the first two is enough.
_MOST_ATTEMPTS = 5
_LONGEST_TITLE = 200
# A double 9.81 in f and the exact one in an energy make it change by some u of its terms: less than this many u is said
# to be conserved.
CONSTANTS_OFF = 1e6
# An enclosure that took so many seconds is kept for the next command. Chosen: reading it takes some hundredths.
LONG = 1.0
# Of the largest component: doubles of the solution are nearer to its digits.
_NEAR = 1e-9
KINKED = "f has kinks or jumps"
# What the enclosure says of a rate.
_COMPONENT = re.compile(r"f is not finite \(component (\d+)\)")
# Times of kinks that are shown.
_MOST_TIMES = 5
# A problem by its key, by its file, or by the contents of one, whose function may be a Python function.
GivenProblem: TypeAlias = str | Path | Problem | Mapping[str, Any]


def problem_given(given: GivenProblem, parameters: GivenParameters = ()) -> Problem:
    """A problem by its key, or by a .toml file or a dict of its equations. Raises Refused, and ValueError in one line.

    `parameters` replace those of the file or the dict.

    The file has start and end, and rates or in their place a Python function, "module:f", which is run once on symbols.
    Optional are parameters (a function gets them as keywords, as doubles), a title and an energy; the help of
    `driftproof stability` shows one. A dict has the same keys; its function may be a Python function itself, and its
    decimals are floats.
    """
    if isinstance(given, Mapping):
        name = getattr(given.get("function"), "__name__", "own")
        return _problem(with_parameters(as_toml(given), parameters, name), name)
    if parameters and not str(given).endswith(".toml"):
        raise ValueError(f"parameters are of a problem in a .toml file or a dict; {brief(given)} has none to change")
    if isinstance(given, Problem):
        return given
    own: Any = given
    if callable(own):
        example = f"{{'function': {getattr(own, '__name__', 'f')}, 'start': [1, 0], 'end': 10}}"
        raise ValueError(f"a function alone does not define a problem; give start and end as well: {example}")
    if not (name := str(given)).endswith(".toml"):
        return problem_named(name)
    try:
        return read_toml(name, LONGEST_PROBLEM, lambda table: _problem(with_parameters(table, parameters, name), name))
    except Refused as reason:
        raise Refused(f"{name}: {reason}", reason.t) from None


def names_problem(given: object) -> bool:
    """True for a problem: an object, a dict, a key of the catalogue, a .toml file with an `end`; and for a function."""
    if isinstance(given, Problem | Mapping) or callable(given):
        return True
    name = str(given)
    return name in PROBLEMS or (name.endswith(".toml") and read_toml(name, LONGEST_PROBLEM, lambda own: "end" in own))


def _problem(table: TomlTable, name: str) -> Problem:
    field, given, energy, unknowns = problem_table(table)
    exactly = {"end": stated_number(table, table.get("end"), "end")}
    exactly |= dict(zip(places_of_start(table, given), given, strict=True))
    end, *start = map(nearest, exactly.values())
    if end <= 0:
        raise ValueError(f"end is {brief(end)}; it must be above 0, where problems begin")
    title = as_line(table.get("title", name), "title", _LONGEST_TITLE)
    if rounded := [f"{where} = {float(nearest(x))!r}" for where, x in exactly.items() if not isinstance(x, Fraction)]:
        title += f", with {', '.join(rounded)}, nearest doubles"
    try:
        reference, second_order = _reference(field, start, tuple(end * k / PARTS for k in range(1, PARTS + 1))), False
    except Refused as reason:
        said = _COMPONENT.sub(lambda found: _rate_as_given(table, int(found[1]), found[0]), str(reason))
        raise Refused(said, reason.t) from None
    with suppress(MethodError):
        second_order = bool(field.second_order())
    about = (name, title, field, tuple(start), reference, name, energy)
    found = Problem(*about, second_order=second_order, unknowns=unknowns)
    changes = "" if energy is None else _change_of(found, energy)
    return replace(found, energy_changes=changes, matrix=matrix_in(field))


def _rate_as_given(table: TomlTable, i: int, otherwise: str) -> str:
    """A component of f as the table writes it, with its key; else as before."""
    rates = table.get("rates")
    if isinstance(rates, Mapping):
        name = [*rates][i]
        return f"rates.{name} = {quoted(rates[name])} is not finite"
    return f"rates[{i}] = {quoted(rates[i])} is not finite" if isinstance(rates, list) else otherwise


def _change_of(problem: Problem, energy: str) -> str:
    """The change of the energy on the solution, and its time; "" if ten digits of doubles in f or in it explain it."""
    function, least = field_function(problem.field, (energy,)), 0.0
    with ctx.workprec(BITS_AT_FIRST), suppress(ArithmeticError, Refused):  # of an energy without a value somewhere
        least = CONSTANTS_OFF * floors(problem)[ENERGY]
        first = enclosed_invariant(lambda y: function(y[0] * 0, y), [enclose(x) for x in problem.start], "energy")
        for t, digits in zip(problem.reference.times, problem.reference.states, strict=True):
            balls = [arb(f"{text} +/- 1e{Decimal(text).as_tuple().exponent}") for text in digits]
            change = enclosed_invariant(lambda y: function(y[0] * 0, y), balls, "energy") - first
            if change.abs_lower() > least:
                return f"{decimal(change)} at t = {float(t):.6g}"
    return ""


def _reference(field: VectorField, start: Sequence[Fraction], times: tuple[Fraction, ...]) -> Reference:
    """The `enclosed_reference`, from this user's cache if the same one has been enclosed by the same program."""
    about = {"field": field, "start": start, "times": times, "flint": flint.__version__, "program": program()}
    question = {name: repr(value) for name, value in about.items()}
    with suppress(ValueError, KeyError, TypeError):
        if (held := kept.cached(question)) is not None:
            return _from_cache(times, held)
    began = perf_counter()
    found = enclosed_reference(field, start, times)
    if perf_counter() - began > LONG and (dense := found.dense) is not None:
        answer = {name: getattr(found, name) for name in ("states", "evidence", "source")}
        answer |= {"changes": [*map(str, found.changes)], "shape": dense.coefficients.shape}
        kept.cache(question, answer | {name: _as_text(getattr(dense, name)) for name in _DENSE})
    return found


_DENSE = tuple(array.name for array in fields(DenseSolution))


@cache
def program() -> str:
    """A hash of all that an enclosure, or a run in floats, is computed by."""
    home, found = Path(driftproof.__file__).parent, sha256()
    for folder in ("enclosure", "methods", "numeric", "reports", "symbolic/algebra"):
        for path in sorted(home.joinpath(folder).glob("*.py")):
            found.update(path.read_bytes())
    return f"{driftproof.__version__}, {found.hexdigest()}"


def _as_text(array: np.ndarray[Any, Any]) -> str:
    return b64encode(array.astype("<f8").tobytes()).decode()


def _from_cache(times: tuple[Fraction, ...], held: Any) -> Reference:
    """The reference that was kept. Raises ValueError unless its doubles and its digits are of one solution."""
    begins, lengths, low, flat = (np.frombuffer(b64decode(held[name]), "<f8") for name in _DENSE)
    dense = DenseSolution(begins, lengths, low, flat.reshape(held["shape"]))
    states = tuple(map(tuple, held["states"]))
    digits = np.array(states, float)
    if not np.abs(dense.at(np.array(times, float)) - digits).max() <= _NEAR * np.abs(digits).max():
        raise ValueError("its doubles are not those of its digits")
    return Reference(times, states, held["evidence"], held["source"], dense, tuple(map(Fraction, held["changes"])))


@working("a problem of your own")
def enclosed_reference(field: VectorField, start: Sequence[Fraction], times: Sequence[Fraction]) -> Reference:
    """The solution from `start` at 0, to ENCLOSED_DIGITS digits at each time. Raises Refused."""
    f, bits, refusal = field_function(field), BITS_AT_FIRST, None
    for _ in range(_MOST_ATTEMPTS):
        try:
            pieces = list[DensePiece]()
            found = enclose_solution(f, list(start), sorted({Fraction(0), *times}), bits, pieces)
            true = dict(zip(found.times, found.states, strict=True))
            with ctx.workprec(bits):
                digits = tuple(tuple(_digits(x, size(true[t])) for x in true[t]) for t in times)
            said = f"enclosed in {found.steps} steps, {bits} bits"
            return Reference(tuple(times), digits, CERTIFIED, said, dense_of(pieces), found.changes)
        except Refused as reason:
            said = str(reason).replace("if f jumps there, ", "").replace(TWO_RUNS, "give the problem an end before it")
            refusal = Refused(said, reason.t)
            if reason.t is None:  # more bits lead no further
                raise refusal from None
        except Uncertified:
            refusal = None
        bits = bits * 3 // 2
    raise refusal or Refused(f"the solution cannot be enclosed to {ENCLOSED_DIGITS} digits with {bits * 2 // 3} bits")


def dense_of(pieces: Sequence[DensePiece]) -> DenseSolution:
    """The solution in doubles from the pieces of its enclosure."""
    most = max(len(p) for piece in pieces for p in piece.polynomials)
    rows = [[[*map(float, p), *[0.0] * (most - len(p))] for p in piece.polynomials] for piece in pieces]
    begins, lengths, low = np.array([(float(each.t), float(each.h), each.low) for each in pieces]).T
    return DenseSolution(begins, lengths, low, np.array(rows))


def _digits(x: arb, largest: arb) -> str:
    """x correctly rounded; for a ball around 0, a zero whose exponent says how near. Raises Uncertified.

    A component whose ball is far below the `largest` component has died out, and gets the digits that are certain.
    """
    for digits in range(0 if x.contains(0) else ENCLOSED_DIGITS, 0, -1):
        try:
            return significant(lambda: x, digits)
        except Uncertified:
            if not x.rad() * arb(10) ** (ENCLOSED_DIGITS + DEEPER_DIGITS) < largest:
                raise
    if x.is_zero():
        return "0e-400"
    places = int((-(2 * arb(x.abs_upper())).log() / arb(10).log()).floor().unique_fmpz() or 0)
    if places < ENCLOSED_DIGITS:
        raise Uncertified("the ball around 0 is too wide")
    return f"0e-{places}"


def kinks_of(problem: Problem) -> str:
    """Say where f changes, and what a method needs to keep its order: RK4's last stage is behind a jump at t + h."""
    times = [f"{float(t):.6g}" for t in problem.reference.changes]
    at = f" at t = {', '.join(times[:_MOST_TIMES])}" if times else ""
    at += f" and {counted(len(times) - _MOST_TIMES, 'later time')}" if len(times) > _MOST_TIMES else ""
    steps = "a method keeps its order only if its steps end there, and no stage takes f from the other side"
    return f"{KINKED}{at}: {steps}, as a last one at t + h may, where rounding of t decides"


def matrix_in(field: VectorField) -> tuple[tuple[Fraction, ...], ...] | None:
    """A, if f(t, y) = A(y - c) or Ay + b(t) is written so in at most MOST_PROVED components, and no solution grows.

    Steps commute with the shift by c, so that what is proved of y' = Ay holds; with b(t) it holds of the difference of
    two solutions. Else None. A constant such as pi stands in A as the double with which steps are run.
    """
    in_doubles = tuple((name, x if isinstance(x, Fraction) else Fraction(float(x))) for name, x in field.parameters)
    if len(field.rates) > MOST_PROVED or (found := linear_part(replace(field, parameters=in_doubles))) is None:
        return None
    rows, at_origin = found
    try:
        with_b = [[as_fmpq(x) for x in (*row, b)] for row, b in zip(rows, at_origin or (0,) * len(rows), strict=True)]
        shifted = fmpq_mat(with_b).rank() == fmpq_mat([row[:-1] for row in with_b]).rank()  # b is in the range of A
        bounded = SystemFacts(METHODS["implicit_midpoint"], rows).step_limit == ALWAYS
    except (TypeError, ValueError, ArithmeticError):
        return None
    return rows if bounded and shifted and (at_origin is not None or any(map(any, rows))) else None
