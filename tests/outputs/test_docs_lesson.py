"""The lesson, and a small text of our own, stand as their claims say, and every changed digit is noticed."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from docs.lesson_tables import CLAIMS, LESSON, MISPRINTS, TABLES, figures, known, misprints, unnoticed
from docs.pages import refreshed
from driftproof.texts.claims.checking import check_claim, check_claims, coverage
from driftproof.texts.claims.claims import parse_claims, read_claims
from driftproof.texts.claims.listings import run_listings
from driftproof.texts.claims.phrases import ANY_NUMBER, Phrase
from driftproof.texts.readers.document import document_of, read_document
from driftproof.texts.readers.numbers import numbers_in
from proofs.claims import REQUIRED, STATEMENTS
from proofs.printed import ROWS
from tests.looping import some

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "lesson.md"
SPRING = ROOT / "examples" / "text" / "spring.md"
SPRING_CLAIMS = SPRING.with_name("claims.toml")
beside = pytest.mark.skipif(not LESSON.exists(), reason="the lesson is not beside this checkout")


@beside
def test_lesson_stands_as_its_claims_say_and_its_listing_prints_what_it_shows(answer):
    assert "1 listing run, all hold" in answer("check", str(LESSON), "--claims", str(CLAIMS), "--run")


@pytest.mark.slow
@beside
def test_figures_of_the_page_are_those_of_the_lesson():
    """All numbers are covered, and of all changes of one covered digit none goes unnoticed."""
    found = figures()
    assert found == known(), "run `python docs/lesson_tables.py`"
    assert found["unnoticed"] == found["refuted"] == found["uncovered"] == 0
    assert found["misprints"] > 5000


@beside
@pytest.mark.long
def test_every_misprint_of_the_lesson_is_noticed_in_the_whole_file():
    """The same changes, each in the whole text, read from its first character to its last."""
    found = some(misprinted(read_document(LESSON), CLAIMS, "plain"), known()["misprints"])
    assert [place for place, lines in found if not lines] == []


def misprinted(document, claims, form):
    """The place of every misprint, and the lines of its findings."""
    for claim in read_claims(claims).claims:
        spellings = claim.spellings()
        for at, digit in misprints(document, check_claim(document, claim, spellings)):
            wrong = document_of(document.source[:at] + digit + document.source[at + 1 :], form)
            findings = check_claim(wrong, claim, spellings).findings
            yield document.position_of_origin(at), [finding.line for finding in findings]


def test_claims_quote_no_sentence():
    """Between two numbers of a phrase there are a few words at most, and in all of it not many more."""
    for claim in some(read_claims(CLAIMS).claims, 100):
        counts = [len(re.findall(r"[A-Za-z]{2,}", literal)) for literal in claim.phrase.literals]
        assert max(counts) <= 5, claim.id
        assert sum(counts) <= 8, claim.id


def test_page_is_what_its_generator_writes():
    page = PAGE.read_text(encoding="utf-8")
    assert refreshed(page, TABLES) == page, "run `make docs`"
    assert refreshed(page.replace(str(known()["misprints"]), "5000"), TABLES) == page


def test_every_number_that_the_proofs_publish_is_claimed_of_the_lesson():
    """With the very value of the proof: but for two that the lesson spells out, or only refers to."""
    spelled = {}
    for claim in read_claims(CLAIMS).claims:
        for key in _statements(claim):
            spelled.setdefault(key, []).extend(text for texts in claim.spellings().values() for text in texts)
    assert {row.claim for row in ROWS if row.claim not in spelled} == {"L069", "L071"}
    assert [row for row in ROWS if row.claim in spelled and row.text not in spelled[row.claim]] == []


def test_statements_that_settle_what_is_given_are_in_the_ledger():
    claims = read_claims(CLAIMS).claims
    named = {key for claim in claims for key in re.findall(r"\bL\d+\b", claim.given or "")}
    assert len(named) >= 10
    assert named <= set(REQUIRED)
    assert {key for claim in claims for key in _statements(claim)} <= set(STATEMENTS)


def _statements(claim):
    first_and_last = re.fullmatch(r"L(\d+) to L(\d+)", claim.id)
    if first_and_last:
        return [f"L{n:03}" for n in range(int(first_and_last[1]), int(first_and_last[2]) + 1)]
    return re.findall(r"\bL\d+\b", claim.id)


def test_text_of_ours_stands_as_its_claims_say(answer):
    shown = answer("check", str(SPRING), "--claims", str(SPRING_CLAIMS), "--run", "--coverage")
    assert shown.startswith(f"{SPRING}: 19 claims, 1 listing run, all hold\n100% of 40 numbers")


@pytest.mark.slow
def test_every_misprint_of_our_text_is_noticed_and_told_in_its_place():
    for place, lines in some(misprinted(read_document(SPRING), SPRING_CLAIMS, "markdown"), 701):
        assert min((abs(line - place.line) for line in lines), default=2) <= 1, place


def test_uncovered_digit_of_our_text_would_be_seen():
    claims = read_claims(SPRING_CLAIMS)
    document = read_document(SPRING)
    fewer = [claim for claim in claims.claims if claim.id != "ratio"]
    assert [number.text for number in coverage(document, check_claims(document, fewer)).uncovered] == ["70"]


def test_misprint_in_the_printed_lines_of_our_text_is_seen_by_running_it():
    source = SPRING.read_text(encoding="utf-8")
    assert run_listings(document_of(source, "markdown")).findings == ()
    (finding,) = run_listings(document_of(source.replace("-0.8245", "-0.8246"), "markdown")).findings
    assert (finding.expected, finding.found) == ("q = -0.8245, v = 0.5614", "q = -0.8246, v = 0.5614")


@dataclass(frozen=True)
class Careless(Phrase):
    """Takes any number for the right one."""

    def exact(self, spellings):
        (name,) = self.names
        return re.compile(f"(?P<{name}>{ANY_NUMBER})".join(map(re.escape, self.literals)))


def test_misprints_that_a_careless_claim_lets_pass_are_counted():
    (claim,) = parse_claims('[[claim]]\nid="a"\nphrase="is {value} at RK4"\nvalue="1/4"').claims
    document = document_of("it is 0.25 at RK4, q\u2081")
    careless = replace(claim, phrase=Careless(claim.phrase.literals, claim.phrase.names))
    for one, missed in ((claim, 0), (careless, 27)):
        outcome = check_claims(document, [one])[0]
        assert len(list(misprints(document, outcome))) == 36
        assert len(unnoticed(document, outcome)) == missed


def test_misprint_is_a_digit_of_the_same_kind():
    assert (MISPRINTS["5"], MISPRINTS["²"], MISPRINTS["₁"]) == ("012346789", "⁰¹³⁴⁵⁶⁷⁸⁹", "₀₂₃₄₅₆₇₈₉")
    assert "½" not in MISPRINTS["½"]
    assert len(MISPRINTS["½"]) == 17
    assert all(numbers_in(document_of(digit).text.text) for digit in "½" + MISPRINTS["½"])
