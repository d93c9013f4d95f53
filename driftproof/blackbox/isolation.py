"""Probes of foreign code in an isolated process with limits: there a hang or a crash is a finding, not ours."""

from __future__ import annotations

import base64
import os
import pickle
import tempfile
import traceback
import warnings
from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic, sleep
from typing import Any

from driftproof.blackbox.findings import Misbehaviour, Outcome
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import Target
from driftproof.support.messages import MessageError, decode, encode
from driftproof.support.processes import Limits, ProcessEnded, Session

Probe = Callable[[ForeignStepper], Any]
# Seconds for one probe: a step of a simulator takes milliseconds, and a probe some hundred steps.
TIME_LIMIT = 60.0
# In bytes, beyond what the process has at its start: no stepper of three numbers needs it, and most machines have it.
MEMORY_LIMIT = 8 * 2**30
# A brief probe may take as many times as long as the longest one before it, and at least so many seconds: with the
# time in which other work holds the processors.
PATIENCE, LEAST_LIMIT = 4, 5.0
# Seconds in which a stepper that does not hang answers one call.
A_CALL = 1.0


def opens(subject: ForeignStepper) -> None:
    """The probe that asks for nothing: it succeeds if the stepper can be imported and answers a first call."""


@dataclass(frozen=True)
class IsolatedRunner:
    """Runs probes on one stepper, each within `time_limit` seconds.

    A stepper given by name runs in a fresh interpreter, its probes being picklable; one given as a callable in a fork
    of this process. With `isolate` false, or where a system cannot fork, it runs here and nothing stops it.
    """

    target: Target
    time_limit: float = TIME_LIMIT
    isolate: bool = True

    def run(self, probes: Sequence[Probe], brief: Container[Probe] = ()) -> list[Outcome]:
        """The outcome of each; after a hang or a crash the rest go on in a new process.

        A stepper that cannot even be opened is tried once: that outcome is the outcome of all. The `brief` probes are
        those of a few steps: what they may take is known from the others, to import and open the stepper included.
        """
        asked, outcomes, longest = [opens, *probes], list[Outcome](), 0.0
        while len(outcomes) < len(asked):
            for outcome, seconds in self._some(asked[len(outcomes) :], brief, longest):
                longest = max(longest, seconds)
                outcomes.append(outcome)
            if outcomes[0].failed:
                return outcomes[:1] * len(probes)
        return outcomes[1:]

    def _some(
        self, probes: Sequence[Probe], brief: Container[Probe], longest: float
    ) -> Iterator[tuple[Outcome, float]]:
        """The outcomes of the first few, at least of one, and their seconds: of all, or up to a hang or a crash."""
        if not self.isolate or not hasattr(os, "fork"):
            serving = Serving(self.target, probes)
            yield from ((serving.outcome(i), 0.0) for i in range(len(probes)))
            return
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "last_call"
            log.touch()
            limit = self.time_limit
            with self._session(probes, log) as session:
                try:
                    if self.target.by_name:
                        session.ask(base64.b64encode(pickle.dumps((self.target, list(probes), log))).decode())
                    for i, probe in enumerate(probes):
                        brief_limit = max(LEAST_LIMIT, PATIENCE * longest)
                        limit = min(self.time_limit, brief_limit) if probe in brief else self.time_limit
                        start = monotonic()
                        outcome = decode(session.ask(i, limit), "driftproof")
                        seconds = monotonic() - start
                        longest = max(longest, seconds)
                        yield outcome, seconds
                except ProcessEnded as ended:
                    yield _of_end(ended, limit, log), 0.0
                except MessageError as error:
                    yield Outcome(kind="crashes", seen=f"{error}: something else wrote into our pipe"), 0.0

    def _session(self, probes: Sequence[Probe], log: Path) -> Session:
        limits = Limits(self.time_limit, memory=MEMORY_LIMIT)
        if not self.target.by_name:
            return Session(Serving(self.target, probes, log), limits)
        # Hypothesis would leave a folder where one works.
        environment = {**os.environ, "HYPOTHESIS_STORAGE_DIRECTORY": str(log.parent)}
        return Session(f"{__name__}:answer_probe", limits, environment=environment)


def _of_end(ended: ProcessEnded, limit: float, log: Path) -> Outcome:
    """What came of a probe whose process gave no answer.

    Where one call follows another the stepper does not hang: the probe has too many for its pace.
    """
    call = _last_call(log)
    if ended.cause != "time":
        return Outcome(kind="crashes", seen=f"{ended}{call}")
    sleep(min(limit, A_CALL))
    if _last_call(log) != call:
        return Outcome(kind="slow", seen=f"too many steps for {limit:.3g} s, at the pace of the stepper")
    return Outcome(kind="hangs", seen=f"{ended}{call}")


def _last_call(log: Path) -> str:
    text = log.read_bytes().decode(errors="replace").partition("\n")[0]
    return f" in step({text})" if text else " while the stepper was imported"


@dataclass
class Serving:
    """The far side: opens the stepper at the first request and answers each by the outcome of one probe, as text.

    The call about to be made stands in the file `log`, if there is one.
    """

    target: Target
    probes: Sequence[Probe]
    log: Path | None = None
    _opened: ForeignStepper | Outcome | None = field(default=None, init=False)

    def __call__(self, index: int) -> str:
        """The outcome of one probe, encoded."""
        return encode(self.outcome(index))

    def outcome(self, index: int) -> Outcome:
        """The outcome of one probe; warnings of the stepper's, as of overflow, are not shown."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if self._opened is None:
                try:
                    self._opened = self.target.open(self._noter())
                except (Misbehaviour, ValueError) as error:
                    self._opened = _failure(error)
            return self._opened if isinstance(self._opened, Outcome) else _outcome(self.probes[index], self._opened)

    def _noter(self) -> Callable[[str], None]:
        if self.log is None:
            return lambda call: None
        file = os.open(self.log, os.O_WRONLY)
        return lambda call: (os.pwrite(file, f"{call}\n".encode(), 0), None)[1]


_serving: list[Serving] = []


def answer_probe(request: str | int) -> str | None:
    """In a fresh interpreter: what is to be served, as `IsolatedRunner` pickled it, then the probes by their number."""
    if isinstance(request, str):
        _serving.append(Serving(*pickle.loads(base64.b64decode(request))))
        return None
    return _serving[-1](request)


def _outcome(probe: Probe, subject: ForeignStepper) -> Outcome:
    try:
        return Outcome(probe(subject))
    except (Misbehaviour, ValueError) as error:
        return _failure(error)
    except Exception as error:  # ours: the stepper's own exceptions come as Misbehaviour
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        return Outcome(kind="instrument_failed", seen=f"{type(error).__name__} in {where}: {error}; please report this")


def _failure(error: Exception) -> Outcome:
    return Outcome(kind=getattr(error, "kind", "bad_input"), seen=str(error))
