"""Turning a user's right-hand side into text that every engine can run, by runs on names instead of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.branches import Branching, Condition, on_all_branches
from driftproof.enclosure.fields.fields import RightHandSide, enclosable, enclosed_rates
from driftproof.methods.formulas.vector_fields import FLOOR, FUNCTIONS, VectorField
from driftproof.methods.numbers.flint_rationals import dyadic

# Larger integers become parameters, since compilers have 64-bit integers.
_LARGEST_LITERAL = 2**31
# chosen: text that is longer comes from a loop, and not from a formula.
_LONGEST_TRACE = 100_000


def field_of_function(f: RightHandSide, components: int) -> VectorField:
    """y' = f(t, y) as text in t, y0, y1, ...; the doubles in f become parameters with exactly their values.

    f is run once for each way that its comparisons may go, and what these runs give becomes choices in the text. Raises
    Refused if they are too many, or if f uses a function that a `VectorField` does not have.

    >>> field_of_function(lambda t, y: [y[1], -0.5 * y[0]], 2)
    VectorField(rates=('y1', '(y0 * double_0)'), parameters=(('double_0', Fraction(-1, 2)),))
    """
    doubles, traced = dict[Fraction, str](), enclosable(f)

    def run(outcomes: Sequence[bool]) -> tuple[list[str], Branching]:
        evaluation = _Tracing(doubles, outcomes)
        names = [Enclosed(evaluation, Traced(f"y{i}", doubles)) for i in range(components)]
        found = enclosed_rates(traced, Enclosed(evaluation, Traced("t", doubles)), names)
        return [Traced.of(rate.value, doubles).text for rate in found], evaluation

    def chosen(condition: Condition, texts: list[str], others: list[str]) -> list[str]:
        greater = " ".join(map(str, condition))
        pairs = zip(texts, others, strict=True)
        return [one if one == other else f"({one} if {greater} else {other})" for one, other in pairs]

    rates = on_all_branches(run, chosen)
    return VectorField(tuple(rates), tuple((name, value) for value, name in doubles.items()))


class _Tracing(Branching):
    """A run on names, in which constants become integers or names, too."""

    def __init__(self, names: dict[Fraction, str], outcomes: Sequence[bool]) -> None:
        super().__init__(outcomes)
        self.names = names

    def constant(self, x: object) -> Traced:
        if isinstance(x, Fraction):  # a knot of data, perhaps
            return Traced.of_fraction(x, self.names)
        return Traced.of(super().constant(x), self.names)

    def decide(self, greater: Traced, less: Traced, at_zero: bool = False) -> bool:
        """The outcome of this run, the same each time that f asks."""
        return self.outcome(greater.text, less.text, at_zero)

    def written(self, name: str, x: Traced) -> Traced:
        """The call as text, also of |x|, which a comparison makes elsewhere. Refused unless a field may hold it."""
        if name not in (*FUNCTIONS, FLOOR):
            may = ", ".join(FUNCTIONS)
            raise Refused(f"f uses {name}; a problem may use {may}, and certify takes other functions")
        return Traced(f"{name}({x.text})", self.names)

    def function(self, name: str, x: Traced) -> Traced:
        """The call as text."""
        return self.written(name, x)

    def is_positive(self, x: Traced) -> bool:
        """False: of a name nothing is certain."""
        return False


class Traced:
    """The text of a value. `divisor` is d if the text is 1/d, so that a quotient is written as one division."""

    def __init__(self, text: str, doubles: dict[Fraction, str], divisor: str = "") -> None:
        """Take the text, and the names given to doubles so far. Raises Refused if the text is too long."""
        if len(text) > _LONGEST_TRACE:
            raise Refused(f"f is too long as text: over {_LONGEST_TRACE} characters")
        self.text, self.doubles, self.divisor = text, doubles, divisor

    @classmethod
    def of(cls, x: Any, doubles: dict[Fraction, str]) -> Traced:
        """The value itself if it is traced; an exact ball as an integer or a parameter."""
        if isinstance(x, Traced):
            return x
        ball = arb(x)
        if not ball.is_exact():
            raise Refused("f uses a number that is not a double")
        return cls.of_fraction(dyadic(ball), doubles)

    @classmethod
    def of_fraction(cls, value: Fraction, doubles: dict[Fraction, str]) -> Traced:
        """An integer, or a parameter."""
        if value.denominator == 1 and abs(value) < _LARGEST_LITERAL:
            return cls(str(value) if value >= 0 else f"({value})", doubles)
        return cls(doubles.setdefault(value, f"double_{len(doubles)}"), doubles)

    def _with(self, sign: str, other: Any) -> Traced:
        a, b = self, Traced.of(other, self.doubles)
        if sign == "*" and b.divisor and not a.divisor:
            return Traced(f"({a.text} / {b.divisor})", self.doubles)
        divisor = b.text if sign == "/" and a.text == "1" else ""
        return Traced(f"({a.text} {sign} {b.text})", self.doubles, divisor)

    def __add__(self, other: Any) -> Traced:
        return self._with("+", other)

    def __mul__(self, other: Any) -> Traced:
        """The product, or a quotient if the factor is a reciprocal."""
        return self._with("*", other)

    __rmul__ = __mul__

    def __rtruediv__(self, other: Any) -> Traced:
        return Traced.of(other, self.doubles)._with("/", self)

    def __neg__(self) -> Traced:
        return Traced(f"(-{self.text})", self.doubles)

    def __sub__(self, other: Any) -> Traced:
        return self._with("-", other)
