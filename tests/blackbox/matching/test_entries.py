"""Claimed and read entries stand side by side, and the one entry that restores the order is found, exactly."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.entries import other_velocities, rational_method, side_by_side
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.claimed_orders import restoring_entries
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from driftproof.symbolic.trees.order_conditions import order
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.dragged_steppers import of_stages
from tests.blackbox.matching.readings import read_with

RK4 = METHODS["rk4"]


def with_entry(i, j, value):
    a = tuple(tuple(value if (k, m) == (i, j) else x for m, x in enumerate(row)) for k, row in enumerate(RK4.a))
    return replace(RK4, key="mine", a=a, c=tuple(sum(r, Q(0)) for r in a))


@pytest.mark.parametrize(("i", "j"), [(1, 0), (2, 1), (3, 2), (3, 0)])
def test_the_entry_that_restores_the_order_is_the_one_that_was_changed(i, j):
    wrong = with_entry(i, j, Q(1, 3))
    assert order(wrong).order < 4
    assert restoring_entries(wrong, 4) == [
        f"with this one entry changed, order 4 is restored: a[{i}][{j}] = {RK4.a[i][j]} in place of 1/3"
    ]


def test_a_weight_is_restored_two_are_not_and_a_right_table_needs_nothing():
    wrong = replace(RK4, b=(Q(1, 6), Q(1, 3), Q(1, 4), Q(1, 6)))
    assert restoring_entries(wrong, 4) == [
        "with this one entry changed, order 4 is restored: b[2] = 1/3 in place of 1/4"
    ]
    assert restoring_entries(replace(RK4, b=(Q(1, 6), Q(1, 4), Q(1, 4), Q(1, 3))), 4) == []
    assert restoring_entries(RK4, 4) == []
    assert side_by_side(read_tableau(opened(codes.rk4)), RK4) == []


def test_the_report_shows_claimed_and_read_and_the_headline_what_is_wrong():
    rows, weights, nodes = codes.floats(RK4)
    weights = [weights[0], 0.25, weights[2], weights[3]]
    report = verify(codes.tableau(rows, weights, nodes), "rk4", examples=50)
    assert "b[1]: 1/4 instead of 1/3" in report.verdict
    lines = report.section("Coefficients: FAILED").lines
    assert [line.split() for line in lines[1:3]] == [
        ["entry", "claimed", "read", "difference"],
        ["b[1]", "1/3", "1/4", "-0.0833"],
    ]
    assert "with this one entry changed, order 4 is restored: b[1] = 1/3 in place of 1/4" in lines


def test_a_row_whose_sum_is_not_its_time_is_told():
    rows, weights, _ = codes.floats(RK4)
    reading = read_tableau(opened(codes.tableau(rows, weights, [0.0, 0.25, 0.5, 1.0])))
    assert side_by_side(reading, RK4)[-1] == "row 1 of A sums to 1/2, its time c is 1/4"
    assert rational_method(reading, "read").b == RK4.b


LATE = read_coefficients(opened(of_stages("rk4", lambda i, stage, v: v if i == 3 else stage)))


def test_the_velocities_that_are_off_are_told_and_no_others():
    assert other_velocities(RK4, LATE) == ["the velocity of call 3 holds F[2]: 0 instead of 1"]
    assert other_velocities(METHODS["heun2"], LATE) == [
        "the velocities passed to its force are not those of the stages of heun2"
    ]


def shifted(method, by, *, timed=True, every=1):
    """What is read of a method whose entries are off, every so many of them."""
    a, b, c = exact_tableau(method)
    moved = [[float(x) + by * ((i + j) % every == 0 and bool(x)) for j, x in enumerate(row)] for i, row in enumerate(a)]
    rows = tuple(map(tuple, moved))
    weights = tuple(float(x) + (by if j % every == 0 else 0.0) for j, x in enumerate(b))
    return TableauReading(rows, weights, tuple(map(float, c)) if timed else None, BINARY64)


def velocities_with(more):
    """What is said of the velocities of RK4's stages, the last but one entry being so much more."""
    return other_velocities(RK4, replace(LATE, format=BINARY32, a_velocity=read_with("rk4", ("a", 3, 2), by=more).a))


# A number of a method, and the size that rounding is allowed for; a row's sum has that of its terms and its time.
SIZES = {"rk4": (("b", 1), 1.0), "ralston4": (("a", 3, 2), 3.83286476)}
SIZES |= {"kutta3": (("c", 2), 3 + 1), "heun3": (("c", 2), 2 / 3 + 2 / 3)}


@pytest.mark.parametrize("share", [0.99, 1.01, -1.01])
def test_what_is_off_is_told_where_it_is_beyond_its_rounding(share):
    for key, (place, size) in SIZES.items():
        off = share * Rounding(BINARY32, METHODS[key].stages).of(size)
        told = side_by_side(read_with(key, place, by=off, in_format=BINARY32), METHODS[key])
        begin = "row 2 of A sums to " if place[0] == "c" else f"{place[0]}["
        assert any(line.startswith(begin) for line in told) == (abs(share) > 1), key
    simple = rational_method(read_with("heun3", ("b", 0), by=share * 20 * 2.0**-26, in_format=BINARY32), "mine")
    assert (simple and simple.b) == (None if abs(share) > 1 else METHODS["heun3"].b)
    (velocity,) = velocities_with(share * Rounding(BINARY32, 4).of(1 + 1))
    assert velocity.startswith("the velocity of call 3 holds F[2]: " if abs(share) > 1 else "given its velocities,")


def test_of_many_entries_twelve_are_shown_and_none_is_mended_of_more_than_seven_stages():
    twelve = [*(("a", 5, j) for j in range(5)), *(("b", j) for j in range(7))]
    for places, more in ((twelve, []), ([*twelve, ("c", 6)], ["and 1 more"])):
        lines = side_by_side(read_with("dormand_prince54", *places), METHODS["dormand_prince54"])
        assert [line for line in lines if not line.startswith("row ")][13:] == more
    assert restoring_entries(replace(METHODS["verner65"], b=(Q(1, 7), *METHODS["verner65"].b[1:])), 2) == []


@pytest.mark.parametrize("key", ["rk4", "dormand_prince54", "sdirk2", "gauss2", "forward_euler"])
@pytest.mark.parametrize("other", ["rk4", "dormand_prince54", "sdirk2", "gauss2", "forward_euler"])
def test_what_stands_side_by_side_is_what_it_was(key, other, as_before):
    kinds = [(0.0, True, 1), (0.125, True, 1), (1e-9, False, 2)]
    readings = [shifted(METHODS[key], by, timed=timed, every=n) for by, timed, n in kinds]
    shown = [side_by_side(each, METHODS[other]) for each in readings]
    said = [line for each in shown for line in ("--", *each)]
    if key == other:
        read = [rational_method(each, "mine") for each in readings if not each.implicit]
        said += [each and each.b for each in read]
        said += [restoring_entries(each, order) for each in read if each is not None for order in (1, 2, 4)]
    as_before(*said)
