"""The files of a study: errors, times and points, as JSON and CSV, each written whole or not at all."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from driftproof.numeric.reference_errors import ENDS, QUANTITIES, Size, floors, half_unit
from driftproof.numeric.sweep import strings
from driftproof.numeric.work_precision.curves import Curve
from driftproof.numeric.work_precision.integrators import MEMBERS
from driftproof.numeric.work_precision.timing import Timing
from driftproof.numeric.work_precision.verdicts import dominators
from driftproof.reports.work_precision.peers import INSTALL
from driftproof.reports.work_precision.report import least_work, priced
from driftproof.reports.work_precision.study import EVALUATIONS, Measured, Study, per_state
from driftproof.support.files import atomic_write
from driftproof.support.plain_text import Json, as_json


def errors_json(study: Study, measured: Measured) -> Json:
    """What is the same in every run: errors, evaluations, orders. Numbers are strings, floats exact to the last bit."""
    problem, reference = study.problem, study.problem.reference
    about = {name: getattr(reference, name) for name in ("evidence", "source", "times")}
    return strings(
        {
            "problem": problem.key,
            "title": problem.title,
            "reference": about | {"half_unit": half_unit(reference.states[-1])},
            "floors": floors(problem),
            "curves": [_curve_json(curve) for curve in measured.curves.values()],
            "dominated_by_evaluations": dominators(priced(measured, EVALUATIONS)),
            **({"least_work": [_least_work_json(goal, measured) for goal in study.wanted]} if study.wanted else {}),
        }
    )


def _least_work_json(goal: float, measured: Measured) -> Json:
    found = {which: least_work(measured, goal, which) for which in ENDS}
    shown = {which: found and {"curve": found[0].key, **vars(found[1])} for which, found in found.items()}
    return {"goal": goal, **shown}


def _curve_json(curve: Curve) -> Json:
    points = [{name: getattr(point, name) for name in _POINT_FIELDS} for point in curve.points]
    for entry in points:
        entry["errors"] = {name: size._asdict() for name, size in entry["errors"].items()}
    order = {"measured_order": vars(curve.order) if curve.order else None}
    started = {"started": curve.started} if curve.started else {}
    return {**{name: getattr(curve, name) for name in _CURVE_FIELDS}, **started, **order, "points": points}


_CURVE_FIELDS = ("key", "title", "claimed_order", "verdict", "refused")
_POINT_FIELDS = ("setting", "evaluations", "errors", "doubt", "remark")


def times_json(study: Study, measured: Measured) -> Json:
    """What was measured in seconds, and on which machine; for ensembles, the seconds of all MEMBERS states."""
    return strings(
        {
            "question": study.question(),
            "members": str(MEMBERS),
            "warm_up": measured.warm_up,
            "timings": {name: _timing_json(timing) for name, timing in measured.timings.items()},
            "absent": dict(measured.absent) | {peer.name: INSTALL for peer in study.peers if not peer.installed},
        }
    )


def _timing_json(timing: Timing) -> Json:
    if not timing.samples:
        return {"remark": timing.remark}
    read = {"minimum": timing.best, "median": timing.median, "spread": timing.spread}
    return {"batch": timing.batch, "samples": timing.samples, **read}


def csv_text(measured: Measured) -> str:
    """One row per point: errors, evaluations, and for each kind minimum, median and spread, in seconds of one state."""
    kinds = measured.kinds
    sizes = [f"{name}_{which}" for name in QUANTITIES for which in Size._fields]
    costs = [f"{kind}_{what}" for kind in kinds for what in ("minimum", "median", "spread")]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["curve", "setting", EVALUATIONS, *sizes, "doubt", "remark", *costs])
    for curve in measured.curves.values():
        timed = {kind: measured.timed(curve, kind) for kind in kinds}
        for point in curve.points:
            errors = [x for name in QUANTITIES for x in point.errors.get(name, ("", "", ""))]
            costs = [x for kind in kinds for x in _seconds(kind, timed[kind].get(point.setting))]
            evaluations = "" if point.evaluations is None else point.evaluations
            writer.writerow([curve.key, point.setting, evaluations, *errors, point.doubt, point.remark, *costs])
    return out.getvalue()


def _seconds(kind: str, timing: Timing | None) -> list[Any]:
    if timing is None:
        return ["", "", ""]
    spread = "" if timing.spread is None else timing.spread
    return [per_state(kind, timing.best), per_state(kind, timing.median), spread]


def write_study(study: Study, measured: Measured, folder: Path) -> list[Path]:
    """Write the files next to the figures, each whole or not at all, and return their paths."""
    contents = {
        "errors.json": as_json(errors_json(study, measured)) + "\n",
        "times.json": as_json(times_json(study, measured)) + "\n",
        "work_precision.csv": csv_text(measured),
    }
    for name, content in contents.items():
        with atomic_write(folder / name) as draft:
            Path(draft).write_text(content, encoding="utf-8")
    return [folder / name for name in contents]
