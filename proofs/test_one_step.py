"""One step of each method: the formulas of the lesson as identities over Q[h, q, v]."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

from sympy import QQ, ring

from driftproof.methods.catalogue import METHODS
from driftproof.numeric import readouts
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.one_step import STATE_H, STATE_Q, STATE_V, H, matrix, matrix_of, symbolic_step
from driftproof.symbolic.trees.order_conditions import elementary_weight, order
from driftproof.symbolic.trees.rooted_trees import density, rooted_trees
from proofs import program
from proofs.claims import COUNTED, PROVED, claim
from proofs.setting import EULER, FIRST_H, LESSON_METHODS, RK4, START, SYMPLECTIC, M, state_after, step_of

h, q, v = STATE_H, STATE_Q, STATE_V


def rk4_slopes() -> list[tuple[Any, Any]]:
    """The four slopes of RK4 as the lesson writes them, polynomials in h, q and v."""
    k1 = (v, -q)
    k2 = (v + h * k1[1] / 2, -(q + h * k1[0] / 2))
    k3 = (v + h * k2[1] / 2, -(q + h * k2[0] / 2))
    k4 = (v + h * k3[1], -(q + h * k3[0]))
    return [k1, k2, k3, k4]


def written(key: str) -> list[tuple[Any, Any]]:
    """(q₁, v₁) of one step in Q[q, v, h], by the method's table, by our stepper, and by the method of our program."""
    name = dict(zip(LESSON_METHODS, program.METHODS, strict=True))[key]
    return [step_of(key), symbolic_step(HAND_WRITTEN[key]), program.step(name, (q, v), h)]  # type: ignore[arg-type]


@claim("L033", "L204", evidence=PROVED, by="identity over Q[h,q,v]")
def test_forward_euler_step_uses_old_state_twice() -> None:
    """Forward Euler: q₁ = q + hv and v₁ = v - hq, both from the old state; our stepper and program do the same."""
    assert written(EULER) == [(q + h * v, v - h * q)] * 3
    assert M(EULER) == matrix([[1, H], [-H, 1]])


@claim("L032", evidence=PROVED, by="read off tableau")
def test_forward_euler_rates_are_those_of_the_start() -> None:
    """Forward Euler takes its only rate at the beginning of the step: one stage, at c = 0, with weight 1."""
    euler: Any = METHODS[EULER]
    assert (euler.a, euler.b, euler.c) == (((0,),), (1,), (0,))
    midpoint: Any = METHODS["midpoint2"]
    assert midpoint.c != (0, 0)


@claim("L034", evidence=PROVED, by="matrices differ by h²")
def test_reusing_an_updated_variable_is_another_method() -> None:
    """Overwriting q, or v, before the other update is formed gives another method: one entry changes by -h²."""
    position_reused = matrix_of(lambda force, x, y, s: (x + s * y, y + s * force(x + s * y)))
    velocity_reused = matrix_of(lambda force, x, y, s: (x + s * (y + s * force(x)), y + s * force(x)))
    assert position_reused - M(EULER) == matrix([[0, 0], [0, -(H**2)]])
    assert velocity_reused - M(EULER) == matrix([[-(H**2), 0], [0, 0]])
    assert velocity_reused == M(SYMPLECTIC)
    assert position_reused == M("symplectic_euler_position_first")


@claim("L011", evidence=PROVED, by="determinants differ")
def test_velocity_first_changes_the_growth_of_area() -> None:
    """Updating the velocity first changes what a step does: area is kept instead of growing by 1 + h²."""
    assert M(EULER).det() == 1 + H**2
    assert M(SYMPLECTIC).det() == 1


@claim("L006", evidence=PROVED, by="identity over Q[h,q,v]")
def test_velocity_first_explains_the_difference() -> None:
    """Why velocity first matters: the two steps differ only by h times the velocity's change, in the position."""
    (euler_q, euler_v), (symplectic_q, symplectic_v) = step_of(EULER), step_of(SYMPLECTIC)
    assert symplectic_v == euler_v
    assert symplectic_q - euler_q == h * (symplectic_v - v) == -(h**2) * q


@claim("L042", "L045", evidence=PROVED, by="identity over Q[h,q,v]")
def test_symplectic_euler_position_uses_the_new_velocity() -> None:
    """Symplectic Euler changes the order: the velocity first, then the position from the new velocity."""
    new_q, new_v = step_of(SYMPLECTIC)
    assert new_v == v - h * q
    assert new_q == q + h * new_v
    assert new_q != q + h * v


@claim("L043", "L205", evidence=PROVED, by="identity over Q[h,q,v]")
def test_symplectic_euler_step() -> None:
    """v₁ = v - hq and q₁ = q + hv₁, in our stepper and program, too; the matrix is ((1-h², h), (-h, 1))."""
    assert written(SYMPLECTIC) == [(q + h * (v - h * q), v - h * q)] * 3
    assert M(SYMPLECTIC) == matrix([[1 - H**2, H], [-H, 1]])


@claim("L046", evidence=PROVED, by="force called once")
def test_both_updates_are_explicit_for_a_force_of_position() -> None:
    """No equation has to be solved: the force is asked once, at the old position, before anything depends on it.

    A force that depended on the velocity could not be asked so: the step hands it the position alone.
    """
    asked: list[Any] = []

    def force(x: Any) -> Any:
        asked.append(x)
        return -x

    symbolic_step(HAND_WRITTEN[SYMPLECTIC], force)
    assert asked == [q]


@claim("L047", evidence=PROVED, by="explicit counterexample")
def test_symplectic_euler_is_implicit_for_a_nonseparable_energy() -> None:
    """For H = ½(1 + q²)v² the formula v₁ = v - h ∂H/∂q(q, v₁) is an equation in v₁, quadratic, not an assignment."""
    _, x, y, s, new = ring("q, v, h, v1", QQ)
    energy = (1 + x**2) * new**2 / 2
    equation = new - y + s * energy.diff(x)
    assert equation == s * x * new**2 + new - y
    assert equation.degree(new) == 2
    separable = (new**2 + x**2) / 2
    assert (new - y + s * separable.diff(x)).degree(new) == 1


@claim("L048", evidence=PROVED, by="series, first term")
def test_symplectic_euler_has_order_one_and_not_two() -> None:
    """On this oscillator symplectic Euler is of first order: a step leaves the flow at h², by ((-½, 0), (0, ½))h²."""
    from proofs.derivations.convergence import local_error

    error = local_error(M(SYMPLECTIC))
    assert error.linear_order == 1
    assert error.coefficient.tolist() == [[-QQ(1, 2), 0], [0, QQ(1, 2)]]
    assert local_error(M("velocity_verlet")).linear_order == 2  # the check can tell orders apart


@claim("L058", evidence=PROVED, by="rooted trees counted")
def test_rk4_has_four_stages_and_order_four_and_not_five() -> None:
    """RK4 forms four rates, and is of order four: all 8 order conditions up to 4 hold, one of order 5 fails."""
    rk4: Any = METHODS[RK4]
    trees = [tree for size in range(1, 5) for tree in rooted_trees(size)]
    assert len(rk4_slopes()) == rk4.stages == 4
    assert [elementary_weight(rk4, tree) * density(tree) for tree in trees] == [1] * 8
    assert any(elementary_weight(rk4, tree) * density(tree) != 1 for tree in rooted_trees(5))
    assert order(rk4).order == 4


@claim("L059", "L207", evidence=PROVED, by="identity over Q[h,q,v]")
def test_rk4_step_is_the_weighted_sum_of_four_rates() -> None:
    """RK4: z + h(k₁ + 2k₂ + 2k₃ + k₄)/6, each k from the one before; our stepper and program form this polynomial."""
    k1, k2, k3, k4 = rk4_slopes()
    weighted = tuple(z + h * (a + 2 * b + 2 * c + d) / 6 for z, a, b, c, d in zip((q, v), k1, k2, k3, k4, strict=True))
    assert written(RK4) == [weighted] * 3
    taylor = [[1 - H**2 / 2 + H**4 / 24, H - H**3 / 6], [-H + H**3 / 6, 1 - H**2 / 2 + H**4 / 24]]
    assert M(RK4) == matrix(taylor)
    assert M("rk38") == M(RK4)  # on this oscillator; as methods they differ:
    assert METHODS["rk38"] != METHODS[RK4]


@claim("L060", evidence=PROVED, by="degree in h")
def test_rates_do_not_hold_the_step() -> None:
    """Each k is a rate: at h = 0 it is F(z), so the step size has to appear in the weighted sum."""
    for k in rk4_slopes():
        assert tuple(component.evaluate(h, 0) for component in k) == tuple(
            component.evaluate(h, 0) for component in (v, -q)
        )
    new_q, new_v = step_of(RK4)
    assert (new_q.evaluate(h, 0), new_v.evaluate(h, 0)) == (q.evaluate(h, 0), v.evaluate(h, 0))


@claim("L061", evidence=PROVED, by="row sums of A")
def test_rk4_times_are_start_middle_middle_end() -> None:
    """With time in the rate, RK4 asks at t, t + h/2, t + h/2 and t + h; the rows of A sum to those fractions."""
    rk4: Any = METHODS[RK4]
    assert rk4.c == (0, Q(1, 2), Q(1, 2), 1)
    assert tuple(sum(row) for row in rk4.a) == rk4.c
    rk38: Any = METHODS["rk38"]
    assert rk38.c != rk4.c


@claim("L062", evidence=PROVED, by="stages differ from result")
def test_intermediate_states_are_not_the_result() -> None:
    """The states at which RK4 asks for rates are predictions: as polynomials, none of them is the state returned."""
    result = step_of(RK4)
    asked = [(-kv, kq) for kq, kv in rk4_slopes()]
    assert all(state != result for state in asked)
    assert asked[0] == (q, v)


@claim("L208", evidence=PROVED, by="identity over Q[h,q,v]")
def test_energy_readout_is_half_the_squared_radius() -> None:
    """The energy that our readout and our program form of exact numbers is ½(q² + v²).

    Of floats the readout's is that up to rounding (T02).
    """
    assert readouts.energy((q, v)) == program.energy((q, v)) == (q**2 + v**2) / 2  # type: ignore[arg-type]


@claim("L002", evidence=COUNTED, by="methods counted")
def test_lesson_advances_exactly_three_methods() -> None:
    """Every scene is advanced by forward Euler, velocity-first symplectic Euler and classical RK4, and no other."""
    assert LESSON_METHODS == ("forward_euler", "symplectic_euler", "rk4")
    assert {scene.methods for scene in PRESETS.values()} == {LESSON_METHODS}
    assert {scene.selected for scene in PRESETS.values()} <= {*LESSON_METHODS}
    assert set(HAND_WRITTEN) == set(LESSON_METHODS)
    assert len({tuple(M(key).to_list_flat()) for key in LESSON_METHODS}) == 3


@claim("L005", evidence=COUNTED, by="methods counted")
def test_three_methods_share_one_state(publish: Any) -> None:
    """Three methods are applied to the same state: from (1, 0) with h = ½ they reach three different states."""
    reached = {state_after(key, 1, FIRST_H, START) for key in LESSON_METHODS}
    assert len(reached) == 3
    publish("methods", str(len(reached)), Q(len(reached)))
