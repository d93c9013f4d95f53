"""Conserved quadratics and modified Hamiltonians: multiplied out, exponentiated in balls."""

from __future__ import annotations

from typing import Any

import pytest
from flint import arb, arb_mat, ctx, fmpq, fmpq_poly

from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.rational_functions import fraction, polynomial_text
from driftproof.symbolic.linear.invariants import (
    QuadraticForm,
    definite_limit,
    modified_hamiltonian,
    quadratic_invariants,
)
from driftproof.symbolic.linear.oscillator import area_factor, oscillator_matrix
from tests.looping import some
from tests.symbolic.linear.linear_examples import EVERY, NIL, ONE, ROOT_3, Z, at, limit_text


def is_conserved(m: StepMatrix, form: tuple[Any, ...]) -> bool:
    """I(Mz) = I(z), multiplied out at the monomials q², qv and v²."""
    (qq, qv), (vq, vv) = m
    a, b, c = (fraction(fmpq_poly() + x) for x in form)
    pulled_back = (
        a * qq * qq + b * qq * vq + c * vq * vq,
        (a * qq * qv + c * vq * vv) * fraction(fmpq_poly([2])) + b * (qq * vv + qv * vq),
        a * qv * qv + b * qv * vv + c * vv * vv,
    )
    return pulled_back == (a, b, c)


@pytest.mark.parametrize("key", EVERY)
def test_quadratics_are_conserved_and_all_of_them(key: str) -> None:
    m = oscillator_matrix(EVERY[key])
    forms = quadratic_invariants(m)
    assert len(forms) == (1 if area_factor(m) == ONE else 0)
    for form in forms:
        a, b, c = form.coefficients
        assert is_conserved(m, (a, b, c))
        assert not is_conserved(m, (a + fmpq(1, 10**30), b, c))


HALF, SLOPE = fraction(fmpq_poly([fmpq(1, 2)])), fraction(Z)
# Matrices with an eigenvalue 1 or -1 for every h, and what they conserve.
DEGENERATE: list[tuple[StepMatrix, list[str]]] = [
    (((ONE, NIL), (NIL, ONE)), ["1/2 0 0", "0 1/2 0", "0 0 1/2"]),
    (((-ONE, NIL), (NIL, -ONE)), ["1/2 0 0", "0 1/2 0", "0 0 1/2"]),
    (((ONE, NIL), (NIL, -ONE)), ["1/2 0 0", "0 0 1/2"]), (((ONE, NIL), (NIL, HALF)), ["1/2 0 0"]),
    (((-ONE, NIL), (NIL, HALF)), ["1/2 0 0"]), (((ONE, SLOPE), (NIL, ONE)), ["0 0 1/2"]),
    (((-ONE, NIL), (SLOPE, -ONE)), ["1/2 0 0"]), (((ONE, SLOPE), (NIL, HALF)), ["1/2 2*h 2*h**2"]),
]  # fmt: skip


@pytest.mark.parametrize(("m", "wanted"), DEGENERATE, ids=range(len(DEGENERATE)))
def test_an_eigenvalue_of_modulus_one_for_ever_conserves_the_square_of_its_left_eigenvector(
    m: StepMatrix, wanted: list[str]
) -> None:
    forms = quadratic_invariants(m)
    assert [" ".join(polynomial_text(c, "h") for c in form.coefficients) for form in forms] == wanted
    assert all(is_conserved(m, form.coefficients) for form in some(forms))


INVARIANTS = {
    "symplectic_euler": (("1/2", "-h/2", "1/2"), "2"),
    "symplectic_euler_position_first": (("1/2", "h/2", "1/2"), "2"),
    "velocity_verlet": (("1/2 - h**2/8", "0", "1/2"), "2"),
    "position_verlet": (("1/2", "0", "1/2 - h**2/8"), "2"),
    "midpoint": (("1/2", "0", "1/2"), "oo"),
    "gauss2": (("1/2", "0", "1/2"), "oo"),
}


@pytest.mark.parametrize("key", INVARIANTS)
def test_invariants_of_known_methods_and_where_they_are_definite(key: str) -> None:
    (form,) = quadratic_invariants(oscillator_matrix(EVERY[key]))
    texts = tuple(polynomial_text(c, "h") for c in form.coefficients)
    assert (texts, limit_text(definite_limit(form))) == INVARIANTS[key]


def test_definite_limit_over_a_number_field_is_not_that_of_a_conjugate() -> None:
    """(3 + √3 - 2h) q² + v² is definite up to (3 + √3)/2; its conjugate would end at (3 - √3)/2."""
    form = QuadraticForm((polynomial([3 + ROOT_3, -2]), fmpq_poly(), fmpq_poly([1])))
    assert limit_text(definite_limit(form)) == "3/2 + sqrt(3)/2"


SYMPLECTIC = [key for key, method in EVERY.items() if area_factor(oscillator_matrix(method)) == ONE]


@pytest.mark.parametrize("key", SYMPLECTIC)
def test_flow_of_the_modified_hamiltonian_is_the_step(key: str) -> None:
    """exp(h J S) in balls, at h = 3/4, against M(3/4)."""
    m = oscillator_matrix(EVERY[key])
    found = modified_hamiltonian(m)
    assert found is not None
    with ctx.workprec(200):
        h = arb(fmpq(3, 4))
        cosine = at(found.cosine, h)
        factor = cosine.acos() / (1 - cosine**2).sqrt() * h
        q2, qv, v2 = (at(f, h) * factor for f in (found.q2, found.qv, found.v2))
        flow = arb_mat([[qv, 2 * v2], [-2 * q2, -qv]]).exp()  # q' = ∂H/∂v, v' = -∂H/∂q
        for i in range(2):
            for j in range(2):
                difference = flow[i, j] - at(m[i][j], h)
                assert difference.contains(0)
                assert difference.rad() < arb(2) ** -150


@pytest.mark.parametrize("key", ["rk4", "forward_euler", "backward"])
def test_there_is_no_modified_hamiltonian_where_area_is_not_conserved(key: str) -> None:
    assert modified_hamiltonian(oscillator_matrix(EVERY[key])) is None


def test_there_is_no_modified_hamiltonian_of_a_hyperbolic_step() -> None:
    assert modified_hamiltonian(((fraction(1 + Z**2), fraction(Z)), (fraction(Z), ONE))) is None
