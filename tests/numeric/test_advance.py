"""Float runs: N steps of the double nearest to t/N, the time at which they end, and rates of floats and of arrays."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.advance import field_rate, float_step
from driftproof.numeric.steps.engine import functions_of

U = Q(1, 2**53)


def test_a_step_that_is_no_float_ends_within_a_unit_of_t():
    for t in (Q(10), Q(1, 3), Q(-7, 5)):
        for steps in (1, 3, 10, 997, 2**20 + 1):
            h = float_step(t, steps)
            assert abs(steps * Q(h) - t) <= U * abs(t)
            for i in (1, steps // 2, steps):
                assert abs(Q(i * h) - i * t / steps) <= (2 * U + U * U) * abs(i * t / steps)


@pytest.mark.parametrize(
    ("t", "steps", "what"), [(Q(1), 0, "steps is 0; must be at least 1"), (Q(1, 10**320), 10**10, "rounds to 0")]
)
def test_times_without_a_step_are_refused(t, steps, what):
    with pytest.raises(ValueError, match=what):
        float_step(t, steps)


def test_rates_of_arrays_choose_for_each_member():
    field = VectorField(("y1", "(y0 if y0 > 0 else -1) * floor(t)"))
    members = np.array([[-0.5, 0.0, 0.75], [1.0, 2.0, 3.0]])
    found = np.array(field_rate(field, functions_of(np))(2.5, members))
    assert found.T.tolist() == [field_rate(field)(2.5, member) for member in members.T]
