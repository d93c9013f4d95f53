"""What a refused step with control inputs, or with a function of another name, is shown is pasted, and works."""

from __future__ import annotations

from functools import reduce

import pytest

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.stepper.styles import keys_of, namespace

CONTROLLED = """
def held(x, u, dt, f):
    a = f(x, u)
    b = f(x + dt / 2 * a, u)
    c = f(x + dt / 2 * b, u)
    return x + dt / 6 * (a + 2 * b + 2 * c + f(x + dt * c, u))

def of_a_model(x, u, dt, model):
    return x + dt * model(x + dt / 2 * model(x, u), u)

def limited(x, u, dt, model):
    u = min(max(u, -1.0), 1.0)
    return x + dt * model(x + dt / 2 * model(x, u), u)

def of_time(fun, t, x, u, dt):
    return x + dt * fun(t + dt / 2, x + dt / 2 * fun(t, x, u), u)

def to_a_horizon(f, x0, u, T, N):
    x, h = x0, T / N
    for _ in range(N):
        x = x + h * f(x + h / 2 * f(x, u), u)
    return x

class Craft:
    def __init__(self): self.state = np.zeros(4)
    def dynamics(self, s, u): return np.array([s[2], s[3], u[0], u[1] - 9.81])
    def step(self, u, dt):
        s = self.state
        self.state = s + dt * self.dynamics(s + dt / 2 * self.dynamics(s, u), u)
        return self.state
"""
NAMED = """
def of_an_operator(u, dt, L):
    v = u + dt * L(u)
    return (u + v + dt * L(v)) / 2

def sampler(q, p, grad_log_prob, eps, L):
    p = p + eps / 2 * grad_log_prob(q)
    for i in range(L):
        q = q + eps * p
        p = p + eps * grad_log_prob(q) * (i < L - 1)
    return q, p + eps / 2 * grad_log_prob(q)
"""
SHOWN = {
    "held": ("rk4", "def wrapped(f, y, h): return held(y, None, h, lambda *x: f(x[0]))"),
    "of_a_model": ("midpoint2", "def wrapped(f, y, h): return of_a_model(y, None, h, lambda *x: f(x[0]))"),
    "limited": ("midpoint2", "def wrapped(f, y, h): return limited(y, 0.0, h, lambda *x: f(x[0]))"),
    "to_a_horizon": ("midpoint2", "def wrapped(f, y, h): return to_a_horizon(lambda *x: f(x[0]), y, None, h, 1)"),
    "Craft": ("midpoint2", "def wrapped(f, y, h): made = Craft(); made.state, made.dynamics = y, "
        "lambda y, *rest: f(y); made.step(None, h); return made.state"),
    "of_an_operator": ("heun2", "def wrapped(f, y, h): return of_an_operator(y, h, f)"),
    "sampler": ("velocity_verlet", "def wrapped(force, q, v, h): return sampler(q, v, force, h, 1)"),
}  # fmt: skip


@pytest.mark.parametrize("name", SHOWN)
@pytest.mark.parametrize("right", [True, False])
def test_inputs_are_left_out_and_functions_of_other_names_are_given(name, right):
    key, line = SHOWN[name]
    wrong = [(" / 2 * ", " / 3 * "), ("dt * L", "dt / 2 * L"), ("(r) * dt", "(r) * dt / 2")]
    code = reduce(lambda text, each: text.replace(*each), [] if right else wrong, CONTROLLED + NAMED)
    names = namespace(code)
    with pytest.raises(BadInput) as caught:
        opened(names[name])
    assert str(caught.value).endswith(f"write: {line}")
    exec(line, names)
    assert (key in keys_of(names["wrapped"])) == right


def test_a_wrapper_that_makes_no_step_is_not_shown_to_be_written_and_why_is_said():
    names = namespace("class Strict:\n    def __init__(self, f): self.f = f\n    def step(self, t, y, h): y.units")
    with pytest.raises(BadInput, match=r"of your own that calls it; tried: .* has no attribute 'units'"):
        opened(names["Strict"])
