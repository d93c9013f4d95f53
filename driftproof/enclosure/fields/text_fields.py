"""Right-hand sides given as text, run on enclosed numbers, on which their constants are exact, and on floats."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from fractions import Fraction
from math import floor
from typing import Any, TypeAlias

import numpy as np

from driftproof.enclosure.arithmetic.clocks import exact_constant
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import RightHandSide, time_first
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.methods.formulas.vector_fields import FLOOR, FUNCTIONS, VectorField, partial_derivative
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.program_text import indented, maker, maker_text
from driftproof.symbolic.algebra.certified import enclose

# The forms in which a user may give f: a function of (t, y), text, or a field.
GivenField: TypeAlias = RightHandSide | str | Sequence[str] | VectorField


def right_hand_side(f: GivenField, components: int) -> RightHandSide:
    """The function itself, or that of a text or a `VectorField` of so many components. Raises ValueError for others.

    >>> right_hand_side("y1; -y0", 2)(0.0, [1.0, 0.5])
    [0.5, -1.0]
    """
    field = given_field(f)
    if not isinstance(field, VectorField):
        return time_first(field)
    if len(field.rates) != components:
        raise ValueError(f"f has {len(field.rates)} components, but the trajectory has {components}")
    return field_function(field)


def given_field(f: GivenField) -> RightHandSide | VectorField:
    """A function as it is, and the field of a text. Raises ValueError."""
    if callable(f) or isinstance(f, VectorField):
        return f
    try:
        return field_of_text(f)
    except ValueError as error:
        raise ValueError(f"f is not a right-hand side: {error}") from None
    except (TypeError, AttributeError):
        raise ValueError(f"f is not a right-hand side but a {type(f).__name__}; give f(t, y) or its text") from None


def field_function(field: VectorField, expressions: Sequence[str] | None = None) -> RightHandSide:
    """f(t, y) of a field, or a function for other expressions in its names, such as first integrals.

    For a Fraction t it computes exactly, and raises TypeError if a rate uses a function such as sin.
    """
    rates = field.rates
    if expressions is not None:
        rest = ("0",) * (len(rates) - len(expressions))
        rates = VectorField((*expressions, *rest), field.parameters).rates[: len(expressions)]
    trees = _Numbered()
    texts = [ast.unparse(trees.visit(ast.parse(rate, mode="eval"))) for rate in rates]
    exact: list[Exact] = [*map(Fraction, trees.numbers), *(value for _, value in field.parameters)]
    names = [*trees.numbers.values(), *(name for name, _ in field.parameters)]
    smooth = field.smooth

    def numbers(t: Any) -> list[Any]:
        if isinstance(t, Fraction):
            return list(exact)
        balls = [enclose(x) for x in exact]
        if isinstance(t, Enclosed) and not smooth:  # where the time is compared with them, as exact constants
            return [exact_constant(t.evaluation, x, ball) for x, ball in zip(exact, balls, strict=True)]
        if isinstance(t, Enclosed):
            return [Enclosed(t.evaluation, ball) for ball in balls]
        return [float(ball.mid()) for ball in balls]

    lines = [f"[{', '.join(field.components)}] = y", f"[{', '.join(names)}] = ν(t)", f"return [{', '.join(texts)}]"]
    text = maker_text((), "f", ["def f(t, y):", *indented(lines)])
    known = {"ν": numbers, FLOOR: floor, **{name: getattr(np, name) for name in FUNCTIONS}}
    made: RightHandSide = maker(text, "right-hand side", known)()
    return made


def linear_part(field: VectorField) -> tuple[tuple[tuple[Fraction, ...], ...], tuple[Fraction, ...] | None] | None:
    """A and b, if f(t, y) = Ay + b is written so in rational numbers, with A(y - c) among them; else None.

    For a b that depends on the time, as a force that is switched does, A alone has to be rational, and b is None.
    """
    n, zero = len(field.rates), Fraction(0)
    slopes = [partial_derivative(rate, y) for rate in field.rates for y in field.components]
    if not field.linear or not VectorField(tuple(slopes), field.parameters).autonomous:
        return None
    wanted = [slopes, None] if field.autonomous else [slopes]
    try:
        numbers, *at_origin = (tuple(map(Fraction, field_function(field, x)(zero, [zero] * n))) for x in wanted)
    except (TypeError, ValueError, ArithmeticError):
        return None
    return tuple(numbers[i : i + n] for i in range(0, n * n, n)), at_origin[0] if at_origin else None


class _Numbered(ast.NodeTransformer):
    """Replaces integers by names, so that 1/10 is computed in the arithmetic of y and not in floats.

    The names begin with a letter that names in users' texts cannot have.
    """

    def __init__(self) -> None:
        self.numbers: dict[int, str] = {}

    def visit_Constant(self, node: ast.Constant) -> ast.Name:
        return ast.Name(self.numbers.setdefault(int(str(node.value)), f"ν{len(self.numbers)}"), ast.Load())
