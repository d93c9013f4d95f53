"""What a user waits for: CPU time of whole commands, and of assert_verified in a test, each in a new process.

Processor time of the process and of those that it starts, Python's own start among it, so that a busy machine says
nothing; a round starts one process for each subject in turn, and the first round only warms the cache of files.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from benchmarks.harness import Goal, Section, milliseconds, spread_shown
from driftproof.numeric.work_precision.timing import Timing

ROOT = Path(__file__).parents[1]
# A stepper as a user writes it, and the longest method of the catalogue.
STEPPERS = """\
def rk4(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h / 2, y + h / 2 * k1)
    k3 = f(t + h / 2, y + h / 2 * k2)
    k4 = f(t + h, y + h * k3)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def ssprk40_2(f, t, y, h):
    u = y
    for i in range(39):
        u = u + h / 39 * f(t + i * h / 39, u)
    return y / 40 + 39 / 40 * (u + h / 39 * f(t + h, u))
"""
SHELL = [sys.executable, "-m", "driftproof"]
# What is started, and the most milliseconds that it should take.
SUBJECTS: dict[str, tuple[list[str], float | None]] = {
    "python -c pass": ([sys.executable, "-c", "pass"], None),
    "driftproof --version": ([*SHELL, "--version"], 80),
    "driftproof step rk4": ([*SHELL, "step", "rk4", "--h", "1/4"], 150),
    "driftproof value": ([*SHELL, "value", "energy_multiplier rk4 h=2"], 200),
    "driftproof run rk4": ([*SHELL, "run", "rk4", "--h", "1/4", "--t", "10"], 200),
    "driftproof roundoff rk4": ([*SHELL, "roundoff", "rk4", "--h", "1/4"], 200),
    "driftproof facts rk4": ([*SHELL, "facts", "rk4"], 200),
    "driftproof identify": ([*SHELL, "identify", "steppers:rk4"], 1000),
    "driftproof verify": ([*SHELL, "verify", "steppers:rk4", "--method", "rk4"], 1000),
    "driftproof verify, ssprk40_2": ([*SHELL, "verify", "steppers:ssprk40_2", "--method", "ssprk40_2"], 5000),
    "assert_verified, the first of a session": ([sys.executable, "-c", "{first}"], 1000),
    "assert_verified, every other": ([sys.executable, "-c", "{next}"], 400),
}
VERIFIED = "from driftproof import assert_verified; from steppers import rk4; " + "assert_verified(rk4, 'rk4'); "
CODE = {"{first}": VERIFIED, "{next}": VERIFIED + "assert_verified(rk4, 'rk4'); " * 4}


def cpu_seconds(command: list[str], folder: Path) -> float:
    """Of a process that ends well, and of all that it waited for; run in `folder`."""
    command = [CODE.get(word, word) for word in command]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        running = subprocess.Popen(command, cwd=folder, env=environment, stdout=nowhere)
        _, status, used = os.wait4(running.pid, 0)
        running.returncode = os.waitstatus_to_exitcode(status)
    if running.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with status {running.returncode}")
    return used.ru_utime + used.ru_stime


def section(taken: Mapping[str, Timing]) -> Section:
    """The table, and the goals."""
    rows = [["in a new process", "minimum", "median", "spread", "samples"]]
    rows += [[name, *spread_shown(times)] for name, times in taken.items()]
    goals = []
    for name, (_, most) in SUBJECTS.items():
        if most is not None:
            best = 1000 * taken[name].best
            goals.append(Goal(name, f"≤ {milliseconds(most)}", milliseconds(best), best <= most))
    return Section("Commands, CPU time", rows, goals)


def sections(rounds: int) -> Iterator[Section]:
    """The next assert_verified is a quarter of what four of them add to the first."""
    taken = {name: Timing() for name in SUBJECTS}
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "steppers.py").write_text(STEPPERS, encoding="utf-8")
        for number in range(rounds + 1):
            seconds = {name: cpu_seconds(command, Path(folder)) for name, (command, _) in SUBJECTS.items()}
            *_, first, following = seconds
            seconds[following] = (seconds[following] - seconds[first]) / 4
            if number:
                for name, value in seconds.items():
                    taken[name].samples.append(value)
    yield section(taken)
