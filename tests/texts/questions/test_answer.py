"""Answers: published values asked for by id, how many digits there are, and what has none."""

from fractions import Fraction as Q

import pytest
from flint import ctx

from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.texts.questions.answer import as_printed
from driftproof.texts.questions.decimals import Style
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.values.published import published_values
from tests.texts.questions.refusals import require_refusal
from tests.texts.questions.steps_by_hand import BY_HAND

HALF_EVEN = Style(rounding="half-even")

# Published ids, and a free question that has the same answer.
EQUIVALENT = {
    "compare.h": "1/2", "exact.energy": "exact t=10 : energy", "exact.first_step.q": "exact t=1/2 : q",
    "exact.first_step.v": "exact t=1/2 : v", "exact.default.q": "exact t=10 : q",
    "exact.default.v": "run rk4 h=1/4 t=10 : exact.v", "default.steps": "run rk4 h=1/4 t=10 : steps",
    "small_steps.steps": "run rk4 h=1/10 t=10 : steps", "rk4.stages": "stages rk4",
    "rk4.exercise_2.evaluations": "run rk4 N=25 t=10 : evaluations",
    "forward_euler.exercise_2.evaluations": "run forward_euler N=100 t=10 : evaluations",
    "forward_euler.exercise_1.q": "step forward_euler h=1/2 from 0,1 : q",
    "forward_euler.exercise_1.v": "step forward_euler h=1/2 from 0,1 : v",
    "forward_euler.exercise_1.energy": "step forward_euler h=1/2 from 0,1 : energy",
    "symplectic_euler.exercise_1.q": "step symplectic_euler h=1/2 from 0,1 : q",
    "symplectic_euler.exercise_1.invariant": "invariant symplectic_euler h=1/2 from 0,1",
    "quarter_cycle.state_error": "sqrt(2)",
    **{f"rk4.first_step.k{i}.{x}": f"step rk4 h=1/2 : k{i}.{x}" for i in (1, 2, 3, 4) for x in "qv"},
    **{f"{key}.first_step.{x}": f"step {key} h=1/2 : {x}" for key in BY_HAND for x in ("q", "v", "energy")},
    **{f"{key}.evaluations_per_step": f"step {key} h=1/2 : evaluations" for key in BY_HAND},
    **{
        f"{key}.default.{x}": f"run {key} h=1/4 t=10 : {x}"
        for key in BY_HAND
        for x in ("energy", "energy_change", "evaluations", "state_error")
    },
    **{f"forward_euler.default.{x}": f"run forward_euler h=1/4 t=10 : {x}" for x in ("q", "v", "phase_error")},
    **{
        f"symplectic_euler.stability_boundary.step{n}.{x}": f"step symplectic_euler h=2 N={n} : {x}"
        for n in (1, 2, 3, 5)
        for x in "qv"
    },
}  # fmt: skip


@pytest.mark.parametrize("key", EQUIVALENT)
def test_published_value_is_the_answer_to_a_free_question(key):
    published, free = value(key), value(EQUIVALENT[key])
    assert published.digits(25, HALF_EVEN) == free.digits(25, HALF_EVEN)
    entry = published_values()[key]
    if entry["exact"] is not None and "sin" not in entry["exact"] and "cos" not in entry["exact"]:
        assert published.exact == free.exact
    assert published.exact_text == entry["exact"]
    assert published.evidence == entry["evidence"]


def test_every_published_value_can_be_asked_for_and_most_have_a_question():
    ids = published_values()
    for key in ids:
        assert value(key).digits(20, HALF_EVEN).strip("0.-") != "" or ids[key]["exact"] == "0"
    assert set(EQUIVALENT) <= set(ids)
    assert len(EQUIVALENT) >= 50


def test_published_decimal_stands_for_all_numbers_that_round_to_it():
    with ctx.workprec(128):
        low, high = endpoints(enclose(as_printed({"decimal": "-1.250e-7", "evidence": "CERTIFIED"}).exact))
    half = Q(1, 2 * 10**10)
    assert low <= Q(-125, 10**9) - half
    assert high >= Q(-125, 10**9) + half
    assert high - low < half * Q(2001, 1000)


def test_answer_is_shown_as_it_is_printed():
    assert repr(value("337/384")) == str(value("337/384")) == "0.877604166666667, exactly 337/384  (DERIVED)"


def test_value_without_an_exact_form_has_its_published_digits_and_no_more():
    key = "rk4.default.state_error"
    assert value(key).digits(24) == published_values()[key]["decimal"][:29]
    with pytest.raises(ValueError, match="which does not determine more digits"):
        value(key).digits(40)


@pytest.mark.parametrize(("n", "reason"), [(0, "must be at least 1"), (10_001, "at most 10000"), (10**9, "at most")])
def test_number_of_digits_has_its_bounds(n, reason):
    with pytest.raises(QuestionError, match=f"column 1: .*{reason}"):
        value("1/3").digits(n)
    assert value("1/3").digits(10_000) == "0." + "3" * 10_000


def test_what_is_no_number_has_no_decimals():
    for question in ("energy_multiplier rk4", "a_stable rk4", "real_limit backward_euler"):
        assert not value(question).is_number
        require_refusal(question, 1, "is not a number and has no decimals")
    with pytest.raises(QuestionError, match="is not a number"):
        float(value("a_stable rk4"))


def test_number_that_no_enclosure_decides_is_an_error_and_not_a_guess():
    nothing = "(run rk4 h=1/4 t=10 : state_error) - (run rk4 h=1/4 t=10 : state_error)"
    conserved = "run gauss2 x'=v, v'=-x, x(0)=pi/4, v(0)=0, energy=x^2+v^2 h=1/2 t=1 : largest_energy_change"
    for question in (nothing, conserved):
        require_refusal(question, 1, "undecided with 131072 bits: 0, which no enclosure shows, or below 1e-394")
    require_refusal("0.1234565", 1, "tie")
    with pytest.raises(QuestionError, match="column 1: the number has no exact form"):
        value("2*pi").tex()


def test_an_exact_form_of_24_characters_is_shown_beside_its_decimal_and_15_digits_unasked():
    for digits, shown in ((22, True), (23, False)):
        assert (", exactly 1/3" in value(f"1/{'3' * digits}").written("text")) is shown
    assert value("1/7").written("text").startswith("0.142857142857143,")
    assert value("stages rk4").written("text") == "4  (COUNTED)"
    assert '"decimal": "0.142857142857143"' in value("1/7").written("json")


def test_digits_and_places_are_taken_in_every_form():
    for form, written in {"text": "0.02", "md": "0.02", "tex": "0.02", "mathml": "<mn>0.02", "json": '"0.02'}.items():
        assert f"{written}9" in value("2/70").written(form, places=3)
        assert f"{written}86" in value("2/70").written(form, digits=3)
