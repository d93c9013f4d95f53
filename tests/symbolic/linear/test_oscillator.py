"""One-step matrices of every family: against SymPy's polynomials, products of shears, and linear solves."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import fmpq, fmpq_mat
from hypothesis import given

from driftproof import strategies
from driftproof.methods.schemes import Nystrom, Splitting
from driftproof.symbolic.algebra.polynomials import scalar
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import (
    area_factor,
    energy_factor,
    energy_multiplier_of,
    inflated,
    linear_step_matrix,
    oscillator_matrix,
    stability_function_of,
)
from tests.catalogue.conformance import ARITHMETICS
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import EVERY, MIDPOINT, MIDPOINT_NYSTROM, NYSTROM_4, ONE
from tests.witnesses.witness_steps import witness_matrix


@pytest.mark.slow
@given(strategies.splittings(max_pairs=3) | strategies.runge_kutta_methods(max_stages=4))
def test_matrix_of_a_drawn_method_is_what_its_step_is_in_other_arithmetics_and_without_one(method: Any) -> None:
    assert oscillator_matrix(method) == witness_matrix(method)
    for name in ("Fraction", "number field", "polynomials in h", "SymPy's polynomials", "balls"):
        assert ARITHMETICS[name].meets(method, method)
    assert not isinstance(method, Splitting) or area_factor(oscillator_matrix(method)) == ONE


def test_implicit_nystrom_is_the_implicit_midpoint_rule() -> None:
    assert oscillator_matrix(MIDPOINT_NYSTROM) == oscillator_matrix(MIDPOINT)
    twin = Nystrom("nystrom", "Nyström", 2, "x", (Q(1, 2),), ((Q(1, 5),),), (Q(1, 2),), (Q(1),))
    assert oscillator_matrix(twin) != oscillator_matrix(MIDPOINT)


SYSTEMS: dict[str, list[list[Q | int]]] = {
    "two springs": [[0, 0, 1, 0], [0, 0, 0, 1], [-2, 1, 0, 0], [1, -2, 0, 0]],
    "a saddle": [[0, 1], [Q(1, 3), 0]],
    "a general matrix": [[1, Q(1, 2), 0], [-3, 0, 2], [0, 1, -1]],
    "a Jordan block": [[2, 1], [0, 2]],
}


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("key", ["rk4", "backward", "midpoint", "gauss3"])
def test_linear_step_is_p_over_q_of_the_matrix(name: str, key: str) -> None:
    rows, r = SYSTEMS[name], stability_function_of(EVERY[key])
    assert r is not None
    m, h = linear_step_matrix(EVERY[key], rows), fmpq(2, 7)
    a = fmpq_mat([[scalar(x) * h for x in row] for row in rows])
    num, den = (_power_sum(p, a) for p in (r.num, r.den))
    assert den * fmpq_mat([[entry(h) for entry in row] for row in m]) == num


def _power_sum(p: Any, a: Any) -> Any:
    total = a * 0
    identity = fmpq_mat([[fmpq(int(i == j)) for j in range(a.ncols())] for i in range(a.nrows())])
    for c in reversed(p.coeffs()):
        total = total * a + identity * c
    return total


def test_splitting_on_coupled_springs() -> None:
    """In the eigenvectors (1, 1) and (1, -1) of K the step is that of the oscillator with ω² = 1 and 3."""
    m = linear_step_matrix(NINE["velocity_verlet"], SYSTEMS["two springs"])
    (qq, qv), (vq, vv) = linear_step_matrix(NINE["velocity_verlet"], [[0, 1], [-3, 0]])
    moved = [row[0] - row[1] for row in m], [row[2] - row[3] for row in m]
    assert moved[0] == [qq, -qq, vq, -vq]
    assert moved[1] == [qv, -qv, vv, -vv]
    nystrom = linear_step_matrix(NYSTROM_4, [[0, 1], [-1, 0]])
    assert nystrom == oscillator_matrix(NYSTROM_4)


@pytest.mark.parametrize("rows", [[[0, 1], [-1, 1]], [[0, 2], [-1, 0]], [[0, 1, 0], [0, 0, 1], [1, 0, 0]]])
def test_splitting_refuses_what_is_not_separable(rows: list[list[int]]) -> None:
    with pytest.raises(ValueError, match="velocity_verlet needs a system"):
        linear_step_matrix(NINE["velocity_verlet"], rows)


def test_linear_system_must_be_square_and_exact() -> None:
    with pytest.raises(ValueError, match="square"):
        linear_step_matrix(NINE["rk4"], [[0, 1]])
    with pytest.raises(TypeError, match="exact"):
        linear_step_matrix(NINE["rk4"], [[0.5]])


@pytest.mark.parametrize("key", ["rk4", "backward", "midpoint", "gauss2", "gauss3"])
def test_determinant_is_the_energy_multiplier_of_a_runge_kutta_method(key: str) -> None:
    m, r = oscillator_matrix(EVERY[key]), stability_function_of(EVERY[key])
    assert r is not None
    assert energy_factor(m) == energy_multiplier_of(r)
    assert area_factor(m) == fraction(inflated(energy_multiplier_of(r).num), inflated(energy_multiplier_of(r).den))
