"""The step of a method for q' = v, v' = F(q), as a function of numbers of any type.

Its text is the straight-line program text of `explicit_steps.field_source`, without zero terms. It contains no number
and no branch on a value, so it works in every arithmetic to which the coefficients are converted: steps are run in
floats, in fractions and with polynomials, and traced to derive rounding bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.explicit_steps import CalledField, FieldSource, field_source
from driftproof.methods.programs.program_text import indented, maker, maker_text
from driftproof.methods.schemes import Method

# Any type with + and * (and what its force needs); the arithmetic is the type's own.
Number: TypeAlias = Any
Force: TypeAlias = Callable[[Number], Number]
Step: TypeAlias = Callable[[Force, Number, Number, Number], tuple[Number, Number]]
# Converts an Exact; not typed so, because an arithmetic may accept rational coefficients only.
Lift: TypeAlias = Callable[[Any], Number]


def step_source(method: Method) -> FieldSource:
    """The lines of a step, which read q, v, h, force and the coefficients, and define q_new and v_new.

    Raises MethodError for an implicit method, whose stages are equations rather than formulas.
    """
    return field_source(method, CalledField(("q", "v"), "force({1})", autonomous=True))


def stepper(method: str | Path | Method, lift: Lift) -> Step:
    """The step (force, q, v, h) → (q₁, v₁) of `method` for q' = v, v' = force(q): the text of `step_source`.

    `lift` converts each exact coefficient to the number type of q, v and h. It is needed because coercion would turn
    `Fraction * ndarray` into an object array and `Fraction * float32` into a Python float.
    Raises MethodError for an implicit method, whose stages are equations rather than formulas.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, stepper
    >>> step = stepper(METHODS["rk4"], Fraction)
    >>> step(lambda q: -q, Fraction(1), Fraction(0), Fraction(1, 2))
    (Fraction(337, 384), Fraction(-23, 48))
    """
    make, coefficients = _compiled(method_of(method))
    step: Step = make(*(lift(c) for c in coefficients))
    return step


@cache
def _compiled(method: Method) -> tuple[Callable[..., Step], tuple[Exact, ...]]:
    source = step_source(method)
    lines = ["def step(force, q, v, h):", *indented([*source.lines, "return q_new, v_new"])]
    text = maker_text([name for name, _ in source.coefficients], "step", lines)
    return maker(text, method.key), tuple(c for _, c in source.coefficients)


def oscillator(q: Number) -> Number:
    """F(q) = -q, the acceleration of the normalised oscillator q' = v, v' = -q."""
    return -q
