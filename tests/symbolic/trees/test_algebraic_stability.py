"""Algebraic stability and semidefinite matrices: exact decisions, against print and minors."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from itertools import combinations

import pytest
from flint import fmpq_mat
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.trees.algebraic_stability import _Matrix, is_algebraically_stable, is_semidefinite
from tests.changes import moved
from tests.methods.tables.entries import entry

# hairer-wanner-1996, IV.12: of the classical families, all but Lobatto IIIA and IIIB.
STABLE = ["gauss2", "gauss3", "radau_ia2", "radau_ia3", "radau_iia2", "radau_iia3", "lobatto_iiic2", "lobatto_iiic3"]
STABLE += ["lobatto_iiic4", "backward_euler", "implicit_midpoint", "crouzeix3"]
UNSTABLE = ["lobatto_iiia3", "lobatto_iiib3", "trapezoid", "forward_euler", "rk4", "tr_bdf2"]


@pytest.mark.parametrize("key", STABLE + UNSTABLE)
def test_algebraic_stability_is_decided_as_in_print(key: str) -> None:
    assert is_algebraically_stable(entry(key)) == (key in STABLE)


def test_algebraic_stability_notices_what_is_missing_by_little() -> None:
    """Radau IIA has a zero eigenvalue: 10⁻³⁰ more in one diagonal entry of A is allowed, 10⁻³⁰ less is not."""
    method = entry("radau_iia3")
    for sign, holds in ((1, True), (-1, False)):
        assert is_algebraically_stable(moved(method, ("a", 0, 0), sign * Q(1, 10**30))) is holds


@pytest.mark.parametrize(("a", "b"), [(Q(-1), Q(-2)), (Q(-1, 2), Q(-2)), (Q(1, 3), Q(1))])
def test_algebraic_stability_needs_both_conditions(a: Q, b: Q) -> None:
    """One stage: M is 2ba - b², which is 0 for the first; the weight of the last alone is not negative."""
    assert not is_algebraically_stable(replace(entry("backward_euler"), a=((a,),), b=(b,)))


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
    assert is_semidefinite(matrix) == has_no_negative_minor(matrix)


@given(gram, st.integers(0, 3))
def test_semidefinite_notices_a_diagonal_entry_that_is_less_than_nothing(matrix: _Matrix, place: int) -> None:
    i = place % len(matrix)
    less = matrix[i][i] + Q(1, 10**30)
    broken = tuple(tuple(x - less * (k == j == i) for j, x in enumerate(row)) for k, row in enumerate(matrix))
    assert not is_semidefinite(broken)


@pytest.mark.parametrize(("corner", "holds"), [(Q(1, 3), True), (Q(1, 3) - Q(1, 10**40), False)])
def test_semidefinite_is_exact_for_irrational_entries(corner: Q, holds: bool) -> None:
    """Leading minors of ((3, √3), (√3, 1)) are 3 and 0."""
    root = square_root(3)
    assert is_semidefinite(((Q(3), root), (root, 3 * corner))) is holds
