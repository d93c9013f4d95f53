"""`driftproof step`: one step to the letter, exact fractions of any size, negative values, ties as asked."""

from __future__ import annotations

import json
from collections.abc import Callable

Answer = Callable[..., str]

STEP = """\
Classical RK4 (rk4): one step of h = 1/2 from (1, 0)

final state q  0.877604166666667      exactly 337/384
final state v  -0.479166666666667     exactly -23/48
energy         0.499894883897569      exactly 147425/294912
energy change  -0.000105116102430556  exactly -31/294912

15 digits, rounded half-even, certified
"""


def test_step_prints_fractions_with_decimals(answer: Answer) -> None:
    assert answer("step", "rk4", "--h", "1/2", "--state", "1,0") == STEP


def test_step_as_json_has_every_number_as_a_string(answer: Answer) -> None:
    found = json.loads(answer("step", "rk4", "--h", "0.5", "--format", "json"))
    assert found["final_state"] == {
        "q": {"exact": "337/384", "decimal": "0.877604166666667"},
        "v": {"exact": "-23/48", "decimal": "-0.479166666666667"},
    }
    assert (found["h"], found["start"], found["digits"], found["rounding"]) == ("1/2", ["1", "0"], 15, "half-even")


def test_negative_values_are_values_and_not_options(answer: Answer) -> None:
    back = answer("step", "rk4", "--h", "-1/2", "--state", "-1,0")
    assert "one step of h = -1/2 from (-1, 0)" in back
    assert "exactly -337/384" in back
    assert answer("step", "rk4", "--h=-1/2", "--state=-1,0") == back
    assert "h = -1/4" in answer("run", "rk4", "--h", "-.25", "--t", "-10", "--state", "-1/3,-2")


def test_minus_sign_of_printed_text_is_understood(answer: Answer) -> None:
    minus = "\N{MINUS SIGN}"
    assert answer("step", "rk4", "--h", f"{minus}1/2") == answer("step", "rk4", "--h", "-1/2")


def test_rounding_of_a_tie_is_as_asked(answer: Answer) -> None:
    tie = ("step", "forward_euler", "--h", "1/8", "--state", "5/2,0", "--digits", "1")
    assert "final state q  2 " in answer(*tie)
    assert "final state q  3 " in answer(*tie, "--rounding", "half-away")


def test_huge_exact_fractions_are_printed_and_not_refused(answer: Answer) -> None:
    found = json.loads(answer("step", "rk4", "--h", "1/2", "--state", "1e1200,1e-1200", "--format", "json"))
    assert len(found["energy"]["exact"]) > 4300  # Python's own limit for printing an integer
    assert found["energy"]["decimal"] == "4.99894883897569e2399"
