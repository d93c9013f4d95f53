"""The normalised oscillator that a spring becomes."""

from __future__ import annotations

import pytest
import sympy

from driftproof.symbolic.derivation.one_step import entries, expression, one_step_matrix
from proofs.derivations.physical import one_step_with_frequency
from tests.nine import NINE


@pytest.mark.parametrize("key", NINE)
def test_frequency_only_rescales_step_and_velocity(key: str) -> None:
    """With ω, M(h) = D⁻¹ M₁(ωh) D for D = diag(1, 1/ω): the normalised matrix M₁ tells all."""
    w, step = sympy.symbols("w h")
    (qq, qv), (vq, vv) = ([expression(entry) for entry in row] for row in one_step_with_frequency(NINE[key]))
    normal = [expression(entry).subs(step, w * step) for entry in entries(one_step_matrix(NINE[key]))]
    found = [qq, qv * w, vq / w, vv]
    assert [sympy.expand(a - b) for a, b in zip(found, normal, strict=True)] == [0, 0, 0, 0]
    assert sympy.expand(qv - normal[1]) != 0
