"""Families of Runge-Kutta methods with one free parameter, as exact data. To add one, add an entry to _TABLES.

>>> from fractions import Fraction
>>> from driftproof import FAMILIES, Facts
>>> Facts(FAMILIES["explicit_order_2"].member(Fraction(2, 3))).order
2
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from typing import TYPE_CHECKING, ClassVar, TypeAlias

from driftproof.methods.names import KeyedTable, UnknownKey
from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.support.plain_text import shortened

if TYPE_CHECKING:
    from flint import fmpq, fmpq_poly

    Coefficients: TypeAlias = fmpq_poly | Sequence[object]


@dataclass(frozen=True)
class ParameterFunction:
    """A rational function num/den over Q in lowest terms, with den monic, made by `parameter_function`.

    Its arithmetic takes int, Fraction and its own kind; anything else raises TypeError.
    """

    num: fmpq_poly
    den: fmpq_poly

    @property
    def coefficients(self) -> list[fmpq]:
        """The coefficients of the numerator, then those of the denominator."""
        return [*self.num.coeffs(), *self.den.coeffs()]

    def __call__(self, value: Exact) -> Exact:
        """The value of the function at a value of the parameter. Raises ZeroDivisionError at a pole."""
        if isinstance(value, Fraction):
            return as_fraction(self.num(as_fmpq(value)) / self.den(as_fmpq(value)))
        num, den = (
            reduce(lambda found, c: found * value + c, reversed(p.coeffs()), 0 * value) for p in (self.num, self.den)
        )
        return num / den

    def __bool__(self) -> bool:
        """False for the function that is zero everywhere."""
        return bool(self.num)

    def __add__(self, other: object) -> ParameterFunction:
        g = _coerced(other)
        return parameter_function(self.num * g.den + g.num * self.den, self.den * g.den)

    __radd__ = __add__

    def __neg__(self) -> ParameterFunction:
        return ParameterFunction(-self.num, self.den)

    def __sub__(self, other: object) -> ParameterFunction:
        return self + -_coerced(other)

    def __rsub__(self, other: object) -> ParameterFunction:
        return -self + other

    def __mul__(self, other: object) -> ParameterFunction:
        g = _coerced(other)
        return parameter_function(self.num * g.num, self.den * g.den)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> ParameterFunction:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        g = _coerced(other)
        return self * parameter_function(g.den, g.num)

    def __rtruediv__(self, other: object) -> ParameterFunction:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        return _coerced(other) / self


def parameter_function(
    num: fmpq_poly | Sequence[object], den: fmpq_poly | Sequence[object] = (1,)
) -> ParameterFunction:
    """The function num/den of polynomials or coefficients, constant term first. Raises ZeroDivisionError if den = 0."""
    from flint import fmpq_poly

    top, bottom = (p if isinstance(p, fmpq_poly) else fmpq_poly([as_fmpq(x) for x in p]) for p in (num, den))
    if bottom == 0:
        raise ZeroDivisionError("the denominator is the zero polynomial")
    common = top.gcd(bottom) * bottom.leading_coefficient()
    return ParameterFunction(top // common, bottom // common)


def _coerced(x: object) -> ParameterFunction:
    if isinstance(x, ParameterFunction):
        return x
    try:
        return parameter_function((x,))
    except TypeError:
        kind = type(x).__name__
        raise TypeError(f"no exact arithmetic between a function of a parameter and {x!r} ({kind})") from None


def parse_function(text: str, parameter: str, what: str) -> ParameterFunction:
    """The rational function of the parameter that `text` spells, e.g. "1 - 1/(2*alpha)", with rational numbers only.

    Raises ValueError, in one line that begins with `what`.
    """
    from driftproof.methods.formulas.expressions import (
        evaluate_expression,  # not needed for methods without a parameter
    )

    unknown = f"is an unknown name; the parameter is {parameter}"
    value = evaluate_expression(text, {parameter: parameter_function((0, 1))}, what, unknown)
    if not isinstance(value, ParameterFunction | Fraction):
        raise ValueError(f"{what}: {shortened(text)!r} is irrational; with a parameter, all numbers must be rational")
    return value if isinstance(value, ParameterFunction) else parameter_function((value,))


@dataclass(frozen=True)
class Family:
    """The Runge-Kutta methods with a tableau (A, b, c) of rational functions over Q of one real parameter.

    `claimed_order` is the order that the source claims for every value, 0 if it claims none. `source` is a key of
    `references.bib` and a place in it. Raises MethodError for a tableau that is not square or has no stage.
    """

    key: str
    title: str
    parameter: str
    claimed_order: int
    source: str
    a: tuple[tuple[ParameterFunction, ...], ...]
    b: tuple[ParameterFunction, ...]
    c: tuple[ParameterFunction, ...]
    kind: ClassVar[str] = "a family of methods, of which `at` chooses one"

    def __post_init__(self) -> None:
        """Raise MethodError for a tableau whose parts differ in length."""
        if not self.b or {len(self.a), len(self.c), *map(len, self.a)} != {len(self.b)}:
            raise MethodError(f"{self.key}: A needs as many rows and columns as b and c have entries, at least one")

    @property
    def stages(self) -> int:
        """The number s of stages."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """True if no stage depends on itself or on a later one, for any value of the parameter."""
        return not any(x for i, row in enumerate(self.a) for x in row[i:])

    def member(self, value: Exact) -> RungeKutta:
        """The method at one value of the parameter, with claimed order 0. Raises MethodError if an entry has a pole."""
        at = f"at {self.parameter} = {value}"
        try:
            a = tuple(tuple(f(value) for f in row) for row in self.a)
            b, c = (tuple(f(value) for f in row) for row in (self.b, self.c))
        except ZeroDivisionError:
            raise MethodError(f"{self.key} is not defined {at}, a pole of its coefficients") from None
        return RungeKutta(
            key=f"{self.key} {at}", title=f"{self.title} {at}", claimed_order=0, source=self.source, a=a, b=b, c=c
        )


# Title, parameter, order, source; then the tableau as books print it, its columns separated by commas.
_TABLES = {
    # Two equal diagonal entries; order 3 for gamma = 1/2 ± sqrt(3)/6.
    "sdirk_order_2": """Two-stage SDIRK methods of order 2 | gamma | 2 | hairer-wanner-1996, IV.6
        gamma     | gamma, 0
        1 - gamma | 1 - 2*gamma, gamma
                  | 1/2, 1/2""",
    # The last stage is the result; the order is 2 only for gamma = 1 ± sqrt(2)/2.
    "sdirk_stiffly_accurate": """Two-stage stiffly accurate SDIRK methods | gamma | 1 | hairer-wanner-1996, IV.6
        gamma | gamma, 0
        1     | 1 - gamma, gamma
              | 1 - gamma, gamma""",
    # Heun at 1, the midpoint rule at 1/2, Ralston at 2/3.
    "explicit_order_2": """Two-stage explicit methods of order 2 | alpha | 2 | butcher-2016, 231
        0     | 0, 0
        alpha | alpha, 0
              | 1 - 1/(2*alpha), 1/(2*alpha)""",
}


class _Families(KeyedTable[Family]):
    """The families by key, each read on its first use."""

    def __getitem__(self, key: str) -> Family:
        if key not in _TABLES:
            raise UnknownKey(key, self)
        return _read(key)

    def __iter__(self) -> Iterator[str]:
        return iter(_TABLES)

    def __len__(self) -> int:
        return len(_TABLES)


@cache
def _read(key: str) -> Family:
    names, *lines = _TABLES[key].splitlines()
    title, parameter, order, source = names.split(" | ")

    def functions(text: str) -> tuple[ParameterFunction, ...]:
        return tuple(parse_function(entry, parameter, key) for entry in text.split(","))

    *stages, (_, weights) = (line.split(" | ") for line in lines)
    c = tuple(parse_function(node, parameter, key) for node, _ in stages)
    rows = tuple(functions(a) for _, a in stages)
    return Family(key, title, parameter, int(order), source, rows, functions(weights), c)


FAMILIES: Mapping[str, Family] = _Families()
