"""The objects that a state comes in: which were tried is said, and what is right in one of them alone fails."""

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.judging.agreement import Domain
from driftproof.blackbox.judging.state_objects import state_objects
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked

FEW = 50
KEPT = np.empty(64)


def in_a_buffer(f, t, y, h):
    """RK4 that forms its stages in the array that it returns, and so in y, where that is its last answer."""
    place, k1 = KEPT[: len(y)], np.array(f(t, y))
    place[:] = y + h / 2 * k1
    k2 = np.array(f(t + h / 2, place))
    place[:] = y + h / 2 * k2
    k3 = np.array(f(t + h / 2, place))
    place[:] = y + h * k3
    place[:] = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(t + h, place))
    return place


def answered_in_a_buffer(f, t, y, h):
    KEPT[: len(y)] = codes.rk4(f, t, np.array(y), h)
    return KEPT[: len(y)]


def spoiling(f, t, y, h):
    end = codes.rk4(f, t, y, h)
    y[:] = 0
    return end


def spoiling_by_name(f, t, *, y, h):
    return spoiling(f, t, y, h)


def spoiling_at_the_second_call(f, t, y, h, calls=[]):  # noqa: B006
    calls.append(t)
    return spoiling(f, t, y, h) if len(calls) > 1 else codes.rk4(f, t, y, h)


def in_place(f, t, y, h):
    y[:] = codes.rk4(f, t, np.array(y), h)


def in_place_and_returned(f, t, y, h):
    in_place(f, t, y, h)
    return y


def one_by_one(f, t, y, h):
    """Heun's method, number by number."""
    k1 = f(t, y)
    ends = f(t + h, [a + h * b for a, b in zip(y, k1, strict=True)])
    return [a + h / 2 * (b + c) for a, b, c in zip(y, k1, ends, strict=True)]


def twice_a_list(f, t, y, h):
    """Ralston's method, where two times a slope is not the slope two times."""
    k1 = f(t, y)
    k2 = f(t + 2 * h / 3, [a + 2 * h / 3 * b for a, b in zip(y, k1, strict=True)])
    return [a + h / 4 * (b + c + d) for a, b, c, d in zip(y, k1, 2 * k2, k2)]  # noqa: B905


def copied_as_a_list(f, t, y, h):
    """The midpoint rule, where a slice is a copy."""
    middle = y[:]
    for i, k in enumerate(f(t, y)):
        middle[i] += h / 2 * k
    return [a + h * k for a, k in zip(y, f(t + h / 2, middle), strict=True)]


def velocity_first(state, h):
    v, x = state
    v = v - h * x / 2
    x = x + h * v
    return [v - h * x / 2, x]


ARRAYS_ONLY = "the state is given as NumPy arrays; lists and tuples are refused; steps go on from the very object"
FOUND = {
    "arrays": (codes.rk4, "rk4", True, ARRAYS_ONLY),
    "a buffer of answers": (answered_in_a_buffer, "rk4", True, ARRAYS_ONLY),
    "in place": (in_place, "rk4", True, ARRAYS_ONLY),
    "in place and returned": (in_place_and_returned, "rk4", True, ARRAYS_ONLY),
    "sequences": (one_by_one, "heun2", True, "given as NumPy arrays; lists and tuples give the same bits"),
    "floats": (codes.velocity_verlet, "velocity_verlet", True, "as Python floats, several positions as NumPy arrays"),
    "one number": (codes.rk4_of_one_number, "rk4", True, "the state is given as Python floats"),
    "a buffer of stages": (in_a_buffer, "rk4", False, "from the very object that the step before returned it is no "),
    "spoilt": (spoiling, "rk4", False, "it spoils its arguments: what it was given is neither what it was nor "),
    "spoilt by name": (spoiling_by_name, "rk4", False, "it spoils its arguments: "),
    "spoilt later": (spoiling_at_the_second_call, "rk4", False, "it spoils its arguments: "),
    "arrays alone": (twice_a_list, "ralston2", False, "the state is given as NumPy arrays; of lists it is another st"),
    "lists alone": (copied_as_a_list, "midpoint2", False, "it is where the state comes as lists; the state is given a"),
    "(v, q)": (velocity_first, "velocity_verlet", False,
        "it is where the state comes as (v, q) in NumPy arrays; write: "),
    "another": (codes.rk4, "heun2", None, "the state is given as NumPy arrays"),
}  # fmt: skip


@pytest.mark.parametrize(("step", "key", "holds", "words"), FOUND.values(), ids=FOUND)
def test_the_objects_of_a_state_are_told_and_what_depends_on_them_fails(step, key, holds, words, as_before):
    asked = Asked(step)
    passed, said, _ = state_objects(opened(asked.code), METHODS[key])
    assert passed is holds, said
    assert words in said
    as_before(said, asked)


# Beyond where a caller forbids them, none of the ordinary steps is taken.
@pytest.mark.parametrize("array", [None, np.float32])
def test_the_objects_of_a_small_domain_are_asked_within_it(array, as_before):
    asked = Asked(codes.velocity_verlet)
    narrow = Domain(largest_step=0.06, largest_state=1.0, smallest_step=0.0)
    passed, said, _ = state_objects(opened(asked.code, array=array), METHODS["velocity_verlet"], domain=narrow)
    assert passed is True
    as_before(said, asked)


def test_the_verdict_is_that_of_the_object_and_says_which():
    scope = verify(one_by_one, "heun2", examples=FEW, isolate=False).section("State: passed").lines[0]
    assert scope.startswith("the state is given as NumPy arrays; lists and tuples give the same bits")
    spoilt = ", but not in the hands of every caller: "
    for step, key, words in (
        (in_a_buffer, "rk4", f"is rk4{spoilt}from the very object "),
        (twice_a_list, "ralston2", f"is ralston2{spoilt}the state is given as NumPy "),
        (copied_as_a_list, "midpoint2", "is not midpoint2; it is where the state comes as lists; "),
        (
            velocity_first,
            "velocity_verlet",
            "is not velocity_verlet; it is where the state comes as (v, q) in NumPy ar",
        ),
    ):
        report = verify(step, key, examples=FEW, isolate=False)
        assert (report.passed, report.verdict.startswith(words)) == (False, True), report
    assert verify(twice_a_list, "ralston2", array=np.array, examples=FEW, isolate=False).passed
