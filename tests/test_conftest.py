"""Of what is slow, the cases to keep are run always, the others with -m slow; what is long, with -m long."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FILE = """
import pytest

@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("k", range(5))
def test_some(k): pass

@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("k", range(2))
def test_few(k): pass

@pytest.mark.slow
def test_none(): pass

@pytest.mark.long
def test_later(): pass

@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("k", [pytest.param(0, marks=pytest.mark.long), 1])
def test_both(k): pass

def test_always(): pass
"""
KEPT = ["some[0]", "some[2]", "few[0]", "few[1]", "both[1]", "always"]
REST = ["some[1]", "some[3]", "some[4]", "none"]


@pytest.mark.parametrize(
    ("chosen", "expected"),
    [
        ([], KEPT),
        (["-m", "slow and not long"], REST),
        (["-m", "long"], ["later", "both[0]"]),
        (["-m", "not long"], None),
    ],
    ids=["by default", "slow", "long", "not long"],
)
def test_what_is_run(tmp_path: Path, chosen: list[str], expected: list[str] | None) -> None:
    shutil.copy(Path(__file__).parents[1] / "conftest.py", tmp_path)
    (tmp_path / "test_file.py").write_text(FILE, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", *chosen]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    found = re.findall(r"::test_(\S+)", done.stdout)
    assert found == expected if expected else sorted(found) == sorted(KEPT + REST), done.stderr
