"""The float steppers agree with the exact steps within rounding bounds derived from the steppers themselves."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
from hypothesis import assume, example, given
from hypothesis import strategies as st

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.readouts import energy
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.one_step import matrix_at
from driftproof.symbolic.rounding.step_bound import step_bound
from driftproof.symbolic.runs import apply
from proofs.claims import FUZZED, claim
from proofs.setting import EULER, LESSON_METHODS, SYMPLECTIC, M

# The double nearest to 1/10, and the smallest subnormal.
TENTH = float(Q(1, 10))
TINY = float.fromhex("0x1p-1074")
floats = st.floats(allow_nan=False, allow_infinity=False)
BOUNDS = {key: step_bound(HAND_WRITTEN[key]) for key in LESSON_METHODS}


def rounding_error(key: str, h: float, q: float, v: float) -> tuple[Q, Q]:
    """|float step - exact step| by component, both from the same doubles."""
    reached = HAND_WRITTEN[key](oscillator, q, v, h)
    exact = apply(matrix_at(M(key), Q(h)), Q(q), Q(v))
    return abs(Q(reached[0]) - exact[0]), abs(Q(reached[1]) - exact[1])


@claim("L053", evidence=FUZZED, by="derived bound held")
@given(h=st.floats(0, 2), q=floats, v=floats)
@example(h=TENTH, q=1.0, v=0.0)
@example(h=TINY, q=TINY, v=-0.0)
def test_modified_quadratic_kept_up_to_rounding(h: float, q: float, v: float) -> None:
    """In floats, 0 <= h <= 2, where no step can overflow, the modified quadratic is kept to within the derived bound.

    That it cannot is what `is_safe` shows of h and the state: no intermediate exceeds the largest double.
    With e the step's rounding error, I(z + e) - I(z) = 2 z·Se + e·Se, and |S| has the entries ½ and h/4.
    """
    step, bound = HAND_WRITTEN[SYMPLECTIC], BOUNDS[SYMPLECTIC]
    assume(bound.is_safe(Q(h), Q(q), Q(v)))

    def invariant(x: Q, y: Q) -> Q:
        return (x * x + y * y - Q(h) * x * y) / 2

    reached = tuple(map(Q, step(oscillator, q, v, h)))
    exact = apply(matrix_at(M(SYMPLECTIC), Q(h)), Q(q), Q(v))
    dq, dv = bound.error_of(Q(h), Q(q), Q(v))
    (a, b), half_h = map(abs, exact), Q(h) / 2
    allowed = a * dq + b * dv + half_h * (a * dv + b * dq) + (dq * dq + dv * dv + Q(h) * dq * dv) / 2
    assert abs(invariant(*reached) - invariant(Q(q), Q(v))) <= allowed


@given(key=st.sampled_from(LESSON_METHODS), h=floats, q=floats, v=floats)
def test_float_steppers_agree_with_exact_steps_to_roundoff(key: str, h: float, q: float, v: float) -> None:
    """Every float step from any safe state with any h stays within the bound derived from the stepper."""
    bound = BOUNDS[key]
    assume(bound.is_safe(Q(h), Q(q), Q(v)))
    (error_of_q, error_of_v), (limit_of_q, limit_of_v) = rounding_error(key, h, q, v), bound.error_of(Q(h), Q(q), Q(v))
    assert error_of_q <= limit_of_q
    assert error_of_v <= limit_of_v


def test_bound_notices_a_step_of_another_method() -> None:
    """The bound is not too generous: a step that uses the old velocity exceeds it."""
    h, q, v = 0.25, 1.0, 0.5
    wrong = HAND_WRITTEN[EULER](oscillator, q, v, h)
    exact = apply(matrix_at(M(SYMPLECTIC), Q(h)), Q(q), Q(v))
    assert abs(Q(wrong[0]) - exact[0]) > BOUNDS[SYMPLECTIC].error_of(Q(h), Q(q), Q(v))[0]


def test_one_float_euler_step_adds_no_energy_of_tiny_h() -> None:
    """Below h = 2⁻²⁶·⁵ one float Euler step from (1, 0) leaves the energy at exactly ½; just above it does not."""
    largest = float.fromhex("0x1.6a09e667f3bccp-27")

    def energy_after(h: float) -> float:
        return float(energy(HAND_WRITTEN[EULER](oscillator, 1.0, 0.0, h)))

    assert energy_after(largest) == 0.5 < energy_after(np.nextafter(largest, 1))
    assert Q(largest) ** 2 < Q(1, 2**53) < Q(float(np.nextafter(largest, 1))) ** 2
