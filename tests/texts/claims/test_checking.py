"""A claim holds of the text that says it and of no text that says another number; every number is accounted for."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.checking import LABEL, UNCOVERED, WORKED_OUT, check_claim, check_claims, coverage
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.readers.document import document_of
from tests.texts.sample import CLAIMS, TEXT, claim, stands


@pytest.mark.parametrize(
    ("form", "text"),
    [
        ("markdown", "| RK4 | **3.3×10⁻⁴** |"),
        ("html", "<tr><td>RK4<td>3.3&times;10<sup>&minus;4</sup></tr>"),
        ("tex", "RK4 & $3.3\\times 10^{-4}$ \\\\"),
    ],
)
def test_one_phrase_serves_every_format(form, text):
    one = claim("RK4 | {value}", value="3.3e-4")
    assert stands(text, one, form) == 1
    assert stands(text.replace("3.3", "3.4"), one, form) == 0


def findings(text, one):
    (outcome,) = check_claims(document_of(text), [one])
    return [(finding.line, finding.column, finding.expected, finding.found) for finding in outcome.findings]


# Phrase with more of its claim, text, what is found: line, column, expected, found.
STEPS, ENERGY, HERE = "at {value} after 5 steps", "the\nenergy grows by {value}", "the error is {value} here"
NEAR = "the end of\nthe energy is near, and\nthe energy "
LONG, FIRST_WORDS = f"the error of it is {{value}} {'y' * 60}", "the error of it "
FOUND = [
    (STEPS, "", "x\n\nis at 0.33 after 5 steps", []),
    (STEPS, "", "x\n\nis at 0.34 after 5 steps", [(3, 7, "0.33", "0.34")]),
    (STEPS, "", "x\n\nis at 0.33 after 6 steps", [(3, 18, "5", "6")]),
    ("from {value} to 0.5", "", "from 0.1 to 0.2\nfrom 0.3 to 0.5\nfrom 0.2 to 0.4", [(2, 6, "0.33", "0.3")]),
    (ENERGY, "", f"{NEAR}grows slowly", [(3, 1, "the\nenergy grows by 0.33", "the energy grows slowly")]),
    (ENERGY, "", f"{NEAR}falls slowly", [(3, 1, "the\nenergy grows by 0.33", "the energy falls slowly")]),
    ("takes 25 at four", "", "takes it\nit takes 20 at five", [(2, 4, "takes 25 at four", "takes 20 at five")]),
    (ENERGY, "", "nothing of it", [(1, 1, "the\nenergy grows by 0.33", "")]),
    (HERE, "", "a\nthe error was 0.33 here", [(2, 1, "the error is 0.33 here", "the error was 0.33 her")]),
    ("| error {value}", "", "a | b", [(1, 1, "| error 0.33", "")]),
    (HERE, "", "nothing", [(1, 1, "the error is 0.33 here", "")]),
    *(("is {value}", "", before + "is so", [(1, 1 + len(before), "is 0.33", "is so")]) for before in ("", "it ")),
    # What stands where a phrase begins is shown up to 60 characters.
    (LONG, "", FIRST_WORDS + "x" * 60, [(1, 1, LONG.format(value=0.33), FIRST_WORDS + "x" * 44)]),
    # Cells that run together are shown as one run.
    ("Euler2.390{value}", "", "Euler2.3900.34", [(1, 6, "2.3900.33", "2.3900.34")]),
    ("0.5: Euler2.390{value}", "", "0.5: Euler2.3900.34", [(1, 11, "2.3900.33", "2.3900.34")]),
    # A number that is right is, however it is spelled, and in a row of a table; what is expected is spelled likewise.
    ("| {value} | 5", "", "| 6 | 0.34 | 5 |", [(1, 7, "0.33", "0.34")]),
    ("{value} to 0.00051", "", "3.3×10⁻¹ to 5.2e-4\n0.34 to 0.00051", [(1, 13, "5.1e-4", "5.2e-4")]),
    # A name with another number comes close where nothing comes closer.
    ("RK4 ends at {value}", "", "RK5 ends at 0.33", [(1, 3, "4", "5")]),
    ("RK4 ends at {value}", "", "RK5 ends at 0.33\nRK4 ends at 0.34", [(2, 13, "0.33", "0.34")]),
    ("h is at most {value}", "", "h is at most 1, then\nh is at most 0.83", [(2, 14, "0.33", "0.83")]),
    ("is {value}", "count = 2", "is 0.33 and is 0.33", []),
    ("is {value}", "", "is 0.33 and is 0.33", [(1, 13, "nothing", "is 0.33")]),
    ("is {value}", "count = 0", "is 0.33 and is 0.33", [(1, 1, "nothing", "is 0.33"), (1, 13, "nothing", "is 0.33")]),
    ("is {value}", "count = 3", "is 0.33 and is 0.33", [(1, 1, "is 0.33", "")]),
    ("h < 2, its", "count = 2", "h < 2, its\nh <= 2, its", [(2, 1, "h < 2, its", "h <= 2, it")]),
    # The place that comes closest is looked for among the first 2000.
    *(
        (STEPS, "", "at 0.34 after 6 steps\n" * before + "at 0.34 after 5 steps", [(line, 4, "0.33", "0.34"), *more])
        for before, line, more in ((1999, 2000, ()), (2000, 1, [(1, 15, "5", "6")]))
    ),
]


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize(("phrase", "more", "text", "found"), FOUND, ids=range(len(FOUND)))
def test_finding_is_the_place_that_comes_closest_and_says_what_is_expected(phrase, more, text, found):
    given = "given = true\n" if any(character.isdigit() for character in phrase) else ""
    assert findings(text, claim(phrase, given + more)) == found


def test_a_power_of_ten_counts_as_much_as_a_digit():
    one, text = claim("| {value}", "digits = 3", value="6.99e-6"), "| 0.800000 | 6.91e-6 | 1,000 | 1/3"
    assert findings(text, one) == [(1, 14, "6.99e-6", "6.91e-6")]
    assert findings(text.replace("6.91e-6", "6.91×10⁻⁶"), one) == [(1, 14, "6.99e-6", "6.91×10^{-6}")]


@pytest.mark.parametrize(
    ("count", "text", "found"),
    [(0, "at 0.33 now\n" * 5, 3), (5, "at 0.34 now\n" * 5, 3), (2, "at 0.33 now\n" + "at 0.34 now\n" * 3, 1)],
)
def test_three_findings_of_a_kind_are_named(count, text, found):
    assert len(findings(text, claim("at {value} now", f"count = {count}"))) == found


def test_a_number_that_another_claim_holds_is_not_called_wrong():
    h, other, begun = (claim(phrase, "given = true") for phrase in ("h = 0.1", "h = 0.2", "h = 0.1 gives {value}"))
    for text, wrong, place in (
        ("h = 0.1\nh = 0.3", other, (2, 5, "0.2", "0.3")),
        ("h = 0.3\nh = 0.1", other, (1, 5, "0.2", "0.3")),
        ("h = 0.1 gives 0.3\nh = 0.2 gives 0.33", begun, (1, 15, "0.33", "0.3")),
    ):
        (finding,) = [found for each in check_claims(document_of(text), [h, wrong]) for found in each.findings]
        assert (finding.line, finding.column, finding.expected, finding.found) == place


def test_what_is_right_but_for_capitals_or_part_of_more_is_said_to_be():
    capitals = "The error is 0.4 here", HERE, "; closest is 'The error is 0.4 here'"
    for text, phrase, said in (capitals, ("is 0.33 %", "is {value}", "nowhere in the text; expected once")):
        (outcome,) = check_claims(document_of(text), [claim(phrase)])
        assert said in outcome.findings[0].message


@given(st.integers(0, 999), st.integers(0, 999), st.sampled_from(["", "-"]))
def test_claim_holds_of_its_own_number_only(n, m, sign):
    one = claim("at {value} now", value=f"{sign}{n / 100:.2f}")
    assert stands(f"it is at {sign.replace('-', chr(0x2212))}{m / 100:.2f} now", one) == (n == m)


def test_every_number_is_accounted_for():
    document = document_of(TEXT)
    outcomes = check_claims(document, CLAIMS.claims)
    at = document.text.text.index("0.25")
    covered = coverage(document, outcomes, CLAIMS.labels, [(at, at + 4)])
    labels, rest = "4:label 5:label 1:label 2:label", "0.5:uncovered 0.25:run 7:uncovered 8/9:uncovered"
    accounts = " ".join(f"{one.number.text}:{one.kind}" for one in covered.numbers)
    assert accounts == f"{labels} 0.33:given 40:given 1:label {rest}"
    assert covered.share == Fraction(1, 2)
    assert coverage(document, [], CLAIMS.labels).counts[UNCOVERED] == 6


def test_numbers_of_programs_are_labels_where_nobody_claims_them():
    document = document_of("```python\nx = 0.33 + 7  # 8\nerror = 5\n```\n", "markdown")
    outcomes = check_claims(document, [claim("error = 5", "given = true")])
    accounts = [f"{one.number.text}:{one.kind}:{one.by}" for one in coverage(document, outcomes).numbers]
    program = "label:an input of a program"
    assert accounts == [f"0.33:{program}", f"7:{program}", "8:uncovered:", "5:given:a"]


def test_a_number_in_two_phrases_is_of_the_first_and_one_of_a_formula_has_its_place():
    entry = '[[claim]]\nid="{}"\nphrase="{}"\ngiven=true\n'.format
    formula = 'values.m={ask="energy_multiplier rk4", exact=true}'
    text = entry("b", "is 5 after 6 steps") + entry("a", "after 6") + entry("m", "by {m}") + formula
    document = document_of("It is 5 after 6 steps, by 1 - h^6/72 + h^8/576.")
    accounts = coverage(document, check_claims(document, parse_claims(text).claims)).numbers
    assert [one.by for one in accounts] == ["b", "b", *["m"] * 5]
    spelled = [document.text.text[one.number.start : one.number.end] for one in accounts]
    assert spelled == ["5", "6", "1", "6", "72", "8", "576"]


def test_numbers_that_run_together_are_counted_one_by_one():
    text = '[[claim]]\nid="a"\nphrase="RK4{a}{b}{c}"\nvalues={a="1/4", b="-1/8", c="16"}'
    document = document_of("RK40.25-0.12516")
    counts = coverage(document, check_claims(document, parse_claims(text).claims)).counts
    assert (counts[WORKED_OUT], counts[LABEL], counts[UNCOVERED]) == (3, 1, 0)
    named = parse_claims('[[claim]]\nid="a"\nphrase="is {value} here"\nvalue="title rk4"').claims
    document = document_of("It is Classical RK4 here, 5.")
    assert [one.number.text for one in coverage(document, check_claims(document, named)).numbers] == ["5"]


# Question, spelled how, a text that is right, one that is not: what is expected there, and what is found.
IN_WORDS = [
    ("evaluations", "words", "RK4 makes one hundred and sixty calls", "RK4 makes 161 calls", "161"),
    ("evaluations", "words", "RK4 makes A hundred\nand sixty calls", "RK4 makes sixteen calls", "sixteen"),
    ("energy_change", "trend", "RK4 makes shrinking calls", "RK4 makes growing calls", "growing"),
]


@pytest.mark.parametrize(("readout", "how", "right", "wrong", "found"), IN_WORDS)
def test_value_in_words_is_held_and_other_words_are_found(readout, how, right, wrong, found):
    asked = f'value = "run rk4 h=1/4 t=10 : {readout}"'
    text = f'[[claim]]\nid="a"\nphrase="makes {{value}} calls"\n{asked}\nspelled="{how}"'
    (one,) = parse_claims(text).claims
    assert findings(right, one) == []
    ((*_, expected, instead),) = findings(wrong, one)
    assert instead == found != expected in one.spellings()["value"]


def test_a_word_of_the_right_direction_is_not_found_beside_a_wrong_number():
    values = '{a = {ask = "power(2, order heun2)", spelled = "words"}, b = {ask = "-order heun2", spelled = "trend"}}'
    (one,) = parse_claims(f'[[claim]]\nid="a"\nphrase="is {{a}} times {{b}}"\nvalues={values}').claims
    found = [findings(f"It is {said} times {how}.", one) for said, how in (("four", "smaller"), ("two", "smaller"))]
    assert [[instead for *_, instead in each] for each in found] == [[], ["two"]]


def test_words_that_no_phrase_holds_are_told():
    document = document_of("The error is 0.33 after 40 steps, two of sixteen. It uses one, 0.5, and grows.")
    one = claim("two of sixteen. It uses one, {value}", "given = true", "0.5")
    assert [word.text for word in coverage(document, []).unread] == ["two", "sixteen", "one", "grows"]
    assert [word.text for word in coverage(document, check_claims(document, [one])).unread] == ["grows"]
    ours = claim("two of sixteen. It uses one, {value}", "", "0.5")
    unread = coverage(document, check_claims(document, [ours])).unread
    assert [word.text for word in unread] == ["two", "sixteen", "one", "grows"], "nobody worked these out, or gave them"


def test_label_that_stands_nowhere_is_refused():
    with pytest.raises(ValueError, match="the phrase of the label 'time' occurs nowhere"):
        coverage(document_of("none"), [], CLAIMS.labels)


@given(st.lists(st.sampled_from(["error is 0.33 after 40 steps", "0.5", "5 min", "RK4", " ", "1/2", "x"])))
def test_coverage_counts_every_number_once(pieces):
    document = document_of(" ".join(["5 min", *pieces]))
    covered = coverage(document, check_claims(document, CLAIMS.claims), CLAIMS.labels)
    spans = [(one.number.start, one.number.end) for one in covered.numbers]
    assert spans == sorted(set(spans))
    digits = {i for i, character in enumerate(document.text.text) if character.isdigit()}
    assert digits == {i for start, end in spans for i in range(start, end)} & digits


def test_check_of_one_claim_looks_at_no_more_places_than_it_says():
    one = claim("a {value} b")
    outcome = check_claim(document_of("a 1 b " * 5000), one, one.spellings())
    assert len(outcome.findings) == 1


NAMED = "Heun is slow. Classical RK4 has, at the end, an error of 0.33 or so."


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (NAMED, []),
        (NAMED.replace("Classical RK4", "The 3/8 rule"), [(1, 57, "rk4", "rk38")]),
        (NAMED.replace("Heun is slow. Classical RK4", "It"), [(1, 33, "rk4", "no method")]),
        (NAMED.replace("Classical RK4", "RK4, not Heun,"), [(1, 59, "rk4", "heun2")]),
        ("| Method | error |\n| RK4 | 0.33 |", []),
        ("| Method | error |\n| Heun | 0.33 |", [(2, 10, "rk4", "heun2")]),
    ],
)
def test_a_claim_holds_the_method_that_the_text_names_where_its_value_stands(text, found):
    phrase = "{value}" if "|" in text else "error of {value}"
    assert findings(text, claim(phrase, "method = 'rk4'")) == found
    assert findings(text, claim(phrase)) == []


@pytest.mark.parametrize(
    ("phrase", "more", "text", "found"),
    [
        ("BDF2 is A-stable", "value = 'a_stable bdf2'", "Note: BDF2 is A-stable.", []),
        ("BDF3 is A-stable", "value = 'a_stable bdf3'", "x BDF3 is A-stable.", [(1, 3, "a_stable bdf3 is no", "yes")]),
        ("BDF3 is not A-stable", "value = 'a_stable bdf3'\nanswer = 'no'", "BDF3 is not A-stable", []),
        ("BDF2 is A-stable", "value = 'a_stable bdf2'", "BDF3 is A-stable", [(1, 4, "2", "3")]),
        ("y' = -sin(y)", "given = true", "Let y' = -sin(y).", []),
        ("y' = -sin(y)", "given = true", "Let y' = -2sin(y).", [(1, 5, "y' = -sin(y)", "y' = -2sin(y")]),
    ],
)
def test_a_phrase_without_numbers_states_a_fact_or_is_given(phrase, more, text, found):
    assert findings(text, claim(phrase, more)) == found


def test_a_fact_is_in_words():
    with pytest.raises(
        ValueError, match=r"claim 'a': order rk4 is a number; its phrase has no \{value\} in place of one"
    ):
        findings("of order 4", claim("of order", "value = 'order rk4'"))


MOVED = """Throughout, h = 0.1. It is stable up to h = 1, and with h = 0.25 the truth is 1.481636.

| Method | y(1) | y(2) |
|---|---|---|
| Euler | 0.40096 | 0.16077 |

The errors:

| Method | order | error |
|---|---|---|
| Euler | 1 | 0.03283 |
"""
OF_MOVED = """claim = [
    { id = "h", phrase = "h = 0.1", given = true },
    { id = "other h", phrase = "h = 0.25", given = true },
    { id = "truth", phrase = "truth is {value}", value = { given = "1.481636" } },
    { id = "row", phrase = "| Euler | {a} | {b}", column = ["y(1)", "y(2)"], values = VALUES },
]""".replace("VALUES", "{ a = { given = '0.40096' }, b = { given = '0.16077' } }")


@pytest.mark.parametrize(
    ("old", "new", "line", "found"),
    [
        ("h = 0.1", "h = 0.25", 1, "0.25"),  # and not the 1 of h = 1
        ("truth is", "value is", 1, "value is 1.481636"),
        ("| Euler | 0.4", "| Heun | 0.4", 5, "| Heun | 0.40096 | 0.16077"),  # and not the other row of Euler
        ("| Euler | 0.4", "| Euler | 0.3", 5, "0.30096"),
    ],
)
def test_what_is_wrong_is_reported_where_it_was_changed(old, new, line, found):
    document = document_of(MOVED.replace(old, new, 1), "markdown")
    findings = [x for one in check_claims(document, parse_claims(OF_MOVED).claims) for x in one.findings]
    assert (findings[0].line, findings[0].found) == (line, found)


def test_the_wrong_numbers_of_several_are_named_with_their_questions():
    values = 'values = { a = { ask = "order rk4" }, b = { ask = "order heun2" } }'
    (one,) = parse_claims(f'[[claim]]\nid = "| {{a}} | {{b}} |"\nphrase = "| {{a}} | {{b}} |"\n{values}').claims
    (finding,) = check_claim(document_of("| 4 | 3 |"), one, one.spellings()).findings
    assert finding.message == "expected 2, found 3 for order heun2"
    both = check_claim(document_of("| 5 | 3 |"), one, one.spellings()).findings
    assert [x.message for x in both] == ["expected 4, found 5 for order rk4", finding.message]
