"""Gymnasium: the physics of its classic control problems, each reduced to q'' = force by its own parameters."""

from __future__ import annotations

from functools import cache
from math import inf

from examples.gallery.entry import targets


def acrobot_rk4(f, y, h):
    """The function `rk4` of the acrobot; it answers with four numbers, the acrobot's, whatever it is given."""
    from gymnasium.envs.classic_control.acrobot import rk4

    return rk4(f, y, [0.0, h])[: len(y)]


@cache
def _cart():
    """A cart of mass 1 whose pole weighs nothing."""
    from gymnasium.envs.classic_control.cartpole import CartPoleEnv

    cart = CartPoleEnv()
    cart.masspole = cart.polemass_length = 0.0
    cart.total_mass = cart.masscart
    cart.x_threshold = inf
    return cart


def _cartpole(integrator):
    def step(force, q, v, h):
        cart = _cart()
        cart.kinematics_integrator, cart.tau, cart.force_mag = integrator, h, force(q)
        cart.state, cart.steps_beyond_terminated = (q, v, 0.0, 0.0), None
        cart.step(1)
        return cart.state[0], cart.state[1]

    return step


@cache
def _rod():
    """A pendulum without gravity, of moment of inertia 1, with a strong motor."""
    from gymnasium.envs.classic_control.pendulum import PendulumEnv

    rod = PendulumEnv(g=0.0)
    rod.m, rod.max_torque = 3.0, inf
    return rod


def pendulum(force, q, v, h):
    """The pendulum, whose speed the problem keeps below 8."""
    import numpy as np

    rod = _rod()
    rod.dt, rod.state, rod.last_u = h, np.array([q, v]), None
    rod.step(np.array([force(q)]))
    return rod.state[0], rod.state[1]


TARGETS = targets(
    __name__,
    "gymnasium",
    field={"acrobot_rk4": ("4-th order Runge-Kutta", 4, "rk4")},
    force={
        "cartpole_euler": (_cartpole("euler"), "Euler", 1, "forward_euler"),
        "cartpole_semi_implicit": (_cartpole("semi-implicit euler"), "semi-implicit Euler", 1, "symplectic_euler"),
        "pendulum": ("(nothing)", None),
    },
)
