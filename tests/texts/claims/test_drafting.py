"""Drafted claims hold of the text they are drafted from, and cover what they say."""

import re
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from driftproof.texts.claims import drafting
from driftproof.texts.claims.checking import GIVEN, UNCOVERED, WORKED_OUT, check_claims, coverage
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.claims.drafting import draft
from driftproof.texts.readers.document import document_of, read_document

ROOT = Path(__file__).parents[3]
SPRING = ROOT / "examples" / "text" / "spring.md"
TODO = re.compile(r"(?m)^# (?:TODO\n)?(?=\[\[claim|id =|phrase =|count =|given =)|^# TODO\n")


def held(document, text):
    """The coverage by drafted claims, all of which hold."""
    claims = parse_claims(text)
    outcomes = check_claims(document, claims.claims)
    findings = [finding for outcome in outcomes for finding in outcome.findings]
    assert findings == []  # of a text without numbers there is nothing to find
    return coverage(document, outcomes).counts


def test_drafted_claims_hold_and_cover_all_once_the_rest_is_given():
    document = read_document(SPRING)
    text = draft(document, "spring.md")
    counts = held(document, text)
    assert counts[WORKED_OUT] > 5
    assert counts[GIVEN] == text.count("the text chooses it")
    assert held(document, TODO.sub("", text))[UNCOVERED] == 0


def test_numbers_of_an_equation_are_given_and_those_after_it_are_not():
    for text, count in (("x'' = -x/(x^2 + 4)^{3/2}; 2", 3), ("y' = -2y + 0.5, 25 of them", 2), ("3y = 2y + 0.5", 0)):
        assert held(document := document_of(text, "plain"), draft(document, "a"))[GIVEN] == count


def test_drafted_claims_notice_a_changed_digit():
    claims = parse_claims(draft(read_document(SPRING), "spring.md"))
    wrong = document_of(SPRING.read_text(encoding="utf-8").replace("5.151", "5.152"), "markdown")
    findings = [finding for outcome in check_claims(wrong, claims.claims) for finding in outcome.findings]
    assert [(finding.expected, finding.found) for finding in findings] == [("5.151", "5.152")]


def test_phrase_in_a_program_holds_no_number_that_is_left_out():
    """Of such a number nothing can be claimed: the claims were refused that had it in their phrases."""
    listing = "y = 1.0\ny = y - 2*0.1*y  # 0.877604 after 3 of 0.875 and 5\nz = 4*0.877604\nz = 0.875 + 6 * 0.877604\n"
    document = document_of(f"RK4:\n\n```python\n{listing}```\n", "markdown")
    drafted = draft(document, "a", ["step rk4 h=1/2 : q", "1 - 1/8"])
    assert held(document, drafted)[WORKED_OUT] == 5
    assert drafted.endswith("# Left out: numbers in program code, 5 in all; they are inputs, not claims.")


def test_phrase_has_three_words_before_its_numbers_and_after_them_what_belongs_to_them():
    text = "RK4 ends at 0.877604 here. One step of RK4 ends at 0.499895, and a step of RK4 ends at 0.877604 again."
    drafted = draft(document_of(f"{text} That is 0.33 % of all."), "a")
    found = tomllib.loads(TODO.sub("", drafted))["claim"]
    phrases = [("RK4 ends at {value}", 2), ("RK4 ends at {value}", 1), ("again. That is 0.33 %", 1)]
    assert [(claim["phrase"], claim.get("count", 1)) for claim in found] == phrases
    assert (found[0]["value"], found[0]["id"]) == ("rk4.first_step.q", "rk4.first_step.q")
    assert "count = 1" not in drafted
    again = document_of(f"{text} Then q is 0.877604.")
    assert held(again, draft(again, "a"))[UNCOVERED] == 0
    assert 'id = "rk4.first_step.q (2)"' in draft(again, "a")


@pytest.mark.parametrize(
    ("text", "phrases"),
    [
        ("from 1.5 " + "y" * 23 + " 2.5", ["from 1.5 " + "y" * 23 + " 2.5"]),
        ("from 1.5 " + "y" * 24 + " 2.5", ["from 1.5", "y" * 24 + " 2.5"]),
        ("RK4 at 0.5x is 0.877604", ["RK4 at 0.5x", "is {value}"]),
        ("from 1.5 to 0.33 % of it", ["from 1.5 to 0.33 %"]),
        ("at 1.5. Or 2.5", ["at 1.5", ". Or 2.5"]),
        ("rk4 2.828427125/3(17", ["rk4 {value}/", "/3(17"]),  # 3 belongs to the next phrase
        ("1.75 " * 9, ["1.75 " * 7 + "1.75", "1.75"]),
        ("5x. 7.5", ["5x", ". 7.5"]),  # no phrase begins within a word
    ],
)
def test_numbers_of_one_line_that_are_near_stand_in_one_phrase(text, phrases):
    assert re.findall(r'phrase = "(.*)"', draft(document_of(text), "a")) == phrases


def test_second_number_of_a_group_is_drafted_where_only_the_first_stands_in_an_earlier_phrase():
    text = "at 44.001\nat 44.001 | 59.727"
    phrases = re.findall(r'phrase = "(.*)"', draft(document_of(text), "a"))
    assert phrases == ["at 44.001", "| 59.727"]


SETTINGS = ["h = 0.3", "dt=0.3", "t_end =\n0.3", "step size of 0.3", "step size of 3", "λ = -9.47", "λ = -3e-144"]
SETTINGS += ["y' = 0.0"]


@pytest.mark.parametrize("setting", SETTINGS)
def test_what_the_text_chooses_is_given_and_what_looks_like_a_value_is_not(setting):
    document = document_of(f"Of RK4 with {setting}, then {setting}, and h2 = 0.3; e = 0.3; h = 2.828.")
    text = draft(document, "a")
    assert held(document, text) == {"value": 1, "given": 2, "run": 0, "label": 2, "uncovered": 2}
    (chosen, limit) = tomllib.loads(text)["claim"]
    assert (chosen["phrase"], chosen["count"]) == (setting.replace("\n", " "), 2)
    assert limit["value"] == "imaginary_limit rk4"


def test_a_letter_of_an_equation_is_given_and_no_other():
    document = document_of("S' = -βS I - c_1 S, with β = 0.44, c_1 = 0.77 and q = 0.99; S = 0.33.")
    given = [claim["phrase"] for claim in tomllib.loads(draft(document, "a"))["claim"]]
    assert given == ["β = 0.44", "c_1 = 0.77"]


@pytest.mark.parametrize("method", ["forward Euler", "velocity Verlet"])
def test_a_digit_beside_the_name_of_a_method_is_no_state_of_it(method):
    """No word but the method's names q = 1, which forward Euler has after a step from (1, 0)."""
    for said, times in (("y(0) = 1", 1), ("a ratio of 1", 0)):
        drafted = draft(document_of(f"We run {method} with h = 0.1 and {said}, often.", "markdown"), "a")
        assert 'value = "' not in drafted
        assert drafted.count("the text chooses it") == 1 + times


def test_a_start_in_brackets_is_given_as_one():
    document = document_of("It runs from (1, -0.3) with h = 0.3 to (1, -0.3), from 1 on.")
    text = draft(document, "a")
    assert held(document, text) == {"value": 0, "given": 3, "run": 0, "label": 0, "uncovered": 3}
    assert [claim["phrase"] for claim in tomllib.loads(text)["claim"]] == ["from (1, -0.3", "h = 0.3"]
    assert 'id = "line 1, column 41"' in text


def test_draft_says_what_was_asked_for_and_is_nowhere_and_its_ids_are_short():
    asked = "run forward_euler rates=(t+y0+0*(t+y0+t+y0+t+y0)) from 0 h=0.2 t={0.4,0.6,1.0} : {y0,state_error}"
    document = document_of("| 0.4 | 0.04 | 0.052 |\n| 0.6 | 0.128 | 0.094 |\n| 1.0 | 0.489 | 0.229 |\n")
    text = draft(document, "a", [asked])
    assert held(document, text)[WORKED_OUT] == 3
    assert 'id = "| {a} | {b}"' in text, "two such questions are too long for an id"
    assert text.rpartition("# Asked for with --ask, but not found in the text:\n")[2].count("t=1.0 : ") == 2
    assert "Asked for" not in draft(document, "a")
    drafted = draft(document, "a", ["run rk4 h={1/4,1/2} t={1,3/4} : q"])
    assert drafted.endswith("\n# Not asked, because h does not divide t: 1, such as run rk4 h=1/2 t=3/4 : q")
    assert drafted.count("#   run rk4 h=") == 3
    drafted = draft(document_of("RK4: 30 steps of 0.2."), "a", ["run rk4 h=0.2 N=30 : {steps,h,evaluations}"])
    assert "the question itself says the value: 2, such as run rk4 h=0.2 N=30 : steps" in drafted
    assert "value =" not in drafted


def test_what_was_asked_for_is_listed_with_the_slips_and_the_guesses_that_may_mean_it():
    asked = ["1.35914", "5/8 + 0.0000000005", "2.5", "64.5 - 1/2", "stability_function rk4", "order rk4", "exp(-9)"]
    drafted = draft(document_of("It is 1.35941 here, 2.5 there\nand 3 elsewhere: 2.5."), "a", asked)
    _, nowhere, guessed = drafted.split("# Asked for with --ask")
    assert "# line 1: 1.35941 is perhaps a slip: 1.35914 is 1.35914\n" in drafted
    listed = ["1.35914; a slip? 1.35941 in line 1", "0.625", "64", "1 + z + z**2/2 + z**3/6 + z**4/24", "4"]
    missing = zip([question for question in asked if question != "2.5"], [*listed, "0.0001234098"], strict=True)
    assert nowhere.splitlines()[1:-1] == [f"#   {question}, {text}" for question, text in missing]
    assert guessed.endswith("\n#   2.5, 2.5; perhaps 2.5 in line 1, 2.5 in line 2")
    assert "#   0.625000005, 0.625\n" in draft(document_of(""), "a", ["0.625000005"]) + "\n", "a tie"


def test_numbers_in_a_column_of_steps_or_times_are_given_if_they_stand_alone():
    table = "| $h$ | error |\n| --- | --- |\n| 0.1 | 0.3 |\n| 0.05 | 0.7 |\n| of 9 | 8 |\n\nand 0.1 too"
    drafted = draft(document_of(table, "markdown"), "a")
    assert [claim["phrase"] for claim in tomllib.loads(drafted)["claim"]] == ["| 0.1 |", "| 0.05 |"]
    assert 'phrase = "| 0.1"' in draft(document_of("error | h\n0.3 | 0.1\nend"), "a")
    for text in ("θ' = ω, ω' = -sin(θ)\n\n| ω |\n| --- |\n| -0.963 |\n\nω = -0.963", "eigenvalue λ = -9.373"):
        assert "\n[[claim]]" not in draft(document_of(text, "markdown"), "a"), "computed, and not chosen"


def test_two_other_values_are_named_and_the_rest_counted_unless_the_text_chooses_the_number():
    _, two, three, _ = asked = [f"0.1234567 + {k} - {k}" for k in range(4)]
    for count, said in ((1, []), (2, [two]), (3, [f"{two}, {three}"]), (4, [f"{two}, {three} and 1 more"])):
        drafted = draft(document_of("is 0.123457"), "a", asked[:count])
        assert re.findall("# 0.123457 looks also like (.*)", drafted) == said
    (weak,) = re.findall("# 0.5 looks (.*)", draft(document_of("is 0.5, and h = 0.5"), "a"))
    assert re.fullmatch(r"like [^,]+, [^,]+ and \d\d more", weak)


def test_an_id_has_150_characters_at_most_and_what_is_nowhere_8_digits():
    for length, shown in ((150, True), (151, False)):
        question = f"0.123457 +{' ' * (length - 11)}0"
        text = draft(document_of("is 0.123457"), "a", [question])
        assert (f'id = "{question}"' in text) is shown
        assert ('id = "is {value}"' in text) is not shown
    assert draft(document_of("7"), "a", ["1/3"]).endswith("#   1/3, 0.33333333")


def test_numbers_of_programs_are_left_out_and_counted_but_for_those_that_are_values():
    program = "```python\nx = 3.75\nq = rk4(1, h=0.5)\nassert q == 337/384  # rk4, one step, or 4.5\n```\n"
    document = document_of(f"{program}\nis 3.75\n", "markdown")
    text = draft(document, "a")
    assert text.endswith("# Left out: numbers in program code, 3 in all; they are inputs, not claims.")
    assert [claim["value"] for claim in tomllib.loads(text)["claim"]] == ["rk4.first_step.q"]
    left = [line for line in text.splitlines() if line.startswith("# phrase")]
    assert left == ['# phrase = "one step, or 4.5"', '# phrase = "is 3.75"']
    assert held(document, text) == {"value": 1, "given": 0, "run": 0, "label": 5, "uncovered": 2}


def test_single_digits_of_programs_are_no_values_though_their_words_stand_around():
    said = "Heun has two stages per step. RK4 uses 16 evaluations in all. The energy of forward Euler grows.\n\n"
    code = "```python\ny = 1.0\nfor n in range(2): y = y * (1 - 0.5 + 0.125)\n```\n"
    drafted = draft(document_of(said + code, "markdown"), "a")
    assert "value =" not in drafted
    assert drafted.endswith("# Left out: numbers in program code, 5 in all; they are inputs, not claims.")


def test_phrase_that_would_be_too_long_is_not_drafted():
    for length, drafted in ((396, True), (397, False)):
        text = draft(document_of(f"{'y' * length} 7.5"), "a")
        assert ("# line 1, column 399: no phrase can be drafted for 7.5" in text) is not drafted


def test_name_of_the_text_cannot_break_the_draft():
    assert tomllib.loads(draft(document_of("7"), 'a\nb = 1\n"')) == {}


PIECES = ("0.877604", "337/384", "0.5", "40", "2.390", "RK4 ", "energy ", "is ", ". ", *'{}"\\\n(%\x7f√')


@pytest.mark.slow
@given(st.lists(st.sampled_from(PIECES), max_size=15))
@example(pieces=["0.5", "0.5", ". "])
def test_draft_of_any_text_holds_of_it(pieces):
    document = document_of("".join(pieces))
    text = draft(document, "a.txt")
    held(document, text)
    held(document, TODO.sub("", text))


LINES = ("the error of the run is {}\n", "the error is 0.7 here\n", "is 0.33 % {}x\n", "| RK4 | 0.25 | 0.3{} |\n")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("line", LINES)
def test_draft_of_twice_the_text_takes_twice_the_steps(line):
    """Of Python's own, where numbers differ and where they are equal in equal contexts."""
    steps = Counter[int]()

    def trace(frame, *_):
        frame.f_trace_opcodes = frame.f_code.co_filename == drafting.__file__
        steps[lines] += frame.f_trace_opcodes
        return trace if frame.f_trace_opcodes else None

    for lines in (30, 60):
        document, before = document_of("".join(line.replace("{}", str(1000 + i)) for i in range(lines))), sys.gettrace()
        sys.settrace(trace)
        try:
            assert "[[claim]]" in draft(document, "a")
        finally:
            sys.settrace(before)
    assert steps[30] < steps[60] < 2.2 * steps[30]


def test_more_claims_than_a_file_may_have_are_not_drafted(monkeypatch):
    monkeypatch.setattr(drafting, "MOST_CLAIMS", 3)
    assert draft(document_of("a 1.5\nb 2.5\nc 3.5"), "a").count("[[claim]]") == 3
    assert draft(document_of("a 1.5\n" * 9), "a").count("[[claim]]") == 1
    with pytest.raises(ValueError, match="claims for more than 3 groups of numbers are not drafted"):
        draft(document_of("a 1.5\nb 2.5\nc 3.5\nd 4.5"), "a")


def test_command_drafts_in_the_format_of_the_text(answer, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.html").write_text("<table><tr><td>RK4<td>0.877604<td>337/384</table>", encoding="utf-8")
    Path("c.toml").write_text(answer("check", "a.html", "--init"), encoding="utf-8")
    assert "100% of 2 numbers covered: 2 by values" in answer("check", "a.html", "--claims", "c.toml")
    asked = "step rk4 lambda=1 h=1/{2..3} : y"
    assert "lambda=1 h=1/3 : y, 1.3955" in answer("check", "a.html", "--init", "--ask", asked)


PINNED = """On y' = y(1 - y), y(0) = 0.1, Euler's method has 0.391811 at t = 2 with h = 0.5.

| h | Euler | RK4 |
|---|---|---|
| 0.5 | 0.391811 | 0.450786 |
| 0.25 | 0.420233 | 0.450844 |
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [("| Euler | RK4 |", "| RK4 | Euler |"), ("| 0.5 |", "| 0.25 |"), ("0.420233", "0.450844"), ("Euler's", "Heun's")],
)
def test_a_drafted_value_is_bound_to_its_row_the_heads_and_the_method_before_it(old, new):
    claims = parse_claims(draft(document_of(PINNED, "markdown"), "a")).claims
    for text, holds in ((PINNED, True), (PINNED.replace(old, new), False)):
        found = [each.findings for each in check_claims(document_of(text, "markdown"), claims)]
        assert (not any(found)) is holds


def test_a_phrase_begins_with_the_whole_name_of_its_method():
    text = "For y' = -y, y(0) = 1 and h = 0.1:\n\n* backward Euler: y(1) ≈ 0.385543\n* forward Euler: y(1) ≈ 0.348678\n"
    drafted = draft(document_of(text, "markdown"), "a")
    assert 'phrase = "backward Euler: y(1) ≈ {value}"' in drafted
    assert 'phrase = "forward Euler: y(1) ≈ {value}"' in drafted


def test_same_words_with_another_meaning_elsewhere_are_no_claim():
    """The second row repeats the first one's number: its phrase would cover both."""
    rows = "| t | other | RK4 |\n| 0.8 | 7.41 | 0.449329 |\n| 0.9 | 7.41 | {} |\n"
    text = f"For y' = -y, y(0) = 1 with h = 0.1:\n\n{rows}"
    repeated, right = (draft(document_of(text.format(x), "markdown"), "a") for x in ("0.449329", "0.406570"))
    assert re.findall(r'^value = "(.*)"', repeated, re.MULTILINE) == []
    assert len(re.findall(r'^value = "(.*)"', right, re.MULTILINE)) == 2
