"""The tableau of a float code is read to the last bit, and where there is none, what was seen is said."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.probes.scripted_answers import Control, NotReadable, Rounding
from driftproof.blackbox.probes.tableau import ScriptedStep, TableauProbe, read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked


def read(step):
    return read_tableau(opened(step, "field"))


coefficients = st.floats(-4, 4, allow_subnormal=False).filter(lambda x: x == 0 or abs(x) > 1e-6)


@st.composite
def tableaux(draw):
    stages = draw(st.integers(1, 6))
    rows = [draw(st.lists(coefficients, min_size=i, max_size=i)) for i in range(stages)]
    a = tuple((*row, *[0.0] * (stages - len(row))) for row in rows)
    b, c = (tuple(draw(st.lists(coefficients, min_size=stages, max_size=stages))) for _ in range(2))
    return a, b, c


def test_a_step_that_moves_at_rest_is_refused_with_the_number_that_moves():
    with pytest.raises(NotReadable, match=r"does not stay 0: the step goes through 0\.25$"):
        read(lambda f, t, y, h: y + h * f(t, y) + h * np.array([0.0, *[0.25] * (len(y) - 1)]))


@given(tableaux())
@settings(max_examples=40)
def test_any_tableau_comes_out_as_it_went_in(given_tableau):
    a, b, c = given_tableau
    reading = read(codes.tableau(a, b, c))
    assert (reading.a, reading.b, reading.c) == (a, b, c)


def iterated_to_the_end(f, t, y, h):
    k = f(t, y)
    for _ in range(100):
        before, k = k, f(t + h / 2, y + h / 2 * k)
        if np.max(np.abs(k - before)) < 1e-12:
            break
    return y + h * k


def adaptive(f, t, y, h):
    low, high = codes.euler(f, t, y, h), codes.heun(f, t, y, h)
    return high if np.max(np.abs(high - low)) < 1e-3 else codes.repeated(codes.heun, 2)(f, t, y, h)


class Remembering:
    """Calls its right-hand side once fewer from the second step on."""

    def __init__(self):
        self.last = None

    def __call__(self, f, t, y, h):
        k = f(t, y) if self.last is None else self.last
        y1 = y + h * k
        self.last = f(t + h, y1)
        return y + h / 2 * (k + self.last)


class Anticipating:
    """Starts from where the first slope of the step before would have led."""

    kept = 0.0

    def step(self, f, t, y, h):
        self.kept = first = f(t, y + h * self.kept)
        return y + h * f(t + h, y + h * first)


def slightly_nonlinear(f, t, y, h):
    k = f(t, y)
    return y + h * k + 1e-12 * h * k**3


def refusing(f, t, y, h):
    raise ValueError(f"no {len(y)} numbers")


def endless(f, t, y, h):
    while True:
        f(t, y)


def forwards(f, t, y, h):
    if h < 0:
        raise ValueError("h must be positive")
    return codes.heun(f, t, y, h)


def raising(f, t, y, h):
    if h == 3:
        raise RuntimeError("three")
    return codes.euler(f, t, y, h)


ASKED = {f"rk4{way}": vars(codes)[f"rk4{way}"] for way in ("", "_in_lists", "_of_one_number", "_on_a_stopped_clock")}
ASKED |= {"convex combinations": codes.ssprk33_in_convex_combinations, "forwards": forwards, "raising": raising}
ASKED |= {f"rk4 in {kind.__name__}": codes.in_precision(codes.rk4, kind) for kind in (np.float32, np.float16)}
ASKED |= {"without a sign": lambda f, t, y, h: codes.heun(f, t, y, abs(h))}
# Their trial steps would not do.
UNTRIED = {
    "remembering": Remembering(), "anticipating": Anticipating().step, "adaptive": adaptive, "refusing": refusing,
    "iterated_to_the_end": iterated_to_the_end, "slightly_nonlinear": slightly_nonlinear, "endless": endless,
    "symplectic_euler_in_a_field": codes.symplectic_euler_in_a_field,
    "never calls": lambda f, t, y, h: y,
    "without_h": lambda f, t, y, h: y + f(t, y),
    "limited": lambda f, t, y, h: y + h * np.clip(f(t, y), -2, 2),
    "crossed": lambda f, t, y, h: y + h * np.roll(f(t, y), 1),
    "falling": lambda f, t, y, h: y + h * (f(t, y) - 9.81),
    "wandering": lambda f, t, y, h: y * 0.99 + h * f(t, y),
    "aware_of_the_time": lambda f, t, y, h: y + h * f(t, y) * (2 if t > 1 else 1),
}  # fmt: skip


@pytest.mark.parametrize("name", [*ASKED, *UNTRIED])
def test_all_that_is_asked_of_a_step_and_said_is_as_before(name, as_before):
    asked = Asked((ASKED | UNTRIED)[name])
    subject = opened(codes.euler if name in UNTRIED else asked.code, "field")
    if name in UNTRIED:
        subject.function = asked.code
    try:
        reading = read_tableau(subject)
        as_before(reading, *reading.lines, asked)
    except (NotReadable, Misbehaviour) as refused:
        as_before(type(refused).__name__, refused, asked)


# Of Heun's method, whose first slope is taken once, in a stage, and the second by half.
@pytest.mark.parametrize(("share", "held"), [(0.95, True), (1.05, False)])
@pytest.mark.parametrize("place", range(5))
def test_a_control_may_be_off_by_the_rounding_of_all_that_it_adds(place, share, held):
    probe, control = TableauProbe(opened(codes.heun, "field"), 1.0), Control("", "", h=-0.75, time=-3.0)
    reading, y, slopes = probe.reading(), -7.0, [-5.0, 11.0]
    seen, times = [y, y - 0.75 * slopes[0], y - 0.75 * sum(slopes) / 2], [-3.0, -3.75]
    if place < 3:
        seen[place] += share * probe.rounding.of(2 * (7 + 0.75 * (5 + 11 / 2)))
    else:
        times[place - 3] -= share * probe.rounding.of(2 * (3 + 0.75))
    with nullcontext() if held else pytest.raises(NotReadable):
        probe._compare(reading, control, y, slopes, seen)
        probe._compare_times(reading.c, control, ScriptedStep(times, [], []))
    assert replace(reading, stage_error=2.0**-30).rounding == Rounding(BINARY64, 2, 2.0**-28)
