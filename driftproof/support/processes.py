"""Code that may hang, crash or hoard memory, run in a process of its own with limits of time and memory.

A `Session` starts a supervisor (see `supervisor`), which forks the worker. The worker answers requests, one at a time,
and its output is discarded. Messages are JSON on pipes: nothing that comes from the worker is executed here. This
protects from accidents. It is no sandbox: the worker has the rights of the user.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

from driftproof.support import supervisor
from driftproof.support.plain_text import Json
from driftproof.support.supervisor import LAST_ROUND, Ends, Handler, ready, supervise

# Seconds in which a fresh interpreter can import this package even on a busy machine; no answer is charged with them.
START_UP = 60.0
# A process that failed after using more than this fraction of its memory limit is reported to have reached the limit:
# the kernel refuses a whole block, which is large for an array, so that the last tenth may never have been in use.
_NEARLY_ALL = 0.9


@dataclass(frozen=True)
class Limits:
    """The limits of a worker: seconds per answer, and bytes of memory, of an answer and of a file.

    Memory is private data (on Linux also in mappings) beyond that of the worker at its start.
    """

    seconds: float = 60.0
    memory: int | None = None
    answer: int = 2**26
    file: int | None = None


class ProcessEnded(Exception):
    """A request has no answer; `cause` is one of time, memory, exit, signal, killed, raised and answer.

    The message adds the numbers: "no answer within 10 s", "the process ended (signal 11, SIGSEGV)".
    """

    def __init__(self, cause: str, words: str) -> None:
        super().__init__(words)
        self.cause = cause


def ask_once(handler: str | Handler, request: Json, limits: Limits, **conditions: Any) -> Json:
    """The answer to one request, from a worker that is started for it. Raises ProcessEnded.

    >>> ask_once("math:sqrt", 2.25, Limits(seconds=30))
    1.5
    """
    with Session(handler, limits, **conditions) as session:
        return session.ask(request)


class Session:
    """A worker that answers requests: `with Session("package.module:function", limits) as session: session.ask(...)`.

    `handler` returns the answer to a request, both JSON. A callable runs in a fork of this process. A name is imported
    in a fresh interpreter, with the import `path`, `environment` and working `folder` that are given or else those of
    this process; driftproof itself is loaded from where it is now, whatever the path holds.
    """

    def __init__(
        self,
        handler: str | Handler,
        limits: Limits,
        *,
        environment: Mapping[str, str] | None = None,
        folder: str | Path | None = None,
        path: Iterable[str] | None = None,
    ) -> None:
        """Start the worker. Raises OSError if the system cannot fork a process."""
        if not hasattr(os, "fork"):
            raise OSError("this system cannot fork a process")
        self.limits = limits
        self._buffer, self._status = b"", dict[str, int]()
        self._requests, self._answers, self._control = os.pipe(), os.pipe(), socket.socketpair()
        theirs = Ends(self._requests[0], self._answers[1], self._control[1].fileno())
        try:
            if isinstance(handler, str):
                self._pid, self._wait = _spawned(theirs, environment, folder)
                found = [os.getcwd(), *sys.path] if path is None else path
                self._send({"handler": handler, "path": [entry or os.getcwd() for entry in found]})
            else:
                self._pid, self._wait = self._forked(theirs, handler)
        finally:
            for end in theirs[:2]:
                os.close(end)
            self._control[1].close()
        self._send({"memory": limits.memory, "file": limits.file})
        self._started = False

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def ask(self, request: Json, seconds: float | None = None) -> Json:
        """The answer to the request, within `seconds` or else the limit. Raises ProcessEnded; then ask nothing more.

        After a timeout the worker still runs, until `end`, and `wait` goes on waiting for the answer.
        """
        if not self._started:
            self.wait(START_UP)
            self._started = True
        self._send(request)
        return self.wait(self.limits.seconds if seconds is None else seconds)

    def wait(self, seconds: float) -> Json:
        """The answer to the last request, within `seconds` from now. Raises ProcessEnded."""
        message = self._received(seconds)
        if "answer" in message:
            return message["answer"]
        cause = "memory" if message.get("memory") else "raised"
        words = self._memory_words() if cause == "memory" else str(message.get("raised"))
        raise ProcessEnded(cause, words)

    def end(self) -> str:
        """Kill the worker and every process that it started; return how it ended, as a text."""
        if self._pid:
            with suppress(OSError):
                self._control[0].shutdown(socket.SHUT_WR)
            self._wait_for_status()
            with suppress(ProcessLookupError):
                os.kill(self._pid, signal.SIGKILL)  # the supervisor, whose work is done
            self._wait()
            self._pid = 0
            for end in (self._requests[1], self._answers[0]):
                os.close(end)
            self._control[0].close()
        return str(self._cause())

    def _forked(self, theirs: Ends, handler: Handler) -> tuple[int, Callable[[], object]]:
        with warnings.catch_warnings():  # about threads that some library of the caller has started
            warnings.simplefilter("ignore")
            pid = os.fork()
        if pid == 0:
            with suppress(BaseException):
                for end in (self._requests[1], self._answers[0]):
                    os.close(end)
                self._control[0].close()
                os.setsid()
                supervise(theirs, handler)
            os._exit(1)
        return pid, partial(os.waitpid, pid, 0)

    def _send(self, message: Json) -> None:
        """Write the message. A worker that does not read it is noticed later, when no answer comes."""
        rest = memoryview(f"{json.dumps(message)}\n".encode())
        os.set_blocking(self._requests[1], False)
        limit = monotonic() + START_UP
        with suppress(BrokenPipeError):
            while rest and ready(limit - monotonic(), writable=self._requests[1]):
                rest = rest[os.write(self._requests[1], rest) :]

    def _received(self, seconds: float) -> dict[str, Json]:
        """The next message of the worker, a JSON object in one line. Raises ProcessEnded."""
        answers, control, limit = self._answers[0], self._control[0].fileno(), monotonic() + seconds
        line, end, self._buffer = self._buffer.partition(b"\n")
        blocks, watched = [line], [answers, control]
        while not end:
            there = ready(limit - monotonic(), *watched)
            if answers in there:
                block, end, self._buffer = os.read(answers, 2**20).partition(b"\n")
                blocks.append(block)
                if not (block or end):  # closed: the worker has ended, or its code closed the pipe
                    watched = [control]
                if sum(map(len, blocks)) > self.limits.answer:
                    raise ProcessEnded("answer", f"an answer of more than {self.limits.answer} bytes")
            elif there:
                self._wait_for_status()
                raise self._cause()
            else:
                self._buffer = b"".join(blocks)
                raise ProcessEnded("time", f"no answer within {seconds:.3g} s")
        with suppress(ValueError, RecursionError):
            message = json.loads(b"".join(blocks))
            if isinstance(message, dict):
                return message
        raise ProcessEnded("answer", "an invalid answer: the code wrote into the pipe to its caller")

    def _wait_for_status(self) -> None:
        """Receive the status that the supervisor sends when it ends; it stays empty if the supervisor was killed."""
        text, limit, control = b"", monotonic() + 2 * LAST_ROUND, self._control[0]
        while not self._status and ready(limit - monotonic(), control.fileno()):
            with suppress(ConnectionError):
                if block := control.recv(2**12):
                    text += block
                    continue
            break
        with suppress(ValueError):
            self._status = self._status or json.loads(text)

    def _cause(self) -> ProcessEnded:
        """How the worker ended, by the status of the supervisor and the limits."""
        if not self._status:
            return ProcessEnded("killed", "the process ended (its supervisor is gone)")
        code, peak, limits = self._status["code"], self._status["peak"], self.limits
        if limits.memory is not None and code and peak > _NEARLY_ALL * limits.memory:
            return ProcessEnded("memory", self._memory_words())
        if code >= 0:
            return ProcessEnded("exit", f"the process ended (exit status {code})")
        cause = "killed" if -code in (signal.SIGKILL, signal.SIGTERM) else "signal"  # killed: by another process
        return ProcessEnded(cause, f"the process ended (signal {-code}, {signal.Signals(-code).name})")

    def _memory_words(self) -> str:
        return f"more than {self.limits.memory or 0:.3g} bytes of memory"


def _spawned(
    theirs: Ends, environment: Mapping[str, str] | None, folder: str | Path | None
) -> tuple[int, Callable[[], object]]:
    process = subprocess.Popen(
        [sys.executable, "-P", "-X", "utf8", supervisor.__file__, *map(str, theirs)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=None if environment is None else dict(environment),
        cwd=folder,
        pass_fds=theirs,
        start_new_session=True,
    )
    return process.pid, process.wait
