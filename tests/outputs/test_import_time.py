"""The import-time benchmark says what it measured; what it measures depends on the machine, so no time is tested."""

from __future__ import annotations

import pytest

from benchmarks.import_time import SUBJECTS, milliseconds_of, section


@pytest.mark.parametrize(("least", "met"), [(0.15, True), (0.16, False)])
def test_table_compares_minima_with_the_goal(least: float, met: bool) -> None:
    taken = {name: [0.2, 0.1, 0.9] for name in SUBJECTS}
    taken["import driftproof.numeric.run"] = [0.9, least, 0.5]
    shown = section(taken, loads_sympy=False)
    assert [goal.met for goal in shown.goals] == [met, True]
    assert shown.goals[0].found == f"{10 * least:.2f}"
    assert [row[0] for row in shown.rows[1:]] == list(SUBJECTS)
    assert not section(taken, loads_sympy=True).goals[1].met


def test_subjects_run_in_a_new_interpreter_and_take_some_time() -> None:
    assert milliseconds_of("pass") > 0
    assert set(SUBJECTS) >= {"import numpy", "import driftproof.numeric.run", "driftproof --help"}
