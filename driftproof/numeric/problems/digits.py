"""The references' decimals, time by time in digits.json beside this file, which is read once."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from driftproof.numeric.problems.problem import Reference


def reference(key: str, evidence: str, source: str) -> Reference:
    """The reference of the problem `key`, y to 20 digits where it has a closed form; 0e-400 is y below that in size.

    Raises KeyError if digits.json has none.
    """
    found = _digits()[key]
    return Reference(tuple(map(Fraction, found)), tuple(map(tuple, found.values())), evidence, source)


@cache
def _digits() -> Any:
    return json.loads((Path(__file__).parent / "digits.json").read_text(encoding="utf-8"))
