"""The table docs/gallery_solvers.md: what `identify_solver` finds in the whole solvers of other people's packages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from docs.pages import markdown
from driftproof.blackbox.solvers.identify_solver import identify_solver
from driftproof.methods.catalogue import METHODS
from examples.gallery.run import HERE, KEPT, asked, installed
from examples.gallery.whole_solvers import PACKAGES

PAGE = HERE.parents[1] / "docs" / "gallery_solvers.md"
FINDINGS = HERE / "solver_findings.md"
ANSWERS = KEPT.with_name("gallery_solvers.json")
HEAD = ("solver", "version", "claimed order", "its steps", "order", "its step sizes", "what else")
TIME_LIMIT = 120.0
INTRODUCTION = """\
Made by `make gallery`: whole solvers, asked by `identify_solver` without being told what they are, each through the
wrapper in `examples/gallery/whole_solvers.py` that hands over the steps it makes. Named are the method of these
steps, the law of their sizes where that is one law in the pair's own estimate, and what nobody expects. Where the steps
are not read, the reason stands in their place: implicit stages of solvers that choose their steps, as a rule.
A solver is called as its package calls it; those with `_fixed` are told how many steps to make, or how long ones.
What stands in the last column is seen in these questions alone, and may be the doing of how its loop is meant to be
used: PathSim's `integrate`, for its own tests, goes on after the end."""
SEEN_TWICE = """\
Seen once more by plain convergence runs without driftproof, `examples/gallery/convergence.py --solvers`: `promised` is
the order by the package's own words, `seen` the slope of the last errors."""


def solvers() -> dict[str, tuple[str, str, int | None]]:
    """Of every solver its path below `whole_solvers`, its package, and the order that this claims."""
    return {
        f"{group} {method}": (f"{group}.{method}", package.name, order)
        for group, package in PACKAGES.items()
        for method, order in package.methods.items()
    }


def row(name: str) -> tuple[str, ...]:
    """The line of the table on one solver."""
    path, package, order = solvers()[name]
    start = (name, installed(package) or "", "" if order is None else str(order))
    try:
        report = identify_solver(f"examples.gallery.whole_solvers:{path}", time_limit=TIME_LIMIT)
    except ValueError as error:
        return (*start, f"cannot be asked: {error}", "", "", "")
    return (*start, *findings(report.data))


def findings(data: Mapping[str, Any]) -> tuple[str, str, str, str]:
    """What a report says, in four cells."""
    steps, controller, unread = data["steps"], data["controller"], data["not_answered"]
    refusal = next((each["seen"] for each in unread), "no answer").partition("; ")[0]
    name = f"not read: {refusal}" if steps is None else steps["name"]
    order = "" if steps is None or steps["order"] is None else str(steps["order"])
    law = controller[0].removeprefix("measured: ") if controller else ""
    return name, order, law, "; ".join([*data["faults"], *data["remarks"]])


def written(rows: Sequence[Sequence[str]]) -> str:
    """The page in Markdown, its first sentences counted."""
    pairs = [cells for cells in rows if getattr(METHODS.get(cells[3]), "b_embedded", None) is not None]
    read = [cells for cells in rows if not cells[3].startswith(("not read", "cannot"))]
    laws = [cells for cells in pairs if cells[5].startswith("h_next")]
    packages = {cells[0].split()[0].partition("_")[0] for cells in rows}
    count = (
        f"{len(rows)} solvers of {len(packages)} packages. The steps of {len(read)} are named, or their order is; "
        f"{len(pairs)} advance a pair of the catalogue, and of {len(laws)} of these the step size control is a law."
    )
    title = "# Whole solvers of other packages, identified from outside"
    twice = FINDINGS.read_text(encoding="utf-8").strip()
    lines = [title, "", count, "", SEEN_TWICE, "", twice, "", "## Every solver", "", INTRODUCTION, ""]
    return "\n".join([*lines, markdown([HEAD, *rows])])


def main(parts: Sequence[str]) -> None:
    """Ask those whose name contains one of the parts; without parts, those that have not been asked; write the page."""
    packages = {name: package for name, (_, package, _) in solvers().items()}
    rows = asked(row, packages, parts, ANSWERS)
    PAGE.write_text(written([rows[name] for name in packages if name in rows]), encoding="utf-8")
