"""Classes with a method for a run, or whose force can be replaced: what they are shown is pasted, and works."""

import pytest

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.class_wrappers import attribute_of, class_run_wrapper, put_wrapper, run_of_class
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.stepper.styles import is_read_as, namespace, pasted

CLASSES = """
class Solver:
    def __init__(self, f):
        self.f = f
    def set_initial_condition(self, u0):
        self.u0 = np.array(u0, float)
    def solve(self, t_span, N):
        t, u = np.linspace(*t_span, N + 1), [self.u0]
        for n in range(N):
            u.append(u[n] + (t[1] - t[0]) * np.asarray(self.f(t[n], u[n])))
        return t, np.array(u)

class Quiet:
    def __init__(self, f, y0):
        self.f, self.y0 = f, np.array(y0, float)
    def run(self, t0, t1, n):
        self.t, self.y = Solver.solve(self.of(), (t0, t1), n)
    def of(self):
        made = Solver(self.f)
        made.set_initial_condition(self.y0)
        return made

class Bashforth(Solver):
    def solve(self, span, n):
        h, u, slopes = (span[1] - span[0]) / n, [self.u0], []
        for i in range(n):
            slopes.append(np.asarray(self.f(span[0] + i * h, u[i])))
            ahead = self.f(span[0] + h / 2, u[i] + h / 2 * slopes[0])
            u.append(u[i] + (h / 2 * (3 * slopes[i] - slopes[i - 1]) if i else h * np.asarray(ahead)))
        return np.linspace(*span, n + 1), np.array(u)

class BashforthOverTimes:
    def __init__(self, f): self.f = f
    def set_initial_condition(self, u0): self.u0 = np.asarray(u0, float)
    def solve(self, times):
        u = [self.u0]
        for k, t in enumerate(times[:-1]):
            h = times[k + 1] - t
            first = self.f(t, u[k])
            middle = self.f(t + h / 2, u[k] + h / 2 * first)
            u.append(u[k] + h * (1.5 * first - self.f(times[k - 1], u[k - 1]) / 2 if k else middle))
        return np.array(u), times

class Adaptive:
    def __init__(self, f, t0, y0, tf, rtol=1e-6):
        self.f, self.t, self.y, self.tf = f, t0, y0, tf
    def step(self):
        pass
    def solve(self):
        return [self.t, self.tf], [self.y, self.y]

class Butterfly:
    def __init__(self, sigma=10.0, dt=0.01):
        self.sigma, self.dt, self.state = sigma, dt, np.array([1.0, 1.0, 1.0])
    def deriv(self, s):
        x, y, z = s
        return np.array([self.sigma * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z])
    def step(self):
        k = self.deriv(self.state)
        self.state = self.state + self.dt / 2 * (k + self.deriv(self.state + self.dt * k))

class Bashforths(Butterfly):
    last = None
    def step(self):
        k = self.deriv(self.state)
        self.state = self.state + self.dt / 2 * (3 * k - (k if self.last is None else self.last))
        self.last = k

class Bob:
    def __init__(self, length, dt):
        self.theta, self.omega, self.length, self.dt, self.swings = 0.5, 0.0, length, dt, 0
    def acceleration(self):
        return -9.81 / self.length * np.sin(self.theta)
    def update(self):
        self.omega += self.dt * self.acceleration()
        self.theta, self.swings = self.theta + self.dt * self.omega, self.swings + 1

class Ball:
    def __init__(self, x, y):
        self.x, self.y, self.vx, self.vy, self.ax, self.ay = x, y, 0.0, 0.0, 0.0, 0.0
    def update(self, dt):
        self.vx, self.vy = self.vx + self.ax * dt, self.vy + self.ay * dt
        self.x, self.y = self.x + self.vx * dt, self.y + self.vy * dt

class Vec:
    def __init__(self, x=0.0, y=0.0):
        self.x, self.y = x, y
    def __add__(self, other):
        return Vec(self.x + other.x, self.y + other.y)
    def __mul__(self, by):
        return Vec(by * self.x, by * self.y)

class Rigid:
    def __init__(self, position, velocity, mass=1.0):
        self.position, self.velocity, self.mass, self.force = position, velocity, mass, Vec()
    def apply_force(self, f):
        self.force = self.force + f
    def update(self, dt):
        self.velocity = self.velocity + self.force * (dt / self.mass)
        self.position, self.force = self.position + self.velocity * dt, Vec()

class Remembered:
    def __init__(self):
        self.x, self.v, self.a = 1.0, 0.0, -1.0
    def acceleration(self, x):
        return -x
    def step(self, h):
        self.x += h * self.v + h**2 / 2 * self.a
        self.v += h / 2 * (self.a + self.acceleration(self.x))
        self.a = self.acceleration(self.x)

class Waves:
    def __init__(self, x, V, dt):
        self.x, self.phase = x, np.exp(-1j * dt * V(x))
    def step(self, psi):
        return self.phase * psi
"""
LINES = {
    "Solver": (
        "f, t, y, h): made = Solver(f); made.set_initial_condition(y); return made.solve([t, t + h], 1)[1][-1]",
        "forward_euler",
    ),
    "Quiet": (
        "f, t, y, h): made = Quiet(f, y); made.run(t, t + h, 1); return (made.t, made.y)[1][-1]",
        "forward_euler",
    ),
    "Bashforth": (
        "f, t, y, h, n): made = Bashforth(f); made.set_initial_condition(y); return made.solve([t, t + n * h], n)[1]",
        "adams_bashforth2",
    ),
    "BashforthOverTimes": (
        "f, t, y, h, n): made = BashforthOverTimes(f); made.set_initial_condition(y); "
        "return made.solve([t + i * h for i in range(n + 1)])[0]",
        "adams_bashforth2",
    ),
    "Bashforths": (
        "f, y, h, n): made = Bashforths(); made.state, made.dt, made.deriv = y, h, f; ys = [y]; "
        "[ys.append((made.step(), [*made.state])[1]) for i in range(n)]; return ys",
        "adams_bashforth2",
    ),
    "Bob": (
        "force, q, v, h): made = Bob(1.0, h); made.theta, made.omega, made.dt, made.acceleration = "
        "q, v, h, lambda: force(made.theta); made.update(); return made.theta, made.omega",
        "symplectic_euler",
    ),
    "Ball": (
        "force, q, v, h): made = Ball(q, 0.0); made.x, made.vx, made.ax = q, v, force(q); made.update(h); "
        "return made.x, made.vx",
        "symplectic_euler",
    ),
    "Rigid": (
        "force, q, v, h): made = Rigid(Vec(q, 0.0), Vec(v, 0.0)); made.position, made.velocity, made.force = "
        "Vec(q, 0.0), Vec(v, 0.0), Vec(force(q), 0.0); made.update(h); return made.position.x, made.velocity.x",
        "symplectic_euler",
    ),
}


@pytest.mark.parametrize("name", LINES)
def test_what_a_class_is_shown_is_pasted_and_works(name):
    names, (line, key) = namespace(CLASSES), LINES[name]
    assert pasted(names, name).endswith(f"; write: def wrapped({line}")
    assert is_read_as(names["wrapped"], key)


def test_a_solver_with_tolerances_is_run_whole_and_a_class_whose_step_takes_its_own_state_shows_no_wrapper():
    names = namespace(CLASSES)
    whole = "identify_solver(Adaptive), on the command line --solver, for a whole solver"
    assert class_run_wrapper(names["Adaptive"]) == whole
    assert run_of_class(names["Adaptive"])(abs, 0.0, 1.0, tf=2.0, rtol=1e-3) == ([0.0, 2.0], [1.0, 1.0])
    assert run_of_class(names["Ball"]) is class_run_wrapper(names["Ball"]) or not class_run_wrapper(names["Ball"])
    with pytest.raises(BadInput, match=r"which no argument is: def step\(f, psi, h\): ...$"):
        opened(names["Waves"])


def test_an_object_that_also_moves_by_what_it_keeps_is_not_shown_so():
    made = namespace(CLASSES)["Remembered"]()
    assert attribute_of(made, "position") == "x"
    assert put_wrapper(type(made), made, "step") == ""
