"""A sweep in text: a row for each point, with what varies and the readouts, or why there are none."""

import re
from dataclasses import replace
from fractions import Fraction as Q

from driftproof.numeric.scenes import Scene
from driftproof.numeric.sweep import SweepAnswer
from driftproof.reports import sweeps

SCENE = Scene("long", "symplectic_euler", Q(1, 2**10), Q(16), readouts=("final_state", "state_error"))


def test_a_row_says_the_point_and_four_digits_of_what_is_not_a_state_or_why_there_are_none():
    scene = replace(SCENE, readouts=("final_state", "state_error", "steps", "phase_error"))
    points = [{"selected": "rk4", "start": (Q(1), Q(1, 2))}, {"selected": "rk4", "start": (Q(1), Q(0))}]
    outcomes = [{"state_error": 2 / 3, "steps": 40, "phase_error": None}, "overflow"]
    answers = list(map(SweepAnswer, points, outcomes))
    assert [re.split("  +", row.strip()) for row in sweeps.sweep_text(scene, answers).splitlines()[2:]] == [
        ["method", "start", "state error", "steps", "phase error (degrees)"],
        ["rk4", "1, 1/2", "0.6667", "40", "undefined"],
        ["rk4", "1, 0", "overflow"],
    ]
    assert sweeps.sweep_text(scene, answers).startswith("long: 2 points\n")
    assert sweeps.sweep_text(scene, answers[:1]).startswith("long: 1 point\n")
