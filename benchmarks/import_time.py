"""Import time of the float side and start of the command line, against `import numpy`: python benchmarks/import_time.py

Fresh interpreters, interleaved so that a busy moment of the machine meets all of them; the minimum is the estimate, the
median says how noisy the machine was. The goal of the project: `import numeric.run` takes at most 1.5 times numpy.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
GOAL = 1.5

# Name -> what a new interpreter does, timed from inside so that the start of Python itself is not counted.
SUBJECTS = {
    "import numpy": "import numpy",
    "import numeric.run": "import numeric.run",
    "all of numeric": "import "
    + ", ".join(f"numeric.{path.stem}" for path in sorted((ROOT / "numeric").glob("*.py")) if path.stem != "__init__"),
    "import driftproof": "import driftproof",
    "driftproof --help": "import contextlib, io\nwith contextlib.redirect_stdout(io.StringIO()):\n    "
    "from driftproof.cli import main\n    with contextlib.suppress(SystemExit): main(['--help'])",
}
TIMED = "import time\nstart = time.perf_counter()\n{code}\nprint(time.perf_counter() - start)"


def seconds(code: str) -> float:
    """What `code` takes in a new interpreter."""
    command = [sys.executable, "-c", TIMED.format(code=code)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60)
    return float(done.stdout)


def measure(rounds: int) -> dict[str, list[float]]:
    """`rounds` timings of each subject, after one that warms the file cache and writes the bytecode."""
    for code in SUBJECTS.values():
        seconds(code)
    taken: dict[str, list[float]] = {name: [] for name in SUBJECTS}
    for _ in range(rounds):
        for name, code in SUBJECTS.items():
            taken[name].append(seconds(code))
    return taken


def report(taken: dict[str, list[float]]) -> str:
    """A table of minimum and median in milliseconds, with the ratio to numpy, and a verdict on the goal."""
    base = min(taken["import numpy"]), statistics.median(taken["import numpy"])
    lines = [f"{'':20}{'min ms':>9}{'median ms':>12}{'min/numpy':>12}{'median/numpy':>15}"]
    for name, times in taken.items():
        least, middle = min(times), statistics.median(times)
        lines.append(f"{name:20}{1e3 * least:9.1f}{1e3 * middle:12.1f}{least / base[0]:12.2f}{middle / base[1]:15.2f}")
    ratio = min(taken["import numeric.run"]) / base[0]
    verdict = "reached" if ratio <= GOAL else "missed"
    lines.append(f"\ngoal: import numeric.run <= {GOAL} numpy: {ratio:.2f}, {verdict}")
    rounds = len(taken["import numpy"])
    return "\n".join([*lines, f"{rounds} rounds, Python {platform.python_version()}, {platform.machine()}"])


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15, help="interpreters started per subject (default 15)")
    print(report(measure(parser.parse_args(arguments).rounds)))


if __name__ == "__main__":
    main()
