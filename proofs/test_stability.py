"""The step sizes for which the methods stay bounded, and their behaviour at the limit and beyond."""

from __future__ import annotations

from fractions import Fraction as Q

import sympy
from sympy import QQ, Rational, ring, sqrt, symbols

from driftproof.numeric.scenes import LARGEST_LESSON_H
from driftproof.symbolic.algebra.certified import certified_sign
from driftproof.symbolic.derivation.energy import energy_multiplier
from driftproof.symbolic.derivation.expression_balls import certifiable
from driftproof.symbolic.derivation.one_step import RING, H, at_rational, expression
from driftproof.symbolic.derivation.stability import (
    LAMBDA,
    AtStep,
    characteristic_polynomial,
    discriminant,
    multipliers,
    stability_limit,
)
from proofs.claims import CERTIFIED, PROVED, claim
from proofs.derivations.physical import one_step_with_frequency
from proofs.derivations.signs import in_square_of_h, is_positive_between, rises_from_zero, roots_between
from proofs.setting import EULER, RK4, START, SYMPLECTIC, M, Real, energy, state_after

h = expression(H)


@claim("L162", evidence=PROVED, by="velocity eliminated")
def test_symplectic_position_recurrence() -> None:
    """Eliminating v from the symplectic updates gives qₙ₊₂ - (2 - h²)qₙ₊₁ + qₙ = 0: λ² - (2 - h²)λ + 1 = 0."""
    _, q, v, s = ring("q, v, h", QQ)
    v1 = v - s * q
    q1 = q + s * v1
    v2 = v1 - s * q1
    q2 = q1 + s * v2
    assert q2 - (2 - s**2) * q1 + q == 0
    assert characteristic_polynomial(M(SYMPLECTIC)) == sympy.Poly(LAMBDA**2 - (2 - h**2) * LAMBDA + 1, LAMBDA)
    assert characteristic_polynomial(M(EULER)) != characteristic_polynomial(M(SYMPLECTIC))


@claim("L163", evidence=PROVED, by="sign of discriminant")
def test_symplectic_roots_on_unit_circle_of_h_lt_two() -> None:
    """For 0 < h < 2 the two roots are distinct and lie on the unit circle: the discriminant is -h²(2 - h)(2 + h) < 0.

    Complex roots of a real polynomial are conjugate, and their product, the constant term, is 1.
    """
    D = discriminant(M(SYMPLECTIC))
    assert D == -(H**2) * (2 - H) * (2 + H)
    assert is_positive_between(-D, Q(0), Q(2))
    assert characteristic_polynomial(M(SYMPLECTIC)).nth(0) == 1
    assert not is_positive_between(-D, Q(0), Q(3))


@claim("L164", evidence=PROVED, by="Jordan block shown")
def test_symplectic_roots_merge_in_a_jordan_block_at_two() -> None:
    """At h = 2 the roots merge at -1, and M is not -I: (M + I) is not zero, its square is."""
    at_two = AtStep(M(SYMPLECTIC), sympy.Integer(2))
    characteristic = characteristic_polynomial(M(SYMPLECTIC)).as_expr().subs(h, 2)
    assert sympy.factor(characteristic) == (LAMBDA + 1) ** 2
    N = at_two.matrix + sympy.eye(2)
    assert sympy.zeros(2) != N
    assert sympy.zeros(2) == N**2
    assert at_two.jordan_block
    assert not at_two.bounded
    assert AtStep(M(SYMPLECTIC), Rational(199, 100)).bounded
    assert stability_limit(M(SYMPLECTIC)) == 2


@claim("L165", evidence=PROVED, by="induction on n")
def test_symplectic_state_grows_linearly_at_two() -> None:
    """At h = 2 the state from (1, 0) grows: zₙ = (-1)ⁿ(2n + 1, 2n). One with q = v does not: it only changes sign."""
    _, n = ring("n", QQ)
    step = M(SYMPLECTIC)
    (a, b), (c, d) = [[at_rational(entry, Q(2)) for entry in row] for row in step.to_list()]
    state, following = (2 * n + 1, 2 * n), (2 * n + 3, 2 * n + 2)
    one_step = tuple(QQ(x.numerator) * state[0] + QQ(y.numerator) * state[1] for x, y in ((a, b), (c, d)))
    assert one_step == tuple(-component for component in following)
    assert (a + b, c + d) == (-1, -1)
    assert tuple(int(component.evaluate(n, 0)) for component in state) == START
    assert state_after(SYMPLECTIC, 7, Q(2), (Q(3), Q(3))) == (-3, -3)


@claim("L174", evidence=PROVED, by="no eigenvector on axis")
def test_symplectic_state_grows_of_h_gt_two() -> None:
    """Beyond h = 2 the state from (1, 0) grows, too: one root is below -1, and (1, 0) has a share of its eigenvector.

    At λ = -1 the characteristic polynomial is 4 - h² < 0, so its roots are real and lie on both sides of -1. (1, 0) is
    no eigenvector, because its image has the velocity -h, so both eigenvectors contribute.
    """
    characteristic = characteristic_polynomial(M(SYMPLECTIC))
    at_minus_one = RING.from_expr(characteristic.eval(-1))
    assert at_minus_one == (2 - H) * (2 + H)
    assert is_positive_between(-at_minus_one, Q(2), None)
    assert characteristic.nth(0) == 1
    assert M(SYMPLECTIC).to_list()[1][0] == -H
    assert energy(*state_after(SYMPLECTIC, 4, Q(5, 2))) > energy(*START)


@claim("L175", evidence=PROVED, by="visible sign, Sturm")
def test_rk4_stability_is_restricted_too() -> None:
    """RK4 has a limit of its own: its powers are bounded up to 2 sqrt 2 and not beyond.

    The energy of every state is multiplied by m in each step: at most 1 as far as the limit, more than 1 beyond.
    """
    limit = stability_limit(M(RK4))
    assert limit == 2 * sqrt(2)
    m = in_square_of_h(energy_multiplier(M(RK4)))
    assert is_positive_between(1 - m, Q(0), Q(8))
    assert at_rational(m, Q(8)) == 1
    assert is_positive_between(m - 1, Q(8), None)
    assert limit != stability_limit(M(SYMPLECTIC))


@claim("L176", evidence=PROVED, by="expand squared modulus")
def test_rk4_energy_multiplier() -> None:
    """RK4's energy multiplier per step is 1 - h⁶/72 + h⁸/576, the squared modulus of 1 + ih - h²/2 - ih³/6 + h⁴/24."""
    assert energy_multiplier(M(RK4)) == 1 - H**6 / 72 + H**8 / 576
    real, imaginary = 1 - H**2 / 2 + H**4 / 24, H - H**3 / 6
    assert real**2 + imaginary**2 == 1 - H**6 / 72 + H**8 / 576
    assert energy_multiplier(M(RK4)) != 1 - H**6 / 72


@claim("L177", evidence=PROVED, by="visible sign, Sturm")
def test_rk4_energy_multiplier_lt_one_of_h_lt_two_sqrt_two() -> None:
    """Between 0 and 2 sqrt 2 the multiplier is below 1, so RK4 damps: 1 - m = h⁶(8 - h²)/576, and m >= 1/4."""
    m = energy_multiplier(M(RK4))
    assert 1 - m == H**6 * (8 - H**2) / 576
    assert m - RING.one / 4 == (H**2 - 6) ** 2 * (H**4 + 4 * H**2 + 12) / 576
    assert is_positive_between(in_square_of_h(1 - m), Q(0), Q(8))  # in h², so that the end is rational
    assert roots_between(in_square_of_h(1 - m), Q(0), Q(9)) == 1


@claim("L178", evidence=PROVED, by="visible sign, Sturm")
def test_rk4_energy_multiplier_gt_one_of_h_gt_two_sqrt_two() -> None:
    """Beyond 2 sqrt 2 the multiplier exceeds 1: m - 1 = h⁶(h² - 8)/576."""
    excess = energy_multiplier(M(RK4)) - 1
    assert excess == H**6 * (H**2 - 8) / 576
    assert is_positive_between(in_square_of_h(excess), Q(8), None)
    assert not is_positive_between(in_square_of_h(excess), Q(7), None)


@claim("L179", evidence=PROVED, by="algebraic number field")
def test_rk4_energy_multiplier_eq_one_at_two_sqrt_two() -> None:
    """At 2 sqrt 2 the multiplier is exactly 1. No double is 2 sqrt 2: at the nearest it is above 1, one lower below."""
    at_limit = AtStep(M(RK4), 2 * sqrt(2))
    assert at_limit.determinant == 1
    assert at_limit.bounded
    multiplier = energy_multiplier(M(RK4))
    nearest = Q(6369051672525773, 2**51)  # the double closest to 2 sqrt 2, and its neighbour below
    below = nearest - Q(1, 2**51)
    assert at_rational(multiplier, nearest) > 1 > at_rational(multiplier, below)
    assert nearest**2 > 8 > ((nearest + below) / 2) ** 2 > below**2
    assert Q(float(below)) == below < nearest == Q(float(nearest))


@claim("L180", evidence=CERTIFIED, by="exact advance, enclosed")
def test_rk4_phase_error_remains_at_two_sqrt_two() -> None:
    """At 2 sqrt 2 the phase is still wrong: each step turns by π + atan(2 sqrt 2), a lead of 88.47... degrees."""
    limit = 2 * sqrt(2)
    assert AtStep(M(RK4), limit).matrix == sympy.Matrix([[-Rational(1, 3), -limit / 3], [limit / 3, -Rational(1, 3)]])
    advance = sympy.pi + sympy.atan(limit)  # cos = -1/3 and sin = -2 sqrt 2 / 3, in the third quarter
    assert sympy.simplify(sympy.cos(advance) + Rational(1, 3)) == 0
    assert sympy.simplify(sympy.sin(advance) + limit / 3) == 0
    lead = certifiable((advance - limit) * 180 / sympy.pi)
    assert certified_sign(lead) > 0
    assert Real(Q(8847, 100)) < Real(lead)
    assert Real(lead) < Real(Q(8848, 100))


@claim("L182", evidence=PROVED, by="squares compared")
def test_largest_step_between_the_two_limits() -> None:
    """The largest step on offer, 5/2, is inside RK4's interval and outside the symplectic one: 4 < (5/2)² < 8."""
    assert 4 < LARGEST_LESSON_H**2 < 8
    largest = Rational(LARGEST_LESSON_H)
    assert AtStep(M(RK4), largest).bounded
    assert not AtStep(M(SYMPLECTIC), largest).bounded
    assert at_rational(energy_multiplier(M(RK4)), LARGEST_LESSON_H) == Q(38081, 147456)
    assert sorted(root.subs(h, largest) for root in multipliers(M(SYMPLECTIC))) == [-4, -Rational(1, 4)]


@claim("L183", evidence=PROVED, by="scaled by ω")
def test_limits_belong_to_method_and_oscillator() -> None:
    """The limits belong to the method and to this oscillator: with frequency ω the step matrix is that of ωh.

    So the limits become 2/ω and 2 sqrt 2/ω; and other methods have others, forward Euler none above 0.
    """
    from driftproof.methods.catalogue import METHODS

    w, s = symbols("w h")
    for key in (EULER, SYMPLECTIC, RK4):
        scaled = [[entry.as_expr() for entry in row] for row in one_step_with_frequency(METHODS[key])]
        (qq, qv), (vq, vv) = [[expression(entry).subs(h, w * s) for entry in row] for row in M(key).to_list()]
        assert sympy.expand(sympy.Matrix(scaled) - sympy.Matrix([[qq, qv / w], [vq * w, vv]])) == sympy.zeros(2)
    assert {key: stability_limit(M(key)) for key in (EULER, SYMPLECTIC, RK4)} == {
        EULER: 0,
        SYMPLECTIC: 2,
        RK4: 2 * sqrt(2),
    }


@claim("L065", evidence=PROVED, by="visible sign, Taylor")
def test_higher_order_is_neither_exact_nor_unrestricted() -> None:
    """Order four makes RK4 neither exact, its step misses cos h, nor unrestricted, its powers grow beyond 2 sqrt 2.

    From (1, 0) it reaches a position above cos h for every h > 0: four derivatives of the difference lead to 1 - cos h.
    """
    position = expression(M(RK4).to_list()[0][0])
    assert rises_from_zero(position - sympy.cos(h), h)
    assert not rises_from_zero(expression(M(EULER).to_list()[0][0]) - sympy.cos(h) - h**2 / 2, h)
    assert is_positive_between(in_square_of_h(energy_multiplier(M(RK4)) - 1), Q(8), None)
