"""Which IMEX method a step is; one entry, a wrong time and a wrong coupling are told, right ones pass."""

from dataclasses import replace

import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.verify import verify
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FACTS_ONLY
from tests.blackbox.families.split_steppers import euler_pair, imex, split_in_turn, unsolved

KEYS = [key for key, method in FACTS_ONLY.items() if isinstance(method, Additive)]


@pytest.mark.parametrize("key", [*KEYS[:-2], *(pytest.param(key, marks=pytest.mark.long) for key in KEYS[-2:])])
def test_a_method_passes_as_itself(key):
    report = verify(imex(key), key, isolate=False)
    assert report.passed, report.text()
    assert report.verdict == f"is {key}"


def test_the_euler_pair_is_named_without_times():
    assert identify(euler_pair, isolate=False).verdict == "it is ars111"


@pytest.mark.parametrize(
    ("key", "how", "words"),
    [
        ("ars222", {"a_explicit": ((2, 0), -0.7)}, "a_explicit[2][0]: -7/10 instead of"),
        ("ars222", {"b_implicit": (1, 0.75)}, "it is ars222 but for b_implicit[1]: 3/4"),
        ("ars443", {"a_implicit": ((2, 1), 1 / 8)}, "it is ars443 but for a_implicit[2][1]: 1/8 instead of 1/6"),
        ("ark324", {"b_explicit": (2, 0.5)}, "it is ark324 but for b_explicit[2]: 1/2"),
        ("ars111", {"implicit_times": [0.0, 0.0]}, "is asked at t + 0 h in stage"),
    ],
)
def test_a_wrong_one_fails_with_its_cause(key, how, words):
    report = verify(imex(key, **how), key, isolate=False)
    assert report.passed is False
    assert words in report.verdict


def test_tables_that_do_not_fit_are_of_lower_order_together():
    words = identify(imex("ars222", a_explicit=((2, 0), 0.5)), isolate=False).verdict
    assert "of order 1 on f + g, its tables alone of order 2 and 2" in words


@pytest.mark.parametrize("step", [split_in_turn, unsolved])
def test_another_step_is_not_known_and_has_its_order(step):
    report = identify(step, isolate=False)
    assert "it is an IMEX method of" in report.verdict
    assert report.data["measured_order"] == 1
    assert "of order 1 on f + g" in report.verdict
    assert verify(step, "ars111", isolate=False).passed is False


def test_tables_are_shown_row_by_row_each_stage_after_those_that_it_needs():
    """Of backward Euler for g and then Euler for f, whose stages come in the order 1, 0."""
    shown = ("c = 1, 0", "b_explicit = 0, 1", "a_implicit[0] = 1", "a_implicit[1] = 1, 0", "b_implicit = 1, 0")
    lines = identify(split_in_turn, isolate=False).section("Coefficients").lines
    assert lines[:6] == ("no IMEX method of the catalogue", *shown)
    lines = identify(euler_pair, isolate=False).section("Coefficients").lines
    assert (lines[0][:21], lines[1:3], lines[-1]) == (
        "ars111: every entry w",
        ("a_explicit[1] = 1, 0", "b_explicit = 1, 0"),
        "it is given no time",
    )


def test_a_method_of_somebody_s_own_is_held_to_its_own_tables():
    own = replace(FACTS_ONLY["ars111"], key="mine", a_implicit=((0, 0), (0, 2)), b_implicit=(-1, 2))
    step = imex("ars111", a_implicit=((1, 1), 2.0), b_implicit=(slice(None), [-1.0, 2.0]))
    assert verify(step, own, isolate=False).section("Coefficients: passed")
    assert verify(imex("ars111"), own, isolate=False).passed is False
