"""Orders by trees of two colours, against the elementary weights of the same method as a partitioned tableau."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Nystrom, RungeKutta, Splitting
from driftproof.symbolic.facts import general_order
from driftproof.symbolic.rosenbrock import RosenbrockStages, WConditions
from driftproof.symbolic.trees.elementary_weights import EXACT, TableauStages
from driftproof.symbolic.trees.order_conditions import (
    order,
    order_of,
    principal_error,
    runge_kutta_conditions,
)
from driftproof.symbolic.trees.partitioned_trees import (
    ColouredConditions,
    conditions_with_nodes,
    embedded_order,
    general_conditions,
    nystrom_conditions,
    nystrom_order,
    separable_conditions,
)
from driftproof.symbolic.trees.rooted_trees import ColouredTree, Tree, canonical_tree, to_brackets, vertices
from tests.changes import coefficients, moved
from tests.looping import some
from tests.methods.tables.entries import entry
from tests.symbolic.trees.residuals import residuals


def conditions_of_the_pair(method: Splitting) -> ColouredConditions:
    """A splitting as a partitioned Runge-Kutta method with a stage for every sub-step, (A, b) for q and (Â, b̂) for v:
    one condition for every tree with vertices of two colours (hairer-lubich-wanner-2006, III.2.2).
    """
    tables = []
    for own in ("drift", "kick"):  # where a drift is evaluated, earlier kicks have changed v, and the other way round
        weights = tuple(c if kind == own else Q(0) for kind, c in method.parts)
        rows = tuple(tuple(c if j < i else Q(0) for j, c in enumerate(weights)) for i in range(len(weights)))
        tables.append(TableauStages(rows, weights))
    return ColouredConditions(("q", "v"), *tables, internal=2, scalars=EXACT)


def uncoloured(tree: ColouredTree) -> Tree:
    return canonical_tree(tuple(map(uncoloured, tree[1])))


def colours(tree: ColouredTree) -> Iterator[tuple[str, str]]:
    """The colours of the two ends of every edge."""
    for branch in tree[1]:
        yield tree[0], branch[0]
        yield from colours(branch)


def largest_fork_at_q(tree: ColouredTree) -> int:
    own = len(tree[1]) if tree[0] == "q" else 0
    return max([own, *map(largest_fork_at_q, tree[1])])


SPLITTINGS = ["symplectic_euler", "position_verlet", "ruth3", "forest_ruth", "suzuki4", "pefrl"]


@pytest.mark.parametrize("key", SPLITTINGS)
def test_residuals_of_a_splitting_are_those_of_its_partitioned_tableau(key: str) -> None:
    """Among all trees of two colours, those whose colours alternate; and of them, those without a fork at q."""
    method = entry(key)
    pair, separable, linear = (conditions_of_the_pair(method), separable_conditions(method), nystrom_conditions(method))
    for n in range(1, 6):
        every = dict(residuals(pair, n))
        alternating = {tree: x for tree, x in every.items() if all(u != v for u, v in colours(tree))}
        assert dict(residuals(separable, n)) == alternating
        assert dict(residuals(linear, n)) == {t: x for t, x in alternating.items() if largest_fork_at_q(t) <= 1}


@pytest.mark.parametrize("amount", [Q(1, 24), Q(1, 10**30)])
@pytest.mark.parametrize("key", SPLITTINGS[:-1])
def test_order_of_a_splitting_notices_every_coefficient_changed(key: str, amount: Q) -> None:
    method = entry(key)
    for place in some(coefficients(method)):
        changed = moved(method, place, amount)
        assert general_order(changed).order == nystrom_order(changed).order == 0


def test_failing_tree_of_a_splitting_says_what_fails() -> None:
    """The kick of symplectic Euler sees the old position: v has -h²/2 F'(q)v too little."""
    first = general_order(entry("symplectic_euler"))
    assert (first.order, to_brackets(first.failing_tree), first.residual) == (1, "[τ_q]_v", Q(-1, 2))
    second = general_order(entry("symplectic_euler_position_first"))
    assert (second.order, to_brackets(second.failing_tree), second.residual) == (1, "[τ_q]_v", Q(1, 2))
    idle = Splitting("idle", "Idle", 0, "test", (("drift", Q(1)),))
    assert (general_order(idle).order, to_brackets(general_order(idle).failing_tree)) == (0, "τ_v")


def test_no_order_is_above_the_bound_of_so_many_stages() -> None:
    drift = Splitting("drift", "Drift", 0, "test", (("drift", Q(1)),))
    keys = ("forward_euler", "rk4", "implicit_midpoint", "gauss3", "velocity_verlet", "ruth3", "nystrom4")
    bounds = [general_conditions(method).bound for method in (*map(entry, keys), drift)]
    assert bounds == [1, 4, 2, 6, 4, 6, 6, 1]
    assert [conditions_with_nodes(entry(key)).bound for key in ("rk4", "implicit_midpoint")] == [8, 2]
    ros3p = FURTHER_METHODS["ros3p"]
    assert WConditions(ros3p).bound == RosenbrockStages(ros3p, ros3p.b).bound == 4


def test_principal_error_of_verlet_is_the_printed_one() -> None:
    """Kick-drift-kick on q'' = F(q): v lacks h³/12 F''(v, v) one way, and F'F/6 - F'F/4 the other."""
    error = principal_error(nystrom_conditions(entry("velocity_verlet")), 0)
    found = {to_brackets(tree): x for tree, x in error.coefficients}
    assert found == {"[τ_q,τ_q]_v": Q(1, 12), "[[τ_v]_q]_v": Q(1, 12), "[[τ_q]_v]_q": Q(-1, 6)}
    assert error.squared_norm == Q(1, 144) + Q(1, 144) + Q(1, 36)


def nystrom_from(method: RungeKutta) -> Nystrom:
    """A Runge-Kutta method on q' = v, v' = F(q), with the slopes of q eliminated: A², bA and b."""

    def times(row: tuple[Exact, ...]) -> tuple[Exact, ...]:
        columns = zip(*method.a, strict=True)
        return tuple(sum((x * y for x, y in zip(row, column, strict=True)), Q(0)) for column in columns)

    a, position = tuple(map(times, method.a)), times(method.b)
    return Nystrom("x", "X", method.claimed_order, "test", method.c, a, position, method.b)


@pytest.mark.parametrize("key", ["rk4", "rk38", "heun3", "gauss3", "radau_iia3", "fehlberg78"])
def test_nystrom_form_of_a_runge_kutta_method_has_its_order(key: str) -> None:
    method = entry(key)
    assert nystrom_order(nystrom_from(method)).order == order(method).order
    broken = replace(nystrom_from(method), b_position=nystrom_from(method).b_velocity)
    assert nystrom_order(broken).order == 1


@pytest.mark.parametrize(("key", "claimed"), [("nystrom4", 4), ("nystrom5", 5)])
def test_order_of_a_nystrom_method_notices_every_coefficient_changed(key: str, claimed: int) -> None:
    method = entry(key)
    assert nystrom_order(method).order == claimed
    diagonal_and_above = {("a", i, j) for i in range(method.stages) for j in range(i, method.stages)}
    for place in some(coefficients(method).keys() - diagonal_and_above - {("c", 0)}):
        assert nystrom_order(moved(method, place, Q(1, 10**30))).order < claimed


def test_order_of_verlet_is_that_of_its_nystrom_form() -> None:
    """Kick-drift-kick is the Nyström method with c = (0, 1), b_position = (1/2, 0), b_velocity = (1/2, 1/2)."""
    half, zero = Q(1, 2), Q(0)
    method = Nystrom("x", "X", 2, "test", (zero, Q(1)), ((zero, zero), (half, zero)), (half, zero), (half, half))
    assert nystrom_order(method) == nystrom_order(entry("velocity_verlet"))
    first, second = (principal_error(nystrom_conditions(m), 0) for m in (method, entry("velocity_verlet")))
    assert first == second


def test_order_with_nodes_notices_a_node_that_is_no_row_sum() -> None:
    """The clock of one stage is wrong by 10⁻³⁰: f(y) has order 4 still, f(t, y) order 1."""
    method = entry("rk4")
    for i in range(4):
        off = moved(method, ("c", i), Q(1, 10**30))
        assert order(off).order == 4
        fact = order_of(conditions_with_nodes(off))
        assert (fact.order, to_brackets(fact.failing_tree)) == (1, "[τ_t]_y")
        assert fact.residual == method.b[i] / 10**30
        assert general_order(off) == fact
        assert embedded_order(replace(off, b_embedded=off.b, embedded_order=4)) == fact
    with_nodes = entry("lobatto_iiib2")  # b·c is that of the row sums
    assert with_nodes.inconsistencies()
    assert (general_order(with_nodes).order, embedded_order(with_nodes)) == (2, None)


def test_conditions_with_nodes_are_those_of_a_longer_tableau() -> None:
    """With c = A1 every leaf weighs the same, whichever its colour; so does every tree."""
    method = entry("heun3")
    conditions = conditions_with_nodes(method)
    for n in range(1, 5):
        found = dict(residuals(conditions, n))
        by_shape: dict[Tree, set[Exact]] = {}
        for tree, x in found.items():
            if tree[:1] != ("t",):  # a tree without a leaf for the time has no colours
                by_shape.setdefault(uncoloured(tree) if tree[:1] == ("y",) else tree, set()).add(x)
        assert {shape: {x} for shape, x in residuals(runge_kutta_conditions(method), n)} == by_shape


def test_nystrom_trees_have_no_fork_at_q_and_are_fewer() -> None:
    method = METHODS["velocity_verlet"]
    assert isinstance(method, Splitting)
    counts = [
        [len(conditions.residuals(n)) for n in range(1, 9)]
        for conditions in (separable_conditions(method), nystrom_conditions(method))
    ]
    assert counts[0] == [2, 2, 4, 8, 18, 40, 96, 230]
    # v-rooted: 1, 1, 2, 3, 6, 10, 20, 36 special Nyström trees (hairer-norsett-wanner-1993, II.14); q-rooted: one less.
    v_rooted = [sum(label[1] == "v" for label, _ in nystrom_conditions(method).residuals(n)) for n in range(1, 9)]
    assert v_rooted == [1, 1, 2, 3, 6, 10, 20, 36]
    assert counts[1] == [x + y for x, y in zip(v_rooted, [1, *v_rooted], strict=False)]
    assert all(vertices(uncoloured(tree)) == 5 for tree, _ in residuals(nystrom_conditions(method), 5))
