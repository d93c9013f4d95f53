"""`driftproof identify` and `verify`: the report as asked for, the exit status, no trace beside the stepper."""

import json
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest

from driftproof.blackbox.isolation import TIME_LIMIT
from driftproof.blackbox.judging.agreement import EXAMPLES
from driftproof.blackbox.judging.specification import Domain

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_stepper_that_is_another_method_is_refuted_and_no_folder_is_left_behind(tmp_path):
    source = "def step(q, v, h):\n    return q + h * v, v - h * q\n"
    (tmp_path / "mine.py").write_text(source, encoding="utf-8")
    path = os.pathsep.join([str(ROOT), *sys.path])
    done = subprocess.run(
        [sys.executable, "-B", "-m", "driftproof", "verify", "mine:step", "--method", "rk4", "--format", "json"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, json.loads(done.stdout)["passed"], done.stderr) == (1, False, "")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.py"]


def test_help_names_the_defaults_that_hold(run):
    defaults = [TIME_LIMIT, EXAMPLES, *(largest for _, largest in Domain().ranges)]
    assert re.findall(r"\(default (\d+)\)", run("verify", "--help")[1]) == [f"{x:g}" for x in defaults]


@pytest.mark.parametrize("command", ["identify", "verify"])
def test_report_is_in_the_format_asked_for(command, run, monkeypatch):
    """The examination itself is replaced: tests/blackbox has it."""

    class Report:
        passed = answered = command == "identify"
        written = staticmethod(lambda form, *_: f"as {form}")

    module = import_module(f"driftproof.blackbox.{command}")
    monkeypatch.setattr(module, command, lambda *_, **__: Report)
    words = ("--method", "rk4") if command == "verify" else ()
    assert run(command, "mine:step", *words, "--format", "markdown") == (not Report.passed, "as markdown\n", "")
    if words:
        assert run("identify", "mine:step", *words) == (1, "as text\n", "")
    monkeypatch.setattr("driftproof.blackbox.solvers.identify_solver.identify_solver", lambda *_, time_limit: Report)
    assert run("identify", "mine:solve", "--solver") == (not Report.answered, "as text\n", "")
    assert run("verify", "mine:solve", "--solver", "--method", "rk4") == (not Report.passed, "as text\n", "")


@pytest.mark.parametrize(("answered", "status"), [(True, 0), (False, 1), (None, 3)])
def test_no_answer_is_no_success(answered, status, run, monkeypatch):
    report = SimpleNamespace(answered=answered, written=lambda form, everything: f"{form}, everything: {everything}")
    monkeypatch.setattr("driftproof.blackbox.identify.identify", lambda *_, **__: report)
    assert run("identify", "mine:step", "--all") == (status, "text, everything: True\n", "")


DOMAINS = {
    (): Domain(2.0, 1000.0),
    ("--largest-step", "3", "--largest-state", "5"): Domain(3.0, 5.0),
    ("--extremes",): Domain(2.0, 1000.0, smallest_step=0.0, smallest_state=0.0),
}


@pytest.mark.parametrize("words", DOMAINS)
def test_the_options_say_in_which_domain_a_stepper_is_examined(words, run, monkeypatch):
    asked = []
    report = SimpleNamespace(passed=True, written=lambda *_: "")
    monkeypatch.setattr("driftproof.blackbox.verify.verify", lambda *_, domain, **__: asked.append(domain) or report)
    assert run("verify", "mine:step", "--method", "rk4", *words)[0] == 0
    assert asked == [DOMAINS[words]]


REFUSED = {
    ("identify",): "required: MODULE:STEP",
    ("identify", "os"): "'os' names no stepper; write package.module:function",
    ("verify", "os:getcwd"): "required: --method",
    ("verify", "os:getcwd", "--solver", "--method", "rk5"): "unknown method 'rk5'; did you mean rk4 or ",
    ("verify", "os:getcwd", "--solver", "--method", "rk4", "--examples", "9"): "--examples has no effect with --solver",
    ("identify", "os:getcwd", "--flush-to-zero"): "--flush-to-zero has no effect without --method",
    ("identify", "os:getcwd", "--solver-tolerance", "0"): "--solver-tolerance has no effect without --method",
    ("identify", "os:getcwd", "--largest-step", "1"): "--largest-step has no effect without --method",
    ("identify", "os:getcwd", "--largest-state", "9"): "--largest-state has no effect without --method",
    ("identify", "os:getcwd", "--solver", "--array", "os:a"): "--array has no effect with --solver",
    ("identify", "os:getcwd", "--solver", "--largest-step", "9"): "--largest-step has no effect with --solver",
    ("verify", "a:b", "--method", "rk4", "--system", "a:f", "--extremes"): "--extremes has no effect with --system",
    (
        "verify",
        "a:b",
        "--method",
        "rk4",
        "--system",
        "a:f",
        "--examples",
        "9",
    ): "--examples has no effect with --system",
    ("verify", "a:b", "--method", "rk4", "--system", "a:f", "--flush-to-zero"): "--flush-to-zero has no effect with",
    ("verify", "os:getcwd", "--method", "rk4", "--examples", "0"): "the number of examples must be from 1 to 1000000",
    ("verify", "os:getcwd", "--method", "rk4", "--largest-step", "-1"): "the step size must be a number above 0",
    ("verify", "os:getcwd", "--method", "rk4", "--solver-tolerance", "0"): "must be a finite number > 0",
    ("verify", "os:getcwd", "--method", "rk4", "--solver-tolerance", "1e-10"): "takes no solver_tolerance",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)


def test_the_system_that_is_meant_is_handed_on_and_a_whole_solver_has_none(run, monkeypatch):
    asked = dict[str, object]()
    report = SimpleNamespace(passed=True, written=lambda form, everything: "it is")
    monkeypatch.setattr("driftproof.blackbox.verify.verify", lambda *_, **how: asked.update(how) or report)
    assert run("verify", "mine:step", "--method", "rk4", "--system", "mine:f") == (0, "it is\n", "")
    assert asked["system"] == "mine:f"
    status, _, said = run("verify", "mine:solve", "--solver", "--method", "rk4", "--system", "mine:f")
    assert status == 2
    assert "--system" in said
