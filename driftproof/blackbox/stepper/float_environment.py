"""The rounding mode and the fate of subnormal numbers: told by arithmetic, kept apart for a stepper and for us."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from typing import Any

_SMALLEST_NORMAL = sys.float_info.min
# 1 + 3/4 ulp lies nearer to the next number than to 1: what becomes of it on either side of 0 tells the four modes.
_NEARLY_AN_ULP = 3 * 2.0**-54
_MODES = {
    (True, True): "",
    (True, False): "rounds upward",
    (False, True): "rounds downward",
    (False, False): "rounds toward zero",
}
# Larger than the environment of any processor: of x86-64 32 bytes, of others less.
_ROOM = 512
# glibc's FE_DFL_ENV; elsewhere an environment is looked at and not put back.
_DEFAULT = -1


def arithmetic_seen() -> str:
    """What binary64 arithmetic does here that IEEE 754's default does not, "" for nothing.

    >>> arithmetic_seen()
    ''
    """
    up, down, one, ulp = 1.0 + _NEARLY_AN_ULP, -1.0 - _NEARLY_AN_ULP, 1.0, 2.0**-52
    rounding = _MODES[up == one + ulp, down == -(one + ulp)]
    lost = _SMALLEST_NORMAL / 2 * 2 == 0.0  # whether results are flushed, or what is given
    return " and ".join(filter(None, [rounding, "flushes subnormal numbers to zero" if lost else ""]))


class FloatEnvironment:
    """Whose arithmetic is on: the stepper's own while it is called, the default one while we work.

    `seen` is what the stepper's does otherwise than the default, `change` in one sentence who made it so.
    """

    def __init__(self) -> None:
        """As it is before the stepper is imported."""
        self.seen, self.change = "", ""
        self._theirs: Any = None
        self._library = _library()
        self.leave("before the stepper is imported")

    def enter(self) -> None:
        """Put the stepper's arithmetic back, where it is not the default."""
        if self._theirs is not None:
            self._library.fesetenv(self._theirs)

    def leave(self, since: str) -> None:
        """Look at what the stepper left, and go back to the default; the first change is told with `since`."""
        self.seen = arithmetic_seen()
        if not self.seen:
            self._theirs = None
            return
        self.change = self.change or f"{since}, arithmetic {self.seen}"
        if self._library is not None:
            self._theirs = ctypes.create_string_buffer(_ROOM)
            self._library.fegetenv(self._theirs)
            self._library.fesetenv(ctypes.c_void_p(_DEFAULT))


def _library() -> Any:
    """The mathematics of glibc, whose default environment is known; None elsewhere."""
    with suppress(OSError):
        return ctypes.CDLL("libm.so.6")
    return None
