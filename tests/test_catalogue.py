"""Every catalogue entry is tied to something that is not its own step: order conditions, R(z), shears, print."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from functools import reduce
from typing import Any, NamedTuple

import pytest
from hypothesis import given
from sympy import QQ, ring
from sympy.polys.matrices import DomainMatrix

from driftproof import strategies
from methods import catalogue
from methods.catalogue import METHODS, method_named
from methods.schemes import Method, RungeKutta, Splitting
from methods.stepping import stepper
from numeric.steppers import HAND_WRITTEN
from symbolic.convergence import local_error
from symbolic.energy import StateDependentEnergy, energy_multiplier, invariant_quadratic
from symbolic.one_step import RING, H, determinant, matrix, matrix_of, one_step_matrix, rational, trace
from symbolic.phase import leading_term, phase_error_series
from symbolic.stability import stability_limit
from symbolic.trees.order import failing_condition
from symbolic.trees.order import order as tree_order
from tests.nine import NINE

RUNGE_KUTTA = [method for method in NINE.values() if isinstance(method, RungeKutta)]
SPLITTINGS = [method for method in NINE.values() if isinstance(method, Splitting)]


def by_key(method: Method) -> str:
    return method.key


def test_catalogue_holds_the_named_methods() -> None:
    named = "forward_euler symplectic_euler symplectic_euler_position_first velocity_verlet position_verlet rk4 rk38"
    assert set(METHODS) >= {*named.split(), "heun2", "midpoint2"}
    assert len(RUNGE_KUTTA) + len(SPLITTINGS) == len(NINE) == 9
    assert all(key == method.key for key, method in METHODS.items())


def test_two_entries_with_one_key_are_refused() -> None:
    with pytest.raises(ValueError, match="share the key rk4"):
        catalogue._by_key((METHODS["rk4"], METHODS["rk4"]))


def test_unknown_key_names_the_closest() -> None:
    with pytest.raises(ValueError, match="unknown method 'rk5'; did you mean rk4 or rk38") as caught:
        method_named("rk5")
    assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match="lists all"):
        method_named("zzzzzzzz")


@pytest.mark.parametrize("method", NINE.values(), ids=by_key)
def test_entry_is_consistent_and_says_where_it_comes_from(method: Method) -> None:
    assert method.inconsistencies() == {}
    assert re.fullmatch(r"[a-z-]+-\d{4}, \S.*", method.source)
    assert method.title == method.title.strip() != ""


@pytest.mark.parametrize("method", RUNGE_KUTTA, ids=by_key)
def test_runge_kutta_has_the_claimed_order_and_not_the_next(method: RungeKutta) -> None:
    order = method.claimed_order
    assert all(failing_condition(method, p) is None for p in range(1, order + 1))
    tree, residual = failing_condition(method, order + 1) or ((), 0)
    assert residual != 0, tree
    assert tree_order(method).order == order


def splitting_order(method: Splitting) -> int:
    """Up to 2, from the coefficients alone: Σk = Σd = 1, and for order 2 half of all (drift before kick) products."""
    drifted, crossed = Q(0), Q(0)
    for kind, c in method.parts:
        drifted += c if kind == "drift" else 0
        crossed += c * drifted if kind == "kick" else 0
    return 0 if method.inconsistencies() else 1 if crossed != Q(1, 2) else 2


@pytest.mark.parametrize("method", SPLITTINGS, ids=by_key)
def test_splitting_has_the_claimed_order_and_not_the_next(method: Splitting) -> None:
    assert splitting_order(method) == method.claimed_order == local_error(one_step_matrix(method)).linear_order


@given(strategies.splittings())
def test_splitting_order_condition_agrees_with_the_local_error_up_to_two(method: Splitting) -> None:
    assert min(local_error(one_step_matrix(method)).linear_order, 2) == splitting_order(method)


def matrix_by_determinants(method: RungeKutta) -> DomainMatrix:
    """R(hJ), from R(z) = det(I - zA + z 1 bᵀ) / det(I - zA) with z = hi, Re R and Im R the entries: no step is run."""
    polynomials, z = ring("z", QQ)
    a = [[rational(x) for x in row] for row in method.a]
    b = [rational(x) for x in method.b]
    s = range(method.stages)
    unit = [[polynomials.one if i == j else polynomials.zero for j in s] for i in s]
    below = DomainMatrix([[unit[i][j] - z * a[i][j] for j in s] for i in s], (len(s), len(s)), polynomials.to_domain())
    above = DomainMatrix(
        [[unit[i][j] - z * a[i][j] + z * b[j] for j in s] for i in s], (len(s), len(s)), polynomials.to_domain()
    )
    assert below.det() == polynomials.one  # an explicit method: A is nilpotent
    real = imaginary = RING.zero
    for (k,), coefficient in above.det().terms():
        turned = coefficient * H**k * (-1 if k % 4 in (2, 3) else 1)  # iᵏ is 1, i, -1, -i
        real, imaginary = (real + turned, imaginary) if k % 2 == 0 else (real, imaginary + turned)
    return matrix([[real, imaginary], [-imaginary, real]])  # J = [[0, 1], [-1, 0]] plays i


@pytest.mark.parametrize("method", RUNGE_KUTTA, ids=by_key)
def test_one_step_matrix_is_the_stability_function_of_determinants(method: RungeKutta) -> None:
    assert one_step_matrix(method) == matrix_by_determinants(method)


@given(strategies.runge_kutta_methods())
def test_stability_function_of_determinants_holds_for_drawn_methods(method: RungeKutta) -> None:
    assert one_step_matrix(method) == matrix_by_determinants(method)


def matrix_by_shears(method: Splitting) -> DomainMatrix:
    """The product of [[1, 0], [-ch, 1]] for a kick and [[1, ch], [0, 1]] for a drift, the last one leftmost."""
    shears = [
        matrix([[1, 0], [-rational(c) * H, 1]]) if kind == "kick" else matrix([[1, rational(c) * H], [0, 1]])
        for kind, c in method.parts
    ]
    return reduce(lambda product, shear: shear * product, shears)


@pytest.mark.parametrize("method", SPLITTINGS, ids=by_key)
def test_one_step_matrix_is_the_product_of_shears(method: Splitting) -> None:
    assert one_step_matrix(method) == matrix_by_shears(method)


@given(strategies.splittings())
def test_drawn_splitting_is_a_product_of_shears_and_keeps_area(method: Splitting) -> None:
    assert one_step_matrix(method) == matrix_by_shears(method)
    assert determinant(one_step_matrix(method)) == 1


def test_witnesses_tell_methods_apart() -> None:
    assert matrix_by_determinants(NINE["heun2"]) != matrix_by_determinants(NINE["rk4"])
    assert matrix_by_shears(NINE["symplectic_euler"]) != matrix_by_shears(NINE["symplectic_euler_position_first"])
    assert determinant(one_step_matrix(NINE["rk4"])) != 1


@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_hand_written_stepper_is_the_definition_for_every_force(key: str) -> None:
    """Over Q[h, q, v] on the oscillator, and over Q[h, q, v, w] on a quadratic force, where the stages matter more."""
    assert matrix_of(HAND_WRITTEN[key]) == one_step_matrix(NINE[key])
    polynomials, q, v, h, w = ring("q, v, h, w", QQ)
    defined = stepper(NINE[key], lambda c: polynomials.ground_new(rational(c)))
    for force in (lambda x: -(w**2) * x, lambda x: w - 3 * x**2):
        assert HAND_WRITTEN[key](force, q, v, h) == defined(force, q, v, h)
    assert HAND_WRITTEN[key](lambda x: -x, q, v, h) != defined(lambda x: x, q, v, h)


class Published(NamedTuple):
    """Facts that are in print, typed from there and not from the code; polynomials are in powers of h, ascending."""

    trace: list[Q | int]
    determinant: list[Q | int]
    energy: list[Q | int] | None  # the multiplier, None where the change depends on the state
    invariant: tuple[list[Q | int], list[Q | int], list[Q | int]] | None  # coefficients of q², qv, v²
    limit: str  # of stability on q'' = -q, in SymPy syntax
    phase: tuple[int, Q]  # leading term of the phase error per step


LEAPFROG = {"trace": [2, 0, -1], "determinant": [1], "energy": None, "limit": "2", "phase": (3, Q(1, 24))}
HALF = [Q(1, 2)]
SHORTENED = [Q(1, 2), 0, Q(-1, 8)]  # ½(1 - h²/4)
SECOND_ORDER = Published([2, 0, -1], [1, 0, 0, 0, Q(1, 4)], [1, 0, 0, 0, Q(1, 4)], None, "0", (3, Q(1, 6)))
FOURTH_ORDER = Published(
    [2, 0, -1, 0, Q(1, 12)],
    [1, 0, 0, 0, 0, 0, Q(-1, 72), 0, Q(1, 576)],
    [1, 0, 0, 0, 0, 0, Q(-1, 72), 0, Q(1, 576)],
    None,
    "2*sqrt(2)",
    (5, Q(-1, 120)),
)
PUBLISHED = {
    "forward_euler": Published([2], [1, 0, 1], [1, 0, 1], None, "0", (3, Q(-1, 3))),
    "symplectic_euler": Published(**LEAPFROG, invariant=(HALF, [0, Q(-1, 2)], HALF)),
    "symplectic_euler_position_first": Published(**LEAPFROG, invariant=(HALF, [0, Q(1, 2)], HALF)),
    "velocity_verlet": Published(**LEAPFROG, invariant=(SHORTENED, [], HALF)),
    "position_verlet": Published(**LEAPFROG, invariant=(HALF, [], SHORTENED)),
    "heun2": SECOND_ORDER,
    "midpoint2": SECOND_ORDER,
    "rk4": FOURTH_ORDER,
    "rk38": FOURTH_ORDER,
}


def polynomial(ascending: list[Q | int]) -> Any:
    return sum((rational(c) * H**k for k, c in enumerate(ascending)), RING.zero)


def facts(m: DomainMatrix) -> Published:
    """The same facts, derived. The polynomials are elements of Q[h]."""
    try:
        energy, invariant = energy_multiplier(m), None
    except StateDependentEnergy:
        energy, invariant = None, tuple(invariant_quadratic(m))
    phase = leading_term(phase_error_series(m, 7))
    return Published(trace(m), determinant(m), energy, invariant, str(stability_limit(m)), phase)


@pytest.mark.parametrize("key", NINE)
def test_derived_facts_are_the_published_ones(key: str) -> None:
    published, derived = PUBLISHED[key], facts(one_step_matrix(NINE[key]))
    assert derived.trace == polynomial(published.trace)
    assert derived.determinant == polynomial(published.determinant)
    assert derived.energy == (None if published.energy is None else polynomial(published.energy))
    assert derived.invariant == (published.invariant and tuple(polynomial(c) for c in published.invariant))
    assert derived.limit == published.limit
    assert derived.phase == (published.phase[0], rational(published.phase[1]))


def test_published_facts_tell_the_methods_apart_except_twins() -> None:
    """Two methods share all their facts only where they share the one-step matrix, as rk4 and rk38 do here."""
    twins = {(a, b) for a in NINE for b in NINE if a < b and PUBLISHED[a] == PUBLISHED[b]}
    assert twins == {("heun2", "midpoint2"), ("rk38", "rk4")}
    assert all(one_step_matrix(NINE[a]) == one_step_matrix(NINE[b]) for a, b in twins)
    assert len({NINE[key] for pair in twins for key in pair}) == 4
