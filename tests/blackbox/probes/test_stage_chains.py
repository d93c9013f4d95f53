"""Chains of marks lead to every stage that counts, in the order of first calls, and control what they tell."""

import pytest

from driftproof.blackbox.probes.marked_stages import MarkedSteps
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.probes.stage_chains import StageChains
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.implicit_steppers import all_at_once, table


def chains_of(key):
    steps = MarkedSteps(opened(all_at_once(table(key))))
    return StageChains(steps, steps.marks(0))


# For Gauss' rule, whose rows of |A| and b sum up to less than 1, and for Lobatto's with larger entries.
@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("besides", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("key", ["gauss2", "lobatto_iiic3"])
def test_so_far_a_chain_may_be_off_as_before(key, besides, as_before):
    chains = chains_of(key)
    (a,), (b,), _ = chains.tables()

    def refused(error):
        try:
            chains.require_chain((a,), (tuple(x * (1 + error) for x in b),), Rounding(BINARY64, 2, besides))
        except NotReadable:
            return True
        return False

    low, high = 0.0, 1.0
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (low, middle) if refused(middle) else (middle, high)
    as_before(f"{high:.4g}")


def test_another_table_is_refused_by_a_chain_through_all_stages():
    chains = chains_of("radau_iia2")
    (a,), (b,), _ = chains.tables()
    with pytest.raises(NotReadable, match="the step is not made of these stages"):
        chains.require_chain((a[::-1],), (b,), Rounding(BINARY64, 2, 4 * chains.left))
