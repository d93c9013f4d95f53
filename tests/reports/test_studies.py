"""A study from Python is the study of the command: its errors, which are the same in every run."""

import json
import re
from contextlib import nullcontext
from types import SimpleNamespace

import pytest

import driftproof
from driftproof.commands import problems
from driftproof.reports import studies
from driftproof.reports.stability import STABILITY_METHODS
from driftproof.reports.studies import WORK_PRECISION_METHODS
from driftproof.reports.work_precision.study import Measured
from tests.reports.studies import be_quick


def test_errors_are_those_of_the_command_and_files_are_written(answer, monkeypatch, tmp_path, capsys):
    be_quick(monkeypatch)
    driftproof.work_precision("dahlquist_1", "rk4", time_limit=0.01, output=tmp_path / "new" / "folder")
    study = driftproof.work_precision("dahlquist_1", "rk4", time_limit=0.01, output=tmp_path)
    shown = json.loads(
        answer("work-precision", "dahlquist_1", "--methods", "rk4", "--time-limit", "0.01", "--format=json")
    )
    assert study["errors"] == shown["errors"]
    assert f"wrote {tmp_path / 'errors.json'}" in str(study)
    assert list(study.found.curves) == ["rk4"]
    driftproof.work_precision("dahlquist_1", "rk4", time_limit=0.02, output=tmp_path)
    assert "is from another study (time_limit differ)" in capsys.readouterr().err
    monkeypatch.setattr(studies, "measure", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    for folder, said in ((tmp_path, f"^the same command goes on from {tmp_path}$"), (None, "^$")):
        with pytest.raises(KeyboardInterrupt, match=said):
            driftproof.work_precision("dahlquist_1", "rk4", output=folder)


def test_progress_counts_points_none_of_them_before_it_is_known_how_many(monkeypatch):
    be_quick(monkeypatch)
    opened, done = [], []
    bar = SimpleNamespace(total=0, update=done.append)
    monkeypatch.setattr(studies, "progress_bar", lambda *asked: opened.append(asked) or nullcontext(bar))
    driftproof.work_precision("dahlquist_1", "rk4", time_limit=0.01)
    assert opened == [(0, "point")]
    assert bar.total >= sum(done) > 1


@pytest.mark.parametrize(
    ("command", "methods"),
    [(problems.stability_command, STABILITY_METHODS), (problems.work_precision_command, WORK_PRECISION_METHODS)],
)
def test_help_names_the_methods_that_are_taken(command, methods):
    assert ",".join(methods) in "".join(command.parser("x").format_help().split())


def test_a_stiff_problem_is_told_so_and_gets_implicit_methods(monkeypatch):
    asked = []
    monkeypatch.setattr(studies, "measure", lambda study, *_: asked.append(study.methods) or Measured())
    told = [str(driftproof.work_precision(key)) for key in ("dahlquist_1e3", "dahlquist_1")]
    said = "This is stiff: an eigenvalue of df/dy is -1e+03 at t = 0, where errors of rk4 grow in a run of fewer "
    assert told[0].startswith(f"{said}than 360 steps; ")
    assert "stiff" not in told[1]
    assert ["radau_iia2" in [method.key for method in methods] for methods in asked] == [True, False]


@pytest.mark.parametrize("error", ["1/0", "0", [1e-3, -1e-6]])
def test_an_error_to_reach_is_positive(error):
    with pytest.raises(ValueError, match="error"):
        studies.work_precision("dahlquist_1", ["forward_euler"], error=error)


def test_numbers_may_be_text_and_scenes_a_list():
    found = driftproof.work_precision("dahlquist_1", ["forward_euler"], error="1e-2,0.001", time_limit="1e-4")
    assert re.findall(r"(?m)^For an error of at most (\S+) at the end", str(found)) == ["1e-2", "1e-3"]
    with pytest.raises(ValueError, match="abc"):
        driftproof.work_precision("dahlquist_1", ["forward_euler"], error="abc")
    assert driftproof.report(["default"]).html == driftproof.report("default").html
