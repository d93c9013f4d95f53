"""Steppers whose states, arguments or answers are seldom met: some are opened, others are refused with a wrapper."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple, TypedDict

import numpy as np

from tests.blackbox.stepper.euler_steps import Tensor


@dataclass
class Clocked:
    pos: float
    vel: float
    time: float
    mass: float
    note: str = ""
    moved: int = field(default=0, init=False)


class Pair(NamedTuple):
    a: float
    b: float


class Sided(NamedTuple):
    x: float
    v: float
    extra: float = 0.0


class Keyed(TypedDict):
    q: float
    p: float


@dataclass
class Colour:
    red: float
    green: float
    blue: float


def of_clocked(state: Clocked, dt):
    return Clocked(state.pos + dt * state.vel, state.vel - dt * state.pos, state.time + dt, state.mass)


def of_pair(state: Pair, dt):
    return Pair(state.a + dt * state.b, state.b - dt * state.a)


def of_sided(state: Sided, dt):
    return state._replace(x=state.x + dt * state.v, v=state.v - dt * state.x)


def of_colour(state: Colour, dt):
    return Colour(state.red + dt, state.green, state.blue)


def of_nobody(state: Nobody, dt):  # noqa: F821
    return {"x": state["x"] + dt * state["v"], "v": state["v"] - dt * state["x"]}


def of_keys_into_a_record(state, dt: float) -> Sided:
    return Sided(state["x"] + dt * state["v"], state["v"] - dt * state["x"])


of_numbered_keys = lambda state, dt: {0: state[0] + dt * state[1], 1: state[1] - dt * state[0]}
of_private = lambda state, dt: (state._q + dt * state._v, state._v - dt * state._q)


def of_three_keys(state, dt):
    return {"x": state["x"] + dt * state["v"], "v": state["v"] - dt * state["x"], "colour": state["colour"]}


def of_tensors(y, dt):
    assert isinstance(y, Tensor)
    return y + dt * Tensor([y.data[1], -y.data[0]])


def of_scalar_tensors(force, q, v, h):
    assert isinstance(q, Tensor)
    assert q.data.shape == ()
    return q + h * v, v + h * force(q)


def of_vectors(force, q, v, h):
    assert np.shape(q) == (3,)
    return q + h * v, v + h * force(q)


def of_one_number(f, t, y, k1, h):
    after = math.fsum([y, h * k1])
    return after, f(t + h, after)


def of_one_number_stale(f, t, y, k1, h):
    if not isinstance(y, float):
        raise TypeError("of one number")
    return math.fsum([y, h * k1]), k1


handing_on_nearly = lambda f, t, y, k1, h: (y + h * k1, f(t + h, y + h * k1) * (1 + 2.0**-9))
handing_on_another = lambda f, t, y, k1, h: (y + h * k1, f(t + h, y + h * k1) * (1 + 2.0**-7))
handing_on_too_few = lambda f, t, y, k1, h: (y + h * k1, f(t + h, y + h * k1)[:1])
handing_on_nothing = lambda f, t, y, k1, h: (y + h * f(t, y),)
to_rest = lambda q, v, h: (0.0 * q, 0.0 * v)
increment_of_a_state = lambda y, h: h * np.array([y[1], -y[0]])
increment_of_a_field = lambda f, t, y, h: h * f(t, y)


class OfRates:
    """Its state is its own: nothing says where it comes from."""

    def __init__(self, f, dt):
        self.f, self.dt, self.y = f, dt, [0.0, 0.0]

    def step(self):
        self.y = self.f(self.y)


class Refusing(OfRates):
    def __init__(self, f, y0, dt):
        raise ValueError("no licence")


class WithArguments:
    def step(self, a, b, c):
        return None


leapfrog_of = lambda grad_q, grad_p, x, p, dt, extra: (x, p)
of_gradients = lambda dHdq, dHdp, q, p, t, h, omega_: (q, p)


maker = lambda f, h: lambda y: y + h * f(0.0, y)
maker_of_forces = lambda acceleration: lambda x, v, dt, unknown: (x, v)
maker_of_kicks = lambda force, h: lambda q, v: (q, v + h * force(q))
maker_of_steps = lambda dt: lambda q, v, w: (q + dt * v, v - dt * q)
maker_of_nothing = lambda f: 7


def maker_that_fails(rhs, dt):
    raise ValueError("no")


solver_with_a_step = lambda f, t_span, y0, dt, mode, other: None
solver_of_one_state = lambda f, y0, t0, t1, n: y0


def of_keyed_without_keys(state: Keyed, dt):
    return state["q"] + dt * state["p"], state["p"] - dt * state["q"]


state_twice = lambda state, y, dt: y
unknown = lambda alpha, beta, gamma: alpha


ODD = {name: step for name, step in vars().items() if getattr(step, "__module__", "") == __name__}
for _name in ("Clocked", "Pair", "Sided", "Keyed", "Colour"):
    del ODD[_name]
for _name, _step in ODD.items():
    _step.__qualname__ = _name
ODD |= {
    "a method of other arguments": WithArguments().step,
    "no name": type("Odd", (), {"__call__": lambda self, alpha, beta: None})(),
    "None": lambda q, v, h: None,
    "strings": lambda q, v, h: ("a", "b"),
    "three of a field": lambda f, t, y, h: [1.0, 2.0, 3.0],
    "another type": lambda f, t, y, h: object,
}
