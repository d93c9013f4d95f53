"""Bounds on what a step may be off by, held from both sides: it is off by k, within the bound and beyond."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import opened

# Half the spacing of binary64 at 1.
U = 2.0**-53


def parted(
    read: Callable[[ForeignStepper], str], made: Callable[[float], Any], words: str, places: tuple[float, float]
) -> bool:
    """Whether these words are said of the step that is off by the second number, and not of that off by the first."""

    def told(k: float) -> str:
        try:
            return read(opened(made(k)))
        except (NotReadable, UnsupportedCall) as refusal:
            return str(refusal)

    return [words in told(k) for k in places] == [False, True]
