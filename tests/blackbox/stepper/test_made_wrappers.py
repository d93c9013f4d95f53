"""What a refused class, object or maker is shown is pasted, works, and forgets nothing."""

import re

import pytest

from driftproof import field_stepper_of, identify, verify
from driftproof.blackbox.families.reports import read_family
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import Target, opened
from driftproof.blackbox.stepper.wrappers import wrapper_line
from tests.blackbox.stepper.styles import keys_of, namespace

CLASSES = """
import numpy as np

class Heun:
    def __init__(self, f, h):
        self.f, self.h = f, h
    def step(self, t, y):
        k = self.f(t, y)
        return y + self.h / 2 * (k + self.f(t + self.h, y + self.h * k))

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

class TimedAB2:
    def __init__(self, f):
        self.inner, self.y, self.t = AB2(f, 0.0), None, 0.0
    def step(self, h):
        self.inner.h = h
        self.y, self.t = self.inner(self.t, self.y), self.t + h

def make_ab2(f, h):
    inner = AB2(f, h)
    return lambda t, y: inner(t, y)

class Stormer:
    def __init__(self, force, h):
        self.force, self.h, self.before = force, h, None
    def step(self, q, v):
        first, last = q + self.h * v + self.h**2 / 2 * self.force(q), self.before
        q1, self.before = (first if last is None else 2 * q - last + self.h**2 * self.force(q)), q
        return q1, (q1 - q) / self.h

class Moving:
    def __init__(self, acceleration, mass, dt, name):
        self.acceleration, self.mass, self.dt, self.x, self.v = acceleration, mass, dt, 0.0, 1.0
    def step(self):
        self.v += self.dt * self.acceleration(self.x) / self.mass
        self.x += self.dt * self.v

class Sampler(Moving):
    def __init__(self, grad_U, dt):
        Moving.__init__(self, lambda x: -grad_U(x), 1.0, dt, "")

class Flow:
    def __init__(self, deriv, dt):
        self.deriv, self.dt, self.state, self.time = deriv, dt, np.array([1.0, 0.0]), 0.0
    def update(self):
        k = self.deriv(self.time, self.state)
        k2 = self.deriv(self.time + self.dt, self.state + self.dt * k)
        self.state, self.time = self.state + self.dt / 2 * (k + k2), self.time + self.dt

class KeptVerlet:
    def __init__(self, acc, x0, v0, dt):
        self.acc, self.x, self.v, self.dt = acc, x0, v0, dt
    def step(self):
        self.v += self.dt / 2 * self.acc(self.x)
        self.x += self.dt * self.v
        self.v += self.dt / 2 * self.acc(self.x)

def bashforth(f, t, y, y_prev, h):
    return y + h / 2 * (3 * f(t, y) - f(t - h, y_prev))

class Vec2:
    def __init__(self, x, y):
        self.x, self.y = x, y
    def plus(self, other, k):
        return Vec2(self.x + k * other.x, self.y + k * other.y)

class Ball:
    def __init__(self):
        self.pos, self.vel, self.force = Vec2(0.0, 0.0), Vec2(0.0, 0.0), Vec2(0.0, 0.0)
    def apply_force(self, force):
        self.force = self.force.plus(force, 1.0)
    def update(self, dt):
        self.vel = self.vel.plus(self.force, dt)
        self.pos, self.force = self.pos.plus(self.vel, dt), Vec2(0.0, 0.0)

class VerletPoint:
    def __init__(self, x, x_prev):
        self.x, self.x_prev = x, x_prev
    def advance(self, accel, dt):
        self.x_prev, self.x = self.x, 2 * self.x - self.x_prev + dt**2 * accel(self.x)

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

class Euler:
    def step(self, terms, t0, t1, y0, args):
        return y0 + (t1 - t0) * terms(t0, y0, args)

class Held:
    def __init__(self, dt, method="euler"):
        self.dt = dt
    def step(self, f, t, y):
        return y + self.dt * f(t, y)

class Env:
    def __init__(self):
        self.state, self.tau = np.array([1.0, 0.0]), 0.02
    def step(self, action=None):
        x, v = self.state
        self.state = np.array([x + self.tau * v, v - self.tau * x])

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

def pairs(f, y0, t0, t1, n):
    y, t, h = np.array(y0, float), t0, (t1 - t0) / n
    found = [y]
    for _ in range(n):
        k = f(t, y)
        y, t = y + h / 2 * (k + f(t + h, y + h * k)), t + h
        found.append(y)
    return np.linspace(t0, t1, n + 1), np.array(found)

def states(f, y0, t0, t1, n):
    return pairs(f, y0, t0, t1, n)[1]
"""
WRAPPED = {
    "Heun": "def wrapped(f, t, y, h): return Heun(f, h).step(t, y)",
    "Kept": "def wrapped(f, t, y, h): made = Kept(f, y, h); made.t = t; made.advance(); return made.y",
    "KeptDefault": "def wrapped(f, t, y, h): made = KeptDefault(f, y, h); made.t = t; made.advance(); return made.y",
    "KeptVerlet": "def wrapped(force, q, v, h): made = KeptVerlet(force, q, v, h); made.step(); return made.x, made.v",
    "AB2": "def wrapped(f, t, y, h, n): made = AB2(f, h); ys = [y]; "
    "[ys.append(made(t + i * h, ys[-1])) for i in range(n)]; return ys",
    "KeptAB2": "def wrapped(f, t, y, h, n): made = KeptAB2(f, y, h); made.t = t; ys = [y]; "
    "[ys.append((made.step(), [*made.y])[1]) for i in range(n)]; return ys",
    "TimedAB2": "from driftproof import field_stepper_of; "
    'wrapped = field_stepper_of(TimedAB2, state="y", time="t", advance="step")',
    "make_ab2": "def wrapped(f, t, y, h, n): made = make_ab2(f, h); ys = [y]; "
    "[ys.append(made(t + i * h, ys[-1])) for i in range(n)]; return ys",
    "Stormer": "def wrapped(force, q, v, h, n): made = Stormer(force, h); ys = [(q, v)]; "
    "[ys.append(made.step(ys[-1][0], ys[-1][1])) for i in range(n)]; return ys",
    "bashforth": "def wrapped(f, t, y, h, n): ys = [y, y + h * f(t + h / 2, y + h / 2 * f(t, y))]; "
    "[ys.append(bashforth(f, t + i * h, ys[-1], ys[-2], h)) for i in range(1, n)]; return ys",
    "Ball": 'from driftproof import stepper_of; wrapped = stepper_of(Ball, position="pos.x", velocity="vel.x", '
    'push=lambda body, f: body.apply_force(Vec2(f, 0.0)), advance="update")',
    "VerletPoint": "def wrapped(force, q, v, h, n): made = VerletPoint(q, q - h * v + h**2 / 2 * force(q)); "
    "ys = [q]; [ys.append((made.advance(force, h), 1.0 * made.x)[1]) for i in range(n)]; "
    "return ys, [v, *((b - a) / h for a, b in zip(ys, ys[1:]))]",
    "Leapfrog": "def wrapped(f, y, h, n): made = Leapfrog(f, y, y + h * f(y + h / 2 * f(y))); "
    "ys = [y, [*made.y]]; [ys.append((made.step(h), [*made.y])[1]) for i in range(1, n)]; return ys",
    "Ralston": "def wrapped(f, t, y, h): return Ralston(f)(y, t, h)",
    "Euler": "def wrapped(f, t, y, h): return Euler().step(f, t, t + h, y, ())",
    "Held": "def wrapped(f, t, y, h): return Held(h).step(f, t, y)",
    "Env": "from driftproof import stepper_of; "
    "wrapped = stepper_of(Env, state=\"state\", advance=lambda made, h: (setattr(made, 'tau', h), made.step()))",
    "Moving": "from driftproof import stepper_of; wrapped = stepper_of(lambda force: Moving(force, 1.0, 0.1, NAME), "
    'position="x", velocity="v", advance=lambda made, h: (setattr(made, \'dt\', h), made.step()))',
    "Sampler": "from driftproof import stepper_of; wrapped = stepper_of(lambda force: Sampler(lambda x: -force(x), "
    '0.1), position="x", velocity="v", advance=lambda made, h: (setattr(made, \'dt\', h), made.step()))',
    "Flow": "from driftproof import field_stepper_of; wrapped = field_stepper_of(lambda f: Flow(f, 0.1), "
    'state="state", time="time", advance=lambda made, h: (setattr(made, \'dt\', h), made.update()))',
    "Clocked": "def wrapped(f, t, y, h): made = Clocked(f, h); made.t = t; return made.step(y)",
    "Whole": "def wrapped(force, q, v, h): return Whole(force, h).advance([q, v])",
    "pairs": "def wrapped(f, t, y, h): return pairs(f, y, t, t + h, 1)[1][-1]",
    "states": "def wrapped(f, t, y, h): return states(f, y, t, t + h, 1)[-1]",
}


REMEMBERING = {
    **dict.fromkeys(("AB2", "KeptAB2", "TimedAB2", "make_ab2", "bashforth"), "adams_bashforth2"),
    **dict.fromkeys(("Stormer", "VerletPoint"), "stormer2"),
    "Leapfrog": "two_step_leapfrog",
}
OTHERS = {
    "KeptVerlet": "velocity_verlet",
    "Ball": "symplectic_euler",
    "Whole": "symplectic_euler",
    "Ralston": "ralston2",
}
OTHERS |= dict.fromkeys(("Euler", "Held", "Env"), "forward_euler") | dict.fromkeys(
    ("Moving", "Sampler"), OTHERS["Ball"]
)


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("name", WRAPPED)
def test_a_class_a_maker_and_a_solver_of_n_steps_are_refused_with_a_wrapper_that_works_and_forgets_nothing(name):
    names = namespace(CLASSES) | {"NAME": ""}
    with pytest.raises(ValueError, match=re.escape(f"`driftproof verify --help`; write: {WRAPPED[name]}")):
        opened(names[name])
    exec(WRAPPED[name], names)
    if name in REMEMBERING:
        assert read_family(opened(names["wrapped"])).key == REMEMBERING[name]
    else:
        assert keys_of(names["wrapped"])[0] == OTHERS.get(name, "heun2")


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
import numpy as np

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
    report = verify(names["CarriedAlone"]().step, "velocity_verlet", examples=40, isolate=False)
    assert report.verdict.endswith(f": it remembers the previous step, or is random; write: {lines['CarriedAlone']}")


def test_an_object_that_cannot_be_called_is_refused_with_the_wrapper_of_the_method_that_makes_its_step():
    names = namespace(CLASSES)
    for found in (names["Ball"](), names["Kept"](None, [1.0], 0.1), names["Flow"](None, 0.1)):
        name = type(found).__name__
        words = f"is {name}, which cannot be called; its .* makes the step; write: {re.escape(WRAPPED[name])}"
        with pytest.raises(BadInput, match=words):
            Target(found).open()
    made = names["Moving"](None, 2.0, 0.25, "")
    made.name = 7
    with pytest.raises(BadInput, match=re.escape("lambda force: Moving(force, 1.0, 0.1, 7)")):
        Target(made.step).open()


def test_a_class_that_takes_its_force_is_judged_by_its_coefficients_where_its_wrapper_is_pasted():
    names = namespace(CLASSES) | {"NAME": ""}
    exec(WRAPPED["Moving"], names)
    found = verify(names["wrapped"], "symplectic_euler", examples=60, isolate=False)
    assert found.passed
    assert "Coefficients: passed" in found.text()
    assert verify(names["wrapped"], "velocity_verlet", examples=60, isolate=False).passed is False


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


WORLD = """
class Body:
    def __init__(self, x, y, vx, vy, m):
        self.x, self.y, self.vx, self.vy, self.mass = x, y, vx, vy, m

class World:
    def __init__(self, bodies, g=-9.81):
        self.bodies, self.g = bodies, g
    def step(self, dt):
        for b in self.bodies:
            b.vy += self.g * dt
            b.x, b.y = b.x + b.vx * dt, b.y + b.vy * dt
"""


def test_a_world_made_from_bodies_is_refused_with_a_wrapper_of_one_body_that_works():
    names = namespace(WORLD)
    for found in (names["World"], names["World"]([])):
        with pytest.raises(BadInput, match=r"write: .*World\(\[Body\(") as caught:
            Target(found).open()
        exec(str(caught.value).partition("write: ")[2], names)
        assert keys_of(names["wrapped"])[0] == "symplectic_euler"


@pytest.mark.parametrize("parameters", ["", ", f, omega2, mode", ", force, h", ", force, q0, v0, h"])
def test_of_a_class_whose_names_do_not_tell_where_its_state_is_nothing_is_shown(parameters):
    names = namespace(f"class Opaque:\n    def __init__(self{parameters}): self.a = 0.0\n    def step(self): pass\n")
    assert wrapper_line(names["Opaque"]) == ""


OWN_STEPS = """
class RK:
    def __init__(self, c, b):
        self.c, self.b = c, b
    def step(self, f, t, u, h):
        return u + self.b * h * f(t + self.c * h, u)

class Game:
    def __init__(self):
        self.x, self.v, self.dt = 1.0, 0.0, 0.01
    def pull(self):
        return -self.x
    def run_step(self):
        self.v += self.pull() * self.dt
        self.x += self.v * self.dt

class Springs:
    def step(self, pos, vel, dt):
        vel = vel - dt * pos
        return pos + dt * vel, vel
"""


def test_a_class_whose_method_is_a_step_of_the_state_is_shown_an_object_of_it():
    names = namespace(OWN_STEPS)
    assert wrapper_line(names["RK"]) == ": wrapped = RK(C, B).step  # write values for C, B"
    assert wrapper_line(names["Springs"]) == ": wrapped = Springs().step"
    assert "advance=lambda made, h: (setattr(made, 'dt', h), made.run_step())" in wrapper_line(names["Game"])
    assert [*keys_of(names["RK"](0.0, 1.0).step)] == ["forward_euler"]
    assert "symplectic_euler" in identify(names["Springs"]().step, isolate=False).verdict


POINTS = """
class Point:
    def __init__(self, x, y):
        self.pos, self.acc = np.array([x, y], float), np.zeros(2)
        self.old_pos = self.pos.copy()
    def apply_force(self, f):
        self.acc = self.acc + f
    def update(self, dt):
        self.pos, self.old_pos = 2 * self.pos - self.old_pos + self.acc * dt * dt, self.pos
        self.acc = np.zeros(2)

class Bead:
    def __init__(self, x):
        self.x, self.x_prev, self.acc = x, x, 0.0
    def move(self, dt):
        self.x, self.x_prev = 2 * self.x - self.x_prev + self.acc * dt**2, self.x
"""


POINTS += """
class Vector:
    def __init__(self, x, y):
        self.x, self.y = x, y
    def plus(self, other, k):
        return Vector(self.x + k * other.x, self.y + k * other.y)

class Rope:
    def __init__(self, x, y, get_accel):
        self.pos, self.prev, self.get_accel = Vector(x, y), Vector(x, y), get_accel
    def integrate(self, dt):
        doubled = self.pos.plus(self.pos, 1).plus(self.prev, -1)
        self.prev, self.pos = self.pos, doubled.plus(self.get_accel(self.pos), 1 * dt * dt)
"""


@pytest.mark.parametrize("name", ["Point", "Bead", "Rope"])
@pytest.mark.parametrize("right", [True, False])
def test_an_object_of_two_positions_is_shown_a_run_that_sets_both(name, right):
    wrong = POINTS.replace("self.acc * dt", "self.acc / 2 * dt").replace("1 * dt * dt", "dt * dt / 2")
    names = namespace(POINTS if right else wrong)
    with pytest.raises(BadInput) as caught:
        opened(names[name])
    exec(str(caught.value).partition("write: ")[2], names)
    assert ("it is stormer2" in identify(names["wrapped"], isolate=False).verdict) == right


ROBOTS = """
class Drive:
    def __init__(self, x=0.0, y=0.0, theta=0.0, v=1.0, omega=0.3):
        self.x, self.y, self.theta, self.v, self.omega = x, y, theta, v, omega
    def integrate(self, dt):
        middle = self.theta + 1/2 * dt * self.omega
        self.x, self.y = self.x + dt * self.v * np.cos(middle), self.y + dt * self.v * np.sin(middle)
        self.theta += dt * self.omega

class Joint:
    def __init__(self, accel):
        self.accel, self.q, self.qd, self.time = accel, np.zeros(3), np.zeros(3), 0.0
    def integrate(self, dt):
        self.qd = self.qd + dt * self.accel(self.q, self.qd, self.time)
        self.q = self.q + 1/1 * dt * self.qd
        self.time += dt

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
"""


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("name", "key"), [
    ("Drive", "midpoint2"), ("Joint", "symplectic_euler"), ("Controlled", "midpoint2"), ("Attempting", "heun2"),
])  # fmt: skip
@pytest.mark.parametrize("right", [True, False])
def test_attributes_that_a_step_moves_and_the_only_method_of_a_state_are_found_whatever_their_names(name, key, right):
    names = namespace(ROBOTS if right else ROBOTS.replace("1/2", "1/3").replace("1/1", "2/3"))
    with pytest.raises(BadInput) as caught:
        opened(names[name])
    exec(str(caught.value).partition("write: ")[2], names)
    found = verify(names["wrapped"], key, examples=20, isolate=False)
    assert found.passed is (None if name == "Drive" else True) if right else found.passed is False, found.text()
    assert not right or f"is {key}" in found.verdict


PLANAR = """
class Ball:
    def __init__(self, x=0.0, y=1.0, vx=1.0, vy=0.0, g=9.81):
        self.x, self.y, self.vx, self.vy, self.g = x, y, vx, vy, g
    def update(self, dt):
        self.vy -= self.g * dt
        self.x, self.y = self.x + self.vx * dt, self.y + self.vy * dt

class Late(Ball):
    def update(self, dt):
        self.x, self.y = self.x + self.vx * dt, self.y + self.vy * dt
        self.vy -= self.g * dt

class Damped:
    def __init__(self):
        self.x, self.dt = [1.0, 0.0], 0.01
    def step(self, u):
        x, v = self.x
        self.x = [x + self.dt * v, v + self.dt * (u - 3 * x - 0.2 * v)]

class Steered:
    def __init__(self):
        self.state = (0.0, 0.0, 0.05, 0.0)
    def step(self, action, h):
        x, v, a, w = self.state
        self.state = x + h * v, v + h * (action - a), a + h * w, w + h * (9.8 * a - action * x)

class Slotted:
    __slots__ = ("f", "t", "y")
    def __init__(self, f, t, y):
        self.f, self.t, self.y = f, t, y
    def __call__(self, h):
        self.y, self.t = self.y + h * self.f(self.t, self.y), self.t + h
"""


@pytest.mark.parametrize(("name", "method", "shown", "passed"), [
    ("Ball", "symplectic_euler", 'position="y", velocity="vy"', None),
    ("Late", "symplectic_euler", 'position="y", velocity="vy"', False),
    ("Damped", "forward_euler", "(setattr(made, 'dt', h), made.step(0.0))", None),
    ("Steered", "forward_euler", "lambda made, h: made.step(0.0, h)", None),
    ("Slotted", "forward_euler", "made(h); return made.y", True),
])  # fmt: skip
def test_a_force_on_one_coordinate_a_control_and_slots_are_seen_in_the_wrapper_which_works(name, method, shown, passed):
    names = namespace(PLANAR)
    with pytest.raises(BadInput) as caught:
        opened(names[name])
    assert shown in str(caught.value)
    exec(str(caught.value).partition("write: ")[2], names)
    found = verify(names["wrapped"], method, examples=20, isolate=False)
    assert found.passed is passed
    assert ("on its own system" in found.verdict) is (passed is None)
