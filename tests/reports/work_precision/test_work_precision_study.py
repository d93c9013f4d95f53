"""A study of error against work: kept point by point, gone on from, byte-stable where it can be, drawn, and told."""

from __future__ import annotations

import csv
import io
import json
import re
import sys
from collections.abc import Callable
from math import inf
from pathlib import Path
from xml.etree import ElementTree

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.work_precision import curves, integrators
from driftproof.numeric.work_precision.curves import Curve, Point
from driftproof.numeric.work_precision.exact import Size
from driftproof.numeric.work_precision.timing import ROUNDS, Timing
from driftproof.numeric.work_precision.verdicts import Priced, dominators
from driftproof.reports.work_precision import study as work_precision
from driftproof.reports.work_precision.figure import draw
from driftproof.reports.work_precision.peers import PEERS, Peer, peers_named
from driftproof.reports.work_precision.report import errors_json, goal_rows, priced, text, times_json, write
from driftproof.reports.work_precision.study import Measured, Study, doubtful, measure, name_of

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few steps, and nothing compiled."""
    monkeypatch.setattr(integrators, "has_numba", lambda: False)
    monkeypatch.setattr(curves, "MOST", 64)
    monkeypatch.setattr(curves, "MOST_IMPLICIT", 16)
    monkeypatch.setattr(work_precision, "TOLERANCES", (1e-3, 1e-6))


def study(*keys: str, problem: str = "harmonic_oscillator", limit: float = 10.0, peers: tuple[Peer, ...] = ()) -> Study:
    return Study(problem_named(problem), [METHODS[key] for key in keys], peers, limit)


def unheard(line: str) -> None:
    raise AssertionError(line)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_errors_are_the_same_bytes_in_two_runs_and_seconds_stand_elsewhere(tmp_path: Path) -> None:
    asked = study("rk4", "velocity_verlet", "gauss2")
    for folder in ("first", "second"):
        write(asked, measure(asked, tmp_path / folder, unheard), tmp_path / folder)
    first, second = contents(tmp_path / "first"), contents(tmp_path / "second")
    assert first["errors.json"] == second["errors.json"]
    assert first["times.json"] != second["times.json"]
    assert b"python" not in first["errors.json"]
    assert str(tmp_path).encode() not in b"".join(first.values())


def test_what_is_measured_is_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = study("rk4", "gauss2")
    before = measure(asked, tmp_path, unheard)
    kept = (tmp_path / "points.json").read_bytes()
    for name in ("curve_of", "started"):
        monkeypatch.setattr(work_precision, name, lambda *_, **__: pytest.fail("measured again"))
    again = measure(asked, tmp_path, unheard)
    assert (again.timings, errors_json(asked, again)) == (before.timings, errors_json(asked, before))
    assert list(again.curves) == ["rk4", "gauss2"]
    assert (tmp_path / "points.json").read_bytes() == kept


def test_a_study_that_is_interrupted_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, turns = study("rk4", "velocity_verlet"), work_precision.interleave

    def interrupted(*arguments: object, **named: object) -> object:
        taken = turns(*arguments, **named)  # type: ignore[arg-type]
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


def test_a_save_that_fails_leaves_the_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = study("rk4")
    measure(asked, tmp_path, unheard)
    before = contents(tmp_path)
    monkeypatch.setattr(work_precision.json, "dumps", lambda *_, **__: (_ for _ in ()).throw(OSError("disk full")))
    store = work_precision.ResultStore(tmp_path, asked.question(), unheard)
    with pytest.raises(OSError, match="disk full"):
        store.save()
    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (study("rk4", "heun3"), "methods differ"),
        (study("rk4", limit=0.06), "time_limit differ"),
        (study("rk4", problem="dahlquist_1"), "problem, definition differ"),
    ],
)
def test_another_question_starts_anew_with_one_line(tmp_path: Path, asked: Study, said: str) -> None:
    before = measure(study("rk4"), tmp_path, unheard)
    heard: list[str] = []
    found = measure(asked, tmp_path, heard.append)
    assert all(
        found.timings[name].samples != before.timings[name].samples for name in found.timings.keys() & before.timings
    )
    assert len(heard) == 1
    assert said in heard[0]
    assert "\n" not in heard[0]
    assert [*found.curves] == [method.key for method in asked.methods]


@pytest.mark.parametrize("held", ["", "{", "[]", '{"question": 1}', '{"question": {}, "curves": 3}'])
def test_a_file_that_cannot_be_read_starts_anew_with_one_line(tmp_path: Path, held: str) -> None:
    (tmp_path / "points.json").write_text(held, encoding="utf-8")
    heard: list[str] = []
    assert measure(study("rk4"), tmp_path, heard.append).curves
    assert len(heard) == 1


def test_a_timed_call_that_reaches_another_state_is_not_timed() -> None:
    point = curves.curves(HARMONIC, ["rk4"], [16])[0].points[0]
    state = integrators.integrator(METHODS["rk4"], HARMONIC).calls["python"](16)
    assert doubtful(HARMONIC, point, state) == ""
    assert "another state" in doubtful(HARMONIC, point, lambda: (state()[0] + 1e-9, state()[1]))
    assert "ZeroDivisionError" in doubtful(HARMONIC, point, lambda: (1 / 0,))


def test_points_over_the_limit_are_marked_and_not_timed() -> None:
    asked = study("gauss2", limit=1e-4)
    found = measure(asked, None, unheard)
    assert found.timings
    assert all("limit 0.0001 s" in timing.remark and not timing.samples for timing in found.timings.values())
    assert "not timed: gauss2, Python, at 8" in text(asked, found)


def test_tables_say_who_is_cheapest_who_is_dominated_and_what_does_not_apply() -> None:
    asked = study("rk4", "velocity_verlet", problem="dahlquist_1")
    shown = text(asked, measure(asked, None, unheard))
    assert "velocity_verlet: not applicable: " in shown
    assert "Least work for an error of at most 1e-6 (* least of all)" in shown
    assert "no times, compiled, of rk4: numba is not installed" in shown
    assert re.search(r"^rk4 +4 +4\.\d\d \(", shown, re.MULTILINE)


def test_goal_is_met_by_measured_points_only() -> None:
    points = [Point(str(n), n, {"state": Size(e, e)}, steps=n) for n, e in ((8, 1e-2), (16, 1e-5))]
    measured = Measured({"a": Curve("a", "A", 1, points)})
    cost = {"evaluations": priced(measured, "evaluations")}
    assert goal_rows(measured, cost, 1e-3)[1] == ["a", "16 *"]
    assert goal_rows(measured, cost, 1e-6)[1] == ["a", "not met: 1.0e-5"]


def test_errors_as_large_as_the_solution_are_lost_and_decide_nothing() -> None:
    def curve(key: str, *errors: float) -> Curve:
        points = [Point(str(8 << i), 8 << i, {"state": Size(e, e)}, scale=1.0) for i, e in enumerate(errors)]
        return Curve(key, key, 1, points)

    measured = Measured({"a": curve("a", 1e9, 0.1), "b": curve("b", 1e8, 0.01), "c": curve("c", 1e7)})
    cost = {"evaluations": priced(measured, "evaluations")}
    assert cost["evaluations"] == {"a": [Priced(0.1, 16)], "b": [Priced(0.01, 16)], "c": []}
    assert dominators(cost["evaluations"]) == {"a": ["b"]}
    assert [row[1] for row in goal_rows(measured, cost, 1e-3)[1:]] == ["not met: 0.1", "not met: 0.01", "not met: lost"]


def test_neighbouring_points_of_one_remark_are_told_by_the_first_and_the_last() -> None:
    remarks = ["not finite", "not finite", "", "not finite", "", "not solved"]
    points = [Point(str(8 << i), None, {}, remark=remark, steps=8 << i) for i, remark in enumerate(remarks)]
    shown = text(study("rk4"), Measured({"rk4": Curve("rk4", "", 4, points)}))
    assert "rk4 at N = 8 to 16, 64: not finite" in shown
    assert "rk4 at N = 256: not solved" in shown


def test_json_and_csv_hold_every_point(tmp_path: Path) -> None:
    asked = study("rk4", "heun3")
    measured = measure(asked, None, unheard)
    write(asked, measured, tmp_path)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "work_precision.csv").read_text(encoding="utf-8"))))
    points = [(curve.key, point.setting) for curve in measured.curves.values() for point in curve.points]
    assert [(row["curve"], row["setting"]) for row in rows] == points
    assert float(rows[0]["state_final"]) == measured.curves["rk4"].points[0].error
    errors = json.loads((tmp_path / "errors.json").read_text(encoding="utf-8"))
    times = json.loads((tmp_path / "times.json").read_text(encoding="utf-8"))
    assert sum(len(curve["points"]) for curve in errors["curves"]) == len(points)
    assert set(times["timings"]) == {name_of(*point[:1], kind, point[1]) for point in points for kind in _kinds(times)}
    assert times["question"]["machine"]
    assert "numpy" in times["question"]["versions"]


def _kinds(times: dict[str, dict[str, object]]) -> set[str]:
    return {name.split(" | ")[1] for name in times["timings"]}


def test_figure_has_a_panel_for_every_cost_and_a_legend_of_all_curves(tmp_path: Path) -> None:
    asked = study("rk4", "heun3", "gauss2")
    measured = measure(asked, None, unheard)
    drawn = draw(asked, measured, "state", tmp_path)
    ElementTree.parse(drawn)
    before, shown = drawn.read_bytes(), drawn.read_text(encoding="utf-8")
    for words in ("evaluations of f", "seconds, Python", "seconds a state, ensemble", "rk4", "heun3", "gauss2"):
        assert f"<!-- {words} -->" in shown
    assert "<!-- rounding the exact result -->" in shown
    assert "<!-- seconds, compiled -->" not in shown
    assert draw(asked, measured, "state", tmp_path).read_bytes() == before


class FakeSolver:
    """Exact at every tolerance but the last, where it fails; counts three evaluations."""

    def __init__(self, problem: object, solver: str) -> None:
        self.exact = dict(zip(HARMONIC.reference.times, HARMONIC.reference.states, strict=True))

    def solve(self, tolerance: float, t: float) -> tuple[float, ...]:
        if tolerance < 1e-4:
            raise ArithmeticError("step too\nsmall")
        return tuple(float(x) + tolerance for x in self.exact[next(x for x in self.exact if float(x) == t)])

    def counted(self, tolerance: float, t: float, limit: float = 0) -> int:
        return 3


def test_a_peer_stands_beside_ours_and_its_failure_is_a_remark(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Peer, "installed", True)
    monkeypatch.setattr(Peer, "version", "1.0")
    asked = study("rk4", peers=(Peer("fake", ("solver",), "python", FakeSolver),))
    found = measure(asked, None, unheard)
    curve = found.curves["fake solver"]
    assert [point.evaluations for point in curve.points] == [3, None]
    assert curve.points[1].remark == "step too small"
    assert curve.points[0].error == pytest.approx(1e-3 * 2**0.5)
    assert len(found.timed(curve, "python")) == 1
    assert "fake solver at tolerance 1e-06: step too small" in text(asked, found)


def test_peers_that_are_absent_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Peer, "installed", False)
    asked = study("rk4", peers=tuple(peers_named(["heyoka", "scipy"])))
    found = measure(asked, None, unheard)
    assert "peer heyoka: not installed; pip install 'driftproof[peers]'" in text(asked, found)
    assert set(times_json(asked, found)["absent"]) >= {"heyoka", "scipy"}


@pytest.mark.parametrize("name", PEERS)
def test_peers_that_are_installed_solve_the_oscillator_and_refuse_what_they_cannot(name: str) -> None:
    pytest.importorskip(name)
    peer = PEERS[name]
    for key in peer.solvers:
        solver = peer.on(HARMONIC, key)
        point = work_precision._peer_point(solver, 1e-6, study(limit=1))
        assert point.error < 1e-2
        assert point.evaluations is None if name == "heyoka" else 20 < (point.evaluations or 0) < 2000


BAD = [
    (("no_such",), "unknown problem 'no_such'"),
    (("--methods", "rk5"), "unknown method 'rk5'; did you mean"),
    (("--peers", "scpy"), "unknown peer 'scpy'; did you mean scipy?"),
    (("--time-limit", "0"), "'0' is no time limit"),
    (("--time-limit", "soon"), "'soon' is not a rational number"),
    (("--format", "xml"), "invalid choice: 'xml'"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD)
def test_bad_input_is_one_line(run: Run, arguments: tuple[str, ...], message: str) -> None:
    status, out, err = run("work-precision", *arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1


def test_a_file_in_the_place_of_the_folder_is_bad_input(run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    status, _, err = run("work-precision", "--methods", "rk4", "-o", str(tmp_path / "file"))
    assert status == 2
    assert "is a file; name a folder" in err


def test_command_writes_its_files_and_names_them(run: Run, tmp_path: Path) -> None:
    status, out, err = run("work-precision", "dahlquist_1", "--methods", "rk4", "-o", str(tmp_path / "new" / "folder"))
    assert (status, err) == (0, "")
    named = re.findall(r"^wrote (.*)$", out, re.MULTILINE)
    assert {Path(name).name for name in named} | {"points.json"} == set(contents(tmp_path / "new" / "folder"))


def test_command_answers_in_json_too(run: Run) -> None:
    status, out, _ = run("work-precision", "--methods", "rk4", "--format", "json")
    assert status == 0
    assert set(json.loads(out)) == {"errors", "times"}


def test_timing_of_no_sample_is_an_infinite_cost_and_a_kind_never_called_none() -> None:
    point = Point("8", 8, {"state": Size(0.1, 0.1)}, steps=8)
    marked = {"a | python | 8": Timing(remark="too long")}
    measured = Measured({"a": Curve("a", "A", 1, [point])}, marked, {"a | python": 1.0})
    assert priced(measured, "python") == {"a": [Priced(0.1, inf)]}
    assert priced(measured, "compiled") == {"a": []}


def test_without_matplotlib_everything_but_the_figures_is_written(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, out, err = run("work-precision", "dahlquist_1", "--methods", "rk4", "-o", str(tmp_path))
    assert (status, err) == (0, "")
    assert out.endswith("no figures: matplotlib is not installed; pip install 'driftproof[report]'\n")
    assert set(contents(tmp_path)) == {"errors.json", "times.json", "work_precision.csv", "points.json"}
