"""First steps are named one by one, and their errors measured."""

import re

import pytest

from driftproof.blackbox.families.multistep_recurrence import read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns
from driftproof.blackbox.families.multistep_start import read_start
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Remembering, Stormer
from tests.blackbox.handwritten_steppers import euler, rk4


def ramped(f, t, y, h):
    """A step of BDF3's start that is none known here: twice Euler's with half the length."""
    return euler(f, t + h / 2, euler(f, t, y, h / 2), h / 2)


AB2, AB3 = "adams_bashforth2", "adams_bashforth3"
# With how errors of the last first value and of the end of a run fall; nothing where another row tells.
STARTS = [
    (Remembering(AB2, euler).step, ("forward_euler",), 2, 2, "1.74, 1.89, 1.95, 1.97, 1.99, 1.99, 2.00",
     "1.82, 1.92, 1.97, 1.98, 1.99"),
    (Remembering("adams_bashforth4", rk4).step, ("rk4",) * 3, 5, 4, "", ""),
    (Remembering("bdf3", planted.implicit_euler).step, ("backward_euler",) * 2, 2, 2, "", ""),
    (Remembering(AB3, ramped).step, ("forward_euler, 2 steps of h/2",) * 2, 2, 2, "", ""),
    (planted.run_of_adams_bashforth3, ("rk4",) * 2, 5, 3, "3.84, 4.39, 4.61, 4.82, 4.92, 4.96, 4.98",
     "2.76, 2.90, 2.95, 2.97, 2.98"),
    (Stormer(right=False).step, ("",), 2, 1, "1.96, 1.98, 1.99, 2.00, 2.00, 2.00, 2.00",
     "0.99, 1.00, 1.00, 1.00, 1.00"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "methods", "power", "order", "first", "whole"), STARTS, ids=range(len(STARTS)))
def test_a_start_is_named_and_its_errors_measured(step, methods, power, order, first, whole):
    runs = MarkedRuns.of(opened(step))
    start = read_start(runs, read_recurrence(runs))
    assert (start.methods, start.power, start.order) == (methods, power, order)
    assert (len(start.slopes), len(start.order_slopes)) == (7, 5)
    *_, begun, ended = start.lines
    slopes = re.escape(first) or r"(-?\d+\.\d\d, )*-?\d+\.\d\d"
    assert re.search(rf"of its first values fall like h\^{power} \(slopes: {slopes}\)$", begun)
    assert ended.startswith(f"order {order} is observed in whole runs, the start included, on ")
    assert ended.endswith(f" (slopes: {whole})" if whole else ")")


def test_of_one_that_needs_no_start_the_first_step_is_looked_at():
    runs = MarkedRuns.of(opened(lambda f, t, y, h: y + 0.875 * h * f(t, y)))
    *_, begun, ended = read_start(runs, read_recurrence(runs)).lines
    assert begun.endswith(" (slopes: 1.47, 1.44, 1.32, 1.04, 0.97, 0.99, 0.99)")
    assert ended.endswith(" (slopes: -0.20, -0.11, -0.06, -0.03, -0.01)")
