"""The problems by key, in the order in which they are listed."""

from __future__ import annotations

from difflib import get_close_matches

from numeric.problems import linear, mechanics, stiff
from numeric.problems.problem import Problem

PROBLEMS: dict[str, Problem] = {p.key: p for file in (linear, stiff, mechanics) for p in file.ENTRIES}


def problem_named(key: str) -> Problem:
    """The problem `key`. Raises ValueError naming the closest keys if there is none."""
    if key in PROBLEMS:
        return PROBLEMS[key]
    close = get_close_matches(key, PROBLEMS, n=2, cutoff=0.4)
    hint = f"; did you mean {' or '.join(close)}?" if close else ""
    raise ValueError(f"unknown problem {key[:60]!r}{hint} (`driftproof stability` lists all)")
