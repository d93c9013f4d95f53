"""Answers about steps and runs: exact forms beside certified decimals, null where there is none, and as a table."""

from fractions import Fraction as Q

from driftproof import METHODS, OscillatorRun
from driftproof.methods.numbers.number_field import square_root
from driftproof.texts.writing.answers import answer_text, exact_and_decimal, run_answer, step_answer

START = (Q(1), Q(0))


def run_of(key, h, t, start=START):
    return OscillatorRun(METHODS[key], h, t, start)


def test_number_has_an_exact_form_a_decimal_and_perhaps_a_unit():
    assert exact_and_decimal(Q(337, 384), 6) == {"exact": "337/384", "decimal": "0.877604"}
    assert exact_and_decimal(square_root(2), 4, "away", "m") == {"exact": "sqrt(2)", "decimal": "1.415", "unit": "m"}
    assert exact_and_decimal(None, 6) is None
    long = Q(10**5000 + 1, 10**5000)
    assert exact_and_decimal(long, 3)["exact"] == f"1{'0' * 4999}1/1{'0' * 5000}"


def test_run_counts_its_evaluations_where_the_method_says_how_many():
    answer, other = (run_answer(run_of(key, Q(1, 4), Q(10)), 6, "half-even") for key in ("rk4", "implicit_midpoint"))
    assert (answer["steps"], answer["evaluations"], other.get("evaluations")) == (40, 160, None)
    assert (answer["exact_state"]["q"]["exact"], answer["phase_error"]["unit"]) == ("cos(10)", "degrees")


def test_text_has_short_exact_forms_and_says_what_is_undefined():
    lines = answer_text(step_answer(run_of("rk4", Q(1, 2), Q(1, 2)), 6, "half-even")).splitlines()
    assert lines[0] == "Classical RK4 (rk4): one step of h = 1/2 from (1, 0)"
    assert lines[2].split() == ["final", "state", "q", "0.877604", "exactly", "337/384"]
    assert lines[-1] == "6 digits, rounded half-even, certified"
    at_rest = answer_text(run_answer(run_of("rk4", Q(1, 4), Q(1), (Q(0), Q(0))), 6, "half-even"))
    assert "phase error    undefined at the origin" in at_rest


def test_exact_forms_of_up_to_24_characters_are_shown():
    for q, shown in ((Q(10**11 + 3, 10**10), True), (Q(10**11 + 3, 10**11), False)):
        text = answer_text(step_answer(run_of("forward_euler", Q(1, 2), Q(1, 2), (q, Q(0))), 6, "half-even"))
        assert len(str(q)) == (24 if shown else 25)
        assert (f"exactly {q}" in text) is shown
