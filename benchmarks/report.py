"""The whole report, beside every peer that is installed: python benchmarks/report.py (about a quarter of an hour)

Writes docs/benchmarks.md, and docs/peers.json, from which docs/differences.md takes what peers answer. `make bench`
runs it in an environment that has the peers.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

from benchmarks import answers, engine, facts, import_time, long_runs, order, peers, peers_time, roundoff, stability
from benchmarks.timing import LIMIT, ROUNDS, TURN, Goal, Row, Section, goal_rows, times_rows
from docs.pages import markdown
from driftproof.support.environment import machine_description, versions_of

ROOT = Path(__file__).parents[1]
TIMED = {
    "Trees and orders": order.rows,
    "Stability": stability.rows,
    "Every fact": facts.rows,
    "Rounding bounds": roundoff.rows,
}
HOW = f"""\
`ours` starts with every cache emptied, before each call; `ours, warm` with what the calls before have left. In a round
every contestant has one turn, in which a short task is repeated for {1000 * TURN:.0f} ms, so that a busy moment of the
machine meets all of them; one that has spent {LIMIT:g} s gets no further turn, so that a slow one may have a single
sample. The minimum is the estimate; the spread is the middle half of the samples, from end to end, over their median.
"Over ours" is the ratio of minima, above 1 where we are faster. Garbage is not collected meanwhile. What a contestant
answers is compared in the same run. Peers compute in floats where that is said."""


def versions() -> str:
    """Of Python, of what we build on and of the peers."""
    fast = ("numba",) if find_spec("numba") else ()
    ours = [f"{name} {version(name)}" for name in ("numpy", "sympy", "python-flint", *fast)]
    theirs = [f"{name} {found}" for name, found in (peers.installed() | peers_time.installed()).items()]
    return f"{versions_of(())['python']}, {', '.join(ours)}; peers: {', '.join(theirs) or 'none'}"


def commit() -> str:
    """The commit, and whether the checkout differs from it."""

    def git(*arguments: str) -> str:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
        return done.stdout.strip()

    return (git("rev-parse", "--short", "HEAD") or "unknown") + (
        ", changed" if git("--no-optional-locks", "status", "--porcelain") else ""
    )


def page(timed: dict[str, list[Row]], sections: Sequence[Section], counts: dict[str, Any], rounds: int) -> str:
    """docs/benchmarks.md."""
    goals = [goal for found in timed.values() for row in found for goal in row.goals()]
    goals += [goal for section in sections for goal in section.goals]
    parts = ["# Benchmarks", head(rounds), "## Goals", summary(goals), markdown(goal_rows(goals))]
    parts += ["## How it is measured", HOW]
    for title, found in timed.items():
        parts += [f"## {title}", markdown(times_rows(found))]
    for section in sections:
        parts += [f"## {section.title}", markdown(section.rows)]
    parts += ["## Do peers answer the same?", agreement(counts)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def head(rounds: int) -> str:
    """What made the page, when, of what, on what."""
    at = datetime.now(UTC).strftime("%Y-%m-%d")
    return (
        f"Made by `make bench` on {at} from commit {commit()}, {rounds} rounds.\n\n"
        f"* machine: {machine_description()}\n* versions: {versions()}"
    )


def summary(goals: Sequence[Goal]) -> str:
    """How many are met, and which are not."""
    missed = [goal.what for goal in goals if not goal.met]
    return f"{len(goals) - len(missed)} of {len(goals)} goals are met" + (
        f"; missed: {'; '.join(missed)}." if missed else "."
    )


def agreement(counts: dict[str, Any]) -> str:
    """The number of answers that are ours, and that are not, by peer."""
    if not counts:
        return "No peer was installed."
    rows = [["peer", "answers", "not ours", "no answer"]]
    for name, peer in counts.items():
        seen = list(peer["facts"].values())
        differs, silent = (sum(len(fact[kind]) for fact in seen) for kind in ("differs", "silent"))
        total = sum(fact["agree"] for fact in seen) + differs
        rows.append([f"{name} {peer['version']}", str(total), str(differs), str(silent)])
    return (
        f"{markdown(rows)}\n[differences.md](differences.md) shows each answer that is not ours, and says who is right."
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure everything, and write both files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"turns of each contestant (default {ROUNDS})")
    chosen = parser.parse_args(arguments)
    timed = {title: measure(chosen.rounds) for title, measure in TIMED.items()}
    sections = [*import_time.sections(), *roundoff.sections(), engine.section(chosen.rounds)]
    sections += [*peers_time.sections(chosen.rounds), *long_runs.sections()]
    found = answers.answers()
    if found:
        (ROOT / "docs" / "peers.json").write_text(answers.as_json(found), encoding="utf-8")
    (ROOT / "docs" / "benchmarks.md").write_text(page(timed, sections, found, chosen.rounds), encoding="utf-8")


if __name__ == "__main__":
    main()
