"""The objects that a state comes in: which were tried is said, and what is right in one of them alone fails."""

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.judging.specification import Domain, Specification
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


def moved_in_place(f, t, y, h):
    """Forward Euler, which changes an array and no float."""
    y += h * f(t, y)


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


def in_place_with_the_time(f, t, y, h):
    in_place(f, t, y, h)
    return t + h


def with_the_time(f, t, y, h):
    return {"t": t + h, "y": codes.rk4(f, t, y, h)}


def with_a_time_too_late(force, q, v, t, h):
    return {"t": t + h + (t > 0), "q": q + h * v, "v": v + h * force(q, t)}


FOUND = {
    "in place, and the time": (in_place_with_the_time, "rk4", True),
    "a record of time and state": (with_the_time, "rk4", True),
    "a record of a wrong time": (with_a_time_too_late, "forward_euler", False),
    "arrays": (codes.rk4, "rk4", True),
    "a buffer of answers": (answered_in_a_buffer, "rk4", True),
    "in place": (in_place, "rk4", True),
    "moved in place": (moved_in_place, "forward_euler", True),
    "in place and returned": (in_place_and_returned, "rk4", True),
    "sequences": (one_by_one, "heun2", True),
    "floats": (codes.velocity_verlet, "velocity_verlet", True),
    "one number": (codes.rk4_of_one_number, "rk4", True), "a buffer of stages": (in_a_buffer, "rk4", False),
    "spoilt": (spoiling, "rk4", False), "spoilt by name": (spoiling_by_name, "rk4", False),
    "spoilt later": (spoiling_at_the_second_call, "rk4", False),
    "arrays alone": (twice_a_list, "ralston2", False), "lists alone": (copied_as_a_list, "midpoint2", False),
    "(v, q)": (velocity_first, "velocity_verlet", False), "another": (codes.rk4, "heun2", None),
}  # fmt: skip


@pytest.mark.parametrize(("step", "key", "holds"), FOUND.values(), ids=FOUND)
def test_the_objects_of_a_state_are_told_and_what_depends_on_them_fails(step, key, holds, as_before):
    asked = Asked(step)
    passed, said, _ = state_objects(opened(asked.code), Specification(METHODS[key]))
    assert passed is holds, said
    as_before(said, asked)


# Beyond where a caller forbids them, none of the ordinary steps is taken.
@pytest.mark.parametrize("array", [None, np.float32])
def test_the_objects_of_a_small_domain_are_asked_within_it(array, as_before):
    asked = Asked(codes.velocity_verlet)
    domain = Domain(largest_step=0.06, largest_state=1.0, smallest_step=0.0)
    narrow = Specification(METHODS["velocity_verlet"], domain=domain)
    passed, said, _ = state_objects(opened(asked.code, array=array), narrow)
    assert passed is True
    as_before(said, asked)


@pytest.mark.slow
def test_the_verdict_is_that_of_the_object_and_says_which(as_before):
    verdicts = []
    for name in ("a buffer of stages", "arrays alone", "lists alone", "(v, q)"):
        report = verify(*FOUND[name][:2], examples=FEW, isolate=False)
        assert report.passed is False, report
        verdicts.append(report.verdict)
    as_before(*verdicts, *verify(one_by_one, "heun2", examples=FEW, isolate=False).section("State: passed").lines)
    assert verify(twice_a_list, "ralston2", array=np.array, examples=FEW, isolate=False).passed
