"""Every method in `methods` has the order, and the order of its second row, that its source claims: exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction as Q
from importlib import import_module
from pkgutil import iter_modules

import pytest

import methods.tables
from methods.catalogue import METHODS
from methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from symbolic.trees.alternating import nystrom_conditions, nystrom_order, separable_conditions, separable_order
from symbolic.trees.order import (
    Conditions,
    embedded_conditions,
    embedded_order,
    order,
    order_of,
    order_to_tolerance,
    runge_kutta_conditions,
)
from symbolic.trees.rooted import AnyTree


def _tabulated() -> Iterator[Method]:
    for module in iter_modules(methods.tables.__path__):
        yield from getattr(import_module(f"methods.tables.{module.name}"), "ENTRIES", ())


# The tables' methods by key, whether or not the catalogue lists them yet.
EVERY: dict[str, Method] = {method.key: method for method in _tabulated()} | METHODS
EXACT = {key: method for key, method in EVERY.items() if not method.decimal}
DECIMAL = {key: method for key, method in EVERY.items() if method.decimal}


def runge_kutta(key: str) -> RungeKutta:
    method = EVERY[key]
    assert isinstance(method, RungeKutta)
    return method


def splitting(key: str) -> Splitting:
    method = EVERY[key]
    assert isinstance(method, Splitting)
    return method


def conditions(method: Method) -> Conditions[AnyTree]:
    """The conditions on the class of problems for which the method's source claims its order."""
    if isinstance(method, RungeKutta | Collocation):
        return runge_kutta_conditions(method)
    if isinstance(method, Splitting) and not method.quadratic_kinetic:
        return separable_conditions(method)
    return nystrom_conditions(method)


@pytest.mark.parametrize("key", EXACT)
def test_order_is_the_claimed_one_and_the_next_order_fails(key: str) -> None:
    method = EXACT[key]
    fact = order(method) if isinstance(method, Collocation) else order_of(conditions(method))
    assert fact.order == method.claimed_order
    assert fact.residual != 0


@pytest.mark.parametrize("key", [key for key, method in EXACT.items() if isinstance(method, RungeKutta)])
def test_order_of_the_second_row_is_the_claimed_one(key: str) -> None:
    method = runge_kutta(key)
    fact = embedded_order(method)
    assert (fact and fact.order) == method.embedded_order


@pytest.mark.parametrize("key", DECIMAL)
def test_order_of_a_rounded_table_is_claimed_to_its_last_digits_and_is_less_exactly(key: str) -> None:
    """Digits that were rounded meet no condition of high order exactly; 10**-9 is coarser than every printed table."""
    method = DECIMAL[key]
    assert order_to_tolerance(conditions(method), Q(1, 10**9)) == method.claimed_order
    assert order_of(conditions(method)).order < method.claimed_order
    second = embedded_conditions(method) if isinstance(method, RungeKutta) else None
    if second is not None:
        assert order_to_tolerance(second, Q(1, 10**9)) == getattr(method, "embedded_order", None)


def test_rows_of_a_pair_are_not_confused() -> None:
    pair = runge_kutta("fehlberg78")
    swapped = replace(pair, b=pair.b_embedded, b_embedded=pair.b)
    assert (order(pair).order, order(swapped).order) == (pair.claimed_order, pair.embedded_order)
    assert pair.claimed_order != pair.embedded_order
    assert embedded_order(runge_kutta("rk4")) is None


@pytest.mark.parametrize(
    ("key", "linear", "separable"),
    [
        ("mclachlan_atela4", 4, 3),
        ("mclachlan_atela5", 5, 3),
        ("blanes_moan_rkn6a", 6, 4),
        ("blanes_moan_rkn6b", 6, 4),
        # Symmetric: its even order is one for free, and up to order 3 there is no difference.
        ("blanes_moan_rkn4", 4, 4),
    ],
)
def test_orders_for_linear_drifts_and_for_separable_problems_are_two_facts(
    key: str, linear: int, separable: int
) -> None:
    method, tolerance = splitting(key), Q(1, 10**9)
    found = [
        order_to_tolerance(conditions(method), tolerance) for conditions in (nystrom_conditions, separable_conditions)
    ]
    assert found == [linear, separable]


@pytest.mark.parametrize("key", [key for key, method in EXACT.items() if isinstance(method, Splitting)])
def test_order_for_linear_drifts_is_never_less_than_for_separable_problems(key: str) -> None:
    assert nystrom_order(splitting(key)).order >= separable_order(splitting(key)).order


def test_conditions_of_every_kind_of_method_are_tried_here() -> None:
    assert {type(method) for method in EVERY.values()} == {RungeKutta, Splitting, Nystrom, Collocation}
    assert {type(method) for method in DECIMAL.values()} >= {RungeKutta, Splitting}
