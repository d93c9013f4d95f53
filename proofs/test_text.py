"""The lesson's text, if it lies beside this checkout: its numbers are their values, its words those that were read."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from driftproof import check
from driftproof.texts.claims.claims import read_claims
from driftproof.texts.values import published
from proofs import sentences
from proofs.claims import verifiable_otherwise
from proofs.printed import ROWS, slips_of
from proofs.sentences import LESSON, changes, inventory, lines_read, placed, to_do

CLAIMS = Path(__file__).parent / "lesson" / "claims.toml"
BESIDE = pytest.mark.skipif(not LESSON.exists(), reason=f"the lesson's text is not beside this checkout, as {LESSON}")


@pytest.fixture(autouse=True)
def numbers_proved(monkeypatch: pytest.MonkeyPatch, values_so_far: Any) -> dict[str, tuple[str, str]]:
    """The text and the decimal of the number of each claim; published are those that this run has proved.

    The file is written only after it.
    """
    document, entries = published._document(), published.published_values()
    proved = {value["id"]: {**entries.get(value["id"], {}), **value} for value in values_so_far}
    monkeypatch.setattr(published, "_document", lambda: {**document, "values": {**entries, **proved}})
    numbers = {key: (text, one["decimal"]) for one in entries.values() for key, text in one["printed"].items()}
    return numbers | {value["claim"]: (value["text"], value["decimal"]) for value in values_so_far}


@BESIDE
def test_the_lesson_has_the_words_that_were_read_and_the_numbers_that_are_proved(
    numbers_proved: dict[str, tuple[str, str]],
) -> None:
    """A sentence that has changed is named, for a proof cannot tell that it proves another one; so is a wrong number.

    A number is right if it is the value that a proof publishes, or that a question asks for; none is left out. The
    list of statements has the same numbers, and calls the same statements verifiable.
    """
    try:
        listed = inventory()
        told = to_do(LESSON.read_text(encoding="utf-8"), listed)
        told += verifiable_otherwise(listed)
        told += [slip for entry in listed for slip in slips_of(entry, numbers_proved)]
        report = check(LESSON, CLAIMS, coverage=True)
        if not report.passed:
            wanted = f"A new number wants a claim in proofs/lesson/{CLAIMS.name}, and, if it is a value, a row in"
            told += [f"{report}", f"{wanted} proofs/printed.py."]
    except ValueError as slip:  # a list cannot be read
        told = [str(slip)]
    if told:
        pytest.fail("\n".join(told), pytrace=False)


@BESIDE
def test_a_wrong_number_of_the_lesson_is_noticed(tmp_path: Path) -> None:
    """Everywhere that the lesson prints one of its three longest, and nowhere else is anything changed."""
    try:
        read_claims(CLAIMS)
    except ValueError as slip:
        pytest.skip(f"the test before says so: {slip}")
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


def _entries(stated: list[tuple[str, int, str]], **more: Any) -> list[dict[str, Any]]:
    same = {"verifiable": True, "printed": None, "decimal": None} | more
    return [{"id": key, "line": line, "quote": quote, **same} for key, line, quote in stated]


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
    record = "To record that, run python -m proofs.sentences."
    for after, told in (
        (["", *lines], "line 1 is line 2 now, its words as before: L901"),
        (
            last_is_first := [lines[5], "", *lines[:5], *lines[7:]],
            "line 6 is line 1 now, its words as before: L903, L904",
        ),
    ):
        assert to_do("\n".join(after), _entries(STATED)) == [told, record]
    assert _record("\n".join(last_is_first), STATED) == 0
    lines_read.cache_clear()
    assert [line.claims for line in lines_read() if line.claims] == [("L903", "L904"), ("L901",), ("L902",)]
    assert _record(WORDS, STATED) == 0
    lines_read.cache_clear()
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


def test_a_new_line_is_asked_for_a_statement(lines: list[str]) -> None:
    """A sentence that is new is shown with what to do."""
    new = "\n".join([*lines, "", FALSE_LINE])
    assert any(f"line 10: {FALSE_LINE[:40]!r}"[:-1] in told for told in to_do(new, _entries(STATED)))
    assert _record(new, [*STATED, ("L905", 10, FALSE_LINE)]) == 0


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ('"line": 3,', '"line": 3', ", line 1, column 145: Expecting ',' delimiter"),
        ('{"claims"', '{"claim"', ': its entries are a list under "claims", as in {"claims": [...]}'),
        (
            '"id": "L902", ',
            "",
            ": entry 2, after L901 has no 'id'; an entry has id, line, quote, verifiable, printed, ",
        ),
        ('"L902"', '"L92"', ": L92: its 'id' is 'L92', and may be L and three digits"),
        ('"L902"', '"L901"', ": L901 is the id of the entries 1 and 2, and may be of one"),
        ('"line": 3', '"line": "3"', ": L902: its 'line' is '3', and may be the number of its line, or of its first "),
        ('"40", "verifiable": true', '"40", "verifiable": "yes"', ": L902: its 'verifiable' is 'yes', and may be true"),
        ('"printed": null', '"printed": 40', ": L901: its 'printed' is 40, and may be the number that it prints, as"),
    ],
)
def test_a_slip_in_the_list_is_one_line(
    right: str, wrong: str, told: str, lines: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """What is wrong, where, and what is allowed; nothing is written."""
    text = sentences.INVENTORY.read_text(encoding="utf-8")
    assert right in text
    sentences.INVENTORY.write_text(text.replace(right, wrong, 1), encoding="utf-8")
    assert sentences.main() == 1
    shown = capsys.readouterr().err
    assert shown.startswith(f"nothing written: INVENTORY{told}")
    assert shown.count("\n") == 1


@pytest.mark.parametrize(
    ("quote", "printed", "decimal", "told"),
    [
        ("of 0.50", "0.50", "0.5000", []),
        ("half of it", "0.50", None, []),
        ("RK40.500.2", "0.50", None, []),
        ("of 0.25", "0.50", "0.5", ["prints 0.50, which is not in its quote 'of 0.25'"]),
        ("of 10.50", "0.50", None, ["prints 0.50, which is not in its quote"]),
        ("of −0.50", "0.50", None, ["prints 0.50, which is not in its quote"]),
        ("of 0.50", "0.50", "0.51", ["its decimal in claims.json is 0.51; to as many digits it is 0.50"]),
        ("of 0.5", "0.5", None, ["in claims.json it prints 0.5; its proof, or a row of proofs/printed.py, 0.50"]),
        ("of 0.50", None, None, ["in claims.json it prints no number; its proof"]),
    ],
)
def test_a_number_of_the_list_is_that_of_its_quote_and_of_its_proof(
    quote: str, printed: str | None, decimal: str | None, told: list[str]
) -> None:
    """As a whole, with its sign, except in the cells of a table that run together."""
    (entry,) = _entries([("L901", 1, quote)], printed=printed, decimal=decimal)
    found = list(slips_of(entry, {"L901": ("0.50", "0.5")}))
    assert [words in each for each, words in zip(found, told, strict=True)] == [True] * len(told)


def test_an_entry_that_is_new_or_verifiable_otherwise_is_named() -> None:
    """With the file in which that is said."""
    new, title, kept = _entries([("L901", 1, "Energy"), ("L001", 1, "A title"), ("L010", 1, "It grows.")])
    told = list(verifiable_otherwise([new, title, {**kept, "verifiable": False}, kept]))
    assert [each[:33] for each in told] == [
        "L901: new in claims.json: run pyt", "L001: verifiable in claims.json, ", "L010: not verifiable in claims.js",
    ]  # fmt: skip


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
