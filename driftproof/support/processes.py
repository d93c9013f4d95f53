"""Code that may hang, crash or hoard, in a process of its own: limits of time and memory, and nothing left behind.

A `Session` starts a supervisor (see `supervisor`), which forks the worker. The worker answers requests, one at a time,
and what it prints goes nowhere. Messages are JSON on pipes: nothing that comes from the worker is executed here. This
is protection from accidents. It is no sandbox: the worker has the rights of the user.
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

# What a fresh interpreter may need to import this package on a busy machine: no part of the time of an answer.
START_UP = 60.0
# From this part of its limit on, a process that was killed is said to have reached it: the kernel refuses the next
# block, which for arrays is large, so that the last tenth may never have been in use.
_NEARLY_ALL = 0.9


@dataclass(frozen=True)
class Limits:
    """What a worker may take: seconds an answer, by the clock and of the processor; bytes of memory, answers and files.

    The memory is private data (on Linux also that of mappings) beyond what the worker has when it starts.
    """

    seconds: float = 60.0
    processor_seconds: float | None = None
    memory: int | None = None
    answer: int = 2**26
    file: int | None = None


class ProcessEnded(Exception):
    """There is no answer; `cause` is one of time, processor, memory, exit, signal, killed, raised and answer.

    The message says the same with its numbers: "no answer within 10 s", "the process ended (signal 11, SIGSEGV)".
    """

    def __init__(self, cause: str, words: str) -> None:
        """The cause in one word, and the message."""
        super().__init__(words)
        self.cause = cause


def ask_once(handler: str | Handler, request: Json, limits: Limits, **conditions: Any) -> Json:
    """The answer to one request, in a process that ends with it. Raises ProcessEnded.

    >>> ask_once("math:sqrt", 2.25, Limits(seconds=30))
    1.5
    """
    with Session(handler, limits, **conditions) as session:
        return session.ask(request)


class Session:
    """A worker and its requests: `with Session("package.module:function", limits) as session: session.ask(...)`.

    `handler` makes an answer of a request, both JSON. By its name it is imported by a fresh interpreter, whose import
    path is the `path` (this process's, if it is not given) and which finds our own package before anything else of its
    name; a callable is called in a fork of this process, with all that it knows. `environment` and `folder` are those
    of a fresh interpreter, where they are not this process's.
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
        """Start it. Raises OSError where the system has no processes to fork."""
        if not hasattr(os, "fork"):
            raise OSError("this system cannot fork a process")
        self.limits = limits
        self._buffer, self._status = b"", dict[str, int]()
        self._requests, self._answers, self._control = os.pipe(), os.pipe(), socket.socketpair()
        theirs = Ends(self._requests[0], self._answers[1], self._control[1].fileno())
        try:
            if isinstance(handler, str):
                self._pid, self._wait = _spawned(theirs, environment, folder)
                self._send({"handler": handler, "path": _path(path)})
            else:
                self._pid, self._wait = self._forked(theirs, handler)
        finally:
            for end in theirs[:2]:
                os.close(end)
            self._control[1].close()
        self._send({"memory": limits.memory, "processor": limits.processor_seconds, "file": limits.file})
        self._started = False

    def __enter__(self) -> Session:
        """The session itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self.end()

    def ask(self, request: Json, seconds: float | None = None) -> Json:
        """The answer, within `seconds` if they are given. Raises ProcessEnded; then nothing more can be asked.

        After a lapse of time the worker still runs, until `end`, and `wait` goes on.
        """
        if not self._started:
            self.wait(START_UP)
            self._started = True
        self._send(request)
        return self.wait(self.limits.seconds if seconds is None else seconds)

    def wait(self, seconds: float) -> Json:
        """The answer to what was asked before, within so many more seconds. Raises ProcessEnded."""
        message = self._received(seconds)
        if "answer" in message:
            return message["answer"]
        cause = "memory" if message.get("memory") else "raised"
        words = self._memory_words() if cause == "memory" else str(message.get("raised"))
        raise ProcessEnded(cause, words)

    def end(self) -> str:
        """Kill the worker and what came of it; how it ended, in words."""
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
        with warnings.catch_warnings():  # of threads that some library of the caller's has running
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
        """Write all of it, as far as somebody reads; who does not is noticed when no answer comes."""
        rest = memoryview(f"{json.dumps(message)}\n".encode())
        os.set_blocking(self._requests[1], False)
        limit = monotonic() + START_UP
        with suppress(BrokenPipeError):
            while rest and monotonic() < limit:
                if ready(START_UP, writable=self._requests[1]):
                    rest = rest[os.write(self._requests[1], rest) :]

    def _received(self, seconds: float) -> dict[str, Json]:
        """The next message of the worker's: one line, a JSON object. Raises ProcessEnded."""
        answers, control, limit = self._answers[0], self._control[0].fileno(), monotonic() + seconds
        line, end, self._buffer = self._buffer.partition(b"\n")
        blocks, watched = [line], [answers, control]
        while not end:
            there = ready(limit - monotonic(), *watched)
            if answers in there:
                block, end, self._buffer = os.read(answers, 2**20).partition(b"\n")
                blocks.append(block)
                if not (block or end):  # closed, by its end or by a worker that closes what it finds
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
        """What the supervisor tells at its end, empty if it was killed itself."""
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
        """How the worker ended of itself."""
        if not self._status:
            return ProcessEnded("killed", "the process ended (its supervisor is gone)")
        code, peak, limits = self._status["code"], self._status["peak"], self.limits
        if code == -signal.SIGXCPU:
            return ProcessEnded("processor", f"more than {limits.processor_seconds:.3g} s of processor time")
        if limits.memory is not None and code and peak > _NEARLY_ALL * limits.memory:
            return ProcessEnded("memory", self._memory_words())
        if code >= 0:
            return ProcessEnded("exit", f"the process ended (exit status {code})")
        cause = "killed" if -code in (signal.SIGKILL, signal.SIGTERM) else "signal"  # by others: no program's own fault
        return ProcessEnded(cause, f"the process ended (signal {-code}, {signal.Signals(-code).name})")

    def _memory_words(self) -> str:
        return f"more than {self.limits.memory or 0:.3g} bytes of memory"


def _path(path: Iterable[str] | None) -> list[str]:
    """The import path of a fresh interpreter: this one's, the current directory by its name."""
    return [entry or os.getcwd() for entry in ([os.getcwd(), *sys.path] if path is None else path)]


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
