"""Energy multipliers and conserved quadratics: that they hold, that they are refused where none exists."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from hypothesis import given

from driftproof import strategies
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.derivation.energy import (
    EnergyForm,
    StateDependentEnergy,
    energy_after,
    energy_change,
    energy_multiplier,
    invariant_quadratic,
)
from driftproof.symbolic.derivation.one_step import (
    RING,
    H,
    at_rational,
    determinant,
    entries,
    matrix,
    matrix_at,
    one_step_matrix,
)
from driftproof.symbolic.runs import apply
from tests.nine import NINE


def value(form: EnergyForm, h: Q, q: Q, v: Q) -> Q:
    q2, qv, v2 = (at_rational(coefficient, h) for coefficient in form)
    return q2 * q * q + qv * q * v + v2 * v * v


@given(strategies.splittings(), strategies.rational_steps(), strategies.rational_states())
def test_energy_forms_are_the_energies_of_the_states(method: Splitting, h: Q, state: tuple[Q, Q]) -> None:
    m = one_step_matrix(method)
    q, v = apply(matrix_at(m, h), *state)
    before, after = sum(x * x for x in state) / 2, (q * q + v * v) / 2
    assert value(energy_after(m), h, *state) == after
    assert value(energy_change(m), h, *state) == after - before


@given(strategies.runge_kutta_methods())
def test_energy_multiplier_of_every_runge_kutta_method_is_the_determinant(method: RungeKutta) -> None:
    m = one_step_matrix(method)
    assert energy_multiplier(m) == determinant(m)


@pytest.mark.parametrize("key", ["symplectic_euler", "symplectic_euler_position_first", "velocity_verlet"])
def test_energy_multiplier_does_not_exist_where_the_change_depends_on_the_state(key: str) -> None:
    m = one_step_matrix(NINE[key])
    with pytest.raises(StateDependentEnergy, match="the energy change depends on the state: E after one step is") as c:
        energy_multiplier(m)
    assert "\n" not in str(c.value)
    # The refusal is right: two states, two ratios.
    ratios = {sum(x * x for x in apply(matrix_at(m, Q(1, 2)), *state)) for state in ((Q(1), Q(0)), (Q(0), Q(1)))}
    assert len(ratios) == 2


def test_energy_multiplier_needs_both_the_squares_and_the_mixed_term() -> None:
    with pytest.raises(StateDependentEnergy):
        energy_multiplier(matrix([[2, 0], [0, 1]]))
    with pytest.raises(StateDependentEnergy):
        energy_multiplier(matrix([[1, 1], [0, 0]]))
    assert energy_multiplier(matrix([[0, H], [-H, 0]])) == H**2


def pulled_back(form: EnergyForm, m: Any) -> EnergyForm:
    """I(Mz), multiplied out by hand: the check is not the derivation."""
    a, b, c, d = entries(m)
    q2, qv, v2 = form
    return EnergyForm(
        q2 * a * a + qv * a * c + v2 * c * c,
        2 * q2 * a * b + qv * (a * d + b * c) + 2 * v2 * c * d,
        q2 * b * b + qv * b * d + v2 * d * d,
    )


@given(strategies.splittings())
def test_every_consistent_splitting_conserves_a_quadratic_that_becomes_the_energy(method: Splitting) -> None:
    m = one_step_matrix(method)
    invariant = invariant_quadratic(m)
    assert pulled_back(invariant, m) == invariant
    assert [at_rational(c, Q(0)) for c in invariant] == [Q(1, 2), 0, Q(1, 2)]
    # The check can fail: the energy itself is not conserved by any of them.
    energy = EnergyForm(RING.one / 2, RING.zero, RING.one / 2)
    assert pulled_back(energy, m) != energy


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([[1, 0], [0, 1]], "have dimension 3"), ([[1, H], [-H, 1]], "no quadratic form is conserved"),
        ([[1, H], [-4 * H, 1 - 4 * H**2]], "does not tend to the energy"),
        ([[1, H], [0, 1]], "does not tend to the energy"), ([[-1, 0], [0, 1]], "have dimension 2"),
    ],
)  # fmt: skip
def test_invariant_is_refused_unless_it_is_one_that_becomes_the_energy(rows: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        invariant_quadratic(matrix(rows))
