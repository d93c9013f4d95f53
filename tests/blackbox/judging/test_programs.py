"""The programs of methods take the steps of these methods, and each mistake in one is seen in its steps."""

import numpy as np
import pytest

from driftproof.blackbox.judging.programs import StepSeen, edits, one_parameter, programs_of
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from tests.looping import some

EXPLICIT = [key for key, method in METHODS.items() if method.explicit]


def taken(rate, y=(0.5, -0.25), t=0.0, h=0.125):
    """A step whose end is not looked at."""
    return StepSeen(rate, t, y, h, y)


def test_the_programs_are_the_methods():
    for key in some(EXPLICIT, 60):
        step = stepper(METHODS[key], float)
        for force in (oscillator, lambda q: 1 + q * q):
            said = step(force, 0.5, -0.25, 0.125)
            for program in some(programs_of(METHODS[key])):
                made = program.end(taken(lambda t, y, force=force: [y[1], force(y[0])]))
                assert made == pytest.approx(said, rel=1e-13), key


@pytest.mark.parametrize("key", ["rk4", "nystrom4", "velocity_verlet", "ruth3"])
def test_slopes_are_asked_at_their_times(key):
    """With t as a further number of the state, the same steps; in both forms of velocity Verlet."""
    for program in some(programs_of(METHODS[key], timed=True)):
        made = program.end(taken(lambda t, y: [y[1], t - y[0]], t=0.75))
        plain = programs_of(METHODS[key])[0]
        wider = type(plain)(plain.lines, plain.tables, False, (slice(None, 2), slice(2, None)))
        told = wider.end(taken(lambda t, y: [y[2], y[3], y[1] - y[0], 0.0], (0.5, 0.75, -0.25, 1.0)))
        assert made == pytest.approx([told[0], told[2]], rel=1e-14)


@pytest.mark.parametrize(("key", "timed"), [("heun2", True), ("velocity_verlet", False), ("nystrom4", False)])
def test_most_mistakes_change_a_step(key, timed):
    method = METHODS[key]
    for program in some(programs_of(method, timed)):
        step = taken(lambda t, y: [y[1], np.cos(y[0] + t)], t=0.25)
        right, shifted = program.end(step), [one.at(0.375) for one in some(one_parameter(method, program))]
        assert all(other.end(step) != right for other in shifted)
        wrong = [type(program)(lines, program.tables, timed) for _, lines in edits(method, program, pair=True)]
        ends = [other.end(step) for other in some(wrong)]
        assert sum(end != right for end in ends) > 3 * len(ends) // 4


def test_a_state_that_is_no_pair_has_no_components():
    method = METHODS["rk4"]
    (program,) = programs_of(method)
    words = " ".join(words for words, _ in some(edits(method, program, pair=False)))
    assert "in the q" not in words
    assert "the q of" not in words
    assert "position" not in words
