"""One step of any method, over any kind of number: its program text, with the coefficients of that arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

from driftproof.methods.number_field import Exact
from driftproof.methods.program_text import maker
from driftproof.methods.schemes import Method
from driftproof.methods.source import step_source

# Any type with + and * (and what its force needs); the arithmetic is the type's own.
Number: TypeAlias = Any
Force: TypeAlias = Callable[[Number], Number]
Step: TypeAlias = Callable[[Force, Number, Number, Number], tuple[Number, Number]]
# From an Exact; not typed so, because an arithmetic may know rationals only and refuse the rest.
Lift: TypeAlias = Callable[[Any], Number]


def stepper(method: Method, lift: Lift) -> Step:
    """The step (force, q, v, h) → (q₁, v₁) of `method` for q' = v, v' = force(q): the text of `methods.source`.

    `lift` carries each exact coefficient into the number type of q, v and h. It is the only way in: relying on
    coercion would turn `Fraction * ndarray` into an object array and `Fraction * float32` into a Python float.
    Raises MethodError for an implicit method, whose stages are equations rather than formulas.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, stepper
    >>> step = stepper(METHODS["rk4"], Fraction)
    >>> step(lambda q: -q, Fraction(1), Fraction(0), Fraction(1, 2))
    (Fraction(337, 384), Fraction(-23, 48))
    """
    make, coefficients = _compiled(method)
    step: Step = make(*(lift(c) for c in coefficients))
    return step


@cache
def _compiled(method: Method) -> tuple[Callable[..., Step], tuple[Exact, ...]]:
    source = step_source(method)
    return maker(source.step(), method.key), tuple(c for _, c in source.coefficients)
