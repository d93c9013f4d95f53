"""The leapfrog program that VerifiedLeapfrog proves correct in Coq, in its own order of operations."""

from __future__ import annotations

from driftproof.methods.programs.stepping import Force, Number


def leapfrog(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
    """q₁ = (q + h v) + (h²/2) F(q), v₁ = v + (h/2)(F(q) + F(q₁)): velocity Verlet, two forces per step.

    Not the generic `velocity_verlet`, which is the same polynomial from another order of operations. The halves stand
    before the product as in the Coq program, which writes 0.5 (h h) and 0.5 h: the same floats.
    Source: kellison-appel-2022, its Coq file leapfrog_project/float_model.v.
    """
    a = force(q)
    q1 = (q + h * v) + (h * h / 2) * a
    return q1, v + (h / 2) * (a + force(q1))
