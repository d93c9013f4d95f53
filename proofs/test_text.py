"""The lesson's text, if it lies beside this checkout: its numbers are their values, its words those that were read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from driftproof import check
from driftproof.texts.values import published
from proofs.claims import STATEMENTS
from proofs.sentences import LESSON, changes, lines_read

CLAIMS = Path(__file__).parent / "lesson" / "claims.toml"
BESIDE = pytest.mark.skipif(not LESSON.exists(), reason=f"the lesson's text is not beside this checkout, as {LESSON}")


@pytest.fixture(autouse=True)
def proved_values(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, values_so_far: Any) -> None:
    """Published values are those that this run has proved: the file is written only after it."""
    document, entries = published._document(), published.published_values()
    proved = {value["id"]: {**entries.get(value["id"], {}), **value} for value in values_so_far}
    monkeypatch.setattr(published, "_document", lambda: {**document, "values": {**entries, **proved}})


@BESIDE
def test_every_number_of_the_lesson_is_covered_and_is_its_value() -> None:
    """Where the lesson prints a number, it prints the value that a proof publishes or that a question asks for."""
    report = check(LESSON, CLAIMS, coverage=True)
    assert report.passed, f"{report}"
    assert "240 numbers covered" in str(report)


# A digit of a state, of a fraction and of an output.
MISPRINTS = (("0.877604", "0.877614"), ("337/384", "338/384"), ("energy=0.499895", "energy=0.499885"))


@BESIDE
@pytest.mark.parametrize(("printed", "wrong"), MISPRINTS)
def test_a_wrong_number_of_the_lesson_is_noticed(printed: str, wrong: str, tmp_path: Path) -> None:
    """Everywhere that the lesson prints it, and nowhere else is anything changed."""
    text, copy = LESSON.read_text(encoding="utf-8"), tmp_path / LESSON.name
    assert printed in text
    places = [i for i in range(len(text)) if text.startswith(printed, i)]
    for at in places:
        copy.write_text(f"{text[:at]}{wrong}{text[at + len(printed) :]}", encoding="utf-8")
        assert not check(copy, CLAIMS).passed, text[at - 40 : at + 40]


def test_every_statement_is_in_a_line_that_was_read() -> None:
    """The lines that were read have all statements of the lesson, by rising numbers."""
    read = lines_read()
    assert sorted({claim for line in read for claim in line.claims}) == [*STATEMENTS]
    assert [line.number for line in read] == sorted({line.number for line in read})


@BESIDE
def test_the_words_of_the_lesson_are_those_that_were_read_against_their_proofs() -> None:
    """A sentence that has changed is named: a proof cannot tell that it proves another one."""
    told = changes(LESSON.read_text(encoding="utf-8"))
    ends = ["Read them against their proofs in ledger.md, then run python -m proofs.sentences"] * bool(told)
    assert not told, "\n".join([*told, *ends])


# Each turns a true sentence into a false one, and leaves every number as it is.
FALSE_WORDS = (
    ("grow", "shrink"), ("ahead", "behind"), ("forward Euler", "RK4"), ("velocity first", "position first"),
    ("clockwise", "counterclockwise"), ("old", "new"), ("hqₙ", "hvₙ"), ("four", "three"),
)  # fmt: skip


@BESIDE
@pytest.mark.parametrize(("words", "others"), FALSE_WORDS)
def test_other_words_are_noticed_wherever_they_stand(words: str, others: str) -> None:
    """In whichever line, which is named with its statements; so is a line that is new, and one that is gone."""
    lines = LESSON.read_text(encoding="utf-8").splitlines()
    changed = [i for i, line in enumerate(lines) if words in line]
    assert changed
    for i in changed:
        for instead in ([lines[i].replace(words, others)], [], [lines[i], "Every method here keeps its energy."]):
            (told,) = changes("\n".join([*lines[:i], *instead, *lines[i + 1 :]]))
            claims = next(line.claims for line in lines_read() if line.number == i + 1)
            assert all(claim in told for claim in claims) is (len(instead) < 2 or not claims)
