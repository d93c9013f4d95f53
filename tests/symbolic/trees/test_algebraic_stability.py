"""Algebraic stability and semidefinite matrices: exact decisions with certificates, against print and minors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import combinations

import pytest
from flint import fmpq_mat
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.number_field import Exact, square_root
from driftproof.symbolic.trees.algebraic_stability import (
    Semidefinite,
    _Matrix,
    algebraic_stability,
    quadratic_matrix,
    semidefinite,
)
from tests.changes import moved
from tests.methods.tables.entries import entry

# hairer-wanner-1996, IV.12: of the classical families, all but Lobatto IIIA and IIIB.
STABLE = ["gauss2", "gauss3", "radau_ia2", "radau_ia3", "radau_iia2", "radau_iia3", "lobatto_iiic2", "lobatto_iiic3"]
STABLE += ["lobatto_iiic4", "backward_euler", "implicit_midpoint", "crouzeix3"]
UNSTABLE = ["lobatto_iiia3", "lobatto_iiib3", "trapezoid", "forward_euler", "rk4", "tr_bdf2"]


@pytest.mark.parametrize("key", STABLE + UNSTABLE)
def test_algebraic_stability_is_decided_as_in_print_with_certificates(key: str) -> None:
    method = entry(key)
    fact = algebraic_stability(method)
    assert fact.holds == (key in STABLE)
    check(quadratic_matrix(method), fact.matrix)
    assert fact.weights.holds == all(x >= 0 for x in method.b)


def test_algebraic_stability_notices_what_is_missing_by_little() -> None:
    """Radau IIA has a zero eigenvalue: 10⁻³⁰ more in one diagonal entry of A is allowed, 10⁻³⁰ less is not."""
    method = entry("radau_iia3")
    for sign, holds in ((1, True), (-1, False)):
        assert algebraic_stability(moved(method, ("a", 0, 0), sign * Q(1, 10**30))).holds is holds


@pytest.mark.parametrize(("a", "matrix_holds"), [(Q(-1), True), (Q(-1, 2), False)])
def test_algebraic_stability_needs_both_conditions(a: Q, matrix_holds: bool) -> None:
    """One stage with weight -2: M is 2ba - b², and the weight is negative whatever M is."""
    fact = algebraic_stability(replace(entry("backward_euler"), a=((a,),), b=(Q(-2),)))
    assert (fact.matrix.holds, fact.weights.holds, fact.holds) == (matrix_holds, False, False)


def value(matrix: _Matrix, x: Sequence[Exact]) -> Exact:
    total: Exact = Q(0)
    for row, left in zip(matrix, x, strict=True):
        for middle, right in zip(row, x, strict=True):
            total = total + left * middle * right
    return total


def check(matrix: _Matrix, fact: Semidefinite) -> None:
    """What the certificate claims, multiplied out: all of M as squares, or a direction in which it is negative."""
    assert all(d > 0 for d, _ in fact.squares)
    if fact.direction is not None:
        assert value(matrix, fact.direction) < 0
        return
    for i, row in enumerate(matrix):
        for j, wanted in enumerate(row):
            total: Exact = Q(0)
            for d, line in fact.squares:
                total = total + d * line[i] * line[j]
            assert total == wanted


def has_no_negative_minor(matrix: _Matrix) -> bool:
    """All principal minors, not only leading ones, are >= 0: Sylvester's criterion for semidefinite matrices."""
    size = len(matrix)
    minors = (chosen for k in range(1, size + 1) for chosen in combinations(range(size), k))
    return all(fmpq_mat([[int(matrix[i][j]) for j in chosen] for i in chosen]).det() >= 0 for chosen in minors)


entries = st.integers(-3, 3)
symmetric = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(entries, min_size=n, max_size=n), min_size=n, max_size=n).map(
        lambda rows: tuple(tuple(Q(rows[max(i, j)][min(i, j)]) for j in range(n)) for i in range(n))
    )
)
gram = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(entries, min_size=n, max_size=n), min_size=1, max_size=n).map(
        lambda rows: tuple(tuple(Q(sum(r[i] * r[j] for r in rows)) for j in range(n)) for i in range(n))
    )
)


@given(symmetric | gram)
def test_semidefinite_agrees_with_all_principal_minors(matrix: _Matrix) -> None:
    fact = semidefinite(matrix)
    assert fact.holds == has_no_negative_minor(matrix)
    check(matrix, fact)


@given(gram, st.integers(0, 3))
def test_semidefinite_notices_a_diagonal_entry_that_is_less_than_nothing(matrix: _Matrix, place: int) -> None:
    i = place % len(matrix)
    less = matrix[i][i] + Q(1, 10**30)
    broken = tuple(tuple(x - less * (k == j == i) for j, x in enumerate(row)) for k, row in enumerate(matrix))
    assert not semidefinite(broken).holds
    check(broken, semidefinite(broken))


@pytest.mark.parametrize("entry", [Q(1), Q(-1), Q(1, 2), Q(-1, 2)])
def test_semidefinite_refutes_a_matrix_with_nothing_on_its_diagonal(entry: Q) -> None:
    matrix = ((Q(0), entry), (entry, Q(0)))
    assert not semidefinite(matrix).holds
    check(matrix, semidefinite(matrix))
    assert semidefinite(((Q(0), Q(0)), (Q(0), Q(0)))) == Semidefinite((), None)


@pytest.mark.parametrize(("corner", "holds"), [(Q(1, 3), True), (Q(1, 3) - Q(1, 10**40), False)])
def test_semidefinite_is_exact_for_irrational_entries(corner: Q, holds: bool) -> None:
    """Leading minors of ((3, √3), (√3, 1)) are 3 and 0."""
    root = square_root(3)
    matrix: _Matrix = ((Q(3), root), (root, 3 * corner))
    fact = semidefinite(matrix)
    assert fact.holds is holds
    check(matrix, fact)


def test_matrix_that_is_not_symmetric_is_refused() -> None:
    with pytest.raises(ValueError, match="must be symmetric"):
        semidefinite(((Q(1), Q(0)), (Q(1), Q(1))))
