"""Handlers that break the process that runs them, each in its own way; a request is the folder for their notes."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

MEGABYTE = 2**20


def echoes(request):
    return request


def hangs(request):
    while True:
        pass


def sleeps(request):
    time.sleep(600)


def hoards(request):
    kept = []
    while True:
        kept.append(bytearray(MEGABYTE))


def raises(request):
    raise KeyError("so it is")


def exits(request):
    os._exit(3)


def leaves(request):
    sys.exit("no licence")


def is_killed(request):
    os.kill(os.getpid(), signal.SIGKILL)


def aborts(request):
    os.abort()


def kills_its_supervisor(folder):
    if folder:
        Path(folder, str(os.getpid())).touch()
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(600)


def floods(request):
    return "x" * (64 * MEGABYTE)


def floods_its_pipe(request):
    for end in range(3, 64):
        with suppress(OSError):
            for _ in range(16):
                os.write(end, b"x" * MEGABYTE)


def writes_words_into_its_pipe(request):
    for end in range(3, 64):
        with suppress(OSError):
            os.write(end, b"[1, 2]\n")


def prints_a_flood(request):
    for _ in range(64):
        print("x" * MEGABYTE)
        os.write(2, b"x" * MEGABYTE)
    return "done"


def closes_its_output(request):
    sys.stdout.close()
    os.close(1)
    os.close(2)
    return "done"


def closes_everything_and_hangs(request):
    os.closerange(0, 256)
    time.sleep(600)


def answers_no_json(request):
    return {1, 2}


def forks_without_end(folder):
    """A fork bomb that stops at 60 processes, each of which notes that it is there."""
    for _ in range(6):
        os.fork()
        Path(folder, str(os.getpid())).touch()
        if len(os.listdir(folder)) >= 60:
            break
    time.sleep(600)


def leaves_a_daemon(folder):
    """In a session of its own, by two forks, with our pipes open; deaf to every signal that one can be deaf to."""
    if os.fork() == 0:
        os.setsid()
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
            signal.signal(number, signal.SIG_IGN)
        if os.fork() == 0:
            Path(folder, str(os.getpid())).touch()
            time.sleep(600)
        os._exit(0)
    while not os.listdir(folder):
        time.sleep(0.001)
    return "answered"


def leaves_a_program(folder):
    program = subprocess.Popen(["sleep", "600"], start_new_session=True)
    Path(folder, str(program.pid)).touch()
    os._exit(0)


def writes_a_large_file(folder):
    with open(Path(folder) / "large", "wb") as file:
        file.truncate(0)
        while True:
            file.write(b"x" * MEGABYTE)


def where_it_is(request):
    from driftproof.support import files

    return [files.__file__, sys.path[:2], os.getcwd(), os.environ.get("LEFT"), sorted(sys.modules)]
