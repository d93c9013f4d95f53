"""Several states at once: the same bits as one by one, or a check that says otherwise."""

import numpy as np

from driftproof.blackbox.checks.determinism import several_states
from driftproof.blackbox.stepper.opening import opened


def check(step, **options):
    found = several_states(opened(step, **options))
    return found[0] if found else None


def verlet(force, q, v, h):
    v = v + h / 2 * force(q)
    q = q + h * v
    return q, v + h / 2 * force(q)


def test_arithmetic_that_broadcasts_takes_batches():
    assert check(verlet).holds is True
    assert check(lambda q, v, h: (q + h * v, v - h * q)).holds is True
    assert check(verlet, array=np.float32).holds is True


def test_a_step_for_one_state_says_so():
    def branching(q, v, h):
        return (q + h * v, v - h * q) if q != 0 else (h * v, v)

    assert check(branching).holds is None
    assert check(branching).words == "takes one state at a time"


def test_states_that_mix_are_a_fault():
    def limited(q, v, h):  # by the largest of the batch, as a norm over all of it is
        v = v - h * q
        return q + h * v, v / max(1.0, float(np.max(np.abs(v))))

    found = check(limited)
    assert found.holds is False
    assert found.is_fault
    assert "otherwise than one by one" in found.words


def test_a_state_in_one_array_is_no_batch():
    assert check(lambda state, h: [state[0] + h * state[1], state[1] - h * state[0]]) is None
    assert check(lambda f, t, y, h: y + h * f(t, y)) is None
