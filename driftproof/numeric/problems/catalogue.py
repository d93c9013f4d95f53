"""The problems by key, in the order in which they are listed.

>>> from driftproof import PROBLEMS
>>> PROBLEMS["kepler_eccentric"].title
"Kepler's problem, eccentricity 0.9, from the pericentre to t = 30"
"""

from __future__ import annotations

from driftproof.numeric.problems.linear import LINEAR_PROBLEMS
from driftproof.numeric.problems.mechanics import MECHANICS_PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.problems.stiff import STIFF_PROBLEMS
from driftproof.support.plain_text import unknown

PROBLEMS: dict[str, Problem] = {p.key: p for p in (*LINEAR_PROBLEMS, *STIFF_PROBLEMS, *MECHANICS_PROBLEMS)}


def problem_named(key: str) -> Problem:
    """The problem `key`. Raises ValueError naming the closest keys if there is none."""
    if key in PROBLEMS:
        return PROBLEMS[key]
    raise ValueError(unknown("problem", key, PROBLEMS, "`driftproof stability` lists them"))
