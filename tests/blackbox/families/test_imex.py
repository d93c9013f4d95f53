"""Which IMEX method a step is; one entry, a wrong time and a wrong coupling are told, right ones pass."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from driftproof.blackbox.families.imex import read_imex
from driftproof.blackbox.families.imex_step import read_imex_step
from driftproof.blackbox.identify import identify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.families.split_steppers import euler_pair, imex, split_in_turn, unsolved

KEYS = [key for key, method in FURTHER_METHODS.items() if isinstance(method, Additive)]


LATER = ("ars121", "ars122", "ars233", "ars232", "ars343", "ark324", *KEYS[-2:])


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", [pytest.param(key, marks=[pytest.mark.long] * (key in LATER)) for key in KEYS])
def test_a_method_passes_as_itself(key):
    report = verify(imex(key), key, isolate=False)
    assert report.passed, report.text()
    assert report.verdict == f"is {key}"


@pytest.mark.parametrize(
    ("key", "how", "words"),
    [
        ("ars222", {"a_explicit": ((2, 0), -0.7)}, "\n  a_explicit[2][0]: -7/10 instead of"),
        ("ars222", {"b_implicit": (1, 0.75)}, "\n  b_implicit[1]: 3/4"),
        ("ark324", {"b_explicit": (2, 0.5)}, "\n  b_explicit[2]: 1/2"),
        ("ars111", {"implicit_times": [0.0, 0.0]}, "is evaluated at t + 0 h in stage"),
    ],
)
def test_a_wrong_one_fails_with_its_cause(key, how, words):
    report = verify(imex(key, **how), key, isolate=False)
    assert report.passed is False
    assert words in report.text(everything=True)


def test_tables_that_do_not_fit_are_of_lower_order_together():
    words = identify(imex("ars222", a_explicit=((2, 0), 0.5)), isolate=False).verdict
    assert "of order 1 on f + g, its tables alone have order 2 and 2" in words


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("times", "order"), [([0.0, 0.0, 0.0], 1), (None, 2)])
def test_the_order_is_that_of_functions_of_t_as_well(times, order):
    """Of stages that are solved at t: where g does not depend on t, the tables alone count."""
    report = verify(imex("ars222", **({"implicit_times": times} if times else {})), "ars222", isolate=False)
    assert report.passed is (times is None)
    criterion = "Order: passed" if times is None else "Order: FAILED"
    assert f"order {order} is observed on a nonlinear problem" in report.section(criterion).lines[1]
    assert ("of order 1 where g or f depends on t" in report.verdict) is (times is not None)


@pytest.mark.parametrize("step", [split_in_turn, unsolved])
def test_another_step_is_not_known_and_has_its_order(step):
    report = identify(step, isolate=False)
    assert "it is an IMEX method of" in report.verdict
    assert report.data["measured_order"] == 1
    assert "of order 1 on f + g" in report.verdict
    assert verify(step, "ars111", isolate=False).passed is False


@pytest.mark.slow
def test_tables_are_shown_row_by_row_each_stage_after_those_that_it_needs():
    """Of backward Euler for g and then Euler for f, whose stages come in the order 1, 0."""
    shown = ("c = 1, 0", "b_explicit = 0, 1", "a_implicit[0] = 1", "a_implicit[1] = 1, 0", "b_implicit = 1, 0")
    lines = identify(split_in_turn, isolate=False).section("Coefficients").lines
    assert lines[:6] == ("no IMEX method of the catalogue", *shown)
    report = identify(euler_pair, isolate=False)
    assert report.verdict == "it is ars111"
    lines = report.section("Coefficients").lines
    off = read_imex_step(opened(euler_pair)).rounding.of(1.0)
    shown = ("a_explicit[1] = 1, 0", "b_explicit = 1, 0", "a_implicit[1] = 0, 1", "b_implicit = 0, 1")
    held = f"ars111: every entry within {off:.1e}, the accuracy of its stage solver"
    assert (*lines[:5], lines[-1]) == (held, *shown, "it receives no time")


@pytest.mark.slow
def test_a_program_is_told_both_tables_and_the_orders_are_shown():
    report, g = identify(imex("ars222"), isolate=False), 0.2928932188134525
    assert report.data["method"] == "ars222"
    assert [float(x) for x in report.data["a_implicit"][2]] == pytest.approx([0.0, 1 - g, g], abs=1e-15)
    tables, seen = report.section("Order").lines
    assert tables == "of order 2 on f + g, its tables alone have order 2 and 2"
    assert seen.endswith("with t, split in two (slopes of the local error: 2.75, 2.87, 2.93, 2.97, 2.98, 2.99)")
    lines = verify(imex("ars222"), "ars443", isolate=False).section("Coefficients: FAILED").lines
    assert lines == ("not those of ars443", "ars443 has 5 stages with an effect, this one 3")
    assert identify(imex("ars111", implicit_times=[0.0, 0.0]), isolate=False).data["method"] is None


@pytest.mark.slow
def test_an_entry_and_a_time_are_held_to_what_rounding_and_its_solver_leave():
    """Of size 1, 1.7 as the entry, and 1 + 2.4 as the row of a time."""
    method, right = FURTHER_METHODS["ars222"], read_imex(opened(imex("ars222")))
    read, off = right.reading, right.reading.rounding.of
    assert read.rounding.besides == 4 * read.stage_error
    for k, passes in ((0.96, True), (1.04, False)):
        a, b, c = (np.array(part) for part in (read.a, read.b, read.c))
        a[0, 2, 1] += k * off(a[0, 2, 1])
        b[1, 1] += k * off(1.0)
        c[2] = 1 + k * off(1 + np.abs(read.a[0][2]).sum())
        for found in (replace(read, a=a.tolist()), replace(read, b=b.tolist()), replace(read, c=c.tolist())):
            first, second, *_ = replace(right, reading=found).criteria(method)
            assert (first.passed and second.passed) is passes


@pytest.mark.slow
def test_a_stage_counts_that_one_table_weighs_and_none_that_neither_does():
    """Of four stages, the second weighed in f alone, the third in g alone, the last nowhere."""
    a, none, half = FURTHER_METHODS["ars343"].a_explicit, (0, 0, 0, 0), Fraction(1, 2)
    tables = {
        "a_explicit": (a[0], a[1], (sum(a[2]), 0, 0, 0), a[3]),
        "a_implicit": (none, none, (0, 0, sum(a[2]), 0), none),
        "b_explicit": (half, half, 0, 0),
        "b_implicit": (half, 0, half, 0),
    }
    own = replace(FURTHER_METHODS["ars343"], key="mine", claimed_order=1, **tables)
    step = imex("ars343", **{name: (slice(None), np.array(part, dtype=float)) for name, part in tables.items()})
    report = verify(step, own, isolate=False)
    assert report.verdict == "is mine", report.text()
    shown = [line.split(" = ")[0] for line in report.section("Coefficients: passed").lines[1:-1]]
    assert shown == ["c", "a_explicit[1]", "a_explicit[2]", "b_explicit", "a_implicit[2]", "b_implicit"]
    assert report.section("Coefficients: passed").lines[1].startswith("c = 0, 0.4358665215084")
