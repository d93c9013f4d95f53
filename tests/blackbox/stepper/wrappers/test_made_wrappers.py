"""What a refused class or maker of steppers is shown is pasted, works, and forgets nothing."""

import pytest

from driftproof import field_stepper_of, identify, verify
from driftproof.blackbox.stepper.wrappers.made_wrappers import attribute_of, put_wrapper
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from tests.blackbox.stepper.styles import is_read_as, namespace, pasted

CLASSES = """
class Kept:
    def __init__(self, f, y0, dt):
        self.f, self.y, self.t, self.dt = f, np.array(y0, float), 0.0, dt
    def advance(self):
        k = self.f(self.t, self.y)
        self.y = self.y + self.dt / 2 * (k + self.f(self.t + self.dt, self.y + self.dt * k))
        self.t += self.dt

class KeptDefault(Kept):
    def __init__(self, f, y0, dt=0.01):
        Kept.__init__(self, f, y0, dt)

class Called:
    def __call__(self, t, y):
        k = self.f(t, y)
        k, self.last = (k if self.last is None else 1.5 * k - 0.5 * self.last), k
        return y + self.h * k

class AB2(Called):
    def __init__(self, f, h):
        self.f, self.h, self.last = f, h, None

class KeptAB2:
    def __init__(self, f, y0, h):
        self.inner, self.y, self.t = AB2(f, h), np.array(y0, float), 0.0
    def step(self):
        self.y, self.t = self.inner(self.t, self.y), self.t + self.inner.h

class Stormer:
    def __init__(self, force, h):
        self.force, self.h, self.before = force, h, None
    def step(self, q, v):
        first, last = q + self.h * v + self.h**2 / 2 * self.force(q), self.before
        q1, self.before = (first if last is None else 2 * q - last + self.h**2 * self.force(q)), q
        return q1, (q1 - q) / self.h

class Leapfrog:
    def __init__(self, rhs, y_old, y):
        self.rhs, self.y_old, self.y = rhs, y_old, y
    def step(self, dt):
        self.y_old, self.y = self.y, self.y_old + 2 * dt * self.rhs(self.y)

class Base:
    def step(self, y, t, dt):
        raise NotImplementedError

class Ralston(Base):
    def __init__(self, deriv):
        self.deriv = deriv
    def __call__(self, y, t, dt):
        k = self.deriv(y, t)
        return y + dt / 4 * (k + 3 * self.deriv(y + 2 / 3 * dt * k, t + 2 / 3 * dt))

class Clocked:
    def __init__(self, f, h):
        self.f, self.h, self.t = f, h, 0.0
    def step(self, y):
        k = self.f(self.t, y)
        self.t += self.h
        return y + self.h / 2 * (k + self.f(self.t, y + self.h * k))

class Whole:
    def __init__(self, force, dt):
        self.force, self.dt = force, dt
    def advance(self, q):
        x, v = q
        v = v + self.dt * self.force(x)
        return x + self.dt * v, v

class Controlled:
    def __init__(self, dynamics):
        self.dynamics = dynamics
    def __call__(self, x, u, dt):
        return x + 1/1 * dt * self.dynamics(x + dt / 2 * self.dynamics(x, u), u)

class Attempting:
    def __init__(self, f):
        self.f = f
    def attempt(self, t, y, h):
        k = self.f(t, y)
        return y + h / 2 * (k + self.f(t + h, y + 1/1 * h * k))

class Slotted:
    __slots__ = ("f", "t", "y")
    def __init__(self, f, t, y):
        self.f, self.t, self.y = f, t, y
    def __call__(self, h):
        self.y, self.t = self.y + h * self.f(self.t, self.y), self.t + h

class RK:
    def __init__(self, c, b):
        self.c, self.b = c, b
    def step(self, f, t, u, h):
        return u + self.b * h * f(t + self.c * h, u)

class Springs:
    def step(self, pos, vel, dt):
        vel = vel - dt * pos
        return pos + dt * vel, vel

class OfSystem:
    def __init__(self, system): self.system = system
    def integrate(self, state, t, dt):
        d = self.system.derivatives
        return state + dt * d(state + dt / 2 * d(state, t), t + dt / 2)

class Buffered:
    def __init__(self, n): self.k = np.empty((2, n))
    def step(self, f, t, y, h):
        self.k[0] = f(t, y)
        self.k[1] = f(t + h / 2, y + h / 2 * self.k[0])
        return y + h * self.k[1]

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
        made = Solver(self.f)
        made.set_initial_condition(self.y0)
        self.t, self.y = made.solve((t0, t1), n)

class Bashforth(Solver):
    def solve(self, span, n):
        h, u, slopes = (span[1] - span[0]) / n, [self.u0], []
        for i in range(n):
            slopes.append(np.asarray(self.f(span[0] + i * h, u[i])))
            ahead = self.f(span[0] + h / 2, u[i] + h / 2 * slopes[0])
            u.append(u[i] + (h / 2 * (3 * slopes[i] - slopes[i - 1]) if i else h * np.asarray(ahead)))
        return np.linspace(*span, n + 1), np.array(u)

class BashforthOverTimes(Bashforth):
    def solve(self, times):
        return Bashforth.solve(self, (times[0], times[-1]), len(times) - 1)[::-1]

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
"""
WRAPPED = {  # the method that each is, and the line that it is shown, or its end
    "Kept": ("heun2", "def wrapped(f, t, y, h): made = Kept(f, y, h); made.t = t; made.advance(); return made.y"),
    "KeptDefault": ("heun2", "made = KeptDefault(f, y, h); made.t = t; made.advance(); return made.y"),
    "AB2": ("adams_bashforth2", "def wrapped(f, t, y, h, n): made = AB2(f, h); ys = [y]; "
        "[ys.append(made(t + i * h, ys[-1])) for i in range(n)]; return ys"),
    "KeptAB2": ("adams_bashforth2", "def wrapped(f, t, y, h, n): made = KeptAB2(f, y, h); made.t = t; ys = [y]; "
        "[ys.append((made.step(), [*made.y])[1]) for i in range(n)]; return ys"),
    "Stormer": ("stormer2", "def wrapped(force, q, v, h, n): made = Stormer(force, h); ys = [(q, v)]; "
        "[ys.append(made.step(ys[-1][0], ys[-1][1])) for i in range(n)]; return ys"),
    "Leapfrog": ("two_step_leapfrog",
        "def wrapped(f, y, h, n): made = Leapfrog(f, y, y); made.y_old, made.y = y, y + h * f(y + h / 2 * f(y)); "
        "ys = [y, [*made.y]]; [ys.append((made.step(h), [*made.y])[-1]) for i in range(1, n)]; return ys"),
    "Ralston": ("ralston2", "def wrapped(f, t, y, h): return Ralston(f)(y, t, h)"),
    "Clocked": ("heun2", "def wrapped(f, t, y, h): made = Clocked(f, h); made.t = t; return made.step(y)"),
    "Whole": ("symplectic_euler", "def wrapped(force, q, v, h): return Whole(force, h).advance([q, v])"),
    "Slotted": ("forward_euler", "made(h); return made.y"),
    "Controlled": ("midpoint2", ""), "Attempting": ("heun2", ""), "OfSystem": ("midpoint2", ""),
    "Buffered": ("midpoint2", ""),
    "Quiet": ("forward_euler", "def wrapped(f, t, y, h): made = Quiet(f, y); made.run(t, t + h, 1); return (made.t, "
        "made.y)[1][-1]"),
    "Bashforth": ("adams_bashforth2", "def wrapped(f, t, y, h, n): made = Bashforth(f); "
        "made.set_initial_condition(y); return made.solve([t, t + n * h], n)[1]"),
    "BashforthOverTimes": ("adams_bashforth2", "def wrapped(f, t, y, h, n): made = BashforthOverTimes(f); "
        "made.set_initial_condition(y); return made.solve([t + i * h for i in range(n + 1)])[0]"),
    "Bashforths": ("adams_bashforth2", "def wrapped(f, y, h, n): made = Bashforths(); made.state, made.dt, "
        "made.deriv = y, h, f; ys = [y]; [ys.append((made.step(), [*made.state])[1]) for i in range(n)]; return ys"),
    "Bob": ("symplectic_euler", "def wrapped(force, q, v, h): made = Bob(1.0, h); made.theta, made.omega, made.dt, "
        "made.acceleration = q, v, h, lambda: force(made.theta); made.update(); return made.theta, made.omega"),
    "Ball": ("symplectic_euler", "def wrapped(force, q, v, h): made = Ball(q, 0.0); made.x, made.vx, made.ax = q, v, "
        "force(q); made.update(h); return made.x, made.vx"),
    "Rigid": ("symplectic_euler", "def wrapped(force, q, v, h): made = Rigid(Vec(q, 0.0), Vec(v, 0.0)); "
        "made.position, made.velocity, made.force = Vec(q, 0.0), Vec(v, 0.0), Vec(force(q), 0.0); made.update(h); "
        "return made.position.x, made.velocity.x"),
}  # fmt: skip


@pytest.mark.slow(keep=9)
@pytest.mark.parametrize("name", WRAPPED)
def test_a_class_a_maker_and_a_solver_of_n_steps_are_refused_with_a_wrapper_that_works_and_forgets_nothing(name):
    names, (key, line) = namespace(CLASSES), WRAPPED[name]
    assert pasted(names, name).endswith(line)
    assert is_read_as(names["wrapped"], key)


IN_PLACE = """
class InPlace(BASE):
    def __call__(self, t, y):
        y[:] = BASE.__call__(self, t, y)
        return y

class KeptInPlace(BASE):
    def __init__(self, f, y, h):
        BASE.__init__(self, f, h)
        self.y, self.t = y, 0.0
    def step(self):
        self.y[:] = BASE.__call__(self, self.t, self.y)
        self.t += self.h
"""


@pytest.mark.parametrize(("base", "head"), [("AB2", "f, t, y, h, n"), ("Euler", "f, t, y, h")])
def test_a_class_that_changes_its_state_in_place_is_seen_to_remember_or_not(base, head):
    euler = "class Euler(AB2):\n    def __call__(self, t, y): return y + self.h * self.f(t, y)\n"
    names = namespace(CLASSES + euler + IN_PLACE.replace("BASE", base))
    for name in ("InPlace", "KeptInPlace"):
        assert f"def wrapped({head}): " in wrapper_line(names[name])


CARRYING = """
class Carried:
    def __init__(self, accel, q0, v0):
        self.accel, self.q, self.v = accel, np.asarray(q0, float), np.asarray(v0, float)
        self.a = accel(self.q)
    def kick(self, dt):
        self.v += dt / 2 * self.a
    def step(self, dt):
        self.kick(dt)
        self.q += dt * self.v
        self.a = self.accel(self.q)
        self.kick(dt)

class Forgotten(Carried):
    def step(self, dt):
        self.kick(dt)
        self.q += dt * self.v
        self.v += dt / 2 * self.accel(self.q)

class CarriedAlone:
    def __init__(self):
        self.a = None
    def step(self, accel, q, v, dt):
        v = v + dt / 2 * (accel(q) if self.a is None else self.a)
        q = q + dt * v
        self.a = accel(q)
        return q, v + dt / 2 * self.a
"""


def test_a_class_that_carries_its_acceleration_is_shown_a_run_that_copies_its_state_and_fails_if_it_is_forgotten():
    names = namespace(CARRYING)
    lines = {each: wrapper_line(names[each])[2:] for each in ("Carried", "Forgotten", "CarriedAlone")}
    assert "(1.0 * made.q, 1.0 * made.v))[1]" in lines["Carried"]
    for line, makes, right in (
        (lines["Carried"], "Carried", True),
        (lines["Carried"], "Forgotten", False),  # the bug comes later, under the wrapper that was pasted
        (lines["Forgotten"], "Forgotten", False),
        (lines["Forgotten"], "Carried", True),
        (lines["CarriedAlone"], "CarriedAlone", True),
    ):
        kept = names | {name: names[makes] for name in lines if f" {name}(" in line}
        exec(line, kept)
        assert verify(kept["wrapped"], "velocity_verlet", examples=40, isolate=False).passed is right, (line, makes)
    assert lines["CarriedAlone"] == "wrapped = CarriedAlone().step"


CLOCKS = """
class Clocked:
    def __init__(self, name):
        self.time, self.last = 0.0, None
    def __call__(self, f, y, h):
        k = f(self.time, y)
        y, self.time = y + h / 2 * (k + f(self.time + h, y + h * k)), self.time + h
        return y
    def ab2(self, f, y, h):
        k = f(self.time, y)
        moved, self.last = k if self.last is None else 1.5 * k - 0.5 * self.last, k
        self.time += h
        return y + h * moved

class Kept(Clocked):
    def __init__(self, f):
        self.f, self.time, self.y = f, 0.0, None
    def step(self, h):
        self.y = Clocked.__call__(self, self.f, self.y, h)
"""


def test_a_clock_that_goes_on_leaves_a_verdict_open_and_is_set_in_the_wrapper():
    names = namespace(CLOCKS)
    held, own = field_stepper_of(names["Kept"]), names["Clocked"]("a")
    for step, key, line in (
        (own, "heun2", "f, t, y, h): made = Clocked(NAME); made.time = t; return made(f, y, h)"),
        (names["Clocked"]("a").ab2, "adams_bashforth2", "f, t, y, h, n): made = Clocked(NAME); made.time = t"),
        (lambda f, y, h: own(f, y, h), "heun2", "let the time be an argument, or make the step anew each time"),
        (held, "heun2", 'write time="time" in the call of field_stepper_of'),
    ):
        found = verify(step, key, isolate=False)
        assert (found.passed, identify(step, isolate=False).verdict.count("a clock of its own")) == (None, 1)
        assert line in found.verdict
        if line.endswith(("h)", " = t")):
            exec(found.verdict.partition("write: ")[2], names | {"NAME": ""}, names)
            assert verify(names["wrapped"], key, isolate=False).verdict.startswith(f"is {key}")
    assert verify(field_stepper_of(names["Kept"], time="time"), "heun2", examples=60, isolate=False).passed


def test_a_class_whose_method_is_a_step_of_the_state_is_shown_an_object_of_it():
    names = namespace(CLASSES)
    assert wrapper_line(names["RK"]) == ": wrapped = RK(C, B).step  # write values for C, B"
    assert wrapper_line(names["Springs"]) == ": wrapped = Springs().step"
    assert is_read_as(names["RK"](0.0, 1.0).step, "forward_euler")
    assert is_read_as(names["Springs"]().step, "symplectic_euler")


def test_an_object_that_also_moves_by_what_it_keeps_is_not_shown_so():
    made = namespace(CLASSES)["Remembered"]()
    assert attribute_of(made, "position") == "x"
    assert put_wrapper(type(made), made, "step") == ""


def test_a_force_that_advances_an_integral_is_a_part_of_the_step_and_is_not_replaced():
    class Loop:
        def __init__(self):
            self.x, self.v, self.kept = 1.0, 0.0, 0.0

        def acc(self, x, dt):
            self.kept += x * dt
            return -4 * x - self.kept

        def step(self, dt):
            self.v += dt * self.acc(self.x, dt)
            self.x += dt * self.v

    assert "made.acc" not in wrapper_line(Loop)
