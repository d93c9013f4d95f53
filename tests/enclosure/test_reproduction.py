"""What is enclosed is compared with what floats compute, and functions that are not functions of (t, y) are refused."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from driftproof import certify
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.fields.traced_fields import field_of_function
from driftproof.enclosure.problem_tables import problem_table
from driftproof.enclosure.reproduction import (
    NotReproduced,
    reproduced_field,
    require_reproduced,
    require_reproduced_between,
)


class Breaker:
    """Switches off above 2, for good."""

    def __init__(self):
        self.tripped = False

    def __call__(self, t, y):
        self.tripped = self.tripped or bool(y[0] > 2)
        return [-y[0] if self.tripped else 1.0]


class Clocked:
    """Remembers the last time."""

    def __init__(self):
        self.last = 0.0

    def __call__(self, t, y):
        past, self.last = self.last, t
        return [t - past]


NOISE = np.random.default_rng(5)
OTHERS = {
    "by type": lambda t, y: [1.0] if isinstance(t, float) else [2.0],
    "by scalar": lambda t, y: [1.0 if np.isscalar(t) else 7.0],
    "breaker": Breaker(),
    "clocked": Clocked(),
    "noise": lambda t, y: [NOISE.uniform() - y[0]],
}


@pytest.mark.parametrize("kind", [Breaker, Clocked])
def test_a_state_that_is_kept_and_seen_only_on_enclosed_numbers_is_the_reason(kind):
    with pytest.raises(Refused, match=r"^f keeps a state from call to call[,:]"):
        certify(kind(), [0.0, 0.01], [[1.0], [1.01]])


@pytest.mark.parametrize("name", OTHERS)
def test_a_problem_whose_text_would_be_another_function_is_refused(name):
    with pytest.raises(NotReproduced, match=r"in floats is .* but its enclosure is|in a second call"):
        problem_table({"function": OTHERS[name], "start": ["1"], "end": "4"})


FUNCTIONS = {
    "tank": (lambda t, y: [0.5 - np.sqrt(y[0])], ["0"]),
    "logarithm": (lambda t, y: [np.log(y[0]) / (t - 1)], ["1/2"]),
    "relay": (lambda t, y: [1.0 if y[0] < 1 else 0.25, y[0] * (t % 1 < 0.5)], ["1", "0"]),
    "near a border": (
        lambda t, y: [1.0 if y[0] / 10 < 0.1 else 0.25, np.log(y[1]) if y[1] / 10 > 0.3 else 0.0],
        ["1", "3"],
    ),
    "large": (lambda t, y: [1e200 * y[0], y[1] / (1 + y[0] ** 2)], ["1e-190", "1"]),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_twin_a_function_is_its_text_where_it_has_values(name):
    f, start = FUNCTIONS[name]
    assert len(problem_table({"function": f, "start": start, "end": "2"}).field.rates) == len(start)


def test_places_between_the_points_of_a_run_are_compared():
    bump = lambda t, y: [5.0 if 1 < t < 3 else 1.0]
    with pytest.raises(NotReproduced, match=r"f in floats is 5\.0 at t = "):
        require_reproduced_between(bump, lambda t, y: [1.0], [0.0, 4.0], [[0.0], [12.0]])
    holed = lambda t, y: [np.sqrt(abs(t - 1) - 0.5)]
    require_reproduced_between(holed, enclosable(holed), [0.0, 2.0], [[2.0], [2.0]])


def test_what_depends_on_the_type_of_the_time_is_refused():
    """Of NumPy's truth values + is "or"."""
    negated = lambda t, y: [-(t > 1) * y[0]]  # NumPy's truth values have no negative
    require_reproduced(negated, enclosable(negated), [0.0, 2.0], [[0.0], [1.0]])
    counted = lambda t, y: [1.0 * ((t > 0.5) + (t > 1))]
    with pytest.raises(
        NotReproduced, match=r"f is 2\.0 at .* but 1\.0 in a second call, with the time as a NumPy number"
    ):
        require_reproduced(counted, enclosable(counted), [0.0, 2.0], [[0.0], [1.0]])


def test_points_of_a_run_need_values_and_places_around_a_start_do_not():
    root, other = (lambda t, y: [np.sqrt(y[0])]), (lambda t, y: [np.sqrt(y[0]) * (1 + 2.0**-20)])
    made = lambda: field_of_function(root, 1)
    with pytest.raises(Refused, match="f or its derivative is not finite"):
        require_reproduced(root, enclosable(root), [0.0], [[0.0]])
    assert reproduced_field(root, made, [Fraction(0)], Fraction(1)).rates == ("sqrt(y0)",)
    with pytest.raises(NotReproduced, match="f in floats is"):
        require_reproduced(other, enclosable(root), [0.0], [[2.0]])
    with pytest.raises(ValueError, match=r"unexpected keyword argument 'k'; its parameters are c$"):
        require_reproduced(partial(lambda t, y, c=1: [c], k=2), enclosable(root), [0.0], [[2.0]])
    with pytest.raises(NotReproduced, match="f in floats is"):
        reproduced_field(other, made, [Fraction(0)], Fraction(1))


SWITCHES = {
    "switch": (0.0, lambda t, y: [1 + np.tanh(20 * (t - 3)) - 0.7 * y[0]]),
    "circle": (0.0, lambda t, y: [0.1 * t + np.cos(t + 0.3) ** 2 + np.sin(t + 0.3) ** 2 - 1 - y[0]]),
    "pulse": (0.0, lambda t, y: [np.tanh(50 * (t - 2)) - np.tanh(50 * (t - 3)) - 0.7 * y[0]]),
    "flat": (2e-14, lambda t, y: [1 - np.cos(1e-8 * t) - y[0]]),
    "to integers": (0.4, lambda t, y: [(y[0] + 2.0**52) - 2.0**52]),
    "to 24 bits": (1 / 3, lambda t, y: [(2**29 + 1) * y[0] - ((2**29 + 1) * y[0] - y[0])]),
}


@pytest.mark.parametrize("name", SWITCHES)
def test_what_cancels_may_be_off_by_its_roundings_and_by_no_more(name):
    """Where no digits are left at the largest sizes, either, the float function is another one."""
    last, f = SWITCHES[name]
    run = enclosable(f), [0.0, 3.25], [[last if name.startswith("to") else 0.0], [last]]
    if name.startswith("to") or name == "flat":
        with pytest.raises(NotReproduced, match="keeps no more digits of it"):
            require_reproduced_between(f, *run)
        return
    require_reproduced_between(f, *run)
    for off in (2.0**-44, -(2.0**-44)):
        with pytest.raises(NotReproduced, match=r"at t = 0\.0, component 0, but its enclosure is [][+/ 0-9.e-]*$"):
            require_reproduced_between(lambda t, y, off=off: [f(t, y)[0] + off], *run)
