"""What a study writes: every point, with its errors apart from its seconds."""

import csv
import io
import json

from driftproof.reports.work_precision.study import measure, timing_name
from driftproof.reports.work_precision.study_files import write_study
from tests.looping import some
from tests.reports.studies import study, unheard


def test_json_and_csv_hold_every_point(tmp_path):
    asked = study("rk4", "heun3", problem="dahlquist_1")
    measured = measure(asked, None, unheard)
    write_study(asked, measured, tmp_path)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "work_precision.csv").read_text(encoding="utf-8"))))
    points = [(curve.key, point.setting) for curve in measured.curves.values() for point in curve.points]
    assert [(row["curve"], row["setting"]) for row in rows] == points
    assert float(rows[0]["state_final"]) == measured.curves["rk4"].points[0].error
    errors = json.loads((tmp_path / "errors.json").read_text(encoding="utf-8"))
    times = json.loads((tmp_path / "times.json").read_text(encoding="utf-8"))
    assert errors["reference"]["half_unit"] == "5e-25"  # of 0.000045399929762484851536, at the last time
    assert sum(len(curve["points"]) for curve in errors["curves"]) == len(points)
    kinds = {name.split(" | ")[1] for name in times["timings"]}
    assert set(times["timings"]) == {timing_name(key, kind, setting) for key, setting in points for kind in kinds}
    assert all(timing["samples"] for timing in some(times["timings"].values()))
    assert times["question"]["machine"]
    assert "numpy" in times["question"]["versions"]
