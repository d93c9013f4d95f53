"""The import-time benchmark says what it measured; what it measures depends on the machine, so no time is tested."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

BENCHMARK = runpy.run_path(str(Path(__file__).parents[1] / "benchmarks" / "import_time.py"))


@pytest.mark.parametrize(("least", "verdict"), [(0.15, "1.50, reached"), (0.16, "1.60, missed")])
def test_report_compares_minima_with_the_goal(least: float, verdict: str) -> None:
    taken = {name: [0.2, 0.1, 0.9] for name in BENCHMARK["SUBJECTS"]}
    taken["import numeric.run"] = [0.9, least, 0.5]
    shown = BENCHMARK["report"](taken)
    assert f"goal: import numeric.run <= 1.5 numpy: {verdict}" in shown
    assert "3 rounds" in shown
    assert shown.count("\n") == len(taken) + 3


def test_subjects_run_in_a_new_interpreter_and_take_some_time() -> None:
    assert BENCHMARK["seconds"]("pass") > 0
    assert set(BENCHMARK["SUBJECTS"]) >= {"import numpy", "import numeric.run", "driftproof --help"}
