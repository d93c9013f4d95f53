"""What coefficients alone decide: published examples, disguises of one method, and every coefficient changed."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import fmpq, fmpq_mat
from hypothesis import given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.methods.schemes import Nystrom, RungeKutta, Splitting
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.linear.reduced_tableau import (
    StageCoefficients,
    adjoint,
    is_first_same_as_last,
    is_stiffly_accurate,
    is_symmetric,
    is_symplectic,
    matchings,
    reduced,
    reduced_word,
    stages_of,
    symplectic_residuals,
)
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.trees.modified_equation import method_series
from tests.changes import coefficients, moved
from tests.methods.tables.entries import entry
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import (
    GAUSS_2,
    GAUSS_3,
    LOBATTO_3,
    LOBATTO_IIIB_2,
    MIDPOINT,
    MIDPOINT_THRICE,
    NYSTROM_4,
    QIN_ZHANG,
    RADAU_3,
    RADAU_IIA_2,
    STORMER,
    TRAPEZOID,
    runge_kutta,
)

EXAMPLES = {
    "gauss2": (GAUSS_2, True, True), "midpoint": (MIDPOINT, True, True), "trapezoid": (TRAPEZOID, False, True),
    "midpoint with three stages": (MIDPOINT_THRICE, True, True),
    "lobatto_iiib2, the midpoint rule in disguise": (LOBATTO_IIIB_2, True, True),
    "radau_iia2": (RADAU_IIA_2, False, False), "qin_zhang": (QIN_ZHANG, True, True), "gauss3": (GAUSS_3, True, True),
    "radau3": (RADAU_3, False, False), "lobatto3": (LOBATTO_3, False, True), "stormer": (STORMER, True, True),
    "nystrom4": (NYSTROM_4, False, False), "rk4": (NINE["rk4"], False, False),
    "velocity_verlet": (NINE["velocity_verlet"], True, True),
    "symplectic_euler": (NINE["symplectic_euler"], True, False),
}  # fmt: skip


@pytest.mark.parametrize("name", EXAMPLES)
def test_symplectic_and_symmetric(name: str) -> None:
    method, symplectic, symmetric = EXAMPLES[name]
    assert (is_symplectic(method), is_symmetric(method)) == (symplectic, symmetric)


def test_trapezoid_looks_symplectic_on_the_oscillator_and_is_not() -> None:
    assert oscillator_matrix(TRAPEZOID) == oscillator_matrix(MIDPOINT)
    assert [*symplectic_residuals(stages_of(TRAPEZOID))] == [Q(-1, 4), 0, Q(1, 4)]


def test_a_node_off_by_ten_to_the_minus_thirty_is_noticed() -> None:
    assert not is_symplectic(moved(GAUSS_3, ("node_polynomial", 0), Q(1, 10**30)))


def test_irreducible_form_of_a_method_in_disguise() -> None:
    assert reduced(stages_of(MIDPOINT_THRICE)) == StageCoefficients(((Q(1, 2),),), ((Q(1),),), (Q(1, 2),))
    assert reduced(stages_of(LOBATTO_IIIB_2)).weights == ((Q(1),),)
    assert reduced(stages_of(GAUSS_2)) == stages_of(GAUSS_2)
    assert reduced(stages_of(runge_kutta(((2, 0), (1, 0)), (0, 0)))) == StageCoefficients(((2,),), ((0,),), (2,))
    assert any(symplectic_residuals(stages_of(LOBATTO_IIIB_2)))  # as it stands it does not satisfy the condition


def without_idle_stages(method: RungeKutta) -> RungeKutta:
    small = reduced(stages_of(method))
    return runge_kutta(small.a, small.b)


@given(strategies.runge_kutta_methods(max_stages=4))
def test_irreducible_form_takes_the_same_step(method: RungeKutta) -> None:
    small = without_idle_stages(method)
    assert stability_function(small) == stability_function(method)
    assert method_series(small, 4) == method_series(method, 4)
    assert without_idle_stages(small) == small


@pytest.mark.parametrize("key", ["rk4", "gauss2", "radau_iia3", "merson45", "lobatto_iiib4"])
def test_stages_that_are_there_twice_are_merged(key: str) -> None:
    method = entry(key)
    twice = [[x / 2 for x in row for _ in range(2)] for row in method.a for _ in range(2)]
    doubled = runge_kutta(twice, [x / 2 for x in method.b for _ in range(2)])
    small = without_idle_stages(doubled)
    assert small == without_idle_stages(method)
    assert small.stages <= method.stages
    assert method_series(small, 6) == method_series(method, 6)


def test_stages_that_do_not_count_are_left_out() -> None:
    """Dormand and Prince's seventh slope serves the second row only; all five of Merson's count."""
    assert len(reduced(stages_of(entry("dormand_prince54"))).c) == 6
    assert len(reduced(stages_of(entry("merson45"))).c) == 5
    idle = runge_kutta(((0,),), (Q(0),))
    assert without_idle_stages(idle).b == (Q(0),)


@pytest.mark.parametrize("key", ["gauss2", "gauss3", "implicit_midpoint", "qin_zhang2"])
def test_symplecticity_and_symmetry_notice_every_coefficient_changed(key: str) -> None:
    method = entry(key)
    assert is_symplectic(method)
    assert is_symmetric(method)
    for place in coefficients(method):
        off = moved(method, place, Q(1, 10**30))
        assert (is_symplectic(off), is_symmetric(off)) == (place[0] == "c", place[0] == "c")


def test_symmetry_does_not_depend_on_the_order_of_the_stages() -> None:
    method = entry("lobatto_iiia3")
    turn = (2, 0, 1)
    shuffled = runge_kutta([[method.a[i][j] for j in turn] for i in turn], [method.b[i] for i in turn])
    assert is_symmetric(shuffled)
    assert not is_symmetric(runge_kutta(shuffled.a, method.b))


@given(strategies.runge_kutta_methods(max_stages=3), st.permutations(range(3)))
def test_a_permuted_method_is_recognised(method: RungeKutta, order: list[int]) -> None:
    order = [i for i in order if i < method.stages]
    permuted = StageCoefficients(
        tuple(tuple(method.a[i][j] for j in order) for i in order),
        (tuple(method.b[i] for i in order),),
        tuple(method.c[i] for i in order),
    )
    assert next(matchings(permuted, stages_of(method)), None) is not None


def test_adjoint_twice_is_the_method() -> None:
    for method in (GAUSS_2, RADAU_IIA_2, NYSTROM_4, STORMER):
        assert adjoint(adjoint(stages_of(method))) == stages_of(method)
    assert adjoint(stages_of(RADAU_IIA_2)) != stages_of(RADAU_IIA_2)


def test_adjoint_of_a_nystrom_method_inverts_its_matrix() -> None:
    other = adjoint(stages_of(NYSTROM_4))
    back = Nystrom("adjoint", "Adjoint", 4, "x", other.c, other.a, *other.weights)
    m, n = oscillator_matrix(NYSTROM_4), oscillator_matrix(back)
    h = fmpq(1, 3)
    forward, backward = (fmpq_mat([[f(s * h) for f in row] for row in x]) for x, s in ((m, -1), (n, 1)))
    assert forward * backward == fmpq_mat([[1, 0], [0, 1]])


def test_symplectic_conditions_of_a_nystrom_method_count_entries_on_both_sides_of_the_diagonal() -> None:
    """Gauss's two stages as those of a Nyström method, A² and bA; then each entry off alone."""
    a, b, two = GAUSS_2.a, GAUSS_2.b, range(2)
    squared = [[a[i][0] * a[0][j] + a[i][1] * a[1][j] for j in two] for i in two]
    weights = (tuple(b[0] * a[0][j] + b[1] * a[1][j] for j in two), b)
    for i, j, off in ((0, 0, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 1)):
        moved = tuple(tuple(x + Q(off * ((k, m) == (i, j)), 7) for m, x in enumerate(squared[k])) for k in two)
        wrong = symplectic_residuals(StageCoefficients(moved, weights, GAUSS_2.c))
        assert any(wrong) == (off * (i - j) != 0)  # b (b - a) - b (b - a) of a stage and itself is 0


def test_nystrom_stages_at_two_nodes_are_not_merged() -> None:
    """Their rows of A agree, their c do not; for a Runge-Kutta method c would be the same and the stages equal."""
    rows = ((Q(0), Q(0)), (Q(0), Q(0)))
    two = Nystrom("two", "Two", 1, "x", (Q(0), Q(1)), rows, (Q(1, 4), Q(1, 4)), (Q(1, 2), Q(1, 2)))
    one = Nystrom("one", "One", 1, "x", (Q(1), Q(1)), rows, (Q(1, 4), Q(1, 4)), (Q(1, 2), Q(1, 2)))
    assert [len(reduced(stages_of(m)).c) for m in (two, one)] == [2, 1]
    assert next(matchings(stages_of(two), stages_of(one)), None) is None
    assert next(matchings(stages_of(two), stages_of(two)), None) == (0, 1)


def test_reduced_word_of_a_splitting() -> None:
    parts = (("kick", Q(1, 4)), ("drift", Q(0)), ("kick", Q(1, 4)), ("drift", Q(1)), ("kick", Q(1, 2)))
    method = Splitting("verlet", "Verlet", 2, "x", parts)
    assert reduced_word(method) == list(NINE["velocity_verlet"].parts)
    assert is_symmetric(method)
    nothing = Splitting("nothing", "Nothing", 0, "x", (("kick", Q(1)), ("drift", Q(0)), ("kick", Q(-1))))
    assert reduced_word(nothing) == []


def test_stiff_accuracy_and_the_first_stage() -> None:
    assert [is_stiffly_accurate(m) for m in (RADAU_IIA_2, RADAU_3, LOBATTO_3, TRAPEZOID)] == [True] * 4
    assert [is_stiffly_accurate(m) for m in (GAUSS_2, GAUSS_3, NINE["rk4"], NINE["position_verlet"])] == [False] * 4
    assert [is_first_same_as_last(m) for m in (TRAPEZOID, LOBATTO_3)] == [True] * 2
    assert [is_first_same_as_last(m) for m in (RADAU_3, RADAU_IIA_2)] == [False] * 2
