"""The README and the tour are true: every command prints what they show, and the map names the folders there are."""

import re
from pathlib import Path

import pytest

from docs.pages import CONSOLE, TUTORIALS, printed
from driftproof.commands.listing import COMMANDS
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.work_precision.curves import curve_of
from tests.looping import exactly, some

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
TOUR = (ROOT / "docs" / "tour.md").read_text(encoding="utf-8")
BLOCKS = CONSOLE.findall(README) + CONSOLE.findall(TOUR)


@pytest.mark.parametrize(("command", "shown"), BLOCKS, ids=[command for command, _ in BLOCKS])
def test_page_shows_what_the_command_prints(command, shown):
    assert printed(command) == shown


def test_every_command_is_on_the_tour_or_in_the_readme():
    others = (path.read_text(encoding="utf-8") for path in (*TUTORIALS, ROOT / "docs" / "texts.md"))
    told = "".join([README, TOUR, *others])
    assert len(BLOCKS) == 12
    missing = [name for name in COMMANDS if f"driftproof {name}" not in told and f"`{name}`" not in told]
    assert missing == []


def test_links_lead_to_files():
    links = re.findall(r"\]\(([^)]+)\)", README)
    assert [link for link in some(links, 10) if not (ROOT / link).exists()] == []


def test_map_names_every_folder_of_the_house():
    named = set(re.findall(r"^(\w+)/ ", README, re.MULTILINE)) | {"symbolic", "numeric"}
    visible = [path for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "build", "dist"))]
    folders = {path.name for path in visible if any((*path.rglob("*.py"), *path.glob("*.svg")))}
    assert folders == named


def test_claims_are_counted_as_the_ledger_has_them():
    ledger = (ROOT / "proofs" / "ledger.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([LT])\d+ \|.*\| ([A-Z]+) \|[^|]*\|[^|]*\| ([^|]*) \|$", ledger, re.MULTILINE)
    assert f"makes {sum(letter == 'L' for letter, *_ in rows)}\nstatements" in README
    by_coq = [coq for _, evidence, coq in some(rows, 200) if evidence in ("PROVED", "RESTRICTED", "CERTIFIED")]
    for page in (README, (ROOT / "docs" / "kernel.md").read_text(encoding="utf-8")):
        assert f"{sum(coq != '-' for coq in by_coq)} of the {len(by_coq)}" in page
    parts = [coq for coq in by_coq if "in part" in coq]
    assert f"certified, {({4: 'four', 5: 'five', 6: 'six'})[len(parts)]} in part" in README


def test_it_is_short():
    """Seven hundred words, blocks of code and sessions apart."""
    prose = re.sub(r"```.*?```", "", README, flags=re.DOTALL)
    assert len(prose.split()) <= 700
    assert len(README.split()) <= 1100


def test_what_was_found_stands_in_the_gallery():
    findings = (ROOT / "examples" / "gallery" / "findings.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\w+ [\d.]+) \| (\w+)[^|]* \| (\d) \| (-?\d) \|$", README, re.MULTILINE)
    assert all(row in "\n".join(README.splitlines()[:45]) for row, *_ in rows)  # on the first screen
    for package, solver, promised, seen in exactly(4, rows):
        assert re.search(rf"\| {package} \| {solver} \| {promised} \| {seen}\.0 \|", findings)


def test_evaluations_beside_the_run_times_are_the_fewest_that_reach_the_error():
    rows = re.findall(r"^\| (1e-\d+) \| (.*) \| (.*) \| (.*) \|$", README, re.MULTILINE)
    keys, problem = ("forward_euler", "symplectic_euler", "rk4"), PROBLEMS["harmonic_oscillator"]
    asked = [(float(most), *cell) for most, *cells in exactly(3, rows) for cell in zip(keys, cells, strict=True)]
    told = [(most, key, int(cell.split()[0].rstrip(","))) for most, key, cell in asked if cell[:1].isdigit()]
    for most, key, evaluations in exactly(5, told):
        steps = evaluations // (4 if key == "rk4" else 1)
        coarse, fine = curve_of(METHODS[key], problem, [steps // 2, steps]).points
        assert fine.error <= most < coarse.error
