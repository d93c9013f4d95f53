"""The catalogue: its keys, its hand-written steppers, and what stands in print of nine of its methods."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from typing import NamedTuple

import pytest
from hypothesis import given
from sympy import QQ, ring
from sympy.polys.matrices import DomainMatrix

from driftproof import Facts, strategies
from driftproof.methods import catalogue
from driftproof.methods.catalogue import METHODS, method_named
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.methods.stepping import stepper
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.convergence import local_error
from driftproof.symbolic.derivation.energy import StateDependentEnergy, energy_multiplier, invariant_quadratic
from driftproof.symbolic.derivation.one_step import determinant, matrix_of, one_step_matrix, rational, trace
from driftproof.symbolic.derivation.phase import leading_term, phase_error_series
from driftproof.symbolic.derivation.stability import stability_limit
from tests.methods.tables.entries import FILES
from tests.nine import NINE, is_printed, polynomial


def test_catalogue_holds_the_named_methods() -> None:
    named = "forward_euler symplectic_euler symplectic_euler_position_first velocity_verlet position_verlet rk4 rk38"
    assert set(METHODS) >= {*named.split(), "heun2", "midpoint2"}
    assert len(NINE) == 9
    assert all(key == method.key for key, method in METHODS.items())


def test_no_more_tables_are_read_than_it_takes_to_find_a_method() -> None:
    methods = catalogue.Catalogue(catalogue.TABLES)
    assert methods["rk4"] == METHODS["rk4"]
    assert list(methods._methods) == [method.key for method in FILES["basic"]]
    assert "no_such_method" not in methods
    assert list(methods) == list(METHODS)


def test_two_entries_with_one_key_are_refused() -> None:
    with pytest.raises(ValueError, match="share the key forward_euler"):
        len(catalogue.Catalogue(("basic", "basic")))


def test_the_other_row_of_a_pair_is_a_method_of_its_own() -> None:
    pairs = [method for method in METHODS.values() if isinstance(method, RungeKutta) and method.b_embedded is not None]
    assert len(pairs) >= 15
    for pair in pairs:
        other = method_named(f"{pair.key}_embedded")
        assert isinstance(other, RungeKutta)
        assert (other.b, other.b_embedded) == (pair.b_embedded, pair.b)
        assert (other.claimed_order, other.embedded_order) == (pair.embedded_order, pair.claimed_order)
        assert other.key not in list(METHODS)
        assert f"{other.key}_embedded" not in METHODS
    assert Facts(method_named("fehlberg45_embedded")).order == 5
    assert "rk4_embedded" not in METHODS


def test_unknown_key_names_the_closest() -> None:
    with pytest.raises(ValueError, match="unknown method 'rk5'; did you mean rk4 or ") as caught:
        method_named("rk5")
    assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match="lists all"):
        method_named("zzzzzzzz")


def splitting_order(method: Splitting) -> int:
    """Up to 2, from the coefficients alone: Σk = Σd = 1, and for order 2 half of all (drift before kick) products."""
    drifted, crossed = Q(0), Q(0)
    for kind, c in method.parts:
        drifted += c if kind == "drift" else 0
        crossed += c * drifted if kind == "kick" else 0
    return 0 if method.inconsistencies() else 1 if crossed != Q(1, 2) else 2


@given(strategies.splittings())
def test_splitting_order_condition_agrees_with_the_local_error_up_to_two(method: Splitting) -> None:
    assert min(local_error(one_step_matrix(method)).linear_order, 2) == splitting_order(method)


@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_hand_written_stepper_is_the_definition_for_every_force(key: str) -> None:
    """Over Q[h, q, v] on the oscillator, and over Q[h, q, v, w] on a quadratic force, where the stages matter more."""
    assert matrix_of(HAND_WRITTEN[key]) == one_step_matrix(NINE[key])
    polynomials, q, v, h, w = ring("q, v, h, w", QQ)
    defined = stepper(NINE[key], lambda c: polynomials.ground_new(rational(c)))
    for force in (lambda x: -(w**2) * x, lambda x: w - 3 * x**2):
        assert HAND_WRITTEN[key](force, q, v, h) == defined(force, q, v, h)
    assert HAND_WRITTEN[key](lambda x: -x, q, v, h) != defined(lambda x: x, q, v, h)


@pytest.mark.parametrize("key", NINE)
def test_one_step_matrix_is_the_printed_one_and_an_exchange_of_sub_steps_is_noticed(key: str) -> None:
    method = NINE[key]
    assert is_printed(method)
    if isinstance(method, Splitting):
        other = {"kick": "drift", "drift": "kick"}
        assert not is_printed(replace(method, parts=tuple((other[kind], c) for kind, c in method.parts)))
        assert is_printed(replace(method, parts=method.parts[::-1])) is (method.claimed_order == 2)


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
