"""Experiments on foreign code in a child process with a time limit: there a hang or a crash is a finding, not ours."""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from abc import ABC, abstractmethod
from collections.abc import Container, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep
from typing import IO

from driftproof.blackbox.findings import Outcome
from driftproof.blackbox.isolation.child import Experiment, opens, serve, serve_stream
from driftproof.blackbox.stepper.target import Target

TIME_LIMIT = 60.0
# A brief experiment may take as many times as long as the longest one before it, and at least so many seconds: with the
# time in which other work holds the processors.
PATIENCE, LEAST_LIMIT = 4, 5.0
# Seconds in which a stepper that does not hang answers one call.
A_CALL = 1.0
# What a fresh interpreter may need to import this package, on a busy machine: no part of the time of an experiment.
START_UP = 60.0


@dataclass(frozen=True)
class Laboratory:
    """Runs experiments on one stepper, each within `time_limit` seconds.

    A stepper given by name runs in a fresh interpreter, its experiments and their results being picklable; one given
    as a callable in a fork of this process. With `isolate` false, or without forks, it runs here and nothing stops it.
    """

    target: Target
    time_limit: float = TIME_LIMIT
    isolate: bool = True

    def run(self, experiments: Sequence[Experiment], brief: Container[Experiment] = ()) -> list[Outcome]:
        """The outcome of each; after a hang or a crash the rest go on in a new child.

        A stepper that cannot even be opened is tried once: that outcome is the outcome of all. The `brief` experiments
        are those of a few steps: what they may take is known from the others, to import and open the stepper included.
        """
        asked, outcomes, clock = [opens, *experiments], list[Outcome](), _Clock(self.time_limit, brief)
        while len(outcomes) < len(asked):
            outcomes += self._some(asked[len(outcomes) :], clock)
            if outcomes[0].failed:
                return outcomes[:1] * len(experiments)
        return outcomes[1:]

    def _some(self, experiments: Sequence[Experiment], clock: _Clock) -> list[Outcome]:
        """The outcomes of the first few, at least of one: of all, or up to one that hung or crashed."""
        if not self.isolate or not (self.target.by_name or hasattr(os, "fork")):
            found: list[Outcome] = []
            serve(self.target, experiments, found.append)
            return found
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "last_call"
            log.touch()
            start = _Interpreter if self.target.by_name else _Fork
            child: _Child = start(self.target, experiments, log)
            return self._collected(child, experiments, log, clock)

    def _collected(self, child: _Child, asked: Sequence[Experiment], log: Path, clock: _Clock) -> list[Outcome]:
        frames: queue.Queue[Outcome | None] = queue.Queue()
        reader = threading.Thread(target=_read_frames, args=(child.stream, frames), daemon=True)
        reader.start()
        try:
            there, ended = _received(child, frames, START_UP, log)
            return [there] if ended else list(_answers(child, frames, asked, log, clock))
        finally:
            child.end()
            reader.join()  # before the next fork: a process with threads should not fork
            child.stream.close()


@dataclass
class _Clock:
    """What an experiment may take: `time_limit` seconds; or less, if it is brief, by the `longest` before it."""

    time_limit: float
    brief: Container[Experiment]
    longest: float = 0.0

    def limit_of(self, experiment: Experiment) -> float:
        """The seconds."""
        if experiment not in self.brief:
            return self.time_limit
        return min(self.time_limit, max(LEAST_LIMIT, PATIENCE * self.longest))


def _answers(
    child: _Child, frames: queue.Queue[Outcome | None], asked: Sequence[Experiment], log: Path, clock: _Clock
) -> Iterator[Outcome]:
    """The outcome of each experiment up to one that hung or crashed."""
    for experiment in asked:
        start = monotonic()
        outcome, ended = _received(child, frames, clock.limit_of(experiment), log)
        yield outcome
        if ended:
            return
        clock.longest = max(clock.longest, monotonic() - start)


def _received(child: _Child, frames: queue.Queue[Outcome | None], limit: float, log: Path) -> tuple[Outcome, bool]:
    """The next outcome, and whether it is the last, the child having hung or crashed.

    Where one call follows another the stepper does not hang: the question has too many for its pace.
    """
    try:
        outcome = frames.get(timeout=limit)
    except queue.Empty:
        call = _last_call(log)
        sleep(min(limit, A_CALL))
        if _last_call(log) != call:
            return Outcome(kind="slow", seen=f"too many steps for {limit:.3g} s, at the pace of the stepper"), True
        return Outcome(kind="hangs", seen=f"no answer within {limit:.3g} s{_last_call(log)}"), True
    if outcome is None:
        return Outcome(kind="crashes", seen=f"the process ended ({child.end()}){_last_call(log)}"), True
    return outcome, False


class _Child(ABC):
    """A process that sends pickled outcomes."""

    stream: IO[bytes]

    @abstractmethod
    def end(self) -> str:
        """Kill it if it still runs; how it ended, in words."""


class _Fork(_Child):
    """A fork of this process."""

    def __init__(self, target: Target, experiments: Sequence[Experiment], log: Path) -> None:
        """Fork; the child never returns from here."""
        readable, writable = os.pipe()
        with warnings.catch_warnings():  # of threads that some library of the caller's has running
            warnings.simplefilter("ignore")
            self._process = os.fork()
        if self._process == 0:
            os.setsid()
            status = 1
            with suppress(BaseException):
                serve_stream(target, experiments, os.fdopen(writable, "wb"), log)
                status = 0
            os._exit(status)
        os.close(writable)
        self.stream = os.fdopen(readable, "rb")
        self._end: str | None = None

    def end(self) -> str:
        """As `_Child` says."""
        if self._end is None:
            os.kill(self._process, signal.SIGKILL)
            _, status = os.waitpid(self._process, 0)  # of its own end, if that came first
            _end_its_own(self._process)
            self._end = _end_in_words(os.waitstatus_to_exitcode(status))
        return self._end


class _Interpreter(_Child):
    """A fresh interpreter, which imports the stepper by its name."""

    def __init__(self, target: Target, experiments: Sequence[Experiment], log: Path) -> None:
        """Start it, with the import path of this one."""
        command = [sys.executable, "-m", "driftproof.blackbox.isolation.child"]
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, [os.getcwd(), *sys.path])),
            "HYPOTHESIS_STORAGE_DIRECTORY": str(log.parent),  # or it leaves a folder where one works
        }
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, env=environment, start_new_session=True
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError), self._process.stdin as stdin:
            pickle.dump((target, list(experiments), log), stdin)
        self.stream = self._process.stdout

    def end(self) -> str:
        """As `_Child` says."""
        self._process.kill()
        status = self._process.wait()
        _end_its_own(self._process.pid)
        return _end_in_words(status)


def _end_its_own(process: int) -> None:
    """Kill the processes that a child has started: one that holds the pipe would keep the reader waiting."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError):
            os.killpg(process, signal.SIGKILL)


def _read_frames(stream: IO[bytes], frames: queue.Queue[Outcome | None]) -> None:
    """Hand on each outcome, and None at the end, whichever way it comes."""
    with suppress(EOFError, OSError, ValueError, pickle.UnpicklingError):
        while True:
            frames.put(pickle.load(stream))
    frames.put(None)


def _end_in_words(status: int) -> str:
    if status >= 0:
        return f"exit status {status}"
    return f"signal {-status}, {signal.Signals(-status).name}"


def _last_call(log: Path) -> str:
    text = log.read_bytes().decode(errors="replace").partition("\n")[0]
    return f" in step({text})" if text else " while the stepper was imported"
