"""Memory and noise are told apart; several states at once come out as one by one, or not."""

import numpy as np
import pytest

from driftproof.blackbox.checks.determinism import first_call_again, repeats, several_states
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox.checks.habits import UNREPEATABLE, Counter, Multistep, plain, results_of
from tests.blackbox.handwritten_steppers import velocity_verlet


class Slip:
    """Another answer at one of its calls."""

    def __init__(self, slips_at, by=1e-9):
        self.calls, self.slips_at, self.by = 0, slips_at, by

    def step(self, q, v, h):
        self.calls += 1
        return q + h * v + self.by * (self.calls == self.slips_at), v - h * q


# Of eleven calls, those that ask the same: three at once, and four after another one; and of the first, made again.
@pytest.mark.parametrize(("call", "by"), [*((call, 1e-9) for call in (2, 3, 5, 7, 9, 11)), (30, 1.0)])
def test_one_slip_is_seen_at_whichever_call_and_is_not_taken_for_memory(call, by):
    slip = Slip(None, by)
    subject = opened(slip.step)
    slip.calls, slip.slips_at = 0, call
    same, memory = repeats(subject)
    assert (same.key, same.holds) == ("same_answer_twice", False)
    assert call < 30 or memory.holds is None


# What solves for its stages may begin with its last solution; an explicit step is repeated but for the order of a sum.
@pytest.mark.parametrize(("by", "method", "passed", "words"), [
    (0.0, "forward_euler", True, "to the last bit"), (2.0**-52, "forward_euler", True, "to 1.9e-16 of its size"),
    (5e-4, "forward_euler", False, "ended at (1.1875, "), (5e-4, "backward_euler", True, "to 4.2e-04 of its size"),
    (5e-3, "backward_euler", False, "ended at (1.1875, "),
])  # fmt: skip
def test_how_alike_a_step_has_to_be_made_again_is_a_matter_of_its_method(by, method, passed, words):
    slip = Slip(2, by)
    again = first_call_again(opened(slip.step), METHODS[method].explicit)
    assert again.holds is passed
    assert words in again.words


def test_of_an_unsteady_stepper_nothing_else_is_asked():
    keys = [seen.key for seen in results_of(UNREPEATABLE)]
    assert keys == ["same_answer_twice", "no_memory", "unsteady"]


def of_one_state(q, v, h):
    return (q + h * v, v - h * q) if q != 0 else (h * v, v)


def limited_by_the_largest(q, v, h):
    """Of the batch, as a norm over all of it is."""
    q, v = plain(q, v, h)
    return q, v / max(1.0, float(np.max(np.abs(v))))


BATCHES = [
    (velocity_verlet, None, True, "give the same results as one by one"),
    (velocity_verlet, np.float32, True, "give the same results as one by one"),
    (plain, None, True, "give the same results as one by one"),
    (of_one_state, None, None, "takes one state at a time"),
    (limited_by_the_largest, None, False, "give other results than one by one"),
]


@pytest.mark.parametrize(("step", "array", "holds", "words"), BATCHES)
def test_several_states_at_once_come_out_as_one_by_one_or_not(step, array, holds, words):
    (found,) = several_states(opened(step, array=array))
    assert (found.holds, found.is_fault) == (holds, holds is False)
    assert words in found.words


def test_a_state_in_one_array_is_no_batch():
    assert several_states(opened(lambda state, h: [state[0] + h * state[1], state[1] - h * state[0]])) == ()
    assert several_states(opened(lambda f, t, y, h: y + h * f(t, y))) == ()


class LastBit:
    """Every other answer is an ulp, or a few, away."""

    def __init__(self, ulps, of_velocity=0):
        self.calls, self.ulps, self.of_velocity = 0, ulps, of_velocity

    def __call__(self, q, v, h):
        self.calls += 1
        odd = self.calls % 2
        return q + h * v + self.ulps * 2.0**-53 * odd, v - h * q + self.of_velocity * 2.0**-54 * odd


UNSTEADY = {
    "memory": lambda: Multistep().step,
    "a counter": lambda: Counter().step,
    "a bit": lambda: LastBit(1),
    "a bit of the smaller number": lambda: LastBit(0, 1),
    "a few bits": lambda: LastBit(16),
    "some bits": lambda: LastBit(17),
    "some digits": lambda: LastBit(1e6),
}


@pytest.mark.parametrize("name", UNSTEADY)
def test_all_that_is_said_of_a_step_that_varies_is_as_before(name, as_before):
    subject = opened(UNSTEADY[name]())
    said = [(seen.key, seen.holds, seen.words, *(trial.line for trial in seen.example)) for seen in repeats(subject)]
    as_before(*said, f"{subject.log.calls} calls")
