"""Import time of the float side and start of the command line, beside numpy's: python benchmarks/import_time.py

Fresh interpreters, timed from inside, so that the start of Python itself is not counted; a round starts one for each
subject in turn, so that a busy moment of the machine meets all of them.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

from benchmarks.timing import Goal, Section, Times, goal_rows, milliseconds, percent
from driftproof.support.plain_text import table

ROOT = Path(__file__).parents[1]
ROUNDS = 15
# The most that `import driftproof.numeric.run` may take, in imports of numpy.
MOST = 1.5

# Name -> what a new interpreter does.
SUBJECTS = {
    "import numpy": "import numpy",
    "import driftproof.numeric.run": "import driftproof.numeric.run",
    "all of numeric": "import "
    + ", ".join(
        f"driftproof.numeric.{path.stem}"
        for path in sorted((ROOT / "driftproof" / "numeric").glob("*.py"))
        if path.stem != "__init__"
    ),
    "import driftproof": "import driftproof",
    "driftproof --help": "import contextlib, io\nwith contextlib.redirect_stdout(io.StringIO()):\n    "
    "from driftproof.cli import main\n    with contextlib.suppress(SystemExit): main(['--help'])",
}
TIMED = "import time\nstart = time.perf_counter()\n{code}\nprint(1000 * (time.perf_counter() - start))"
LOADED = "import sys\n{code}\nprint('sympy' in sys.modules)"


def new_interpreter(code: str) -> str:
    """What `code` prints in a new interpreter at the root."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60).stdout.strip()


def milliseconds_of(code: str) -> float:
    """What `code` takes in a new interpreter."""
    return float(new_interpreter(TIMED.format(code=code)))


def measure(rounds: int) -> dict[str, list[float]]:
    """`rounds` timings of each subject, after one that warms the file cache and writes the bytecode."""
    for code in SUBJECTS.values():
        milliseconds_of(code)
    taken: dict[str, list[float]] = {name: [] for name in SUBJECTS}
    for _ in range(rounds):
        for name, code in SUBJECTS.items():
            taken[name].append(milliseconds_of(code))
    return taken


def section(taken: Mapping[str, Sequence[float]], *, loads_sympy: bool) -> Section:
    """The table, and the goals: driftproof.numeric.run against numpy, and no SymPy after `import driftproof`."""
    times = {name: Times(samples) for name, samples in taken.items()}
    base = times["import numpy"].best
    rows = [["in a new interpreter", "minimum", "median", "spread", "samples", "over numpy"]]
    for name, t in times.items():
        shown = (milliseconds(t.best), milliseconds(t.median), percent(t.spread), str(len(t.samples)))
        rows.append([name, *shown, f"{t.best / base:.2f}"])
    ratio = times["import driftproof.numeric.run"].best / base
    goals = [
        Goal("import driftproof.numeric.run over import numpy", f"≤ {MOST}", f"{ratio:.2f}", ratio <= MOST),
        Goal("import driftproof loads SymPy", "no", "yes" if loads_sympy else "no", not loads_sympy),
    ]
    return Section("Import", rows, goals)


def sections(rounds: int = ROUNDS) -> list[Section]:
    """Measured."""
    loads_sympy = new_interpreter(LOADED.format(code="import driftproof")) == "True"
    return [section(measure(rounds), loads_sympy=loads_sympy)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"interpreters a subject (default {ROUNDS})")
    for found in sections(parser.parse_args(arguments).rounds):
        print(table(found.rows), table(goal_rows(found.goals)), sep="\n\n")


if __name__ == "__main__":
    main()
