"""The head of a column says what its numbers are: settings, numbers of steps, unknowns, or facts of methods."""

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.words.heads import LIMIT_OF_STEPS, fact_in_column, is_head_of, is_of_steps, leaves_quantity

TABLE = """We solve x' = x(1 - y), y' = y(x - 1), x(0) = 2, y(0) = 1 with h = 0.1.
| {} | RK4 x | RK4 y |
| 1 | 1.98970 | 1.10479 |
| 2 | 1.95797 | 1.21802 |
| 3 | 1.83016 | 1.33713 |
| 4 | 1.90443 | 1.45851 |
"""


@pytest.mark.parametrize(
    ("head", "cells", "heads", "steps"),
    [
        ("n", "1 2 3", "", True),
        ("n", "0 10 20", "", True),
        ("k", "1 2", "", True),
        ("N", "10 20 40", "", False),
        ("N", "1 2 4", "", False),
        ("n", "10 20", "y_n", False),  # of two runs
        ("n", "4", "y_n", True),
        ("n", "4", "y", False),
        ("K", "1 2 3", "", False),
        ("step", "10 20 40", "", True),
        ("Step n", "5", "", True),
        ("step", "0.2 0.1", "", False),
        ("step", "4 2 1", "", False),  # step sizes
        ("steps", "10 20 30", "", False),
        ("t", "1 2 3", "", False),
    ],
)
def test_a_column_has_numbers_of_steps_or_of_runs(head, cells, heads, steps):
    assert is_of_steps(head, cells.split(), [head, *heads.split()]) is steps


@pytest.mark.parametrize("head", ["n", "k", "i", "step", "Step n", "t"])
def test_rows_that_are_exchanged_below_numbers_of_steps_are_slips_and_the_others_claims(head):
    text = TABLE.format(head)
    for n in range(1, 5) if head == "t" else ():
        text = text.replace(f"| {n} |", f"| 0.{n} |")
    suggestions = Suggestions(text)
    found = [x for x in suggestions._numbers if len(x.text) == 7]
    assert [x.text for x in found if suggestions.slips(x)] == ["1.83016", "1.90443"]
    assert [suggestions.look_alikes(x)[0].strong for x in found] == [True] * 4 + [False, True] * 2


def test_a_head_names_a_setting_a_fact_or_a_method_only():
    assert [is_head_of(*one) for one in (("h", "step"), ("t", "time (s)"), ("n", "t"))] == [True, True, False]
    assert (fact_in_column("stages"), fact_in_column("steps")) == ("stages", None)
    limits = "h max", "h_{max}", "max dt", "largest stable step", "stable for h <", "step-size limit", "limit on h"
    assert {*map(fact_in_column, limits)} == {LIMIT_OF_STEPS}
    assert {*map(fact_in_column, ("h", "max error", "largest step error", "step"))} == {None}
    assert [leaves_quantity(head, ["y"]) for head in ("rk4", "rk4 error", "rk4 y")] == [True, False, False]
