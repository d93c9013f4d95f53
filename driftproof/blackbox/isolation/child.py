"""The child's side of an experiment: open the stepper, run, and send each outcome; as a module, a fresh interpreter."""

from __future__ import annotations

import faulthandler
import os
import pickle
import sys
import traceback
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any

from driftproof.blackbox.findings import Misbehaviour, Outcome
from driftproof.blackbox.stepper.subject import Subject
from driftproof.blackbox.stepper.target import Target

Experiment = Callable[[Subject], Any]


def opens(subject: Subject) -> None:
    """The experiment that asks for nothing: it succeeds if the stepper can be imported and answers a first call."""


def serve(
    target: Target, experiments: Sequence[Experiment], send: Callable[[Outcome], None], log: Path | None = None
) -> None:
    """Send the outcome of each experiment, in order; the call about to be made stands in `log`.

    Warnings of the stepper's, as of overflow where that is what an experiment asks for, are not shown.
    """
    with open(log or os.devnull, "wb", buffering=0) as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            subject = target.open(lambda call: _note(file, call))
        except (Misbehaviour, ValueError) as error:
            for _ in experiments:
                send(_failure(error))
            return
        for experiment in experiments:
            send(_outcome(experiment, subject))


def serve_stream(target: Target, experiments: Sequence[Experiment], stream: IO[bytes], log: Path) -> None:
    """`serve` with outcomes pickled into a stream, an empty one first, and whatever the stepper prints thrown away."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(nowhere, descriptor)
    sys.stdout = sys.stderr = os.fdopen(nowhere, "w")  # a notebook's, or a test runner's, go elsewhere
    faulthandler.disable()

    def send(outcome: Outcome) -> None:
        pickle.dump(outcome, stream)
        stream.flush()

    send(Outcome())
    serve(target, experiments, send, log)


def _outcome(experiment: Experiment, subject: Subject) -> Outcome:
    try:
        return Outcome(experiment(subject))
    except (Misbehaviour, ValueError) as error:
        return _failure(error)
    except Exception as error:  # ours: the stepper's own exceptions come as Misbehaviour
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        return Outcome(kind="instrument_failed", seen=f"{type(error).__name__} in {where}: {error}; please report this")


def _failure(error: Exception) -> Outcome:
    return Outcome(kind=getattr(error, "kind", "bad_input"), seen=str(error))


def _note(file: IO[bytes], call: str) -> None:
    os.pwrite(file.fileno(), f"{call}\n".encode(), 0)


def main() -> None:
    """Read a pickled (target, experiments, log) from standard input and serve it on standard output."""
    output = os.fdopen(os.dup(1), "wb")
    target, experiments, log = pickle.load(sys.stdin.buffer)
    serve_stream(target, experiments, output, log)


if __name__ == "__main__":
    main()
