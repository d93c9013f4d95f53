"""A number's row or sentence says which method, step size, time and quantity it is about, and no more."""

from fractions import Fraction as Q

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.contradictions import asked_quantity

ABOVE = """The error is {}.

| h | AB2 |
| 0.5 | 0.77 |
"""
TABLE = """We take h = 0.1.

| t | Euler | error | RK4 | error |
| 0.5 | 0.61 | 0.02 | 0.6065 | 0.0001 |
"""


def place(text, number):
    (found,) = [x for x in numbers_in(text) if x.text == number]
    return Suggestions(text)._place_of(found)


@pytest.mark.parametrize(
    ("text", "methods", "settings", "quantity", "unknown"),
    [
        ("With h = 0.1 Heun's method gives y(1) = 0.77.", {"heun2"}, (Q(1, 10), 1), "state", "y"),
        ("Heun is off by 0.77 at t = 1, where h = 1/4, not h = 1/2", {"heun2"}, (Q(1, 4), 1), "error", None),
        ("t = 2. Euler's error\nfor h = 0.5 is,\nbriefly, 0.77.", {"forward_euler"}, (Q(1, 2), 2), "error", None),
        ("Errors aside, the exact solution is x = 0.77", set(), (None, None), "exact", "x"),
        ("RK4: the relative error is 0.77 %", {"rk4"}, (None, None), "percent", None),
        ("RK4: the relative error is 0.77", {"rk4"}, (None, None), "relative_error", None),
        ("RK4's error is 0.77 times as large", {"rk4"}, (None, None), "ratio", None),
        ("With h = 0.1 Heun's slope at t = 1 is 0.77", {"heun2"}, (Q(1, 10), 1), "slope", None),
        ("h = 0.1, so that k_2 = 0.77", set(), (Q(1, 10), None), "k2", None),
        ("h = 0.1, so that y_3 = 0.77", set(), (Q(1, 10), Q(3, 10)), "state", "y"),
        ("N_1' = -N_1, N_1(0) = 1. t = 3, h = 0.1. N_1 = 0.77", set(), (Q(1, 10), 3), "state", "n_1"),
        ("h = 0.1\n| n | S_n | I_n |\n| 4 | 1 | 0.77 |", set(), (Q(1, 10), Q(2, 5)), "state", "i"),
        ("h = 0.1\n| n | y_n | e_n |\n| 4 | 1 | 0.77 |", set(), (Q(1, 10), Q(2, 5)), "error", None),
        ("Heun, h = 0.1: y_2 = 1 - 0.2 + 0.01 = 0.77", {"heun2"}, (Q(1, 10), Q(1, 5)), "state", "y"),
        ("Heun, h = 0.1, t = 3. There y = a/b = 0.77", {"heun2"}, (Q(1, 10), 3), "calculation", "y"),
        ("h = 0.1\n| day | forward | I (RK4) |\n| 4 | 0.77 | 1 |", {"forward_euler"}, (Q(1, 10), 4), "state", None),
        ("h = 0.1\n| day | forward | I (RK4) |\n| 4 | 1 | 0.77 |", {"rk4"}, (Q(1, 10), 4), "state", "i"),
        ("RK4 has y = 0.1, y = 0.77 by Heun's method, but 0.1 by Euler's", {"heun2"}, (None, None), "state", "y"),
        ("From h = 0.2 to 0.1 Heun's error falls by the factor 0.77", {"heun2"}, (Q(1, 10), None), "ratio", None),
        ("It divides the error of Heun by 0.77", {"heun2"}, (None, None), "ratio", None),
        ("t = 1\n| method | y(1) |\n| exact | 0.77 |", set(), (None, 1), "exact", "y"),
        ("t = 1\n| method | RK4 |\n| error | 0.77 |", {"rk4"}, (None, 1), "error", None),
        ("Heun, h = 0.1, t = 3. At the start y = 0.77", {"heun2"}, (Q(1, 10), 0), "state", "y"),
        ("Heun, h = 0.1, t = 3. Its energy is initially 0.77", {"heun2"}, (Q(1, 10), 0), "energy", None),
        ("Heun, h = 0.1, t = 3\n| x | E |\n| 1 | 0.77 |", {"heun2"}, (Q(1, 10), 3), "energy", None),
        (
            "Heun's energy, h = 0.1: after 5 steps it grew by 0.77 %",
            {"heun2"},
            (Q(1, 10), Q(1, 2)),
            "part_of_energy",
            None,
        ),
        ("Heun, h = 0.1: E grows. Its amplitude grew by 0.77 %", {"heun2"}, (Q(1, 10), None), "percent", None),
        (
            "Heun, h = 0.1: it gains 0.77 % of its energy in each step",
            {"heun2"},
            (Q(1, 10), Q(1, 10)),
            "part_of_energy",
            None,
        ),
        ("Heun, h = 0.1, t = 3: E(0) = 0.77", {"heun2"}, (Q(1, 10), 0), "state", "e"),
        ("By Heun. There y(0) = 1, and 0.77 later, not RK4", {"heun2"}, (None, None), None, None),
    ],
)
def test_a_sentence_names(text, methods, settings, quantity, unknown):
    found = place(text, "0.77")
    assert found.methods == methods
    assert (found.settings.get("h"), found.settings.get("t")) == settings
    assert (found.quantity, found.unknown) == (quantity, unknown)


def test_a_cell_is_of_its_row_and_its_column_or_the_last_one_that_names_a_method():
    for number, methods, quantity in (
        ("0.61", {"forward_euler"}, "state"),
        ("0.02", {"forward_euler"}, "error"),
        ("0.6065", {"rk4"}, "state"),
        ("0.0001", {"rk4"}, "error"),
    ):
        found = place(TABLE, number)
        assert (found.methods, found.quantity, found.settings) == (methods, quantity, {"h": Q(1, 10), "t": Q(1, 2)})
    assert place(TABLE, "0.5").quantity == "chosen"
    assert place("t | y\n0.5 | 0.77", "0.77").settings == {"t": Q(1, 2)}
    for number, h in (("0.61", Q(1, 2)), ("0.77", Q(1, 4))):
        assert place("| h | y | h | y |\n| 0.5 | 0.61 | 0.25 | 0.77 |", number).settings == {"h": h}
    rows = "| method | y | error |\n| RK4 | 0.6065 | 1e-4 |"
    assert place(rows, "0.6065").methods == {"rk4"}


def test_a_row_is_of_the_method_that_its_first_cell_names():
    assert place("| Method | Order | Constant |\n| Adams-Bashforth 3 | 3 | 3/8 |", "3/8").methods == {
        "adams_bashforth3"
    }


def test_a_question_is_meant_if_all_that_it_names_is_named():
    run = "run rk4 y'=-y, y(0)=1, h=1/10, t=1/2 : "
    found = place(TABLE, "0.6065")
    assert found.means(f"{run}y", {"rk4"})
    for other in (f"{run}error", run.replace("1/10", "1/5") + "y", run.replace("t=1/2", "t=1") + "y", "order rk4"):
        assert not found.means(other, {"rk4"})
    assert not found.means(f"{run.replace('1/10', '1/5')}y - {run}y", {"rk4"}), "the first step size is asked for"
    two = "run heun2 x'=y, y'=-x from (1, 0) h=1/10, t=1 : "
    for said, meant in (("gives y(1) =", [True, False, False]), ("to t = 1 has", [True, True, False])):
        named = place(f"With h = 0.1 Heun's method {said} 0.77.", "0.77")
        assert [named.means(two + asked, {"heun2"}) for asked in ("y", "x", "evaluations")] == meant
    assert not found.means(f"{run}y", {"heun2"})
    ratio = "ratio(run rk4 y'=-y, h=1/5, t=1/2 : error, run rk4 y'=-y, h=1/10, t=1/2 : error)"
    assert place("RK4, t = 1/2 and h = 0.1: a factor of 15.9", "15.9").means(ratio, {"rk4"})
    assert not place("RK4, t = 1/2 and h = 0.3: a factor of 15.9", "15.9").means(ratio, {"rk4"})
    told = {
        "y": "state",
        "exact.y": "exact",
        "k2.y": "k2",
        "error.y": "error",
        "position_error": "error",
        "evaluations": "evaluations",
    }
    assert {readout: asked_quantity(run + readout)[0] for readout in told} == told
    assert asked_quantity(f"percent({run}relative_error, 1)") == ("percent", "")
    assert asked_quantity(f"percent({run}y, 1)")[0] == "share"
    assert [asked_quantity(f"{asked}y0")[1] for asked in (run, "run rk4 rates=(y0) : ")] == ["y0", ""]


def test_a_place_is_sure_of_its_time_if_that_stands_in_its_row_or_sentence():
    for text, sure in (
        ("To t = 1 with Heun. Then y = 0.77", False),
        ("With Heun y = 0.77 at t = 1", True),
        ("With Heun it has 0.77 at t = 1", False),
        ("Heun, h = 0.1: after two steps y = 0.77", True),
        ("Heun, h = 0.1: y_2 = 0.77", True),
        ("t = 1\n| h | y |\n| 0.1 | 0.77 |", True),
    ):
        assert place(text, "0.77").sure is sure, text


@pytest.mark.parametrize(("said", "quantity"), [("0.3", "state"), ("shown below", "error")])
def test_a_quantity_above_a_table_is_that_of_the_table_unless_its_own_value_is_given(said, quantity):
    assert place(ABOVE.format(said), "0.77").quantity == quantity


@pytest.mark.parametrize(
    ("text", "t"),
    [
        ("at t = 4 the energy has risen from {} to 1.99", 0),
        ("at t = 4 the error has fallen from {} to 0.02", 4),
    ],
)
def test_an_energy_that_changes_from_a_number_has_that_at_the_start(text, t):
    assert place(text.format("0.75"), "0.75").settings == {"t": t}
