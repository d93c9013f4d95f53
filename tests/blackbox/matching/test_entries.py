"""Claimed and read entries stand side by side, and the one entry that restores the order is found, exactly."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.blackbox.matching.entries import mended, other_velocities, rational_method, side_by_side
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from driftproof.symbolic.trees.order_conditions import order
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.dragged_steppers import of_stages

RK4, DOPRI5 = METHODS["rk4"], METHODS["dormand_prince54"]


def with_entry(i, j, value):
    row = (*RK4.a[i][:j], value, *RK4.a[i][j + 1 :])
    a = (*RK4.a[:i], row, *RK4.a[i + 1 :])
    return replace(RK4, key="mine", a=a, c=tuple(sum(r, Q(0)) for r in a))


@pytest.mark.parametrize(("i", "j"), [(1, 0), (2, 1), (3, 2), (3, 0)])
def test_the_entry_that_restores_the_order_is_the_one_that_was_changed(i, j):
    wrong = with_entry(i, j, Q(1, 3))
    assert order(wrong).order < 4
    assert mended(wrong, 4) == [
        f"with this one entry changed, order 4 is restored: a[{i}][{j}] = {RK4.a[i][j]} in place of 1/3"
    ]


def test_a_weight_is_restored_two_are_not_and_a_right_table_needs_nothing():
    wrong = replace(RK4, b=(Q(1, 6), Q(1, 3), Q(1, 4), Q(1, 6)))
    assert mended(wrong, 4) == ["with this one entry changed, order 4 is restored: b[2] = 1/3 in place of 1/4"]
    assert mended(replace(RK4, b=(Q(1, 6), Q(1, 4), Q(1, 4), Q(1, 3))), 4) == []
    assert mended(RK4, 4) == []
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


def test_the_velocities_that_are_off_are_told_and_no_others():
    late = read_coefficients(opened(of_stages("rk4", lambda i, stage, v: v if i == 3 else stage)))
    assert other_velocities(RK4, late) == ["the velocity of call 3 holds F[2]: 0 instead of 1"]
    assert other_velocities(METHODS["heun2"], late) == [
        "the velocities that its force is given are not those of the stages of heun2"
    ]


def shifted(method, by, *, timed=True, every=1):
    """What is read of a method whose entries are off, every so many of them."""
    a, b, c = exact_tableau(method)
    moved = [[float(x) + by * ((i + j) % every == 0 and bool(x)) for j, x in enumerate(row)] for i, row in enumerate(a)]
    rows = tuple(map(tuple, moved))
    weights = tuple(float(x) + (by if j % every == 0 else 0.0) for j, x in enumerate(b))
    return TableauReading(rows, weights, tuple(map(float, c)) if timed else None, BINARY64)


def one_off(key, name, by):
    """What is read in binary32 of a method with one number off: in A, row by row, in b or in c."""
    numbers = dict(zip("abc", ([*map(float, np.ravel(part))] for part in codes.floats(METHODS[key])), strict=True))
    numbers[name[0]][int(name[1:])] += by
    a, n = numbers["a"], len(numbers["b"])
    rows = tuple(tuple(a[i * n : (i + 1) * n]) for i in range(n))
    return TableauReading(rows, tuple(numbers["b"]), tuple(numbers["c"]), BINARY32)


# Beside the name of the number, the size that rounding is allowed for; a row's sum has that of its terms and its time.
@pytest.mark.parametrize(("key", "name", "size"), [("rk4", "b1", 1.0), ("ralston4", "a14", 3.83286476)])
@pytest.mark.parametrize(("share", "same"), [(0.99, True), (1.01, False), (-1.01, False)])
def test_an_entry_is_the_claimed_one_to_rounding(key, name, size, share, same):
    reading = one_off(key, name, share * Rounding(BINARY32, 4).of(size))
    assert (side_by_side(reading, METHODS[key])[:1] == []) == same


@pytest.mark.parametrize(("key", "size"), [("kutta3", 3 + 1), ("heun3", 2 / 3 + 2 / 3)])
@pytest.mark.parametrize(("share", "same"), [(0.99, True), (1.01, False), (-1.01, False)])
def test_a_row_sums_to_its_time_to_the_rounding_of_its_terms(key, size, share, same):
    reading = one_off(key, "c2", share * Rounding(BINARY32, 3).of(size))
    told = [line for line in side_by_side(reading, METHODS[key]) if line.startswith("row 2 of A sums to ")]
    assert (told == []) == same


@pytest.mark.parametrize(("share", "b"), [(0.99, (Q(1, 4), Q(0), Q(3, 4))), (1.01, None)])
def test_an_entry_is_a_simple_rational_to_its_own_rounding(share, b):
    found = rational_method(one_off("heun3", "b0", share * Rounding(BINARY32, 3).of(0.25)), "mine")
    assert (found and found.b) == b


@pytest.mark.parametrize(("share", "same"), [(0.99, True), (1.01, False)])
def test_a_velocity_is_that_of_a_stage_to_rounding(share, same):
    rows = [list(row) for row in codes.floats(RK4)[0]]
    rows[3][2] += share * Rounding(BINARY32, 4).of(1 + 1)
    late = read_coefficients(opened(of_stages("rk4", lambda i, stage, v: v if i == 3 else stage)))
    late = replace(late, format=BINARY32, a_velocity=tuple(map(tuple, rows)))
    (line,) = other_velocities(RK4, late)
    assert line.startswith("its positions are not" if same else "the velocity of call 3 holds F[2]: 1.0000")


def test_of_many_entries_twelve_are_shown_and_none_is_mended_of_more_than_seven_stages():
    for more in (0, 1):
        rows, weights, nodes = codes.floats(DOPRI5)
        rows[5], weights = [x + 1 for x in rows[5][:5]] + [0.0] * 2, [x + 1 for x in weights]
        nodes[6] += more
        lines = side_by_side(TableauReading(tuple(map(tuple, rows)), tuple(weights), tuple(nodes), BINARY64), DOPRI5)
        assert (len(lines[1:13]), lines[13:][:more]) == (12, ["and 1 more"] * more)
        assert ("and 1 more" in lines) == bool(more)
    assert mended(replace(METHODS["verner65"], b=(Q(1, 7), *METHODS["verner65"].b[1:])), 2) == []


@pytest.mark.parametrize("key", ["rk4", "dormand_prince54", "sdirk2", "gauss2", "forward_euler"])
@pytest.mark.parametrize("other", ["rk4", "dormand_prince54", "sdirk2", "gauss2", "forward_euler"])
def test_what_stands_side_by_side_is_what_it_was(key, other, as_before):
    kinds = [(0.0, True, 1), (0.125, True, 1), (1e-9, False, 2)]
    readings = [shifted(METHODS[key], by, timed=timed, every=n) for by, timed, n in kinds]
    shown = [side_by_side(each, METHODS[other]) for each in readings]
    read = [rational_method(each, "mine") for each in readings if not each.implicit]
    repaired = [mended(each, order) for each in read if each is not None for order in (1, 2, 4)]
    as_before(*(line for each in shown for line in ("--", *each)), *[each and each.b for each in read], *repaired)
