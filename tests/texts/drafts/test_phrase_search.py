"""A drafted phrase stands where it is said to, says which number is meant, and is found in linear time."""

import re
import sys
import tomllib
from collections import Counter
from itertools import product

import pytest

from driftproof.texts.claims.checking import UNCOVERED, WORKED_OUT, check_claims
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.drafts import drafting, members, phrase_search
from driftproof.texts.drafts.drafting import draft
from driftproof.texts.readers.document import document_of
from tests.texts.sample import held

TODO = re.compile(r"(?m)^# (?:TODO\n)?(?=\[\[claim|id =|phrase =|count =|given =)|^# TODO\n")


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


def test_phrase_that_would_be_too_long_is_not_drafted():
    for length, drafted in ((396, True), (397, False)):
        text = draft(document_of(f"{'y' * length} 7.5"), "a")
        assert ("# line 1, column 399: no phrase can be drafted for 7.5" in text) is not drafted


def test_a_slip_for_which_no_phrase_can_be_drafted_is_named():
    text = draft(document_of("Halving the step size doubles the error of Euler's method."), "a")
    slip = "# line 1: doubles is perhaps a slip: 1/power(2, order forward_euler) is halves\n"
    assert f"{slip}# line 1, column 23: no phrase can be drafted for doubles" in text


FILES = {module.__file__ for module in (drafting, members, phrase_search)}
LINES = ("the error of the run is {}\n", "the error is 0.7 here\n", "is 0.33 % {}x\n", "| RK4 | 0.25 | 0.3{} |\n")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("line", LINES)
def test_draft_of_twice_the_text_takes_twice_the_steps(line):
    """Of Python's own, where numbers differ and where they are equal in equal contexts."""
    steps = Counter[int]()

    def trace(frame, *_):
        frame.f_trace_opcodes = frame.f_code.co_filename in FILES
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


def test_same_words_with_another_meaning_elsewhere_are_no_claim_and_the_right_ones_name_their_row():
    """The second row repeats the first one's number."""
    rows = "| t | other | RK4 |\n| 0.8 | 7.41 | 0.449329 |\n| 0.9 | 7.41 | {} |\n"
    text = f"For y' = -y, y(0) = 1 with h = 0.1:\n\n{rows}"
    repeated, right = (draft(document_of(text.format(x), "markdown"), "a") for x in ("0.449329", "0.406570"))
    assert re.findall(r'^(?:value|row|column) = "(.*)"', repeated, re.MULTILINE) == ["0.8", "RK4", RIGHT_IN_08]
    assert len(re.findall(r'^value = "(.*)"', right, re.MULTILINE)) == 2


RIGHT_IN_08 = "run rk4 y'=-y, y(0)=1, h=0.1, t=0.8 : y"
UNKNOWN_BETWEEN = """For y' = -y, y(0) = 1 with h = 0.1:

| t | load | RK4 | load | Heun |
|---|---|---|---|---|
| 0.8 | 7.41 | 0.449329 | 5.51 | 0.449975 |
| 0.9 | 7.63 | 0.406570 | 5.53 | 0.407228 |
"""


@pytest.mark.parametrize(
    ("old", "new", "wrong"),
    [
        ("0.449329", "0.406570", 2),
        ("0.449329", "0.449975", 2),
        ("| 0.9", "| 0.7", 2),
        ("RK4", "Heun", 4),
        ("7.63", "7.64", 0),
        ("0.406570", "0.406571", 1),
    ],
)
def test_a_value_behind_a_number_without_a_claim_keeps_its_row_and_column(old, new, wrong):
    claims = parse_claims(draft(document_of(UNKNOWN_BETWEEN, "markdown"), "a")).claims
    for text, findings in (
        (UNKNOWN_BETWEEN, 0),
        (UNKNOWN_BETWEEN.replace(old, "X").replace(new, old).replace("X", new), wrong),
    ):
        checked = check_claims(document_of(text, "markdown"), claims)
        assert sum(len(each.findings) for each in checked if each.claim.values) == findings


STEPS_IN_HEADS = """For y' = -3y, y(0) = 2, the values at t = 2 are:

| Method | h = 0.2 | h = 0.1 | order |
|---|---|---|---|
| Heun | 0.0086161 | 0.0055482 | 2 |
| RK4 | 0.0050109 | 0.0049601 | 4 |

A smaller step:

| h | RK4: y(2) | error |
|---|---|---|
| 0.05 | 0.0049576 | 1.422e-07 |
| 0.025 | 0.0049575 | 8.349e-09 |
"""


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("h = 0.2 | h = 0.1", "h = 0.1 | h = 0.2", "h = 0.1"),
        ("h = 0.1 | order", "order | h = 0.1", "order"),
        ("RK4: y(2) | error", "error | RK4: y(2)", "error"),
        ("RK4: y(2) | error", "RK4: y(2) | relative error", "relative error"),
        ("| RK4: y(2)", "| Heun: y(2)", "Heun: y(2)"),
    ],
)
def test_a_row_that_is_live_as_a_whole_keeps_the_heads_of_its_columns(old, new, found):
    claims = parse_claims(draft(document_of(STEPS_IN_HEADS, "markdown"), "a")).claims
    for text, expected in ((STEPS_IN_HEADS, []), (STEPS_IN_HEADS.replace(old, new), [found])):
        checked = check_claims(document_of(text, "markdown"), claims)
        assert [x.found for each in checked if each.claim.values for x in each.findings][-1:] == expected


ON_A_WIKI = """== Decay ==
Take u' = -3u with u(0) = 2 and h = 0.1. AB2 is started with a step of Heun's method; Euler's needs no start.

{| class="wikitable"
! t !! AB2 !! Heun
|-
| 0.2 || 1.119500 || 1.110050
|-
| 0.3 || 0.839225 || 0.826987
|}
"""


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("AB2 !! Heun", "Heun !! AB2", True),
        ("a step of Heun's", "a step of RK4's", True),
        ("is started with a step of Heun's method", "is started exactly", True),
        ("Euler's needs", "RK4 needs", False),
    ],
)
def test_a_row_of_a_wiki_keeps_its_heads_and_a_run_what_starts_it(old, new, found):
    claims = parse_claims(draft(document_of(ON_A_WIKI), "a")).claims
    assert sum(len(one.values) for one in claims) == 4
    checked = check_claims(document_of(ON_A_WIKI.replace(old, new)), claims)
    assert any(each.findings for each in checked) is found
    assert not any(each.findings for each in check_claims(document_of(ON_A_WIKI), claims))


@pytest.mark.parametrize(
    "said",
    ["with exact starting values", "started exactly", "its first values from the solution", "with exact initial steps"],
)
def test_a_draft_says_as_the_text_does_that_exact_values_start(said):
    text = f"On y' = -5y, y(0) = 1, {said}, with h = 1/20, BDF2 is off by 7.89e-4 at t = 1."
    claims = parse_claims(drafted := draft(document_of(text), "a")).claims
    assert {*re.findall("started=(\\w+)", drafted)} == {"exact"}
    assert not any(each.findings for each in check_claims(document_of(text), claims))


def test_a_start_in_prose_that_none_of_the_values_has_is_named():
    text = (
        "Take u' = -3u with u(0) = 2 and h = 0.1. AB2 {} with a step of {}'s method; it gives:\n\n"
        "| t | AB2 |\n|---|---|\n| 0.2 | 1.119500 |\n| 0.3 | 0.839225 |\n\n"
        "```python\n# first step with Heun's method\n```\n"
    )
    for (name, named), verb in product((("Euler", True), ("Heun", False)), ("is started", "starts")):
        drafted = draft(document_of(text.format(verb, name), "markdown"), "a")
        assert ("s method is perhaps a slip: what starts the values held is heun2" in drafted) is named
        assert (f'phrase = "AB2 {verb} with a step of {name}' in drafted) is not named


def test_a_limit_of_stability_is_of_the_axis_that_the_text_names():
    text = "On the imaginary axis AB3 reaches 0.7236 and AB4 0.4300. On the real axis AB4 reaches 0.3."
    claims = parse_claims(draft(document_of(text), "a")).claims
    for axis, found in (("imaginary", 0), ("real", 2)):
        checked = check_claims(document_of(text.replace("imaginary", axis)), claims)
        assert sum(len(each.findings) for each in checked) == found
