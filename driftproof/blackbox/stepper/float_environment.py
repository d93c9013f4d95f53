"""The rounding mode and the treatment of subnormal numbers: detected by arithmetic, separate for a stepper and us."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from typing import Any

_SMALLEST_NORMAL = sys.float_info.min
# 1 + 3/4 ulp is nearer to the next number than to 1. How it and its negative are rounded tells the four modes apart.
_NEARLY_AN_ULP = 3 * 2.0**-54
_MODES = {
    (True, True): "",
    (True, False): "rounds upward",
    (False, True): "rounds downward",
    (False, False): "rounds toward zero",
}
# Bytes for an environment, more than any processor needs: 32 on x86-64, fewer on others.
_ROOM = 512
# glibc's FE_DFL_ENV. Without glibc the environment is looked at, but not restored.
_DEFAULT = -1


def arithmetic_seen() -> str:
    """How binary64 arithmetic differs here from the default of IEEE 754; "" if it does not.

    >>> arithmetic_seen()
    ''
    """
    up, down, one, ulp = 1.0 + _NEARLY_AN_ULP, -1.0 - _NEARLY_AN_ULP, 1.0, 2.0**-52
    rounding = _MODES[up == one + ulp, down == -(one + ulp)]
    lost = _SMALLEST_NORMAL / 2 * 2 == 0.0  # also if operands are flushed rather than results
    return " and ".join(filter(None, [rounding, "flushes subnormal numbers to zero" if lost else ""]))


class FloatEnvironment:
    """Switches between the stepper's arithmetic, while it is called, and the default one, while we work.

    `seen` says how the stepper's arithmetic differs from the default, `change` says the same and since when it does.
    """

    def __init__(self) -> None:
        """Look at the arithmetic before the stepper is imported."""
        self.seen, self.change = "", ""
        self._theirs: Any = None
        self._library: Any = None
        with suppress(OSError):  # of glibc, whose default environment is known; elsewhere there is none
            self._library = ctypes.CDLL("libm.so.6")
        self.leave("before the stepper is imported")

    def enter(self) -> None:
        """Restore the stepper's arithmetic, if it is not the default."""
        if self._theirs is not None:
            self._library.fesetenv(self._theirs)

    def leave(self, since: str) -> None:
        """Look at the arithmetic that the stepper leaves and restore the default; `since` dates the first change."""
        self.seen = arithmetic_seen()
        if not self.seen:
            self._theirs = None
            return
        self.change = self.change or f"{since}, arithmetic {self.seen}"
        if self._library is not None:
            self._theirs = ctypes.create_string_buffer(_ROOM)
            self._library.fegetenv(self._theirs)
            self._library.fesetenv(ctypes.c_void_p(_DEFAULT))
