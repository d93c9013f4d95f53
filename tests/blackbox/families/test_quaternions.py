"""Quaternion steps: the factor 1/2, the product, the length and the order, from one matrix of a linear test."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.families.quaternions import read_quaternion
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes
from tests.blackbox.families.bounds import U, parted


def test_length_and_order_are_told():
    def lines(step):
        return dict(read_quaternion(opened(step)).parts)["Rotation"]

    for step, length, order in (
        (RK4, "its length is multiplied by 1 - phi^6/144 + ...", "order 4 at a constant omega"),
        (codes.quaternion("forward_euler", unit=True), "the result has length 1, whatever the input",
         "order 2 at a constant omega"),
        (codes.turned_by(lambda x: x), "its length is kept to rounding", "no error"),
    ):  # fmt: skip
        assert lines(step)[1:] == [length, order]


def test_a_step_is_held_to_a_method_by_its_factor():
    assert verify(codes.quaternion("rk4"), "rk4", isolate=False).passed
    assert verify(codes.quaternion("rk38"), "rk4", isolate=False).passed  # a linear test tells no more
    for step, key in (
        (codes.quaternion("kutta3"), "rk4"),
        (codes.one_sign, "forward_euler"),
        (codes.quaternion("forward_euler"), "symplectic_euler"),
        (codes.quaternion("forward_euler", lambda q, w: 2 * codes.body(q, w)), "forward_euler"),
    ):
        report = verify(step, key, isolate=False)
        assert report.passed is False
        assert report.verdict.startswith(f"is not {key}; it is ")


def test_what_is_no_linear_step_is_a_fault_and_what_remembers_is_refused():
    bent = read_quaternion(opened(lambda q, omega, dt: q + dt * codes.body(q, omega) * np.dot(q, q)))
    assert "not linear in q" in bent.faults[0]
    seen = []

    def remembering(q, omega, dt):
        seen.append(q)
        return q + dt * len(seen) * codes.body(q, omega)

    with pytest.raises(NotReadable, match="taken twice"):
        read_quaternion(opened(remembering))


RK4, UNIT, X = codes.quaternion("rk4"), codes.quaternion("rk4", unit=True), np.eye(4)[1]
# Steps that are off by k, what is said of one that is off too far, and k before and behind the bound.
BOUNDS = [
    # 4 (12 + 2) roundings of numbers of size 8: the step is linear in q, or its length is 1 whatever goes in.
    (lambda k: lambda q, w, dt: RK4(q, w, dt) + k * U * np.dot(q, q) * X, "not linear in q", (220, 227)),
    (lambda k: lambda q, w, dt: UNIT(q, w, dt) * (1 + k * U), "not make its length 1", (442, 455)),
    (lambda k: lambda q, w, dt: UNIT(q, w * (1 + k * U * np.dot(q, q)), dt), "not make its length 1", (586, 606)),
    # Of size 8 (1 + |R|): a matrix beside the two of a rotation, and a rotation by another angle.
    (lambda k: lambda q, w, dt: RK4(q, w, dt) + k * U * q[0] * X, "is not a rotation about omega", (786, 808)),
    (lambda k: lambda q, w, dt: RK4(q, w * (1 + k * U * (dt == 0.25)), dt), "depends on more than h |om", (318, 328)),
    # Of a rate as large as 1/2, 2^-6 (1 + 1/2); of a step at rest, 2^-6.
    (lambda k: lambda q, w, dt: q + dt * (codes.body(q, w) + k * q[0] * X), "not a product of q", (0.0233, 0.0237)),
    (lambda k: lambda q, w, dt: RK4(q, w, dt) + k * (not any(w)), "with omega = 0, (0.5", (0.0155, 0.0158)),
]


@pytest.mark.parametrize(("made", "words", "places"), BOUNDS, ids=range(len(BOUNDS)))
def test_what_may_be_rounding_has_a_bound(made, words, places):
    assert parted(lambda subject: "; ".join(read_quaternion(subject).faults), made, words, places)


def test_a_length_that_is_made_another_is_undecided_and_a_rotation_by_the_length_fails():
    words = "the step is not linear in q, and does not make its length 1"
    before = lambda q, w, dt: RK4(q / np.linalg.norm(q), w, dt)
    for step in (lambda q, w, dt: 2 * UNIT(q, w, dt), before):
        report = verify(step, "rk4", isolate=False)
        assert (report.passed, report.verdict) == (None, f"undecided whether it is rk4: {words}")
    by_length = lambda q, w, dt: UNIT(q, w * np.linalg.norm(q), dt)
    report = verify(by_length, "rk4", isolate=False)
    assert (report.passed, report.verdict) == (False, f"is not rk4; it is not a known quaternion step; {words}")
    assert identify(by_length, isolate=False).answered is False


def test_programs_are_told_the_method_the_product_and_how_fast_it_turns():
    def data(step):
        return tuple(read_quaternion(opened(step)).data.values())

    once, names = "q omega (scalar first)", ("method", "product", "rotation", "order", "normalised", "scale")
    assert tuple(read_quaternion(opened(RK4)).data) == names
    back = codes.quaternion("kutta3", lambda q, w: -codes.space(q, w))
    assert data(back)[:2] == ("kutta3", "-omega q (scalar first)")
    for product, rate in ((once, codes.body), ("omega q (scalar first)", codes.space)):
        last = lambda q, w, rate=rate: np.roll(rate(np.roll(q, 1), w), -1)
        assert data(codes.quaternion("kutta3", rate))[1] == product
        assert data(codes.quaternion("kutta3", last))[1] == product.replace("first", "last")
    assert data(UNIT) == (None, once, "rk4, normalised to length 1", 4, True, "1")
    assert data(codes.turned_by(lambda x: x)) == (None, once, "exact", None, False, "1")
    halved = codes.turned_by(lambda x: 4 * np.arctan(x / 4))
    assert data(halved)[:3] == (None, once, "implicit_midpoint in 2 equal parts")
    assert data(codes.turned_by(lambda x: 0.3 * x))[3:] == (0, False, "0.3")
    assert data(lambda q, w, dt: np.array(q))[1:] == (once, "not a known rotation", 0, False, "0")
    assert data(lambda q, w, dt: RK4(q, w, dt) + (not any(w)))[0] is None
    assert data(codes.one_sign) == (None, None, "not a known rotation", 0, False, "0")


def test_a_method_that_makes_the_length_one_passes_as_itself_alone():
    assert verify(UNIT, "rk4", isolate=False).verdict.startswith("is rk4, normalised to length 1, of q' = q omega/2")
    euler = lambda q, w, dt: (lambda y: y / np.linalg.norm(y))(q + dt * codes.body(q, w))
    assert verify(euler, "forward_euler", isolate=False).passed
    assert verify(euler, "heun2", isolate=False).passed is False
    assert verify(lambda q, w, dt: UNIT(q, w / 2, dt), "rk4", isolate=False).passed is False


HELD = lambda q, gyro, t, dt: RK4(q, gyro(t), dt)
TIMED = [
    (codes.of_function("rk4"), "rk4", True, "is rk4 of q' = q omega/2 (scalar first)"),
    (
        codes.of_function("rk38", unit=True),
        "rk38",
        True,
        "is rk38, normalised to length 1, of q' = q omega/2 (scalar f",
    ),
    (codes.of_function("rk38"), "rk4", False, "is not rk4: where omega depends on t, the step is not that of rk4"),
    (codes.of_function("rk4", 0.0, unit=True), "rk4", False, "is not rk4: where omega depends on t, the step is not"),
    (codes.of_function("forward_euler"), "forward_euler", True, "is forward_euler of q' = q omega/2 (scalar first)"),
    (HELD, "rk4", True, "is rk4 of q' = q omega/2 (scalar first), omega constant"),
    (RK4, "rk4", True, "is rk4 of q' = q omega/2 (scalar first), omega constant"),
]


@pytest.mark.parametrize(("step", "key", "passed", "words"), TIMED, ids=range(len(TIMED)))
def test_an_angular_velocity_that_is_a_function_of_t_shows_the_times_of_the_stages(step, key, passed, words):
    report = verify(step, key, isolate=False)
    assert (report.passed, report.verdict.startswith(words)) == (passed, True), report.verdict
    mistimed = identify(step, isolate=False).data["faults"]
    assert ["no step of rk4 nor of another" in fault for fault in mistimed] == [True] * (step is TIMED[3][0])


def test_a_rate_that_is_none_is_shown_beside_the_nearest():
    report = verify(codes.one_sign, "forward_euler", isolate=False)
    (off,) = report.section("Rotation: FAILED").lines
    assert off == "not a known rotation: off the factor of forward_euler by 0.62 at the angle 2"
    rate = "at omega = (2, 3, 6)/7 the rate of q[3] takes 0.143 q[2], that of q omega (scalar first) -0.143 q[2]"
    assert report.section("Rate: FAILED").lines == (f"its rate is not a product of q and omega: {rate}",)
    assert verify(RK4, "rk4", isolate=False).section("Rate: passed").lines == ("that of q' = q omega/2 (scalar first)",)
