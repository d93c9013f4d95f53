"""Definitions are exact, frozen and validated: what is refused, in which words, and what is only reported."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from fractions import Fraction as Q
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given

from driftproof import strategies
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import Collocation, MethodError, Nystrom, RungeKutta, Splitting

NAMED = {"key": "mine", "title": "Mine", "claimed_order": 2, "source": "me-2024, 1"}
ROOT_2, ROOT_3 = square_root(2), square_root(3)
HEUN = RungeKutta(**NAMED, a=((0, 0), (1, 0)), b=(Q(1, 2), Q(1, 2)), c=(0, 1))
KICKS = Splitting(**NAMED, parts=(("kick", 1),))
NYSTROM = Nystrom(**NAMED, c=(0,), a=((0,),), b_position=(1,), b_velocity=(1,))
GAUSS = Collocation(**NAMED, node_polynomial=(Q(-1, 2), 1))


def runge_kutta(**changed: Any) -> RungeKutta:
    return dataclasses.replace(HEUN, **changed)


def splitting(parts: Any) -> Splitting:
    return Splitting(**NAMED, parts=parts)


def test_integers_become_fractions_and_lists_become_tuples() -> None:
    method = runge_kutta(a=[[0, 0], [1, 0]], c=iter([0, 1]))
    assert method == runge_kutta()
    assert all(type(x) is Q for row in (*method.a, method.b, method.c) for x in row)
    assert hash(method) == hash(runge_kutta())


def test_splitting_parts_may_come_from_a_generator() -> None:
    parts = (("kick", 1), ("drift", Q(1)))
    assert splitting(part for part in parts).parts == parts
    assert all(type(c) is Q for _, c in splitting(list(parts)).parts)
    assert [KICKS.quadratic_kinetic, *(method.decimal for method in (KICKS, NYSTROM, HEUN))] == 4 * [False]


INEXACT = [0.5, np.float64(0.5), np.int64(1), sympy.Rational(1, 2), "1/2", True, None, 1j]


@pytest.mark.parametrize("value", INEXACT, ids=repr)
@pytest.mark.parametrize(
    ("build", "place"),
    [
        (lambda x: runge_kutta(a=((0, 0), (x, 0))), "mine: a[1][0]"),
        (lambda x: runge_kutta(b=(x, 1)), "mine: b[0]"),
        (lambda x: runge_kutta(c=(0, x)), "mine: c[1]"),
        (lambda x: runge_kutta(b_embedded=(x, 1), embedded_order=1), "mine: b_embedded[0]"),
        (lambda x: splitting((("kick", 1), ("drift", x))), "mine: parts[1]"),
    ],
)
def test_inexact_coefficient_is_refused_with_its_place(build: Callable[[Any], Any], place: str, value: object) -> None:
    assert refusal(lambda: build(value)).startswith(f"{place} is {value!r} ({type(value).__name__}); coefficients")


PART, TUPLE, PAIR = "write ('kick', c) or ('drift', c)", "write a tuple of exact coefficients", {"embedded_order": 1}
FIELDS = "coefficients lie in the fields of sqrt(2) and sqrt(3); write them in one field"
ROOTS = "node_polynomial has a complex or a multiple root"


@pytest.mark.parametrize(
    ("method", "changes", "message"),
    [
        (HEUN, {"b": ()}, "b is empty; a method has at least one stage"),
        (HEUN, {"a": ((0, 0),)}, "a has 1 entries, b has 2; they must agree"),
        (HEUN, {"a": ((0, 0), (1,))}, "a[1] has 1 entries, b has 2; they must agree"),
        (HEUN, {"c": (0, 1, 2)}, "c has 3 entries, b has 2; they must agree"),
        (HEUN, {"a": 5}, f"a is 5; {TUPLE}"), (HEUN, {"a": "00"}, f"a is '00'; {TUPLE}"),
        (HEUN, {"a": (0, 1)}, f"a[0] is 0; {TUPLE}"), (HEUN, {"b": "11"}, f"b is '11'; {TUPLE}"),
        (HEUN, {"a": ((0, 0), (ROOT_3, 0)), "b": (1, ROOT_2)}, FIELDS),
        (HEUN, {"b_embedded": (1, 0)}, "b_embedded and embedded_order must be given together"),
        (HEUN, PAIR, "b_embedded and embedded_order must be given together"),
        (HEUN, {"b_embedded": (1,), **PAIR}, "b_embedded has 1 entries, b has 2; they must agree"),
        (KICKS, {"parts": ()}, "parts is empty; a splitting has at least one kick or drift"),
        (KICKS, {"parts": iter(())}, "parts is empty; a splitting has at least one kick or drift"),
        (KICKS, {"parts": 5}, f"parts is 5; {TUPLE}"),
        (KICKS, {"parts": (("kick", 1), ("push", 1))}, f"parts[1] is ('push', 1); {PART}"),
        (KICKS, {"parts": (("kick", 1, 1),)}, f"parts[0] is ('kick', 1, 1); {PART}"),
        (KICKS, {"parts": ("kick",)}, f"parts[0] is 'kick'; {PART}"),
        (KICKS, {"parts": (("kick", ROOT_3), ("drift", ROOT_2))}, FIELDS),
        (NYSTROM, {"a": ((0, 0),)}, "a[0] has 2 entries, b_velocity has 1; they must agree"),
        (NYSTROM, {"b_position": (1, 2)}, "b_position has 2 entries, b_velocity has 1; they must agree"),
        (NYSTROM, {"b_velocity": ()}, "b_velocity is empty; a method has at least one stage"),
        (GAUSS, {"node_polynomial": (1, 0)}, "node_polynomial is constant; a method has at least one node"),
        (GAUSS, {"node_polynomial": (1, 0, 1)}, ROOTS), (GAUSS, {"node_polynomial": (1, -2, 1)}, ROOTS),
        (
            GAUSS,
            {"node_polynomial": (ROOT_3, 1)},
            "node_polynomial has irrational coefficients; rational ones are needed",
        ),
    ],
)  # fmt: skip
def test_malformed_definition_is_refused_in_one_line(method: Any, changes: dict[str, Any], message: str) -> None:
    assert refusal(lambda: dataclasses.replace(method, **changes)) == f"mine: {message}"


def refusal(build: Callable[[], Any]) -> str:
    with pytest.raises(MethodError) as caught:
        build()
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_explicit_is_read_off_the_tableau() -> None:
    assert runge_kutta().explicit
    assert not runge_kutta(a=((0, 0), (1, Q(1, 10**40)))).explicit
    assert not runge_kutta(a=((0, -1), (1, 0))).explicit


def test_inconsistency_is_reported_with_its_residual_and_not_refused() -> None:
    tiny = Q(1, 10**30)
    assert runge_kutta().inconsistencies() == {}
    assert runge_kutta(b=(Q(1, 2), Q(1, 2) + tiny)).inconsistencies() == {"sum(b) - 1": tiny}
    assert runge_kutta(c=(0, 1 - tiny)).inconsistencies() == {"c[1] - sum(a[1])": -tiny}
    assert splitting((("kick", Q(1, 2)), ("drift", 1))).inconsistencies() == {"sum(kicks) - 1": Q(-1, 2)}
    assert splitting((("kick", 1),)).inconsistencies() == {"sum(drifts) - 1": Q(-1)}
    nystrom = Nystrom("m", "m", 0, "", (Q(0), Q(1, 2)), ((0, 0), (tiny, 0)), (Q(1, 2), 0), (0, 1))
    assert nystrom.inconsistencies() == {}, "explicit symplectic methods have no stages of order 2"
    rounded = dataclasses.replace(nystrom, a=((0, 0), (Q(1, 8) + tiny, 0)))
    assert rounded.inconsistencies() == {"sum(a[1]) - c[1]**2/2": tiny}
    assert NYSTROM.inconsistencies() == {"sum(b_position) - 1/2": Q(1, 2)}
    # Collocation integrates constants exactly whatever its nodes: as its own tableau, it has rows that sum to c and 1.
    at = Collocation(**NAMED, node_polynomial=(Q(1, 8), Q(-3, 4), 1))
    a, b, c = at.tableau(64)
    assert (at.inconsistencies(), RungeKutta(**NAMED, a=a, b=b, c=c).inconsistencies()) == ({}, {})


def test_rational_element_of_a_field_becomes_a_fraction() -> None:
    method = RungeKutta(**NAMED, a=((ROOT_3 - ROOT_3,),), b=(ROOT_3 * ROOT_3 / 3,), c=(0,))
    assert (method.a, method.b, method.field) == (((Q(0),),), (Q(1),), None)
    assert type(method.a[0][0]) is type(method.b[0]) is Q
    assert (method.explicit, method.inconsistencies()) == (True, {})


def test_residual_of_an_irrational_tableau_is_exact() -> None:
    method = RungeKutta(**NAMED, a=((ROOT_3,),), b=(ROOT_3,), c=(0,))
    assert method.inconsistencies() == {"sum(b) - 1": ROOT_3 - 1, "c[0] - sum(a[0])": -ROOT_3}


def test_node_polynomial_is_made_monic() -> None:
    method = Collocation(**NAMED, node_polynomial=(Q(-1), Q(2), Q(0)))
    assert method.node_polynomial == (Q(-1, 2), Q(1))
    assert (method.stages, method.explicit, method.decimal, method.field) == (1, False, False, None)


@given(strategies.runge_kutta_methods())
def test_drawn_runge_kutta_methods_are_explicit_and_consistent(method: RungeKutta) -> None:
    assert method.explicit
    assert method.inconsistencies() == {}


@given(strategies.splittings())
def test_drawn_splittings_are_consistent(method: Splitting) -> None:
    assert method.inconsistencies() == {}
    assert dataclasses.replace(method, parts=method.parts[1:]).inconsistencies() != {} or method.parts[0][1] == 0
