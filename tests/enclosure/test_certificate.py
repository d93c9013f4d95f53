"""A certificate in words, as JSON and as a table: its decimals hold the balls, and its digits are counted."""

from __future__ import annotations

import json
from dataclasses import replace
from decimal import localcontext
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st

from driftproof.enclosure.certificate import (
    ALL_DIGITS,
    Certificate,
    Drift,
    Split,
    decimal,
    largest_of,
    largest_place,
    right_digits,
)
from driftproof.symbolic.algebra.certified import endpoints
from tests.looping import exactly

ROWS = ((arb(0), arb(-1).exp() - 0.4), (arb(0.25, 2**-60), arb(-0.75)), (arb(0.5), arb(1) / 3))
PLAIN = Certificate(
    t=(0.0, 0.5, 1.0), y=((1.0, 1.0),) * 3, errors=ROWS, digits_at=(17, 0, 1), bits=128, steps=7, doubles=(0.1, -3.7)
)
HALVES = tuple(tuple(x / 2 for x in row) for row in ROWS)
WHOLE = replace(
    PLAIN,
    split=Split("rk4", ROWS, HALVES, HALVES, 2, 256),
    drifts={"energy": Drift((arb(0), arb(2), arb(-3))), "<L>": Drift(*((arb(0), arb(1), arb(0)),) * 3)},
)


def test_words_say_where_and_what():
    assert str(PLAIN).splitlines() == [
        "largest error 0.7500000000, proved: component 1 at t = 0.5, point 1 of 0 to 2",
        "0 correct digits at every point, relative to its largest component; enclosure: 7 steps, 128 bits",
        "constants in f, each exactly this double: 0.1, -3.7",
    ]
    assert WHOLE.text().splitlines()[1:-2] == [
        "  there -0.7500000000 = truncation -0.3750000000 + rounding -0.3750000000 (rk4, steps: 2)",
        "largest truncation 0.3750000000: component 1 at t = 0.5, point 1 of 0 to 2",
        "largest rounding 0.3750000000: component 1 at t = 0.5, point 1 of 0 to 2",
        "energy: largest drift -3.000000000 at t = 1",
        "<L>: largest drift 1.000000000 at t = 0.5 = truncation 1.000000000 + rounding 1.000000000",
    ]


def test_rounding_of_an_implicit_run_holds_what_its_solver_left_unsolved():
    said = "rounding includes what the run's own solver, such as Newton's method, left unsolved"
    assert said in replace(WHOLE, split=replace(WHOLE.split, solved=True)).text()
    assert said not in WHOLE.text()


def test_as_many_times_as_components_leave_open_which_are_which_so_it_is_said():
    """Rows that are columns of SciPy's y are another run, and no other shape of y shows it."""
    words = "there are as many times as components; y was read so that y(0.5) = (1.0, 2.0)"
    assert words in replace(PLAIN, t=(0.0, 0.5), y=((0.0, 1.0), (1.0, 2.0)), errors=ROWS[:2]).text()
    assert "as many times" not in WHOLE.text()


def test_words_name_a_few_of_thousands_of_constants():
    found = replace(WHOLE, doubles=tuple(k + 0.1 for k in range(10_000)))
    assert found.text().endswith("\n10000 constants in f, each exactly this double: 0.1, 1.1, 2.1, ...")
    assert len(found.record()["doubles"]) == 10_000


def test_json_holds_every_ball():
    record = json.loads(WHOLE.json())
    for rows, balls in ((record["errors"], ROWS), (record["split"]["truncation"], HALVES)):
        for row, wanted in exactly(3, zip(rows, balls, strict=True)):
            for ball, x in exactly(2, zip(row, wanted, strict=True)):
                low, high = endpoints(x)
                middle, radius = Fraction(ball["midpoint"]), Fraction(ball["radius"])
                assert middle - radius <= low <= high <= middle + radius
                assert radius <= 2 * (high - low) + Fraction(1, 10**24)
    with localcontext(prec=6):
        assert json.loads(WHOLE.json()) == record
    assert record["largest_error"] == {
        "component": 1, "midpoint": "7.5e-1", "point": 1, "radius": "0", "t": "0.5"
    }  # fmt: skip
    assert (record["digits"], record["doubles"], record["t"]) == (0, ["0.1", "-3.7"], ["0.0", "0.5", "1.0"])
    assert set(record["drifts"]["energy"]) == {"total"}
    assert not {"split", "drifts"} & set(json.loads(PLAIN.json()))


def test_notebook_shows_a_table_of_few_points():
    html = WHOLE._repr_html_()
    assert html.count("<tr>") == 4
    assert "&lt;L&gt;" in html
    assert "<th>rounding</th>" in html
    many = replace(PLAIN, t=(0.0,) * 1000, errors=ROWS[:1] * 1000, digits_at=(17,) * 1000)
    assert many._repr_html_().count("<tr>") == 13


@pytest.mark.parametrize(
    ("ball", "words"),
    [
        (arb(0), "0"), (arb(-0.75), "-0.7500000000"), (arb("1.23456789012e-4"), "0.0001234567890"),
        (arb("1.23456789012e-5"), "1.234567890e-5"), (arb(0.9, 0.2), "[+/- 1.11]"), (arb(0, 0.5), "[+/- 0.501]"),
        (arb("nan"), "nan"), (arb(1, 2**-10), "1.0"), (arb(2) ** -(10**6), "[1.01e-301030 +/- 3.42e-301035]"),
    ],
)  # fmt: skip
def test_decimal_has_the_digits_that_the_ball_has(ball, words):
    assert decimal(ball) == words


@given(st.integers(10**12, 10**13), st.integers(1, 10**4))
def test_both_ends_of_a_ball_round_to_its_decimal(middle, radius):
    with ctx.workprec(128):
        words = decimal((middle + arb(0, radius)) / 10**12)
    places = len(words.partition(".")[2])
    assert all(round(Fraction(end, 10**12), places) == Fraction(words) for end in (middle - radius, middle + radius))


@pytest.mark.parametrize(
    ("row", "place"),
    [
        ((arb(1, 2**-300), arb(1, 2**-299)), 1), ((arb(10) ** -400, -(arb(10) ** -330)), 1),
        ((arb(10) ** 430, arb(10) ** 400), 0), ((arb(1), arb(-1), arb(1)), 0), ((arb(1, 2**-300), arb(1)), 0),
    ],
)  # fmt: skip
def test_the_largest_place_is_that_of_the_larger_of_any_two_sizes(row, place):
    assert largest_place([(), row]) == (1, place)


def test_largest_is_a_ball_of_the_largest_size():
    assert largest_of(ROWS, 128) == arb(0.75)
    assert largest_of([], 128) == 0
    assert replace(PLAIN, y=((0.25, 0.5),), errors=((arb(0.25), arb(-0.5)),)).digits_of == (None, 0)


@pytest.mark.parametrize(
    ("error", "true", "digits"),
    [
        ((arb(0), arb(0)), (arb(1), arb(2)), ALL_DIGITS), ((arb(1e-7), arb(0)), (arb(1), arb(100)), 9),
        ((arb(10), arb(0)), (arb(1), arb(0)), 0), ((arb(1), arb(0)), (arb(0), arb(0)), 0),
    ],
)  # fmt: skip
def test_digits_are_those_of_the_largest_component(error, true, digits):
    with ctx.workprec(128):
        assert right_digits(error, true) == digits
