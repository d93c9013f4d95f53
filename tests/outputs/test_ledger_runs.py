"""The ledger in real runs of the proofs: in two processes, with a selection, and with a planted error."""

import hashlib
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from driftproof.texts.values.published import VALUES_FILE
from proofs import conftest

ROOT = Path(__file__).parents[2]

# Loaded as a plugin before the proofs: RK4 with its last two weights changed, still consistent, no longer RK4.
PLANT = """
from dataclasses import replace
from fractions import Fraction
from driftproof.methods.catalogue import METHODS
METHODS._methods["rk4"] = replace(METHODS["rk4"], b=(Fraction(1, 6), Fraction(1, 3), Fraction(1, 4), Fraction(1, 4)))
"""

# The proof of one claim, as if somebody had deleted it.
DELETED = """
from proofs import claims
kept = claims.claim
claims.claim = lambda *keys, **said: kept(*(key for key in keys if key != "L034"), **said)
"""


def run_proofs(*arguments, plugins=None, folder=ROOT):
    path = {"PYTHONPATH": str(plugins)} if plugins else {}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "proofs", *arguments],
        cwd=folder,
        env={"PATH": "/usr/bin:/bin", "COLUMNS": "150", **path},
        capture_output=True,
        text=True,
        timeout=300,
    )


def digest():
    return hashlib.sha256(VALUES_FILE.read_bytes()).hexdigest()


@pytest.fixture
def planted(tmp_path):
    (tmp_path / "planted_error.py").write_text(PLANT, encoding="utf-8")
    return tmp_path


def standings(done):
    """What the ledger prints of each claim: its evidence, "failed", or "not"."""
    return dict(line.split()[:2] for line in done.stdout.splitlines() if line.startswith("L"))


@pytest.mark.slow
def test_planted_error_fails_what_it_touches_of_a_selection_and_the_rest_is_called_not_run(planted):
    before = digest()
    done = run_proofs("-k", "test_energy or test_one_step or L080", "-p", "planted_error", plugins=planted)
    standing = standings(done)
    assert done.returncode != 0
    assert [standing[key] for key in ("L059", "L188", "L207")] == ["failed"] * 3
    assert not {"L036", "L163"} & {*standing}  # of those that stand, or were not run, there is the number alone
    assert re.search(r"^228 claims: \d+ PROVED, .* \d+ failed, \d+ not run\b", done.stdout, re.MULTILINE)
    assert "assert '337/384' == '" in done.stdout  # what is printed beside what it would be now
    assert "values.json not written" in done.stdout
    assert digest() == before


def test_what_the_files_had_otherwise_is_said_of_each_value(tmp_path, monkeypatch):
    """As after somebody has edited a published value, or added one; nothing is said where all are as they were."""
    proved = VALUES_FILE.read_text(encoding="utf-8")
    file = tmp_path / "values.json"
    monkeypatch.setattr(conftest, "VALUES_FILE", file)
    monkeypatch.setattr(conftest, "_files", lambda ledger: [(file, proved)])
    ledger = SimpleNamespace(complete=True)
    file.write_text(proved.replace('"337/384"', '"338/384"').replace('"rk4.stages"', '"mine"'), encoding="utf-8")
    first, *others = conftest._publish(ledger, 0).splitlines()
    assert first == "wrote values.json, which differed from what is proved"
    assert [line.split(":")[0] for line in others] == [
        "  mine",
        "  rk4.first_step.q",
        "  rk4.first_step.q",
        "  rk4.stages",
    ]
    assert others[1].startswith("  rk4.first_step.q: 338/384 = 0.8776041666666666666666666")
    assert conftest._publish(ledger, 0) == "values.json and ledger.md are up to date"
    assert conftest._publish(ledger, 1).startswith("values.json not written")


@pytest.mark.slow
def test_a_claim_whose_proof_is_deleted_fails_the_run_of_all_files(tmp_path):
    (tmp_path / "deleted.py").write_text(DELETED, encoding="utf-8")
    done, whole = (run_proofs("--collect-only", *more, plugins=tmp_path) for more in (("-p", "deleted"), ()))
    assert "without a proof: L034;" in " ".join(done.stdout.split())
    assert (done.returncode, whole.returncode) == (1, 0)


@pytest.mark.slow
@pytest.mark.parametrize(("power", "standing"), [("** 2", "PROVED"), ("** 3", "failed")])
def test_the_claim_that_contributing_adds_stands_in_the_ledger_and_a_wrong_one_fails(power, standing, tmp_path):
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    ((path, added),) = re.findall(r"end of `(proofs/.*?)` is\n\n```python\n(.*?\n)```", page, re.DOTALL)
    shutil.copytree(ROOT / "proofs", tmp_path / "proofs", ignore=shutil.ignore_patterns("__pycache__"))
    claimed = re.findall(r'"L(\d{3})"', "".join(map(Path.read_text, (ROOT / "proofs").glob("test_*.py"))))
    following = f"L{max(249, *map(int, claimed)) + 1}"  # of the claims that there are, the example's among them or not
    for name in ("conftest.py", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path)
    with (tmp_path / path).open("a", encoding="utf-8") as file:
        file.write("\n\n" + added.replace("** 2\n", f"{power}\n").replace("L250", following))
    done = run_proofs("-k", "two_steps_of_forward_euler", plugins=ROOT, folder=tmp_path)
    (line,) = re.findall(rf"^{following} .*expand +Two steps of forward Euler multiply.*", done.stdout, re.MULTILINE)
    assert line.split()[1] == standing
    shown = page.replace("L250", following).splitlines()  # whose columns are as wide as those of all claims
    assert (line.split() in map(str.split, shown)) == (standing == "failed")


# The default run plants its error in two files of proofs, in one process. The long tier runs them all, in two
# processes, whose ledgers have to become one.
@pytest.mark.long
def test_two_processes_keep_one_ledger_and_change_no_value():
    before = digest()
    done = run_proofs("-n", "2")
    assert done.returncode == 0
    ledger = (ROOT / "proofs" / "ledger.md").read_text(encoding="utf-8")
    assert re.search(r"^\d+ claims: .*(?=\.$)", ledger, re.MULTILINE)[0] in done.stdout
    assert "not run" not in done.stdout
    assert "values.json and ledger.md are up to date" in done.stdout
    assert digest() == before
