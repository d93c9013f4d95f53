"""Fits of linear steps in these tests: which methods are alike, and steps that are nearly methods."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from functools import cache

import numpy as np

from driftproof.blackbox.matching.linear_match import LinearFit, linear_fit
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Splitting
from driftproof.numeric.steppers import rk4
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.runs import exact_matrix_at


def fit(step) -> LinearFit:
    return linear_fit(opened(step))


@cache
def alike() -> dict[str, list[str]]:
    """The methods with the same matrix, by its exact values at two steps to 60 digits."""
    found: dict[tuple[str, ...], list[str]] = {}
    for key, method in METHODS.items():
        values = (significant(x, 60) for h in (Q(3, 7), Q(-5, 4)) for x in exact_matrix_at(method, h))
        found.setdefault(tuple(values), []).append(key)
    return {key: keys for keys in found.values() for key in keys}


RUTH3 = METHODS["ruth3"]
assert isinstance(RUTH3, Splitting)
adjoint_of_ruth3 = stepper(replace(RUTH3, parts=RUTH3.parts[::-1]), float)


VARIANTS = [
    (lambda force, q, v, h: rk4(force, q, v, -h), "rk4, with -h for h: it steps back in time"),
    (lambda force, q, v, h: adjoint_of_ruth3(force, q, v, h), "the adjoint of ruth3"),
    (lambda force, q, v, h: rk4(force, q, v, float(np.float32(h))), "rk4, with h rounded to binary32"),
    (lambda force, q, v, h: rk4(lambda x: force(x) / 2, q, v, h), "rk4, but the force enters 0.5 times"),
    (lambda force, q, v, h: rk4(force, q, v, 0.75 * h), "rk4, with 0.75 h for h"),
    (
        lambda q, v, h: (q + h / 2 * (v - h * q), v - h * q),
        "velocity-first symplectic Euler, but the position moves by 0.5 h v",
    ),
]
