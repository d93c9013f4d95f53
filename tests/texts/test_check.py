"""The report says what is wrong and what is covered, as text, JSON and annotations, and the command its status."""

import json
from fractions import Fraction
from inspect import signature
from pathlib import Path

import pytest

from driftproof.support import assertions
from driftproof.texts.check import TextReport, assert_text, check, claims_beside, texts_with_claims
from driftproof.texts.claims.checking import UNCOVERED
from driftproof.texts.claims.claims import Claims
from driftproof.texts.claims.listings import run_listings
from driftproof.texts.readers.document import document_of
from tests.texts.sample import CLAIMS, TEXT, claim


def test_report_says_what_is_wrong_and_what_is_covered():
    document = document_of(TEXT)
    covered = "33.3% of 6 numbers covered: 0 by values, 2 given, 4 uncovered; 5 labels not counted"
    assert TextReport.of("a.txt", document, CLAIMS).written("text") == f"a.txt: 1 claim, all hold\n{covered}"
    words = TextReport.of("a.txt", document_of(TEXT + " Two, two and ten."), CLAIMS)
    assert words.written("text").splitlines()[2] == "not checked: 3 words for numbers or growth (two ×2, ten)"
    assert json.loads(words.written("json"))["words"][2] == {"text": "ten", "line": 3, "column": 58}
    denied = claim("RK4 is neither A- nor L-stable", 'value = "a_stable rk4"\nanswer = "no"')
    words = TextReport.of("a.txt", document_of("RK4 is neither A- nor L-stable, neither halved."), Claims((denied,)))
    assert words.written("text").splitlines()[2] == "not checked: 2 words for numbers or growth (neither, halved)"
    again = TextReport.of("a.txt", document_of(TEXT + " Then the error is 0.47 after 40 steps."), CLAIMS)
    assert again.written("text").splitlines()[2] == "not checked: 2 numbers where a claim has another one (0.47, 40)"
    percent = TextReport.of("a.txt", document_of("It is 0.33 percent."), Claims((claim("is {value}"),)))
    assert "closest is 'is 0.33 percent'" in percent.written("text").splitlines()[0]
    parts = TextReport.of("a.txt", document_of(TEXT + r"\input{b} \input{c}"), CLAIMS)
    assert parts.written("text").splitlines()[2] == "not read: b, c, included by the text; check each separately"
    wrong = TextReport.of("a.txt", document_of(TEXT.replace("0.33", "0.34")), CLAIMS)
    assert wrong.written("text").startswith("a.txt:2:30: a: expected 0.33, found 0.34\na.txt: 1 claim, 1 refuted\n")
    nothing = TextReport.of("a.txt", document, Claims()).written("text")
    assert nothing.startswith("a.txt: 0 claims, so nothing was checked")
    listed = TextReport.of("a.txt", document, CLAIMS, suggest=True)
    assert any(line.startswith("a.txt:3:11: not covered: 'It prints") for line in listed.written("text").splitlines())
    assert "looks like default.h" in listed.written("text")


def test_report_in_json_has_every_number_and_every_finding():
    report = TextReport.of("a.txt", document_of(TEXT.replace("40", "41")), CLAIMS, suggest=True)
    answer = json.loads(report.written("json"))
    assert answer["passed"] is False
    assert answer["claims"] == {"a": {"count": 1, "found": 0}}
    assert answer["findings"][0] | {"message": ""} == {
        "claim": "a", "line": 2, "column": 41, "expected": "40", "found": "41", "message": ""
    }  # fmt: skip
    assert answer["coverage"][UNCOVERED] == len([n for n in answer["numbers"] if n["kind"] == UNCOVERED]) == 6
    assert {"text": "4", "line": 1, "column": 3, "kind": "label", "by": "part of a name"} in answer["numbers"]


def test_report_for_github_escapes_what_it_must():
    report = TextReport.of("a,b:c%.txt", document_of("is 0.34 %\nis 0.3"), Claims((claim("is {value}\n"),)))
    (line,) = report.written("github").splitlines()
    assert line.startswith("::error file=a%2Cb%3Ac%25.txt,line=2,col=4,title=a::expected 0.33")
    suggested = TextReport.of("a.txt", document_of("is 0.1234"), Claims(), suggest=True).written("github")
    assert suggested == "::notice file=a.txt,line=1,col=4,title=not covered::'is 0.1234'"


def test_least_coverage_fails_a_text_with_new_numbers():
    claims = Claims(CLAIMS.claims, CLAIMS.labels, coverage=Fraction(1, 3))
    assert not TextReport.of("a", document_of(TEXT), claims).findings
    report = TextReport.of("a", document_of(TEXT + " And 9."), claims)
    assert report.findings
    assert report.findings[0].claim == "coverage"
    assert (report.findings[0].line, report.findings[0].column) == (2, 56), "the first number that is not covered"
    assert not TextReport.of("a", document_of("5 min"), Claims((), CLAIMS.labels, coverage=Fraction(1))).findings


def test_report_shows_24_characters_three_values_five_words_and_5000_numbers():
    text = "a" * 30 + " 40 " + "b" * 30 + "\ntwo three four five six seven"
    report = TextReport.of("a.txt", document_of(text), Claims(), suggest=True).written("text").splitlines()
    assert report[0].startswith(f"a.txt:1:32: not covered: '{'a' * 23} 40 {'b' * 23}'; looks like ")
    assert report[0].partition("; looks like ")[2].count(", ") == 2
    assert " more" in report[0]
    assert report[-1] == "not checked: 6 words for numbers or growth (two, three, four, five, six, 1 more)"
    five = TextReport.of("a.txt", document_of("two three four five six"), Claims()).written("text")
    assert five.endswith("(two, three, four, five, six)")
    assert TextReport.of("a.txt", document_of("7 " * 5000), Claims(), suggest=True).coverage.counts[UNCOVERED] == 5000
    with pytest.raises(ValueError, match="5001 numbers are not covered; at most 5000 are listed"):
        TextReport.of("a.txt", document_of("7 " * 5001), Claims(), suggest=True)


def test_as_many_values_as_are_named_are_all(monkeypatch):
    report = TextReport.of("a.txt", document_of("It is 0.877604 !"), Claims(), suggest=True)
    everything = [one.question for one in report.suggestions.look_alikes(report.coverage.uncovered[0])]
    monkeypatch.setattr("driftproof.texts.check._MOST_NAMED", len(everything))
    line, *_ = report.written("text").splitlines()
    assert line == f"a.txt:1:7: not covered: 'It is 0.877604 !'; looks like {', '.join(everything)}"


def test_listing_that_prints_something_else_is_a_finding(files):
    (files / "none.toml").write_text("", encoding="utf-8")
    for shown, passed in (("0.25", True), ("0.26", False)):
        (files / "b.md").write_text(f"5 of\n\n```python\nprint(1/4)\n```\n```\n{shown}\n```\n", encoding="utf-8")
        report = check("b.md", "none.toml", run=True)
        assert report.passed is passed
        assert [(one.claim, one.line) for one in report.findings] == [("listing 1", 7)][passed:]
        share, run, uncovered = ("50%", ", 1 by running", 1) if passed else ("0%", "", 2)
        counted = f"{share} of 2 numbers covered: 0 by values, 0 given{run}, {uncovered} uncovered; 1 label not counted"
        assert report.written("text").splitlines()[-1] == counted


def test_claims_stand_beside_the_text_or_what_is_missing_is_named(files):
    (files / "my text.md").write_text("7")
    draft = r"driftproof check 'my text\.md' --init > 'my text\.md\.claims\.toml'$"
    with pytest.raises(ValueError, match=rf"^no claims to check: give --claims FILE or write .* draft them: {draft}"):
        claims_beside("my text.md")
    with pytest.raises(ValueError, match=r"^no\.md: No such file or directory$"):
        claims_beside("no.md")
    with pytest.raises(ValueError, match=r"^no text in \. has a claims file; that of chapter\.md would be"):
        texts_with_claims(Path())
    (files / "a.md.claims.toml").write_text("", encoding="utf-8")
    assert claims_beside("a.md") == Path("a.md.claims.toml")
    assert texts_with_claims(Path()) == texts_with_claims(Path("a.md")) == [Path("a.md")]


@pytest.mark.parametrize(
    "asked", [{"claims": "c.toml", "init": True}, {"init": True, "run": True}, {"init": True, "coverage": True}]
)
def test_claims_are_drafted_or_held(asked, files):
    with pytest.raises(ValueError, match="--init drafts claims"):
        check("a.md", **asked)


def test_listings_have_ten_seconds_unless_told():
    assert {signature(f).parameters["time_limit"].default for f in (check, run_listings)} == {10}


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.md").write_text("One step of RK4 leads to **337/384**, or 0.8776.\n", encoding="utf-8")
    (tmp_path / "c.toml").write_text(
        '[[claim]]\nid="q"\nphrase="leads to {q}, or {d}."\nvalues.q="rk4.first_step.q"\nexact=true\n'
        'values.d={ask="step rk4 h=1/2 : q", places=4}\n',
        encoding="utf-8",
    )
    return tmp_path


def test_command_answers_with_its_exit_status(files, run):
    out = "a.md: 1 claim, all hold\n100% of 2 numbers covered: 2 by values, 0 given, 0 uncovered; 1 label not counted\n"
    assert run("check", "a.md", "--claims", "c.toml") == (0, out, "")
    text = (files / "a.md").read_text(encoding="utf-8")
    (files / "a.md").write_text(text.replace("0.8776", "0.8777"), encoding="utf-8")
    status, out, err = run("check", "a.md", "--claims", "c.toml")
    assert (status, err) == (1, "")
    assert out.startswith("a.md:1:42: q: expected 0.8776, found 0.8777\n")
    _, out, _ = run("check", "a.md", "--claims", "c.toml", "--format", "github")
    assert out.startswith("::error file=a.md,line=1,col=42")


def test_what_the_draft_calls_perhaps_wrong_is_said_until_it_is_mended(tmp_path):
    """It is no finding, as nobody claimed it."""
    text, claims = tmp_path / "a.md", tmp_path / "a.md.claims.toml"
    wrong = "BDF3 is A-stable.\nThe angle: BDF3 is A(86.0°)-stable, BDF4 A(74.3°)-stable. RK4's real limit is 2.785.\n"
    right = wrong.replace("BDF3 is A-stable", "BDF2 is A-stable").replace("74.3", "73.4")
    text.write_text(wrong, encoding="utf-8")
    claims.write_text(check(text, init=True)["claims"], encoding="utf-8")
    report = check(text)
    assert report.passed
    places = [("BDF3 is A-stable", 1, 1, "a_stable bdf3 is no"), ("74.3", 2, 44, "angle bdf4 is 73.4")]
    assert [tuple(one.values()) for one in report.as_dict()["slips"]] == places
    shown = report.written("text")
    assert f"{text}:2:44: 74.3 is perhaps a slip: angle bdf4 is 73.4\n" in shown
    assert ", all hold; 2 perhaps wrong\nwhat is right is kept by a claim" in shown
    assert report.written("github").count("::warning file=") == 2
    text.write_text(right, encoding="utf-8")
    assert (check(text).slips, check(text).passed) == ((), True)


def test_a_limit_called_perhaps_wrong_is_named_though_a_calculation_has_it(tmp_path):
    text, said = tmp_path / "a.md", "It behaves as d' = -1.5 d. Euler is stable for {0}, AB2 for {0}."
    text.write_text(said.format("h ≤ 4/3 ≈ 1.333"), encoding="utf-8")
    Path(f"{text}.claims.toml").write_text(check(text, init=True)["claims"], encoding="utf-8")
    report = check(text).as_dict()
    assert [one["text"] for one in report["slips"]] == ["4/3"]
    assert [one["kind"] for one in report["numbers"] if one["text"] == "1.333"] == ["value", "uncovered"]


SLIP_AND_OTHER = """Version 0.40667.

For y' = -y, y(0) = 1 with h = 0.1:

| t | load | RK4 |
| 0.9 | 7.1 | 0.40667 |
"""


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [("\n\n", "\n\nIn all:\n\n", (8, 15)), ("7.1", "7.2", (6, 15)), ("| 0.40667", "| 0.40657", None)],
)
def test_a_number_called_perhaps_wrong_is_named_at_its_own_place_alone(tmp_path, old, new, place):
    text = tmp_path / "a.md"
    text.write_text(SLIP_AND_OTHER, encoding="utf-8")
    Path(f"{text}.claims.toml").write_text(check(text, init=True)["claims"], encoding="utf-8")
    assert len(check(text).slips) == 1
    text.write_text(SLIP_AND_OTHER.replace(old, new, 1), encoding="utf-8")
    report = check(text).as_dict()
    assert [(one["line"], one["column"]) for one in report["slips"]] == [place] * (place is not None)


def test_an_assertion_raises_with_every_finding_and_tells_listeners(tmp_path, monkeypatch):
    text, heard = tmp_path / "a.txt", []
    monkeypatch.setattr(assertions, "listeners", [heard.append])
    text.write_text("The order is 4.", encoding="utf-8")
    Path(f"{text}.claims.toml").write_text(
        "claim = [{ id = 'o', phrase = 'order is {value}', value = 'order rk4' }]", encoding="utf-8"
    )
    assert_text(text)
    text.write_text("The order is 5.", encoding="utf-8")
    with pytest.raises(AssertionError, match=r"a\.txt:1:14: o: expected 4, found 5\n"):
        assert_text(text)
    assert [(one.headline, one.passed) for one in heard] == [
        (f"{text} holds", True),
        (f"{text} has 1 claim that does not hold", False),
    ]
