"""Steps with names of their own are opened by what they call and return; a wrong one is a wrong step."""

import re

import numpy as np
import pytest

from driftproof import Allowance, verify
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.wrappers.named_forms import named_forms


def of_two_gradients(q, p, dt, dVdq, dTdp, last=-1):
    p = p - dt / 2 * dVdq(q)
    q = q + dt * dTdp(p)
    return q, p + last * dt / 2 * dVdq(q)


def of_a_wrong_sign(q, p, dt, dVdq, dTdp):
    return of_two_gradients(q, p, dt, dVdq, dTdp, last=1)


def as_in_fortran(neq, x, ystart, step, derivs, yout, last=1):
    d1 = derivs(x, ystart)
    d2 = derivs(x + step / 2, ystart + step / 2 * d1)
    d3 = derivs(x + step / 2, ystart + step / 2 * d2)
    d4 = derivs(x + last * step, ystart + step * d3)
    for i in range(neq):
        yout[i] = ystart[i] + step / 6 * (d1[i] + 2 * d2[i] + 2 * d3[i] + d4[i])


def at_a_wrong_time(neq, x, ystart, step, derivs, yout):
    as_in_fortran(neq, x, ystart, step, derivs, yout, last=1 / 2)


def of_two_velocities(p, v, accel, dt):
    v = v + dt * accel(p)
    return p + dt * v, v


def of_the_old_velocity(p, v, accel, dt):
    return p + dt * v, v + dt * accel(p)


def of_half_steps(x, v_half, forces, inv_mass, dt):
    v_half = v_half + dt * forces(x) * inv_mass
    return x + dt * v_half, v_half


def mass_forgotten(x, v_half, forces, inv_mass, dt):
    v_half = v_half + dt * forces(x)
    return x + dt * v_half, v_half


def of_no_usual_name(pop, t, dt, growth, late=1.0):
    k1 = growth(pop, t)
    return pop + dt / 2 * (k1 + growth(pop + dt * k1, t + late * dt))


def by_a_clock(slope, clock, u, delta):
    return u + delta * slope(clock + delta / 2, u + delta / 2 * slope(clock, u))


def of_x_by_dx(fun, y, x, dx):
    return y + dx * fun(x, y)


def of_a_slope_in_hand(y, dydx, x, h, derivs, half=0.5):
    return y + h * derivs(x + h / 2, y + half * h * dydx)


def in_gravity(r, v, dt, gravity):
    r = r + v * dt / 2
    v = v + gravity(r) * dt
    return r + v * dt / 2, v


def of_the_old_time(pop, t, dt, growth):
    return of_no_usual_name(pop, t, dt, growth, late=0.0)


def of_a_whole_step(y, dydx, x, h, derivs):
    return of_a_slope_in_hand(y, dydx, x, h, derivs, half=1.0)


HELD = [
    (of_no_usual_name, "heun2", ""), (of_the_old_time, "heun2", "c[1]: 0 instead of 1"), (by_a_clock, "midpoint2", ""),
    (of_x_by_dx, "forward_euler", ""), (in_gravity, "position_verlet", ""), (of_a_slope_in_hand, "midpoint2", ""),
    (of_a_whole_step, "midpoint2", "a[1][0]: 1 instead of 1/2"),
    (of_two_gradients, "velocity_verlet", ""), (of_a_wrong_sign, "velocity_verlet", "kick 2: -1/2 instead of 1/2"),
    (as_in_fortran, "rk4", ""), (at_a_wrong_time, "rk4", "c[3]: 1/2 instead of 1"),
    (of_two_velocities, "symplectic_euler", ""), (of_the_old_velocity, "symplectic_euler", "it is forward_euler"),
    (of_half_steps, "symplectic_euler", ""), (mass_forgotten, "symplectic_euler", "kick 0: 2 instead of 1"),
]  # fmt: skip


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("step", "key", "wrong"), HELD, ids=[step.__name__ for step, _, _ in HELD])
def test_names_of_its_own_do_not_matter_and_a_wrong_step_is_no_matter_of_its_names(step, key, wrong):
    found = verify(step, key, examples=30, isolate=False)
    assert found.passed is not bool(wrong), found.text()
    assert wrong in found.verdict


def newton(rhs, jac, t, c, dt, rounds=30):
    found = np.array(c)
    for _ in range(rounds):
        off = found - c - dt * np.asarray(rhs(t + dt, found))
        found = found - np.linalg.solve(np.eye(len(c)) - dt * np.asarray(jac(t + dt, found)), off)
    return found


def one_round(rhs, jac, t, c, dt):
    return newton(rhs, jac, t, c, dt, rounds=1)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("step", [newton, one_round])
def test_beside_a_jacobian_the_state_may_have_any_name(step):
    exact = Allowance(solver_tolerance=1e-10)
    found = verify(step, "backward_euler", examples=30, allowance=exact, isolate=False)
    assert found.passed is (step is newton), found.text()


def damped(force, x, v, c, dt):
    v = v + dt * (force(x) - c * v)
    return x + dt * v, v


def test_what_changes_an_answer_without_a_clock_is_not_taken_for_the_time():
    wrapper = "write: def wrapped(force, q, v, h): return damped(force, q, v, C, h)  # write values for C"
    with pytest.raises(BadInput, match=re.escape(wrapper)):
        opened(damped)


def test_what_is_no_state_is_not_taken_for_one():
    assert [*named_forms(lambda f, y_old, y, h: y)] == [*named_forms(lambda f, t, c: c)] == [*named_forms(dict)] == []
    with pytest.raises(BadInput, match="does not fit any calling convention"):
        opened(lambda rhs, t, c, dt: 0.5 * c)  # a short step moves it
    with pytest.raises(BadInput, match="does not fit any calling convention"):
        opened(lambda u, N, L, dt: u + dt * (N(u) + L(u)))  # neither part is solved for
