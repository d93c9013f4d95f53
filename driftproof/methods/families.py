"""Families of Runge-Kutta methods with one free parameter, as exact data. To add one, add an entry to FAMILIES.

>>> from fractions import Fraction
>>> from driftproof import FAMILIES, Facts
>>> Facts(FAMILIES["explicit_order_2"].member(Fraction(2, 3))).order
2
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from driftproof.methods.expressions import parse_function
from driftproof.methods.number_field import Exact
from driftproof.methods.parameters import Function
from driftproof.methods.schemes import MethodError, RungeKutta


@dataclass(frozen=True)
class Family:
    """The methods with tableau (A, b, c), whose entries are rational functions over Q of one real parameter.

    `claimed_order` is what the source claims for every value, 0 where it claims nothing. `source` is a key of
    `references.bib` and a place in it. Raises MethodError for a tableau that is not square or has no stage.
    """

    key: str
    title: str
    parameter: str
    claimed_order: int
    source: str
    a: tuple[tuple[Function, ...], ...]
    b: tuple[Function, ...]
    c: tuple[Function, ...]

    def __post_init__(self) -> None:
        """Refuse a tableau whose parts disagree in length."""
        if not self.b or {len(self.a), len(self.c), *map(len, self.a)} != {len(self.b)}:
            raise MethodError(f"{self.key}: A needs as many rows and columns as b and c have entries, one at least")

    @property
    def stages(self) -> int:
        """The number s of slopes."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """True when no slope depends on itself or on a later one, whatever the parameter."""
        return not any(x for i, row in enumerate(self.a) for x in row[i:])

    def member(self, value: Exact) -> RungeKutta:
        """The method at one value of the parameter, claimed order 0. Raises MethodError where an entry has a pole."""
        name = f"{self.key} at {self.parameter} = {value}"
        try:
            a = tuple(tuple(f(value) for f in row) for row in self.a)
            b, c = (tuple(f(value) for f in row) for row in (self.b, self.c))
        except ZeroDivisionError:
            raise MethodError(
                f"{self.key}: no method at {self.parameter} = {value}, a pole of its coefficients"
            ) from None
        return RungeKutta(key=name, title=name, claimed_order=0, source=self.source, a=a, b=b, c=c)


def _family(
    key: str,
    title: str,
    parameter: str,
    *,
    claimed_order: int,
    source: str,
    a: Sequence[Sequence[str]],
    b: Sequence[str],
    c: Sequence[str],
) -> Family:
    def read(entries: Sequence[str]) -> tuple[Function, ...]:
        return tuple(parse_function(text, parameter, key) for text in entries)

    return Family(key, title, parameter, claimed_order, source, tuple(map(read, a)), read(b), read(c))


_ENTRIES = (
    # Two equal diagonal entries; order 3 for gamma = 1/2 ± sqrt(3)/6.
    _family(
        "sdirk_order_2",
        "Two-stage SDIRK methods of order 2",
        "gamma",
        claimed_order=2,
        source="hairer-wanner-1996, IV.6",
        a=(("gamma", "0"), ("1 - 2*gamma", "gamma")),
        b=("1/2", "1/2"),
        c=("gamma", "1 - gamma"),
    ),
    # The last stage is the result; order 2 for gamma = 1 ± sqrt(2)/2 only.
    _family(
        "sdirk_stiffly_accurate",
        "Two-stage stiffly accurate SDIRK methods",
        "gamma",
        claimed_order=1,
        source="hairer-wanner-1996, IV.6",
        a=(("gamma", "0"), ("1 - gamma", "gamma")),
        b=("1 - gamma", "gamma"),
        c=("gamma", "1"),
    ),
    # Heun at 1, the midpoint rule at 1/2, Ralston at 2/3.
    _family(
        "explicit_order_2",
        "Two-stage explicit methods of order 2",
        "alpha",
        claimed_order=2,
        source="butcher-2016, 231",
        a=(("0", "0"), ("alpha", "0")),
        b=("1 - 1/(2*alpha)", "1/(2*alpha)"),
        c=("0", "alpha"),
    ),
)
FAMILIES: dict[str, Family] = {family.key: family for family in _ENTRIES}
