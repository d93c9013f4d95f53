"""What a refused function is shown is pasted, and works; what cannot be known is left in capitals."""

import pytest

from driftproof.blackbox.families.reports import read_family
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.function_wrappers import list_wrapper
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.wrappers import wrapper_line
from tests.blackbox.stepper.styles import namespace


def test_a_whole_solver_is_sent_to_its_own_command_and_nothing_is_said_of_the_unknown():
    def solve(f, t_span, y0, rtol, atol):
        return None

    assert wrapper_line(solve) == ": identify_solver(solve), for a whole solver"
    assert wrapper_line(max) == ""
    for step in (lambda q, h, mesh: None, lambda p, h, mesh: None, lambda y, h, mesh: None):
        assert "([q, v], h, MESH)" in wrapper_line(step)


def test_of_a_step_whose_h_is_built_in_the_wrapper_says_what_to_do():
    names = namespace("def made(h):\n    return lambda q, v: (q + h * v, v - h * q)\n")
    with pytest.raises(ValueError, match=r"# its h is built in: let it be an argument, or make the step anew"):
        opened(names["made"](0.25))


def test_of_a_step_that_takes_the_state_before_the_wrapper_says_where_to_keep_it():
    assert "# a method of two steps: let an object keep its X_OLD, step(" in wrapper_line(
        lambda x, x_old, acc, dt: x_old
    )
    assert "two steps" not in wrapper_line(lambda f, t, y, h, mesh: y)


LISTS = """
def bdf2(f, t, ys, h):
    y = ys[-1]
    for _ in range(60):
        y = 4 / 3 * ys[-1] - 1 / 3 * ys[-2] + 2 / 3 * h * f(t + h, y)
    return y

def adams_bashforth2(f, t, states, h):
    return states[-1] + h / 2 * (3 * f(t, states[-1]) - f(t - h, states[-2]))

def adams_bashforth3(f, t, history, dt):
    first, second, third = history[:3]
    return first + dt / 12 * (23 * f(t, first) - 16 * f(t - dt, second) + 5 * f(t - 2 * dt, third))
"""


@pytest.mark.parametrize("name", ["bdf2", "adams_bashforth2", "adams_bashforth3"])
def test_a_step_that_takes_a_list_of_states_is_refused_with_a_run_of_n_steps_that_works(name):
    names = namespace(LISTS)
    with pytest.raises(BadInput, match="write: def wrapped") as caught:
        opened(names[name])
    exec(str(caught.value).partition("write: ")[2], names)
    assert read_family(opened(names["wrapped"])).key == name
    back = lambda n: lambda f, t, ys, h: ys[-n] + n * h * f(t, ys[-1])
    assert [bool(list_wrapper(back(n))) for n in (7, 8)] == [True, False]
