"""The float steppers: three written by hand in the lesson's order of operations, the rest made from their definitions.

Each takes (force, q, v, h) and returns (q₁, v₁); `force(q)` is the acceleration. Their constants are integers, so they
run unchanged on a float, on arrays of states and of h (by broadcasting), and in the precision of their arguments. h = 0
returns the state, up to the signs of zeros and as long as no sum of slopes overflows; a negative h steps back in time;
infinities and NaN propagate by the rules of IEEE 754.
"""

from __future__ import annotations

from functools import cache

from driftproof.methods.programs.stepping import Force, Number, Step, oscillator, stepper
from driftproof.methods.schemes import Method


def forward_euler(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
    """(q + h v, v + h F(q)): both rates are taken at the old state."""
    return q + h * v, v + h * force(q)


def symplectic_euler(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
    """v₁ = v + h F(q), then q + h v₁: velocity first. Not `symplectic_euler_position_first`."""
    v1 = v + h * force(q)
    return q + h * v1, v1


def rk4(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
    """z + h (k₁ + 2k₂ + 2k₃ + k₄) / 6, the classical method.

    Halves are formed as (h k)/2 and the sum is divided by 6 last, as in the lesson's listing: another order of
    operations gives the same polynomial but rounds differently.
    """
    k1_q, k1_v = v, force(q)
    k2_q, k2_v = v + h * k1_v / 2, force(q + h * k1_q / 2)
    k3_q, k3_v = v + h * k2_v / 2, force(q + h * k2_q / 2)
    k4_q, k4_v = v + h * k3_v, force(q + h * k3_q)
    q1 = q + h * (k1_q + 2 * k2_q + 2 * k3_q + k4_q) / 6
    v1 = v + h * (k1_v + 2 * k2_v + 2 * k3_v + k4_v) / 6
    return q1, v1


HAND_WRITTEN: dict[str, Step] = {"forward_euler": forward_euler, "symplectic_euler": symplectic_euler, "rk4": rk4}


def hand_written(method: Method) -> Step | None:
    """The hand-written step of a catalogue method, or None; a user's own method with the same key has none."""
    from driftproof.methods.catalogue import METHODS

    written = HAND_WRITTEN.get(method.key)
    return written if written and method is METHODS[method.key] else None


def float_stepper(method: Method | str) -> Step:
    """The stepper of a method, given itself or by name, in float runs: the hand-written step if there is one."""
    from driftproof.methods.given_methods import method_of  # loads the catalogue and the reader of files

    method = method_of(method)
    return hand_written(method) or stepper(method, float)


@cache
def evaluations_per_step(method: Method | str) -> int:
    """The number of calls of f, or of the force, in a step, counted on one: no step branches on a value."""
    force = CountedForce(oscillator)
    float_stepper(method)(force, *map(float, range(3)))
    return force.calls


class CountedForce:
    """A force that counts its calls in `calls`: the evaluations actually made, not the nominal ones."""

    def __init__(self, force: Force) -> None:
        """Start at zero calls of `force`."""
        self.force = force
        self.calls = 0

    def __call__(self, q: Number) -> Number:
        """Return force(q) and count the call."""
        self.calls += 1
        return self.force(q)
