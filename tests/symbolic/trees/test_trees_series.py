"""B-series composed, inverted and mirrored, against the same operations on tableaux."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q

import pytest

from driftproof.methods.number_field import Exact, square_root
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.trees.modified import flow, logarithm, modified_equation
from driftproof.symbolic.trees.rooted import Tree, density, number_of, shapes, tall, vertices
from driftproof.symbolic.trees.series import (
    BSeries,
    adjoint,
    compose,
    exact_series,
    inverse,
    method_series,
    reversed_step,
    substitute,
    symmetric_to_order,
    symplectic_to_order,
)
from tests.methods.tables.entries import entry

EULER, RK4, MIDPOINT = (entry(key) for key in ("forward_euler", "rk4", "implicit_midpoint"))


def tableau(a: list[list[Exact]], b: list[Exact]) -> RungeKutta:
    rows = tuple(map(tuple, a))
    return RungeKutta("x", "X", 0, "test", rows, tuple(b), tuple(sum(row, Q(0)) for row in rows))


def one_after_the_other(first: RungeKutta, second: RungeKutta) -> RungeKutta:
    """Both steps as one method of step h: the second one's stages start where the first one ends."""
    above = [[*row, *[Q(0)] * second.stages] for row in first.a]
    below = [[*first.b, *row] for row in second.a]
    return tableau([*above, *below], [*first.b, *second.b])


def mirrored(method: RungeKutta) -> RungeKutta:
    """The adjoint as a tableau: a*ᵢⱼ = bⱼ - aᵢⱼ, in the reverse order of stages (hairer-lubich-wanner-2006, V.2)."""
    a = [[b - x for x, b in zip(row, method.b, strict=True)] for row in method.a]
    return tableau([row[::-1] for row in a[::-1]], [*method.b[::-1]])


PAIRS = [("rk4", "heun3"), ("forward_euler", "backward_euler"), ("radau_iia2", "rk38"), ("gauss2", "forward_euler")]


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_composition_is_the_series_of_both_steps_as_one_tableau(first: str, second: str) -> None:
    one, other = entry(first), entry(second)
    composed = compose(method_series(one, 6), method_series(other, 6))
    assert composed == method_series(one_after_the_other(one, other), 6)
    assert composed != method_series(one_after_the_other(other, one), 6)


@pytest.mark.parametrize("key", ["rk4", "forward_euler", "radau_iia3", "lobatto_iiic3", "gauss2", "gill4"])
def test_adjoint_is_the_series_of_the_mirrored_tableau(key: str) -> None:
    method = entry(key)
    assert adjoint(method_series(method, 6)) == method_series(mirrored(method), 6)
    assert adjoint(adjoint(method_series(method, 6))) == method_series(method, 6)


@pytest.mark.parametrize("key", ["rk4", "gauss2", "radau_iia3"])
def test_inverse_composed_with_the_series_is_the_identity(key: str) -> None:
    series = method_series(entry(key), 7)
    for composed in (compose(series, inverse(series)), compose(inverse(series), series)):
        assert (composed.empty, {composed.scalars.exact(x) for x in composed.coefficients}) == (1, {0})


def test_composition_is_associative_and_not_commutative() -> None:
    a, b, c = (method_series(entry(key), 6) for key in ("rk4", "heun3", "backward_euler"))
    assert compose(compose(a, b), c) == compose(a, compose(b, c))
    assert compose(a, b) != compose(b, a)


def test_exact_series_is_a_one_parameter_group_and_its_own_adjoint() -> None:
    exact = exact_series(8)
    twice = BSeries(
        8,
        exact.empty,
        tuple(x * 2 ** vertices(t) for t, x in zip(shapes(8), exact.coefficients, strict=True)),
        exact.scalars,
    )
    assert compose(exact, exact) == twice
    assert adjoint(exact) == exact
    assert inverse(exact) == reversed_step(exact)
    assert symplectic_to_order(exact) == symmetric_to_order(exact) == 8
    assert all(x == Q(1, density(tree)) for tree, x in exact.items())


def test_coefficient_is_read_by_tree_and_no_further_than_the_series_goes() -> None:
    series = method_series(RK4, 5)
    assert series.coefficient(((), ((),))) == series.coefficient((((),), ())) == Q(1, 8)
    assert series.truncated(3) == method_series(RK4, 3)
    with pytest.raises(KeyError, match="6 vertices in a B-series of order 5"):
        series.coefficient(tall(6))


def test_series_of_other_things_than_steps_are_refused() -> None:
    field = modified_equation(RK4, 3)
    for refused in (lambda: compose(field, field), lambda: inverse(field), lambda: logarithm(field)):
        with pytest.raises(ValueError, match="near the identity"):
            refused()
    for refused in (lambda: flow(exact_series(3)), lambda: substitute(exact_series(3), field)):
        with pytest.raises(ValueError, match="no coefficient of the empty tree"):
            refused()


def test_series_over_two_fields_are_refused() -> None:
    first, second = (method_series(tableau([[root]], [root]), 2) for root in (square_root(2), square_root(3)))
    with pytest.raises(TypeError, match=r"two B-series over different|no exact arithmetic between"):
        compose(first, second)


def change(series: BSeries, tree: Tree, amount: Q) -> BSeries:
    coefficients = list(series.coefficients)
    coefficients[number_of(tree)] += series.scalars.lift(amount)
    return BSeries(series.order, series.empty, tuple(coefficients), series.scalars)


@pytest.mark.parametrize("question", [symplectic_to_order, symmetric_to_order])
def test_structure_of_a_series_notices_one_coefficient_changed(question: Callable[[BSeries], int]) -> None:
    series = method_series(MIDPOINT, 6)
    for tree in shapes(6)[1:]:
        found = question(change(series, tree, Q(1, 10**30)))
        assert found < 6 or (question is symmetric_to_order and vertices(tree) % 2 == 1)
