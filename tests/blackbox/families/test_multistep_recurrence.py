"""rho and sigma are read to rounding, from objects and runs, of either kind of equation."""

from dataclasses import replace

import numpy as np
import pytest

from driftproof.blackbox.families.multistep_recurrence import FORWARD_EULER, NoRecurrence, Recurrence, read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.families.bounds import U, parted
from tests.blackbox.families.remembering_steppers import BASHFORTH4, Corrected, Remembering
from tests.blackbox.handwritten_steppers import euler, rk4
from tests.looping import some


@pytest.mark.parametrize(
    ("key", "error"), [("adams_bashforth5", 4.6995e-8), ("adams_moulton3", 3.7924e-12), ("bdf4", 4.7650e-11)]
)
def test_coefficients_are_read_that_no_method_of_the_catalogue_has(key, error):
    sigma = [float(x / FURTHER_METHODS[key].rho[-1]) for x in FURTHER_METHODS[key].sigma]
    sigma[0] += 1 / 64
    reading = read_recurrence(MarkedRuns.of(opened(Remembering(key, rk4, sigma=sigma).step)))
    assert reading.method is None
    for seen, right in some(zip(reading.recurrence.sigma, sigma, strict=True)):
        assert abs(seen - right) <= reading.recurrence.error
    assert reading.recurrence.error == pytest.approx(error, rel=1e-4)
    assert (reading.late, reading.predictor, reading.corrections) == (0, None, 0)
    assert reading.near[0][0] == key


def test_the_floats_of_a_method_are_its_own_fractions():
    assert MultistepFacts(FORWARD_EULER).order == FORWARD_EULER.claimed_order
    for key in some(["adams_bashforth6", "bdf6", "cowell4"]):
        method = FURTHER_METHODS[key]
        exact = Recurrence.of(method, BINARY64).exact
        assert MultistepFacts(exact).order == method.claimed_order
        assert Recurrence.of(method, BINARY64).differences(method) == ()


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

    runs = MarkedRuns.of(opened(Leaving("adams_bashforth2", rk4).step))
    if instead is refused and when in ("after fifty steps", "in steps back"):
        assert read_recurrence(runs).method.key == "adams_bashforth2"
        return
    with pytest.raises(NotReadable, match="in a run of") as caught:
        read_recurrence(runs)
    assert (caught.type is NoRecurrence) is (instead is euler)


def beside(made, off):
    """The step, and this of its state and of h."""
    return lambda f, t, y, h: made.step(f, t, y, h) + off(y, h)


def adams_bashforth2(**how):
    return Remembering("adams_bashforth2", rk4, **how)


def predicted_and_corrected():
    return Corrected("adams_moulton3", rk4, BASHFORTH4)


HALVES = [-0.25, 1.25, 0.0]
LEFT = "steps do not satisfy the recurrence"
# Steps that are off by k u, what is said of one that is off too far, and k before and behind the bound.
BOUNDS = [
    (lambda k: adams_bashforth2(sigma=[k * U - 0.5, 1.5, 0.0]).step, LEFT, (23, 24.5)),
    (lambda k: beside(adams_bashforth2(), lambda y, h: k * U * abs(y)), "not in the catalogue", (37, 46)),
    (lambda k: beside(adams_bashforth2(), lambda y, h: k * U * (h == 0.75)), LEFT, (8.5, 8.9)),
    # Of one that is not known, what is read wrongly of 2 (3 + 3) coefficients; of implicit ones, what solvers leave.
    (lambda k: beside(adams_bashforth2(sigma=HALVES), lambda y, h: k * U * (h == 0.75)), LEFT, (5100, 5320)),
    (lambda k: beside(Remembering("adams_moulton2", rk4), lambda y, h: k * U), LEFT, (2.6e9, 2.7e9)),
    (lambda k: beside(predicted_and_corrected(), lambda y, h: k * U * np.eye(len(y))[0]), "solved to", (1395, 1430)),
]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("made", "words", "places"), BOUNDS, ids=range(len(BOUNDS)))
def test_what_may_be_rounding_has_a_bound(made, words, places):
    assert parted(lambda subject: read_recurrence(MarkedRuns.of(subject)).name, made, words, places)


def test_a_corrector_whose_slope_is_taken_a_step_too_early_is_said_to_be_that():
    def early(f, t, y, h):
        return step(lambda at, x: f(t if at == t + h else at, x), t, y, h)

    step = Corrected("adams_moulton3", rk4, BASHFORTH4).step
    said = "adams_moulton3 except for sigma[3]: the slope that it weighs is taken a step too early, as that of sigma[2]"
    assert said in read_recurrence(MarkedRuns.of(opened(early))).name


def test_a_coefficient_is_told_from_another_by_four_roundings_or_what_it_was_read_to():
    method = FURTHER_METHODS["adams_bashforth2"]
    exact, units = Recurrence.of(method, BINARY64), "units in its last place away)"
    off = f"sigma[0]: -0.4999999999999995 instead of -1/2 (about 9 {units}"
    for sigma, found in (
        ((-0.5 + 4 * U, 1.5 + 6 * U, 0.0), ()),
        ((-0.5 + 4.5 * U, 1.5 + 8 * U, 0.0), (off, f"sigma[1]: 1.5000000000000009 instead of 3/2 (about 4 {units}")),
        ((1.0, 2.0, 3.0), None),
    ):
        assert replace(exact, sigma=sigma).differences(method) == found
    assert replace(exact, sigma=(-0.5 + 90 * U, 1.5, 0.0), error=90 * U).differences(method) == ()
    bdf2 = FURTHER_METHODS["bdf2"]  # its last rho is 3/2
    told = replace(Recurrence.of(bdf2, BINARY64), sigma=(0.0, 0.0, 0.75)).differences(bdf2)
    assert told == ("sigma[2]: 3/4 instead of 2/3",)
    assert (
        exact.differences(FURTHER_METHODS["adams_bashforth3"]) is exact.differences(FURTHER_METHODS["stormer2"]) is None
    )


class Late(Remembering):
    """Two steps by another method more than it needs."""

    def step(self, f, t, y, h):
        """One step."""
        after = super().step(f, t, y, h)
        return after if len(self.states) > 3 else rk4(f, t, y, h)


LINES = [
    (predicted_and_corrected(), -2, "F is evaluated at the prediction of adams_bashforth4 and at the states returned"),
    (Late("adams_bashforth2", rk4), -2, "the first 3 steps differ"),
    (adams_bashforth2(sigma=[0.0, 1.0, 0.0]), -2, "the first step differs"),
    (Remembering("bdf2", euler, most=2), 0, "bdf2: satisfied to 1.6e-09, the accuracy of its solver, in runs of 40"),
]


@pytest.mark.parametrize(("made", "place", "line"), LINES, ids=range(len(LINES)))
def test_what_was_read_is_shown(made, place, line):
    assert read_recurrence(MarkedRuns.of(opened(made.step))).lines[place].startswith(line)
