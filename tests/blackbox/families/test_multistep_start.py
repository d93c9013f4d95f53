"""First steps are named one by one, and their errors measured."""

import re

import pytest

from driftproof.blackbox.families.multistep_recurrence import read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns
from driftproof.blackbox.families.multistep_start import read_start
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Remembering, Stormer, euler, rk4_step


def ramped(f, t, y, h):
    """A step of BDF3's start that is none known here: twice Euler's with half the length."""
    return euler(f, t + h / 2, euler(f, t, y, h / 2), h / 2)


@pytest.mark.parametrize(
    ("step", "methods", "power", "order"),
    [
        (Remembering("adams_bashforth2", euler).step, ("forward_euler",), 2, 2),
        (Remembering("adams_bashforth4", rk4_step).step, ("rk4",) * 3, 5, 4),
        (Remembering("bdf3", planted.implicit_euler).step, ("backward_euler",) * 2, 2, 2),
        (Remembering("adams_bashforth3", ramped).step, ("forward_euler, 2 steps of h/2",) * 2, 2, 2),
        (planted.run_of_adams_bashforth3, ("rk4",) * 2, 5, 3),
        (Stormer(right=False).step, ("",), 2, 1),
    ],
)
def test_a_start_is_named_and_measured(step, methods, power, order):
    runs = MarkedRuns.of(opened(step))
    start = read_start(runs, read_recurrence(runs))
    assert (start.methods, start.power, start.order) == (methods, power, order)
    assert (len(start.slopes), len(start.order_slopes)) == (7, 5)
    *_, first, whole = start.lines
    assert re.search(rf"of its first values fall like h\^{power} \(slopes: (-?\d+\.\d\d, )*-?\d+\.\d\d\)$", first)
    assert whole.startswith(f"order {order} is seen in whole runs, the start included, on ")


def short_of(f, t, y, h):
    return y + 0.875 * h * f(t, y)


ERRORS = [
    (
        Remembering("adams_bashforth2", euler).step,
        "1.74, 1.89, 1.95, 1.97, 1.99, 1.99, 2.00",
        "1.82, 1.92, 1.97, 1.98, 1.99",
    ),
    (planted.run_of_adams_bashforth3, "3.84, 4.39, 4.61, 4.82, 4.92, 4.96, 4.98", "2.76, 2.90, 2.95, 2.97, 2.98"),
    (Stormer(right=False).step, "1.96, 1.98, 1.99, 2.00, 2.00, 2.00, 2.00", "0.99, 1.00, 1.00, 1.00, 1.00"),
    # Of one that needs no start, the first step is looked at.
    (short_of, "1.47, 1.44, 1.32, 1.04, 0.97, 0.99, 0.99", "-0.20, -0.11, -0.06, -0.03, -0.01"),
]


@pytest.mark.parametrize(("step", "first", "whole"), ERRORS, ids=range(len(ERRORS)))
def test_errors_are_of_the_last_first_value_and_of_the_end_of_a_run(step, first, whole):
    runs = MarkedRuns.of(opened(step))
    lines = read_start(runs, read_recurrence(runs)).lines
    assert lines[-2].endswith(f" (slopes: {first})")
    assert lines[-1].endswith(f" (slopes: {whole})")
