"""Answers beside their questions: the same question gets its answer, another one and any changed digit get none."""

import json
import re

import pytest

from driftproof.support import kept
from driftproof.support.kept import NotKept, cache, cached, keep
from tests.looping import exactly

ASKED, FOUND = {"field": "-y0", "version": "1"}, {"digits": ["0.25", "3"]}


def test_an_answer_is_taken_over_for_its_own_question_only(tmp_path):
    keep(path := tmp_path / "new" / "kept.json", ASKED, FOUND)
    assert kept.kept(path, ASKED)["digits"] == FOUND["digits"]
    with pytest.raises(NotKept, match=r"^is from another study \(version differ\)$"):
        kept.kept(path, ASKED | {"version": "2"})
    text = path.read_text()
    for wrong in exactly(4, (text.replace("0.25", "0.26"), text.replace('"3"', '"4"'), text[:-9], "[1]")):
        path.write_text(wrong)
        with pytest.raises(NotKept, match="cannot be read"):
            kept.kept(path, ASKED)


def test_a_cache_has_the_newest_answers_and_nothing_where_it_cannot_be_written(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(kept, "MOST_FILES", 2)
    for version in "123":
        assert cached(ASKED | {"version": version}) is None
        cache(ASKED | {"version": version}, FOUND)
        assert cached(ASKED | {"version": version})["digits"] == FOUND["digits"]
    (folder,) = tmp_path.iterdir()
    versions = {json.loads(path.read_text())["question"]["version"] for path in exactly(2, [*folder.iterdir()])}
    assert "3" in versions
    assert all(re.fullmatch(r"[0-9a-f]{32}\.json", path.name) for path in exactly(2, [*folder.iterdir()]))
    monkeypatch.setenv("XDG_CACHE_HOME", str(next(folder.iterdir())))  # a file, in which there is no folder
    cache(ASKED, FOUND)
    assert cached(ASKED) is None
