"""Whatever is asked, the language answers or refuses in one line."""

from contextlib import suppress
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from docs.language_tables import questions_of
from driftproof.methods.formulas.expression_tree import ExpressionParser
from driftproof.texts.questions import evaluate
from driftproof.texts.questions.decimals import ROUNDING_POLICIES, Style
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.questions.evaluate import value

REFUSED = questions_of("refusals")
QUESTIONS = (*questions_of("runs", "facts", "arithmetic"), *REFUSED)
ASKED = QUESTIONS
# What a question may be made of, and what an attacker would put into it.
PIECES = sorted(
    {token.text for asked in ASKED for token in ExpressionParser(asked.replace("'", "")).tokens}
    | {"1e1200", "1e-1200", "9" * 60, "h=1e300", "N=1000000000000", "t=1e1000", "gauss10", "yoshida8", "ssprk40_2"}
    | {"**64", "((", "))", "at", "from", ",", "=", "{{", "\x00", "é", "−", "\n", "__class__", ".", "..", "0"}
)


def answer_or_refuse(question):
    """Ask for everything that can be asked for. Only QuestionError may come, and on one line."""
    try:
        answer = value(question)
        assert answer.evidence in ("PROVED", "DERIVED", "COUNTED", "CERTIFIED", "STATED")
        assert answer.exact_text != ""
        for rounding in (None, *ROUNDING_POLICIES):
            for ask_for in (answer.digits, answer.places):
                with suppress(AmbiguousRounding):
                    assert ask_for(3, Style(rounding)).strip("-0123456789.e") == ""
        answer.tex()
        answer.mathml()
    except QuestionError as refusal:
        assert str(refusal).count("\n") == 0  # noqa: PT017 - whether there is a refusal is not the question
        assert 1 <= refusal.column <= len(refusal.text) + 1  # noqa: PT017 - Greek letters are spelled out there


@given(st.text(max_size=60))
def test_any_text_is_answered_or_refused(text):
    answer_or_refuse(text)


@given(st.lists(st.sampled_from(PIECES), max_size=14).map(" ".join))
def test_any_row_of_words_is_answered_or_refused(text):
    answer_or_refuse(text)


@st.composite
def mutated(draw):
    """A question with a few pieces cut out, put in or doubled."""
    text = draw(st.sampled_from(QUESTIONS))
    for _ in range(draw(st.integers(1, 3))):
        at, cut = draw(st.integers(0, len(text))), draw(st.integers(0, 3))
        put = draw(st.sampled_from(PIECES) | st.text("0123456789().:,=/*+-^ hqvtNz_eE", max_size=3))
        text = text[:at] + put + text[at + cut :]
    return text


@given(mutated())
@settings(suppress_health_check=[HealthCheck.too_slow])
def test_any_mutated_question_is_answered_or_refused(text):
    answer_or_refuse(text)


@pytest.mark.slow
@settings(max_examples=30)  # a difference of equal numbers takes a while to be refused
@given(st.sampled_from(QUESTIONS), st.sampled_from(QUESTIONS), st.sampled_from("+-*/"), st.integers(-70, 70))
def test_any_two_questions_in_arithmetic_are_answered_or_refused(a, b, sign, power):
    answer_or_refuse(f"({a}) {sign} ({b})")
    answer_or_refuse(f"log2(({a}) ** {power})")


def test_fuzzing_would_notice_another_exception(monkeypatch):
    def broken(question):
        raise KeyError(question)

    monkeypatch.setattr(evaluate, "parse_question", broken)
    with pytest.raises(KeyError):
        answer_or_refuse("1 + 1 + 1")


def test_fuzzing_reaches_answers_and_not_only_refusals():
    answered = 0
    for question in QUESTIONS:
        with suppress(QuestionError):
            answered += value(question) is not None
    assert answered >= len(QUESTIONS) - len(REFUSED)


def test_a_number_that_is_enclosed_prints_its_digits_and_a_ball_where_there_are_none():
    assert repr(value("exact t=10 : q").exact) == "-0.839071529076452"
    assert repr(value("sin(pi)").exact).startswith("[+/-")


def test_a_question_is_text():
    with pytest.raises(TypeError, match="a question is a string, such as 'order rk4', not 3"):
        value(3)


@pytest.mark.parametrize(
    ("text", "question", "edit", "before", "after"),
    [
        (
            'family = "runge_kutta"\nA = [[0, 0], ["1/2", 0]]\nb = [0, 1]\n',
            "step mine.toml h=1/2 : q", ("[0, 1]", "[1, 0]"), Fraction(7, 8), 1,
        ),
        (
            'rates = ["-y0"]\nstart = ["1"]\nend = "1"\n', "run forward_euler problem=mine.toml h=1/2 t=1 : y0",
            ("-y0", "y0"), Fraction(1, 4), Fraction(9, 4),
        ),
    ],
)  # fmt: skip
def test_file_that_was_edited_is_read_anew(text, question, edit, before, after, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(text, encoding="utf-8")
    assert value(question).exact == before
    Path("mine.toml").write_text(text.replace(*edit), encoding="utf-8")
    assert value(question).exact == after
