"""What contributors read and machines run: every path that is named is there, every command is one of ours."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from docs.pages import FILE_OR_CONSOLE
from driftproof import __version__, cli
from tests.looping import some

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "tests/README.md"])
def test_every_path_that_a_page_names_is_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = re.findall(r"`((?:driftproof|tests|proofs|docs|examples)/[\w./]*)`", text)
    missing = [path for path in some(named, 4) if not (ROOT / path).exists()]
    assert missing == []


def test_every_name_that_contributors_read_is_one():
    """Names in capitals, and calls of functions."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    files = [
        *(ROOT / "driftproof").rglob("*.py"),
        *(ROOT / "tests").rglob("*.py"),
        ROOT / "README.md",
        ROOT / "CITATION.cff",
    ]
    source = "\n".join(path.name + path.read_text(encoding="utf-8") for path in some(files, 200))
    named = re.findall(r"`(_?[A-Z]{3}[A-Z_]+|(?:\w+\.)?[a-z_]+(?=\())", text)
    assert [name for name in some(named, 4) if name.rpartition(".")[2] not in source] == []


def test_the_version_is_one():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert cited["version"] == project["version"] == __version__
    assert cited["license"] == project["license"]


def test_a_release_has_a_public_address_and_none_is_made_up_before():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    urls = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"].get("urls", {})
    newest = re.search(r"(?m)^## (.+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))[1]
    assert urls or newest.endswith("unreleased"), "CONTRIBUTING.md, A release, 3"
    assert cited.get("repository-code") in (urls.values() or [None])
    pages = some([*ROOT.glob("*.*[dlf]"), *(ROOT / "docs").rglob("*.md")], 20)
    named = [re.findall(r"https?://[^\s)>\"]*driftproof", path.read_text(encoding="utf-8")) for path in pages]
    assert {address for found in named for address in found} <= set(urls.values())


def test_workflows_run_what_is_there():
    jobs = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    assert "bash .ci/run" in commands
    assert (ROOT / ".ci/run").is_file()
    asked = re.findall(r"driftproof (\w+)", " ".join(commands))
    assert all(command in cli.COMMANDS for command in some(asked))


def test_the_oldest_versions_of_all_that_is_required_and_of_the_extras_are_tested():
    jobs = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"]
    (install,) = (step["run"] for step in jobs["oldest"]["steps"] if "pip install" in step.get("run", ""))
    pins = subprocess.run(["bash", "-c", f"echo {install}"], cwd=ROOT, capture_output=True, text=True).stdout.split()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = {*project["dependencies"], *extras["fast"], *extras["text"], *extras["cluster"]}
    assert {each.replace(">=", "==") for each in some(wanted, 8)} <= {*pins}


@pytest.mark.slow
def test_the_action_runs_a_command_and_shows_what_it_said(tmp_path):
    action = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
    install, run = action["runs"]["steps"]
    assert install["env"]["WHAT"] == "${{ inputs.package }}[${{ inputs.extras }}]"
    asked = {"COMMAND": "step rk4 --h 1/2 --state 1,0", "GITHUB_STEP_SUMMARY": str(tmp_path / "summary")}
    page = (ROOT / "docs" / "tutorials" / "engineer.md").read_text(encoding="utf-8")
    (asked_of_the_page,) = re.findall("command: (.*)", page)
    (tmp_path / "springs.py").write_text({name: text for name, text, _ in FILE_OR_CONSOLE.findall(page)}["springs.py"])
    (tmp_path / "driftproof").write_text(f'#!/bin/sh\nexec {sys.executable} -m driftproof "$@"\n')
    (tmp_path / "driftproof").chmod(0o755)
    given = {**os.environ, **asked, "PYTHONPATH": str(ROOT), "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    for command, status, fenced, words in (
        (asked["COMMAND"], 0, True, "337/384"),
        ("value --only rk4.first_step.q --format md", 0, False, "| `rk4.first_step.q` | `337/384` |"),
        ("facts rk9", 2, True, "driftproof facts: unknown method 'rk9'"),
        ("facts rk4\n  --only\n  order\n", 0, True, "order"),
        ("facts rk4\nfacts heun2\n", 2, True, "driftproof facts: unrecognized arguments: facts heun2"),
        (asked_of_the_page, 1, False, "is not velocity\\_verlet; judging by linear steps only, it is velocity-first"),
    ):
        (tmp_path / "summary").write_text("")
        done = subprocess.run(
            ["bash", "-e", "-c", run["run"]],
            env={**given, "COMMAND": command},
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        summary = (tmp_path / "summary").read_text()
        assert (done.returncode, summary.count("```")) == (status, 2 * fenced)
        assert words in done.stdout
        assert words in summary
