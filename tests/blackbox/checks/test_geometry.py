"""Symmetry, reversibility, areas and norms of methods are seen, and none of them is a fault."""

import pytest

from driftproof.numeric.steppers import float_stepper
from tests.blackbox.checks.habits import result

TRAITS = [
    ("forward_euler", "symmetric", False, "S(-h) undoes S(h) up to a defect of 0.063 at h = 1/4 that falls as h**2"),
    ("forward_euler", "area_preserving", False, "areas grow by the factor 1.0625 in a step of h = 1/4"),
    ("rk4", "reversible", False, "up to a defect of 3.4e-06 at h = 1/4 that falls as h**6"),
    ("velocity_verlet", "symmetric", True, "S(-h) undoes S(h), to rounding"),
    ("prince_dormand87", "area_preserving", False, "areas grow by the factor 1.000000028 in a step of h = 1"),
]


@pytest.mark.parametrize(("method", "key", "holds", "words"), TRAITS)
def test_a_trait_of_a_method_is_seen(method, key, holds, words):
    seen = result(float_stepper(method), key)
    assert (seen.holds, seen.is_fault) == (holds, False)
    assert words in seen.words
