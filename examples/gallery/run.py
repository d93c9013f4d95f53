"""Identify the targets of the gallery whose packages are installed, and write the table docs/gallery.md.

Run it at the root of the checkout: `python -m examples.gallery.run [PART OF A NAME ...]`; with `--solvers` first, it
asks the whole solvers of `whole_solvers.py`, and writes docs/gallery_solvers.md.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from docs.pages import markdown
from driftproof.blackbox.identify import identify
from driftproof.blackbox.report import Report
from examples.gallery.entry import Entry

HERE = Path(__file__).parent
TABLE = HERE.parents[1] / "docs" / "gallery.md"
FINDINGS = HERE / "findings.md"
KEPT = HERE.parents[1] / "build" / "gallery.json"
HEADLINE = """\
Ten integrators in released packages that are not what they say, the worst first. driftproof read each from outside;
each was then seen once more by a plain convergence run without driftproof: `examples/gallery/convergence.py`.
`promised` is the order by the package's own words, `seen` the slope of the last errors."""
INTRODUCTION = """\
Made by `make gallery`: what each stepper says that it is, and what driftproof finds from outside, without being
told. The true order is that of the coefficients where they can be read (any problem that the stepper is for), else
measured on nonlinear problems, else on linear problems. The worst error of 200 steps is over the sum of |monomials|, in
units of the unit roundoff u; beyond the bound means that the code does more than round the method's sums and
products, and the row says what: by its source, or as found from outside. The checks say what else nobody
expects. What each target is by its source, and which claims are not so, stands in
`tests/outputs/gallery_expected.py`."""
# Seconds for all questions to a stepper; compiled code takes most of them to compile.
TIME_LIMIT = 600.0
# The checks that, failed, take a step beyond the bound, the plainest first.
REASONS = ("full_precision", "small_digits", "position_range", "velocity_range", "linear")
HEAD = ("target", "version", "claimed", "identified", "order claimed", "true order", "worst error", "checks")


def targets() -> dict[str, Entry]:
    """Every target, of every file `on_*.py` beside this one."""
    modules = (import_module(f"examples.gallery.{path.stem}") for path in sorted(HERE.glob("on_*.py")))
    return {name: entry for module in modules for name, entry in module.TARGETS.items()}


def installed(package: str) -> str | None:
    """The version of the package, None where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def row(name: str, entry: Entry) -> tuple[str, ...]:
    """The line of the table on one target."""
    start = (name, installed(entry.package) or "", entry.method)
    claimed = "" if entry.order is None else str(entry.order)
    try:
        report = identify(entry.step, calls=entry.calls, array=entry.array, time_limit=TIME_LIMIT)
    except ValueError as error:
        return (*start, f"cannot be asked: {error}", claimed, "", "", "")
    return (*start, report.verdict, claimed, _order(report), _worst(report, entry), _checks(report))


def _order(report: Report) -> str:
    data = report.data
    for kind in ("order", "measured_order", "linear_order"):
        if kind == "order" and data[kind] is not None and data["order_fails"] is None:
            return f"{data[kind]} or more"
        if data[kind] is not None:
            return str(data[kind]) + {"order": "", "measured_order": " (measured)", "linear_order": " (linear)"}[kind]
    return "?"


def _worst(report: Report, entry: Entry) -> str:
    rounding = report.data["rounding"]
    if rounding is None:
        return ""
    if rounding["failing"] is not None:
        factor = float(rounding["failing"]["error_over_bound"])
        return f"beyond the bound, e.g. by a factor of {factor:.2g}: {_why(report, entry)}"
    return f"{float(rounding['largest_scaled_error']):.2g} u"


def _why(report: Report, entry: Entry) -> str:
    """Why a step is beyond the bound: what its source says, what it rounds besides, or where it is not linear."""
    if entry.rounds:
        return entry.rounds
    if report.data["rounding"]["but_for"]:
        return f"every error is within it {report.data['rounding']['but_for']}"
    broken = {check["key"]: check["words"] for check in report.data["checks"] if check["holds"] is False}
    return next((broken[key] for key in REASONS if key in broken), "not known")


def _checks(report: Report) -> str:
    faults = report.section("Faults")
    # How long was waited depends on the machine.
    return "passed" if faults is None else re.sub(r", no answer within [\d.]+ s", "", "; ".join(faults.lines))


def main(parts: Sequence[str]) -> None:
    """Ask those whose name contains one of the parts; without parts, those that have not been asked. Write the table.

    Each answer is kept as it comes, so that a run that was broken off goes on where it stopped; a package of another
    version is asked again.
    """
    if parts[:1] == ["--solvers"]:
        import_module("examples.gallery.solver_table").main(parts[1:])
        return
    entries = targets()
    rows = asked(lambda name: row(name, entries[name]), {x: e.package for x, e in entries.items()}, parts, KEPT)
    missing = [name for name in entries if name not in rows]
    TABLE.write_text(written([rows[name] for name in entries if name in rows], missing), encoding="utf-8")


def asked(
    row: Callable[[str], Sequence[str]], packages: Mapping[str, str], parts: Sequence[str], place: Path
) -> dict[str, Sequence[str]]:
    """The rows of all names whose packages are installed, those kept at the place among them, of these versions."""
    versions = {name: at for name, package in packages.items() if (at := installed(package)) is not None}
    kept: dict[str, Sequence[str]] = json.loads(place.read_text(encoding="utf-8")) if place.exists() else {}
    rows = {name: line for name, line in kept.items() if name in versions and line[1] == versions[name]}
    chosen = [name for name in versions if (any(part in name for part in parts) if parts else name not in rows)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for line in pool.map(row, chosen):
            print("  ".join(line), flush=True)
            rows[line[0]] = line
            place.parent.mkdir(exist_ok=True)
            place.write_text(json.dumps(rows), encoding="utf-8")
    return rows


def written(rows: Sequence[Sequence[str]], missing: Sequence[str]) -> str:
    """The table in Markdown, and which targets are not in it."""
    findings = FINDINGS.read_text(encoding="utf-8").strip()
    lines = ["# Steppers of other packages, identified from outside", "", HEADLINE, "", findings, ""]
    lines += ["## Every stepper", "", INTRODUCTION, ""]
    return (
        "\n".join(
            [*lines, markdown([HEAD, *rows]), f"Not asked: {', '.join(missing)}." if missing else "", ""]
        ).rstrip()
        + "\n"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
