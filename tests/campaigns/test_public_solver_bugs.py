"""Every public bug that is replayed is caught by its cause, and no mended twin raises an alarm."""

import pytest

from tests.campaigns.public_solver_bugs import REPLAYS
from tests.looping import exactly

# Each takes as many calls as it may, or whole runs, on a way that others take, too: they are examined in the long tier.
LATER = ("jax-ml/jax#40510", "headmyshoulder/odeint-v2#173", "firemodels/fds#8009", "mfem/mfem#2343")
EACH = [
    pytest.param(each, id=f"{each.reference}: {each.about}", marks=[pytest.mark.long] * (each.reference in LATER))
    for each in REPLAYS
]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("replay", EACH)
def test_the_bug_is_caught_and_its_cause_is_named(replay):
    assert replay.cause in replay.examine(replay.buggy).words


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("replay", EACH)
def test_the_mended_twin_raises_no_alarm(replay):
    said = replay.examine(replay.mended)
    assert said.faults == []
    assert replay.cause not in said.words


def test_every_replay_is_another_one():
    assert len({replay.about for replay in exactly(26, REPLAYS)}) == 26
