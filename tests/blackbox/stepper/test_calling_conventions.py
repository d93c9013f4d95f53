"""The names of parameters in the wild tell the calling convention; what fits none is refused in one line."""

import functools
import inspect
from types import SimpleNamespace

import pytest

from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    MAP,
    SIGNATURES,
    STANDARD_ORDER,
    CallingConvention,
    conventions_of,
)
from driftproof.blackbox.stepper.opening import opened
from tests.looping import some

WILD = {
    (MAP, "position velocity step"): [
        *("q, v, h", "q, v, h, k=4.0", "x, v, dt", "q, p, h", "pos, vel, dt", "theta, omega, dt", "X, V, dT"),
        *("_q, _v, _h", "y, vy, eps"),
    ],
    (MAP, "velocity position step"): ["v, x, dt"], (MAP, "step position velocity"): ["dt, x, v"],
    (MAP, "time position velocity step"): ["t, x, v, dt"], (MAP, "state step"): ["state, dt", "y, h", "p, dt"],
    (MAP, "state time step"): ["y, t, h"],
    (FORCE, "function position velocity step"): ["force, q, v, h", "get_acceleration, r, v, timestep"],
    (FORCE, "position velocity step function"): ["x, v, dt, accel"],
    (FORCE, "position velocity function step"): ["x, v, a, dt"],
    (FORCE, "function time position velocity step"): ["acc, t, x, v, dt"],
    (FORCE, "position velocity carried step function"): ["q, p, f0, h, force"],
    (FIELD, "function time state step"): [
        "f, t, y, h", "fun, t0, y0, step_size", "dydt, tn, yn, h", "f, t, y, h, *, atol=1e-8, **options",
        *("f, x, y, h", "f, xi, yi, h", "f, t_n, y_n, h", "deriv, current_time, current_state, delta_t"),
    ],
    (FIELD, "function state time step"): ["f, y, t, dt", "deriv, y, t, dt, args=()", "f, q, t, h"],
    (FIELD, "time state step function"): ["t, y, h, f"], (FIELD, "function state step"): ["rhs, u, dt"],
}  # fmt: skip


def convention_of(step, kind=None):
    """The most usual one."""
    return conventions_of(step, kind)[0]


def parameters_of(step):
    return str(inspect.signature(step))


def with_parameters(parameters):
    return eval(f"lambda {parameters}: None")


@pytest.mark.parametrize(("kind", "order"), WILD)
def test_names_in_the_wild_tell_the_calling_convention(kind, order):
    for parameters in some(WILD[kind, order]):
        assert convention_of(with_parameters(parameters)) == CallingConvention(kind, tuple(order.split()))


@pytest.mark.parametrize("parameters", [
    *("", "q", "q, v", "q, v, h, k, mode", "x, y, dt", "model, state, dt", "f, y, t_span"),
    *("q, v, h, t, t0", "a, b, c", "*args", "state, action", "f, g, force, q, v, h", "theta, omega, dt, l"),
])  # fmt: skip
def test_other_names_are_refused_in_one_line_that_shows_the_known_ones(parameters):
    step = with_parameters(parameters)
    with pytest.raises(ValueError, match="is not one of these") as caught:
        convention_of(step)
    message = str(caught.value)
    assert "\n" not in message
    assert all(words in message for words in SIGNATURES.values())
    assert "<lambda>(" in message


@pytest.mark.parametrize(("kind", "order"), STANDARD_ORDER.items())
def test_a_convention_that_is_named_takes_arguments_in_its_standard_order(kind, order):
    parameters = ", ".join(f"argument{i}" for i in range(len(order)))
    assert convention_of(with_parameters(parameters), kind) == CallingConvention(kind, order)


def test_a_convention_that_is_named_is_taken_of_two_that_fit():
    assert convention_of(with_parameters("y, v, h"), MAP).order == ("position", "velocity", "step")
    assert convention_of(with_parameters("f, y, h"), FIELD).order == ("function", "state", "step")
    with pytest.raises(ValueError, match="is not one of these"):
        convention_of(with_parameters("q, v, h"), FIELD)


def test_an_unknown_convention_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="unknown calling convention 'window'; choose from map, force, field"):
        convention_of(with_parameters("q, v, h"), "window")


@pytest.mark.parametrize("step", [
    lambda q, v, h, k, m: (q + h * v, v - h * q * k / m),
    lambda k, m, x, v, dt: (x + dt * v, v - dt * x * k / m),
    lambda m, q, stiffness, v, h: (q + h * v, v - h * q * stiffness / m),
    lambda q, v, omega, h: (q + h * v, v - h * q * omega**2),
    lambda state, dt, w0: (state[0] + dt * state[1], state[1] - dt * state[0] * w0),
], ids=parameters_of)  # fmt: skip
def test_parameters_of_an_oscillator_are_set_to_1_wherever_they_stand(step):
    assert set(convention_of(step).extra.values()) == {1.0}
    assert opened(step).step(1.0, 0.75, 0.25) == (1.1875, 0.5)


@pytest.mark.parametrize("step", [
    lambda q, v, *, h: (q + h * v, v - h * q),
    lambda q, *, v, dt: (q + dt * v, v - dt * q),
    lambda *, dt, v, x: (x + dt * v, v - dt * x),
    lambda k, q, v, *, h: (q + h * v, v - h * q * k),
    lambda y, *, h: (y[0] + h * y[1], y[1] - h * y[0]),
], ids=parameters_of)  # fmt: skip
def test_parameters_by_name_only_are_passed_by_name(step):
    assert opened(step).step(1.0, 0.75, 0.25) == (1.1875, 0.5)


class Oscillator:
    def step(self, q, v, h):
        return q + h * v, v - h * q

    def __call__(self, state, dt):
        return state

    @staticmethod
    def advance(x, v, dt):
        return x + dt * v, v - dt * x


def general(f, t, y, h):
    return y + h * f(t, y)


def test_methods_objects_and_bound_functions_are_steppers():
    assert convention_of(Oscillator().step).order == ("position", "velocity", "step")
    assert convention_of(Oscillator()).order == ("state", "step")
    assert convention_of(Oscillator.advance).kind == MAP
    bound = functools.partial(general, lambda t, y: -y)
    assert convention_of(bound) == CallingConvention(MAP, ("time", "state", "step"))
    assert convention_of(SimpleNamespace(py_func=general)).kind == FIELD  # as numba compiles
    assert convention_of(functools.wraps(general)(lambda *arguments: general(*arguments))).kind == FIELD


def test_a_step_size_with_a_default_is_given_and_by_name_where_it_does_not_come_next():
    for step in (functools.partial(Oscillator().step, h=0.1), lambda q, v, damping=0.0, h=0.1: None):
        found = convention_of(step)
        assert (found.order, found.names) == (STANDARD_ORDER[MAP], ("q", "v", "h"))
    assert convention_of(lambda q, v, dt=0.1: None).names == ()
    timed = convention_of(lambda f, y, *, t0=0.0, h, further=None: None)
    assert timed.names == ("f", "y", "h", "t0")
    assert convention_of(lambda f, t, y, h, *args: None).order == STANDARD_ORDER[FIELD]
    with pytest.raises(ValueError, match=r"\(q, v\) is not one of these"):
        convention_of(lambda q, v, damping=0.0: None)


@pytest.mark.parametrize("no_signature", [dict, max, 42])
def test_without_a_signature_the_convention_has_to_be_named(no_signature):
    with pytest.raises((TypeError, ValueError)):
        inspect.signature(no_signature).bind_partial(1, 2, 3, 4)
    with pytest.raises(ValueError, match=r"\(\?\) is not one of these"):
        convention_of(no_signature)
    assert convention_of(no_signature, FIELD) == CallingConvention(FIELD, STANDARD_ORDER[FIELD])
