"""The lesson's own text, if it lies beside this checkout: each of its numbers is the value that it stands for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from driftproof import check
from driftproof.texts.values import published

LESSON = Path(__file__).parents[2] / "shared" / "lesson" / "lesson.txt"
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
