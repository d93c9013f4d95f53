"""Families of Runge-Kutta methods with a free parameter, written as they are printed: for the tests of families."""

from __future__ import annotations

from driftproof.methods.families import Family, parse_function


def family(parameter: str, a: str, b: str, c: str, key: str = "given") -> Family:
    """The family with these rows of A, by ";", and entries, by ","."""

    def row(text: str) -> tuple[object, ...]:
        return tuple(parse_function(entry, parameter, "entry") for entry in text.split(","))

    return Family(key, key.title(), parameter, 0, "x", tuple(row(line) for line in a.split(";")), row(b), row(c))


THETA = family("theta", "0, 0; 1 - theta, theta", "1 - theta, theta", "0, 1", "theta")
# R = 1 + z + az² + az³/2: order 1, and 2 at a = 1/2.
CUBIC = family("a", "0, 0, 0; 1/2, 0, 0; 0, a, 0", "0, 0, 1", "0, 1/2, a", "cubic")
# R = 1 + z + z²/2 + az³.
SECOND = family("a", "0, 0, 0; 1, 0, 0; 1/2 - a, a, 0", "0, 0, 1", "0, 1, 1/2", "second")
# Singly diagonally implicit with three stages: order 2 for every g but 1/2, order 4 for the three roots of Crouzeix.
SDIRK_3 = family(
    "g",
    "g, 0, 0; 1/2 - g, g, 0; 2*g, 1 - 4*g, g",
    "1/(6*(1 - 2*g)**2), 1 - 1/(3*(1 - 2*g)**2), 1/(6*(1 - 2*g)**2)",
    "g, 1/2, 1 - g",
    "sdirk_3",
)
