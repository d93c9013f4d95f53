"""What a step takes from v of its own: a loss for each time by its law, a loss for each step as a fault."""

from __future__ import annotations

from collections.abc import Callable
from math import exp

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.families.damping import read_damping
from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families.bounds import U, parted


def damped(factor: Callable[[float], float]):
    """Symplectic Euler of a force, the velocity multiplied in each step."""

    def step(force, x, v, dt):
        v = (v + dt * force(x)) * factor(dt)
        return x + dt * v, v

    return step


def of_oscillator(factor: Callable[[float], float]):
    """The same of the oscillator."""
    step = damped(factor)
    return lambda x, v, dt: step(lambda q: -q, x, v, dt)


def halves(force, x, v, dt):
    """Velocity Verlet between two halves of the damping."""
    loss = np.exp(-0.3 * dt / 2)
    v = loss * v + dt / 2 * force(x)
    x = x + dt * v
    return x, loss * (v + dt / 2 * force(x))


def stiff(k: float):
    """Symplectic Euler of q'' = -k q, which keeps areas: their factor is a difference of numbers of size k h²."""
    return lambda q, v, h: (q + h * (v - h * k * q), v - h * k * q)


LAWS = [
    (lambda h: np.exp(-0.3 * h), "exp(-3/10 h)", 0.3),
    (lambda h: 0.5**h, "exp(-0.693147", 0.693147),
    (lambda h: 1 - 0.3 * h, "1 - 3/10 h", 0.3),
    (lambda h: 1 / (1 + h / 4), "1/(1 + 1/4 h)", 0.25),
    (lambda h: (1 - h / 8) / (1 + h / 8), "(1 - 1/4 h/2)/(1 + 1/4 h/2)", 0.25),
    (lambda h: 1 / (1 + h / 4) ** 2, "a function of h that is none of exp(-c h)", 0.5),
    (lambda h: 1 - h, "multiplied by 1 - h, which", 1),  # with 0 at h = 1
    (lambda h: 1 - 3 * h, "multiplied by 1 - 3 h, which", 3),
    (lambda h: 1 - 9 * h, "a function of h that is none of exp(-c h), 1 - c h", 9),  # below 0 in most steps
]


@pytest.mark.parametrize(("factor", "law", "rate"), LAWS, ids=[law for _, law, _ in LAWS])
@pytest.mark.parametrize("made", [damped, of_oscillator])
def test_a_loss_for_each_time_is_told_by_its_law_and_is_no_fault(made, factor, law, rate):
    found = read_damping(opened(made(factor)))
    assert law in found.lines[0]
    assert f"which corresponds to a drag of {rate} v" in found.lines[0]
    assert found.faults == []
    assert found.data["rate"] == f"{rate:g}"
    if made is damped:
        assert found.order.order == 1
        assert "with a drag, of order 1 as measured" in found.verdict


@pytest.mark.parametrize("made", [damped, of_oscillator])
@pytest.mark.parametrize("once", [0.99, 0.0, 0.9999])
def test_a_loss_for_each_step_is_a_fault(made, once):
    factor = lambda h: once * (np.exp(-h) if once == 0.9999 else 1)
    found = read_damping(opened(made(factor)))
    (fault,) = found.faults
    assert f"is multiplied by {once:g} in each step, however short: a damping" in fault
    assert found.at_once == pytest.approx(np.array([[once]]), rel=1e-11, abs=0.0)  # of h^2, and of 2^-20 in it
    report = identify(made(factor), isolate=False)
    assert fault in report.section("Faults").lines
    assert fault in report.verdict


def test_a_drag_in_binary32_is_told():
    def step(force, x, v, dt):
        x, v, dt = (np.float32(y) for y in (x, v, dt))
        v = np.float32(np.exp(-dt / 4)) * v + dt * np.float32(force(x))
        return x + dt * v, v

    assert "multiplied by exp(-1/4 h)" in read_damping(opened(step)).lines[0]


def test_the_order_is_that_beside_the_drag():
    report = identify(halves, isolate=False)
    assert report.verdict.startswith("it is a step of a force with a drag, of order 2 as measured")
    assert (report.section("Faults"), report.data["measured_order"]) == (None, 2)
    assert "order 2 is observed on q'' = F(q) - 0.3 v" in "".join(report.section("Order").lines)
    assert verify(halves, "velocity_verlet", examples=20, isolate=False).passed is False


def test_what_takes_nothing_from_v_or_no_multiple_of_it_is_refused():
    nothing, no_drag = "does not damp v", "small steps do not follow a drag"
    for step, refusal, words in (
        *((made(lambda h: 1.0), UnsupportedCall, nothing) for made in (damped, of_oscillator)),
        (lambda x, v, h: (x + h * v, v - h * x), UnsupportedCall, nothing),
        (lambda f, t, y, h: y + h * f(t, y), UnsupportedCall, "is its own"),
        (lambda force, x, v, h: (x + h * v, v + h * (force(x) - v * abs(v))), NotReadable, "not a multiple"),
        (lambda x, v, h: (x + h * v, v - h * x - h * v**3), NotReadable, "not linear"),
        (of_oscillator(lambda h: 1 + h), NotReadable, r"areas grow as 1 \+ 1 h: no drag"),
        (lambda x, v, h: (x * (1 - h) + h * v, v - h * x), NotReadable, no_drag),
        (lambda x, v, h: (x + h * v, v * exp(-h)), NotReadable, no_drag),
        (stiff(8.4 * 2.0**40), UnsupportedCall, nothing),  # where h² k + |1 - h² k| is 16, of the short step 2^-20
        (stiff(8.6 * 2.0**40), NotReadable, "areas"),
        (stiff(1e200), NotReadable, "areas"),
        (damped(lambda h: 2.0), NotReadable, "multiplies by 2: no damping"),
        (damped(lambda h: -0.5), NotReadable, "multiplies by -0.5: no damping"),
    ):
        with pytest.raises(refusal, match=words):
            read_damping(opened(step))
    assert identify(damped(lambda h: exp(0)), isolate=False).data["damping"] is None


C = np.array([[0.25, 0.125], [0.0, 0.5]])


def of_vectors(factor: Callable[[float], np.ndarray]):
    """Symplectic Euler of vectors, the velocity multiplied by a matrix in each step."""

    def step(force, x, v, dt):
        v = factor(dt) @ v + dt * force(x)
        return x + dt * v, v

    return step


def turned(angle: float):
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def coriolis(force, x, v, dt):
    v = v + dt * (force(x) - 2 * np.cross([0.0, 0.0, 0.25], v))
    return x + dt * v, v


def strang(force, x, v, dt):
    half = (np.eye(2) - dt / 4 * C) @ np.linalg.inv(np.eye(2) + dt / 4 * C)
    v = half @ v + dt / 2 * force(x)
    x = x + dt * v
    return x, half @ (v + dt / 2 * force(x))


DRAG, ONCE = "with a drag, of order", "a damping per step"
OF_VECTORS = [
    (of_vectors(lambda h: np.eye(2) - h * C), DRAG, "h, which corresponds to a drag of [[0.25, 0.125], [0, 0.5]]"),
    (of_vectors(lambda h: np.linalg.inv(np.eye(2) + h * C)), DRAG, "1/(1 + [[1/4, 1/8], [0, 1/2]] h)"),
    (of_vectors(lambda h: np.diag([np.exp(-h / 4), np.exp(-h / 2)])), DRAG, "exp(-[[1/4, 0], [0, 1/2]] h)"),
    (of_vectors(lambda h: np.exp(-h / 4) * np.eye(3)), DRAG, "by exp(-1/4 h), which corresponds to a drag of 0.25 v"),
    (of_vectors(lambda h: np.exp(-h / 4) * np.array([[1, h / 4], [0, 1]])), DRAG, "by a function of h that is none of"),
    (of_vectors(lambda h: np.diag([0.99, 1.0])), ONCE, "by [[0.99, 0], [0, 1]] in each step, however short"),
    (of_vectors(lambda h: turned(h / 2)), "a force that turns v, of order 1", "-C v with C = [[0, -0.5], [0.5, 0]]"),
    (of_vectors(lambda h: turned(0.1)), "a turn per step", "halving h doubles it"),
    (coriolis, "a force that turns v, of order 1", "by 1 - [[0, -1/2, 0], [1/2, 0, 0], [0, 0, 0]] h"),
    (of_vectors(lambda h: np.eye(2) - h * np.array([[0.25, 0.5], [0.0, 0.25]])), DRAG, "of [[0.25, 0.5], [0, 0.25]] v"),
    (strang, "with a drag, of order 2 as measured", "multiplied by a function of h that is none of"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "kind", "law"), OF_VECTORS, ids=range(len(OF_VECTORS)))
def test_a_matrix_of_drag_or_of_turning_is_told_and_is_no_method_of_one_number(step, kind, law):
    report = identify(step, isolate=False)
    assert kind in report.verdict
    assert law in report.verdict
    assert report.data["method"] is None


EACH, NONE = "in each step, however short", "a function of h that is none of exp"
# Steps that are off by k, what is said of one that is off too far, and k before and behind the bound.
BOUNDS = [
    # Of 4 (4 + 2) = 24 roundings of numbers of size 16, as loss; of size 2/h, as rate; of size 4, beside v1 = D v.
    (lambda k: damped(lambda h: 1 - k * U), EACH, (380, 388)),
    (lambda k: of_oscillator(lambda h: 1 - k * U), "phase space", (380, 388)),
    (lambda k: damped(lambda h: exp(-0.3 * h) * (1 + k * U * (h == 2.0**-9))), NONE, (48, 50)),
    (lambda k: damped(lambda h: exp(-0.3 * h) * (1 + k * U * (h == 1))), NONE, (141, 145)),
    (lambda k: lambda force, x, v, h: (x, (v + h * force(x)) * exp(-h) + k * U * v * v), "a multiple of", (15.5, 16.5)),
    # Of size 8 (|a| + |b| + |c| + |d|) beside a step that is linear, of its velocity and of its position.
    (lambda k: lambda x, v, h: (x + h * v, v * exp(-h) - h * x + k * U * v * v), "not linear", (63, 66)),
    (lambda k: lambda x, v, h: (x + h * v + k * U * v * v, v * exp(-h) - h * x), "not linear", (63, 66)),
    # 9 h (1 + c + k)^2 of h = 2^-20 with c = 1/4 and the spring k = 1, for the slopes of x by x and by v.
    (lambda k: lambda x, v, h: (x * (1 - k * h) + h * v, v / (1 + h / 4) - h * x), "not follow", (4.3e-5, 4.4e-5)),
    (lambda k: lambda x, v, h: (x + h * v * (1 + k), v / (1 + h / 4) - h * x), "not follow", (4.3e-5, 4.4e-5)),
    # Losses like h^p: half of h leaves more than 3/8 of a drag, and less than 3/4.
    (lambda k: damped(lambda h: 1 - 0.01 * h**k), "does not damp v", (1.41, 1.42)),
    (lambda k: damped(lambda h: 1 - 0.01 * h**k), EACH, (0.42, 0.41)),
]


@pytest.mark.parametrize(("made", "words", "places"), BOUNDS, ids=range(len(BOUNDS)))
def test_what_may_be_rounding_has_a_bound(made, words, places):
    assert parted(lambda subject: read_damping(subject).verdict, made, words, places)


def test_vectors_without_a_drag_take_nothing_from_v():
    step = of_vectors(lambda h: np.eye(2))
    assert identify(step, isolate=False).verdict == "it is symplectic_euler"
    assert "a drag" in identify(strang).verdict  # from another process
    assert verify(step, "symplectic_euler", examples=20, isolate=False).passed is True
    with pytest.raises(UnsupportedCall, match="does not damp v"):
        read_damping(opened(step))


def of_velocities(ahead: Callable[[np.ndarray, np.ndarray], np.ndarray]):
    """The midpoint rule of vectors whose force is given this velocity, of the start and of the middle."""

    def step(force, x, v, dt):
        assert x.shape in ((2,), (3,))
        middle = v + dt / 2 * force(x, v)
        return x + dt * middle, v + dt * force(x + dt / 2 * v, ahead(v, middle))

    return step


VELOCITIES = [
    (lambda v, middle: middle, True, "is midpoint2"),
    (lambda v, middle: v, False, "the velocity of call 1 holds F[0]: 0 instead of 1/2"),
    (lambda v, middle: np.array([middle[0], *v[1:]]), False, "of 2 positions, v[0] is not what the coefficients"),
    (lambda v, middle: middle[::-1].copy(), False, "is not midpoint2"),
]


@pytest.mark.parametrize(("ahead", "passed", "words"), VELOCITIES, ids=range(len(VELOCITIES)))
def test_a_force_that_is_given_another_velocity_is_seen_in_every_number(ahead, passed, words):
    found = verify(of_velocities(ahead), "midpoint2", examples=20, isolate=False)
    assert found.passed is passed
    assert words in found.verdict
