"""Axes and plots: ticks are round, few and inside; limits are just beyond; scales and labels are exact."""

import re
from fractions import Fraction as Q
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.reports.page.plot import (
    AXIS_ENDS,
    TICK_STEPS,
    Plot,
    Scale,
    decade,
    decades,
    decades_of,
    frame,
    label,
    linear,
    place,
    symmetric_limit,
    ticks,
)

fractions = st.builds(Q, st.integers(-(10**12), 10**12), st.integers(1, 10**9))
positive = st.builds(Q, st.integers(1, 10**12), st.integers(1, 10**12))


@given(low=fractions, high=fractions)
def test_ticks_are_three_to_six_multiples_of_the_coarsest_round_step_inside(low, high):
    """The coarsest: twice the step, which is round or between two round ones, is not reached by any round one."""
    assume(low < high)
    found = ticks(low, high)
    steps = {b - a for a, b in pairwise(found)}
    (step,) = steps
    assert 3 <= len(found) <= 6
    assert low <= found[0] < found[-1] <= high
    assert found[0] - step < low
    assert found[-1] + step > high
    assert all((tick / step).denominator == 1 for tick in found)
    power = Q(10) ** decade(step)
    assert step / power in TICK_STEPS
    coarser = min(m * power * k for m in TICK_STEPS for k in (1, 10) if m * power * k > step)
    assert len([i for i in range(int(low // coarser), int(high // coarser) + 2) if low <= i * coarser <= high]) < 3


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (-4, 4, [-4, 0, 4]), (0, 10, [0, 5, 10]), (Q(-5, 4), Q(5, 4), [-1, 0, 1]),
        (Q(-25, 2), Q(25, 2), [-10, 0, 10]), (-3, 3, [-2, 0, 2]), (0, 7, [0, 2, 4, 6]), (-10, 0, [-10, -5, 0]),
        (0, Q(1, 10**300), [0, Q(5, 10**301), Q(1, 10**300)]),
        (0, Q(10) ** 308, [0, 5 * Q(10) ** 307, Q(10) ** 308]),
    ],
)  # fmt: skip
def test_ticks_of_known_axes(low, high, expected):
    assert ticks(Q(low), Q(high)) == expected


@pytest.mark.parametrize("low", [1, 2])
def test_axis_without_length_has_no_ticks(low):
    with pytest.raises(ValueError, match="has no length"):
        ticks(Q(low), Q(1))


@given(largest=positive)
def test_limit_is_round_beyond_and_near(largest):
    limit = symmetric_limit(largest)
    assert limit / Q(10) ** decade(limit) in AXIS_ENDS
    assert largest < limit <= Q(7, 5) * largest
    assert largest * Q(21, 20) <= limit


def test_limits_grow_by_a_third_at_most():
    ends = [*AXIS_ENDS, Q(10)]
    assert max(b / a for a, b in pairwise(ends)) == Q(4, 3)
    assert (symmetric_limit(Q(0)), symmetric_limit(Q(3)), symmetric_limit(Q(39, 4))) == (1, 4, Q(25, 2))
    reached = [1, 1.2, 1.9, 2.3, 2.8, 3.8, 4.7, 5.7, 7.5]
    assert [float(symmetric_limit(Q(x))) for x in reached] == [1.25, 1.5, 2, 2.5, 3, 4, 5, 6, 8]


@given(x=positive)
def test_decade_is_the_last_power_of_ten_not_above(x):
    assert Q(10) ** decade(x) <= x < Q(10) ** (decade(x) + 1)


@pytest.mark.parametrize(
    ("x", "shown"),
    [
        (Q(0), "0"), (Q(-4), "−4"), (Q(1, 2), "0.5"), (Q(400_000), "400000"), (Q(10**6), "10⁶"),
        (Q(-4 * 10**7), "−4·10⁷"), (Q(1, 10**4), "0.0001"), (Q(5, 10**5), "5·10⁻⁵"), (Q(5, 4) * 10**20, "1.25·10²⁰"),
    ],
)  # fmt: skip
def test_label_says_the_number(x, shown):
    assert label(x) == shown


@given(low=fractions, high=fractions, start=fractions, end=fractions, x=fractions)
def test_scale_is_affine_and_hits_both_ends(low, high, start, end, x):
    assume(low < high)
    scale = Scale(low, high, start, end)
    assert (scale(low), scale(high)) == (start, end)
    assert scale(x) - scale(x - 1) == scale.per_unit == (end - start) / (high - low)


def test_scale_refuses_what_is_no_number():
    scale = Scale(Q(0), Q(1), Q(0), Q(1))
    assert scale(0.1) == Q(0.1) != Q(1, 10)
    for x in (float("inf"), float("nan")):
        with pytest.raises((OverflowError, ValueError)):
            scale(x)


@given(fractions)
def test_place_is_within_half_a_hundredth(x):
    assert abs(Q(place(x)) - x) <= Q(1, 200)
    assert place(x) != "-0"


def small_plot():
    return Plot(linear(Q(-1), Q(1), "x", (Q(0), Q(100))), linear(Q(-1), Q(1), "y", (Q(100), Q(0))))


def test_marks_are_where_their_numbers_are():
    plot = small_plot()
    plot.line([(-1.0, -1.0), (0.5, 1.0)], "a")
    plot.dots([(0.0, 0.0)], "b")
    plot.disc((Q(1, 3), 0), 5, "c", "third")
    plot.circle(0.5, "d")
    assert plot.drawn == [
        '<path class="a" d="M0 100L75 0"></path>',
        '<path class="b" d="M50 50h0"></path>',
        '<circle class="c" cx="66.67" cy="50" r="5"><title>third</title></circle>',
        '<circle class="d" cx="50" cy="50" r="25"></circle>',
    ]


def test_marks_part_the_distances_between_labels():
    (left, right), _ = frame(100, 100)
    for low, high, marks in ((0, 10, 8), (-4, 4, 6), (0, 2, 8), (-6, 6, 10)):
        axis = linear(Q(low), Q(high), "x", (left, right))
        found = axis.marks()
        assert len(found) == marks
        assert len({b - a for a, b in pairwise(sorted([*found, *axis.ticks]))}) == 1
    axis = decades(-13, 1, "error", (left, right))
    assert next(iter(axis.labelled())) == (-12, "10⁻¹²")
    assert len(axis.marks()) + len(axis.ticks) == 15, "every power of ten"
    axis = decades(-324, -10, "error", (left, right))
    assert {b - a for a, b in pairwise(sorted([*axis.marks(), *axis.ticks]))} == {10}
    assert decades(0, 2, "x", (left, right)).marks() == []
    assert [decades(0, high, "x", (left, right)).ticks[:2] for high in (6, 8)] == [[0, 2]] * 2, "four at least"
    for values, ends in (([0.0], (0, 2)), ([-3.5, 1.2], (-4, 2)), ([1.0, 3.0], (1, 3)), ([0.5, 1.5], (0, 2))):
        scale = decades_of(values, "x", (left, right)).scale
        assert (scale.low, scale.high) == ends, "whole decades around the values, two at least"


def test_axes_stand_where_their_numbers_are():
    """A frame of 100 by 60, 52 from the left and 26 from above: every place worked out by hand."""
    across, up = frame(100, 60)
    plot = Plot(linear(Q(0), Q(1), "x", across), decades(-1, 1, "<y>", up))
    shown = "".join(plot.axes())
    assert re.findall(r'class="(axis|grid|mark)" d="(.*?)"', shown) == [
        *(("axis", "M52 86V26"), ("grid", "M102 86V26"), ("grid", "M152 86V26")),
        *(("mark", f"M{x} 86v-4") for x in (62, 72, 82, 92, 112, 122, 132, 142)),
        *(("grid", f"M52 {y}H152") for y in (86, 56, 26)),
    ]
    assert re.findall(r'class="(\w+ \w)" x="(\d+)" y="(\d+)">(.*?)<', shown) == [
        *(("tick x", "52", "105", "0"), ("tick x", "102", "105", "0.5"), ("tick x", "152", "105", "1")),
        *(("tick y", "44", "86", "10⁻¹"), ("tick y", "44", "56", "1"), ("tick y", "44", "26", "10¹")),
        *(("name x", "102", "124", "x"), ("name y", "52", "15", "&lt;y&gt;")),
    ]
    plot.words("none")
    assert plot.drawn == ['<text class="name x" x="102" y="56">none</text>']
    assert 'viewBox="0 0 168 132"' in plot.picture("id", "A", "B")
    marked = Plot(decades(0, 4, "x", across), linear(Q(0), Q(1), "y", up))
    assert re.findall(r'class="mark" d="(M52 .*?)"', "".join(marked.axes()))[:2] == ["M52 80h4", "M52 74h4"]
