"""The change of energy in one step, and the quadratic form that a step conserves instead."""

from __future__ import annotations

from typing import NamedTuple

from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.derivation.one_step import RING, H, MatrixEntry, StepPolynomial, entries, matrix


class EnergyForm(NamedTuple):
    """The quadratic form q2·q² + qv·qv + v2·v², coefficients in Q[h] or in Q(h)."""

    q2: MatrixEntry
    qv: MatrixEntry
    v2: MatrixEntry


class StateDependentEnergy(ValueError):
    """The energy change of a step depends on the state, so no single multiplier exists."""


def energy_after(m: DomainMatrix) -> EnergyForm:
    """E(Mz) = ½|Mz|², the energy after one step as a quadratic form in the state before it."""
    qq, qv, vq, vv = entries(m)
    return EnergyForm((qq**2 + vq**2) / 2, qq * qv + vq * vv, (qv**2 + vv**2) / 2)


def energy_change(m: DomainMatrix) -> EnergyForm:
    """E(Mz) - E(z), the energy that one step adds, as a quadratic form in the state before it."""
    after = energy_after(m)
    half = RING.one / 2
    return EnergyForm(after.q2 - half, after.qv, after.v2 - half)


def energy_multiplier(m: DomainMatrix) -> MatrixEntry:
    """The factor μ(h) with E(Mz) = μ(h) E(z) for every state z.

    Raises StateDependentEnergy if the energy change depends on the state.
    """
    after = energy_after(m)
    if after.qv or after.q2 != after.v2:
        shown = f"({after.q2})*q**2 + ({after.qv})*q*v + ({after.v2})*v**2"
        raise StateDependentEnergy(f"the energy change depends on the state: E after one step is {shown}")
    return 2 * after.q2


def invariant_quadratic(m: DomainMatrix) -> EnergyForm:
    """The quadratic form I with I(Mz) = I(z) that equals the energy at h = 0, from MᵀSM = S over Q(h).

    Denominators are cleared, so its coefficients lie in Q[h]. Raises ValueError unless the solutions form a line and
    one of them becomes the energy.
    """
    qq, qv, vq, vv = entries(m)
    zero = RING.zero
    pulled_back = [  # rows: coefficients of q², qv, v² in I(Mz); columns: those in I(z)
        [qq**2, qq * vq, vq**2],
        [2 * qq * qv, qq * vv + qv * vq, 2 * vq * vv],
        [qv**2, qv * vv, vv**2],
    ]
    identity = [[RING.one if i == j else zero for j in range(3)] for i in range(3)]
    solutions = (matrix(pulled_back).to_field() - matrix(identity).to_field()).nullspace()
    if not solutions.shape[0]:
        raise ValueError("no quadratic form is conserved")
    if solutions.shape[0] != 1:
        raise ValueError(f"the conserved quadratic forms have dimension {solutions.shape[0]}, so none is distinguished")
    return _normalised(*solutions.to_list()[0])


def _normalised(q2: StepPolynomial, qv: StepPolynomial, v2: StepPolynomial) -> EnergyForm:
    common = RING.one
    for fraction in (q2, qv, v2):
        common = common.lcm(fraction.denom)
    cleared = [(fraction * common).numer / (fraction * common).denom.LC for fraction in (q2, qv, v2)]
    content = RING.zero
    for polynomial in cleared:
        content = content.gcd(polynomial)
    cleared = [polynomial.exquo(content) for polynomial in cleared]
    at_zero = cleared[0].evaluate(H, 0)
    if not at_zero or cleared[2].evaluate(H, 0) != at_zero or cleared[1].evaluate(H, 0):
        raise ValueError("the conserved quadratic form does not tend to the energy as h goes to 0")
    return EnergyForm(*(polynomial / (2 * at_zero) for polynomial in cleared))
