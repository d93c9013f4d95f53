"""Borders are found between neighbours of the format, with their names, by steps that move nothing."""

import math
from math import inf, nextafter, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.checks.borders import (
    NegligibleStep,
    bisected_neighbours,
    negligible_step,
    short_name,
)
from driftproof.blackbox.checks.trials import Trial, TrialRunner, steady_runner
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32
from tests.blackbox.checks.habits import CAR_IN_A_VALLEY, DIVIDES_BY_H, WRAPPED, plain

RUNNER = TrialRunner(opened(plain))
# Halving in magnitude takes 11 tries from one end of the exponents to the other, 52 more the digits; and a round number
# is tried, with its neighbour, at up to 20 of them.
MOST_TRIES = 110


def tries_and_edge(limit, kept, gone, runner=RUNNER):
    tried = []

    def changed(x):
        tried.append(x)
        return (x > limit) == (gone > limit)

    return len(tried), bisected_neighbours(changed, kept, gone, runner), tried


@given(st.floats(1e-300, 1e300))
@settings(max_examples=50)
def test_a_border_anywhere_is_found_between_two_neighbours(limit):
    _, (kept, gone), tried = tries_and_edge(limit, 1e-305, 1e305)
    assert (kept, gone) == (limit, nextafter(limit, inf))
    assert len(tried) < MOST_TRIES


@given(st.floats(1e-300, 1e300))
@settings(max_examples=50)
def test_a_border_is_found_downwards_and_below_0(limit):
    assert tries_and_edge(limit, 1e305, 1e-305)[1] == (nextafter(limit, inf), limit)
    assert tries_and_edge(-limit, -1e-305, -1e305)[1] == (nextafter(-limit, 0.0), -limit)


@pytest.mark.parametrize("limit", [0.01, 100.0, 1e-7, 2.4, 1e6, pi, 2 * pi])
def test_a_border_with_a_short_name_is_found_soon(limit):
    _, ends, tried = tries_and_edge(limit, 1e-9, 1e9)
    assert ends[0] == limit
    assert len(tried) < 30


def test_a_border_at_0_is_found_next_to_it():
    assert tries_and_edge(0.0, 0.0, 1.0)[1] == (0.0, 5e-324)


def test_the_other_component_came_back_only_if_it_did():
    short = negligible_step(RUNNER)
    for component, q, v in ((0, 0.5, 2.0), (1, 2.0, 0.5)):
        for answer, kept in (((q, v), True), ((q + 0.1, v), component == 0), ((q, v + 0.1), component == 1)):
            assert short.keeps_other(component, Trial("", (q, v, short.h), answer)) is kept


# A step of h = 2**-20 of an oscillator moves a number by h times the size, and less than four times that; besides there
# is the slack, of numbers of size 1 and more.
@pytest.mark.parametrize("size", [0.25, 3.0])
@pytest.mark.parametrize("slack", [0.0, 2.0**-30])
def test_a_short_step_may_move_a_state_by_so_much(size, slack):
    short = NegligibleStep(RUNNER, 2.0**-20, (1.0, 1.0), slack)
    allowed = 4 * short.h * size + slack * max(1.0, size)
    for factor, kept in ((1, True), (1 + 2.0**-20, False)):
        moved = Trial("", (size, 0.0, short.h), (size, allowed * factor)), Trial("", (0.0, -size, 0.0), (0.0, -size))
        assert (short.keeps(moved[0]), short.keeps_other(0, moved[0]), short.keeps(moved[1])) == (kept, kept, True)
    assert not short.keeps(Trial("", (size, 0.0, short.h), failure="raises ValueError"))


@pytest.mark.parametrize(("fmt", "kind"), [(BINARY32, np.float32), (BINARY16, np.float16)])
def test_neighbours_are_those_of_the_format(fmt, kind):
    runner = TrialRunner(RUNNER.subject, fmt)
    kept, gone = tries_and_edge(math.e, 1.0, 1000.0, runner)[1]
    assert kept == float(kind(kept)) < math.e < gone
    assert gone == float(np.nextafter(kind(kept), kind(10)))


def test_hints_are_tried_first_and_left_if_they_are_wrong():
    tried = []

    def changed(x):
        tried.append(x)
        return x > 1 / 3

    right = (1 / 3, nextafter(1 / 3, 1.0))
    assert bisected_neighbours(changed, 0.1, 1.0, RUNNER, [right]) == right
    assert len(tried) == 2
    assert bisected_neighbours(changed, 0.1, 1.0, RUNNER, [(0.5, nextafter(0.5, 1.0)), (7.0, 8.0)]) == right


def test_names_edges_and_short_steps_are_what_they_were(as_before):
    numbers = [0.1 * 3, 2 / 3, 1e22, 6.1e-5, -0.3, 100.00000000000001, float(np.float32(1e30)), 65504.0, 1.5e-7]
    numbers += [100.0, 0.01, -2.4, 1e300, 0.0, -0.0, pi, -pi, 2 * pi, -pi / 2, nextafter(pi, 4.0), 0.625, 2.0**-1074]
    numbers += [float(np.float32(0.1)), float(np.float16(-0.1)), 65536.0, 2.0**100]
    limits = [(0.3, 1e-8, 1e8), (7.25, 1.0, 1e3), (1 / 3, 1e-3, 2.0), (6.02e23, 1.0, 1e30), (2.0**-1060, 5e-324, 1.0)]
    found = [(count, len(tried), ends) for count, ends, tried in (tries_and_edge(*each) for each in limits)]
    short = [negligible_step(steady_runner(opened(step))) for step in (plain, CAR_IN_A_VALLEY, WRAPPED, DIVIDES_BY_H)]
    as_before(*map(short_name, numbers), *found, *((each.h, each.state, each.slack) for each in short))
    assert [each.keeps(each.along(0, each.state[0])) for each in short] == [True] * 4
