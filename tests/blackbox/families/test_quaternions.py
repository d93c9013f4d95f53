"""Quaternion steps: the factor 1/2, the product, the length and the order, from one matrix of a linear test."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.families.quaternions import read_quaternion
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes


def test_length_and_order_are_told():
    def lines(step):
        return dict(read_quaternion(opened(step)).parts)["Rotation"]

    assert lines(codes.quaternion("rk4"))[1:] == [
        "its length is multiplied by 1 - phi^6/144 + ...",
        "order 4 at a constant omega",
    ]
    unit = lines(codes.quaternion("forward_euler", unit=True))
    assert unit[1:] == ["what comes out has length 1, whatever goes in", "order 2 at a constant omega"]
    assert lines(codes.turned_by(lambda x: x))[1:] == ["its length is kept to rounding", "no error"]


def test_a_step_is_held_to_a_method_by_its_factor():
    assert verify(codes.quaternion("rk4"), "rk4", isolate=False).passed
    assert verify(codes.quaternion("rk38"), "rk4", isolate=False).passed  # a linear test tells no more
    for step, key in (
        (codes.quaternion("rk4", unit=True), "rk4"),
        (codes.quaternion("kutta3"), "rk4"),
        (codes.one_sign, "forward_euler"),
        (codes.quaternion("forward_euler"), "symplectic_euler"),
        (codes.quaternion("forward_euler", lambda q, w: 2 * codes.body(q, w)), "forward_euler"),
    ):
        report = verify(step, key, isolate=False)
        assert report.passed is False
        assert report.verdict.startswith(f"is not {key}; it is ")


def test_what_is_no_linear_step_is_refused():
    with pytest.raises(NotReadable, match="not linear in q"):
        read_quaternion(opened(lambda q, omega, dt: q + dt * codes.body(q, omega) * np.dot(q, q)))
    seen = []

    def remembering(q, omega, dt):
        seen.append(q)
        return q + dt * len(seen) * codes.body(q, omega)

    with pytest.raises(NotReadable, match="taken twice"):
        read_quaternion(opened(remembering))
