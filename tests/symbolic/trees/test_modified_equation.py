"""The modified equation, against formal power series, logarithms, and coefficients in print."""

from __future__ import annotations

from fractions import Fraction as Q
from math import prod

import pytest

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.trees.modified_equation import BSeries, method_series, modified_equation
from driftproof.symbolic.trees.order_conditions import order
from driftproof.symbolic.trees.rooted_trees import Tree, vertices
from tests.methods.tables.entries import entry
from tests.symbolic.linear.linear_examples import gauss, radau_iia
from tests.witnesses.b_series import hamiltonian_to_order
from tests.witnesses.trees import symmetry, tall

RK4 = entry("rk4")

# --- the sum of a B-series on y' = y² from y(0) = 1, where F(t) is a number -------------------------------------------


def differential(tree: Tree) -> int:
    """F(t) at y = 1 for f = y²: f = 1, f' = 2, f'' = 2, f''' = 0."""
    return (1, 2, 2)[len(tree)] * prod(map(differential, tree)) if len(tree) < 3 else 0


def on_y_squared(series: BSeries) -> list[Exact]:
    """The coefficients of h, h², ... of B(a, 1)."""
    total: list[Exact] = [Q(0)] * series.order
    for tree, x in series.items():
        n = vertices(tree) - 1
        total[n] = total[n] + x * Q(differential(tree), symmetry(tree))
    return total


Power = list[Q]


def product(u: Power, v: Power) -> Power:
    """The product of two power series as far as both are known, constant term first."""
    return [sum((u[i] * v[k - i] for i in range(k + 1)), Q(0)) for k in range(min(len(u), len(v)))]


def composed(outer: Power, inner: Power) -> Power:
    """outer(inner(x)), by Horner's rule."""
    result = [Q(0)] * len(inner)
    for x in reversed(outer):
        result = product(result, inner)
        result[0] += x
    return result


def step_on_y_squared(method: RungeKutta, length: int) -> Power:
    """φ with hy₁ = φ(hy₀) for y' = y², as a power series: stages by iteration, each pass right to one term more."""
    x: Power = [Q(0), Q(1)] + [Q(0)] * (length - 2)

    def advanced(row: tuple[Exact, ...], slopes: list[Power]) -> Power:
        return [a + sum((Q(str(w)) * k[i] for w, k in zip(row, slopes, strict=True)), Q(0)) for i, a in enumerate(x)]

    slopes = [[Q(0)] * length] * method.stages
    for _ in range(length):
        stages = [advanced(row, slopes) for row in method.a]
        slopes = [product(u, u) for u in stages]
    return advanced(method.b, slopes)


@pytest.mark.parametrize("key", ["forward_euler", "rk4", "kutta3", "implicit_midpoint", "radau_iia2", "lobatto_iiia3"])
def test_sum_of_the_series_is_the_step_taken_on_power_series(key: str) -> None:
    method = entry(key)
    assert [Q(0), Q(1), *on_y_squared(method_series(method, 8))] == step_on_y_squared(method, 10)


@pytest.mark.parametrize("key", ["forward_euler", "rk4", "kutta3", "implicit_midpoint", "radau_iia2", "lobatto_iiia3"])
def test_modified_equation_on_y_squared_has_the_step_as_its_flow(key: str) -> None:
    """v(φ(x)) = φ'(x) v(x): the field v carried along by its own flow φ (Julia's equation), as power series."""
    method, length = entry(key), 10
    phi = step_on_y_squared(method, length)
    field = [Q(0), Q(0), *map(Q, map(str, on_y_squared(modified_equation(method, 8))))]
    slope = [*(k * x for k, x in enumerate(phi) if k), Q(0)]
    assert composed(field, phi) == product(slope, field)
    field[-1] += 1
    field[-2] += 1
    assert composed(field, phi) != product(slope, field)


# hairer-lubich-wanner-2006, IX.1 and IX.9: f₂ and f₃ by elementary differentials of τ, [τ], [τ,τ] and [[τ]]; b(t) is
# σ(t) times these.
FIELDS = {
    "forward_euler": {(): 1, ((),): Q(-1, 2), ((), ()): Q(1, 12) * 2, (((),),): Q(1, 3)},
    "implicit_midpoint": {(): 1, ((),): 0, ((), ()): Q(-1, 24) * 2, (((),),): Q(1, 12)},
}


@pytest.mark.parametrize("key", FIELDS)
def test_modified_equation_has_the_printed_differentials(key: str) -> None:
    assert dict(modified_equation(entry(key), 3).items()) == FIELDS[key]


@pytest.mark.parametrize("key", ["rk4", "heun3", "radau_iia3", "lobatto_iiic3"])
def test_tall_trees_of_the_modified_equation_are_the_logarithm_of_r(key: str) -> None:
    """On y' = λy only they count: Σ b(tall) zⁿ = log R(z), so that R' = R (log R)'."""
    method = entry(key)
    weights, field = (dict(series(method, 9).items()) for series in (method_series, modified_equation))
    r = [Q(1), *(Q(str(weights[tall(n)])) for n in range(1, 10))]
    log_slope = [n * Q(str(field[tall(n)])) for n in range(1, 10)]
    assert [n * x for n, x in enumerate(r)][1:] == product(r, log_slope)
    assert log_slope[: order(method).order] == [1] + [0] * (order(method).order - 1)


@pytest.mark.parametrize("stages", [2, 3, 4, 5])
def test_modified_equation_of_collocation_needs_no_radicals(stages: int) -> None:
    """Gauss of order p keeps the first p - 1 corrections zero; what remains is Hamiltonian and of odd order."""
    field = modified_equation(gauss(stages), 7)
    first = next((vertices(tree) for tree, x in field.items() if x and tree), None)
    assert first == (2 * stages + 1 if stages < 4 else None)
    assert hamiltonian_to_order(field) == 7
    assert hamiltonian_to_order(modified_equation(radau_iia(2), 7)) == 3


def test_modified_equation_in_a_field_is_that_without_radicals() -> None:
    assert list(modified_equation(entry("gauss3"), 8).items()) == list(modified_equation(gauss(3), 8).items())
