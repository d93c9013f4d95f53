"""What a refusal shows is pasted, and works; an increment is told apart from a step."""

import re

import pytest

from driftproof.blackbox.findings import Increment, Misbehaviour
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.wrappers import wrapper_line
from tests.blackbox.stepper.styles import STYLES, keys_of, namespace


@pytest.mark.parametrize("style", [s for s in STYLES if s.wrapper], ids=lambda style: style.title)
def test_a_style_that_is_refused_shows_a_wrapper_which_works_when_it_is_pasted(style):
    names = namespace(style.code)
    with pytest.raises((ValueError, Misbehaviour)) as caught:
        opened(list(names.values())[-1])
    message = str(caught.value)
    assert "\n" not in message
    assert message.endswith(f": {style.wrapper.rstrip()}")
    exec(style.wrapper, names)
    assert style.key in keys_of(names["wrapped"])


def test_an_increment_of_position_and_velocity_is_told_apart_from_a_step_that_is_damped():
    with pytest.raises(Increment, match=re.escape("def wrapped(q, v, h): dq, dv =")):
        opened(lambda q, v, h: (h * v, -h * q))
    assert opened(lambda q, v, h: (0.25 * q, 0.25 * v)).step(1.0, 1.0, 0.5) == (0.25, 0.25)


def test_a_whole_solver_is_sent_to_its_own_command_and_nothing_is_said_of_the_unknown():
    def solve(f, t_span, y0, rtol, atol):
        return None

    assert wrapper_line(solve) == ": a whole solver is examined by identify_solver(solve)"
    assert wrapper_line(max) == ""
