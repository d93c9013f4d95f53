"""What is done to arguments and answers, and what types go in and come out."""

import pytest

from tests.blackbox.checks.habits import ADDS_INTO_ITS_ARGUMENTS, INTEGERS, assert_fault, code, identified, own_buffer

FAULTS = [
    (INTEGERS, "returns", "returns integers: at h = 0, (1.0, 0.75) becomes (1.0, 0.0)"),
    (
        code("out = np.zeros_like(state); out[0], out[1] = plain(state[0], state[1], h); return out", "state, h"),
        "takes_integers",
        "integers cut the answer off: (3.0625, 0.25) becomes (3.0, 0.0)",
    ),
    (ADDS_INTO_ITS_ARGUMENTS, "keeps_arguments", "given arrays, it changes its arguments, besides returning"),
    (own_buffer, "keeps_answers", "an answer is overwritten by the next"),
]


@pytest.mark.parametrize(("step", "key", "words"), FAULTS, ids=identified)
def test_a_fault_is_told_in_words(step, key, words):
    assert_fault(step, key, words)
