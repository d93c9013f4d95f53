"""Which Rosenbrock method a step is; one entry, a missing df/dt and a late Jacobian are told, right ones pass."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from driftproof.blackbox.families.rosenbrock import read_rosenbrock
from driftproof.blackbox.identify import identify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.rosenbrock import Rosenbrock
from tests.blackbox.families.bounds import U
from tests.blackbox.families.linearised_steppers import linearly_implicit_euler, ros2_by_hand, rosenbrock
from tests.blackbox.families.split_steppers import imex
from tests.blackbox.transcripts import to_twelve_digits
from tests.looping import some

KEYS = [key for key, method in FURTHER_METHODS.items() if isinstance(method, Rosenbrock)]


# How a step is written: all of them for one method, and one of them, in turn, for each other.
HOW = ({}, {"reuse": True}, {"stored": True}, {"time_slope": "differences"})
WRITTEN = {*((KEYS[0], n) for n in range(len(HOW))), *((key, n % len(HOW)) for n, key in enumerate(KEYS))}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "how"), [(key, HOW[n]) for key, n in sorted(WRITTEN)], ids=str)
def test_a_method_passes_however_it_is_written(key, how):
    report = verify(rosenbrock(key, **how), key, isolate=False)
    assert report.passed, report.text()
    assert report.verdict == f"is {key}"
    used = "differences of f" if "time_slope" in how else "a function of its own"
    assert report.section("Coefficients: passed").lines[-1] == f"df/dt is from {used}"


def test_a_paper_s_own_form_is_the_same_method():
    report = identify(ros2_by_hand, isolate=False)
    assert (report.verdict, report.section("Coefficients").lines[-1]) == ("it is ros2", "f receives no time")


@pytest.mark.parametrize(
    ("key", "how", "words"),
    [
        ("ros3p", {"gamma": ((1, 0), 1.0), "reuse": True}, "is not ros3p; it is not a known"),
        ("ros2", {"b": (0, 2 / 3)}, "is not ros2; it is not a known"),
        ("rodas3", {"alpha": ((2, 0), 0.5)}, "is not rodas3; it is not a known"),
        ("grk4t", {"gamma": ((3, 2), -0.1112)}, "is not grk4t; it is not a known"),
        ("grk4t", {"time_slope": "none"}, "df/dt is left out: order 1 is observed where f depends on t, not 4"),
        ("ros3p", {"time_slope": "twice"}, "df/dt enters with other weights than the row sums of gamma"),
        ("ros3p", {"at_end": True}, "the Jacobian is evaluated at t + 1 h, and 0 from y, not at the start"),
    ],
)
def test_a_wrong_one_fails_with_its_cause(key, how, words):
    report = verify(rosenbrock(key, **how), key, isolate=False)
    assert report.passed is False
    assert words in report.verdict
    assert report.section("Steps: FAILED") is None


def test_the_other_root_of_the_equation_for_gamma_is_as_good_where_both_have_the_name_and_no_other_gamma():
    for g, passed in ((1 + 2**-0.5, True), (0.5, False)):
        report = verify(lambda y, f, jac, h, g=g: ros2_by_hand(y, f, jac, h, g), "ros2", isolate=False)
        assert report.passed is passed
        assert (
            "is ros2 with gamma[0][0] = 1 + 1/2*sqrt(2), the other root of its equation" in report.verdict
        ) is passed
    g, root = 1 + 2**-0.5, -(2**0.5)
    gamma = {(0, 0): g, (1, 0): -g, (1, 1): g, (2, 0): g * (4 + root), (2, 1): -g * (6 + root), (2, 2): g}
    places = (np.array([each[i] for each in gamma]) for i in (0, 1))
    other = rosenbrock("ode23s", gamma=(tuple(places), [*gamma.values()]))
    assert verify(other, "ode23s", isolate=False).verdict.startswith("is not ode23s; it is not a known")


def test_of_several_wrong_entries_the_products_are_told_in_which_they_stand():
    report = verify(rosenbrock("rodas3", gamma=((2, 0), 1.5), b=(0, 2 / 3)), "rodas3", isolate=False)
    wrong = report.section("Coefficients: FAILED").lines
    assert len(wrong) == 7
    assert wrong[1] == "the slope of call 0 enters the result with 1/2 instead of 0.666667"
    assert wrong[2] == "J h^2 times the slope of call 0 enters the argument of call 2 with 5/8 instead of -0.25"
    assert wrong[4] == "J^2 h^3 times the slope of call 0 enters the argument of call 2 with 3/8 instead of -0.5"


def test_a_w_method_may_leave_out_the_derivative_by_t():
    report = verify(rosenbrock("ros2", time_slope="none"), "ros2", isolate=False)
    assert (report.passed, report.section("Coefficients: passed").lines[-1]) == (True, "no df/dt")


@pytest.mark.parametrize(("most", "key"), [(2, "ros3p"), (3, "rodas3"), (2, "ros2"), (4, "rodas3")])
def test_as_many_numbers_tell_no_more_than_as_many_powers_of_gamma(most, key):
    whole = rosenbrock(key)

    def of_few(f, jac, dfdt, t, y, h):
        if len(y) > most:
            raise ValueError("too many numbers")
        return whole(f, jac, dfdt, t, y, h)

    report, stages = verify(of_few, key, isolate=False), len(FURTHER_METHODS[key].b)
    if most >= stages:
        assert identify(of_few, isolate=False).verdict == f"it is {key}"
        assert report.passed
        return
    assert identify(of_few, isolate=False).verdict == f"it is, judging by {most} components, {key}"
    assert report.passed is None
    assert f"a stepper of {stages} components" in report.section("What would decide it").lines[0]


def test_an_unknown_one_is_shown_with_its_coefficients_and_what_it_needs():
    report = identify(linearly_implicit_euler, isolate=False)
    assert report.verdict == "it is not a known Rosenbrock method, of order 1 as measured"
    assert "gamma[0] = 1" in report.section("Coefficients").lines
    assert "order 1 is observed with half of f' as J" in report.section("Order").lines[1]


def test_a_method_of_somebody_s_own_is_held_to_its_own_products():
    """Of one that has ROS2's places, and others of its gamma; and of as many places as it asks for."""
    own = replace(
        FURTHER_METHODS["ros2"], key="mine", claimed_order=1, gamma=((Fraction(1, 4), 0), (-1, Fraction(1, 4)))
    )
    step = rosenbrock("ros2", gamma=(slice(None), [[0.25, 0.0], [-1.0, 0.25]]))
    assert verify(step, own, isolate=False).verdict == "is mine"
    assert verify(rosenbrock("ros2"), own, isolate=False).passed is False
    other = verify(rosenbrock("ros2"), "rodas3", isolate=False).section("Coefficients: FAILED")
    assert other.lines == ("rodas3 evaluates f at 3 places, this one at 2",)


def test_another_method_and_a_step_without_a_jacobian_are_not_it():
    assert "is not ros3p; it is ros2" in verify(rosenbrock("ros2"), "ros3p", isolate=False).verdict
    report = verify(lambda f, t, y, h: y + h * f(t, y), "ros2", isolate=False)
    assert report.passed is None
    assert report.section("What would decide it").lines == (
        "a stepper that takes a Jacobian, in place of its own differences of f: step(f, jac, t, y, h)",
    )


def test_what_is_read_is_shown_with_the_orders():
    off = identify(rosenbrock("ros3p", gamma=((1, 0), 1.5), alpha=((1, 0), 0.75)), isolate=False)
    diagonal, last = "0.788675134595", "-0.788675134595, -1.07735026919, 0.788675134595"
    rows = f"gamma[0] = {diagonal}|gamma[1] = 3/2, {diagonal}|gamma[2] = {last}|b = 2/3, 0, 1/3"
    shown = to_twelve_digits("|".join(off.section("Coefficients").lines[1:-1]))
    assert shown == f"alpha[1] = 3/4|alpha[2] = 1, 0|{rows}"
    right, seen = identify(rosenbrock("ros2"), isolate=False), "on a nonlinear problem of 4 components, with t"
    slopes, halved = "2.32, 2.87, 3.01, 3.03, 3.02, 3.01, 3.01", "order 2 is observed with half of f' as J"
    orders = f"order 2 with J = f', 2 with any matrix|order 2 is observed with J = f' {seen} "
    orders += f"(slopes of the local error: {slopes})|{halved} {seen}"
    assert "|".join(right.section("Order").lines) == orders
    named = "ros2: products of alpha and b with gamma up to its power 7, to rounding"
    assert right.section("Coefficients").lines[0] == named
    held = verify(rosenbrock("ros2"), "ros2", isolate=False).section("Derivatives: passed")
    assert held.lines == ("J at the start", "df/dt is from a function of its own")
    data = [right.data[name] for name in ("method", "time_slope", "measured_order", "measured_w_order")]
    assert (data, right.data["products"][0][2]) == (["ros2", "a function", 2, 2], ["0.5", "0.5"])


# How far one number of ROS3P may be read off by rounding, in u: of the size of the terms that it is a sum of.
BOUNDS = {
    "weights": {
        (0, 1, 0): 29.0, (0, 2, 0): 101.5, (1, 1, 0): 22.5, (1, 2, 0): 138.7, (2, 1, 0): 17.5, (2, 2, 1): 37.75,
    },
    "time_slope": {(0, 2): 95.8, (1, 1): 17.5, (1, 2): 123.4},
    "nodes": {(0,): 28.0, (1,): 57.0},
}  # fmt: skip


def test_what_may_be_rounding_has_a_bound():
    right = read_rosenbrock(opened(rosenbrock("ros3p")))
    for level, places in some(BOUNDS.items()):
        for place, bound in some(places.items()):
            for k, passes in ((0.97 * bound, True), (1.03 * bound, False)):
                numbers = np.array(getattr(right.reading, level))
                numbers[place] += k * U
                found = replace(right, reading=replace(right.reading, **{level: numbers.tolist()}))
                held = found.criteria(FURTHER_METHODS["ros3p"])[0].passed and not found.faults
                assert held is passes, (level, place, k)


@pytest.mark.slow
@pytest.mark.parametrize(("step", "key"), [(rosenbrock("ros2"), "ros2"), (imex("ars222"), "ars222")])
def test_a_method_with_irrational_entries_is_read_in_an_isolated_process(step, key):
    assert verify(step, key).verdict == f"is {key}"
    assert identify(step).data["method"] == key
