"""Steppers that no instrument may trust: each behaves in one way as somebody's code does, and some do not come back."""

import os
import random
import signal
import subprocess
import sys
from itertools import count

import numpy as np

from driftproof.blackbox.findings import NoAnswer


def hangs(q, v, h):
    while True:
        pass


def hangs_at_zero(q, v, h):
    while h == 0:
        pass
    return q + h * v, v - h * q


def hangs_with_a_child(q, v, h):
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"], close_fds=False)
    os.fork()
    while True:
        pass


def crashes(q, v, h):
    os.kill(os.getpid(), signal.SIGSEGV)


def is_killed(q, v, h):
    os.kill(os.getpid(), signal.SIGKILL)


def crashes_backwards(q, v, h):
    if h < 0:
        os._exit(3)
    return q + h * v, v - h * q


def exits(q, v, h):
    sys.exit("no licence")


def returns_nan(q, v, h):
    return float("nan"), v


def returns_integers(q, v, h):
    return int(q + h * v), int(v - h * q)


def wrong_shape(q, v, h):
    return (q + h * v,)


_last = {"force": 0.0}


def remembers(q, v, h):
    before, _last["force"] = _last["force"], -q
    return q + h * v, v + h * (before - q) / 2


def noisy(q, v, h):
    return q + h * v + 1e-9 * random.random(), v - h * q


def prints(q, v, h):
    print("step", q)
    os.write(1, b"\x80\x05")
    np.array([1e300]) * 1e300  # a warning
    return q + h * v, v - h * q


def hoards(q, v, h):
    return bytearray(2**40)


def hanging_at(nth):
    """What is told of each call before it is made: of the nth, that it did not come back before."""
    made = count()

    def before(call):
        if next(made) == nth:
            raise NoAnswer(f"step({call}) did not return in time")

    return before
