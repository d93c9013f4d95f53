"""How errors fall with the step size: orders, leading terms, and cases where a smaller step does not help."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import numpy as np
import sympy
from flint import acb, arb
from sympy import QQ, Rational

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.scenes import LARGEST_LESSON_H
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.algebra.certified import CertifiableReal, certified_sign, enclose, fixed, significant
from driftproof.symbolic.derivation.energy import energy_multiplier
from driftproof.symbolic.derivation.expression_balls import certifiable
from driftproof.symbolic.derivation.one_step import H, expression, matrix
from driftproof.symbolic.derivation.stability import discriminant
from driftproof.symbolic.trees.order_conditions import elementary_weight, order
from driftproof.symbolic.trees.rooted_trees import density, rooted_trees
from proofs.claims import CERTIFIED, PROVED, RESTRICTED, claim
from proofs.derivations.convergence import FINAL_TIME, global_error_coefficient, local_error
from proofs.derivations.signs import in_square_of_h, is_positive_between, rises_from_zero
from proofs.setting import (
    BOUNDARY_H,
    COMPARE_H,
    DEFAULT_H,
    END,
    EULER,
    LESSON_METHODS,
    RK4,
    SMALL_H,
    START,
    SYMPLECTIC,
    M,
    Real,
    calls_of_a_step,
    energy,
    run,
    state_after,
)

START_COLUMN = sympy.Matrix(START)
h = sympy.Symbol("h", positive=True)


def leading_state_error(key: str, at: sympy.Expr = FINAL_TIME) -> sympy.Expr:
    """The coefficient of hᵖ in the state error, a Euclidean norm, at time `at` from (1, 0)."""
    error = global_error_coefficient(local_error(M(key))).subs(FINAL_TIME, at) * START_COLUMN
    return sympy.sqrt(sympy.trigsimp(error.dot(error)))


@claim("L039", evidence=RESTRICTED, by="exact counterexample")
def test_smaller_step_smaller_energy_error_only_of_small_h() -> None:
    """Forward Euler's energy error over a fixed interval falls with the step only while h < 1.98029...

    E(T)/E₀ = exp(T log(1 + h²)/h), and the exponent falls with h exactly where 2h²/(1 + h²) > log(1 + h²). Needed: a
    step below that; at t = 10 the step 2 gives the factor 5⁵ = 3125, the larger step 5/2 only (29/4)⁴ = 2762.8..., and
    both are on offer.
    """
    growth = sympy.log(1 + h**2) / h
    slope = sympy.together(growth.diff(h) * h**2)
    assert sympy.simplify(slope - (2 * h**2 / (1 + h**2) - sympy.log(1 + h**2))) == 0
    low, high = Rational(198029, 100000), Rational(198030, 100000)
    assert certified_sign(certifiable(slope.subs(h, low))) > 0 > certified_sign(certifiable(slope.subs(h, high)))
    # one turn only: with x = h² the slope rises while x < 1 and falls after, from 0 at x = 0
    x = sympy.Symbol("x", positive=True)
    assert sympy.simplify((2 * x / (1 + x) - sympy.log(1 + x)).diff(x) - (1 - x) / (x + 1) ** 2) == 0
    at_two, at_larger = (energy(*state_after(EULER, n, END / n)) / energy(*START) for n in (5, 4))
    assert (at_two, at_larger) == (3125, Q(29, 4) ** 4)
    assert at_larger < at_two
    assert (END / 5, END / 4) == (BOUNDARY_H, LARGEST_LESSON_H)
    assert sympy.limit(growth, h, 0) == 0  # so the error does vanish in the end


@claim("L041", evidence=PROVED, by="limit, visible sign")
def test_convergence_and_long_time_behaviour_are_different_limits() -> None:
    """Forward Euler's energy converges, E(T)/E₀ → 1 as h → 0 at fixed T; at fixed h it grows without bound as n → ∞.

    At any fixed T > 0; and at any fixed h > 0 by Bernoulli's inequality, E_n/E₀ >= 1 + n h².
    """
    multiplier = expression(energy_multiplier(M(EULER))).subs(expression(H), h)
    assert multiplier == 1 + h**2
    assert sympy.limit(multiplier ** (sympy.Symbol("T", positive=True) / h), h, 0) == 1
    assert sympy.limit(multiplier ** (1 / h**2), h, 0) != 1
    assert _excess_over_bernoulli(multiplier - 1) == _N * h**4


_N = sympy.Symbol("n", positive=True)


def _excess_over_bernoulli(x: sympy.Expr) -> sympy.Expr:
    """(1 + nx)(1 + x) - (1 + (n+1)x): where it and x are not negative, (1 + x)ⁿ >= 1 + nx, by induction from n = 0."""
    return sympy.expand((1 + _N * x) * (1 + x) - (1 + (_N + 1) * x))


@claim("L064", evidence=RESTRICTED, by="order conditions, ratio")
def test_higher_order_wins_for_small_steps() -> None:
    """Higher order improves accuracy at small steps: RK4's error falls like h⁴, the Euler methods' like h.

    On any smooth problem RK4 meets all conditions up to order 4, and forward Euler misses one of order 2; here the
    quotient of their leading errors at t = 10 is h³/60, which vanishes with h, and symplectic Euler's is a positive
    multiple of h. Needed: a smooth problem on which the lower order errs at all; with y' = 1 no consistent method errs,
    and there is nothing to improve.
    """
    assert [order(METHODS[key]).order for key in (EULER, RK4)] == [1, 4]
    ratio = leading_state_error(RK4, sympy.Integer(10)) * h**4 / (leading_state_error(EULER, sympy.Integer(10)) * h)
    assert ratio == h**3 / 60
    assert local_error(M(SYMPLECTIC)).linear_order == 1
    assert certified_sign(certifiable(leading_state_error(SYMPLECTIC, sympy.Integer(10)))) > 0
    for key in (EULER, RK4):  # y' = 1: the step adds h Σ bᵢ, which is h
        assert sum(METHODS[key].b) == 1


@claim("L143", evidence=CERTIFIED, by="disjoint enclosures")
def test_errors_fall_from_default_to_small_steps() -> None:
    """From h = 1/4 to h = 1/10 over the same interval the state error falls, for each of the three methods."""
    for key in LESSON_METHODS:
        assert Real(run(key, SMALL_H).state_error) < Real(run(key, DEFAULT_H).state_error)
        assert abs(run(key, SMALL_H).energy_change) < abs(run(key, DEFAULT_H).energy_change)
    assert Real(run(EULER, Q(5, 2)).state_error) < Real(run(EULER, Q(2)).state_error)  # a smaller step can be worse


@claim("L147", evidence=CERTIFIED, by="disjoint enclosures")
def test_symplectic_compare_run_misses_the_endpoint() -> None:
    """At h = ½ the symplectic path misses the exact endpoint, by 0.250082..."""
    assert fixed(run(SYMPLECTIC, COMPARE_H).state_error, 6) == "0.250082"
    assert Real(Q(250082, 10**6)) < Real(run(SYMPLECTIC, COMPARE_H).state_error)
    assert Real(Q(1, 4)) < Real(run(SYMPLECTIC, COMPARE_H).state_error)


@claim("L148", evidence=CERTIFIED, by="disjoint enclosures")
def test_rk4_compare_run_follows_more_closely() -> None:
    """At h = ½ RK4 ends nearer to the exact state than the symplectic run, by a factor of more than 48."""
    rk4, symplectic = run(RK4, COMPARE_H).state_error, run(SYMPLECTIC, COMPARE_H).state_error
    assert Real(rk4) < Real(symplectic)
    assert certified_sign(lambda: enclose(symplectic) - 48 * enclose(rk4)) > 0


@claim("L012", evidence=RESTRICTED, by="enclosures, counterexample")
def test_rk4_follows_more_closely_on_the_steps_on_offer() -> None:
    """For four evaluations a step instead of one, RK4 follows the solution more closely than either Euler method.

    One step from any state errs less than forward Euler's for every 0 < h <= 7/2: on (0, 1] because h²/2 - h⁴/24 is
    above h⁵/120, and from there by enclosures; at t = 10 it is nearer than both at the steps named here. Needed: a step
    like those of the presets and 5/2, at which both were compared; one step of h = 4 from (1, 0) is farther off with
    RK4 than with forward Euler.
    """
    assert (calls_of_a_step(RK4), calls_of_a_step(EULER), calls_of_a_step(SYMPLECTIC)) == (4, 1, 1)
    for key, real, imaginary in ((EULER, H**0, H), (RK4, 1 - H**2 / 2 + H**4 / 24, H - H**3 / 6)):
        assert M(key) == matrix([[real, imaginary], [-imaginary, real]])  # so errors of any state are those of R(ih)
    # 1 - cos h >= h²/2 - h⁴/24 is the real part that Euler misses, and |R(ih) - e^{ih}| <= h⁵/120 what RK4 misses
    assert rises_from_zero(1 - h**2 / 2 + h**4 / 24 - sympy.cos(h), h)
    assert is_positive_between(H**2 / 2 - H**4 / 24 - H**5 / 120, Q(0), Q(1))
    pieces = [(Q(i, 64), Q(i + 1, 64)) for i in range(64, 224)]
    assert (pieces[0][0], pieces[-1][1]) == (1, Q(7, 2))
    assert all(_gain_of_rk4(low, high) > 0 for low, high in pieces)
    assert not _gain_of_rk4(Q(4), Q(4)) > 0
    for step in (SMALL_H, DEFAULT_H, COMPARE_H, Q(2), Q(5, 2)):
        rk4, euler, symplectic = (run(key, step).state_error for key in (RK4, EULER, SYMPLECTIC))
        assert Real(rk4) < Real(euler)
        assert Real(rk4) < Real(symplectic)
    assert Real(run(EULER, Q(4), Q(4)).state_error) < Real(run(RK4, Q(4), Q(4)).state_error)


def _gain_of_rk4(low: Q, high: Q) -> arb:
    """A ball that holds |1 + ih - e^{ih}|² - |R(ih) - e^{ih}|² for all h from low to high, R being RK4's."""
    at = enclose(low).union(enclose(high))
    rotation = acb(at.cos(), at.sin())
    euler = acb(1, at) - rotation
    rk4 = acb(1 - at**2 / 2 + at**4 / 24, at - at**3 / 6) - rotation
    return euler.real**2 + euler.imag**2 - rk4.real**2 - rk4.imag**2


@claim("L188", evidence=PROVED, by="Taylor series, trees")
def test_one_step_errors_are_h_squared_and_h_to_the_fifth() -> None:
    """One step from the exact state of a smooth problem errs by O(h²) for both Euler methods, by O(h⁵) for RK4.

    For the Euler methods by Taylor's formula, with the term in h² shown; for RK4 by the conditions of all trees up to
    order 4, one of order 5 failing. On the oscillator the leading errors of a unit state are h²/2, h²/2 and h⁵/120.
    """
    assert _forward_euler_local_error() == ((_F1 * _F / 2,), 2)
    assert _symplectic_local_error() == ((_G1 * _F / 2, -_F1 * _G / 2), 2)
    rk4 = METHODS[RK4]
    trees = [tree for size in range(1, 5) for tree in rooted_trees(size)]
    assert [elementary_weight(rk4, tree) * density(tree) for tree in trees] == [1] * 8
    assert any(elementary_weight(rk4, tree) * density(tree) != 1 for tree in rooted_trees(5))
    for key, power, size in ((EULER, 2, QQ(1, 2)), (SYMPLECTIC, 2, QQ(1, 2)), (RK4, 5, QQ(1, 120))):
        error = local_error(M(key))
        assert error.power == power
        assert error.coefficient.T * error.coefficient == size**2 * sympy.eye(2)


# Symbols for a smooth field and its first derivative at the start of a step: q' = G(v), v' = F(q), or y' = F(y).
_F, _G, _F1, _G1 = sympy.symbols("F G F1 G1")


def _forward_euler_local_error() -> tuple[tuple[sympy.Expr, ...], int]:
    """(coefficient, power) of the leading term of y(h) - (y + hF), where y(h) = y + hF + h²F'F/2 + O(h³), y' = F(y)."""
    return _leading(h * _F + h**2 * _F1 * _F / 2 - _on_taylor(EULER))


def _symplectic_local_error() -> tuple[tuple[sympy.Expr, ...], int]:
    """(coefficients, power) of the leading error for q' = G(v), v' = F(q), whose flow has h²G'F/2 and h²F'G/2."""
    q1, v1 = _on_taylor(SYMPLECTIC)
    return _leading(q1 - h * _G - h**2 * _G1 * _F / 2, v1 - h * _F - h**2 * _F1 * _G / 2)


def _leading(*errors: sympy.Expr) -> tuple[tuple[sympy.Expr, ...], int]:
    """The lowest power of h in any of the errors, with the coefficient of each there."""
    series = [sympy.Poly(error, h) for error in errors]
    power = min(degree for each in series for (degree,) in each.monoms())
    return tuple(sympy.expand(each.coeff_monomial(h**power)) for each in series), power


def _on_taylor(key: str) -> Any:
    """The change in a step of `key`, right up to h², for a field given by its value and its first derivative."""
    if key == EULER:
        (row,), (weight,) = METHODS[key].a, METHODS[key].b
        assert row == (0,)  # its one stage is the start
        return weight * h * _F
    q = v = sympy.Integer(0)
    for part, c in METHODS[key].parts:
        if part == "kick":
            v += c * h * (_F + _F1 * q)
        else:
            q += c * h * (_G + _G1 * v)
    return q, v


@claim("L185", evidence=PROVED, by="exact counterexamples")
def test_orders_are_for_smooth_problems_over_fixed_intervals() -> None:
    """For smooth problems over a fixed interval, but not without both, a one-step O(hᵖ⁺¹) becomes a global O(hᵖ).

    With eₙ₊₁ <= (1 + hL)eₙ + Chᵖ⁺¹ and e₀ = 0 induction gives eₙ <= Chᵖ((1 + hL)ⁿ - 1)/L <= Chᵖ(exp(LT) - 1)/L.
    With a rate that jumps at t = 1/3, RK4's error at t = 1 is h/6 for h = 1/2, 1/4, 1/8, ...; and over an interval that
    grows, forward Euler's energy exceeds every bound at any fixed h.
    """
    n, L, C, p = sympy.symbols("n L C p", positive=True)
    bound = lambda k: C * h**p * ((1 + h * L) ** k - 1) / L
    assert bound(0) == 0
    assert sympy.simplify((1 + h * L) * bound(n) + C * h ** (p + 1) - bound(n + 1)) == 0
    # (1 + hL)ⁿ <= exp(hLn), because exp(x) - 1 - x is 0 at 0 and its derivative exp(x) - 1 has the sign of x
    x = sympy.Symbol("x", positive=True)
    assert (sympy.exp(x) - 1 - x).subs(x, 0) == 0
    assert (sympy.exp(x) - 1 - x).diff(x) == sympy.exp(x) - 1
    assert [_error_of_a_jump(Q(thirds, 3)) for thirds in (0, 1, 2)] == [0, Q(1, 6), -Q(1, 6)]
    assert [2 * thirds % 3 for thirds in (1, 2)] == [2, 1]  # 1/3 is 2ᵏ/3 steps: a third into one, or two thirds
    assert _excess_over_bernoulli(expression(energy_multiplier(M(EULER)) - 1)) == _N * expression(H) ** 4


def _error_of_a_jump(at: Q) -> Q:
    """RK4's error, over h, in the step in which y' jumps from 0 to 1 `at` a part of it; the other steps are exact."""
    rk4 = METHODS[RK4]
    return Q(sum(b for b, c in zip(rk4.b, rk4.c, strict=True) if c >= at)) - (1 - at)


@claim("L186", evidence=PROVED, by="one condition fails")
def test_euler_methods_have_global_error_of_first_order() -> None:
    """Over a fixed interval both Euler methods err by O(h) on smooth problems, and not by O(h²) on this one.

    Their one-step errors are O(h²) on any smooth problem (L188), and that makes O(h) over an interval (L185). On the
    oscillator the errors are Th/2 and, from (1, 0), (h/2)|sin T|, to leading order.
    """
    assert [power for _, power in (_forward_euler_local_error(), _symplectic_local_error())] == [2, 2]
    assert sympy.simplify(leading_state_error(EULER) ** 2 - (FINAL_TIME / 2) ** 2) == 0
    assert sympy.simplify(leading_state_error(SYMPLECTIC) ** 2 - (sympy.sin(FINAL_TIME) / 2) ** 2) == 0
    assert local_error(M(EULER)).linear_order == local_error(M(SYMPLECTIC)).linear_order == 1
    assert leading_state_error(EULER, sympy.Integer(10)) == 5  # not zero, so not of second order


@claim("L187", evidence=PROVED, by="all trees to order four")
def test_rk4_has_global_error_of_fourth_order() -> None:
    """Over a fixed interval RK4 errs by O(h⁴) on smooth problems, and not by O(h⁵) on this one.

    Its one-step error is O(h⁵) on any smooth problem (L188), and that makes O(h⁴) over an interval (L185). On the
    oscillator the error is Th⁴/120 to leading order, h⁴/12 at T = 10.
    """
    assert order(METHODS[RK4]).order == 4
    assert local_error(M(RK4)).linear_order == 4
    assert sympy.simplify(leading_state_error(RK4) ** 2 - (FINAL_TIME / 120) ** 2) == 0
    assert leading_state_error(RK4, sympy.Integer(10)) == Rational(1, 12)


@claim("L191", evidence=PROVED, by="ratio of leading terms")
def test_halving_divides_leading_error_by_two_and_sixteen() -> None:
    """Halving h divides the leading global error Chᵖ by 2ᵖ: by 2 at first order, by 16 at fourth.

    The runs approach those ratios: RK4's between 1/32 and 1/64 is within 0.001 of 16.
    """
    assert [2 ** local_error(M(key)).linear_order for key in LESSON_METHODS] == [2, 2, 16]
    coarse, fine = run(RK4, Q(1, 32)).state_error, run(RK4, Q(1, 64)).state_error

    def ratio_minus(x: Q) -> int:
        return certified_sign(lambda: enclose(coarse) - enclose(x) * enclose(fine))

    assert ratio_minus(Q(15999, 1000)) > 0 > ratio_minus(Q(16001, 1000))


@claim("L192", evidence=CERTIFIED, by="three exact examples")
def test_observed_ratio_can_be_changed_three_ways() -> None:
    """A vanishing leading term, a coarse step and roundoff can each change the ratio of errors under halving.

    At T = 4 the error of symplectic Euler's velocity from (1, 0), whose O(h) term is 0, falls by 4 rather than 2.
    Forward Euler's falls by less than 1.19 from h = 5/2, and from 5/2 to 2 it *grows*. Halved from 1/64, RK4's step
    divides its exact error by 16, and the error of the same runs in binary32 by less than 2.
    """
    velocity_term = (global_error_coefficient(local_error(M(SYMPLECTIC))) * START_COLUMN)[1]
    assert velocity_term == 0

    def velocity_error(step: Q) -> CertifiableReal:
        exact = run(SYMPLECTIC, step, Q(4))
        return lambda: abs(enclose(exact.final_state[1]) - enclose(exact.exact_state[1]))

    def ratio(coarse: CertifiableReal, fine: CertifiableReal) -> Real:
        return Real(lambda: enclose(coarse) / enclose(fine))

    assert ratio(velocity_error(Q(1, 32)), velocity_error(Q(1, 64))) > Real(Q(39, 10))
    assert ratio(*(run(EULER, step).state_error for step in (Q(5, 2), Q(5, 4)))) < Real(Q(119, 100))
    assert Real(run(EULER, Q(5, 2)).state_error) < Real(run(EULER, Q(2)).state_error)
    steps = Q(1, 64), Q(1, 128)
    assert ratio(*(run(RK4, step).state_error for step in steps)) > Real(Q(159, 10))
    assert ratio(*(_binary32_error(step) for step in steps)) <= Real(Q(2))


def _binary32_error(step: Q) -> CertifiableReal:
    """The error of RK4's run in binary32 at t = 10, as the sum over both components."""
    state, size = (np.float32(1), np.float32(0)), np.float32(float(step))
    assert Q(float(size)) == step
    for _ in range(int(END / step)):
        state = HAND_WRITTEN[RK4](oscillator, *state, size)
    assert all(isinstance(x, np.float32) for x in state)
    exact = run(RK4, step).exact_state
    return lambda: sum(abs(enclose(Q(float(x))) - enclose(y)) for x, y in zip(state, exact, strict=True))


@claim("L193", evidence=CERTIFIED, by="disjoint enclosures")
def test_one_coarse_comparison_shows_no_order() -> None:
    """One coarse comparison shows no order: symplectic Euler's error falls by 2.79 from h = 1/2 to 1/4, not by 2.

    Read as an order that would be one and a half; it is one.
    """
    coarse, fine = (run(SYMPLECTIC, step).state_error for step in (COMPARE_H, DEFAULT_H))
    assert significant(lambda: enclose(coarse) / enclose(fine), 3) == "2.79"
    assert local_error(M(SYMPLECTIC)).linear_order == 1


@claim("L008", evidence=RESTRICTED, by="three facts of h")
def test_step_size_sets_convergence_work_and_stability() -> None:
    """The step decides three things: the error Chᵖ at t = 10, the 10/h steps of work, and whether runs stay bounded.

    Shown for the three methods: C is not 0 and p >= 1; 10/h steps, of 1, 1 and 4 evaluations each; and symplectic Euler
    and RK4 are bounded below 2 and 2 sqrt 2 and not beyond: below 2 the two roots of product 1 are conjugate, beyond
    they are real and apart; RK4 multiplies the energy. Needed: a method with a limit; forward Euler is bounded for no
    positive h, so there the step does not decide.
    """
    for key, step_calls in ((EULER, 1), (SYMPLECTIC, 1), (RK4, 4)):
        assert local_error(M(key)).linear_order >= 1
        assert certified_sign(certifiable(leading_state_error(key, sympy.Integer(10)))) > 0
        assert [run(key, END / n).steps for n in range(1, 41)] == [*range(1, 41)]
        assert calls_of_a_step(key) == step_calls
    roots_apart = discriminant(M(SYMPLECTIC))
    grows = {key: in_square_of_h(energy_multiplier(M(key)) - 1) for key in (EULER, RK4)}
    for bounded, unbounded, limit in (-roots_apart, roots_apart, Q(2)), (-grows[RK4], grows[RK4], Q(8)):
        assert is_positive_between(bounded, Q(0), limit)
        assert is_positive_between(unbounded, limit, None)
    assert M(SYMPLECTIC).det() == 1
    assert grows[EULER] == H


@claim("L151", evidence=CERTIFIED, by="ball enclosure")
def test_coarse_segments_skip_much_of_the_motion() -> None:
    """A segment can hide much motion: at h = 5/2 the exact state turns by over 143° between two samples."""
    turn = certifiable(Rational(5, 2) * 180 / sympy.pi)
    assert Real(Q(143)) < Real(turn)
    assert Real(turn) < Real(Q(144))
