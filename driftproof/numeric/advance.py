"""Run any method on any problem step by step: explicit ones by program text, others by loops that solve equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.methods.catalogue import Entry, of_one_state
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.multistep import Multistep
from driftproof.methods.programs.program_text import indented, maker_text
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.run import nearest_double
from driftproof.numeric.steppers import evaluations_per_step
from driftproof.numeric.steps.engine import compiled_runner, elementwise, program_function, runner
from driftproof.numeric.steps.implicit import ImplicitRun, implicit_runner
from driftproof.numeric.steps.multistep import MultistepRun, multistep_runner
from driftproof.numeric.steps.rosenbrock import rosenbrock_runner

State: TypeAlias = Sequence[float]
Rate: TypeAlias = Callable[[float, Any], list[float]]
# advance(y, h, first, last) -> y after steps first to last - 1, step i starting at t = i h.
Advance: TypeAlias = Callable[[State, float, int, int], State]


def advance(method: Entry, problem: Problem, *, compiled: bool = False) -> Advance:
    """Return advance(y, h, first, last) -> y of the method on the problem, in Python floats or compiled by numba.

    The states of a multistep method carry those before; see `MultistepRun`. Raises MethodError if the method does not
    apply, such as a splitting on a problem of first order. The function that it returns raises ArithmeticError or
    ValueError if floats overflow, f is undefined or stages are not found.
    """
    if isinstance(method, Multistep):
        start = lambda first: advance(first, problem, compiled=compiled)
        return multistep_runner(method, problem.field, start, compiled=compiled)
    if isinstance(method, Rosenbrock):
        return rosenbrock_runner(method, problem.field, compiled=compiled)
    one_step = of_one_state(method)
    if one_step.explicit:
        return (compiled_runner if compiled else runner)(one_step, problem.field)
    return implicit_runner(one_step, problem.field, compiled=compiled)


def evaluations_of(run: Advance, method: Entry, steps: int) -> int:
    """The number of evaluations of f by `run`, which has taken `steps` steps since it was made."""
    if isinstance(run, MultistepRun):
        return run.calls + evaluations_of(run.starter, run.start_method, run.begun)
    return run.calls if isinstance(run, ImplicitRun) else steps * evaluations_per_step(of_one_state(method))


def error_summary(error: Exception) -> str:
    """Why a run could not go on, in one line: the `reason` of the error if it has one, else its message."""
    return getattr(error, "reason", "") or " ".join(str(error).split())


def float_step(t: Fraction, steps: int) -> float:
    """The double h used as the size of N steps to t. Raises ValueError for no step, or an h that no double is near to.

    The steps end at N h, exactly. Unless h is subnormal, |h - t/N| <= u|t/N| and so |N h - t| <= u|t|, as if t itself
    were rounded. The time fl(i h) of step i is within (2u + u²)|i t/N| of i t/N, while a sum of i times h may be off by
    i²u|h|/2 more.
    """
    if steps < 1:
        raise ValueError(f"steps is {steps}; must be at least 1")
    return nearest_double(t / steps, "h = t / steps")


def float_start(problem: Problem) -> State:
    """The start of the problem in floats, each component rounded once."""
    return tuple(nearest_double(x, f"start y{i}") for i, x in enumerate(problem.start))


def field_rate(field: VectorField, functions: Mapping[str, Any] | None = None) -> Rate:
    """Return f(t, y) of the field as a function of a number and a sequence of numbers, whose value is a list.

    `functions` are those of such numbers, see `engine.functions_of`. Without them y is converted to Python floats,
    whose overflows and divisions by zero raise.
    """
    names = [name for name, _ in field.parameters]
    numbers = "map(float, y)" if functions is None else "y"
    lines = [f"{''.join(f'{y}, ' for y in field.components)}= {numbers}", f"return [{', '.join(field.at({}))}]"]
    text = maker_text(names, "run", ["def run(t, y):", *indented(lines)])  # called run, as no parameter may be
    if functions is None:
        return program_function(text, "run", field.parameters)
    return program_function(elementwise(text), "run", field.parameters, functions)


def rests_at_origin(problem: Problem) -> bool:
    """True if f(0, 0) = 0 in floats at all times, as where c is 0 in f(t, y) = A(y - c)."""
    return problem.field.autonomous and not any(field_rate(problem.field)(0.0, (0.0,) * len(problem.start)))
