"""The spring with units, and the normalised oscillator it becomes."""

from __future__ import annotations

import pytest
import sympy
from sympy import QQ, ring

from driftproof.symbolic.derivation.one_step import entries, expression, one_step_matrix
from driftproof.symbolic.derivation.physical import Spring, one_step_with_frequency
from tests.nine import NINE

m, k, L, x, u, h = sympy.symbols("m k L x u h", positive=True)
SPRING = Spring(m, k, L)


def test_normalised_state_and_energy_have_the_units_taken_out() -> None:
    q, v = SPRING.state(x, u)
    assert sympy.simplify(SPRING.energy(x, u) - k * L**2 * (q**2 + v**2) / 2) == 0
    assert sympy.simplify(SPRING.energy(x, u) - k * L * (q**2 + v**2) / 2) != 0
    assert sympy.simplify(SPRING.omega**2 - k / m) == 0
    assert SPRING.duration(h) * SPRING.omega == h


def test_numbers_work_as_well_as_symbols() -> None:
    spring = Spring(sympy.Integer(2), sympy.Integer(8), sympy.Integer(3))
    assert spring.omega == 2
    assert spring.state(sympy.Integer(3), sympy.Integer(6)) == (1, 1)
    assert spring.energy(sympy.Integer(3), sympy.Integer(6)) == 8 * 9
    assert spring.duration(sympy.Integer(1)) == sympy.Rational(1, 2)


@pytest.mark.parametrize("key", NINE)
def test_frequency_only_rescales_step_and_velocity(key: str) -> None:
    """With ω, M(h) = D⁻¹ M₁(ωh) D for D = diag(1, 1/ω): the normalised matrix M₁ tells all."""
    w, step = sympy.symbols("w h")
    (qq, qv), (vq, vv) = ([expression(entry) for entry in row] for row in one_step_with_frequency(NINE[key]))
    normal = [expression(entry).subs(step, w * step) for entry in entries(one_step_matrix(NINE[key]))]
    found = [qq, qv * w, vq / w, vv]
    assert [sympy.expand(a - b) for a, b in zip(found, normal, strict=True)] == [0, 0, 0, 0]
    assert sympy.expand(qv - normal[1]) != 0


def test_unit_frequency_gives_the_one_step_matrix_back() -> None:
    polynomials, *_ = ring("q, v, h, w", QQ)
    rows = one_step_with_frequency(NINE["rk4"])
    at_one = [expression(entry).subs(sympy.Symbol("w"), 1) for row in rows for entry in row]
    assert at_one == [expression(entry) for entry in entries(one_step_matrix(NINE["rk4"]))]
    assert rows[0][0].ring == polynomials
