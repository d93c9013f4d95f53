"""Methods by the path that they take through our code, and a few of each, for tests that are about paths and not data.

What an entry of the catalogue says is asked of every entry, always. What our machinery makes of it is the same code for
all methods of one path: the default run takes the shortest of each and the one in the middle, and
HYPOTHESIS_PROFILE=thorough takes all.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterable
from fractions import Fraction
from math import lcm

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, Method, RungeKutta, Splitting
from tests.changes import coefficients

THOROUGH = os.environ.get("HYPOTHESIS_PROFILE") == "thorough"


def path_of(method: Method) -> tuple[str, ...]:
    """The kind of scheme, of its coefficients and of its stages: all on which branches of the machinery depend."""
    number = "decimal" if method.decimal else "irrational" if method.field else "rational"
    return type(method).__name__, number, *_stages(method)


def _stages(method: Method) -> tuple[str, ...]:
    if isinstance(method, RungeKutta):
        above = any(x for i, row in enumerate(method.a) for x in row[i + 1 :])
        stages = "explicit" if method.explicit else "fully implicit" if above else "diagonally implicit"
        return stages, "alone" if method.b_embedded is None else "embedded"
    if isinstance(method, Splitting):
        return "T quadratic" if method.quadratic_kinetic else "T any", method.parts[0][0]
    return () if isinstance(method, Collocation) else ("explicit" if method.explicit else "implicit",)


def length(method: Method) -> int:
    """The number of coefficients that are not zero: what the program of the method multiplies by."""
    return sum(x != 0 for x in coefficients(method).values())


def by_path(methods: Iterable[Method]) -> dict[tuple[str, ...], list[Method]]:
    """The methods of each path, the shortest first."""
    found = defaultdict(list)
    for method in methods:
        found[path_of(method)].append(method)
    return {path: sorted(methods, key=length) for path, methods in found.items()}


def common_denominator(method: Method) -> int:
    """Of the rational coefficients: the longer it is, the longer are the numbers that facts are written in."""
    return lcm(*(x.denominator for x in coefficients(method).values() if isinstance(x, Fraction)))


def representatives() -> list[str]:
    """The shortest and the middle method of each path, and the one with the longest numbers; all in a thorough run."""
    if THOROUGH:
        return list(METHODS)
    pairs = ((methods[0], methods[len(methods) // 2]) for methods in by_path(METHODS.values()).values())
    longest = max(METHODS.values(), key=common_denominator)
    return list(dict.fromkeys([*(method.key for pair in pairs for method in pair), longest.key]))
