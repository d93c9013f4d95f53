"""Another step than the h that is given, and long steps that are made of shorter ones, are told."""

import numpy as np
import pytest

from driftproof.blackbox.checks.step_size import sub_steps
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.checks.habits import code, result


def test_long_steps_that_are_refused_are_not_made_of_shorter_ones_nor_taken_as_they_are():
    refusing = code("if h > 4: raise ValueError('too long')\nreturn plain(q, v, h)")
    assert result(refusing, "sub_steps").holds
    seen = result(refusing, "step_size")
    assert (seen.holds, seen.words) == (None, "h = 16 is refused: it raises ValueError: too long")


def test_of_an_ignored_h_the_way_is_told_in_few_digits():
    said = {way: result(code(f"return {way}, v"), "step_size").words for way in ("1e300", "0.5", "3.0")}
    assert ["1e+300" in said["1e300"], " 1/2 " in said["0.5"], " 3 " in said["3.0"]] == [True] * 3


def gauss2(f, t, y, h):
    """Its two stages by iteration, until they stand."""
    d = 3**0.5 / 6
    a, k = np.array([[0.25, 0.25 - d], [0.25 + d, 0.25]]), np.array([f(t, y)] * 2)
    for _ in range(100):
        before = k
        k = np.array([f(t + (0.5 - d) * h, y + h * (a[0] @ k)), f(t + (0.5 + d) * h, y + h * (a[1] @ k))])
        if abs(k - before).max() < 1e-14:
            break
    return y + h * (k[0] + k[1]) / 2


def verlet_in_sub_steps(force, q, v, h):
    """The last force of a sub-step is the first of the next."""
    count = max(1, int(-(-abs(h) // 0.1)))
    d, a = h / count, force(q)
    for _ in range(count):
        v = v + d / 2 * a
        q, a = q + d * v, force(q + d * v)
        v = v + d / 2 * a
    return q, v


def adaptive(force, q, v, h):
    done, d = 0.0, h
    while done < h:
        d = min(d, h - done)
        a = force(q)
        if d * d * abs(a) > 1e-3:
            d /= 3
            continue
        v = v + d * a
        q, done = q + d * v, done + d
    return q, v


@pytest.mark.parametrize(
    ("step", "holds", "words"),
    [
        (gauss2, None, "times from there on: it iterates"),
        (verlet_in_sub_steps, False, "above h = 0.1 it takes sub-steps: 2 of its force calls become 3"),
        (adaptive, None, "it iterates, or adapts a step of its own"),
    ],
)
def test_an_iteration_is_told_from_sub_steps(step, holds, words):
    (check,) = sub_steps(opened(step))
    assert check.holds is holds
    assert words in check.words


def heun_on(rate):
    """Heun's method of a system that it has built in."""

    def step(y, dt):
        k1 = rate(y)
        return y + dt / 2 * (k1 + rate(y + dt * k1))

    return step


def test_steps_that_overflow_are_not_two_halves():
    """a' = -10000 a b, b' = 10000 a b - 3 b, where long steps end at some 1e40, and two of them at no number."""
    rate = lambda y: np.array([-1e4 * y[0] * y[1], 1e4 * y[0] * y[1] - 3 * y[1]])

    def rk4(y, dt):
        k1 = rate(y)
        k2 = rate(y + dt / 2 * k1)
        k3 = rate(y + dt / 2 * k2)
        return y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + dt * k3))

    with np.errstate(all="ignore"):
        (check,) = sub_steps(opened(rk4))
    assert (check.holds, check.words) == (True, "no sub-steps were detected")


@pytest.mark.parametrize(("count", "holds"), [(lambda h: 1, True), (lambda h: 1 + (abs(h) > 0.5), False)])
def test_a_step_that_is_two_halves_at_one_h_alone_is_in_no_sub_steps(count, holds):
    """Of a' = 4(b - a), b' = 4(a - b) steps of h = 1 are two of 1/2: R(-8) = R(-4)^2."""
    heun = heun_on(lambda y: 4.0 * np.array([y[1] - y[0], y[0] - y[1]]))

    def step(y, dt):
        for _ in range(count(dt)):
            y = heun(y, dt / count(dt))
        return y

    (check,) = sub_steps(opened(step))
    assert (check.holds, "above h = 0.5 it takes sub-steps" in check.words) == (holds, not holds)
