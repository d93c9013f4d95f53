"""The README is true: every command it shows prints what it says, and its map names the folders there are."""

import re
from pathlib import Path

import pytest

from docs.pages import CONSOLE, printed

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = CONSOLE.findall(README)


@pytest.mark.parametrize(("command", "shown"), BLOCKS, ids=[command for command, _ in BLOCKS])
def test_readme_shows_what_the_command_prints(command, shown):
    assert printed(command) == shown


def test_a_stale_readme_would_be_noticed():
    command, shown = BLOCKS[0]
    assert printed(command) != shown.replace("337/384", "337/385") != shown
    assert len(BLOCKS) == 9


def test_map_names_every_folder_of_the_house():
    named = set(re.findall(r"^(\w+)/ ", README, re.MULTILINE)) | {"numeric"}
    visible = [path for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "build", "dist"))]
    folders = {path.name for path in visible if any((*path.rglob("*.py"), *path.glob("*.svg")))}
    assert folders == named


def test_quoted_ledger_lines_stand_in_the_ledger():
    quoted = re.findall(r"^\| L\d+ .*$", README, re.MULTILINE)
    ledger = (ROOT / "proofs" / "ledger.md").read_text(encoding="utf-8").splitlines()
    assert len(quoted) == 3
    assert set(quoted) <= set(ledger)
