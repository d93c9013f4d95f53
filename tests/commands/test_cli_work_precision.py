"""`driftproof work-precision`: its files, its JSON, and one line for what it cannot use."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.reports.studies import be_quick, contents

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command measures quickly."""
    be_quick(monkeypatch)


BAD = [
    (("no_such",), "unknown problem 'no_such'"),
    (("--methods", "rk5"), "unknown method 'rk5'; did you mean"),
    (("--peers", "scpy"), "unknown peer 'scpy'; did you mean scipy?"),
    (("--time-limit", "0"), "'0' is no time limit"),
    (("--time-limit", "soon"), "'soon' is not a rational number"),
    (("--format", "xml"), "invalid choice: 'xml'"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD)
def test_bad_input_is_one_line(run: Run, arguments: tuple[str, ...], message: str) -> None:
    status, out, err = run("work-precision", *arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1


def test_a_file_in_the_place_of_the_folder_is_bad_input(run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    status, _, err = run("work-precision", "--methods", "rk4", "-o", str(tmp_path / "file"))
    assert status == 2
    assert "is a file; name a folder" in err


def test_command_writes_its_files_and_names_them(run: Run, tmp_path: Path) -> None:
    status, out, err = run("work-precision", "dahlquist_1", "--methods", "rk4", "-o", str(tmp_path / "new" / "folder"))
    assert (status, err) == (0, "")
    named = re.findall(r"^wrote (.*)$", out, re.MULTILINE)
    assert {Path(name).name for name in named} | {"points.json"} == set(contents(tmp_path / "new" / "folder"))


def test_command_answers_in_json_too(run: Run) -> None:
    status, out, _ = run("work-precision", "--methods", "rk4", "--format", "json")
    assert status == 0
    assert set(json.loads(out)) == {"errors", "times"}


def test_without_matplotlib_everything_but_the_figures_is_written(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, out, err = run("work-precision", "dahlquist_1", "--methods", "rk4", "-o", str(tmp_path))
    assert (status, err) == (0, "")
    assert out.endswith("no figures: matplotlib is not installed; pip install 'driftproof[report]'\n")
    assert set(contents(tmp_path)) == {"errors.json", "times.json", "work_precision.csv", "points.json"}
