"""The steps whose rounding is bounded in these tests, and what is asked of a bound more than once."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import oscillator
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.rounding.any_evaluation_order import AnyEvaluationOrderBound
from driftproof.symbolic.rounding.step_bound import StepBound, in_format
from tests.nine import NINE
from tests.witnesses.leapfrog import leapfrog

WRITTEN_OUT = {**HAND_WRITTEN, "leapfrog": leapfrog}
PROGRAMS = {f"generic {key}": method for key, method in NINE.items()} | WRITTEN_OUT
IRRATIONAL = [key for key, m in METHODS.items() if m.explicit and getattr(m, "field", None)]
ONE_ZERO = (Q(1), Q(0))


def matrix_at(bound: StepBound, h: Q):
    """(M_qq, M_qv, M_vq, M_vv) at h, of the very program whose bound this is."""
    return tuple(sum((c * h**k for k, c in entry.items()), Q(0)) for entry in bound.entries)


def float_run(step, h: float, steps: int, start: tuple[float, float], dtype=float):
    """The final state of a float run, exactly."""
    (q, v), size = (dtype(x) for x in start), dtype(h)
    for _ in range(steps):
        q, v = step(oscillator, q, v, size)
    return Q(float(q)), Q(float(v))


def covers(definition: AnyEvaluationOrderBound, bound: StepBound) -> bool:
    """True when a program's own bound is nowhere above the definition's: coefficient by coefficient, at all h, z."""
    own = [in_format(x.error, bound.format) for x in bound.outputs]
    return bound.format == definition.format and all(
        coefficient <= mine.get(powers, 0)
        for theirs, mine in zip(own, definition.error_terms, strict=True)
        for powers, coefficient in theirs.items()
    )


def all_within(errors, bounds) -> bool:
    """True when no error exceeds its bound."""
    return all(error <= bound for error, bound in zip(errors, bounds, strict=True))
