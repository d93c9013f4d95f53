"""State error, energy and wrapped phase error: what each of them shows and what it cannot show."""

from __future__ import annotations

from fractions import Fraction as Q
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy
from sympy import QQ, Rational, atan2, cos, field, pi, ring, sin

from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric import readouts
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN, CountedForce
from driftproof.symbolic import runs
from driftproof.symbolic.algebra.certified import certified_sign, fixed
from driftproof.symbolic.derivation.expression_balls import certifiable
from driftproof.symbolic.derivation.formulas import as_matrix
from driftproof.symbolic.derivation.one_step import H
from driftproof.symbolic.derivation.phase import leading_term, phase_error_series, phase_per_step
from driftproof.symbolic.derivation.stability import AtStep
from proofs.claims import CERTIFIED, PROVED, RESTRICTED, claim
from proofs.derivations.signs import rises_from_zero
from proofs.setting import (
    DEFAULT_H,
    EULER,
    FIRST_H,
    RK4,
    START,
    SYMPLECTIC,
    M,
    Real,
    calls_of_a_step,
    energy,
    run,
    state_after,
)

# Two states (q, v) and (x, y), and for each a positive number that both of its components are divided by.
_, q, v, x, y, here, there = field("q, v, x, y, here, there", QQ)
QUARTER = ((Q(1), Q(0)), (Q(0), Q(-1)))


class Traced:
    """A rational function on which the readouts run without rounding; instead of a root its radicand is returned."""

    def __init__(self, value: Any) -> None:
        """Take an element of the field."""
        self.value = value

    def __add__(self, other: Traced) -> Traced:
        """Add."""
        return Traced(self.value + other.value)

    def __sub__(self, other: Traced) -> Traced:
        """Subtract."""
        return Traced(self.value - other.value)

    def __mul__(self, other: Traced) -> Traced:
        """Multiply."""
        return Traced(self.value * other.value)

    def __truediv__(self, other: Traced) -> Traced:
        """Divide."""
        return Traced(self.value / other.value)

    def __pow__(self, exponent: int) -> Traced:
        """Raise to a power."""
        return Traced(self.value**exponent)

    def __abs__(self) -> Traced:
        """The size of the component's state, as if it were the larger of the two."""
        return Traced(here if self.value in (q, v) else there)

    def __ge__(self, other: Traced) -> bool:
        """The two sizes of a state are the same."""
        return True

    def sqrt(self) -> Any:
        """The radicand."""
        return self.value

    def hypot(self, other: Traced) -> Any:
        """The radicand of the length."""
        return (self * self + other * other).value

    def arctan2(self, other: Traced) -> SimpleNamespace:
        """The sine and the cosine, up to a factor, of an angle that is neither converted nor 180 degrees."""
        angle = SimpleNamespace(of=(self.value, other.value))
        angle.degrees = lambda: angle
        return angle


STATES = ((Traced(q), Traced(v)), (Traced(x), Traced(y)))
CROSS, DOT = q * y - v * x, q * x + v * y


@claim("L134", evidence=PROVED, by="readouts run on symbols")
def test_state_error_is_euclidean_distance() -> None:
    """The state error is the Euclidean distance of two states: its square is (q - x)² + (v - y)².

    So says the arithmetic of both readouts, of floats and of exact runs; T02 bounds the rounding.
    """
    for read in (readouts.state_error, runs.distance):
        assert read(*STATES) == (q - x) ** 2 + (v - y) ** 2
    exact = run(EULER, DEFAULT_H)
    exact_q, exact_v = cos(10), -sin(10)
    assert exact.t == 10
    assert list(map(str, exact.exact_state)) == [str(exact_q), str(exact_v)]
    squared = (exact.final_state[0] - exact_q) ** 2 + (exact.final_state[1] - exact_v) ** 2
    assert fixed(exact.state_error, 30) == fixed(certifiable(sympy.sqrt(squared)), 30)
    assert readouts.state_error(STATES[0], STATES[0]) != (q - x) ** 2 + (v - y) ** 2


@claim("L152", evidence=PROVED, by="E is half r²")
def test_energy_is_half_the_squared_radius() -> None:
    """Energy error is a wrong distance from the origin, E = r²/2, whatever the angle."""
    r, angle = sympy.symbols("r angle", positive=True)
    state = (r * cos(angle), -r * sin(angle))
    assert sympy.trigsimp(readouts.energy(state) - r**2 / 2) == 0
    assert sympy.simplify(sympy.trigsimp(readouts.energy(state)).diff(angle)) == 0
    assert sympy.trigsimp(readouts.energy(state)).diff(r) != 0


@claim("L108", evidence=PROVED, by="polar form")
def test_radii_show_energy_and_angles_show_wrapped_phase_error() -> None:
    """Marks of equal radius have equal energy, and the angle between two marks is the wrapped phase error.

    In polar form cross and dot product are rρ sin(α - β) and rρ cos(α - β), whose angle the readout takes (T02, L135).
    """
    r, rho, alpha, beta = sympy.symbols("r rho alpha beta", positive=True)
    (q1, v1), (q2, v2) = (r * cos(alpha), -r * sin(alpha)), (rho * cos(beta), -rho * sin(beta))
    assert sympy.trigsimp(readouts.energy((q1, v1)) - r**2 / 2) == 0
    assert sympy.simplify(q1 * v2 - v1 * q2 - r * rho * sin(alpha - beta)) == 0
    assert sympy.simplify(q1 * q2 + v1 * v2 - r * rho * cos(alpha - beta)) == 0


@claim("L153", evidence=PROVED, by="rotated state")
def test_phase_error_is_the_angle_between_states() -> None:
    """Phase error is a wrong place on the cycle: turning a state by α changes its phase by α and not its energy."""
    t, alpha, r = *sympy.symbols("t alpha", real=True), sympy.Symbol("r", positive=True)
    ahead = (r * cos(t + alpha), -r * sin(t + alpha))
    exact = (cos(t), -sin(t))
    cross = ahead[0] * exact[1] - ahead[1] * exact[0]
    dot = ahead[0] * exact[0] + ahead[1] * exact[1]
    assert sympy.simplify(cross - r * sin(alpha)) == 0
    assert sympy.simplify(dot - r * cos(alpha)) == 0
    assert sympy.trigsimp(readouts.energy(ahead)) == r**2 / 2


@claim("L154", evidence=PROVED, by="antipodal states")
def test_equal_energy_states_up_to_two_radii_apart() -> None:
    """States of equal energy can be far apart: as far as twice the radius, for z and -z."""
    assert readouts.energy((q, v)) == readouts.energy((-q, -v))
    assert (q - -q) ** 2 + (v - -v) ** 2 == 4 * (2 * readouts.energy((q, v)))


@claim("L155", evidence=PROVED, by="exact values compared")
def test_two_states_share_the_energy_one_half() -> None:
    """(1, 0) and (0, -1) both have energy ½."""
    assert [energy(*state) for state in QUARTER] == [Q(1, 2), Q(1, 2)]
    assert QUARTER[0] != QUARTER[1]


@claim("L156", evidence=PROVED, by="exact angle")
def test_those_states_are_a_quarter_cycle_apart() -> None:
    """The phase angles atan2(-v, q) of (1, 0) and (0, -1) are 0 and π/2: they differ by a quarter of a cycle."""
    angles = [atan2(-Rational(state[1]), Rational(state[0])) for state in QUARTER]
    assert angles == [0, pi / 2]
    assert angles[1] - angles[0] == 2 * pi / 4


@claim("L157", evidence=PROVED, by="derivative and start")
def test_phase_angle_of_the_solution_is_time() -> None:
    """The phase angle atan2(-v, q) of the exact solution is t, modulo 2π: it is 0 at the start and grows at rate 1.

    A readout that took another angle would not: that of the state itself, atan2(v, q), falls.
    """
    t = sympy.Symbol("t", real=True)
    q_exact, v_exact = cos(t), -sin(t)
    angle = atan2(-v_exact, q_exact)
    assert angle.subs(t, 0) == 0
    assert sympy.simplify(angle.diff(t)) == 1
    assert sympy.simplify(atan2(v_exact, q_exact).diff(t)) == -1


@claim("L158", evidence=CERTIFIED, by="ball enclosure")
def test_phase_error_compares_final_angles() -> None:
    """The readout compares the final angles: for the default run 40·atan(1/4) - 10 radians, from the two angles."""
    by_angles = (40 * sympy.atan(Rational(1, 4)) - 10) * 180 / pi
    assert fixed(run(EULER, DEFAULT_H).phase_error, 25) == fixed(certifiable(by_angles), 25)  # type: ignore[arg-type]
    assert fixed(run(EULER, DEFAULT_H).phase_error, 25) != fixed(certifiable(-by_angles), 25)  # type: ignore[arg-type]


@claim("L135", evidence=RESTRICTED, by="readouts run on symbols")
def test_phase_error_is_wrapped_to_half_open_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The phase error is the signed shortest angle, from -180° up to but not including 180°, positive ahead.

    Both readouts, of floats and of exact runs, take atan2 of cross and dot product, over a positive number; by the
    polar form (L108) that is α - β up to whole turns, from -180° to 180°, and none that differs by whole turns is
    shorter (L159). Needed: states off the origin, where there is no angle, and a choice between -180° and 180°, which
    are one angle.
    """
    (angle,) = readouts.phase_error(*(tuple(np.array([z], dtype=object) for z in state) for state in STATES))
    assert tuple(part * here * there for part in angle.of) == (CROSS, DOT)
    assert angle.of != (-CROSS / (here * there), DOT / (here * there))
    monkeypatch.setattr(runs, "arb", SimpleNamespace(atan2=lambda sine, cosine: (sine, cosine)))
    assert runs._angle_between((q, v), (x, y)) == (CROSS, DOT)
    monkeypatch.undo()
    assert readouts.phase_error((1.0, -1.0), (1.0, 0.0)) == 45
    for opposite in ((-1.0, 0.0), (-1.0, -0.0)):
        assert readouts.phase_error(opposite, (1.0, 0.0)) == -180
    assert readouts.phase_error((0.0, 0.0), (1.0, 0.0)) is None
    assert run(EULER, Q(1), Q(1), (Q(0), Q(0))).phase_error is None


@claim("L159", evidence=PROVED, by="visible sign")
def test_phase_error_is_the_shortest_of_all_differences() -> None:
    """Of all angle differences that are equal up to whole turns, the readout is the shortest.

    It is an a from -180 to 180 (L135), and (a + 360 k)² - a² is a product without a negative factor, for k >= 1 and for
    k <= -1. A run that lags by more than half a turn shows it.
    """
    _, a, k = ring("a, k", QQ)
    longer = (a + 360 * k) ** 2 - a**2
    assert longer == 720 * k * ((a + 180) + 180 * (k - 1)) == 720 * -k * ((180 - a) + 180 * (-k - 1))
    assert (a + 180 * k) ** 2 - a**2 != 360 * k * ((a + 180) + 180 * (k - 1))  # half turns can be shorter
    late = run(EULER, Q(5, 2))
    wrapped = late.phase_error
    angles = (4 * sympy.atan(Rational(5, 2)) - 10) * 180 / pi
    unwrapped, turned = certifiable(angles), certifiable(angles + 360)
    assert fixed(turned, 20) == fixed(wrapped, 20)  # type: ignore[arg-type]
    assert Real(unwrapped) < Real(Q(-180))
    assert certified_sign(turned) > 0
    assert Real(turned) < Real(Q(180))


@claim("L160", evidence=PROVED, by="angle grows with t")
def test_positive_phase_error_is_ahead() -> None:
    """A positive phase error is ahead: the angle atan2(-v, q) grows at rate 1, so a later state has a larger one."""
    rate = (q * q + v * v, q * q + v * v)  # numerator and denominator of d/dt atan2(-v, q)
    dq, dv = v, -q
    assert (q * -dv - -v * dq, q**2 + v**2) == rate
    t, s = sympy.symbols("t s", real=True)
    later, sooner = ((cos(time), -sin(time)) for time in (t + s, t))
    sine = later[0] * sooner[1] - later[1] * sooner[0]  # of the phase error, positive for s below half a turn
    assert sympy.simplify(sine - sin(s)) == 0
    assert certified_sign(certifiable(sin(sympy.Integer(1)))) == 1


@claim("L136", "L161", evidence=PROVED, by="period of the angle")
def test_wrapping_hides_whole_turns() -> None:
    """Whole turns are not counted: a state that lags by a full cycle is the same state, so no readout can tell."""
    t, n = sympy.symbols("t", real=True), sympy.Symbol("n", integer=True)
    assert sympy.simplify(cos(t + 2 * pi * n) - cos(t)) == 0
    assert sympy.simplify(sin(t + 2 * pi * n) - sin(t)) == 0
    assert sympy.simplify(cos(t + pi * n) - cos(t)) != 0  # half turns do show


@claim("L240", "L245", evidence=PROVED, by="one circle, all phases")
def test_energy_fixes_radius_and_not_phase() -> None:
    """The right energy fixes the radius and leaves the phase free: every angle on the circle has that energy.

    So an endpoint with the right energy need not be accurate.
    """
    r, alpha, beta = sympy.symbols("r alpha beta", positive=True)
    states = [(r * cos(angle), -r * sin(angle)) for angle in (alpha, beta)]
    assert [sympy.trigsimp(readouts.energy(state)) for state in states] == [r**2 / 2] * 2
    distance = sum((a - b) ** 2 for a, b in zip(*states, strict=True))
    assert sympy.simplify(distance - 4 * r**2 * sin((alpha - beta) / 2) ** 2) == 0


@claim("L246", evidence=PROVED, by="exact values compared")
def test_quarter_cycle_error_keeps_the_energy() -> None:
    """The numerical result (0, -1) for the exact (1, 0) has the right energy, ½."""
    assert energy(*QUARTER[1]) == energy(*QUARTER[0]) == Q(1, 2)


@claim("L247", evidence=PROVED, by="exact distance")
def test_quarter_cycle_error_is_root_two(publish: Any) -> None:
    """The numerical result (0, -1) for the exact (1, 0) has the state error sqrt 2."""
    squared = sum((a - b) ** 2 for a, b in zip(*QUARTER, strict=True))
    assert squared == 2
    publish("quarter_cycle.state_error", f"√{squared}", square_root(int(squared)))


@claim("L003", evidence=PROVED, by="pairs alike in one")
def test_stability_is_read_apart_from_drift_phase_and_cost() -> None:
    """Stability does not follow from energy drift, phase error or cost, nor do these from it: it is read apart.

    From (1, 1) symplectic Euler is back there at t = 12 with h = 1 and with h = 2, alike in every error; both Euler
    methods cost the same; symplectic Euler and RK4 are both bounded at h = 1/2 and differ in all three.
    """
    bounded = lambda key, step: AtStep(M(key), sympy.Rational(step)).bounded
    ends = [state_after(SYMPLECTIC, n, Q(step), (Q(1), Q(1))) for n, step in ((12, 1), (6, 2))]
    assert ends == [(1, 1)] * 2
    assert (bounded(SYMPLECTIC, 1), bounded(SYMPLECTIC, 2)) == (True, False)
    assert calls_of_a_step(EULER) == calls_of_a_step(SYMPLECTIC) != calls_of_a_step(RK4)
    assert (bounded(EULER, Q(1, 2)), bounded(SYMPLECTIC, Q(1, 2)), bounded(RK4, Q(1, 2))) == (False, True, True)
    one, other = run(SYMPLECTIC, Q(1, 2)), run(RK4, Q(1, 2))
    assert one.energy_change != other.energy_change
    (q1, v1), (q2, v2) = one.final_state, other.final_state
    assert q1 * v2 - v1 * q2 != 0  # so that their angles differ


@claim("L007", evidence=PROVED, by="pairs alike in one")
def test_four_quantities_are_read_apart() -> None:
    """State error, energy error, phase error and cost are four readouts: no one of them determines another.

    Of each error there are two states that agree in it and differ in the other two; a step of either Euler method costs
    the same and differs in all three; and a step that asks for a force in vain reaches the same state at twice the
    cost.
    """

    def read(x: int, y: int) -> tuple[Any, ...]:
        """Squared distance from (1, 0), energy less that of (1, 0), angle from (1, 0)."""
        return ((x - 1) ** 2 + y**2, energy(Q(x), Q(y)) - energy(*START), atan2(-y, x))

    same_distance = read(2, 0), read(1, 1)
    same_energy = read(0, -1), read(1, 0)
    same_phase = read(2, 0), read(3, 0)
    for alike, (one, other) in enumerate((same_distance, same_energy, same_phase)):
        assert [i for i in range(3) if one[i] == other[i]] == [alike]
    # One evaluation, twice, and three different errors; a step that asks in vain, and the same state for more.
    h = H.as_expr()
    c, s = cos(h), sin(h)
    (q1, v1), (q2, v2) = (sympy.Matrix([[1, 0]]) * as_matrix(M(key)).T for key in (EULER, SYMPLECTIC))
    assert calls_of_a_step(EULER) == calls_of_a_step(SYMPLECTIC)
    nearer = (q1 - c) ** 2 + (v1 + s) ** 2 - (q2 - c) ** 2 - (v2 + s) ** 2
    assert sympy.expand(nearer + 2 * h**2 * (c - 1 + h**2 / 2)) == 0
    assert rises_from_zero(c - 1 + h**2 / 2, h)
    assert sympy.expand(q1**2 + v1**2 - q2**2 - v2**2 - h**2 * (2 - h**2)) == 0  # not 0 at h = 1/2
    assert sympy.expand(q1 * v2 - v1 * q2 + h**3) == 0  # so that the angles differ
    frugal, wasteful = CountedForce(oscillator), CountedForce(oscillator)
    step = HAND_WRITTEN[EULER]
    reached = step(frugal, *START, FIRST_H), (wasteful(Q(9)), step(wasteful, *START, FIRST_H))[1]
    assert reached[0] == reached[1]
    assert (frugal.calls, wasteful.calls) == (1, 2)
    assert {"state_error", "energy_change", "phase_error", "evaluations"} <= set(PRESETS["default"].readouts)


def test_leading_phase_errors_have_the_signs_of_a_lag_and_a_lead() -> None:
    """For small h RK4 lags by h⁵/120 per step and symplectic Euler leads by h³/24."""
    assert leading_term(phase_error_series(M(RK4), 8)) == (5, -QQ(1, 120))
    assert leading_term(phase_error_series(M(SYMPLECTIC), 8)) == (3, QQ(1, 24))
    assert sympy.simplify(sympy.cos(phase_per_step(M(SYMPLECTIC))) - (1 - H.as_expr() ** 2 / 2)) == 0
    assert START == (1, 0)
