"""What a refused function is shown is pasted, and works; what cannot be known is left in capitals."""

import numpy as np
import pytest

from driftproof.blackbox.stepper.wrappers import wrapper_line
from driftproof.blackbox.verify import verify
from tests.blackbox.stepper.styles import namespace, pasted


def test_a_whole_solver_is_sent_to_its_own_command_and_nothing_is_said_of_the_unknown():
    def solve(f, t_span, y0, rtol, atol):
        return None

    assert wrapper_line(solve) == ": identify_solver(solve), on the command line --solver, for a whole solver"
    assert wrapper_line(max) == ""
    for step in (lambda q, h, mesh: None, lambda p, h, mesh: None, lambda y, h, mesh: None):
        assert "([q, v], h, MESH)" in wrapper_line(step)


RESPA = """
def respa(x, v, fast, slow, mass, dt, n_inner=4):
    before = slow(x)
    v = v + dt / 2 * before / mass
    for _ in range(n_inner):
        v = v + dt / n_inner / 2 * fast(x) / mass
        x = x + dt / n_inner * v
        v = v + dt / n_inner / 2 * fast(x) / mass
    return x, v + dt / 2 * slow(x) / mass
"""


@pytest.mark.parametrize("stale", [False, True])
def test_a_step_of_two_forces_is_given_the_one_that_it_calls_least_and_makes_one_inner_step(stale):
    names = namespace(RESPA.replace("dt / 2 * slow(x)", "dt / 2 * before") if stale else RESPA)
    assert pasted(names, "respa").endswith("return respa(q, v, lambda q, *rest: 0.0 * q, force, 1.0, h, 1)")
    assert verify(names["wrapped"], "velocity_verlet", examples=50, isolate=False).passed is (not stale)


def test_what_a_coupled_step_forgets_shows_in_the_wrapper_that_it_is_shown():
    """At the second stage x is left at its start in f, and v in g: a method on q'' = F(q) alone."""
    names = namespace("""
def midpoint(f, g, t, x, v, h):
    k, m = f(t, x, v), g(t, x, v)
    return x + h * f(t + h / 2, x, v + h / 2 * m), v + h * g(t + h / 2, x + h / 2 * k, v)
""")
    exec(wrapper_line(names["midpoint"]).removeprefix(": "), names)
    assert not verify(names["wrapped"], "midpoint2").passed
    plain = wrapper_line(lambda f, g, x, v, h: (x + h * f(v), v + h * g(x)))
    assert "numpy" not in plain, "f and g do not take both"


def test_a_state_of_more_numbers_than_two_is_handed_on_as_it_is():
    def cart(state, action, tau=0.02):
        _, v, theta, omega = state
        return state + tau * np.array([v, action, omega, theta - action])

    line = wrapper_line(cart)
    assert line == ": def wrapped(y, h): return cart(y, ACTION, h)  # write values for ACTION"
    exec(line[2:].replace("ACTION", "1.0"), names := {"cart": cart})
    assert "is forward_euler on its own" in verify(names["wrapped"], "forward_euler", isolate=False).verdict
