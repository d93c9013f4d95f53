"""The wheel, installed where a user's project has files of our folders' names: it owns one name; nothing shadows it."""

import subprocess
import zipfile
from pathlib import Path

import pytest

from hatch_build import Addresses

SPRINGS = """\
def step(q, v, h):
    return q + h * v, v - h * q
"""

THREE_LINES = """\
from driftproof import assert_verified
from springs import step

assert_verified(step, method="forward_euler", examples=5)
print("verified")
"""

TEMPLATE = 'RK4 leads to q = {{ value("rk4.first_step.q") }} and v = {{ value("step rk4 h=1/2 : v") }}.\n'
RENDER_AND_SHOW = """\
from pathlib import Path
from driftproof.cli import main

assert main(["render", "lesson.md.j2"]) == 0
print(Path("lesson.md").read_text())
"""

CLAIMS = """\
[[claim]]
id = "first-step"
value = "rk4.first_step.q"
phrase = "q = {value}"
exact = true
"""

# What somebody's project may have: modules and packages of the names that our folders have.
DECOYS = [
    *("methods.py", "symbolic/__init__.py", "numeric.py", "support/__init__.py", "texts.py", "reports.py"),
    *("commands.py", "blackbox/__init__.py", "enclosure.py", "cli.py", "proofs.py"),
]

# What is run there, and what it says.
RUNS = {
    "assert_verified": (["-c", THREE_LINES], "verified"),
    "identify": (["-m", "driftproof", "identify", "springs:step"], "judging by linear steps only, it is forward_euler"),
    "verify": (["-m", "driftproof", "verify", "springs:step", "--method", "Euler"], "is forward_euler on q'' = -q"),
    "render": (["-c", RENDER_AND_SHOW], "q = 337/384 and v = -23/48"),
    "check": (["-m", "driftproof", "check", "lesson.md", "--claims", "claims.toml"], "1 claim"),
    "facts": (["-m", "driftproof", "facts", "rk4", "--only", "order"], "4"),
}


def project(folder):
    files = {
        "springs.py": SPRINGS, "lesson.md.j2": TEMPLATE, "lesson.md": "RK4 leads to q = 337/384 at once.\n",
        "claims.toml": CLAIMS,
    }  # fmt: skip
    for name, text in {**files, **dict.fromkeys(DECOYS, "X = 1\n")}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def said(python, arguments, folder):
    done = subprocess.run(
        [str(python), *arguments], cwd=folder, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL
    )
    return done.returncode, done.stdout, done.stderr


def test_wheel_holds_one_name(wheel):
    with zipfile.ZipFile(wheel) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
    assert {name for name in tops if not name.endswith(".dist-info")} == {"driftproof"}
    assert len(tops) == 2


def test_wheel_names_the_repository_whose_workflow_builds_it_and_no_other(wheel, monkeypatch):
    with zipfile.ZipFile(wheel) as archive:
        (metadata,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        said = archive.read(metadata).decode()
    addresses = dict(line.removeprefix("Project-URL: ").split(", ") for line in said.splitlines() if "URL: " in line)
    home = "https://example.org/people/driftproof"
    assert (addresses["Source"], addresses["Issues"]) == (home, f"{home}/issues")
    assert {*addresses} == {"Source", "Documentation", "Changelog", "Issues"}
    monkeypatch.delenv("GITHUB_REPOSITORY", raising=False)
    elsewhere = dict[str, object]()
    Addresses("", {}).update(elsewhere)
    assert elsewhere == {}


def test_environment_is_that_of_the_wheel(installed, tmp_path):
    status, out, _ = said(installed, ["-c", "import driftproof; print(driftproof.__file__)"], tmp_path)
    assert status == 0
    assert Path(out.strip()).is_relative_to(installed.parents[1])


@pytest.mark.parametrize("name", RUNS)
def test_answer_beside_decoys_is_right(name, installed, tmp_path):
    arguments, part = RUNS[name]
    status, out, err = said(installed, arguments, project(tmp_path))
    assert (status, err) == (0, "")
    assert part in out


def test_decoys_would_shadow_what_is_not_in_the_package(installed, tmp_path):
    folder = project(tmp_path)
    assert said(installed, ["-c", "import methods; print(methods.X)"], folder)[1] == "1\n"
