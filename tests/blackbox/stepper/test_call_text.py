"""A call as a line of Python: as it is made, with the maker of its numbers, and as Python reads every float."""

import math
from math import inf

import numpy as np
import pytest

from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.checks.habits import plain


def of_lists(f, y, t, h):
    return [y.index(y[0]), *f(y, t)[1:]]


WRITTEN = {
    "step(1.0, 0.75, 0.25)": plain,
    "step(numpy.array([1.0, 0.75]), 0.25)": lambda state, dt: state,
    "step([1.0, 0.75], 0.25)": lambda y, h: [y.index(y[0]), y[1]],
    "step(0.0, 1.0, 0.75, 0.25)": lambda t, x, v, dt: (x, v),
    "step(q=1.0, v=0.75, h=0.25, k=1.0)": lambda q, v, h, k: (q, k * v),
    "step(lambda q: -q, 1.0, 0.75, 0.25)": lambda force, q, v, h: (q, v + h * force(q)),
    "step(lambda t, y: numpy.array([y[1], -y[0]]), numpy.array([1.0, 0.75]), 0.25)": lambda f, y, h: f(0.0, y),
    "step(lambda y, t: [y[1], -y[0]], [1.0, 0.75], 0.0, 0.25)": of_lists,
}


@pytest.mark.parametrize("call", WRITTEN)
def test_a_call_is_written_as_it_is_made(call):
    assert call_text(opened(WRITTEN[call]), 1.0, 0.75, 0.25) == call


def test_a_call_is_written_with_the_maker_of_its_numbers():
    subject = opened(plain, array=np.float32)
    assert call_text(subject, 1.0, 0.75, 0.25) == "step(numpy.float32([1.0]), numpy.float32([0.75]), 0.25)"
    of_scalars = opened(lambda q, v, h: (q, v - h * math.sin(q)), array=np.float32)
    assert call_text(of_scalars, 1.0, 0.75, 0.25) == "step(numpy.float32(1.0), numpy.float32(0.75), 0.25)"


def test_nan_and_infinity_are_written_as_python_reads_them():
    subject = opened(plain)
    assert call_text(subject, math.nan, -inf, 0.1) == 'step(float("nan"), float("-inf"), 0.1)'


def test_a_line_that_calls_a_force_of_more_names_each_argument_once():
    def step(force, q, v, h):
        return q + h * v, v + h * force(q, 2.0, None)

    assert call_text(opened(step), 1.0, 0.5, 0.25) == "step(lambda q, _1, _2: -q, 1.0, 0.5, 0.25)"
