"""The order seen on the pendulum: right for right methods, lower for wrong ones, and the reference is the pendulum."""

from math import sin

import numpy as np
import pytest
from flint import arb, ctx

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.pendulum_order import _BITS, measured_order, pendulum
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import stepper

ORDERS = {"forward_euler": 1, "symplectic_euler": 1, "velocity_verlet": 2, "heun3": 3, "rk4": 4, "yoshida4": 4}
ORDERS |= {"dormand_prince54": 5, "yoshida6": 6}


def in_floats(step):
    """The same step, but deaf to any other arithmetic."""
    return lambda force, q, v, h: tuple(map(float, step(force, float(q), float(v), float(h))))


@pytest.mark.parametrize(("key", "order"), ORDERS.items())
def test_the_order_of_a_method_is_seen_in_balls_and_in_floats(key, order):
    step = stepper(METHODS[key], float)
    balls = measured_order(opened(step, "force"))
    floats = measured_order(opened(in_floats(step), "force"))
    assert (balls.order, balls.arithmetic) == (order, "Arb balls")
    assert (floats.order, floats.arithmetic) == (order, "binary64")


def test_a_position_that_moves_by_half_is_of_order_0():
    assert measured_order(opened(lambda force, q, v, h: (q + h * v / 2, v + h * force(q)))).order == 0


def test_an_order_that_holds_on_the_oscillator_only_is_not_believed():
    def step(force, q, v, h):  # the solution's series to h^4, were force(force(q)) its derivative times force
        a, b = force(q), force(v)
        q1 = q + h * v + h**2 * a / 2 + h**3 * b / 6 + h**4 * force(a) / 24
        return q1, v + h * a + h**2 * b / 2 + h**3 * force(a) / 6 + h**4 * force(b) / 24

    assert measured_order(opened(step)).order < 4


def test_noise_hides_the_order():
    generator = np.random.default_rng(1)
    step = stepper(METHODS["rk4"], float)

    def noisy(force, q, v, h):
        q1, v1 = step(force, float(q), float(v), float(h))
        return q1 + 1e-3 * generator.standard_normal(), v1

    assert measured_order(opened(noisy)).order is None


def test_a_field_is_stepped_in_arrays_of_balls():
    def midpoint(f, t, y, h):
        return y + h * f(t + h / 2, y + h * f(t, y) / 2)

    found = measured_order(opened(midpoint))
    assert (found.order, found.arithmetic) == (2, "Arb balls")
    assert "order 2 is seen on the pendulum" in found.words


def test_a_built_in_system_is_not_asked():
    with pytest.raises(UnsupportedCall):
        measured_order(opened(lambda q, v, h: (q + h * v, v - h * q)))


def test_the_reference_keeps_the_energy_of_the_pendulum_and_a_finer_cut_agrees():
    with ctx.workprec(_BITS):
        q, v = pendulum(1.0, 0.75, 2.0)
        energy = v * v / 2 - q.cos() - (arb(0.75) ** 2 / 2 - arb(1).cos())
        finer = pendulum(1.0, 0.75, 2.0, pieces=32, terms=60)
    assert abs(energy) < 1e-30
    assert all(abs(x - y) < 1e-30 for x, y in zip((q, v), finer, strict=True))


def test_the_reference_is_what_small_steps_come_to():
    q, v = 1.0, 0.75
    step = stepper(METHODS["rk4"], float)
    for _ in range(1000):
        q, v = step(lambda x: -sin(x), q, v, 0.001)
    exact = [float(x.mid()) for x in pendulum(1.0, 0.75, 1.0)]
    assert [q, v] == pytest.approx(exact, abs=1e-12)
