"""The catalogue: its keys, its hand-written steppers, and the printed one-step matrices of nine of its methods."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest
from hypothesis import given
from sympy import QQ, ring

from driftproof import Facts, strategies
from driftproof.methods import catalogue
from driftproof.methods.catalogue import METHODS, entry_named
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.one_step import matrix_of, one_step_matrix, rational
from proofs.derivations.convergence import local_error
from tests.methods.tables.entries import FILES
from tests.nine import NINE, is_printed


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
        other = entry_named(f"{pair.key}_embedded")
        assert isinstance(other, RungeKutta)
        assert (other.b, other.b_embedded) == (pair.b_embedded, pair.b)
        assert (other.claimed_order, other.embedded_order) == (pair.embedded_order, pair.claimed_order)
        assert other.key not in list(METHODS)
        assert f"{other.key}_embedded" not in METHODS
    assert Facts(entry_named("fehlberg45_embedded")).order == 5
    assert "rk4_embedded" not in METHODS


def test_unknown_key_names_the_closest() -> None:
    with pytest.raises(ValueError, match="unknown method 'rk5'; did you mean rk4 or ") as caught:
        entry_named("rk5")
    assert "\n" not in str(caught.value)
    assert repr(METHODS).endswith(" by key: forward_euler, symplectic_euler, symplectic_euler_position_first, ...>")
    for wrong, near in (
        ("Eulr", "; did you mean Euler"),
        ("Cranc-Nicolson", "; did you mean Crank-Nic"),
        ("zzzzzzzz", ""),
    ):
        with pytest.raises(ValueError, match=rf"unknown method '{wrong}'{near}.* \(.* lists all"):
            entry_named(wrong)


@pytest.mark.parametrize(("name", "corrector"), [
    ("abm4", "adams_moulton3"), ("ABM2", "trapezoid"), ("Adams-Bashforth-Moulton 6", "adams_moulton5"),
    ("abm4-PECECE", "adams_moulton3"),
])  # fmt: skip
def test_a_corrected_multistep_method_is_told_who_knows_it_and_what_to_give(name: str, corrector: str) -> None:
    said = f"'{name}' is corrected a fixed .* `driftproof verify` .* adams_bashforth[2-6] or {corrector}, or in exact"
    with pytest.raises(ValueError, match=said):
        entry_named(name)
    entry_named(corrector)
    with pytest.raises(ValueError, match="unknown method 'abm7'"):
        entry_named("abm7")


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
