"""What a refused object that keeps its state is shown is pasted, and works; what is wrong in its step shows there."""

import re

import pytest

from driftproof import verify
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import Target
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from tests.blackbox.stepper.styles import namespace, pasted

CLASSES = """
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

class Env:
    def __init__(self):
        self.state, self.tau = np.array([1.0, 0.0]), 0.02
    def step(self, action=None):
        x, v = self.state
        self.state = np.array([x + self.tau * v, v - self.tau * x])

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

class Thrown:
    def __init__(self, x=0.0, y=1.0, vx=1.0, vy=0.0, g=9.81):
        self.x, self.y, self.vx, self.vy, self.g = x, y, vx, vy, g
    def update(self, dt):
        self.vy -= self.g * dt
        self.x, self.y = self.x + self.vx * dt, self.y + self.vy * dt

class Late(Thrown):
    def update(self, dt):
        self.x, self.y = self.x + self.vx * dt, self.y + self.vy * dt
        self.vy -= self.g * dt

class Steered:
    def __init__(self):
        self.state = (0.0, 0.0, 0.05, 0.0)
    def step(self, action, h):
        x, v, a, w = self.state
        self.state = x + h * v, v + h * (action - a), a + h * w, w + h * (9.8 * a - action * x)

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

class Game:
    def __init__(self):
        self.x, self.v, self.dt = 1.0, 0.0, 0.01
    def pull(self):
        return -self.x
    def run_step(self):
        self.v += self.pull() * self.dt
        self.x += self.v * self.dt

class Point:
    def __init__(self, x, y):
        self.pos, self.acc = np.array([x, y], float), np.zeros(2)
        self.old_pos = self.pos.copy()
    def apply_force(self, f):
        self.acc = self.acc + f
    def update(self, dt):
        self.pos, self.old_pos = 2 * self.pos - self.old_pos + 1/1 * self.acc * dt * dt, self.pos
        self.acc = np.zeros(2)

class Bead:
    def __init__(self, x):
        self.x, self.x_prev, self.acc = x, x, 0.0
    def move(self, dt):
        self.x, self.x_prev = 2 * self.x - self.x_prev + 1/1 * self.acc * dt**2, self.x

class Rope:
    def __init__(self, x, y, get_accel):
        self.pos, self.prev, self.get_accel = Vec2(x, y), Vec2(x, y), get_accel
    def integrate(self, dt):
        doubled = self.pos.plus(self.pos, 1).plus(self.prev, -1)
        self.prev, self.pos = self.pos, doubled.plus(self.get_accel(self.pos), 1/1 * dt * dt)

class Heavy:
    def __init__(self, x=0.0, mass=2.0):
        self.x, self.v, self.acc, self.mass = x, 0.0, 0.0, mass
    def apply_force(self, f):
        self.acc += f / 1/1 / self.mass
    def update(self, dt):
        self.v += self.acc * dt
        self.x, self.acc = self.x + self.v * dt, 0.0

class HeavyPoint(Point):
    def __init__(self, x, y):
        Point.__init__(self, x, y)
        self.mass = 4.0
    def apply_force(self, f):
        self.acc = self.acc + f / self.mass

class Carried:
    def __init__(self, force, m=3.0):
        self.force, self.m, self.x, self.v = force, m, 0.0, 0.0
    def move(self, dt):
        self.v += self.force(self.x) / self.m * dt
        self.x += self.v * dt

class Stored:
    def __init__(self, mass=2.0):
        self.position, self.velocity, self.force, self.mass = 0.0, 0.0, 0.0, mass
    def update(self, dt):
        self.velocity += self.force / self.mass * dt
        self.position += self.velocity * dt

class Cloth:
    def __init__(self, x, accel):
        self.pos, self.accel = np.array(x, float), accel
        self.prev = self.pos + 0.125 * accel(self.pos)
    def simulate(self, dt):
        a, before = self.accel(self.pos), self.prev
        self.prev = self.pos.copy()
        self.pos = 2 * self.pos - before + a * dt**2

class VerletPoint:
    def __init__(self, x, x_prev):
        self.x, self.x_prev = x, x_prev
    def advance(self, accel, dt):
        self.x_prev, self.x = self.x, 2 * self.x - self.x_prev + dt**2 * accel(self.x)
"""
STEPPER_OF = "from driftproof import stepper_of; wrapped = stepper_of("
KEPT = [  # the class, the method, the verdict on it where the wrapper is pasted, and what that says
    ("Ball", "symplectic_euler", True, f'{STEPPER_OF}Ball, position="pos.x", velocity="vel.x", '
     'push=lambda body, f: body.apply_force(Vec2(f, 0.0)), advance="update")'),
    ("Env", "forward_euler", True,
     f"{STEPPER_OF}Env, state=\"state\", advance=lambda made, h: (setattr(made, 'tau', h), made.step()))"),
    ("Moving", "symplectic_euler", True, f"{STEPPER_OF}lambda force: Moving(force, 1.0, 0.1, NAME), "
     'position="x", velocity="v", advance=lambda made, h: (setattr(made, \'dt\', h), made.step()))'),
    ("Sampler", "symplectic_euler", True, f"{STEPPER_OF}lambda force: Sampler(lambda x: -force(x), 0.1), "
     'position="x", velocity="v", advance=lambda made, h: (setattr(made, \'dt\', h), made.step()))'),
    ("Flow", "heun2", True,
     "from driftproof import field_stepper_of; wrapped = field_stepper_of(lambda f: Flow(f, 0.1), "
     'state="state", time="time", advance=lambda made, h: (setattr(made, \'dt\', h), made.update()))'),
    ("Game", "symplectic_euler", True, "advance=lambda made, h: (setattr(made, 'dt', h), made.run_step())"),
    ("Thrown", "symplectic_euler", None, 'position="y", velocity="vy"'),
    ("Late", "symplectic_euler", False, 'position="y", velocity="vy"'),
    ("Steered", "forward_euler", None, "lambda made, h: made.step(0.0, h)"),
    ("Drive", "midpoint2", None, ""), ("Joint", "symplectic_euler", True, ""),
    ("VerletPoint", "stormer2", True, "made = VerletPoint(0.0, 0.0); made.x, made.x_prev = q, q - h * v + h**2 / 2 * "
     "force(q); ys = [q - h * v + h**2 / 2 * force(q), q]; [ys.append((made.advance(force, h), 1.0 * made.x)[-1]) "
     "for i in range(n)]; return ys[1:], [v, *((b - a) / h for a, b in zip(ys[1:], ys[2:]))]"),
    ("Cloth", "stormer2", True, "made.pos, made.prev = 0 * made.pos + q, 0 * made.pos + q - "),
    ("Heavy", "symplectic_euler", True,
     f'{STEPPER_OF}Heavy, position="x", velocity="v", push=lambda body, f: body.apply_force(body.mass * f), advance='),
    ("HeavyPoint", "stormer2", True, "made.mass = 1.0"), ("Carried", "symplectic_euler", True, "Carried(force, m=1.0)"),
    ("Stored", "symplectic_euler", True, "made.mass, made.position, made.velocity, made.force = 1.0, q, v, force(q)"),
    ("Point", "stormer2", True, ""), ("Bead", "stormer2", True, ""), ("Rope", "stormer2", True, ""),
]  # fmt: skip


@pytest.mark.slow(keep=8)
@pytest.mark.parametrize(("name", "key", "passed", "shown"), KEPT)
def test_an_object_that_keeps_its_state_is_refused_with_a_wrapper_that_works(name, key, passed, shown):
    names = namespace(CLASSES) | {"NAME": ""}
    assert shown in pasted(names, name)
    found = verify(names["wrapped"], key, examples=20, isolate=False)
    assert found.passed is passed, found.text()
    assert ("on its own system" in found.verdict) is (passed is None)


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("name", "key"), [
    ("Drive", "midpoint2"), *((each, "symplectic_euler") for each in ("Joint", "Heavy")),
    *((each, "stormer2") for each in ("Point", "Bead", "Rope")),
])  # fmt: skip
def test_what_is_wrong_in_its_step_fails_under_its_wrapper(name, key):
    names = namespace(CLASSES.replace("1/2", "1/3").replace("1/1", "2/3"))
    pasted(names, name)
    assert verify(names["wrapped"], key, examples=20, isolate=False).passed is False


def test_an_object_that_cannot_be_called_is_refused_with_the_wrapper_of_the_method_that_makes_its_step():
    names = namespace(CLASSES)
    for found in (names["Ball"](), names["Flow"](None, 0.1)):
        (line,) = (shown for name, _, _, shown in KEPT if name == type(found).__name__)
        words = f"is {type(found).__name__}, which cannot be called; its .* makes the step; write: {re.escape(line)}"
        with pytest.raises(BadInput, match=words):
            Target(found).open()
    made = names["Moving"](None, 2.0, 0.25, "")
    made.name = 7
    with pytest.raises(BadInput, match=re.escape("lambda force: Moving(force, 1.0, 0.1, 7)")):
        Target(made.step).open()


@pytest.mark.parametrize("parameters", ["", ", f, omega2, mode", ", force, h", ", force, q0, v0, h"])
def test_of_a_class_whose_names_do_not_tell_where_its_state_is_nothing_is_shown(parameters):
    names = namespace(f"class Opaque:\n    def __init__(self{parameters}): self.a = 0.0\n    def step(self): pass\n")
    assert wrapper_line(names["Opaque"]) == ""
