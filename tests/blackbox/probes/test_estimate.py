"""The row of weights of an error estimate is read to the last bit, in whichever form it is returned."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.probes.estimate import ABSOLUTE, DIFFERENCE, NORM, SOLUTION, read_estimate
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.objects import field_stepper_of
from driftproof.methods.catalogue import METHODS
from tests.blackbox.pair_steppers import pair_step
from tests.blackbox.transcripts import Asked


def read(step):
    return read_estimate(opened(step, "field"))


def relative(y1, error, h, y):
    return y1, error / (1e-6 + 1e-3 * np.maximum(abs(y), abs(y1)))


FORMS = {
    "a difference": (lambda y1, error, h, y: (y1, error), DIFFERENCE, 1),
    "the other result": (lambda y1, error, h, y: (y1, y1 - error), SOLUTION, 1),
    "the other sign": (lambda y1, error, h, y: (y1, -error), DIFFERENCE, -1),
    "absolute": (lambda y1, error, h, y: (y1, abs(error)), ABSOLUTE, -1),
    "root mean square": (lambda y1, error, h, y: (y1, np.sqrt(np.mean(error**2))), NORM, -1),
    "the largest": (lambda y1, error, h, y: (y1, max(abs(error))), NORM, -1),
}


@pytest.mark.parametrize("key", ["bogacki_shampine32", "fehlberg45", "dop853"])
@pytest.mark.parametrize("name", FORMS)
def test_the_row_comes_out_as_it_went_in(key, name, as_before):
    answer, form, sign = FORMS[name]
    asked = Asked(pair_step(key, answer))
    reading, pair = read(asked.code), METHODS[key]
    as_before([float(e) for e in reading.row], reading.sizes, asked)
    assert (reading.form, reading.power, reading.relative) == (form, 1, False)
    signs = (1, -1) if sign < 0 and form != DIFFERENCE else (sign,)  # of absolute values up to a common one
    exact = [x - y for x, y in zip(pair.b, pair.b_embedded, strict=True)]
    off = [max(abs(e - s * x) for e, x in zip(reading.row, exact, strict=True)) for s in signs]
    # Each weight is rounded once, and so is y1 - error where that is returned: half a unit of numbers below 8 each.
    assert min(off) <= 3 * 8 * Fraction(1, 2**53)


def test_a_result_of_one_number_that_equals_the_time_at_the_end_is_no_time():
    def midpoint(f, t, y, h):
        first = f(t, y)
        slope = f(t + h / 2, math.fsum([y, h / 2 * first]))
        return y + h * slope, h * (slope - first)

    reading = read(midpoint)
    assert (reading.form, reading.row, reading.fault) == (DIFFERENCE, (-1, 1), "")
    assert read_tableau(opened(midpoint)).remarks == ()
    several = opened(lambda f, t, y, h: (y + h * f(t, y), 0 * y))
    assert several.step_field(lambda t, y: [1.0], 0.0, [0.0], 1.0) == [1.0]
    assert several.log.beside == [0.0]


ASKED = {
    "per unit step": lambda y1, error, h, y: (y1, error / h),
    "relative": relative,
    "nothing": lambda y1, error, h, y: (y1, 0 * y),
    "squared in h": lambda y1, error, h, y: (y1, error * h),
    "of most numbers": lambda y1, error, h, y: (y1, max(abs(error[:-1]), default=abs(error[0]))),
    "absolute per unit step": lambda y1, error, h, y: (y1, abs(error / h)),
    "the other result of the first": lambda y1, error, h, y: (y1, np.append((y1 - error)[:1], y1[1:])),
    "at some steps only": lambda y1, error, h, y: (y1, error) if np.all(y < 4) else y1,
    "with a drift": lambda y1, error, h, y: (y1 - h, error),
}
SPOILED = {
    "as it is": lambda e: e,
    "shifted": lambda e: e + 1.0,
    "exchanged": lambda e: e[..., ::-1],
    "limited": lambda e: np.minimum(e, 0.01),
    "squared": lambda e: e**2,
}


def spoiled(form, spoil):
    def answer(y1, error, h, y):
        end, beside = form(y1, error, h, y)
        return end, spoil(np.atleast_1d(beside))

    return answer


ASKED |= {f"{way}, {name}": spoiled(FORMS[name][0], SPOILED[way]) for way in SPOILED for name in FORMS}


@pytest.mark.parametrize("name", ASKED)
def test_all_that_is_asked_of_an_estimate_and_said_is_as_before(name, as_before):
    asked = Asked(pair_step("bogacki_shampine32" if ", " in name else "fehlberg45", ASKED[name]))
    try:
        found = read(asked.code)
        row = [float(x) for x in found.row]
        as_before(found.form, found.power, found.relative, found.fault, row, found.sizes, asked)
    except NotReadable as refusal:
        as_before(refusal, asked)


def refusing(refused):
    """Bogacki and Shampine's pair, which refuses some lengths of steps."""

    def step(f, t, y, h):
        if refused(h):
            raise ValueError("not so long")
        return pair_step("bogacki_shampine32")(f, t, y, h)

    return step


def test_a_pair_that_steps_no_way_back_is_read_and_one_that_steps_ahead_at_times_is_not():
    assert read(refusing(lambda h: h < 0)) == read(pair_step("bogacki_shampine32"))
    with pytest.raises(Misbehaviour, match="not so long"):
        read(refusing(lambda h: h == 2.0**-6))


def test_an_estimate_that_is_halved_at_large_states_is_wrong_there_and_not_relative():
    found = read(pair_step("fehlberg45", lambda y1, error, h, y: (y1, error / (1 + (max(abs(y)) > 4)))))
    assert (found.relative, found.fault[:18]) == (False, "with another start")


def test_an_object_keeps_its_estimate_in_an_attribute():
    class Solver:
        def __init__(self, f):
            self.f, self.t, self.y, self.estimate = f, 0.0, None, None

        def step(self, h):
            self.y, self.estimate = pair_step("bogacki_shampine32")(self.f, self.t, self.y, h)

    step = field_stepper_of(Solver, state="y", time="t", error="estimate")
    assert read(step).row == read(pair_step("bogacki_shampine32")).row
