"""The change of the energy in a step, and the quadratic that symplectic Euler conserves."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
import sympy
from sympy import QQ

from driftproof.numeric import readouts
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.energy import (
    EnergyForm,
    StateDependentEnergy,
    energy_change,
    energy_multiplier,
    invariant_quadratic,
)
from driftproof.symbolic.derivation.one_step import (
    STATE_H,
    STATE_Q,
    STATE_V,
    H,
    StepPolynomial,
    at_rational,
    determinant,
    matrix,
)
from proofs.claims import CERTIFIED, PROVED, RESTRICTED, claim
from proofs.derivations.signs import is_positive_between, roots_between
from proofs.setting import (
    COMPARE_H,
    DEFAULT_H,
    EULER,
    FIRST_H,
    LESSON_METHODS,
    RK4,
    START,
    SYMPLECTIC,
    M,
    Real,
    energy,
    run,
    state_after,
    step_of,
)

h, q, v = STATE_H, STATE_Q, STATE_V


def E(x: Any, y: Any) -> Any:
    """The energy ½(x² + y²)."""
    return (x**2 + y**2) / 2


@claim("L035", "L036", evidence=PROVED, by="expand, cross terms cancel")
def test_forward_euler_energy_multiplier_eq_one_add_h_sq() -> None:
    """Forward Euler: inserting the step into the energy, the cross terms ±2hqv cancel and E₁ = (1 + h²)E₀."""
    new_q, new_v = step_of(EULER)
    assert new_q**2 == q**2 + 2 * h * q * v + h**2 * v**2
    assert new_v**2 == v**2 - 2 * h * q * v + h**2 * q**2
    assert E(new_q, new_v) - (1 + h**2) * E(q, v) == 0
    assert energy_multiplier(M(EULER)) == 1 + H**2
    assert energy_multiplier(M(RK4)) != 1 + H**2


@claim("L037", evidence=PROVED, by="visible sign h²E")
def test_forward_euler_energy_grows_of_nonzero_state() -> None:
    """Each forward Euler step with h > 0 adds the energy h²E, which is positive for every state but the origin.

    In floats a tiny step adds nothing at all: see `test_agreement`.
    """
    gain = E(*step_of(EULER)) - E(q, v)
    assert gain == h**2 * E(q, v)
    assert E(q, v) == (q**2 + v**2) / 2  # a sum of squares: positive unless both vanish


@claim("L010", "L123", evidence=RESTRICTED, by="visible sign h²E")
def test_forward_euler_energy_grows_but_not_at_the_origin() -> None:
    """Each forward Euler step with h > 0 adds the energy h²E, which is positive unless the state is the origin.

    Needed: a nonzero state, for at the origin nothing grows.
    """
    assert E(*step_of(EULER)) - E(q, v) == h**2 * (q**2 + v**2) / 2
    assert energy(*state_after(EULER, 1, FIRST_H, (Q(0), Q(0)))) == 0


@claim("L038", evidence=PROVED, by="induction on n")
def test_forward_euler_energy_after_n_steps() -> None:
    """After n steps Eₙ = (1 + h²)ⁿE₀: true for n = 0, and each step multiplies the energy of any state by 1 + h²."""
    multiplier = _lift(energy_multiplier(M(EULER)))
    assert E(*_apply(M(EULER) ** 0)) == E(q, v)
    assert E(*step_of(EULER)) == multiplier * E(q, v)  # of any state, so also of the n-th
    for n in range(5):  # the conclusion, on actual powers
        assert E(*_apply(M(EULER) ** n)) == (1 + h**2) ** n * E(q, v)


def _apply(m: Any) -> tuple[Any, Any]:
    (qq, qv), (vq, vv) = m.to_list()
    return _lift(qq) * q + _lift(qv) * v, _lift(vq) * q + _lift(vv) * v


def _lift(polynomial: Any) -> Any:
    """An element of Q[h] as one of Q[q, v, h]."""
    return sum((coefficient * h**power for (power,), coefficient in polynomial.terms()), 0 * h)


def _spelled_out(form: EnergyForm) -> Any:
    """A quadratic form with coefficients in Q[h] as an element of Q[q, v, h]."""
    return _lift(form.q2) * q**2 + _lift(form.qv) * q * v + _lift(form.v2) * v**2


@claim("L040", evidence=RESTRICTED, by="visible sign h²")
def test_forward_euler_unbounded_for_every_positive_h() -> None:
    """No positive step keeps forward Euler bounded: the radius grows by sqrt(1 + h²) > 1 at each step.

    Needed: a nonzero state, for the origin stays where it is.
    """
    excess = energy_multiplier(M(EULER)) - 1
    assert excess == H**2
    assert is_positive_between(excess, Q(0), None)
    assert not is_positive_between(energy_multiplier(M(RK4)) - 1, Q(0), None)
    assert not is_positive_between(-1 - H**2, Q(0), None)  # without a root, and negative
    assert state_after(EULER, 1000, FIRST_H, (Q(0), Q(0))) == (0, 0)


@claim("L044", evidence=PROVED, by="MᵀJM = J")
def test_symplectic_euler_is_symplectic() -> None:
    """On this oscillator velocity-first Euler is symplectic: MᵀJM = J. Forward Euler is not."""
    J = matrix([[0, 1], [-1, 0]])
    assert M(SYMPLECTIC).transpose() * J * M(SYMPLECTIC) == J
    assert M(EULER).transpose() * J * M(EULER) != J


@claim("L049", evidence=PROVED, by="Jacobian of any force")
def test_symplectic_step_keeps_oriented_area_of_any_force() -> None:
    """Symplectic Euler keeps dq∧dv, as the motion does: for any force of position its Jacobian has determinant 1.

    The motion: q' = v, v' = F(q) has no divergence, and on this oscillator its flow is a rotation.
    """
    assert _jacobian_determinant(SYMPLECTIC) == 1
    assert _jacobian_determinant(EULER) == 1 - h**2 * _SLOPE != 1
    x, y = sympy.symbols("x y")
    rate = (y, sympy.Function("F")(x))
    assert rate[0].diff(x) + rate[1].diff(y) == 0
    t = sympy.Symbol("t")
    flow = sympy.Matrix([[sympy.cos(t), sympy.sin(t)], [-sympy.sin(t), sympy.cos(t)]])
    assert sympy.trigsimp(flow.det()) == 1


# F'(q) at the only position where an Euler method evaluates the force; a symbol, so it may be any number.
_SLOPE = v


class _Jet:
    """The derivatives of a value with respect to q and v, with the rules for sums and for products with h."""

    def __init__(self, of_q: Any, of_v: Any) -> None:
        """Take the two derivatives."""
        self.of_q, self.of_v = of_q, of_v

    def __add__(self, other: _Jet) -> _Jet:
        """Add the derivatives."""
        return _Jet(self.of_q + other.of_q, self.of_v + other.of_v)

    def __rmul__(self, step: Any) -> _Jet:
        """Multiply the derivatives by a constant."""
        return _Jet(step * self.of_q, step * self.of_v)


class _Constant:
    """The step h, which depends on neither q nor v."""

    def __mul__(self, other: _Jet) -> _Jet:
        """Multiply the derivatives by h."""
        return _Jet(h * other.of_q, h * other.of_v)


def _jacobian_determinant(key: str) -> Any:
    """The determinant of ∂(q₁, v₁)/∂(q, v) of the hand-written step, for a force with the derivative _SLOPE."""
    one, zero = h**0, 0 * h
    force = lambda position: _Jet(_SLOPE * position.of_q, _SLOPE * position.of_v)
    new_q, new_v = HAND_WRITTEN[key](force, _Jet(one, zero), _Jet(zero, one), _Constant())
    return new_q.of_q * new_v.of_v - new_q.of_v * new_v.of_q


@claim("L050", evidence=PROVED, by="determinant is 1")
def test_symplectic_euler_determinant_eq_one() -> None:
    """The symplectic update preserves area in the (q, v) plane: its determinant is 1, forward Euler's 1 + h²."""
    assert determinant(M(SYMPLECTIC)) == 1
    assert determinant(M(EULER)) == 1 + H**2


@claim("L051", evidence=PROVED, by="factored energy change")
def test_symplectic_euler_changes_energy_except_on_two_lines() -> None:
    """Symplectic Euler does not keep E at each step: the change is ½h²(v - (h+1)q)(v - (h-1)q), zero on two lines."""
    change = E(*step_of(SYMPLECTIC)) - E(q, v)
    assert change == h**2 * (v - (h + 1) * q) * (v - (h - 1) * q) / 2
    assert change != 0
    with pytest.raises(StateDependentEnergy):
        energy_multiplier(M(SYMPLECTIC))


@claim("L052", evidence=PROVED, by="substitute and expand")
def test_symplectic_euler_keeps_the_modified_quadratic() -> None:
    """The symplectic update preserves ½(q² + v² - hqv) exactly, for every h: substitute, and it comes back."""

    def quadratic(x: Any, y: Any) -> Any:
        return (x**2 + y**2 - h * x * y) / 2

    assert quadratic(*step_of(SYMPLECTIC)) - quadratic(q, v) == 0
    assert quadratic(*step_of("symplectic_euler_position_first")) - quadratic(q, v) != 0
    assert tuple(invariant_quadratic(M(SYMPLECTIC))) == (QQ(1, 2), -H / 2, QQ(1, 2))


@claim("L054", evidence=PROVED, by="difference shown")
def test_modified_quadratic_differs_from_energy() -> None:
    """The modified quadratic is not the energy: they differ by -½hqv, which vanishes only on the axes or at h = 0."""
    assert _spelled_out(invariant_quadratic(M(SYMPLECTIC))) - E(q, v) == -h * q * v / 2


def _definiteness(invariant: EnergyForm) -> StepPolynomial:
    """The polynomial 4·q2·v2 - qv² in Q[h]: the level curves are ellipses exactly where it and q2 are positive."""
    return 4 * invariant.q2 * invariant.v2 - invariant.qv**2


@claim("L055", evidence=RESTRICTED, by="sum of two squares")
def test_invariant_level_curves_are_ellipses_of_h_lt_two() -> None:
    """For 0 < h < 2 the level curves of the modified quadratic are ellipses, so q and v stay bounded.

    q² + v² - hqv = (q - hv/2)² + (1 - h²/4)v², both squares positive. Needed: a positive level; the zero level is the
    origin alone.
    """
    assert (q - h * v / 2) ** 2 + (1 - h**2 / 4) * v**2 == q**2 + v**2 - h * q * v
    definite = _definiteness(invariant_quadratic(M(SYMPLECTIC)))
    assert definite == (2 - H) * (2 + H) / 4
    assert is_positive_between(definite, Q(0), Q(2))
    assert not is_positive_between(definite, Q(0), Q(3))
    # the bounds that follow: |v|² <= 2I/(1 - h²/4) by the identity, and |q|² by its mirror image
    assert (v - h * q / 2) ** 2 + (1 - h**2 / 4) * q**2 == q**2 + v**2 - h * q * v


@claim("L056", evidence=PROVED, by="sign of definiteness")
def test_level_curves_degenerate_at_two_and_open_beyond() -> None:
    """The bound h < 2 matters: at h = 2 the quadratic is ½(q - v)², parallel lines; beyond, the curves are open."""
    definite = _definiteness(invariant_quadratic(M(SYMPLECTIC)))
    assert at_rational(definite, Q(2)) == 0
    assert (q**2 + v**2 - h * q * v).evaluate(h, 2) == ((q - v) ** 2).evaluate(h, 2)
    assert is_positive_between(-definite, Q(2), None)


SHOWN = ("final_state", "exact_state", "state_error", "energy", "energy_change", "phase_error", "steps")


@claim("L137", evidence=PROVED, by="identity, and every run")
def test_energy_change_is_measured_from_one_half(publish: Any) -> None:
    """Energy change is measured from 0.5: in each scene's runs it is the final energy less ½, as in our readout.

    The readout's arithmetic is run on polynomials; in floats the same holds up to rounding (T02).
    """
    assert energy(*START) == Q(1, 2)
    for key in LESSON_METHODS:
        for scene in PRESETS.values():
            exact = run(key, scene.h)
            assert exact.energy_change == energy(*exact.final_state) - Q(1, 2)
            shown = run_method(replace(scene, readouts=SHOWN), key)  # what pages print is read by the same functions
            state, true = shown["final_state"], shown["exact_state"]
            assert shown["energy_change"] == readouts.float_energy_change(state, (1.0, 0.0))
            assert (shown["energy"], shown["steps"]) == (readouts.energy(state), exact.steps)
            assert shown["state_error"] == readouts.state_error(state, true) != readouts.state_error(state, (1.0, 0.0))
            assert shown["phase_error"] == readouts.phase_error(state, true)
            assert true == readouts.exact_state((1.0, 0.0), 10.0) != state
    assert readouts.float_energy_change((q, v), START) == E(q, v) - QQ(1, 2)
    assert readouts.float_energy_change((q, v), (Q(0), Q(2))) != E(q, v) - QQ(1, 2)
    publish("exact.energy", str(float(energy(*START))), energy(*START))


@claim("L090", evidence=PROVED, by="exact values compared")
def test_structure_kept_but_energy_not() -> None:
    """Keeping the structure is not keeping the energy: after the first step it is 13/32, not 1/2, at determinant 1."""
    assert determinant(M(SYMPLECTIC)) == 1
    assert energy(*state_after(SYMPLECTIC, 1, FIRST_H)) == Q(13, 32) != energy(*START)


@claim("L091", evidence=CERTIFIED, by="disjoint enclosures")
def test_rk4_first_step_is_nearest_in_state_and_energy() -> None:
    """After the first step RK4 has the smallest state error and the smallest energy error of the three."""
    rk4, euler, symplectic = (run(key, FIRST_H, FIRST_H) for key in (RK4, EULER, SYMPLECTIC))
    for other in (euler, symplectic):
        assert Real(rk4.state_error) < Real(other.state_error)
        assert abs(rk4.energy - energy(*START)) < abs(other.energy - energy(*START))
    assert not (Real(symplectic.state_error) < Real(euler.state_error))


@claim("L111", evidence=PROVED, by="exact rational arithmetic")
def test_default_drift_is_over_three_radii() -> None:
    """The default run's drift dwarfs the unit circle: its last radius is (17/16)²⁰, between 3.36 and 3.37."""
    radius = Q(17, 16) ** 20
    assert radius**2 == 2 * run(EULER, DEFAULT_H).energy
    assert Q(336, 100) < radius < Q(337, 100)


@claim("L146", evidence=PROVED, by="invariant bounds radius")
def test_symplectic_compare_run_stays_within_four_thirds() -> None:
    """At h = ½ the symplectic path stays bounded: q² + v² <= 1/(1 - h/2) = 4/3 at every step, from the invariant.

    q² + v² - hqv - (1 - h/2)(q² + v²) = (h/2)(q - v)² is not negative, and the left form stays 1 from (1, 0).
    """
    kept = lambda x, y: x**2 + y**2 - h * x * y
    assert kept(q, v) - (1 - h / 2) * (q**2 + v**2) == h / 2 * (q - v) ** 2
    assert kept(*step_of(SYMPLECTIC)) == kept(q, v)
    assert kept(q, v).evaluate([(q, 1), (v, 0)]) == 1
    assert Q(4, 3) == 1 / (1 - COMPARE_H / 2)
    largest = max(2 * energy(*state_after(SYMPLECTIC, n, COMPARE_H)) for n in range(21))
    assert 1 < largest <= Q(4, 3)
    assert 2 * energy(*state_after(EULER, 20, COMPARE_H)) > Q(4, 3)  # forward Euler leaves that disc


@claim("L236", "L228", evidence=PROVED, by="indefinite quadratic form")
def test_symplectic_euler_energy_can_rise_or_fall() -> None:
    """Symplectic Euler does not always lower the energy: for every h > 0 some states gain and others lose.

    The change is a quadratic form of determinant -h⁴/4 < 0, hence indefinite. Up from (0, 1), down from (1, 0).
    """
    change = energy_change(M(SYMPLECTIC))
    assert _spelled_out(change) == E(*step_of(SYMPLECTIC)) - E(q, v)
    assert change.q2 * change.v2 - (change.qv / 2) ** 2 == -(H**4) / 4
    gains = energy(*state_after(SYMPLECTIC, 1, FIRST_H, (Q(0), Q(1))))
    loses = energy(*state_after(SYMPLECTIC, 1, FIRST_H, (Q(1), Q(0))))
    assert loses < Q(1, 2) < gains
    assert roots_between(change.v2, Q(0), None) == 0  # from (0, 1) it rises at every h


@claim("L238", evidence=PROVED, by="change at both starts")
def test_first_example_lost_energy_because_of_its_start() -> None:
    """The first example lost energy because it began at (1, 0): there the change is ½h²(h² - 1), at (0, 1) it is ½h².

    The sign at (1, 0) turns at h = 1, so it is the place in the cycle together with h < 1 that decides.
    """
    change = energy_change(M(SYMPLECTIC))
    assert _spelled_out(change) == E(*step_of(SYMPLECTIC)) - E(q, v)
    assert change.q2 == H**2 * (H**2 - 1) / 2
    assert change.v2 == H**2 / 2
    assert is_positive_between(-change.q2, Q(0), Q(1))
    assert is_positive_between(change.q2, Q(1), None)
