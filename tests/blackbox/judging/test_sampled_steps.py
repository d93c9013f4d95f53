"""Steps that are drawn lie in their domain and at its edges, alike on every run; the simplest is simple, and fails."""

from fractions import Fraction
from itertools import islice

import pytest

from driftproof.blackbox.judging.sampled_steps import Sizes, simplest_step, steps_within
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FORMATS
from tests.blackbox.transcripts import Asked, checksum
from tests.looping import exactly

STEPS, STATES = Sizes(2.0**-20, 2.0, BINARY64), Sizes(2.0**-60, 1000.0, BINARY64)
DRAWN = list(islice(steps_within(STEPS, STATES), 1000))


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("low", [0.0, 2.0**-5])
def test_every_number_is_one_of_the_format_within_its_ends(name, low):
    steps, states = (Sizes(low, high, FORMATS[name]) for high in (2.0, 1000.0))
    drawn = exactly(300, islice(steps_within(steps, states), 300))
    assert all(FORMATS[name].holds(Fraction(x)) for step in drawn for x in step)
    assert all(low <= h <= 2 and h > 0 for _, _, h in drawn)
    assert all(x == 0 or low <= abs(x) <= 1000 for step in drawn for x in step[:2])


KINDS = {
    "origin": (lambda q, v, h: q == v == 0, 5),
    "no position": (lambda q, v, h: q == 0 != v, 50),
    "no velocity": (lambda q, v, h: v == 0 != q, 50),
    "equal": (lambda q, v, h: q == v != 0, 15),
    "opposite": (lambda q, v, h: q == -v != 0, 15),
    "cancelling": (lambda q, v, h: abs(v - h * q) < 1e-3 * abs(v), 5),
    "alike": (lambda q, v, h: 1 / 4 < abs(q / v if v else 0) < 4, 250),
    "tiny": (lambda q, v, h: 0 < abs(q) < 2.0**-40, 100),
    "large": (lambda q, v, h: 500 < abs(q) <= 1000, 50),
    "ends of h": (lambda q, v, h: h in (2.0, 2.0**-20), 10),
    "h is 1": (lambda q, v, h: h == 1, 5),
    "full": (lambda q, v, h: h.as_integer_ratio()[0].bit_length() >= 50, 300),
    "powers of two": (lambda q, v, h: h.as_integer_ratio()[0] == 1, 50),
    "smallest": (lambda q, v, h: min(abs(q), abs(v)) == 2.0**-60, 5),
}


@pytest.mark.parametrize(("is_met", "least"), KINDS.values(), ids=KINDS)
def test_of_a_thousand_steps_so_many_are_of_this_kind(is_met, least):
    assert sum(is_met(*step) for step in DRAWN) >= least


def test_all_floats_reach_down_to_the_smallest_and_do_not_overflow():
    everything = Sizes(0.0, 1.7e308, BINARY64)
    drawn = {abs(q) for q, _, _ in islice(steps_within(everything, everything), 1000)}
    assert min(drawn - {0.0}) < 1e-320
    assert max(drawn) == 1.7e308


def test_narrow_formats_keep_away_from_underflow():
    assert Sizes(2.0**-60, 1.0, BINARY16).least == 2.0**-7
    assert Sizes(2.0**-100, 1.0, BINARY32).least == 2.0**-63


@pytest.mark.parametrize(
    ("fails", "failing", "simplest"),
    [
        pytest.param(lambda step: True, (3.7, -2.2, 0.3), (0.0, 0.0, 1.0), id="all"),
        pytest.param(lambda step: step[0] != 0, (3.7, -2.2, 0.3), (1.0, 0.0, 1.0), id="q"),
        pytest.param(lambda step: step[0] < 0, (-3.7, -2.2, 0.3), (-1.0, 0.0, 1.0), id="q < 0"),
        pytest.param(lambda step: step[1] > 100, (3.7, 812.3, 0.3), (0.0, 101.0, 1.0), id="v > 100"),
        pytest.param(lambda step: step[1] < -900, (3.7, -912.3, 0.3), (0.0, -901.0, 1.0), id="v < -900"),
        pytest.param(lambda step: 1 < step[0] < 1.4, (1.3456, 2.2, 0.3), (1.25, 0.0, 1.0), id="1 < q < 1.4"),
        pytest.param(lambda step: 0.09 < step[2] < 0.11, (1.5, 2.2, 0.101), (0.0, 0.0, 0.09375), id="h about 0.1"),
        pytest.param(lambda step: 0 < abs(step[0]) < 1e-15, (7.1e-17, 2.2, 0.3), (2.0**-50, 0.0, 1.0), id="tiny q"),
        pytest.param(lambda step: step == (3.7, -2.2, 0.3), (3.7, -2.2, 0.3), (3.7, -2.2, 0.3), id="one"),
    ],
)
def test_the_simplest_step_that_fails_is_of_few_short_numbers(fails, failing, simplest):
    assert simplest_step(fails, failing, STEPS, STATES) == simplest


def test_the_simplest_step_lies_in_a_small_domain():
    small = Sizes(0.01, 0.1, BINARY64), Sizes(1e-3, 0.7, BINARY64)
    assert simplest_step(lambda step: step[0] != 0, (0.6, 0.3, 0.05), *small) == (0.5, 0.0, 0.0625)
    ends = Sizes(0.3125, 0.3125, BINARY64), Sizes(0.625, 7.0, BINARY64)
    assert simplest_step(lambda step: 0 < step[0] < 0.7, (0.6999, 3.3, 0.3125), *ends) == (0.625, 0.0, 0.3125)
    assert simplest_step(lambda step: step[0] > 6.5, (6.77, 3.3, 0.3125), *ends) == (7.0, 0.0, 0.3125)


def test_after_the_simplest_of_all_six_hundred_simpler_steps_are_asked_for_at_most():
    asked: list[object] = []
    fails = lambda step: asked.append(step) or (len(asked) > 4**3 and len(asked) % 29 == 0)
    assert simplest_step(fails, (612.7183, -3.2512345, 0.0123456), STEPS, STATES) == (514.0, 0.0, 0.0123456)
    assert len(asked) == 4**3 + 600


def test_simple_numbers_lie_within_up_to_the_ends_or_are_the_largest_power_of_two_there_or_the_largest():
    ends = {(1.0, 2.0): [1.0, 2.0, -1.0], (2.5, 3.5): [3.5], (4.0, 7.5): [4.0], (1.5, 2.0): [2.0]}
    assert {each: Sizes(*each, BINARY64).simple(1.0, 2.0, -1.0, 0.5, 8.0) for each in ends} == ends


FAILING = {
    "large": lambda q, v, h: abs(q) + abs(v) > 417.3,
    "steep": lambda q, v, h: abs(v) > 3.7 * abs(q) + 0.01,
    "short": lambda q, v, h: h < 0.013,
    "long": lambda q, v, h: h > 1.371 and q < -0.3,
    "narrow": lambda q, v, h: 0.2913 < h < 0.2917 and v > 0,
    "tiny": lambda q, v, h: 0 < abs(q) < 1e-9,
    "odd": lambda q, v, h: q != int(q) and v < 0,
    "of no rule": lambda q, v, h: hash((q, v, h)) % 40 == 0,
    "just so": lambda q, v, h: abs(q * h - v) < 1e-4 < abs(v),
}
STARTS = [(0.3, -0.7, 0.2915), (612.7, -3.25, 0.0123), (-0.75, 0.1, 1.9)]
STARTS += [(7.7e-12, 2.2, 0.29155), (2.5, 0.71, 0.2840001)]


@pytest.mark.parametrize("name", FAILING)
def test_the_steps_that_are_asked_for_before_the_simplest_are_what_they_were(name, as_before):
    found, fails = [], FAILING[name]
    for start in [*STARTS, *(step for step in DRAWN if fails(*step))][:9]:
        asked = Asked(lambda q, v, h: fails(q, v, h))
        found.append((simplest_step(lambda step, asked=asked: asked.code(*step), start, STEPS, STATES), str(asked)))
    as_before(*found)


def test_the_steps_that_are_drawn_are_what_they_were(as_before):
    ends = [(a, b, f) for a, b in ((0.0, 0.0), (1e-3, 0.1)) for f in FORMATS.values()]
    domains = [(STEPS, STATES), *((Sizes(a, 0.3, f), Sizes(b, 70.0, f)) for a, b, f in ends)]
    drawn = [list(islice(steps_within(*each), 300)) for each in domains]
    corners = [(s.least, s.most, s.corners, s.simple(1.0, 2.0, 0.25)) for each in domains for s in each]
    as_before(*(steps[7] for steps in drawn), checksum(str(drawn)), checksum(str(corners)))
