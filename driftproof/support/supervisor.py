"""The supervisor and the worker of a `Session`, for code that may hang, crash or hoard memory; see `processes`.

The supervisor forks the worker and waits until either the worker or the session ends. Then it kills every process that
the worker has started: on Linux even those that moved to a session of their own, because it is their subreaper;
elsewhere those in the worker's process group. A fresh interpreter runs this module as a file, before driftproof can be
imported; so it imports nothing of driftproof.
"""

from __future__ import annotations

import ctypes
import faulthandler
import importlib.util
import json
import os
import select
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Any, NamedTuple

_Json = Any
Handler = Callable[[_Json], _Json]
# Seconds in which the supervisor kills what is left: a kill takes microseconds, and a fork bomb several rounds.
LAST_ROUND = 10.0
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36  # linux/prctl.h


class Ends(NamedTuple):
    """The file descriptors from which requests are read, to which answers are written, and of the parent socket."""

    requests: int
    answers: int
    control: int


def ready(seconds: float | None, *readable: int, writable: int | None = None) -> list[int]:
    """The descriptors that can be used without waiting, or whose other end is closed; [] if `seconds` pass first."""
    poll = select.poll()  # select.select refuses descriptors beyond 1023
    for descriptor in readable:
        poll.register(descriptor, select.POLLIN)
    if writable is not None:
        poll.register(writable, select.POLLOUT)
    return [descriptor for descriptor, _ in poll.poll(None if seconds is None else max(0.0, 1000 * seconds))]


def supervise(theirs: Ends, handler: Handler | None) -> None:
    """Fork the worker, wait until it or the session ends, kill all that it started, and report how it ended."""
    control = theirs[2]
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)
    worker = os.fork()
    if worker == 0:
        os.close(control)
        status = 1
        with suppress(BaseException):
            _work(theirs, handler)
            status = 0
        os._exit(status)
    with suppress(OSError):  # the worker does the same; whichever process is first succeeds
        os.setpgid(worker, worker)
    for end in theirs[:2]:
        os.close(end)
    _wait_for_end(worker, control)
    code, peak = _end_all(worker)
    os.write(control, json.dumps({"code": code, "peak": peak}).encode())
    os._exit(0)


def _wait_for_end(worker: int, control: int) -> None:
    """Wait until the session is closed or the worker has ended, without reaping it."""
    try:
        ready(None, control, os.pidfd_open(worker))
    except (AttributeError, OSError):  # no pidfd, as on old kernels and systems other than Linux: poll
        while not ready(0.01, control):
            if os.waitid(os.P_PID, worker, os.WEXITED | os.WNOHANG | os.WNOWAIT):
                return


def _end_all(worker: int) -> tuple[int, int]:
    """Kill and reap all that the worker started; return its exit code, or minus its signal, and its peak memory."""
    import resource

    code, peak, limit = -signal.SIGKILL, 0, monotonic() + LAST_ROUND
    unit, at_start = 1 if sys.platform == "darwin" else 1024, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    while monotonic() < limit:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(worker, signal.SIGKILL)
        for process in _descendants():
            with suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        try:
            while (ended := os.wait4(-1, os.WNOHANG))[0]:
                if ended[0] == worker:
                    code = os.waitstatus_to_exitcode(ended[1])
                    peak = (ended[2].ru_maxrss - at_start) * unit
        except ChildProcessError:
            break
        sleep(0.001)
    return code, peak


def _descendants() -> list[int]:
    """The processes that descend from this one, by /proc; [] on systems without it."""
    parents: dict[int, int] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError, ValueError, IndexError):
            parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
    found = {os.getpid()}
    while more := {process for process, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found - {os.getpid()})


def _work(theirs: Ends, handler: Handler | None) -> None:
    """Answer requests until there are no more, and discard what is printed meanwhile."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    os.setpgid(0, 0)
    faulthandler.disable()
    requests, answers = os.fdopen(theirs[0], "rb"), theirs[1]
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nowhere, descriptor)
    sys.stdout = sys.stderr = os.fdopen(nowhere, "w")  # a notebook or a test runner may have replaced them
    try:
        answering = _imported(json.loads(requests.readline())) if handler is None else handler
        limits = json.loads(requests.readline())
        _limit(limits["memory"], limits["file"])
        _send(answers, json.dumps({"answer": None}))
    except Exception as error:
        _send(answers, _raised(error))
        return
    for line in requests:
        try:
            text = json.dumps({"answer": answering(json.loads(line))})
        except Exception as error:
            text = _raised(error)
        _send(answers, text)


def _send(answers: int, text: str) -> None:
    rest = memoryview(f"{text}\n".encode())
    while rest:
        rest = rest[os.write(answers, rest) :]


def _raised(error: Exception) -> str:
    words = f"{type(error).__name__}: {' '.join(str(error).split())}"[:2000]
    return json.dumps({"raised": words, "memory": isinstance(error, MemoryError)})


def _imported(order: dict[str, Any]) -> Handler:
    """Import the handler with the import path of the order, after loading driftproof from where this file lies.

    Modules of driftproof are then found in the loaded package: no module of the user is taken for one of driftproof,
    and no file next to the package for a module of the user.
    """
    package = Path(__file__).parents[1]
    spec = importlib.util.spec_from_file_location(package.name, package / "__init__.py")
    assert spec is not None
    assert spec.loader is not None
    sys.modules[package.name] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.path[:] = order["path"]
    place, _, name = order["handler"].partition(":")
    handler: Handler = getattr(importlib.import_module(place), name)
    return handler


def _limit(memory: int | None, file: int | None) -> None:
    """Limit files to `file` bytes, and private data to `memory` bytes beyond what is in use now."""
    import resource

    used = 0
    with suppress(OSError):
        used = 1024 * int(Path("/proc/self/status").read_text().partition("VmData:")[2].split()[0])
    for what, most in (
        (resource.RLIMIT_DATA, None if memory is None else used + memory),
        (resource.RLIMIT_FSIZE, file),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(what)
        if most is not None:
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            resource.setrlimit(what, (most, most))


def _prctl(option: int, argument: int) -> None:
    with suppress(OSError, AttributeError):
        if sys.platform == "linux":
            ctypes.CDLL(None).prctl(option, argument, 0, 0, 0)


if __name__ == "__main__":
    supervise(Ends(*map(int, sys.argv[1:4])), None)
