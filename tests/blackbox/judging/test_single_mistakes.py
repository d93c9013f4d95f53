"""One wrong line and one wrong coefficient are found in programs that somebody else wrote, and none in right ones."""

import pytest

from driftproof import stepper_of
from driftproof.blackbox.judging.single_mistakes import MOST_SHOWN, program_of, single_mistakes
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import oscillator, stepper
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked
from tests.looping import some

THIRTEEN = codes.floats(METHODS["fehlberg78"])
EXPLICIT = [key for key, method in METHODS.items() if method.explicit]


def test_the_programs_are_the_methods():
    for key in some(EXPLICIT, 60):
        step, program = stepper(METHODS[key], float), program_of(METHODS[key])
        for force in (oscillator, lambda q: 1 + q * q):
            made, said = program.step(force, 0.5, -0.25, 0.125), step(force, 0.5, -0.25, 0.125)
            assert made == pytest.approx(said, rel=1e-13), key


def rk4_with(slope=None, base=None, end=None):
    """RK4 with another third slope, with stages on another base, or with another end."""

    def step(f, t, y, h):
        k1 = f(t, y)
        k2 = f(t + h / 2, y + h / 2 * k1)
        y3 = (base(y, h, k2) if base else y) + h / 2 * k2
        k3 = f(t + h / 2, y3) if slope is None else slope(f, t, y, h, k2)
        k4 = f(t + h, (base(y, h, k2) if base else y) + h * k3)
        total = (k1 + 2 * k2 + 2 * k3 + k4) / 6
        return y + h * total if end is None else end(y, h, total)

    return step


def verlet(kick=lambda v, a, h: v + h / 2 * a, stale=False):
    """Velocity Verlet with another last kick, or with the first force twice."""

    def step(q, v, h):
        a = -q
        v = v + h / 2 * a
        q = q + h * v
        return q, kick(v, a if stale else -q, h)

    return step


def nystrom4_with_new_velocity(force, q, v, h):
    a = force(q)
    b = force(q + h / 2 * v + h * h / 8 * a)
    c = force(q + h * v + h * h / 2 * b)
    v1 = v + h / 6 * (a + 4 * b + c)
    return q + h * v1 + h * h / 6 * (a + 2 * b), v1


WRONG = {
    "reused": (rk4_with(slope=lambda f, t, y, h, k2: k2), "rk4"),
    "twice as far": (rk4_with(slope=lambda f, t, y, h, k2: f(t, y + h * k2)), "rk4"),
    "no h": (rk4_with(end=lambda y, h, k: y + k), "rk4"),
    "h twice": (rk4_with(end=lambda y, h, k: y + h * h * k), "rk4"),
    "doubled": (rk4_with(end=lambda y, h, k: y + 2 * h * k), "rk4"),
    "overwritten": (rk4_with(base=lambda y, h, k: y + h / 3 * k), "rk4"),
    "q left": (rk4_with(end=lambda y, h, k: [y[0], (y + h * k)[1]]), "rk4"),
    "in turn": (codes.composed([("drift", 1), ("kick", 1)]), "forward_euler"),
    "stale": (verlet(stale=True), "velocity_verlet"),
    "exchanged": (codes.symplectic_euler, "symplectic_euler_position_first"),
    "exchanged before a third": (codes.composed([("drift", 1), ("kick", 0.5), ("kick", 0.5)]), "velocity_verlet"),
    "not kicked": (verlet(kick=lambda v, a, h: v), "velocity_verlet"),
    "new velocity": (nystrom4_with_new_velocity, "nystrom4"),
    "drifted too far": (codes.composed([("drift", 0.5), ("kick", 1), ("drift", 0.625)]), "position_verlet"),
    "of thirteen stages": (codes.tableau(THIRTEEN[0], [1 / 7, *THIRTEEN[1][1:]], THIRTEEN[2]), "fehlberg78"),
    "all kicks": (codes.composed([("kick", 0.55), ("drift", 1), ("kick", 0.55)]), "velocity_verlet"),
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("step", "key"), WRONG.values(), ids=WRONG)
def test_the_mistake_is_among_those_that_take_the_same_steps(step, key, as_before):
    asked = Asked(step)
    found = single_mistakes(opened(asked.code), METHODS[key])
    assert 0 < len(found) <= MOST_SHOWN
    as_before(*found, asked)


class NeverPushedAgain:
    """Velocity Verlet with the acceleration that it was made with."""

    def __init__(self, force):
        """At 1."""
        self.x, self.v, self.acc = 1.0, 0.0, force(1.0)

    def update(self, dt):
        """One step."""
        self.x += self.v * dt + self.acc * dt**2 / 2
        self.v += self.acc * dt


def test_a_slope_that_is_kept_is_no_kick_of_0():
    step = stepper_of(NeverPushedAgain, position="x", velocity="v", advance="update")
    subject = opened(step)
    subject.function.made.acc = 0.0  # as one that was made in a step without a force has it
    assert single_mistakes(subject, METHODS["velocity_verlet"]) == ()


def gives_up(q, v, h):
    raise ValueError("no")


@pytest.mark.parametrize(
    ("step", "key"),
    [(codes.rk4, "rk4"), (codes.rk38, "dormand_prince54"), (codes.rk4, "gauss2"), (codes.velocity_verlet, "rk4")],
)
def test_nothing_is_said_of_a_right_step_or_of_one_that_is_far_off(step, key):
    assert single_mistakes(opened(step), METHODS[key]) == ()
    subject = opened(codes.rk4)
    subject.function = gives_up
    assert single_mistakes(subject, METHODS["heun2"]) == ()
