"""How errors fall with the step: orders with their leading terms, and where a smaller step does not help."""

from __future__ import annotations

from fractions import Fraction as Q

import sympy
from sympy import QQ, Rational

from driftproof.symbolic.algebra.certified import CertifiableReal, certified_sign, enclose, fixed, is_less
from driftproof.symbolic.derivation.convergence import T, global_error_coefficient, local_error
from driftproof.symbolic.derivation.energy import energy_multiplier
from driftproof.symbolic.derivation.expression_balls import certifiable
from driftproof.symbolic.derivation.one_step import H, expression
from driftproof.symbolic.derivation.phase import STEPS, closed_form
from proofs.claims import CERTIFIED, PROVED, RESTRICTED, claim
from proofs.setting import (
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
    energy,
    run,
    state_after,
)

START_COLUMN = sympy.Matrix(START)
h = sympy.Symbol("h", positive=True)


def leading_state_error(key: str, at: sympy.Expr = T) -> sympy.Expr:
    """The coefficient of hᵖ in the state error at time `at` from (1, 0), a Euclidean norm."""
    error = global_error_coefficient(local_error(M(key))).subs(T, at) * START_COLUMN
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
    assert sympy.limit(growth, h, 0) == 0  # so the error does vanish in the end


@claim("L041", evidence=PROVED, by="two limits")
def test_convergence_and_long_time_behaviour_are_different_limits() -> None:
    """Forward Euler converges, E(T)/E₀ → 1 as h → 0 at fixed T; at fixed h it grows without bound as n → ∞."""
    n = sympy.Symbol("n", positive=True)
    multiplier = expression(energy_multiplier(M(EULER))).subs(expression(H), h)
    assert multiplier == 1 + h**2
    assert sympy.limit(multiplier ** (END / h), h, 0) == 1
    assert sympy.limit(multiplier.subs(h, Rational(1, 10)) ** n, n, sympy.oo) == sympy.oo


@claim("L064", evidence=PROVED, by="leading terms compared")
def test_higher_order_wins_for_small_steps() -> None:
    """On this smooth problem the higher order wins once h is small: RK4's error is Ch⁴, the others' Ch."""
    orders = {key: local_error(M(key)).linear_order for key in LESSON_METHODS}
    assert orders == {EULER: 1, SYMPLECTIC: 1, RK4: 4}
    ratio = leading_state_error(RK4, sympy.Integer(10)) * h**4 / (leading_state_error(EULER, sympy.Integer(10)) * h)
    assert sympy.limit(ratio, h, 0) == 0


@claim("L143", evidence=CERTIFIED, by="disjoint enclosures")
def test_errors_fall_from_default_to_small_steps() -> None:
    """From h = 1/4 to h = 1/10 over the same interval the state error falls, for each of the three methods."""
    for key in LESSON_METHODS:
        assert is_less(run(key, SMALL_H).state_error, run(key, DEFAULT_H).state_error)
        assert abs(run(key, SMALL_H).energy_change) < abs(run(key, DEFAULT_H).energy_change)
    assert is_less(run(EULER, Q(5, 2)).state_error, run(EULER, Q(2)).state_error)  # a smaller step can be worse


@claim("L147", evidence=CERTIFIED, by="disjoint enclosures")
def test_symplectic_compare_run_misses_the_endpoint() -> None:
    """At h = ½ the symplectic path misses the exact endpoint, by 0.250082..."""
    assert fixed(run(SYMPLECTIC, COMPARE_H).state_error, 6) == "0.250082"
    assert is_less(Q(1, 4), run(SYMPLECTIC, COMPARE_H).state_error)


@claim("L148", evidence=CERTIFIED, by="disjoint enclosures")
def test_rk4_compare_run_follows_more_closely() -> None:
    """At h = ½ RK4 ends nearer to the exact state than the symplectic run, by a factor of more than 48."""
    rk4, symplectic = run(RK4, COMPARE_H).state_error, run(SYMPLECTIC, COMPARE_H).state_error
    assert is_less(rk4, symplectic)
    assert certified_sign(lambda: enclose(symplectic) - 48 * enclose(rk4)) > 0


@claim("L012", evidence=RESTRICTED, by="exact counterexample")
def test_rk4_follows_more_closely_on_the_steps_on_offer() -> None:
    """For four evaluations a step instead of one, RK4 follows the solution more closely.

    True at t = 10 for every preset step and the largest on offer. Needed: a step not much larger; one step of h = 4
    from (1, 0) is farther off with RK4 than with forward Euler.
    """
    from driftproof.numeric.steppers import evaluations_per_step

    assert (evaluations_per_step(RK4), evaluations_per_step(EULER), evaluations_per_step(SYMPLECTIC)) == (4, 1, 1)
    for step in (SMALL_H, DEFAULT_H, COMPARE_H, Q(2), Q(5, 2)):
        rk4, euler, symplectic = (run(key, step).state_error for key in (RK4, EULER, SYMPLECTIC))
        assert is_less(rk4, euler)
        assert is_less(rk4, symplectic)
    assert is_less(run(EULER, Q(4), Q(4)).state_error, run(RK4, Q(4), Q(4)).state_error)


@claim("L188", evidence=PROVED, by="series, first term")
def test_one_step_errors_are_h_squared_and_h_to_the_fifth() -> None:
    """From the exact state one step errs by h²/2 for both Euler methods and by h⁵/120 for RK4, to leading order."""
    euler, symplectic, rk4 = (local_error(M(key)) for key in LESSON_METHODS)
    assert (euler.power, symplectic.power, rk4.power) == (2, 2, 5)
    for error, size in ((euler, QQ(1, 2)), (symplectic, QQ(1, 2)), (rk4, QQ(1, 120))):
        C = error.coefficient
        assert C.T * C == size**2 * sympy.eye(2)  # the same size from every unit state


@claim("L186", "L185", evidence=PROVED, by="series, first term")
def test_euler_methods_have_global_error_of_first_order() -> None:
    """Over a fixed interval both Euler methods err by O(h): Th/2 and, from (1, 0), (h/2)|sin T|, to leading order.

    The oscillator is smooth and the interval finite, as the sentence asks.
    """
    assert sympy.simplify(leading_state_error(EULER) ** 2 - (T / 2) ** 2) == 0
    assert sympy.simplify(leading_state_error(SYMPLECTIC) ** 2 - (sympy.sin(T) / 2) ** 2) == 0
    assert local_error(M(EULER)).linear_order == local_error(M(SYMPLECTIC)).linear_order == 1
    assert leading_state_error(EULER, sympy.Integer(10)) == 5  # not zero, so not of second order


@claim("L187", evidence=PROVED, by="series, first term")
def test_rk4_has_global_error_of_fourth_order() -> None:
    """Over a fixed interval RK4 errs by O(h⁴): Th⁴/120 to leading order, h⁴/12 at T = 10."""
    assert local_error(M(RK4)).linear_order == 4
    assert sympy.simplify(leading_state_error(RK4) ** 2 - (T / 120) ** 2) == 0
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
    """A vanishing leading term, a coarse step and roundoff each change the ratio of errors under halving.

    At T = 4 the error of symplectic Euler's velocity from (1, 0), whose O(h) term is 0, falls by 4 rather than 2.
    Forward Euler's error *grows* from h = 5/2 to 2. In floats, halving a tiny h changes nothing at all.
    """
    velocity_term = (global_error_coefficient(local_error(M(SYMPLECTIC))) * START_COLUMN)[1]
    assert velocity_term == 0

    def velocity_error(step: Q) -> CertifiableReal:
        exact = run(SYMPLECTIC, step, Q(4))
        return lambda: abs(enclose(exact.final_state[1]) - enclose(exact.exact_state[1]))

    coarse, fine = velocity_error(Q(1, 32)), velocity_error(Q(1, 64))
    assert certified_sign(lambda: enclose(coarse) - enclose(Q(39, 10)) * enclose(fine)) > 0
    assert is_less(run(EULER, Q(5, 2)).state_error, run(EULER, Q(2)).state_error)
    tiny = 2.0**-30
    assert 1.0 - tiny * tiny == 1.0 - (tiny / 2) * (tiny / 2)


@claim("L193", evidence=CERTIFIED, by="disjoint enclosures")
def test_one_coarse_comparison_shows_no_order() -> None:
    """One coarse comparison shows no order: symplectic Euler's error falls by 2.78 from h = 1/2 to 1/4, not by 2.

    Read as an order that would be one and a half; it is one.
    """
    coarse, fine = (run(SYMPLECTIC, step).state_error for step in (COMPARE_H, DEFAULT_H))
    assert certified_sign(lambda: enclose(coarse) - enclose(Q(278, 100)) * enclose(fine)) > 0
    assert local_error(M(SYMPLECTIC)).linear_order == 1


@claim("L008", evidence=PROVED, by="three facts of h")
def test_step_size_sets_convergence_work_and_stability() -> None:
    """The step decides three things: the error Chᵖ, the T/h steps of work, and whether the run stays bounded."""
    from driftproof.symbolic.derivation.stability import AtStep

    assert leading_state_error(EULER, sympy.Integer(10)) == 5
    assert [run(EULER, step).steps for step in (Q(1, 2), Q(1, 4))] == [20, 40]
    assert AtStep(M(SYMPLECTIC), sympy.Rational(19, 10)).bounded
    assert not AtStep(M(SYMPLECTIC), sympy.Rational(5, 2)).bounded


@claim("L151", evidence=CERTIFIED, by="ball enclosure")
def test_coarse_segments_skip_much_of_the_motion() -> None:
    """A segment can hide much motion: at h = 5/2 the exact state turns by over 143° between two samples."""
    turn = certifiable(Rational(5, 2) * 180 / sympy.pi)
    assert is_less(Q(143), turn)
    assert is_less(turn, Q(144))


def test_closed_form_of_symplectic_euler_from_the_start() -> None:
    """From (1, 0): qₙ = cos((n + ½)θ)/cos(θ/2), vₙ = -sin(nθ)/cos(θ/2) with 2 sin(θ/2) = h: obeys one more step."""
    theta, n = sympy.symbols("theta n", real=True)
    step = 2 * sympy.sin(theta / 2)

    def state(k: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
        return (
            sympy.cos((k + Rational(1, 2)) * theta) / sympy.cos(theta / 2),
            -sympy.sin(k * theta) / sympy.cos(theta / 2),
        )

    q, v = state(n)
    new_v = v - step * q
    new_q = q + step * new_v
    for reached, expected in zip((new_q, new_v), state(n + 1), strict=True):
        difference = sympy.expand_trig(sympy.expand((reached - expected) * sympy.cos(theta / 2)))
        assert sympy.simplify(difference.rewrite(sympy.exp).expand()) == 0
    assert (state(sympy.Integer(0))[0], state(sympy.Integer(0))[1]) == START
    power = closed_form(M(SYMPLECTIC)).subs(expression(H), 1).subs(STEPS, 3)
    assert sympy.simplify(power[0, 0] - state_after(SYMPLECTIC, 3, Q(1))[0]) == 0
