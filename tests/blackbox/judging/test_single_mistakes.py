"""One wrong line and one wrong coefficient are found in programs that somebody else wrote, and none in right ones."""

import numpy as np
import pytest

from driftproof import Allowance, stepper_of, verify
from driftproof.blackbox.judging.single_mistakes import MOST_SHOWN, mistakes_on, single_mistakes
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.systems.given_steps import GivenSteps
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked

THIRTEEN = codes.floats(METHODS["fehlberg78"])


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


def kutta3_in_place(f, t, y, h):
    w = y
    k1 = f(t, y)
    w += h / 2 * k1
    k2 = f(t + h / 2, w)
    w[:] = y + h * (2 * k2 - k1)
    y += h / 6 * (k1 + 4 * k2 + f(t + h, w))


WRONG = {
    "in place": (kutta3_in_place, "kutta3"),
    "weights exchanged": (codes.tableau(((), (2 / 3,)), (3 / 4, 1 / 4), (0, 2 / 3)), "ralston2"),
    "reused": (rk4_with(slope=lambda f, t, y, h, k2: k2), "rk4"),
    "twice as far": (rk4_with(slope=lambda f, t, y, h, k2: f(t + h / 2, y + h * k2)), "rk4"),
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


def test_a_second_slip_in_a_time_is_not_passed_over():
    two = rk4_with(slope=lambda f, t, y, h, k2: f(t, y + h * k2))
    assert single_mistakes(opened(two), METHODS["rk4"]) == ()


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


def driven(t, y):
    """A pendulum that is damped and driven."""
    return np.array([y[1], -np.sin(y[0]) - 0.1 * y[1] + 0.5 * np.cos(0.7 * t)])


def swung(t, y):
    """Two pendulums, one of them driven."""
    return np.array([*y[2:], -np.sin(y[0]), 0.5 * np.cos(0.7 * t) - y[1]])


def epidemic(y):
    """Susceptible, infected and removed."""
    return np.array([-0.3 * y[0] * y[1], 0.3 * y[0] * y[1] - 0.1 * y[1], 0.1 * y[1]])


def rk4_of(times, halved=(0.5, 0.5)):
    def step(t, y, h):
        k1 = driven(t + times[0] * h, y)
        k2 = driven(t + times[1] * h, y + halved[0] * h * k1)
        k3 = driven(t + times[2] * h, y + halved[1] * h * k2)
        return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + driven(t + times[3] * h, y + h * k3))

    return step


def verlet_of(moved=0.5, kicks=(0.5, 0.5), late=1.0):
    def step(q, v, t, h):
        force = lambda q, t: swung(t, [*q, *v])[2:]
        a = force(q, t)
        q = q + h * v + moved * h * h * a
        return q, v + h * (kicks[0] * a + kicks[1] * force(q, t + late * h))

    return step


def heun(y, dt):
    k1 = epidemic(y)
    return y + dt / 3 * (k1 + epidemic(y + dt * k1))


def in_turn(y, dt):
    y = np.array(y)
    for i in range(3):
        y[i] += dt * epidemic(y)[i]
    return y


def pendulum(y):
    """A pendulum with friction."""
    return np.array([y[1], -np.sin(y[0]) - 0.1 * y[1]])


def slope_of(y):
    """The derivative of the pendulum's slopes."""
    return np.array([[0.0, 1.0], [-np.cos(y[0]), -0.1]])


def implicit(theta=1.0, rounds=12, frozen=False, newton=True, driven=0.0, late=1.0):
    """The step of weight theta for the new slope, by some iterations."""

    def step(t, y, h):
        y, matrix = np.array(y), np.eye(2)
        f = lambda y, t: pendulum(y) + np.array([0.0, driven * np.cos(1.3 * t)])
        z, first, old = y, slope_of(y), (1 - theta) * f(y, t)
        for _ in range(rounds):
            new = y + h * (old + theta * f(z, t + late * h))
            z = z - np.linalg.solve(matrix - h * theta * (first if frozen else slope_of(z)), z - new) if newton else new
        return z

    return step if driven else lambda y, h: step(0.0, y, h)


def rod(y):
    return np.array([-2.4 * y[0] + 1.2 * y[1], 1.2 * y[0] - 2.4 * y[1] + 1.2 * y[2], 1.2 * y[1] - 2.4 * y[2]])


def rod_in_turn(y, h):
    y = np.array(y)
    for i in range(3):
        y[i] += h / 2 * rod(y)[i]
    return np.linalg.solve(np.eye(3) - h / 2 * np.array([rod(x) for x in np.eye(3)]), y)


def late(t, y):
    """A number that follows cos t a million times as fast."""
    return -1e6 * (np.asarray(y) - np.cos(t))


SHOWN = "on the slopes of its shortest steps "
NEWTON = "the stages are solved by {} of Newton's method from y"
WEIGHED = "a[1][1]: 11/20 instead of 1/2, and a[1][0] the rest of their sum"
IMPLICIT = {
    "Newton once": (implicit(rounds=1), "backward_euler", pendulum, NEWTON.format("1 iteration"), True),
    "frozen": (
        implicit(rounds=3, frozen=True),
        "backward_euler",
        pendulum,
        NEWTON.format("3 iterations") + ", with the Jacobian of the first",
        False,
    ),
    "iterated": (
        implicit(rounds=4, newton=False),
        "backward_euler",
        pendulum,
        "the stages are iterated 4 times from k[i] = f(y)",
        True,
    ),
    "theta": (implicit(0.55), "trapezoid", pendulum, WEIGHED, True),
    "time": (
        implicit(0.5, driven=1.0, late=0.5),
        "trapezoid",
        lambda t, y: pendulum(y) + np.array([0.0, np.cos(1.3 * t)]),
        "c[1]: 1/2 instead of 1",
        True,
    ),
    # Its steps are so short that h and h * h are both nearly 0 beside t.
    "time of a stiff system": (
        lambda t, y, h: (y + h * 1e6 * np.cos(t)) / (1 + h * 1e6),
        "backward_euler",
        late,
        "c[0]: 0 instead of 1",
        False,
    ),
    "in turn": (rod_in_turn, "trapezoid", rod, "in k[0], each number moves by h a[1][0] k[0] before the next", True),
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("step", "key", "system", "words", "seen"), IMPLICIT.values(), ids=IMPLICIT)
def test_the_mistake_of_an_implicit_step_is_named_on_its_system(step, key, system, words, seen):
    told = f"is not {key}; it is {key} {{}}with one mistake: {words}"
    options = {"allowance": Allowance(solver_tolerance=1e-10), "isolate": False}
    assert verify(step, key, system=system, **options).verdict.startswith(told.format(""))
    assert verify(step, key, **options).verdict.startswith(told.format(SHOWN) if seen else f"is not {key}")
    right = implicit(1.0 if key == "backward_euler" else 0.5)
    assert verify(right, key, system=pendulum, **options).passed


def heading(y):
    """The place of a wheeled robot that turns slowly, and where it heads."""
    return np.array([0.1 * np.cos(y[2]), 0.1 * np.sin(y[2]), 0.1 + 0 * y[2]])


def driven_ahead(y, h):
    return y + h * heading(y + h * heading(y))


def chained(t, y):
    """Bodies in a row, each bound to the next; one alone feels no force."""
    q, v = np.split(np.asarray(y), 2)
    pulls = np.diff(q) - 0.1 * np.diff(q) ** 3
    return np.concatenate([v, np.append(pulls, 0) - np.append(0, pulls)])


def stale_chain(q, v, h):
    q, v = np.atleast_1d(q), np.atleast_1d(v)
    a = chained(0, np.concatenate([q, v]))[len(q) :]
    return q + h * v + h * h / 2 * a, v + h * a


STALE = "new v = v[1] + h * d[2] * F(q[0]) in place of new v = v[1] + h * d[2] * F(q[1])"
TURNS = "in k[0], each number moves by h b[0] k[0] before the next one's slope is taken"
BUILT_IN = {
    "all at t": (rk4_of([0, 0, 0, 0]), "rk4", driven, "all of c times 0", SHOWN),
    "last at half": (rk4_of([0, 0.5, 0.5, 0.5]), "rk4", driven, "c[3]: 1/2 instead of 1", SHOWN),
    "half forgotten": (rk4_of([0, 0.5, 0.5, 1], (0.5, 1.0)), "rk4", driven, "a[2][1]: 1 instead of 1/2", SHOWN),
    "no half in q": (
        verlet_of(moved=1.0),
        "velocity_verlet",
        swung,
        "the weight of k[0] in q1: 1 instead of 1/2",
        SHOWN,
    ),
    "second kick at t": (verlet_of(late=0.0), "velocity_verlet", swung, "the time of kick 2: 0 instead of 1", SHOWN),
    # At h = 2, which would be the only h, h**2 / 2 is h.
    "slow": (driven_ahead, "midpoint2", heading, "a[1][0]: 1 instead of 1/2", SHOWN),
    "several bodies": (stale_chain, "velocity_verlet", chained, STALE, SHOWN),
    "in turn": (in_turn, "forward_euler", epidemic, TURNS, SHOWN),
    # Slopes that short steps show are then not those that the code has.
    "no half in v": (verlet_of(kicks=(1, 1)), "velocity_verlet", swung, "all of b_velocity times 2", ""),
    "a third": (heun, "heun2", epidemic, "all of b times 2/3", ""),
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("step", "key", "system", "words", "shown"), BUILT_IN.values(), ids=BUILT_IN)
def test_the_mistake_is_named_where_another_system_is_built_in(step, key, system, words, shown):
    given = verify(step, key, system=system, isolate=False)
    assert given.verdict.startswith(f"is not {key}; it is {key} with one mistake: {words};")
    assert given.section("One mistake that gives the same steps").lines[0] == words
    found = verify(step, key, isolate=False).verdict
    assert found.startswith(
        f"is not {key}; it is {key} {shown}with one mistake: {words};" if shown else f"is not {key}"
    )
    assert shown or words not in found


def pushed(q, v, h):
    """A damped oscillator by kicks that see the velocity, and a drift that is too long."""
    v = v + h / 2 * (-q - 0.1 * v)
    q = q + 1.25 * h * v
    return q, v + h / 2 * (-q - 0.1 * v)


def test_no_mistake_is_sought_where_kicks_and_drifts_are_not_apart_or_steps_are_right():
    damped = GivenSteps(opened(pushed), [(1.0, 0.5), (0.5, -0.75)], 1.0, lambda t, y: [y[1], -y[0] - 0.1 * y[1]])
    assert mistakes_on(damped, Specification(METHODS["velocity_verlet"])) == ()
    right = GivenSteps(opened(codes.velocity_verlet), damped.states, 1.0, lambda t, y: [y[1], -y[0]])
    assert mistakes_on(right, Specification(METHODS["velocity_verlet"])) == ()
    assert mistakes_on(right, Specification(METHODS["symplectic_euler"])) == ()
    assert mistakes_on(right, Specification(METHODS["gauss2"])) == ()
