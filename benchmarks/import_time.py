"""Import time of the float side, beside numpy's.

Fresh interpreters, timed from inside, so that the start of Python itself is not counted; a round starts one for each
subject in turn, so that a busy moment of the machine meets all of them.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from benchmarks.harness import Goal, Section, spread_shown
from driftproof.numeric.work_precision.timing import Timing

ROOT = Path(__file__).parents[1]
# The most that `import driftproof.numeric.run` may take, in imports of numpy.
MOST = 1.25
FLOATS, BASE = "import driftproof.numeric.run", "import numpy"
# What a new interpreter does.
SUBJECTS = {
    BASE: BASE,
    FLOATS: FLOATS,
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
TIMED = "import time\nstart = time.process_time()\n{code}\nprint(time.process_time() - start)"
LOADED = "import sys\nimport driftproof\nprint('sympy' in sys.modules)"


def new_interpreter(code: str) -> str:
    """What `code` prints in a new interpreter at the root."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60).stdout.strip()


def section(taken: Mapping[str, Timing], *, loads_sympy: bool) -> Section:
    """The table, and the goals: the float side against numpy, and no SymPy after `import driftproof`."""
    base = taken[BASE].best
    rows = [["in a new interpreter", "minimum", "median", "spread", "samples", "over numpy"]]
    rows += [[name, *spread_shown(times), f"{times.best / base:.2f}"] for name, times in taken.items()]
    ratio = taken[FLOATS].best / base
    goals = [
        Goal(f"{FLOATS} over {BASE}", f"≤ {MOST}", f"{ratio:.2f}", ratio <= MOST),
        Goal("import driftproof loads SymPy", "no", "yes" if loads_sympy else "no", not loads_sympy),
    ]
    return Section("Import", rows, goals)


def sections(rounds: int) -> Iterator[Section]:
    """Twice as many rounds, for files are read; one before them warms the cache of files and writes the bytecode."""
    taken = {name: Timing() for name in SUBJECTS}
    for number in range(2 * rounds + 1):
        for name, code in SUBJECTS.items():
            seconds = float(new_interpreter(TIMED.format(code=code)))
            if number:
                taken[name].samples.append(seconds)
    yield section(taken, loads_sympy=new_interpreter(LOADED) == "True")
