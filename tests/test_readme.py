"""The README is true: every command it shows prints what it says, and its map names the folders there are."""

import re
import shlex
from pathlib import Path

import pytest

from driftproof.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CONSOLE = re.findall(r"```console\n\$ driftproof (.*?)\n(.*?)```", README, re.DOTALL)


def shown_and_printed(command: str, shown: str, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    assert main(shlex.split(command)) == 0
    return shown, capsys.readouterr().out


@pytest.mark.parametrize(("command", "shown"), CONSOLE, ids=[command for command, _ in CONSOLE])
def test_readme_shows_what_the_command_prints(command, shown, capsys):
    shown, printed = shown_and_printed(command, shown, capsys)
    assert printed == shown


def test_a_stale_readme_would_be_noticed(capsys):
    command, shown = CONSOLE[0]
    stale, printed = shown_and_printed(command, shown.replace("337/384", "337/385"), capsys)
    assert printed != stale
    assert len(CONSOLE) == 6


def test_map_names_every_folder_of_the_house():
    named = set(re.findall(r"^(\w+)/ ", README, re.MULTILINE)) | {"numeric"}
    folders = {path.name for path in ROOT.iterdir() if path.is_dir() and any((*path.glob("*.py"), *path.glob("*.svg")))}
    assert folders == named


def test_quoted_ledger_lines_stand_in_the_ledger():
    quoted = re.findall(r"^\| L\d+ .*$", README, re.MULTILINE)
    ledger = (ROOT / "proofs" / "ledger.md").read_text(encoding="utf-8").splitlines()
    assert len(quoted) == 3
    assert set(quoted) <= set(ledger)
