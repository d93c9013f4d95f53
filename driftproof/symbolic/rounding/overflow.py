"""For which states and steps no operation of a step overflows."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import Force
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat
from driftproof.symbolic.rounding.step import linear_bound
from driftproof.symbolic.rounding.trace import Subject, at_step, in_format, magnitude, program, trace


def largest_safe_state(
    subject: Subject, h: Fraction, fmt: FloatFormat = BINARY64, force: Force = oscillator
) -> Fraction:
    """The largest s for which |q|, |v| <= s proves that no operation of the step at h overflows.

    Each operation's result is a q + b v + c up to its error, both linear in the state, so each asks for
    (|a| + |b| + error per unit of state) s + |c| + error at the origin <= largest finite number; s is the least that
    they leave. Sufficient, not necessary. For a given state too, see `StepBound.is_safe`.
    Raises OverflowError if not even the origin is safe, NotLinear, RefusedOperation.
    """
    safe = fmt.largest
    for x in program(trace(subject, fmt, force, h)):
        terms = at_step(in_format(magnitude(x), fmt), Fraction(1))  # h is a constant of the program
        row = linear_bound(terms, terms)
        slope, free = sum(row.error[0]), row.underflow[0]
        if free > fmt.largest:
            raise OverflowError(f"at h = {h} the step overflows {fmt.name} from every state")
        if slope > 0:
            safe = min(safe, (fmt.largest - free) / slope)
    return safe
