"""The lesson's text, if it lies beside this checkout: its numbers are their values, its words those that were read."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from driftproof import check
from driftproof.texts.values import published
from proofs import sentences
from proofs.printed import ROWS
from proofs.sentences import INVENTORY, LESSON, changes, lines_read, placed, to_do

CLAIMS = Path(__file__).parent / "lesson" / "claims.toml"
BESIDE = pytest.mark.skipif(not LESSON.exists(), reason=f"the lesson's text is not beside this checkout, as {LESSON}")


@pytest.fixture(autouse=True)
def proved_values(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, values_so_far: Any) -> None:
    """Published values are those that this run has proved: the file is written only after it."""
    document, entries = published._document(), published.published_values()
    proved = {value["id"]: {**entries.get(value["id"], {}), **value} for value in values_so_far}
    monkeypatch.setattr(published, "_document", lambda: {**document, "values": {**entries, **proved}})


@BESIDE
def test_the_lesson_has_the_words_that_were_read_and_the_numbers_that_are_proved() -> None:
    """A sentence that has changed is named, for a proof cannot tell that it proves another one; so is a wrong number.

    A number is right if it is the value that a proof publishes, or that a question asks for; none is left out.
    """
    text, report = LESSON.read_text(encoding="utf-8"), check(LESSON, CLAIMS, coverage=True)
    told = to_do(text, json.loads(INVENTORY.read_text(encoding="utf-8"))["claims"])
    if not report.passed:
        told += [f"{report}", f"A new number wants a claim in {CLAIMS.name}, and a row in proofs/printed.py."]
    if told:
        pytest.fail("\n".join(told), pytrace=False)


@BESIDE
def test_a_wrong_number_of_the_lesson_is_noticed(tmp_path: Path) -> None:
    """Everywhere that the lesson prints one of its three longest, and nowhere else is anything changed."""
    text, copy = LESSON.read_text(encoding="utf-8"), tmp_path / LESSON.name
    longest = sorted({row.text for row in ROWS if row.text in text}, key=lambda number: (len(number), number))[-3:]
    places = [(found.end(), number) for number in longest for found in re.finditer(re.escape(number), text)]
    assert len(places) >= len(longest) == 3
    for end, number in places:
        copy.write_text(f"{text[: end - 1]}{(int(number[-1]) + 1) % 10}{text[end:]}", encoding="utf-8")
        assert not check(copy, CLAIMS).passed, text[end - 40 : end + 40]


# A lesson of four paragraphs, the statements of which are read; two stand in one line, and two have one quote.
WORDS = "Energy grows.\n\nThe phase is 40.\nIt lags.\n\nA step is 40. It is old.\n\nThe end."
STATED = [("L901", 1, "Energy grows."), ("L902", 3, "40"), ("L903", 6, "40"), ("L904", 6, "It is old.")]
FALSE_LINE = "Every symplectic method keeps the energy of every oscillator forever."


@pytest.fixture
def lines(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[list[str]]:
    """The lines of a made-up lesson that has been read, to be changed in several ways."""
    for name in ("LESSON", "INVENTORY", "FILE"):
        monkeypatch.setattr(sentences, name, tmp_path / name)
    sentences.FILE.write_text("", encoding="utf-8")
    _record(WORDS, STATED)
    lines_read.cache_clear()
    yield WORDS.splitlines()
    lines_read.cache_clear()


def _entries(stated: list[tuple[str, int, str]]) -> list[dict[str, Any]]:
    return [{"id": key, "line": line, "quote": quote} for key, line, quote in stated]


def _record(text: str, stated: list[tuple[str, int, str]]) -> int:
    """What the command says of a text and a list of statements."""
    lines_read.cache_clear()
    sentences.LESSON.write_text(text, encoding="utf-8")
    sentences.INVENTORY.write_text(json.dumps({"claims": _entries(stated)}), encoding="utf-8")
    return sentences.main()


def test_other_words_are_noticed_wherever_they_stand(lines: list[str]) -> None:
    """In whichever line, which is named with its statements; so is a line that is new, and one that is gone."""
    assert [line.number for line in lines_read()] == [1, 3, 4, 6, 8]
    for read in lines_read():
        i = read.number - 1
        for instead in ([FALSE_LINE], [], [lines[i], FALSE_LINE]):
            (told,) = changes("\n".join([*lines[:i], *instead, *lines[i + 1 :]]))
            assert all(claim in told for claim in read.claims) is (len(instead) < 2 or not read.claims)


def test_places_are_told_apart_and_lines_that_moved_are_told(lines: list[str]) -> None:
    """Two changed lines side by side are two places; where their number differs they are one, from line to line."""
    of_6 = "the words of L903, L904 are gone or changed"
    for instead, told in (
        ([FALSE_LINE, "", FALSE_LINE], ["line 4: words without a statement are gone or changed", f"line 6: {of_6}"]),
        ([FALSE_LINE] * 3, [f"lines 4 to 6: {of_6}"]),
    ):
        assert changes("\n".join([*lines[:3], *instead, *lines[6:]])) == told
    moved = to_do("\n".join(["", *lines]), _entries(STATED))
    assert moved[0] == "line 2: its words are as before, but ledger.md has them in line 1"
    assert len(moved) == 2
    assert to_do(WORDS, _entries(STATED)) == []


def test_statements_stand_where_their_words_do(lines: list[str]) -> None:
    """After any lines before them, wherever their own line went; one whose words are gone is named, and its line."""
    stand = lambda *lines: placed("\n".join(lines), _entries(STATED))
    read = {line.number: [*line.claims] for line in lines_read() if line.claims}
    assert read == {1: ["L901"], 3: ["L902"], 6: ["L903", "L904"]}
    for new, after in (([], 0), ([""], 0), ([FALSE_LINE, ""], 2), (["40"], 3), ([FALSE_LINE, ""], 6)):
        moved = {number + len(new) * (number > after): claims for number, claims in read.items()}
        assert stand(*lines[:after], *new, *lines[after:]) == (moved, [])
    assert stand(*lines[2:], lines[0]) == ({7: ["L901"], 1: ["L902"], 4: ["L903", "L904"]}, [])
    for number, wrong, lost in ((3, "The phase is 400.", "L902: '40'"), (6, "A step is 40.", "L904: 'It is old.'")):
        (told,) = stand(*lines[: number - 1], wrong, *lines[number:])[1]  # that it stands elsewhere does not count
        assert told == f"{lost} is gone"


def test_a_new_line_is_asked_for_a_statement_and_an_id_stands_once(lines: list[str]) -> None:
    """A sentence that is new is shown with what to do; no statement takes the id of another one."""
    new, twice = "\n".join([*lines, "", FALSE_LINE]), [*STATED, ("L901", 10, FALSE_LINE)]
    assert any(f"line 10: {FALSE_LINE[:40]!r}"[:-1] in told for told in to_do(new, _entries(STATED)))
    assert _record(new, twice) == 1
    assert "L901: a second statement of this id" in placed(new, _entries(twice))[1][0]
    assert _record(new, [*STATED, ("L905", 10, FALSE_LINE)]) == 0


def test_a_statement_is_dropped_by_deleting_it_from_the_list(
    lines: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """It is named with what speaks of it; as long as its words alone are gone, nothing is written."""
    before, without = sentences.FILE.read_text(encoding="utf-8"), "\n".join(lines[2:])
    assert _record(without, STATED) == 1
    assert re.fullmatch(
        r"nothing written:\n.*L901 are gone\nL901: .* is gone\nWrite .*\nRead .*\n", capsys.readouterr().err
    )
    assert sentences.FILE.read_text(encoding="utf-8") == before
    assert _record(without, STATED[1:]) == 0
    assert re.search(r"\ndropped: L901, still named in proofs/test_text.py:\d+\n$", capsys.readouterr().out)
