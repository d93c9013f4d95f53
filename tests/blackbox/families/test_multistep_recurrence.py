"""rho and sigma are read to rounding, from objects and runs, of either kind of equation."""

import pytest

from driftproof.blackbox.families.multistep_recurrence import NoRecurrence, Recurrence, read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import FACTS_ONLY
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.families.remembering_steppers import Remembering, euler, rk4_step
from tests.looping import some


@pytest.mark.parametrize("key", ["adams_bashforth5", "adams_moulton3", "bdf4"])
def test_coefficients_are_read_that_no_method_of_the_catalogue_has(key):
    sigma = [float(x / FACTS_ONLY[key].rho[-1]) for x in FACTS_ONLY[key].sigma]
    sigma[0] += 1 / 64
    reading = read_recurrence(MarkedRuns.of(opened(Remembering(key, rk4_step, sigma=sigma).step)))
    assert reading.method is None
    for seen, right in some(zip(reading.recurrence.sigma, sigma, strict=True)):
        assert abs(seen - right) <= reading.recurrence.error < 1e-7
    assert reading.near[0][0] == key


def test_exact_fractions_lead_to_exact_facts():
    step = Remembering("adams_bashforth2", rk4_step, sigma=[-1 / 4, 5 / 4, 0.0]).step
    facts = read_recurrence(MarkedRuns.of(opened(step))).facts
    assert (facts.order, str(facts.error_constant)) == (1, "1/4")


def test_the_floats_of_a_method_are_its_own_fractions():
    for key in some(["adams_bashforth6", "bdf6", "cowell4"]):
        method = FACTS_ONLY[key]
        exact = Recurrence.of(method, BINARY64).exact
        assert MultistepFacts(exact).order == method.claimed_order
        assert Recurrence.of(method, BINARY64).differences(method) == ()


def test_a_one_step_method_of_several_stages_keeps_no_recurrence():
    with pytest.raises(NoRecurrence, match="of up to 8 steps"):
        read_recurrence(MarkedRuns.of(opened(rk4_step)))


CHANGES = {
    "after fifty steps": lambda step, t, h: len(step.states) > 50,
    "in steps back": lambda step, t, h: h < 0,
    "in short steps": lambda step, t, h: abs(h) < 1e-3,
    "long after 0": lambda step, t, h: t > 100,
}


def refused(f, t, y, h):
    raise RuntimeError("not from here")


# Steps back, and runs in which numbers may grow, need not be made; all others must.
@pytest.mark.parametrize("when", CHANGES)
@pytest.mark.parametrize("instead", [euler, refused])
def test_a_recurrence_that_is_left_somewhere_is_none(when, instead):
    class Leaving(Remembering):
        def step(self, f, t, y, h):
            after = super().step(f, t, y, h)
            return instead(f, t, y, h) if CHANGES[when](self, t, h) else after

    runs = MarkedRuns.of(opened(Leaving("adams_bashforth2", rk4_step).step))
    if instead is refused and when in ("after fifty steps", "in steps back"):
        assert read_recurrence(runs).method.key == "adams_bashforth2"
        return
    with pytest.raises(NotReadable, match="in a run of") as caught:
        read_recurrence(runs)
    assert (caught.type is NoRecurrence) is (instead is euler)
