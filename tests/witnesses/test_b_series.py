"""The witnesses for structure: what the exact flow and known methods are, and one coefficient changed by 10⁻³⁰."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.symbolic.trees.elementary_weights import EXACT
from driftproof.symbolic.trees.modified_equation import method_series, modified_equation
from tests.looping import some
from tests.methods.tables.entries import entry
from tests.witnesses.b_series import hamiltonian_to_order, symmetric_to_order, symplectic_to_order


@pytest.mark.parametrize(
    ("key", "symplectic", "symmetric"),
    [("implicit_midpoint", 6, 6), ("trapezoid", 2, 6), ("rk4", 4, 5), ("forward_euler", 1, 1), ("qin_zhang2", 6, 6)],
)
def test_structure_of_a_method_is_the_known_one(key: str, symplectic: int, symmetric: int) -> None:
    series, field = method_series(entry(key), 6), modified_equation(entry(key), 6)
    assert symplectic_to_order(series) == hamiltonian_to_order(field) == symplectic
    assert symmetric_to_order(field) == symmetric


def test_one_coefficient_changed_is_noticed() -> None:
    series = method_series(entry("implicit_midpoint"), 6)
    for t in some(range(1, len(series.coefficients)), 36):
        coefficients = list(series.coefficients)
        coefficients[t] += EXACT.lift(Q(1, 10**30))
        assert symplectic_to_order(replace(series, coefficients=tuple(coefficients))) < 6
