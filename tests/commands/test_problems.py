"""`driftproof stability` and `work-precision`: what is proved beside what is seen, files, JSON, one-line refusals."""

import json
import re
from pathlib import Path

import pytest

from driftproof.numeric.problems.catalogue import PROBLEMS
from tests.reports.studies import be_quick, contents


def test_problems_are_listed(answer):
    assert all(key in answer("stability") for key in PROBLEMS)
    listed = {entry["problem"]: entry for entry in json.loads(answer("stability", "--format", "json"))}
    assert list(listed) == list(PROBLEMS)
    kinds = {name: listed["stiff_oscillator"][name] for name in ("linear", "stiff", "second_order")}
    assert kinds == {"linear": True, "stiff": True, "second_order": True}


@pytest.fixture
def quick(monkeypatch):
    """Every command measures quickly."""
    be_quick(monkeypatch)


@pytest.mark.usefixtures("quick")
def test_problem_may_be_a_file_of_the_users_own(answer, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('title = "Mine"\nrates = ["y1", "-sin(y0)"]\nstart = [1, 0]\nend = 1\n')
    found = json.loads(answer("stability", str(path), "--methods", "rk4", "--format", "json"))
    assert (found["title"], found["linear"]) == ("Mine", False)
    assert float(found["methods"][0]["runs"][0]["error"]) < 1e-6
    study = json.loads(answer("work-precision", str(path), "--methods", "rk4", "--format", "json"))
    assert (set(study), study["errors"]["reference"]["evidence"]) == ({"errors", "times"}, "certified")


@pytest.mark.usefixtures("quick")
def test_work_precision_writes_its_files_and_names_them(answer, tmp_path):
    folder = tmp_path / "new" / "folder"
    out = answer("work-precision", "dahlquist_1", "--methods", "rk4", "-o", str(folder))
    named = re.findall(r"^wrote (.*)$", out, re.MULTILINE)
    assert {Path(name).name for name in named} | {"points.json"} == set(contents(folder))


def test_the_help_says_that_a_time_limit_is_none_for_the_whole_study(answer):
    said = " ".join(answer("work-precision", "--help").split())
    assert "seconds for timing one point" in said
    assert "no limit on the whole: compiling a method takes seconds" in said


REFUSED = {
    ("stability", "kepler_09"): "unknown problem 'kepler_09'; did you mean kepler",
    ("stability", "kepler", "--h", "3/7"): "h = 3/7 does not divide t",
    ("stability", "kepler", "--h", "1/10000000"): "at most 1000000 are run",
    ("stability", "kaps", "--h", "1e300"): "h = 1000000000000000000000000000000000000... does not divide t = 1 ",
    ("work-precision", "--methods", "rk5"): "unknown method 'rk5'; did you mean",
    ("work-precision", "--peers", "scpy"): "unknown peer 'scpy'; did you mean scipy?",
    ("work-precision", "--time-limit", "0"): "'0' is not allowed: the time limit must be a number above 0",
    ("work-precision", "-o", "pyproject.toml"): "pyproject.toml is a file; name a folder",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)


def test_certify_and_sweep_take_other_parameters(tmp_path, answer, refusal):
    """A run of k = 2 is right for a file of k = 1 only with the parameter that it had."""
    mine, run = tmp_path / "mine.toml", tmp_path / "run.csv"
    mine.write_text('rates.y = "-k*y"\nstart.y = 1\nend = 1\nparameters.k = 1\n')
    run.write_text("t,y\n0,1\n1,0.1353352832366127\n")
    assert "largest error 0.2325" in answer("certify", str(mine), str(run))
    about = "--parameters", "k=2"
    assert "16 correct digits" in answer("certify", str(mine), str(run), *about)
    swept = "sweep", str(mine), "--methods", "rk4", "--h", "1/4"
    assert answer(*swept).startswith("mine: 1 point")
    assert answer(*swept, *about).startswith("mine with k = 2: 1 point")
    for given in (("--parameters", "k=1", *about), ("--parameters", "k=1,k=2")):
        assert "k has one value at a time, but is given 1 and 2" in refusal(*swept, *given)
    head = {
        "problem": f"{mine} with k = 2",
        "start": ["1"],
        "readouts": ["state_error", "largest_error", "evaluations"],
    }
    answer(*swept, *about, "-o", str(kept := tmp_path / "kept.jsonl"))
    found = json.loads(answer(*swept, *about, "--format", "json"))
    assert (found["title"], found["start"]) == (head["problem"], head["start"])
    assert json.loads(kept.read_text().splitlines()[0]).items() >= head.items()
    assert "unknown parameter 'c'" in refusal(*swept, "--parameters", "c=2")
    assert "a scene has none to change" in refusal("sweep", "default", "--h", "1/4", *about)
