"""What a number might be is suggested, the best first, and drafted claims hold of the text they are drafted from."""

from __future__ import annotations

import re
import sys
import tomllib
from collections import Counter
from collections.abc import Callable
from fractions import Fraction as Q
from pathlib import Path
from types import FrameType

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.texts.claims import drafting
from driftproof.texts.claims.checking import GIVEN, UNCOVERED, WORKED_OUT, check_claims, coverage
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.claims.drafting import LookAlike, Suggestions, draft
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.document import Document, document_of, read_document
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import exactly

ROOT = Path(__file__).parents[3]
SPRING = ROOT / "examples" / "text" / "spring.md"


def suggested(text: str) -> list[list[LookAlike]]:
    suggestions = Suggestions(text)
    return [suggestions.of(number) for number in numbers_in(text) if number.label is None]


@pytest.mark.parametrize(
    ("text", "best"),
    [
        ("one step of RK4 leads to the position 337/384", "rk4.first_step.q"),
        ("one step of RK4 leads to 0.877604", "rk4.first_step.q"),
        ("forward Euler's state error is 2.390 at the end", "forward_euler.default.state_error"),
        ("with RK4, h = 1/8 and t = 2: energy change -1.26e-7", None),
        ("RK4, h = 1/5, t = 2: the state error is 2.7e-5", "run rk4 h=1/5 t=2 : state_error"),
        ("RK4 is stable up to 2.828", "imaginary_limit rk4"),
        (
            "the Crank-Nicolson method, h = 1/5 and t = 2: the state error is 6.63e-3",
            "run trapezoid h=1/5 t=2 : state_error",
        ),
        ("nothing like it: 0.123456", None),
        ("not a number 1/0", None),
    ],
)
def test_best_suggestion_is_the_value_whose_names_are_near(text: str, best: str | None) -> None:
    *_, last = suggested(text)
    assert (last[0].question if last else None) == best


def test_suggestion_is_strong_only_where_the_digits_or_the_names_say_so() -> None:
    assert [candidate.strong for candidate in suggested("about 0.877604")[0]] == [True, True]
    for text, strong in (("0.5", False), ("2.4", False), ("2.39", False), ("0.090", False)):
        assert {candidate.strong for candidate in suggested(f"about {text}")[0]} == {strong}, text
    assert suggested("forward Euler's state error is 2.390 at the end")[-1][0].strong
    exact = [value(candidate.question).exact == Q(1, 2) for candidate in suggested("about 0.5")[0]]
    assert exact == sorted(exact, reverse=True), "what is equal stands before what is rounded"
    assert {*exact} == {True, False}
    (candidates,) = suggested("the exact energy is 0.5")
    assert (candidates[0].question, candidates[0].strong) == ("exact.energy", True)


def test_names_of_a_value_are_near_within_a_line_of_the_number() -> None:
    near = lambda spaces: [
        one.strong for one in suggested(f"order rk4{' ' * spaces}4")[-1] if one.question == "order rk4"
    ]
    assert (near(91), near(92)) == ([True], [False])  # the number, and 100 characters before it


def test_so_many_methods_steps_and_times_are_asked_of_and_no_more() -> None:
    given = ["h = 1/123456789012345678", "h = 1/12345678901234567"]  # of 20 characters, and of 19
    given += [f"{letter} = {'1/' * (letter == 'h')}{n}" for letter in "ht" for n in range(2, 9)]
    text = " ".join([*METHODS, *given])
    asked = [question.split() for question in Suggestions(text)._questions()]
    assert len({words[1] for words in asked if words[0] == "run"}) == 6
    assert {words[2] for words in asked if words[0] == "step"} == {"h=1/12345678901234567", "h=1/2", "h=1/3", "h=1/4"}
    assert {words[3] for words in asked if words[0] == "run"} == {"t=2", "t=3"}
    runs = {
        question.split()[2] for question in Suggestions("h = 1/2000, h = 3/10")._questions() if question[:3] == "run"
    }
    assert runs == {"h=1/4", "h=1/2"}, "neither long ones, nor those that end beside t"


def test_suggested_value_is_spelled_as_the_number_is() -> None:
    text = "RK4 and forward Euler: 2.390, 3.3e-4, 337/384, 160, 0.8776"
    numbers = [n for n in numbers_in(text) if n.label is None]
    for number, candidates in exactly(5, zip(numbers, suggested(text), strict=True)):
        assert candidates
        assert all(number.text in candidate.form.spellings(value(candidate.question)) for candidate in candidates)


TODO = re.compile(r"(?m)^# (?:TODO\n)?(?=\[\[claim|id =|phrase =|count =|given =)|^# TODO\n")


def held(document: Document, text: str) -> dict[str, int]:
    """The coverage by drafted claims, all of which hold."""
    claims = parse_claims(text.encode())
    outcomes = check_claims(document, claims.claims)
    findings = [finding for outcome in outcomes for finding in outcome.findings]
    assert findings == []  # of a text without numbers there is nothing to find
    return coverage(document, outcomes).counts


def test_drafted_claims_hold_and_cover_all_once_the_rest_is_given() -> None:
    document = read_document(SPRING)
    text = draft(document, "spring.md")
    counts = held(document, text)
    assert counts[WORKED_OUT] > 5
    assert counts[GIVEN] == 0
    assert held(document, TODO.sub("", text))[UNCOVERED] == 0


def test_drafted_claims_notice_a_changed_digit() -> None:
    claims = parse_claims(draft(read_document(SPRING), "spring.md").encode())
    wrong = document_of(SPRING.read_text(encoding="utf-8").replace("5.151", "5.152"), "markdown")
    findings = [finding for outcome in check_claims(wrong, claims.claims) for finding in outcome.findings]
    assert [(finding.expected, finding.found) for finding in findings] == [("5.151", "5.152")]


def test_phrase_has_three_words_before_its_numbers_and_after_them_what_belongs_to_them() -> None:
    text = "RK4 ends at 0.877604 here. One step of RK4 ends at 0.499895, and a step of RK4 ends at 0.877604 again."
    drafted = draft(document_of(f"{text} That is 0.33 % of all."), "a")
    found = tomllib.loads(TODO.sub("", drafted))["claim"]
    assert [(claim["phrase"], claim.get("count", 1)) for claim in found] == [
        ("RK4 ends at {value}", 2),
        ("RK4 ends at {value}", 1),
        ("again. That is 0.33 %", 1),
    ]
    assert (found[0]["value"], found[0]["id"]) == ("rk4.first_step.q", "rk4.first_step.q")
    again = document_of(f"{text} Then q is 0.877604.")
    assert held(again, draft(again, "a"))[UNCOVERED] == 0
    assert 'id = "rk4.first_step.q (2)"' in draft(again, "a")


@pytest.mark.parametrize(
    ("text", "phrases"),
    [
        ("from 1.5 " + "y" * 23 + " 2.5", ["from 1.5 " + "y" * 23 + " 2.5"]),
        ("from 1.5 " + "y" * 24 + " 2.5", ["from 1.5", "y" * 24 + " 2.5"]),
        ("at 0.5x is 0.877604", ["at 0.5x", "is {value}"]),
        ("at 1.5. Or 2.5", ["at 1.5", ". Or 2.5"]),
        ("1.5 " * 9, ["1.5 " * 7 + "1.5", "1.5"]),
    ],
)
def test_numbers_of_one_line_that_are_near_stand_in_one_phrase(text: str, phrases: list[str]) -> None:
    assert re.findall(r'phrase = "(.*)"', draft(document_of(text), "a")) == phrases


def test_name_of_the_text_cannot_break_the_draft() -> None:
    assert tomllib.loads(draft(document_of("7"), 'a\nb = 1\n"')) == {}


PIECES = ("0.877604", "337/384", "0.5", "40", "2.390", "RK4 ", "energy ", "is ", ". ", *'{}"\\\n(%\x7f√')


@given(st.lists(st.sampled_from(PIECES), max_size=15))
@example(pieces=["0.5", "0.5", ". "])
def test_draft_of_any_text_holds_of_it(pieces: list[str]) -> None:
    document = document_of("".join(pieces))
    text = draft(document, "a.txt")
    held(document, text)
    held(document, TODO.sub("", text))


LINES = ("the error of the run is {}\n", "the error is 0.7 here\n", "is 0.33 % {}x\n", "| RK4 | 0.25 | 0.3{} |\n")


@pytest.mark.parametrize("line", LINES)
def test_draft_of_twice_the_text_takes_twice_the_steps(line: str) -> None:
    """Of Python's own, where numbers differ and where they are equal in equal contexts."""
    steps = Counter[int]()

    def trace(frame: FrameType, *_: object) -> object:
        frame.f_trace_opcodes = frame.f_code.co_filename == drafting.__file__
        steps[lines] += frame.f_trace_opcodes
        return trace if frame.f_trace_opcodes else None

    for lines in (60, 120):
        document, before = document_of("".join(line.replace("{}", str(1000 + i)) for i in range(lines))), sys.gettrace()
        sys.settrace(trace)
        try:
            assert "[[claim]]" in draft(document, "a")
        finally:
            sys.settrace(before)
    assert steps[60] < steps[120] < 2.2 * steps[60]


def test_more_claims_than_a_file_may_have_are_not_drafted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drafting, "MOST_CLAIMS", 3)
    assert draft(document_of("a 1.5\nb 2.5\nc 3.5"), "a").count("[[claim]]") == 3
    assert draft(document_of("a 1.5\n" * 9), "a").count("[[claim]]") == 1
    with pytest.raises(ValueError, match="claims for more than 3 groups of numbers are not drafted"):
        draft(document_of("a 1.5\nb 2.5\nc 3.5\nd 4.5"), "a")


def test_command_drafts_in_the_format_of_the_text(
    answer: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.html").write_text("<table><tr><td>RK4<td>0.877604<td>337/384</table>", encoding="utf-8")
    Path("c.toml").write_text(answer("check", "a.html", "--init"), encoding="utf-8")
    assert "100% of 2 numbers covered: 2 by values" in answer("check", "a.html", "--claims", "c.toml")
