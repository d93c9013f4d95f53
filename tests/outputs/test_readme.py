"""The README and the tour are true: every command prints what they show, and the map names the folders there are.

What the README shows an author, in an empty folder, is run by test_docs_texts.
"""

import re
from pathlib import Path

import pytest

from docs.pages import CONSOLE, printed
from driftproof.cli import COMMANDS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
TOUR = (ROOT / "docs" / "tour.md").read_text(encoding="utf-8")
BLOCKS = CONSOLE.findall(README.partition("## Any text\n")[0]) + CONSOLE.findall(TOUR)


@pytest.mark.parametrize(("command", "shown"), BLOCKS, ids=[command for command, _ in BLOCKS])
def test_page_shows_what_the_command_prints(command, shown):
    assert printed(command) == shown


def test_every_command_is_on_the_tour_or_in_the_readme():
    told = README + TOUR
    missing = [name for name in COMMANDS if f"driftproof {name}" not in told and f"`{name}`" not in told]
    assert missing == []


def test_links_lead_to_files():
    links = {(ROOT, link) for link in re.findall(r"\]\(([^)]+)\)", README)}
    links |= {(ROOT / "docs", link) for link in re.findall(r"\]\(([^)]+)\)", TOUR)}
    assert len(links) >= 10
    assert [link for folder, link in links if not (folder / link).exists()] == []


def test_a_stale_readme_would_be_noticed():
    command, shown = BLOCKS[0]
    assert printed(command) != shown.replace("337/384", "337/385") != shown
    assert len(BLOCKS) == 12


def test_map_names_every_folder_of_the_house():
    named = set(re.findall(r"^(\w+)/ ", README, re.MULTILINE)) | {"symbolic", "numeric"}
    visible = [path for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "build", "dist"))]
    folders = {path.name for path in visible if any((*path.rglob("*.py"), *path.glob("*.svg")))}
    assert folders == named


def test_quoted_ledger_lines_stand_in_the_ledger():
    quoted = re.findall(r"^\| L\d+ .*$", README, re.MULTILINE)
    ledger = (ROOT / "proofs" / "ledger.md").read_text(encoding="utf-8").splitlines()
    assert len(quoted) == 3
    assert set(quoted) <= set(ledger)
