"""The weights of a dense output are read at each theta, calls that it makes itself included."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.dense import THETAS, read_dense
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.objects import field_stepper_of
from driftproof.methods.catalogue import EXTENSIONS
from tests.blackbox.extension_steppers import extension_step
from tests.blackbox.handwritten_steppers import rk4
from tests.blackbox.transcripts import Asked


def read(step):
    return read_dense(opened(step, "field"))


@pytest.mark.parametrize("of_time", [False, True])
def test_rows_are_the_polynomials_at_their_thetas(of_time, as_before):
    asked = Asked(extension_step("dormand_prince54_shampine", of_time=of_time))
    reading, table = read(asked.code), EXTENSIONS
    as_before(*reading.rows, asked)
    assert reading.argument == ("the time" if of_time else "theta")
    assert (len(reading.rows), reading.step.calls) == (17, 7)
    weights = table["dormand_prince54_shampine"].weights
    for theta, row in zip(THETAS, reading.rows, strict=True):
        exact = [float(sum(x * theta**n for n, x in enumerate(weight))) for weight in weights]
        assert np.allclose(row, exact, rtol=0, atol=20 * 2.0**-53)  # a sum of four terms below 8, and a product


def test_calls_of_the_dense_output_are_stages():
    def euler(f, t, y, h):
        first = f(t, y)

        def midway(theta):
            second = f(t + h / 2, y + h / 2 * first)
            return y + h * (theta * first + theta * (theta - 1) * (second - first))

        return y + h * first, midway

    reading = read(euler)
    assert (reading.step.calls, reading.own, reading.step.c) == (2, (1.0, 0.0), (0.0, 0.5))
    assert (reading.rows[0], reading.rows[8], reading.rows[16]) == ((0.0, 0.0), (0.75, -0.25), (1.0, 0.0))


def test_an_object_makes_its_dense_output_when_asked():
    class Solver:
        def __init__(self, f):
            self.f, self.t, self.y = f, 0.0, None

        def step(self, h):
            self.y, self.dense = extension_step("rk4_hermite", of_time=True)(self.f, self.t, self.y, h)
            self.t += h

        def dense_output(self):
            return self.dense

    for dense in ("dense", "dense_output"):
        step = field_stepper_of(Solver, state="y", time="t", dense=dense, anew=True)
        assert read(step).rows == read(extension_step("rk4_hermite")).rows


def test_what_is_no_dense_output_is_said():
    with pytest.raises(UnsupportedCall, match="takes no right-hand side"):
        read_dense(opened(lambda q, v, h: (q + h * v, v - h * q)))
    with pytest.raises(UnsupportedCall, match="returns no dense output"):
        read(rk4)


def of_another_kind(change):
    """Heun's method, its dense output linear and then changed."""

    def step(f, t, y, h):
        y1 = y + h / 2 * (f(t, y) + f(t + h, y + h * f(t, y)))
        return y1, change(lambda place: y + (place - t) * (y1 - y) / h, f, t, y, h)

    return step


KINDS = {
    "of the time": of_another_kind(lambda linear, f, t, y, h: linear),
    "of theta": of_another_kind(lambda linear, f, t, y, h: lambda theta: linear(t + theta * h)),
    "nowhere right": of_another_kind(lambda linear, f, t, y, h: lambda theta: 0 * y),
    "right at the end": of_another_kind(lambda linear, f, t, y, h: lambda theta: linear(t + h)),
    "only inside": of_another_kind(lambda linear, f, t, y, h: lambda at: linear(at) if t <= at < t + h else 1 / 0),
    "with calls at some": of_another_kind(
        lambda linear, f, t, y, h: lambda theta: linear(t + theta * h) + (0 * f(t, y) if theta > 0.5 else 0 * y)
    ),
    "nearly right": of_another_kind(lambda linear, f, t, y, h: lambda at: linear(at) + 0.9 / 64),
    "nearly wrong": of_another_kind(lambda linear, f, t, y, h: lambda at: linear(at) + 1.1 / 64),
    "of one number": lambda f, t, y, h: (float(y) + h * f(t, y), lambda theta: float(y) + theta * h * f(t, y)),
    "raising": of_another_kind(lambda linear, f, t, y, h: lambda theta: 1 / 0),
}


@pytest.mark.parametrize("name", KINDS)
def test_what_is_read_of_a_dense_output_is_what_it_was(name, as_before):
    asked = Asked(KINDS[name])
    try:
        found = read(asked.code)
        as_before(found.argument, found.own, *found.rows[::5], asked)
    except (NotReadable, Misbehaviour) as refusal:
        as_before(type(refusal).__name__, refusal, asked)
