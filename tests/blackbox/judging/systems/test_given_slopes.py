"""A system is given by what it takes: the time, the state, its parts by name, parameters; and it has as many slopes."""

from functools import partial

import numpy as np
import pytest

from driftproof import verify


def discharge(v, dt, R, C, wrong=0):
    """Heun's step of a capacitor, or one that divides by R alone."""
    rate = lambda v: -v / R * C if wrong else -v / (R * C)
    return v + dt / 2 * (rate(v) + rate(v + dt * rate(v)))


def falling_to(r, v, mu, dt, wrong=0):
    """The midpoint rule of a body that is attracted."""
    pull = lambda r: -(mu ** (1 + wrong)) * r / np.linalg.norm(r) ** 3
    return r + dt * (v + dt / 2 * pull(r)), v + dt * pull(r + dt / 2 * v)


def pulls(x, masses):
    """The accelerations of bodies that attract each other."""
    d = x[None] - x[:, None]
    return np.einsum("j,ijk->ik", masses, d / ((d * d).sum(axis=2) + 0.25)[:, :, None] ** 1.5)


def sky(bodies, dt):
    """Position-first symplectic Euler of a list of bodies."""
    for each in bodies:
        each.pos = each.pos + dt * each.vel
    found = pulls(np.array([each.pos for each in bodies]), np.array([each.mass for each in bodies]))
    for each, pull in zip(bodies, found, strict=True):
        each.vel = each.vel + dt * pull


def attracted(t, y, mass):
    return np.concatenate([y[9:], pulls(y[:9].reshape(3, 3), mass).ravel()])


def spinning(psi, dt):
    k1 = -1j * np.array([[1, 2], [2, -1]]) @ psi
    return psi + dt * (-1j * np.array([[1, 2], [2, -1]]) @ (psi + dt / 2 * k1))


def kepler(t, y, mu=1.0):
    return [*y[3:], *(-mu * y[:3] / np.linalg.norm(y[:3]) ** 3)]


class Spring:
    def __init__(self, pos=1.0, vel=0.0, stiffness=9.0):
        self.pos, self.vel, self.stiffness = pos, vel, stiffness

    def update(self, dt):
        self.vel -= self.stiffness * self.pos * dt
        self.pos += self.vel * dt


@pytest.mark.parametrize(("step", "method", "system", "said"), [
    (discharge, "heun2", lambda t, y, R, C: -y / (R * C), "is heun2 on the system given with R = 1.25; C = 0.875, to"),
    (partial(discharge, wrong=1), "heun2", lambda y, R, C: -y / (R * C), "is not the one given with R = 1.25; C = 0."),
    (discharge, "heun2", lambda y, t: [-y[0]], "undecided whether it is heun2: with R, C set to 1, where a"),
    (partial(discharge, R=2.0), "heun2", lambda t, y, C, R: -y / (R * C), "with R = 2; C = 1.25, to"),
    (falling_to, "midpoint2", kepler, "is midpoint2 on the system given with mu = 1.25, to"),
    (partial(falling_to, wrong=1), "midpoint2", kepler, "its system is not the one given with mu = 1.25: from"),
    (falling_to, "midpoint2", lambda y, mu: [*y[2:], *(-mu * y[:2] / np.linalg.norm(y[:2]) ** 3)],
     "undecided whether it is midpoint2: of 4 numbers its system is the one given, but not of more, where from"),
    (lambda y, h: y - h * np.roll(y, 1), "forward_euler", lambda y: -y, "is not forward_euler: its system is not"),
    (sky, "symplectic_euler_position_first", attracted, "on the system given with mass = 2, 4, 8, to"),
    (sky, "symplectic_euler_position_first", lambda y: attracted(0.0, y, np.ones(3)),
     "undecided whether it is symplectic_euler_position_first: its system is not the one given with the masses of its"),
    (Spring.update, "symplectic_euler", lambda y: [y[1], -9 * y[0]], "undecided whether it is symplectic_euler: with"),
    (Spring.update, "symplectic_euler", lambda y, stiffness: [y[1], -stiffness * y[0]], "with stiffness = 1.25, to"),
    (spinning, "midpoint2", lambda t, psi: -1j * np.array([[1, 2], [2, -1]]) @ psi, "on the system given, to"),
    (spinning, "midpoint2", lambda y: [y[2] + 2 * y[3], 2 * y[2] - y[3], -y[0] - 2 * y[1], y[1] - 2 * y[0]], "given"),
])  # fmt: skip
def test_parameters_are_the_same_numbers_in_the_system_and_in_the_step(step, method, system, said):
    assert said in verify(step, method, system=system, isolate=False).verdict
