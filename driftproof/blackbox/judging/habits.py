"""Why a step is beyond the bound of a method that it is otherwise: a habit of codes, or coefficients of few digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import log10

from driftproof.blackbox.judging.agreement import EXAMPLES, NO_ALLOWANCE, ORDINARY_DOMAIN, Agreement, Domain, agreement
from driftproof.blackbox.judging.tolerance import Allowance, Tolerance
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import fixed, significant

# What codes do besides rounding the method's sums and products.
HABITS: dict[str, Callable[[Allowance], Allowance]] = {
    "if h is rounded to binary32 first": lambda given: replace(given, step_in_binary32=True),
    "if the velocity is a difference of positions over h": lambda given: replace(given, velocity_from_positions=True),
}
ROUNDED = "if its coefficients are rounded to"
# Digits more and fewer than the size of an error tells are tried: h and the states weigh it by some powers of ten.
_DIGITS_AROUND = 2
# A source with fewer digits is no rounding of the method.
_FEWEST = 5


def explained(
    subject: ForeignStepper,
    method: Method,
    allowance: Allowance = NO_ALLOWANCE,
    domain: Domain = ORDINARY_DOMAIN,
    examples: int = EXAMPLES,
) -> Agreement:
    """The agreement; where it does not hold, with the first of the habits, or number of digits, with which it does.

    Raises ValueError as `agreement` does.
    """
    found = agreement(subject, method, allowance, domain, examples)
    if found.failing is None or found.failing.answer is None:
        return found
    for words, allowed in HABITS.items():
        if allowed(allowance) != allowance and agreement(subject, method, allowed(allowance), domain, examples).holds:
            return replace(found, but_for=words)
    q, v, h, answer = found.failing.q, found.failing.v, found.failing.h, found.failing.answer
    near: list[tuple[float, str, Method]] = []
    for words, rounded in _of_few_digits(method, found.largest_scaled_error * float(subject.format.u)):
        judged = Tolerance(rounded, subject.format, allowance).judge(q, v, h, answer)
        if all(component.allowed for component in judged):
            near.insert(0, (max(component.ratio for component in judged), words, rounded))
    # The same numbers are said with the fewest digits, which are tried last and stand first.
    for _, words, rounded in sorted(near, key=lambda each: each[0]):
        if agreement(subject, rounded, allowance, domain, examples).holds:
            return replace(found, but_for=f"{ROUNDED} {words}")
    return found


def _of_few_digits(method: Method, error: float) -> Iterator[tuple[str, Method]]:
    """The method with its coefficients as a source prints them whose digits end about where the error is."""
    if not error:  # but in the range of underflow
        return
    middle = round(-log10(error))
    for digits in range(middle + _DIGITS_AROUND, max(_FEWEST, middle - _DIGITS_AROUND) - 1, -1):
        for words, text in ((f"{digits} decimals", fixed), (f"{digits} significant digits", significant)):
            rounded = _with_coefficients(method, partial(_rounded, text, digits))
            if rounded is not None and rounded != method:
                yield words, rounded


def _rounded(text: Callable[[Exact, int], str], digits: int, x: Exact) -> Fraction:
    return Fraction(text(x, digits))


def _with_coefficients(method: Method, change: Callable[[Exact], Fraction]) -> Method | None:
    """The same method with other numbers; None for a kind that is not given by a table."""

    def row(numbers: tuple[Exact, ...]) -> tuple[Exact, ...]:
        return tuple(map(change, numbers))

    if isinstance(method, Splitting):
        return replace(method, parts=tuple((kind, change(x)) for kind, x in method.parts))
    if isinstance(method, RungeKutta):
        rows = tuple(map(row, method.a))
        return replace(method, a=rows, b=row(method.b), c=row(method.c), b_embedded=None, embedded_order=None)
    if isinstance(method, Nystrom):
        position, velocity = row(method.b_position), row(method.b_velocity)
        return replace(method, a=tuple(map(row, method.a)), c=row(method.c), b_position=position, b_velocity=velocity)
    return None
