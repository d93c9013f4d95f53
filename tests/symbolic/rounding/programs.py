"""The steps whose rounding is bounded in these tests, and what is asked of a bound more than once."""

from __future__ import annotations

from fractions import Fraction as Q

from flint import ctx

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.rounding.step_bound import StepBound, in_format
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.nine import NINE
from tests.witnesses.any_order import AnyOrder
from tests.witnesses.leapfrog import leapfrog

WRITTEN_OUT = {**HAND_WRITTEN, "leapfrog": leapfrog}
PROGRAMS = {f"generic {key}": method for key, method in NINE.items()} | WRITTEN_OUT
IRRATIONAL = [key for key, m in METHODS.items() if m.explicit and getattr(m, "field", None)]
ONE_ZERO = (Q(1), Q(0))


def as_step(subject, lift=float):
    """The step function itself, or that of a method with its coefficients lifted."""
    return subject if callable(subject) else stepper(subject, lift)


def rk4_reassociated(force, q, v, h):
    """RK4 with every product and every sum taken the other way round than in the hand-written step."""
    k1q, k1v = v, force(q)
    k2q, k2v = v + k1v * (h / 2), force(k1q * (h / 2) + q)
    k3q, k3v = v + k2v * (h / 2), force(k2q * (h / 2) + q)
    k4q, k4v = v + k3v * h, force(k3q * h + q)
    q1 = (h / 6) * (k4q + (2 * k3q + (2 * k2q + k1q))) + q
    return q1, (h / 6) * (k4v + (2 * k3v + (2 * k2v + k1v))) + v


def matrix_at(bound: StepBound, h: Q):
    """(M_qq, M_qv, M_vq, M_vv) at h, of the very program whose bound this is."""
    return tuple(sum((c * h**k for k, c in entry.items()), Q(0)) for entry in bound.entries)


def float_run(step, h: float, steps: int, start: tuple[float, float], dtype=float):
    """The final state of a float run, exactly."""
    (q, v), size = (dtype(x) for x in start), dtype(h)
    for _ in range(steps):
        q, v = step(oscillator, q, v, size)
    return Q(float(q)), Q(float(v))


def covers(definition: AnyOrder, bound: StepBound) -> bool:
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


def error_in_balls(key: str, program, h: float, q: float, v: float):
    """|fl(step(z)) - M(h) z| with M over the number field, in Arb balls of 300 bits."""
    floats = program(oscillator, q, v, h)
    with ctx.workprec(300):
        exact = apply([enclose(x) for x in exact_matrix_at(METHODS[key], Q(h))], enclose(Q(q)), enclose(Q(v)))
        return [abs(enclose(Q(x)) - y) for x, y in zip(floats, exact, strict=True)]
