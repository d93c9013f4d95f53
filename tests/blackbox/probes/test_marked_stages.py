"""Stages are known by their times and by clocks in y; what calls elsewhere, or at too many places, is refused."""

import numpy as np
import pytest

from driftproof.blackbox.probes.marked_stages import MarkedSteps, Setting, StageMarks, clock_slopes, spread
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.implicit_steppers import all_at_once, one_by_one, table, untimed
from tests.looping import exactly

AT_ONE_TIME = ([[0.5, 0.0], [0.25, 0.5]], [0.5, 0.5], [1.0, 1.0])


def steps(step):
    return MarkedSteps(opened(step))


def test_nodes_are_the_times_of_the_calls_in_units_of_h():
    found = steps(one_by_one(table("tr_bdf2")))
    assert found.timed
    assert found.size == 4
    assert found.nodes == tuple(table("tr_bdf2")[2])
    assert not steps(untimed(all_at_once(table("trapezoid")))).timed


@pytest.mark.parametrize(("apart", "count"), [(2.0**-44, 2), (2.0**-45, 1), (2.0**-46, 1)])
def test_nodes_are_one_that_are_no_more_than_256_roundings_apart(apart, count):
    assert len(steps(lambda f, t, y, h: y + h / 2 * (f(t + h / 2, y) + f(t + h / 2 + apart, y))).nodes) == count


@pytest.mark.parametrize(("apart", "count"), [(2.0**-15, 2), (2.0**-16, 1), (2.0**-17, 1)])
def test_stages_are_one_that_differ_by_no_more_than_a_difference_quotient(apart, count):
    (shown,) = steps(lambda f, t, y, h: y + h / 2 * (f(t, y) + f(t, y + apart))).marks(1).hands
    assert [len(seen) for seen in shown.values()] == [count]


def test_a_clock_shows_the_sum_of_a_row_times_its_slopes_at_each_stage():
    marks = steps(one_by_one(AT_ONE_TIME)).marks(1)
    (shown,) = marks.hands
    # The first guess of each stage shows what the stages before it have made, then the stage.
    assert [round(x, 6) for x in shown[0,].values()] == [0.0, 0.5, 0.25, 0.75]
    assert len(marks.labels) == 4
    kept = marks.only([(0, 1), (0, 3)])
    assert kept.labels == [(0, 1), (0, 3)]
    for label, hand in exactly(2, zip(kept.labels, (0.5, 0.75), strict=True)):
        assert kept.shares(0, [hand])[label] == pytest.approx(1, abs=1e-9)


def test_shares_are_those_of_the_polynomials_through_what_the_clocks_show():
    marks = StageMarks((0.0,), ({(0,): {0: 0.0, 1: 0.5, 2: 1.0}},))
    assert marks.shares(0, [0.5]) == {(0, 0): 0.0, (0, 1): 1.0, (0, 2): 0.0}
    assert sum(marks.shares(0, [0.3]).values()) == pytest.approx(1)
    assert clock_slopes([{(0,): 1.0}]) == [1.0]
    assert clock_slopes([{(1,): 0.5, (2,): 0.5}]) == [(spread(1) + spread(2)) / 2]


def test_a_clock_shows_what_a_solver_has_come_to_last():
    def nears(f, t, y, h):
        for off in (1e-6, 1e-9, 0.0):
            slope = np.asarray(f(t + h, y + h / 2 + off))
        return y + h * slope

    (shown,) = steps(nears).marks(1).hands
    assert shown == {(0,): {0: 0.5}}


def test_numbers_of_two_stages_are_far_apart():
    assert spread(0) == 1
    values = sorted(spread(i) for i in range(40))
    assert np.diff(values).min() > 0.01


def moves_its_times(f, t, y, h):
    return y + h * f(t + h * float(np.abs(f(t, y)).max()) / 2, y)


def stiff(count):
    """As many calls at times of their own."""
    return lambda f, t, y, h: y + h * sum(f(t + h * i / count, y) for i in range(count)) / count


def test_another_time_and_too_many_stages_are_refused():
    subject = steps(moves_its_times)
    assert subject.nodes == (0.0, 0.5)
    with pytest.raises(
        NotReadable, match=r"is called at t \+ 1 h, and with other slopes, times and h at the nodes 0, 0.5"
    ):
        subject.run(subject.marks(0), Setting(), lambda shares, moved: [2.0] * len(moved))
    with pytest.raises(NotReadable, match="called at 41 stages: it is adaptive"):
        steps(stiff(41)).marks(0)
    assert len(steps(stiff(40)).marks(0).labels) == 40


def test_what_a_step_does_on_marked_stages_is_no_fault_of_it():
    def fails(f, t, y, h):
        if np.abs(f(t, y)).max() == 2:
            raise RuntimeError("no convergence")
        return y + h * f(t, y)

    subject = steps(fails)
    with pytest.raises(NotReadable, match=r"with its stages marked, .* raises RuntimeError: no convergence"):
        subject.run(subject.marks(0), Setting(), lambda shares, moved: [2.0] * len(moved))


@pytest.mark.slow
def test_a_step_that_never_ends_by_itself_is_ended():
    def endless(f, t, y, h):
        while np.all(f(t, y) == 1):
            pass
        return y

    with pytest.raises(NotReadable, match="more than 20000 calls"):
        steps(endless)
