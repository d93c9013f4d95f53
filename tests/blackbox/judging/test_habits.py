"""What a step does besides the method is named: a habit of codes, or the few digits of its coefficients."""

from __future__ import annotations

import pytest

from driftproof.blackbox.judging.habits import explained
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.algebra.certified import fixed, significant

FEW = 200


def yoshida(text):
    """Yoshida's fourth-order splitting with its coefficients typed in, as a map and called with a force."""
    parts = [(kind, float(text(x))) for kind, x in METHODS["yoshida4"].parts]

    def forced(force, q, v, h):
        for kind, x in parts:
            q, v = (q + x * h * v, v) if kind == "drift" else (q, v + x * h * force(q))
        return q, v

    return forced


def as_map(forced):
    return lambda q, v, h: forced(lambda q: -q, q, v, h)


def verlet_by_positions(q, v, h):
    end = q + h * (v - h / 2 * q)
    return end, (end - q) / h - h / 2 * end


def test_a_velocity_that_is_a_difference_of_positions_is_named_in_the_verdict():
    report = verify(verlet_by_positions, "velocity_verlet", examples=FEW)
    named = "is not velocity_verlet to roundoff; it is, if the velocity is a difference of positions over h"
    assert report.verdict == named
    assert not report.passed


@pytest.mark.parametrize(
    ("text", "digits"),
    [
        (lambda x: fixed(x, 14), "14 decimals"),
        (lambda x: significant(x, 13), "13 significant digits"),
        (lambda x: fixed(x, 9), "9 decimals"),
    ],
)
def test_the_digits_of_a_source_are_said_of_a_map_and_of_a_step_with_a_force(text, digits):
    for step in (yoshida(text), as_map(yoshida(text))):
        verdict = verify(step, "yoshida4", examples=FEW).verdict
        assert verdict == f"is not yoshida4 to roundoff; it is, if its coefficients are rounded to {digits}"


def test_another_method_has_no_such_excuse():
    found = explained(opened(as_map(yoshida(float))), METHODS["velocity_verlet"], examples=FEW)
    assert (found.holds, found.but_for) == (False, "")
    assert explained(opened(as_map(yoshida(float))), METHODS["yoshida4"], examples=FEW).holds
