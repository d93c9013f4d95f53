"""All outcomes of comparisons: each that some numbers have is run once, and none that no numbers have."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.fields import branches
from driftproof.enclosure.fields.branches import Branching, on_all_branches
from tests.looping import some


def outcomes_of(asked):
    """What the runs of all branches answer to the questions (a, sign, b) in their order."""

    def run(told):
        branch = Branching(told)
        answers = tuple(branch.outcome(a, b, sign == ">=") for a, sign, b in asked)
        return [answers], branch

    return on_all_branches(run, lambda _, one, other: one + other)


def true_of(asked, numbers):
    return tuple(numbers[a] > numbers[b] or (sign == ">=" and numbers[a] == numbers[b]) for a, sign, b in asked)


def test_two_numbers_have_the_outcomes_of_less_equal_and_greater():
    questions = [(a, sign, b) for a, b in ("xy", "yx") for sign in (">", ">=")]
    for asked in some(product(questions, repeat=3)):
        found = outcomes_of(asked)
        assert sorted(found) == sorted({true_of(asked, {"x": x, "y": 1}) for x in (0, 1, 2)})


def test_no_outcome_of_several_numbers_is_missed():
    random = Random(1)
    for _ in range(40):
        pairs = [random.sample("xyz", 2) for _ in range(4)]
        asked = [(a, random.choice((">", ">=")), b) for a, b in pairs]
        found = outcomes_of(asked)
        assert len(found) == len(set(found))
        assert {true_of(asked, dict(zip("xyz", numbers, strict=True))) for numbers in product(range(3), repeat=3)} <= {
            *found
        }


def test_what_is_chosen_is_told_the_condition():
    def run(told):
        branch = Branching(told)
        return ("big" if branch.outcome("x", "y", False) else "small"), branch

    said = on_all_branches(run, lambda condition, one, other: f"{one} if {' '.join(condition)} else {other}")
    assert said == "big if x > y else small"


def test_loops_and_runs_end(monkeypatch):
    def run(told):
        branch, k = Branching(told), 0
        while branch.outcome("x", k, False):
            k += 1
        return k, branch

    with pytest.raises(Refused, match="more than 64 outcomes"):
        on_all_branches(run, lambda _, one, other: max(one, other))
    monkeypatch.setattr(branches, "MOST_OUTCOMES", 7)
    with pytest.raises(Refused, match="more than 7 outcomes"):
        outcomes_of([("x", ">", k) for k in range(3)])
    assert len(outcomes_of([("x", ">", k) for k in range(2)])) == 4
