"""The order seen on nonlinear problems: right for right methods, lower for wrong ones, in balls and in floats."""

import math

import numpy as np
import pytest

from driftproof.blackbox.findings import StepRaised
from driftproof.blackbox.judging.measured_order import measured_orders, power_of_errors
from driftproof.blackbox.judging.nonlinear_problems import START
from driftproof.blackbox.judging.specification import Domain, Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import RungeKutta
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import TOLD
from tests.blackbox.transcripts import Asked, shortened

ORDERS = {"forward_euler": 1, "symplectic_euler": 1, "velocity_verlet": 2, "heun3": 3, "rk4": 4, "yoshida4": 4}
ORDERS |= {"dormand_prince54": 5, "yoshida6": 6}


def in_floats(step):
    """The same step, but deaf to any other arithmetic."""
    return lambda force, q, v, h: tuple(map(float, step(force, float(q), float(v), float(h))))


@pytest.mark.parametrize(("key", "order"), ORDERS.items())
def test_the_order_of_a_method_is_seen_in_balls_and_in_floats(key, order):
    step = stepper(METHODS[key], float)
    balls = measured_orders(opened(step, "force"))[0]
    floats = measured_orders(opened(in_floats(step), "force"))[0]
    assert (balls.order, balls.arithmetic) == (order, "Arb balls")
    assert (floats.order, floats.arithmetic) == (order, "binary64")


def test_steps_without_an_answer_and_beyond_the_domain_are_left_out():
    def short(f, t, y, h):
        if h > 0.3:
            raise RuntimeError("no convergence")
        return y + h * f(t, y)

    seen = measured_orders(opened(in_arrays(short), "field"))[0]
    assert (seen.order, len(seen.slopes)) == (1, 6)
    wanted = Specification(METHODS["backward_euler"], domain=Domain(largest_step=2.0**-4))
    assert len(measured_orders(opened(codes.euler, "field"), wanted)[0].slopes) == 4
    with pytest.raises(StepRaised):
        measured_orders(opened(lambda f, t, y, h: codes.euler(f, t, y, h) if t != START else 1 / 0, "field"))


def in_arrays(step):
    """The same step of y' = f(t, y), but deaf to any other arithmetic."""
    return lambda f, t, y, h: np.array(step(f, t, np.asarray(y, dtype=float), float(h)), dtype=float)


def test_noise_hides_the_order():
    generator = np.random.default_rng(1)
    step = stepper(METHODS["rk4"], float)

    def noisy(force, q, v, h):
        q1, v1 = step(force, float(q), float(v), float(h))
        return q1 + 1e-3 * generator.standard_normal(), v1

    assert measured_orders(opened(noisy))[0].order is None


def right_on_the_oscillator(force, q, v, h):
    """The solution's series to h^4, were force(force(q)) its derivative times force."""
    a, b = force(q), force(v)
    q1 = q + h * v + h**2 * a / 2 + h**3 * b / 6 + h**4 * force(a) / 24
    return q1, v + h * a + h**2 * b / 2 + h**3 * force(a) / 6 + h**4 * force(b) / 24


MEASURED = codes.RK4_AT_WRONG_TIMES | {
    "half moved": codes.half_moved, "right on the oscillator": right_on_the_oscillator, "midpoint": codes.midpoint,
    "one number": codes.rk4_of_one_number,
    "one number without t": lambda f, y, h: math.fsum([y, h * f(y)]),
}  # fmt: skip


@pytest.mark.parametrize("name", MEASURED)
def test_the_orders_of_a_code_are_seen_and_wrong_times_and_a_number_left_out_cost_it(name, as_before):
    asked = Asked(MEASURED[name])
    general, *others = measured_orders(opened(asked.code))
    as_before(general.words, *others, asked)
    assert name not in codes.RK4_AT_WRONG_TIMES or "a nonlinear problem of 4 components, with t" in general.words


EXPLICIT = [key for key, method in METHODS.items() if isinstance(method, RungeKutta) and method.explicit]


@pytest.mark.slow(keep=5)
@pytest.mark.parametrize("method", EXPLICIT)
def test_no_method_is_seen_with_a_lower_order_than_its_own(method, as_before):
    field = opened(codes.tableau(*codes.floats(METHODS[method])), "field")
    force = opened(stepper(METHODS[method], float), "force")
    seen = (*measured_orders(field), *measured_orders(force))
    orders = [found.order for found in seen]
    as_before(*shortened([found.words for found in seen], method in TOLD))
    assert len(orders) == 3
    assert min(order for order in (*orders, 99) if order is not None) >= METHODS[method].claimed_order


@pytest.mark.parametrize(
    ("errors", "noise", "seen"),
    [
        ([1.0, 0.5, math.nan, 0.1], 0.0, (None, (1.0,))), ([1.0, 0.5, math.inf, 0.1], 0.0, (None, (1.0,))),
        ([8.0, 4.0, 1.0, 0.25], 0.2, (2, (1.0, 2.0, 2.0))), ([8.0, 4.0, 1.0, 0.25], 0.25, (None, (1.0, 2.0))),
        ([4.0, 1.0], 0.5, (None, (2.0,))),
        ([1.0, 2.0**-2.25, 2.0**-4.5], 0.0, (2, (2.25, 2.25))),
        ([1.0, 2.0**-2.375, 2.0**-4.75], 0.0, (None, (2.375, 2.375))),
    ],
)  # fmt: skip
def test_the_slopes_end_in_the_noise_and_two_that_agree_show_a_power(errors, noise, seen):
    assert power_of_errors(errors, [noise] * len(errors)) == seen
