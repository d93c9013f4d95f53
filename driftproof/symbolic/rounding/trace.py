"""A step run on `Rounded` numbers, and the list of operations that it turned out to be."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import TypeAlias

from driftproof.methods.problems import oscillator
from driftproof.methods.schemes import Method
from driftproof.methods.stepping import Force, Lift, Step, stepper
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.rounding.formats import FloatFormat
from driftproof.symbolic.rounding.number import RefusedOperation, Rounded, constant, rational_value
from driftproof.symbolic.rounding.polynomials import H, Polynomial, Q, V, majorant, terms

# What a bound can be asked about: a method of the catalogue, or anybody's step function.
Subject: TypeAlias = Method | Step
# Powers of (q, v), or of (h, q, v), with their coefficients.
Terms: TypeAlias = dict[tuple[int, ...], Fraction]


class NotLinear(ValueError):
    """The step is not linear in the state, so it has no one-step matrix and no error matrix."""


def trace(subject: Subject, fmt: FloatFormat, force: Force = oscillator, h: Fraction | None = None) -> list[Rounded]:
    """[q1, v1] of one step from symbolic (q, v), by running the step itself; `subject` is it, or a method.

    With `h` given (a number of the format) the step size is that constant rather than a symbol. Raises
    RefusedOperation where the step does what cannot be bounded.
    """
    size = Rounded(fmt, H) if h is None else constant(h, fmt)
    step = subject if callable(subject) else stepper(subject, lift_to(fmt))
    result = step(force, Rounded(fmt, Q), Rounded(fmt, V), size)
    outputs = list(result) if isinstance(result, Iterable) else []
    if len(outputs) != 2:
        raise RefusedOperation(f"the step returned {result!r}; it must return the pair (q1, v1)")
    return [x if isinstance(x, Rounded) else constant(_demand_number(x), fmt) for x in outputs]


def lift_to(fmt: FloatFormat) -> Lift:
    """The lift of exact coefficients to floats of the format: 1/6 becomes the nearest one, and owns up to it."""
    return lambda exact: constant(exact, fmt)


def program_of(method: Method, fmt: FloatFormat) -> Step:
    """The generic step of a definition with the coefficients that its program holds: what it computes up to rounding.

    To the definition itself this is another method, by the rounding of its coefficients.
    """
    return stepper(method, lambda exact: decide_by_enclosure(exact, fmt.nearest))


def program(outputs: Iterable[Rounded]) -> list[Rounded]:
    """Every number the outputs depend on, operands before results, each once."""
    order: dict[int, Rounded] = {}

    def visit(x: Rounded) -> None:
        if id(x) not in order:
            for operand, _ in x.operands:
                visit(operand)
            order[id(x)] = x

    for output in outputs:
        visit(output)
    return list(order.values())


def magnitude(x: Rounded) -> Polynomial:
    """|x| + error, a bound on |x^|, and on what was rounded to give it."""
    return majorant(x.exact) + x.error


def in_format(polynomial: Polynomial, fmt: FloatFormat) -> Terms:
    """The polynomial in (h, q, v) that is left when the format's own d and eta are put in."""
    left: Terms = {}
    for (in_d, in_eta, *powers), c in terms(polynomial):
        value = c * fmt.relative_error**in_d * fmt.eta**in_eta
        left[tuple(powers)] = left.get(tuple(powers), Fraction(0)) + value
    return left


def at_step(by_powers: Terms, h: Fraction) -> Terms:
    """The polynomial in (q, v) that is left at this h."""
    left: Terms = {}
    for (in_h, *powers), c in by_powers.items():
        left[tuple(powers)] = left.get(tuple(powers), Fraction(0)) + c * h**in_h
    return left


def at_state(by_powers: Terms, q: Fraction, v: Fraction) -> Fraction:
    """The value at this (q, v)."""
    return sum((c * q**in_q * v**in_v for (in_q, in_v), c in by_powers.items()), Fraction(0))


def _demand_number(x: object) -> Fraction:
    exact = rational_value(x)
    if exact is None:
        raise RefusedOperation(f"the step returned {x!r}, which is {type(x).__name__} and not a number")
    return exact
