"""Any method on any problem, step after step: explicit ones by program text, implicit ones by Newton's method."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from driftproof.methods.program_text import indented, maker, maker_text
from driftproof.methods.schemes import Method
from driftproof.methods.vector_fields import VectorField, field_source, jacobian_matrix
from driftproof.numeric.engine import OF_FLOATS, field_runner, lifted
from driftproof.numeric.implicit import Jacobian, implicit_stepper
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.run import nearest_double

State: TypeAlias = tuple[float, ...]
Rate: TypeAlias = Callable[[float, Any], list[float]]
# advance(y, h, first, last) -> y: steps first to last - 1, the i-th from t = i h.
Advance: TypeAlias = Callable[[State, float, int, int], State]


def advance(method: Method, problem: Problem, rate: Rate | None = None) -> Advance:
    """advance(y, h, first, last) -> y of the method on the problem, in Python floats.

    `rate` stands in for the problem's own, to count its calls say; only stages that are equations call it, and their
    Jacobian matrices are written out of the problem's text. Raises MethodError where the method does not apply: a
    splitting where the problem is of first order. What it returns may raise ArithmeticError or ValueError where floats
    end or stages are not found.
    """
    if method.explicit:
        return field_runner(method, problem.field)
    step = implicit_stepper(method, rate or field_rate(problem.field), field_jacobian(problem.field))

    def run(y: State, h: float, first: int, last: int) -> State:
        for i in range(first, last):
            y = tuple(map(float, step(i * h, y, h).y))
        return y

    return run


def error_summary(error: Exception) -> str:
    """Why a run could not go on, in one line: what the method says in a few words, else the error's own text."""
    return getattr(error, "reason", "") or " ".join(str(error).split())


class StepTimes(NamedTuple):
    """N steps from 0 towards t: `h` is the double that is run, `end` the time N h at which they end, exactly.

    With |h - t/N| <= u|t/N|, unless h is subnormal, |end - t| <= u|t|: as if t itself were rounded. To separate the
    error of a run from that of its times, compare with the solution at `end`. The time fl(i h) of step i is within
    (2u + u²)|i t/N| of i t/N, while a sum of i times h may be off by i²u|h|/2 more.
    """

    h: float
    end: Fraction


def step_times(t: Fraction, steps: int) -> StepTimes:
    """The times of `steps` steps to t. Raises ValueError for no step, and for an h that no double is near to."""
    if steps < 1:
        raise ValueError(f"steps is {steps}; at least one step leads to t")
    h = nearest_double(t / steps, "h = t / steps")
    return StepTimes(h, steps * Fraction(h))


def float_start(problem: Problem) -> State:
    """The start, each component rounded once."""
    return tuple(nearest_double(x, f"start y{i}") for i, x in enumerate(problem.start))


def field_rate(field: VectorField, functions: Mapping[str, Any] | None = None) -> Rate:
    """f(t, y) of the field as a function of a number and of a sequence of numbers; a list.

    `functions` are those of the numbers, by the names in `fields.FUNCTIONS`. Without them the numbers are taken as
    Python floats, whose overflows and divisions by zero raise.
    """
    rate: Rate = _function(field, f"[{', '.join(field.at({}))}]", functions)
    return rate


def field_jacobian(field: VectorField) -> Jacobian:
    """(t, y) -> the n x n matrix with ∂fᵢ/∂yⱼ in row i and column j, by exact formulas, in Python floats."""
    rows = ", ".join(f"[{', '.join(row)}]" for row in jacobian_matrix(field))
    return _function(field, f"[{rows}]", None)


def _function(field: VectorField, value: str, functions: Mapping[str, Any] | None) -> Callable[[float, Any], Any]:
    """(t, y) -> the value that the text spells. In its text it is called run, as no parameter may be."""
    names = [name for name, _ in field.parameters]
    numbers = "map(float, y)" if functions is None else "y"
    lines = [f"{''.join(f'{y}, ' for y in field.components)}= {numbers}", f"return {value}"]
    text = maker_text(names, "run", ["def run(t, y):", *indented(lines)])
    known = OF_FLOATS if functions is None else dict(functions)
    made: Callable[[float, Any], Any] = maker(text, "run", known)(*[lifted(c, np.float64) for _, c in field.parameters])
    return made


class Counted:
    """A rate that counts its calls, whatever they are for: stages, and Jacobian matrices formed by differences."""

    def __init__(self, rate: Callable[[float, Any], Any]) -> None:
        """Start at zero calls."""
        self.rate = rate
        self.calls = 0

    def __call__(self, t: float, y: Any) -> Any:
        """rate(t, y), counted."""
        self.calls += 1
        return self.rate(t, y)


def counted_evaluations(method: Method, problem: Problem, steps: int) -> int:
    """How often a run of so many steps computes f, or the accelerations, counted on the very text that is run.

    The text is a loop over straight lines, so that one step, in which a function stands where the last rate was and
    counts, tells those of N.
    """
    return steps * _calls_of_a_step(method, len(problem.start), problem.second_order)


@cache
def _calls_of_a_step(method: Method, components: int, second_order: bool) -> int:
    half = components // 2
    rates = [f"y{half + i}" if second_order and i < half else "-y0" for i in range(components)]
    source = field_source(method, VectorField((*rates[:-1], "sin(y0)")))
    calls = 0

    def counting(x: float) -> float:
        nonlocal calls
        calls += 1
        return x

    run = maker(source.run(), method.key, {"sin": counting})(*[lifted(c, np.float64) for _, c in source.coefficients])
    run((0.0,) * components, 0.0, 0, 1)
    return calls
