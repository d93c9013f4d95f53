"""Steps with another mass, stiffness or frequency are the method's or not, and what stays at its default is named."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.other_parameters import other_parameters
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS

EULER, VERLET = METHODS["symplectic_euler"], METHODS["velocity_verlet"]


@dataclass(frozen=True)
class Particle:
    x: float
    v: float
    m: float = 1.0


def forced(force_of):
    def step(force, x, v, dt, mass=1.0):
        v = v + dt / 2 * force_of(force(x), mass)
        x = x + dt * v
        return x, v + dt / 2 * force_of(force(x), mass)

    return step


def of_mass(pull):
    def step(x, v, dt, m):
        v = v - dt * pull(x, m)
        return x + dt * v, v

    return step


def of_both(pull):
    def step(x, v, dt, k, m):
        v = v - dt * pull(k, m) * x
        return x + dt * v, v

    return step


def of_frequency(power):
    def step(x, v, dt, omega=1.0):
        v = v - dt * omega**power * x
        return x + dt * v, v

    return step


def in_turns(x, v, dt, m=1):
    for _ in range(m):
        v = v - dt / m * x
        x = x + dt / m * v
    return x, v


def of_momentum(x, p, dt, m):
    p = p - dt * x
    return x + dt * p / m, p


def of_momentum_by_default(x, p, dt, m=1.0, k=1.0):
    p = p - dt * k * x
    return x + dt * p / m, p


def forced_momentum(force, q, p, dt, m=1.0):
    p = p + dt * force(q)
    return q + dt * p / m, p


def of_array(state, dt, m=1.0, k=1.0):
    return of_momentum_by_default(*state, dt, m, k)


def of_momenta_in_a_record(velocity):
    def step(state, dt):
        p = state[velocity] - dt * state["k"] * state["q"]
        return {**state, "q": state["q"] + dt * p / state["m"], velocity: p}

    return step


def of_record(ended):
    def step(p: Particle, dt: float) -> Particle:
        v = p.v - dt * p.x / p.m
        return ended(p, p.x + dt * v, v)

    return step


WRONG = [
    (forced(lambda force, m: force * m), VERLET, "with mass = 2 its step of q'' = -q is wrong: from (1.0, 0.0) with"),
    (of_frequency(1), EULER, "with omega = 2 its step of q'' = -4 q is wrong"),
    (of_mass(lambda x, m: x * m), EULER, "with m = 4 its step of q'' = -0.25 q is wrong"),
    (of_mass(lambda x, m: x // m if type(m) is int else x / m), EULER, "with m = 4 its step of q'' = -0.25 q is wrong"),
    (of_both(lambda k, m: k * m), EULER, "with m = 2, k = 8 its step of q'' = -4 q is wrong"),
    (of_both(lambda k, m: k // m), EULER, "with m = 8, k = 2 its step of q'' = -0.25 q is wrong"),
    (of_momenta_in_a_record("v"), EULER, "with m = 2, k = 8 its step of q'' = -4 q is wrong"),
    (of_record(lambda p, x, v: Particle(x, v)), EULER, "a record whose m is 4 comes back with 1.0"),
]
# A mass may be a label, and one of `m` times: then the force is an acceleration, or m counts something.
RIGHT = [
    (forced(lambda force, m: force / m), VERLET, "6 steps with mass = 2 within the bound"),
    (forced(lambda force, m: force), VERLET, "6 steps with mass = 2 within the bound"),
    (of_frequency(2), EULER, "6 steps with omega = 2 within the bound"),
    (of_mass(lambda x, m: x), EULER, "6 steps with m = 4 within the bound; 6 steps with m = 4 within the bound"),
    (of_mass(lambda x, m: x / m), EULER, "6 steps with m = 4 within the bound; 6 steps with m = 4 within the bound"),
    (of_both(lambda k, m: k / m), EULER, "6 steps with m = 2, k = 8 within the bound; 6 steps with m = 8, k = 2 wi"),
    (of_momentum, EULER, "6 steps with m = 4 within the bound; 6 steps with m = 4 within the bound"),
    (of_momentum_by_default, EULER, "6 steps with m = 2, k = 8 within the bound; 6 steps with m = 8, k = 2 within"),
    (forced_momentum, EULER, "6 steps with m = 2 within the bound"),
    (of_array, EULER, "6 steps with m = 2, k = 8 within the bound; 6 steps with m = 8, k = 2 within the bound"),
    (of_momenta_in_a_record("p"), EULER, "6 steps with m = 2, k = 8 within the bound; 6 steps with m = 8, k = 2"),
    (of_record(lambda p, x, v: replace(p, x=x, v=v)), EULER, "6 steps with m = 4 within the bound; 6 steps with m = 4"),
]


@pytest.mark.parametrize(("step", "method", "cause"), WRONG, ids=range(len(WRONG)))
def test_what_is_wrong_with_other_parameters_alone_is_caught(step, method, cause):
    passed, words, _ = other_parameters(opened(step), Specification(method))
    assert passed is False
    assert cause in words


@pytest.mark.parametrize(("step", "method", "said"), RIGHT, ids=range(len(RIGHT)))
def test_what_is_right_with_them_passes(step, method, said):
    passed, words, _ = other_parameters(opened(step), Specification(method))
    assert passed is True, words
    assert words.startswith(said)


def test_what_is_left_at_its_default_is_named():
    def euler_of(f, t, y, h, args=(), damping=np.zeros(2)):  # noqa: B008
        return y + h * (f(t, y, *args) - damping[0] * y)

    report = verify(euler_of, "forward_euler", examples=60, isolate=False)
    assert report.passed
    assert report.section("Parameters: not tested").lines == ("args, damping left at the default",)
    assert other_parameters(opened(in_turns), Specification(EULER))[:2] == (None, "m left at the default")
    assert "; c left at the default" in other_parameters(opened(lambda x, v, h, k, c=0: (x + h * v, v - h * k * x)),
                                                         Specification(METHODS["forward_euler"]))[1]  # fmt: skip


def test_what_has_no_further_parameters_is_not_asked():
    with pytest.raises(UnsupportedCall, match="no frequency or stiffness"):
        other_parameters(opened(lambda x, v, h: (x + h * v, v - h * x)), Specification(METHODS["forward_euler"]))
