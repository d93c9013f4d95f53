"""Objects with a state as steppers: named like the step that they make, and what they remember is told."""

from __future__ import annotations

import re
from math import cos, nan
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.checks.determinism import repeats
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.identify import identify
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.objects import field_stepper_of, stepper_of
from driftproof.blackbox.verify import verify
from tests.blackbox.transcripts import summed


class Body:
    """Kick, then drift; it calls its force."""

    def __init__(self, force):
        self.force, self.x, self.v = force, 0.0, 0.0

    def update(self, dt):
        self.v += dt * self.force(self.x)
        self.x += dt * self.v


class Remembering(Body):
    """Verlet with the acceleration of the last step, whatever state it is given."""

    last = None

    def update(self, dt):
        first = self.force(self.x) if self.last is None else self.last
        self.v += dt / 2 * first
        self.x += dt * self.v
        self.last = self.force(self.x)
        self.v += dt / 2 * self.last


class Belated(Remembering):
    """Wrong: it leaves the force at the place before the last."""

    def update(self, dt):
        before = self.x
        super().update(dt)
        self.last = self.force(before)


class Cached:
    """Verlet of a spring, with the acceleration of its last step, or of where it was made."""

    def __init__(self):
        self.x, self.v = 1.0, 0.0
        self.a, self.steps = self.acceleration(), 0

    def acceleration(self):
        return -self.x

    def update(self, dt):
        self.x += dt * self.v + dt**2 / 2 * self.a
        before, self.a = self.a, self.acceleration()
        self.v += dt / 2 * (before + self.a)
        self.steps += 1


class Standing(Cached):
    """Makes no step of 0."""

    def update(self, dt):
        if dt:
            super().update(dt)


class Forgetful(Cached):
    """Wrong: the acceleration stays that of where it was made."""

    def update(self, dt):
        a = self.a
        super().update(dt)
        self.a = a


class InTheFlat(Remembering):
    """The same with a place and a velocity of two numbers, and a force on both."""

    def __init__(self, force):
        self.force, self.x, self.v = force, np.zeros(2), np.zeros(2)


class Engine:
    """A body in space, with a force that is given before the step, held two levels down."""

    def __init__(self):
        self.body = SimpleNamespace(position=np.zeros(3), velocity=(0.0, 0.0, 0.0), mass=1)
        self.push = 0.0

    def apply(self, force):
        self.push = force

    def step(self, dt):
        x, *rest = self.body.velocity
        self.body.velocity = (x + dt * self.push, *rest)
        self.body.position = self.body.position + dt * np.array(self.body.velocity)


class Spring:
    """Its system is built in, its state one list."""

    def __init__(self):
        self.state = [0.0, 0.0, 7.0]

    def step(self, dt):
        q, v, _ = self.state
        self.state = [q + dt * v, v - dt * q, 0.0]


class ForwardSpring(Spring):
    """Knows no step back: the NaN of one stays in it."""

    def __init__(self):
        super().__init__()
        self.scale = 1.0

    def step(self, dt):
        self.scale *= 1.0 if dt >= 0 else nan
        super().step(dt * self.scale)


class Solver:
    """The explicit midpoint method on arrays."""

    def __init__(self, f):
        self.f, self.t, self.y = f, 0.0, None

    def step(self, h):
        self.y = self.y + h * self.f(self.t + h / 2, self.y + h / 2 * self.f(self.t, self.y))
        self.t += h


body = stepper_of(Body, position="x", velocity="v", advance="update")
remembering = stepper_of(Remembering, position="x", velocity="v", advance="update")
renewed = stepper_of(Remembering, position="x", velocity="v", advance="update", anew=True)
pushed = stepper_of(Engine, position="body.position", velocity="body.velocity", push="apply")
pushed_by_attribute = stepper_of(Engine, position="body.position", velocity="body.velocity", push="push")
belated = stepper_of(Belated, position="x", velocity="v", advance="update")
spring = stepper_of(Spring, state="state")
by_functions = stepper_of(
    lambda force: {"force": force},
    position=(lambda d: d["q"], lambda d, q: d.update(q=q)),
    velocity=(lambda d: d["v"], lambda d, v: d.update(v=v)),
    advance=lambda d, h: d.update(q=d["q"] + h * d["v"], v=d["v"] + h * d["force"](d["q"])),
)
solver = field_stepper_of(Solver, time="t")
solver_without_time = field_stepper_of(lambda f: Solver(lambda t, y: f(y)))
NAMED = {
    "body": (body, "it is symplectic_euler"),
    "remembering": (remembering, "it is velocity_verlet"),
    "renewed": (renewed, "it is velocity_verlet"),
    "flat": (stepper_of(InTheFlat, position="x", velocity="v", advance="update", anew=True), "it is velocity_verlet"),
    "pushed": (pushed, "it is symplectic_euler"),
    "spring": (spring, "judging by linear steps only, it is forward_euler"),
    "solver": (solver, "it is midpoint2"),
}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", NAMED)
def test_an_object_is_named_like_the_step_that_it_makes(name, as_before):
    step, verdict = NAMED[name]
    report = identify(step)
    assert (report.verdict, report.target) == (verdict, f"{__name__}:{type(step._ready(None)).__name__}")
    assert report.section("Faults") is None
    as_before(*summed(report))


def test_what_one_step_leaves_that_is_not_finite_does_not_speak_for_the_others():
    report = identify(stepper_of(ForwardSpring, state="state"))
    assert report.verdict == NAMED["spring"][1]
    assert report.section("Faults").lines[0].startswith("h < 0 gives (nan, nan)")


def test_attributes_and_functions_do_for_methods():
    for step in (pushed_by_attribute, by_functions, solver_without_time):
        assert read_forces(opened(step)).drift == 1.0


def test_an_object_that_remembers_is_told_from_one_made_anew():
    memory = next(check for check in repeats(opened(belated)) if check.key == "no_memory")
    assert memory.holds is False
    assert "depends on the previous call" in memory.words
    assert "velocity_verlet" not in identify(belated).verdict
    assert all(check.holds for check in repeats(opened(renewed)))


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("anew", [False, True])
def test_what_an_object_keeps_is_brought_up_to_date_or_named_and_what_it_forgets_is_no_excuse(anew):
    def judged(cls, **how):
        how = {"advance": "update", "anew": anew, **how}
        return verify(stepper_of(cls, position="x", velocity="v", **how), "velocity_verlet", examples=50, isolate=False)

    assert judged(Cached).passed is True
    undecided = judged(Standing)
    assert undecided.passed is None
    assert "what it keeps from the last one, a;" in undecided.verdict
    advance = re.search(r"write advance=(.*) in the call", undecided.verdict)[1]
    assert "A_AT_ITS_STATE" in advance
    assert judged(Standing, advance=eval(advance.replace("A_AT_ITS_STATE", "made.acceleration()"))).passed is True
    assert judged(Forgetful).passed is False


def test_what_lies_beside_the_state_is_as_in_a_new_object():
    seen = []
    noting = stepper_of(Spring, state="state", advance=lambda spring, h: seen.append(list(spring.state)))
    noting(1.0, 2.0, 0.5)
    assert seen[-1] == [1.0, 2.0, 7.0]


def test_an_object_whose_array_is_narrow_keeps_it_narrow():
    def narrow():
        engine = Engine()
        engine.body.position = np.zeros(3, dtype=np.float32)
        return engine

    step = stepper_of(narrow, position="body.position", velocity="body.velocity", push="apply")
    assert step(lambda q: 0.0, 1 / 3, 0.0, 1)[0] == float(np.float32(1 / 3))


def test_a_maker_of_other_arguments_is_refused_in_one_line():
    with pytest.raises(TypeError, match=re.escape("make(force, mass) has to take the function")):
        stepper_of(lambda force, mass: None)


def test_an_attribute_that_is_not_there_is_a_finding_in_its_own_words():
    report = identify(stepper_of(Body, position="where", velocity="v", advance="leap"))
    assert "has no attribute 'leap'" in report.verdict


def test_a_word_that_was_to_be_replaced_is_not_made_an_attribute():
    step = stepper_of(lambda: SimpleNamespace(x=1.0, v=0.5, move=lambda h: None), position="POSITION", advance="move")
    with pytest.raises(BadInput, match="has no attribute POSITION: write the name of its own"):
        opened(step)


class Shaken:
    def __init__(self):
        self.x = self.v = self.t = 0.0

    def step(self, h):
        pull = lambda t, x: cos(t) - x
        self.v, before = self.v + h * pull(self.t + h / 2, self.x + h / 2 * self.v), self.v
        self.x, self.t = self.x + h * (before + h / 2 * pull(self.t, self.x)), self.t + h


def test_a_clock_that_each_step_sets_leaves_open_what_it_drives_and_a_place_is_a_name_or_two_functions():
    step = stepper_of(
        Shaken, position="x", velocity="v", advance=lambda made, h: (setattr(made, "t", 0.0), made.step(h))
    )
    found = verify(step, "midpoint2", examples=20, isolate=False)
    assert found.passed is None
    assert "begin at one t of its own" in found.verdict
    with pytest.raises(TypeError, match="give the name of an attribute, or two functions"):
        stepper_of(Shaken, state=["x", "v", "t"])


@pytest.mark.parametrize(("late", "anew"), [(False, False), (True, False), (True, True)])
def test_a_force_that_is_asked_before_positions_move_is_told_as_a_stale_one(late, anew):
    class Pendulum:
        def __init__(self):
            self.x, self.v, self.a = 1.0, 0.0, -np.sin(1.0)

        def step(self, h):
            v = self.v + h / 2 * self.a
            at, self.x = self.x, self.x + h * v
            self.a = -np.sin(at if late else self.x)
            self.v = v + h / 2 * self.a

    found = verify(
        stepper_of(Pendulum, position="x", velocity="v", anew=anew), "velocity_verlet",
        system=lambda y: [y[1], -np.sin(y[0])], isolate=False,
    )  # fmt: skip
    assert (found.passed, "what it keeps, a, is not that of where it goes on: a stale" in found.verdict) == (
        not late,
        late,
    )
