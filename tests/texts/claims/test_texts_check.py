"""A claim holds of the text that says it and of no text that says another number; what nobody claims is listed."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.checking import (
    GIVEN,
    LABEL,
    RUN,
    UNCOVERED,
    WORKED_OUT,
    check_claim,
    check_claims,
    coverage,
)
from driftproof.texts.claims.claims import Claim, Claims, parse_claims
from driftproof.texts.claims.report import TextReport
from driftproof.texts.readers.document import document_of

Run = Callable[..., tuple[int, str, str]]


def claim(phrase: str, more: str = "", value: str = "0.33") -> Claim:
    """A claim whose one value, if its phrase has one, is a number spelled so."""
    values = f"value = {{given = {json.dumps(value)}}}" if "{value}" in phrase else ""
    text = f"[[claim]]\nid = 'a'\nphrase = {json.dumps(phrase, ensure_ascii=False)}\n{values}\n{more}"
    return parse_claims(text.encode()).claims[0]


def found(text: str, one: Claim, form: str = "plain") -> int:
    return len(check_claims(document_of(text, form), [one])[0].occurrences)


# phrase, value, a text that says it, texts that do not
STANDS = [
    ("is {value} off", "0.33", "it is\u00a00.33\n  off.", ["it is 0.34 off", "it is 0.331 off", "this is 10.33 off"]),
    ("error {value}", "0.33", "error 0.33, and", ["error 0.331", "error 0.33e-4", "error 0.33×10⁻⁴", "error 0.33/2"]),
    ("error {value}", "0.33", "an error 0.33", ["error 0.33%", "error 0.33 %", "terror 0.33", "error 0.33.1"]),
    (
        "{value} of it",
        "0.33",
        "(0.33 of it",
        ["-0.33 of it", "1.0.33 of it", "10.33 of it", "√0.33 of it", "^0.33 of it"],
    ),
    ("v = {value}", "-0.5", "v = −0.5", ["v = 0.5", "v = - 0.5", "v = −0.55", "v = −0,5"]),
    ("v = {value}", "-0.5", "v = -0.5", ["v = +0.5"]),
    (
        "about {value} steps",
        "5651",
        "about 5,651 steps",
        ["about 56,51 steps", "about 5651.0 steps", "about 5 651 steps"],
    ),
    ("about {value} steps", "5651", "about 5\u202f651 steps", ["about 5\u202f652 steps"]),
    ("is {value}", "3.3e-4", "is 3.3×10⁻⁴.", ["is 3.3×10⁻³.", "is 3.3×10⁴.", "is 3.3"]),
    ("is {value}", "3.3e-4", "is 3.3e-04", ["is 3.3e-05", "is 3.3e-40", "is 3.3e4"]),
    ("O(h^{value})", "4", "O(h⁴)", ["O(h⁵)", "O(h⁴⁴)", "O(h4)"]),
    ("Euler{value}-0.054", "0.090", "Euler0.090-0.054", ["Euler0.090-0.055", "Euler0.091-0.054"]),
    (
        "ends after {value}",
        "2",
        "ends after 2.",
        ["ends after 2.5", "ends after 2/3", "ends after 2h", "ends after 2√2", "ends after 2²"],
    ),
]


@pytest.mark.parametrize(("phrase", "value", "text", "others"), STANDS)
def test_phrase_stands_in_no_text_with_another_number(phrase: str, value: str, text: str, others: list[str]) -> None:
    one = claim(phrase, "given = true", value)
    assert found(text, one) == 1
    assert [other for other in others if found(other, one)] == []


@pytest.mark.parametrize(
    ("form", "text"),
    [
        ("markdown", "| RK4 | **3.3×10⁻⁴** |"),
        ("html", "<tr><td>RK4<td>3.3&times;10<sup>&minus;4</sup></tr>"),
        ("tex", "RK4 & $3.3\\times 10^{-4}$ \\\\"),
    ],
)
def test_one_phrase_serves_every_format(form: str, text: str) -> None:
    one = claim("RK4 | {value}", value="3.3e-4")
    assert found(text, one, form) == 1
    assert found(text.replace("3.3", "3.4"), one, form) == 0


def test_case_counts_unless_told() -> None:
    assert (found("Is 0.33", claim("is {value}")), found("Is 0.33", claim("is {value}", "ignore_case = true"))) == (
        0,
        1,
    )


def findings(text: str, one: Claim) -> list[tuple[int, int, str, str]]:
    (outcome,) = check_claims(document_of(text), [one])
    return [(finding.line, finding.column, finding.expected, finding.found) for finding in outcome.findings]


def test_finding_names_line_column_expected_and_found() -> None:
    one = claim("at {value} after 5 steps", "given = true")
    assert findings("x\n\nis at 0.33 after 5 steps", one) == []
    assert findings("x\n\nis at 0.34 after 5 steps", one) == [(3, 7, "0.33", "0.34")]
    assert findings("x\n\nis at 0.33 after 6 steps", one) == [(3, 18, "5", "6")]


def test_finding_is_the_place_that_comes_closest() -> None:
    one = claim("from {value} to 0.5", "given = true")
    assert findings("from 0.1 to 0.2\nfrom 0.3 to 0.5\nfrom 0.2 to 0.4", one) == [(2, 6, "0.33", "0.3")]


def test_finding_in_cells_that_run_together_shows_the_run() -> None:
    assert findings("Euler2.3905.15240", claim("Euler2.390{value}", "given = true", "5.15140")) == [
        (1, 6, "2.3905.15140", "2.3905.15240")
    ]


def test_phrase_that_stands_nowhere_is_looked_for_by_its_beginning() -> None:
    one = claim("the error is {value} here")
    (found_at,) = findings("a\nthe error was 0.33 here", one)
    assert found_at[:2] == (2, 1)
    (outcome,) = check_claims(document_of("The error is 0.4 here"), [one])
    assert "ignore_case = true allows them" in outcome.findings[0].message
    assert findings("nothing", one) == [(1, 1, "the error is 0.33 here", "")]


def test_phrase_stands_exactly_as_often_as_the_claim_says() -> None:
    text = "is 0.33 and is 0.33"
    assert findings(text, claim("is {value}", "count = 2")) == []
    assert [place[:2] for place in findings(text, claim("is {value}"))] == [(1, 13)]
    assert len(findings(text, claim("is {value}", "count = 3"))) == 1
    assert len(findings(text, claim("is {value}", "count = 0"))) == 2


def test_number_right_but_part_of_more_is_said_to_be() -> None:
    (outcome,) = check_claims(document_of("is 0.33 %"), [claim("is {value}")])
    assert "stands nowhere" in outcome.findings[0].message


@given(st.integers(0, 999), st.integers(0, 999), st.sampled_from(["", "-"]))
def test_claim_holds_of_its_own_number_only(n: int, m: int, sign: str) -> None:
    one = claim("at {value} now", value=f"{sign}{n / 100:.2f}")
    assert found(f"it is at {sign.replace('-', chr(0x2212))}{m / 100:.2f} now", one) == (n == m)


TEXT = """\
RK4, read in 5 min.
1. In Section 2 the error is 0.33 after 40 steps, q₁ = 0.5.
It prints 0.25, and nobody claims 7 or 8/9."""
CLAIMS = Claims(
    (claim("error is {value} after 40 steps", "given = true"),),
    parse_claims(b"[[label]]\nphrase = '{n} min'\nwhy = 'time'").labels,
)


def test_every_number_is_accounted_for() -> None:
    document = document_of(TEXT)
    outcomes = check_claims(document, CLAIMS.claims)
    at = document.text.text.index("0.25")
    covered = coverage(document, outcomes, CLAIMS.labels, [(at, at + 4)])
    assert [(one.number.text, one.kind) for one in covered.numbers] == [
        ("4", LABEL),
        ("5", LABEL),
        ("1", LABEL),
        ("2", LABEL),
        ("0.33", GIVEN),
        ("40", GIVEN),
        ("1", LABEL),
        ("0.5", UNCOVERED),
        ("0.25", RUN),
        ("7", UNCOVERED),
        ("8/9", UNCOVERED),
    ]
    assert covered.share == Fraction(1, 2)
    assert coverage(document, [], CLAIMS.labels).counts[UNCOVERED] == 6


def test_numbers_that_run_together_are_counted_one_by_one() -> None:
    text = '[[claim]]\nid="a"\nphrase="RK4{a}{b}{c}"\nvalues={a="1/4", b="-1/8", c="16"}'
    document = document_of("RK40.25-0.12516")
    counts = coverage(document, check_claims(document, parse_claims(text.encode()).claims)).counts
    assert (counts[WORKED_OUT], counts[LABEL], counts[UNCOVERED]) == (3, 1, 0)


def test_label_that_stands_nowhere_is_refused() -> None:
    with pytest.raises(ValueError, match="label for 'time' stands nowhere"):
        coverage(document_of("none"), [], CLAIMS.labels)


@given(st.lists(st.sampled_from(["error is 0.33 after 40 steps", "0.5", "5 min", "RK4", " ", "1/2", "x"])))
def test_coverage_counts_every_number_once(pieces: list[str]) -> None:
    document = document_of(" ".join(["5 min", *pieces]))
    covered = coverage(document, check_claims(document, CLAIMS.claims), CLAIMS.labels)
    spans = [(one.number.start, one.number.end) for one in covered.numbers]
    assert spans == sorted(set(spans))
    digits = {i for i, character in enumerate(document.text.text) if character.isdigit()}
    assert digits == {i for start, end in spans for i in range(start, end)} & digits


def test_report_says_what_is_wrong_and_what_is_covered() -> None:
    document = document_of(TEXT)
    assert TextReport.of("a.txt", document, CLAIMS).written("text").splitlines() == [
        "a.txt: 1 claim, all hold",
        "33.3% of 6 numbers covered: 0 by values, 2 given; 4 not; and 5 labels",
    ]
    wrong = TextReport.of("a.txt", document_of(TEXT.replace("0.33", "0.34")), CLAIMS)
    assert wrong.written("text").splitlines()[:2] == [
        "a.txt:2:30: a: expected 0.33, found 0.34",
        "a.txt: 1 claim, 1 refuted",
    ]
    assert TextReport.of("a.txt", document, Claims()).written("text").startswith("a.txt: 0 claims, so nothing is held")
    listed = TextReport.of("a.txt", document, CLAIMS, suggest=True)
    assert any(
        line.startswith("a.txt:3:11: not covered: 'It prints 0.25, and") for line in listed.written("text").splitlines()
    )
    assert "looks like default.h" in listed.written("text")


def test_report_in_json_has_every_number_and_every_finding() -> None:
    answer = json.loads(
        TextReport.of("a.txt", document_of(TEXT.replace("40", "41")), CLAIMS, suggest=True).written("json")
    )
    assert answer["passed"] is False
    assert answer["claims"] == {"a": {"count": 1, "found": 0}}
    assert answer["findings"][0] | {"message": ""} == {
        "claim": "a", "line": 2, "column": 41, "expected": "40", "found": "41", "message": ""
    }  # fmt: skip
    assert answer["coverage"][UNCOVERED] == len([n for n in answer["numbers"] if n["kind"] == UNCOVERED]) == 6
    assert {"text": "4", "line": 1, "column": 3, "kind": "label", "by": "part of a name"} in answer["numbers"]


def test_report_for_github_escapes_what_it_must() -> None:
    report = TextReport.of("a,b:c%.txt", document_of("is 0.34 %\nis 0.3"), Claims((claim("is {value}\n"),)))
    (line,) = report.written("github").splitlines()
    assert line.startswith("::error file=a%2Cb%3Ac%25.txt,line=2,col=4,title=a::expected 0.33")


def test_least_coverage_fails_a_text_with_new_numbers() -> None:
    claims = Claims(CLAIMS.claims, CLAIMS.labels, coverage=Fraction(1, 3))
    assert not TextReport.of("a", document_of(TEXT), claims).findings
    report = TextReport.of("a", document_of(TEXT + " And 9."), claims)
    assert report.findings
    assert report.findings[0].claim == "coverage"
    assert not TextReport.of("a", document_of("5 min"), Claims((), CLAIMS.labels, coverage=Fraction(1))).findings


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.md").write_text("One step of RK4 leads to **337/384**, or 0.8776.\n", encoding="utf-8")
    (tmp_path / "c.toml").write_text(
        '[[claim]]\nid="q"\nphrase="leads to {q}, or {d}."\nvalues.q="rk4.first_step.q"\nexact=true\n'
        'values.d={ask="step rk4 h=1/2 : q", places=4}\n',
        encoding="utf-8",
    )
    return tmp_path


def test_command_answers_with_its_exit_status(files: Path, run: Run) -> None:
    assert run("check", "a.md", "--claims", "c.toml") == (
        0,
        "a.md: 1 claim, all hold\n100% of 2 numbers covered: 2 by values, 0 given; 0 not; and 1 label\n",
        "",
    )
    text = (files / "a.md").read_text(encoding="utf-8")
    (files / "a.md").write_text(text.replace("0.8776", "0.8777"), encoding="utf-8")
    status, out, err = run("check", "a.md", "--claims", "c.toml")
    assert (status, err) == (1, "")
    assert out.startswith("a.md:1:42: q: expected 0.8776, found 0.8777\n")
    assert run("check", "a.md", "--claims", "c.toml", "--format", "github")[1].startswith(
        "::error file=a.md,line=1,col=42"
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("a.md",), "one of the arguments --claims --init is required"),
        (("a.md", "--claims", "c.toml", "--init"), "not allowed with argument"),
        (("none.md", "--claims", "c.toml"), "none.md"),
        (("a.md", "--claims", "none.toml"), "none.toml"),
        (("a.md", "--claims", "a.md"), "a.md: "),
        (("..", "--claims", "c.toml"), "Is a directory"),
        (("a.md", "--claims", "c.toml", "--time-limit", "0"), "is no time limit"),
        (("a.md", "--claims", "c.toml", "--format", "xml"), "invalid choice"),
    ],
)
def test_command_refuses_bad_input_in_one_line(files: Path, run: Run, arguments: tuple[str, ...], message: str) -> None:
    status, out, err = run("check", *arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_check_of_one_claim_looks_at_no_more_places_than_it_says() -> None:
    one = claim("a {value} b")
    outcome = check_claim(document_of("a 1 b " * 5000), one, one.spellings())
    assert len(outcome.findings) == 1
