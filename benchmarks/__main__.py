"""Every benchmark, beside every peer that is installed: python -m benchmarks (about twenty minutes)

Writes docs/benchmarks.md, and docs/peers.json, from which docs/differences.md takes what peers answer; `make bench`
runs it in an environment that has the peers. `python -m benchmarks NAME ...` prints what some of them find instead.
"""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import UTC, datetime
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from benchmarks import answers, peers, peers_time
from benchmarks.harness import LIMIT, ROUNDS, TURN, Section, goal_rows
from docs.pages import markdown
from driftproof.support.environment import machine_description, versions_of
from driftproof.support.plain_text import table

ROOT = Path(__file__).parents[1]
# In the order of the page; each is asked for so many rounds, and yields its tables as they are finished.
BENCHMARKS: dict[str, Callable[[int], Iterator[Section]]] = {
    name: import_module(f"benchmarks.{name}").sections
    for name in (
        *("exact_facts", "import_time", "commands", "roundoff", "engine", "ensembles"),
        *("stiff", "lines", "enclosure", "peers_time", "long_runs", "growth"),
    )
}
HOW = f"""\
Imports, commands, enclosures, ensembles to an error, stiff problems and lines are in processor seconds, of all threads,
everything else in seconds of the clock.
`ours` starts with every cache emptied, before each call; `ours, warm` with what the calls before have left. In a round
every contestant has one turn, in which a short task is repeated for {1000 * TURN:.0f} ms, so that a busy moment of the
machine meets all of them; one that has spent {LIMIT:g} s gets no further turn, so that a slow one may have a single
sample. The minimum is the estimate; the spread is the middle half of the samples, from end to end, over their median.
"Over ours" is the ratio of minima, above 1 where we are faster. Garbage is not collected meanwhile. What a contestant
answers is compared in the same run. Peers compute in floats where that is said."""

# What a reader of a table has to know, by its title; why a goal is missed is said here.
NOTES = {
    "Every fact": """\
`dop853` misses its goal: a quarter of its time goes into complex roots at two precisions, which a step of Newton's
method could refine, and another into the products of its stages, one number at a time.""",
    "Rounding bounds": """\
The bound of `dop853` is that of 329 operations on polynomials of some 150 terms with long coefficients, which is its
time.""",
    "Ensembles to a given error": """\
The worst of 10,000 systems, in processor seconds; ours and heyoka in one thread, each with its own best method or
tolerance.""",
    "Stiff problems": """\
Compiled Radau IIA of order 5 in controlled steps, solved to a hundredth of the tolerance with one matrix while it
converges, as SciPy's is in Python. numbalsoda is not here: there is no wheel of it, and its build asks for a Fortran
compiler. A first step of Radau IIA or Gauss on Robertson's problem by 10^9 is refused, and no damping can help: soon
y' = -k y^2 with k = 4.8e-4 is left of the problem, and for h k large the stages w / sqrt(h k) have A w^2 = 1, while
A^-1 1 has negative entries (2, -2 for Radau IIA of two stages): none is real. Controlled steps solve the problem.""",
    "Lines of neighbours": """\
The Brusselator with diffusion, two numbers at a place, in processor seconds: the band of the Jacobian is found in the
text. SciPy's rates are whole arrays of NumPy, and its LSODA is Fortran, told the band.""",
    "Growth": """\
Processor seconds; the exponent is that of least squares over the last three sizes, and may be 0.3 above the one on
paper.""",
}


def head(rounds: int) -> str:
    """What made the page, when, of what, on what."""
    fast = ("numba",) if find_spec("numba") else ()
    ours = [f"{name} {version(name)}" for name in ("numpy", "sympy", "python-flint", *fast)]
    theirs = [f"{name} {found}" for name, found in (peers.installed() | peers_time.installed()).items()]
    versions = f"{versions_of(())['python']}, {', '.join(ours)}; peers: {', '.join(theirs) or 'none'}"
    return (
        f"Made by `make bench` on {datetime.now(UTC):%Y-%m-%d} from commit {commit()}, {rounds} rounds.\n\n"
        f"* machine: {machine_description()}\n* versions: {versions}"
    )


def commit() -> str:
    """The commit, and whether the checkout differs from it."""

    def git(*arguments: str) -> str:
        return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    changed = ", changed" if git("--no-optional-locks", "status", "--porcelain") else ""
    return (git("rev-parse", "--short", "HEAD") or "unknown") + changed


def page(sections: Iterable[Section], counts: dict[str, Any], rounds: int) -> str:
    """docs/benchmarks.md."""
    sections = list(sections)
    goals = [goal for section in sections for goal in section.goals]
    missed = [goal.what for goal in goals if not goal.met]
    summary = f"{len(goals) - len(missed)} of {len(goals)} goals are met"
    summary += f"; missed: {'; '.join(missed)}." if missed else "."
    parts = ["# Benchmarks", head(rounds), "## Goals", summary, markdown(goal_rows(goals))]
    parts += ["## How it is measured", HOW]
    for section in sections:
        parts += [f"## {section.title}", *filter(None, [NOTES.get(section.title)]), markdown(section.rows)]
    parts += ["## Do peers answer the same?", agreement(counts)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


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
    """Measure what is named and print it, or measure everything and write both files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join(BENCHMARKS)}")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"turns of each contestant (default {ROUNDS})")
    chosen = parser.parse_args(arguments)
    for name in chosen.names:
        if name not in BENCHMARKS:
            parser.error(f"{name!r} is no benchmark; choose from {', '.join(BENCHMARKS)}")
        for section in BENCHMARKS[name](chosen.rounds):
            goals = [table(goal_rows(section.goals))] if section.goals else []
            print(section.title, table(section.rows), *goals, "", sep="\n\n", flush=True)
    if not chosen.names:
        sections = [section for benchmark in BENCHMARKS.values() for section in benchmark(chosen.rounds)]
        found = answers.answers()
        if found:
            (ROOT / "docs" / "peers.json").write_text(answers.as_json(found), encoding="utf-8")
        (ROOT / "docs" / "benchmarks.md").write_text(page(sections, found, chosen.rounds), encoding="utf-8")


if __name__ == "__main__":
    main()
