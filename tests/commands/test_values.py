"""`driftproof value`, `values` and `diff`: bare numbers for texts, every format, and what is refused."""

import json
import shlex

import pytest

from driftproof.symbolic.facts import FACTS
from driftproof.texts.questions import errors, evaluate
from driftproof.texts.questions.runs import RUN_READOUTS

ANSWERS = {
    "rk4.first_step.q": "0.877604166666667, exactly 337/384  (PROVED)",
    "rk4.first_step.q --digits 6": "0.877604", "rk4.first_step.v --places 3": "-0.479",
    "rk4.first_step.v --places 3 --style printed": "−0.479",
    "'1/30000000' --digits 2 --style printed": "3.3×10⁻⁸", "'1/8' --places 2 --rounding half-even": "0.12",
    "'1/8' --places 2 --rounding half-away": "0.13",
    "'5/2' --places 0 --rounding away": "3", "'-2.5' --places 0 --rounding half-even": "-2",
    "'1/2'": "0.500000000000000, exactly 1/2  (DERIVED)",
    "'run rk4 h=1/4 t=10 : evaluations'": "160  (COUNTED)",
    "'step symplectic_euler h=2 N=5 : v' --style printed": "−10  (DERIVED)",
    "'energy_multiplier rk4'": "1 - h**6/72 + h**8/576  (DERIVED)",
    "'energy_multiplier rk4' --format tex": r"1-\frac{h^{6}}{72}+\frac{h^{8}}{576}",
    "'energy_multiplier rk4' --format md": r"$1-\frac{h^{6}}{72}+\frac{h^{8}}{576}$",
    "rk4.first_step.q --format tex --digits 3": "0.878", "rk4.first_step.q --format md --digits 3": "0.878",
    "'1/2' --format mathml": "<math><mfrac><mn>1</mn><mn>2</mn></mfrac></math>",
    "'sqrt(2)' --format mathml": "<math><msqrt><mn>2</mn></msqrt></math>",
    "'2**(1/3)' --format mathml": "<math><mroot><mn>2</mn><mn>3</mn></mroot></math>",
    "'run forward_euler h=1/4 t=10 : phase_error deg'": "-11.5080564137641 degrees  (CERTIFIED)",
    "'run forward_euler h=1/4 t=10 : phase_error deg' --places 3": "-11.508",
    "'a_stable radau_iia2'": "yes  (DERIVED)",
}  # fmt: skip


@pytest.mark.parametrize("line", ANSWERS)
def test_answers_to_the_letter(line, answer):
    assert answer("value", *shlex.split(line)) == f"{ANSWERS[line]}\n"


def test_what_the_help_says_of_errors_and_their_signs_is_so(answer):
    assert "nor has error.x; (run ... : x) - (run ... : exact.x) has one" in answer("value", "--help")
    run = "run forward_euler x'=x, x(0)=1, h=1, t=1"  # 2 - e
    size, signed = answer("value", f"{run} : error.x"), answer("value", f"({run} : x) - ({run} : exact.x)")
    assert (signed[0], size) == ("-", signed[1:])


def test_json_says_everything(answer):
    assert json.loads(answer("value", "step rk4 h=1/2 : v", "--digits", "3", "--format", "json")) == {
        "question": "step rk4 h=1/2 : v", "exact": "-23/48", "decimal": "-0.479", "rounding": "half-even",
        "unit": None, "evidence": "DERIVED",
    }  # fmt: skip
    formula = json.loads(answer("value", "energy_multiplier rk4", "--format", "json"))
    assert (formula["exact"], formula["decimal"]) == ("1 - h**6/72 + h**8/576", None)


def test_list_names_everything_that_can_be_asked(answer):
    shown = answer("value", "--list")
    for name in (*RUN_READOUTS, *FACTS, "ratio", "sdirk_order_2", "rk4.first_step.q", "turns"):
        assert name in shown


def test_answer_that_takes_too_long_is_given_up(refusal, monkeypatch):
    def for_ever(question):
        while question:
            pass

    monkeypatch.setattr(evaluate, "value", for_ever)
    monkeypatch.setattr(errors, "QUESTION_SECONDS", 0.05)
    assert "no answer within 0.05 seconds" in refusal("value", "order rk4")


REFUSED = {
    ("value",): "give a question in quotes, --only PATTERN or --list",
    ("value", "1/8", "--places", "2"): "half-even gives 0.12, half-away 0.13; choose a rounding",
    ("value", "1/3", "--digits", "0"): "'0' is not allowed: the number of digits must be from 1 to 10000",
    ("value", "1/3", "--places", "1", "--digits", "1"): "not allowed with argument",
    ("value", "energy_multiplier rk4", "--digits", "3", "--format", "json"): "is not a number and has no decimals",
    ("value", "run rk4 h=1/4 t=10 : state_error", "--format", "tex"): "has no exact form; add digits or places",
    ("value", "step rk5 h=1/2 : q"): "'step rk5 h=1/2 : q', column 6: unknown method 'rk5'",
    ("value", "two\nlines rk4"): "'two lines rk4', column 1: 'two lines' is not a known fact or readout",
    ("value", "rk4.first_step.q", "--only", "*"): "a question cannot be combined with --list or --only",
    ("value", "--list", "--digits", "3"): "--digits has no effect with --list",
    ("value", "--only", "*", "--digits", "3"): "--digits has no effect with --only",
    ("value", "--only", "*", "--style", "plain"): "--style has no effect with --only",
    ("value", "1", "--format", "js"): "--format js needs --only PATTERN",
    ("value", "--only", "*", "--format", "mathml"): "--format mathml takes one question; with --only, choose from json",
    ("values", "--only", "no such id"): "no published value has an id that matches 'no such id'",
    ("values", "--format", "xml"): "invalid choice: 'xml'",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)
