"""What is read of a push: where its fields are asked for; what is no push that turns, kicks and drifts is refused."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify
from driftproof.blackbox.families.magnetic_step import read_magnetic
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes


def test_where_fields_are_asked_is_read_where_they_are_functions():
    assert read_magnetic(opened(codes.drifting)).asked == (0.5, 0.5)
    assert read_magnetic(opened(codes.asked_at(1.0, 0.0, 1.0))).asked == (1.0, 1.0)
    assert read_magnetic(opened(codes.boris())).asked == ()


def test_what_is_not_linear_or_remembers_is_refused():
    with pytest.raises(NotReadable, match="relativistic"):
        read_magnetic(opened(codes.relativistic))
    with pytest.raises(NotReadable, match="does not stay"):
        read_magnetic(opened(lambda x, v, B, dt: (x + dt * v, v + dt * np.cross(v, B) + dt)))
    seen = []

    def remembering(v, B, dt):
        seen.append(v)
        return v + dt * len(seen) * np.cross(v, B)

    with pytest.raises(NotReadable, match="taken twice"):
        read_magnetic(opened(remembering))
    with np.errstate(all="ignore"):
        undone = identify(codes.boris(lambda b, h: b / 0.0), isolate=False)
    assert undone.verdict.startswith("gives no answer: from ")
    assert identify(codes.relativistic, isolate=False).verdict.startswith("it is no method that is known here: twice")
