"""The lesson's text, if it lies beside this checkout: its numbers are their values, its words those that were read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from driftproof import check
from driftproof.texts.values import published
from proofs.claims import STATEMENTS
from proofs.sentences import INVENTORY, LESSON, changes, lines_read, placed

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
    assert report.passed, f"{report}\nA new number wants a claim in {CLAIMS.name}, and a row in proofs/printed.py"


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
    assert {claim for line in read for claim in line.claims} == {*STATEMENTS}
    assert [line.number for line in read] == sorted({line.number for line in read})


@BESIDE
def test_the_words_of_the_lesson_are_those_that_were_read_against_their_proofs() -> None:
    """A sentence that has changed is named: a proof cannot tell that it proves another one."""
    told = changes(LESSON.read_text(encoding="utf-8"))
    ends = ["Read them against their proofs in ledger.md, then run python -m proofs.sentences"] * bool(told)
    assert not told, "\n".join([*told, *ends])


@pytest.fixture
def lines() -> list[str]:
    """The lines of the lesson, to be changed in several ways; a lesson that has been changed is told of just once."""
    text = LESSON.read_text(encoding="utf-8")
    if changes(text):
        pytest.skip("other words than those that were read: the test of the words says where")
    return text.splitlines()


# Each turns a true sentence into a false one, and leaves every number as it is.
FALSE_WORDS = (
    ("grow", "shrink"), ("ahead", "behind"), ("forward Euler", "RK4"), ("velocity first", "position first"),
    ("clockwise", "counterclockwise"), ("old", "new"), ("hqₙ", "hvₙ"), ("four", "three"),
)  # fmt: skip
FALSE_LINE = "Every symplectic method keeps the energy of every oscillator forever."


@BESIDE
@pytest.mark.parametrize(("words", "others"), FALSE_WORDS)
def test_other_words_are_noticed_wherever_they_stand(words: str, others: str, lines: list[str]) -> None:
    """In whichever line, which is named with its statements; so is a line that is new, and one that is gone."""
    changed = [i for i, line in enumerate(lines) if words in line]
    assert changed
    for i in changed:
        for instead in ([lines[i].replace(words, others)], [], [lines[i], FALSE_LINE]):
            (told,) = changes("\n".join([*lines[:i], *instead, *lines[i + 1 :]]))
            claims = next(line.claims for line in lines_read() if line.number == i + 1)
            assert all(claim in told for claim in claims) is (len(instead) < 2 or not claims)


@BESIDE
def test_places_are_told_apart_and_lines_that_moved_are_told(lines: list[str]) -> None:
    """Two changed lines side by side are two places; where their number differs they are one, from line to line."""
    of_57, of_59 = ", ".join(f"L{n:03}" for n in range(49, 52)), ", ".join(f"L{n:03}" for n in range(52, 57))
    for instead, told in (
        ([FALSE_LINE, "", FALSE_LINE], [f"line {n}: the words of {ids}" for n, ids in ((57, of_57), (59, of_59))]),
        ([FALSE_LINE] * 3, [f"lines 57 to 59: the words of {of_57}, {of_59}"]),
    ):
        assert changes("\n".join([*lines[:56], *instead, *lines[59:]])) == [f"{x} are gone or changed" for x in told]
    assert changes("\n".join(["", *lines])) == ["line 2: its words are as before, but ledger.md has them in line 1"]


@BESIDE
def test_statements_stand_where_their_words_do(lines: list[str]) -> None:
    """After any lines before them, wherever their own line went; one whose words are gone is named, and its line."""
    inventory = json.loads(INVENTORY.read_text(encoding="utf-8"))["claims"]
    stand = lambda *lines: placed("\n".join(lines), inventory)
    read = {line.number: [*line.claims] for line in lines_read() if line.claims}
    for new, after in (([], 0), ([""], 0), ([FALSE_LINE, ""], 56), (["40"], 133), ([FALSE_LINE, ""], 243)):
        moved = {number + len(new) * (number > after): claims for number, claims in read.items()}
        assert stand(*lines[:after], *new, *lines[after:]) == moved
    assert stand(*lines[:56], *lines[58:150], lines[56], *lines[150:])[149] == read[57]
    for number, wrong, lost in ((131, "400", "L120"), (123, "2.39", "L116"), (57, lines[56][:-30], "L051")):
        with pytest.raises(ValueError, match=rf"^{lost}: '[^\n]*'$"):  # that it stands elsewhere does not count
            stand(*lines[: number - 1], wrong, *lines[number:])
