"""A study of error against work: kept point by point, gone on from where it stopped, never measured twice."""

import dataclasses
import json
import math
import re
from itertools import cycle

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.work_precision import curves, integrators
from driftproof.numeric.work_precision.timing import ROUNDS, Timing
from driftproof.reports.work_precision import study as work_precision
from driftproof.reports.work_precision.report import errors_json, study_text, write_study
from driftproof.reports.work_precision.study import measure, state_remark
from driftproof.support import kept
from tests.reports.studies import contents, study, unheard


@pytest.mark.slow
def test_errors_are_the_same_bytes_in_two_runs_and_seconds_stand_elsewhere(tmp_path):
    asked = study("rk4", "velocity_verlet", "gauss2")
    for folder in ("first", "second"):
        write_study(asked, measure(asked, tmp_path / folder, unheard), tmp_path / folder)
    first, second = contents(tmp_path / "first"), contents(tmp_path / "second")
    assert first["errors.json"] == second["errors.json"]
    assert first["times.json"] != second["times.json"]
    assert b"python" not in first["errors.json"]
    assert str(tmp_path).encode() not in b"".join(first.values())


def test_progress_is_told_to_the_end(tmp_path):
    told = list[tuple[int, int]]()
    measure(study("rk4", "heun2"), tmp_path, unheard, lambda more, done: told.append((more, done)))
    assert told[:3] == [(2, 0), (0, 1), (0, 1)]
    assert [*map(sum, zip(*told, strict=True))] == [(total := 2 + told[3][0]), total]


def test_what_is_measured_is_not_measured_again(tmp_path, monkeypatch):
    asked = dataclasses.replace(study("rk4", "gauss2"), wanted=[1e-2])
    before = measure(asked, tmp_path, unheard)
    kept = (tmp_path / "points.json").read_bytes()
    for name in ("curve_of", "started", "for_goal", "solver_point"):
        monkeypatch.setattr(work_precision, name, lambda *_, **__: pytest.fail("measured again"))
    again = measure(asked, tmp_path, unheard)
    assert (again.timings, errors_json(asked, again)) == (before.timings, errors_json(asked, before))
    assert list(again.curves) == ["rk4", "gauss2", "gauss2 controlled"]
    assert (tmp_path / "points.json").read_bytes() == kept


def test_a_study_that_is_interrupted_goes_on_where_it_was(tmp_path, monkeypatch):
    asked, turns = study("rk4", "velocity_verlet"), work_precision.interleave

    def interrupted(*arguments, **named):
        taken = turns(*arguments, **named)
        for name in taken:
            yield name
            if not name:
                raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(work_precision, "interleave", interrupted)
        with pytest.raises(KeyboardInterrupt):
            measure(asked, tmp_path, unheard)
    held = json.loads((tmp_path / "points.json").read_text(encoding="utf-8"))
    first = {name: timing["samples"] for name, timing in held["timings"].items()}
    assert {len(samples) for samples in first.values()} == {1}
    finished = measure(asked, tmp_path, unheard)
    for name, timing in finished.timings.items():
        assert timing.samples[:1] == first[name]
        assert len(timing.samples) == ROUNDS


def test_a_save_that_fails_leaves_the_file_as_it_was(tmp_path, monkeypatch):
    asked = study("rk4")
    measure(asked, tmp_path, unheard)
    before = contents(tmp_path)
    monkeypatch.setattr(kept.json, "dumps", lambda *_, **__: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        measure(asked, tmp_path, [].append)
    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (study("rk4", "heun3"), "methods differ"),
        (study("rk4", limit=0.06), "time_limit differ"),
        (study("rk4", problem="dahlquist_1"), "problem, definition differ"),
    ],
)
def test_another_question_starts_anew_with_one_line(tmp_path, asked, said):
    before = measure(study("rk4"), tmp_path, unheard)
    heard = []
    found = measure(asked, tmp_path, heard.append)
    assert all(
        found.timings[name].samples != before.timings[name].samples for name in found.timings.keys() & before.timings
    )
    assert len(heard) == 1
    assert said in heard[0]
    assert "\n" not in heard[0]
    assert [*found.curves] == [method.key for method in asked.methods]


@pytest.mark.parametrize("held", ["", "{", "[]", '{"question": 1}', '{"question": {}, "curves": 3}'])
def test_a_file_that_cannot_be_read_starts_anew_with_one_line(tmp_path, held):
    (tmp_path / "points.json").write_text(held, encoding="utf-8")
    heard = []
    assert measure(study("rk4"), tmp_path, heard.append).curves
    assert len(heard) == 1


@pytest.mark.parametrize("key", ["evaluations", "samples", "claimed_order", "problem", "checksum"])
def test_no_digit_that_was_changed_is_taken_for_a_measurement(tmp_path, key):
    measure(asked := study("rk4"), tmp_path, unheard)
    path, heard = tmp_path / "points.json", list[str]()
    before, name, after = path.read_text(encoding="utf-8").partition(f'"{key}": ')
    path.write_text(before + name + re.sub(r"[1-8a-y]", lambda found: chr(ord(found[0]) + 1), after, count=1))
    assert work_precision.held(path, asked.question(), heard.append) == work_precision.Measured()
    assert len(heard) == 1


def test_a_timed_call_that_reaches_another_state_is_not_timed():
    point = curves.curve_of(METHODS["rk4"], HARMONIC, [16]).points[0]
    state = integrators.integrator(METHODS["rk4"], HARMONIC).calls["python"](16)
    assert state_remark(HARMONIC, point, state) == ""
    assert "its final state differs" in state_remark(HARMONIC, point, lambda: (state()[0] + 1e-9, state()[1]))
    assert "ZeroDivisionError" in state_remark(HARMONIC, point, lambda: (1 / 0,))


def test_a_solver_that_fails_at_a_loose_tolerance_is_asked_for_tighter_ones(monkeypatch):
    class Solver:
        once = 1

        def __init__(self, failing):
            self.failing = failing

        def counted(self, tolerance, t, most):
            if tolerance in self.failing:
                raise ArithmeticError("no step size meets the tolerance")
            return 7

        def solve(self, tolerance, t):
            return [1.0, 0.0]

    def settings(*failing):
        points = work_precision._solver_curve("x", lambda: Solver(failing), study("rk4")).points
        return [float(point.setting) for point in points]

    loose, tight = work_precision.TOLERANCES
    assert settings() == settings(loose) == settings(loose, tight) == [loose, tight]
    monkeypatch.setattr(work_precision, "TOLERANCES", (loose, tight, tight / 10))
    assert settings(tight) == [loose, tight], "twin: one that fails where it did not before is not"


def test_points_over_the_limit_are_marked_and_not_timed():
    asked = study("gauss2", limit=1e-4)
    found = measure(asked, None, unheard)
    assert found.timings
    assert all("over 0.0001 s" in timing.remark and not timing.samples for timing in found.timings.values())
    told = study_text(asked, found)
    assert re.search(r"not timed, being longer than 0.0001 s \(--time-limit\): points of gauss2 \d", told)
    assert "not timed: gauss2" not in told


def test_what_a_point_takes_is_guessed_from_the_one_before(monkeypatch):
    """As many times as long as it has steps: 0.03 s for 16 are 0.06 s for 32, which is not begun, and 0.12 s for 64."""
    taken = cycle((0.021, 0.03))
    monkeypatch.setattr(work_precision, "_warm_up", lambda *_: 0.02)
    monkeypatch.setattr(work_precision, "started", lambda call: (Timing(1, [0.0]), next(taken)))
    found = measure(study("rk4", limit=0.05), None, unheard)
    for kind in ("python", "ensemble"):
        remarks = [found.timings[f"rk4 | {kind} | {steps}"].remark for steps in (8, 16, 32, 64)]
        assert remarks == ["", "", "about 0.06 s, over 0.05 s", "about 0.12 s, over 0.05 s"]


def test_methods_that_tell_their_error_also_choose_their_steps():
    """Pairs, Gauss's methods and Radau IIA, at the tolerances of peers; nobody else."""
    found = measure(study("rk4", "heun_euler21", "radau_iia2", limit=0.01), None, unheard).curves
    assert list(found) == ["rk4", "heun_euler21", "heun_euler21 controlled", "radau_iia2", "radau_iia2 controlled"]
    for key in ("heun_euler21 controlled", "radau_iia2 controlled"):
        loose, *_, tight = (point for point in found[key].points if point.errors)
        assert 1e-4 > loose.error * 1e-2 > tight.error
        assert 20 < (loose.evaluations or 0) < (tight.evaluations or 0)


def test_the_largest_tolerance_for_an_error_is_among_one_two_and_five():
    """A solver whose error is its tolerance, and three times as large on the way; each goal starts from the decades."""

    class Solver:
        once = 1
        counted = staticmethod(lambda tolerance, t, most: 7)
        solve = staticmethod(lambda tolerance, t: [math.cos(t) + tolerance * (1 if t == 10 else 3), -math.sin(t)])

    asked = study("rk4")
    curve = work_precision._solver_curve("x", Solver, asked)
    for goal, between in ((3.1e-6, ["2e-06"]), (7e-6, ["5e-06", "2e-06"]), (1.6e-5, ["5e-06"]), (1e-9, [])):
        points = work_precision._tolerance_for_goal(Solver, asked, curve, goal)
        assert [point.setting for point in points] == ["1e-03", *between, "1e-06"]
        again = dataclasses.replace(curve, points=points)
        assert work_precision._tolerance_for_goal(Solver, asked, again, goal) == points


def test_an_error_that_is_wanted_is_met_with_fewer_steps_than_a_doubling():
    """To leading order RK4 errs by 10 h⁴/120, which is 0.00998 for N = 17, and 0.0127 for N = 16."""
    asked = dataclasses.replace(study("rk4"), wanted=[1e-2, 1e-1])
    found = measure(asked, None, unheard)
    met = [curves.lasting(found.curves["rk4"].points, goal)[-1].steps for goal in asked.wanted]
    assert met == [17, 10]
    assert {16, 17, 18, 19, 10, 11, 12} <= {point.steps for point in found.curves["rk4"].points}
    timed = {n for n in range(20) if f"rk4 | python | {n}" in found.timings}
    assert timed == {8, 10, 16, 17}, "those beside them only tell that no luck is named"
    text = study_text(dataclasses.replace(study("rk4"), wanted=[1e-2, 1e-1]), found)
    assert "rk4 with h = 10/17, N = 17: 68 evaluations" in text
    assert "the fewest steps are found to a sixteenth" in text
    assert "sixteenth" not in study_text(study("rk4"), found)
