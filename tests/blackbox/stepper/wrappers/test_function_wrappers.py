"""What a refused function is shown is pasted, and works: runs, steps from earlier states, steps of other arguments."""

import numpy as np
import pytest

from driftproof.blackbox.stepper.wrappers.function_wrappers import class_run_wrapper, run_of_class
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from driftproof.blackbox.verify import verify
from tests.blackbox.stepper.styles import is_read_as, namespace, pasted

PLAIN = """
def stormer(x, x_prev, acc, dt):
    return 2 * x - x_prev + dt**2 * acc(x), x

def stormer_alone(acc, dt, x_prev, x):
    return 2 * x - x_prev + dt**2 * acc(x)

def bashforth(f, t, y, y_prev, h):
    return y + h / 2 * (3 * f(t, y) - f(t - h, y_prev))

def from_zero(f, U_0, dt, T):
    u = np.zeros((round(T / dt) + 1, len(U_0)))
    u[0] = U_0
    for n in range(round(T / dt)):
        u[n + 1] = u[n] + dt * f(u[n], n * dt)
    return u, np.linspace(0, T, len(u))

def by_name(f, y0, t_end, dt):
    found = {"t": [0.0], "y": [np.array(y0, float)]}
    while found["t"][-1] < t_end - 1e-12:
        found["y"].append(found["y"][-1] + dt * f(found["t"][-1], found["y"][-1]))
        found["t"].append(found["t"][-1] + dt)
    return found

def in_pairs(f, x0, y0, x_end, n):
    h, found = (x_end - x0) / n, [(x0, list(y0))]
    for i in range(n):
        y0 = np.array(y0) + h * f(x0 + i * h, y0)
        found.append((x0 + (i + 1) * h, list(y0)))
    return found

def over_a_grid(fun, x0, iv, args=()):
    x = [np.asarray(x0)]
    for t, dt in zip(iv, np.diff(iv)):
        x.append(x[-1] + dt * fun(x[-1], t, *args))
    return np.asarray(x)

def over_times(acc, x0, v0, t):
    x, v = np.full(len(t), x0), np.full(len(t), v0)
    for i, h in enumerate(np.diff(t)):
        v[i + 1] = v[i] + h * acc(x[i])
        x[i + 1] = x[i] + h * v[i + 1]
    return x, v

def to_an_end(dydx, x, y, x_end, h):
    while x < x_end - 1e-12:
        x, y = x + h, y + h * dydx(x, y)
    return y

def pendulum(theta0, omega0, dt, N):
    theta, omega = np.full(N + 1, theta0), np.full(N + 1, omega0)
    for i in range(N):
        omega[i + 1] = omega[i] - theta[i] * dt
        theta[i + 1] = theta[i] + omega[i + 1] * dt
    return theta, omega

def bashforth_of_ends(f, a, b, y0, n):
    h, t, y = (b - a) / n, np.linspace(a, b, n + 1), np.zeros((n + 1, np.size(y0)))
    y[0], slopes = y0, []
    for i in range(n):
        slopes.append(f(t[i], y[i]))
        ahead = slopes[-1] if i else f(t[i] + h / 2, y[i] + h / 2 * slopes[-1])
        y[i + 1] = y[i] + (h / 2 * (3 * ahead - slopes[-2]) if i else h * ahead)
    return t, y

def bashforth_from_zero(f, y0, t_end, n):
    return bashforth_of_ends(f, 0.0, t_end, y0, n)[1]

def after_two_steps(f, t0, tf, ya, N):
    h, t, y = (tf - t0) / N, np.linspace(t0, tf, N + 1), np.zeros((N + 1, np.size(ya)))
    y[0] = ya
    for i in range(2):
        y[i + 1] = y[i] + h * f(t[i] + h / 2, y[i] + h / 2 * f(t[i], y[i]))
    for i in range(2, N):
        a, b, c = (f(t[j], y[j]) for j in (i, i - 1, i - 2))
        y[i + 1] = y[i] + h / 12 * (23 * a - 16 * b + 5 * c)
    return t, y

def march(f, t0, y0, t_end, h):
    yield t0, y0
    while t0 < t_end - 1e-12:
        t0, y0 = t0 + h, y0 + h * f(t0, y0)
        yield t0, y0

def with_parameters(params, y, vector_field, t, g=0.0, h=0.1):
    return y + h * vector_field(t, y, params)
"""
RUN = "ys = [q - h * v + h**2 / 2 * force(q), q]; [ys.append({}) for i in range(n)]; return ys[1:], "
RUN += "[v, *((b - a) / h for a, b in zip(ys[1:], ys[2:]))]"
FORCED, EULER, FORWARD = "force, q, v, h", "symplectic_euler", "forward_euler"
PASTED = {
    "stormer": ("force, q, v, h, n", RUN.format("stormer(ys[-1], ys[-2], force, h)[0]"), "stormer2"),
    "stormer_alone": ("force, q, v, h, n", RUN.format("stormer_alone(force, h, ys[-2], ys[-1])"), "stormer2"),
    "from_zero": ("f, t, y, h", "return from_zero(lambda y, s: f(t + s, y), y, h, h)[0][-1]", FORWARD),
    "by_name": ("f, t, y, h", "return by_name(lambda s, y: f(t + s, y), y, h, h)['y'][-1]", FORWARD),
    "in_pairs": ("f, t, y, h", "return in_pairs(f, t, y, t + h, 1)[-1][1]", FORWARD),
    "over_a_grid": ("f, t, y, h", "return over_a_grid(f, y, [t, t + h])[-1]", FORWARD),
    "over_times": (FORCED, "run = over_times(force, q, v, [0.0, h]); return run[0][-1], run[1][-1]", EULER),
    "to_an_end": ("f, t, y, h", "return to_an_end(f, t, y, t + h, h)", FORWARD),
    "pendulum": ("q, v, h", "run = pendulum(q, v, h, 1); return run[0][-1], run[1][-1]", "symplectic_euler"),
    "bashforth_of_ends": ("f, t, y, h, n", "return bashforth_of_ends(f, t, t + n * h, y, n)[1]", "adams_bashforth2"),
    "bashforth_from_zero": (
        *("f, t, y, h, n", "return bashforth_from_zero(lambda s, y: f(t + s, y), y, n * h, n)", "adams_bashforth2"),
    ),
    "after_two_steps": ("f, t, y, h, n", "return after_two_steps(f, t, t + n * h, y, n)[1]", "adams_bashforth3"),
    "march": ("f, t, y, h", "return [*march(f, t, y, t + h, h)][-1][1]", FORWARD),
    "bashforth": (
        *(
            "f, t, y, h, n",
            "ys = [y, y + h * f(t + h / 2, y + h / 2 * f(t, y))]; [ys.append(bashforth(f, t + i * h, "
            "ys[-1], ys[-2], h)) for i in range(1, n)]; return ys  # a run of n steps, whose first is one of midpoint2",
        ),
        "adams_bashforth2",
    ),
    "with_parameters": ("f, t, y, h", "return with_parameters(params=(), y=y, vector_field=f, t=t, h=h)", FORWARD),
}


@pytest.mark.slow(keep=10)
@pytest.mark.parametrize("name", PASTED)
def test_a_run_or_a_step_with_other_arguments_is_refused_with_a_wrapper_that_works(name):
    names = namespace(PLAIN)
    head, body, key = PASTED[name]
    assert pasted(names, name).endswith(f"write: def wrapped({head}): {body}")
    assert is_read_as(names["wrapped"], key)


def test_a_run_is_read_where_it_begins_and_nothing_is_said_of_one_that_does_not():
    """Or of a run whose states are not to be told from its times."""
    assert "[-1]" not in wrapper_line(lambda f, y0, t0, t_end, dt: np.array([2.0 * y0, y0]))
    assert "[-1]" not in wrapper_line(lambda x0, v0, dt, T: (np.zeros(2), np.zeros(2)))
    assert "[-1]" not in wrapper_line(lambda f, y0, t0, dt: np.array([y0, y0]))


def test_of_a_step_whose_force_is_built_in_and_that_takes_the_state_before_the_force_is_asked_for():
    line = wrapper_line(lambda x, x_old, dt: x_old)
    assert line.startswith(": def step(force, x, x_old, dt): ...  # a method of two steps is read if")
    assert "two steps" not in wrapper_line(lambda f, t, y, h, mesh: y)


def given_forces(x, v, f, m, box, dt):
    v = v + dt * f / m
    return (x + dt * v) % box, v, f


def asking_forces(x, v, f, m, box, dt):
    v = v + dt * f(x) / m
    return (x + dt * v) % box, v


def test_forces_that_a_step_is_given_as_numbers_stay_an_argument_of_its_wrapper():
    line = wrapper_line(given_forces)
    assert line.startswith(
        ": def wrapped(x, v, f, dt): return given_forces(x, v, f, M, BOX, dt)  # write values for M, BOX"
    )
    line = wrapper_line(asking_forces)
    assert line.startswith(": def wrapped(force, q, v, h): return asking_forces(q, v, force, 1.0, BOX, h)")


def test_a_whole_solver_is_sent_to_its_own_command_and_nothing_is_said_of_the_unknown():
    def solve(f, t_span, y0, rtol, atol):
        return None

    asserted = "in a test assert_verified_solver(solve, method)"
    assert (
        wrapper_line(solve) == f": identify_solver(solve), {asserted}, on the command line --solver, for a whole solver"
    )
    assert wrapper_line(max) == ""
    for step in (lambda q, h, mesh: None, lambda p, h, mesh: None, lambda y, h, mesh: None):
        assert "([q, v], h, MESH)" in wrapper_line(step)


def test_a_state_of_more_numbers_than_two_is_handed_on_as_it_is():
    def cart(state, action, tau=0.02):
        _, v, theta, omega = state
        return state + tau * np.array([v, action, omega, theta - action])

    line = wrapper_line(cart)
    assert line == ": def wrapped(y, h): return cart(y, ACTION, h)  # write values for ACTION"
    exec(line[2:].replace("ACTION", "1.0"), names := {"cart": cart})
    assert "is forward_euler on its own" in verify(names["wrapped"], "forward_euler", isolate=False).verdict


RUNS = """
class Adaptive:
    def __init__(self, f, t0, y0, tf, rtol=1e-6):
        self.f, self.t, self.y, self.tf = f, t0, y0, tf
    def step(self):
        pass
    def solve(self):
        return [self.t, self.tf], [self.y, self.y]

class Ball:
    def __init__(self, x):
        self.x, self.vx = x, 0.0
    def update(self, dt):
        self.x += self.vx * dt
"""


def test_a_solver_with_tolerances_is_run_whole_and_an_object_without_a_run_is_not():
    names = namespace(RUNS)
    asserted = "in a test assert_verified_solver(Adaptive, method)"
    whole = f"identify_solver(Adaptive), {asserted}, on the command line --solver, for a whole solver"
    assert class_run_wrapper(names["Adaptive"]) == whole
    assert run_of_class(names["Adaptive"])(abs, 0.0, 1.0, tf=2.0, rtol=1e-3) == ([0.0, 2.0], [1.0, 1.0])
    assert run_of_class(names["Ball"]) is None
    assert class_run_wrapper(names["Ball"]) == ""
