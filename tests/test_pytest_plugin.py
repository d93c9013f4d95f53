"""The plugin for pytest, in projects of somebody else's: each is run by a pytest of its own."""

import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from driftproof.pytest_plugin import pytest_runtest_call

ROOT = Path(__file__).parents[1]
PROJECT = """
import pytest
from driftproof import assert_verified

def euler(q, v, h):
    return q + h * v, v - h * q

def hangs(q, v, h):
    while True:
        pass

def test_right():
    assert_verified(euler, "forward_euler", examples=20)

def test_wrong():
    assert_verified(euler, "rk4", examples=20)

@pytest.mark.xfail
def test_wrong_as_known():
    assert_verified(euler, "rk4", examples=20)

def test_told_apart():
    with pytest.raises(AssertionError, match="is not rk4"):
        assert_verified(euler, "rk4", examples=20)

@pytest.mark.driftproof(time_limit=0.5)
def test_slow():
    assert_verified(hangs, "forward_euler")

def test_plain():
    assert 1 + 1 == 3

def test_asked_without_sense():
    assert_verified(euler, "backward_euler")
"""


def pytest_in(folder, *words, project=PROJECT, **variables):
    (folder / "test_steps.py").write_text(project)
    # By its module, so that it is this checkout's; an installed one is not loaded, nor is any other's.
    plugin = ["-p", "driftproof.pytest_plugin", "-p", "no:cacheprovider"]
    env = {"PYTHONPATH": str(ROOT), "PATH": "", "CI": "1", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"} | variables
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *plugin, *words],
        cwd=folder, capture_output=True, text=True, env=env,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("project")
    return pytest_in(folder, "--driftproof-report=found", "--strict-markers"), folder / "found"


@pytest.mark.slow
def test_the_short_summary_begins_with_the_verdict(run):
    assert re.search(
        r"(?m)^FAILED test_steps.py::test_wrong - \S*euler is not rk4; judging by linear .*, it is forward_euler",
        run[0].stdout,
    )
    assert "FAILED test_steps.py::test_plain - assert (1 + 1) == 3" in run[0].stdout


@pytest.mark.slow
def test_a_verdict_that_the_short_summary_cuts_is_shown_in_full_before_it_and_no_other_is(tmp_path):
    narrow, wide = (pytest_in(tmp_path, "-k", "wrong or plain", CI="", COLUMNS=room).stdout for room in ("70", "200"))
    (verdict,) = re.findall(r"FAILED test_steps.py::test_wrong - (test_steps:euler is not rk4; .*)\n", wide)
    line = f"test_steps.py::test_wrong: {verdict}\n"
    assert [text.count(line) for text in (narrow, wide)] == [1, 0]
    assert "FAILED test_steps.py::test_wrong - test_steps:euler is not " in narrow.partition(line)[2]
    assert "test_plain: " not in narrow


def test_a_question_without_sense_shows_the_line_that_asks_and_nothing_of_ours(run):
    shown = run[0].stdout.partition("_ test_asked_without_sense _")[2].partition("short test summary")[0]
    assert "allowance=Allowance(solver_tolerance=1e-10)" in shown
    assert "tolerance.py" not in shown.partition("E  ")[0]


def test_the_marker_is_the_time_limit_of_the_test(run):
    assert re.search(
        r"(?m)^FAILED test_steps.py::test_slow - \S*hangs undecided .*(no answer within|did not return in time)",
        run[0].stdout,
    )


def test_the_folder_has_a_file_for_each_test_that_found_something_and_a_summary(run):
    found = {path.name: json.loads(path.read_text()) for path in run[1].glob("*.json")}
    passed = {told["test"].partition("::")[2]: told["verdicts"][0]["passed"] for told in found.values()}
    known = dict.fromkeys(["test_wrong", "test_wrong_as_known", "test_told_apart"], False)
    assert passed == {"test_right": True, **known, "test_slow": None}
    summary = (run[1] / "summary.md").read_text()
    assert summary.count("### `test_steps.py::test_") == 5
    words = [line.split(" | ")[0][2:] for line in summary.splitlines()[2:7]]
    assert words == ["undecided", "FAILED", *["failed, as expected"] * 2, "passed"]
    assert "is not rk4" in summary
    silent = "`test_steps.py::test_asked_without_sense`, `test_steps.py::test_plain`"
    assert f"\n\nfailed without a verdict: {silent}\n\n###" in summary


@pytest.mark.slow
def test_workers_write_the_same_folder(run, tmp_path):
    pytest_in(tmp_path, "-p", "xdist", "-n", "2", "--driftproof-report=found")
    paths = [path.name for path in run[1].iterdir()]
    assert len(paths) == 6
    plain = lambda text: re.sub(r"no answer within [0-9.]+ s|the 0.5 s [^:]*: stopped after [0-9.]+ s", "hangs", text)
    for path in paths:  # which limit of time stops a step that hangs depends on the machine
        assert plain((tmp_path / "found" / path).read_text()) == plain((run[1] / path).read_text())


ALIKE = f"""
import os
{PROJECT.partition("def hangs")[0]}
@pytest.mark.parametrize("method", ["forward_euler", "rk4"], ids=["a|b", "a b"])
def test_named_alike(method, tmp_path):
    os.chdir(tmp_path)
    assert_verified(euler, method, examples=20)
"""


@pytest.mark.slow
def test_names_that_files_cannot_have_lose_nothing_and_a_verdict_of_another_time_is_none(tmp_path):
    pytest_in(tmp_path, "--driftproof-report=found", project=ALIKE)
    rows = (tmp_path / "found" / "summary.md").read_text().splitlines()[2:4]
    assert [row.split()[1] for row in rows] == ["FAILED", "passed"]
    assert r"`test_steps.py::test_named_alike[a\|b]`" in rows[1]
    project = f"{ALIKE}\ndef test_it():\n    pass\n"
    assert pytest_in(tmp_path, "--driftproof-report=found", "-k", "test_it", project=project).returncode == 0
    assert (tmp_path / "found" / "summary.md").read_text() == "no verdict\n"
    pytest_in(tmp_path, "--driftproof-report=found", project=ALIKE.replace("os.chdir(tmp_path)", "raise OSError"))
    assert [path.name for path in (tmp_path / "found").iterdir()] == ["summary.md"]


IN_PLACE = """
from driftproof import assert_verified

def euler(y, h):
    y[:] = [y[0] + h * y[1], y[1] - h * y[0]]
    return y

def test_remarked():
    assert_verified(euler, "forward_euler", examples=20)
"""


@pytest.mark.parametrize(("filters", "word"), [("default", "passed"), ("error", "passed, but the test FAILED")])
def test_a_remark_fails_a_test_where_its_warning_is_an_error_and_the_summary_says_so(filters, word, tmp_path):
    (tmp_path / "pytest.ini").write_text(f"[pytest]\nfilterwarnings = {filters}::driftproof.RemarkWarning\n")
    done = pytest_in(tmp_path, "--driftproof-report=found", project=IN_PLACE)
    assert (done.returncode, "remark: it changes its argument and returns it" in done.stdout) == ("but" in word, True)
    assert f"\n| {word} | `test_steps.py::test_remarked`" in (tmp_path / "found" / "summary.md").read_text()


def test_a_folder_that_is_none_is_refused_in_a_line(tmp_path):
    done = pytest_in(tmp_path, "--driftproof-report=test_steps.py")
    assert done.stderr == "ERROR: --driftproof-report: test_steps.py is a file; name a folder\n\n"
    assert pytest_in(tmp_path, "--driftproof-report=").stderr == "ERROR: --driftproof-report: name a folder\n\n"


@pytest.mark.parametrize("given", ["", "time_limit=0", "time_limit=True", "time_limit='long'", "timelimit=3", "0"])
def test_a_mark_without_seconds_is_refused_in_a_line_that_shows_it(given):
    mark = eval(f"pytest.mark.driftproof({given}).mark")
    item = SimpleNamespace(nodeid="test_steps.py::test_it", get_closest_marker=lambda name: mark)
    with pytest.raises(
        pytest.fail.Exception, match=r"^test_steps\.py::test_it: mark it driftproof\(time_limit=S"
    ) as told:
        next(pytest_runtest_call(item))
    assert (told.value.msg.rpartition(", not ")[2], told.value.pytrace) == (f"driftproof({given})", False)


def test_the_verdict_on_a_trajectory_is_written_too(tmp_path):
    project = """
from driftproof import assert_accurate

ROWS = [0.0, 0.5, 1.0], [[1.0], [0.6065], [0.3679]]

def test_near():
    assert_accurate(ROWS, lambda t, y: -y, 1e-4)

def test_far():
    assert_accurate(ROWS, lambda t, y: -y, 1e-5)
"""
    done = pytest_in(tmp_path, "--driftproof-report=found", project=project)
    assert "FAILED test_steps.py::test_far - the solution is off by 3.065971263e-5, more than 1e-05" in done.stdout
    summary = (tmp_path / "found" / "summary.md").read_text()
    assert "largest error 3.065971263e-5, proved" in summary
    found = [json.loads(path.read_text())["verdicts"][0] for path in sorted((tmp_path / "found").glob("*.json"))]
    assert [verdict["passed"] for verdict in found] == [False, True]
    near = "is, at each of its 3 points, within 0.0001 of the true one that starts at the first (proved)"
    assert found[1]["verdict"] == near
