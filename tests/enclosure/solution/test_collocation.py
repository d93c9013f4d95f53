"""Implicit steps nearly solve stiff equations, in as many bits as are asked for."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.solution.collocation import collocation, solved_stages

M, BITS = 9, 96


def stages_of(f, start, step, m=M):
    with ctx.workprec(BITS):
        method, first = collocation(m, BITS, 2 * m + 2), [arb(x) for x in start]
        return solved_stages(enclosable(f), method, (Fraction(0), Fraction(step)), [first] * (m + 1), 1e-22)


def test_matrices_differentiate_and_interpolate_polynomials():
    """σ³, given by its values, has the slopes 3σ², and Chebyshev's coefficients 3/4 of T_1 and 1/4 of T_3."""
    with ctx.workprec(2 * BITS):
        method, allowed = collocation(M, BITS, 2 * M + 2), arb(2) ** -BITS
        assert (len(method.stages), method.stages[-1]) == (M, 1.0)
        values = arb_mat([[arb(x) ** 3] for x in (-1.0, *method.stages)])
        slopes = (method.slopes * values).entries()
        assert all(abs(s - 3 * arb(x) ** 2) < allowed for s, x in zip(slopes, method.stages, strict=True))
        coefficients = [*(method.coefficients * values).entries(), *[arb(0)] * (M + 1)]
        found = (arb_mat([coefficients]) * arb_mat(method.chebyshev.tolist())).entries()
        wanted = {1: arb(0.75), 3: arb(0.25)}
        assert all(abs(c - wanted.get(k, 0)) < allowed for k, c in enumerate(found))


@pytest.mark.parametrize("rate", [-1.0, -1e6, -1e12])
def test_step_and_flow_follow_the_slow_solution(rate):
    """y' = λ(y - cos t) - sin t has y = cos t; of the flow of (λ, -1) the slow part decays by e^-h."""
    stages = stages_of(lambda t, y: [rate * (y[0] - np.cos(t)) - np.sin(t), -y[1]], [1.0, 1.0], 0.25)
    y, z = stages.polynomials()
    with ctx.workprec(BITS):
        assert abs(y(arb(1)) - arb(0.25).cos()) < 1e-14
        assert abs(z(arb(1)) - arb(-0.25).exp()) < 1e-15
        flow = stages.flow(arb_mat([[0, 0], [0, 1]]))
        assert abs(sum(c[1, 1] for c in flow) - arb(-0.25).exp()) < 1e-13


def test_step_that_has_no_solution_or_leaves_the_doubles_is_none():
    for rate in (lambda y: 1 + y**2, lambda y: np.exp(np.exp(y)), lambda y: 1e200 * (1e200 + 0 * y)):
        with np.errstate(all="ignore"):
            assert stages_of(lambda t, y, rate=rate: [rate(y[0]) + 0 * t], [8.0], 10.0) is None
