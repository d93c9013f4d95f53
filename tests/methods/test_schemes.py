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
from driftproof.methods.schemes import Collocation, MethodError, Nystrom, RungeKutta, Splitting
from driftproof.methods.stepping import stepper
from tests.looping import some

HEUN = {"a": ((0, 0), (1, 0)), "b": (Q(1, 2), Q(1, 2)), "c": (0, 1)}
NAMED = {"key": "mine", "title": "Mine", "claimed_order": 2, "source": "me-2024, 1"}


def runge_kutta(**changed: Any) -> RungeKutta:
    return RungeKutta(**{**NAMED, **HEUN, **changed})


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


INEXACT = [0.5, np.float64(0.5), np.int64(1), sympy.Rational(1, 2), "1/2", True, None, 1j]


@pytest.mark.parametrize("value", INEXACT, ids=repr)
@pytest.mark.parametrize(
    ("build", "place"),
    [
        (lambda x: runge_kutta(a=((0, 0), (x, 0))), "mine: a[1][0]"),
        (lambda x: runge_kutta(b=(x, 1)), "mine: b[0]"),
        (lambda x: runge_kutta(c=(0, x)), "mine: c[1]"),
        (lambda x: splitting((("kick", 1), ("drift", x))), "mine: parts[1]"),
    ],
)
def test_inexact_coefficient_is_refused_with_its_place(build: Callable[[Any], Any], place: str, value: object) -> None:
    assert refusal(lambda: build(value)).startswith(f"{place} is {value!r} ({type(value).__name__}); coefficients")


WRONG: list[tuple[Callable[[], Any], str]] = [
    (lambda: runge_kutta(b=()), "mine: b is empty; a method has at least one stage"),
    (lambda: runge_kutta(a=((0, 0),)), "mine: a has 1 entries, b has 2; they must agree"),
    (lambda: runge_kutta(a=((0, 0), (1,))), "mine: a[1] has 1 entries, b has 2; they must agree"),
    (lambda: runge_kutta(c=(0, 1, 2)), "mine: c has 3 entries, b has 2; they must agree"),
    (lambda: runge_kutta(a=5), "mine: a is 5; write a tuple of exact coefficients"),
    (lambda: runge_kutta(a="00"), "mine: a is '00'; write a tuple of exact coefficients"),
    (lambda: runge_kutta(a=(0, 1)), "mine: a[0] is 0; write a tuple of exact coefficients"),
    (lambda: runge_kutta(b="11"), "mine: b is '11'; write a tuple of exact coefficients"),
    (lambda: splitting(()), "mine: parts is empty; a splitting has at least one kick or drift"),
    (lambda: splitting(p for p in ()), "mine: parts is empty; a splitting has at least one kick or drift"),
    (lambda: splitting(5), "mine: parts is 5; write a tuple of exact coefficients"),
    (lambda: splitting((("kick", 1), ("push", 1))), "mine: parts[1] is ('push', 1); write ('kick', c) or ('drift', c)"),
    (lambda: splitting((("kick", 1, 1),)), "mine: parts[0] is ('kick', 1, 1); write ('kick', c) or ('drift', c)"),
    (lambda: splitting(("kick",)), "mine: parts[0] is 'kick'; write ('kick', c) or ('drift', c)"),
]


@pytest.mark.parametrize(("build", "message"), WRONG, ids=range(len(WRONG)))
def test_malformed_definition_is_refused_in_one_line(build: Callable[[], Any], message: str) -> None:
    assert refusal(build) == message


def refusal(build: Callable[[], Any]) -> str:
    with pytest.raises(MethodError) as caught:
        build()
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("method", [runge_kutta(), splitting((("kick", 1),))])
def test_definitions_are_frozen(method: RungeKutta | Splitting) -> None:
    for field in some(dataclasses.fields(method), 4):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(method, field.name, None)


def test_explicit_is_read_off_the_tableau() -> None:
    assert runge_kutta().explicit
    assert not runge_kutta(a=((0, 0), (1, Q(1, 10**40)))).explicit
    assert not runge_kutta(a=((0, -1), (1, 0))).explicit


def test_implicit_method_has_no_explicit_step() -> None:
    with pytest.raises(MethodError, match="mine is implicit: its stages are equations"):
        stepper(runge_kutta(a=((0, 0), (1, 1))), lambda c: c)


def test_inconsistency_is_reported_with_its_residual_and_not_refused() -> None:
    tiny = Q(1, 10**30)
    assert runge_kutta().inconsistencies() == {}
    assert runge_kutta(b=(Q(1, 2), Q(1, 2) + tiny)).inconsistencies() == {"sum(b) - 1": tiny}
    assert runge_kutta(c=(0, 1 - tiny)).inconsistencies() == {"c[1] - sum(a[1])": -tiny}
    assert splitting((("kick", Q(1, 2)), ("drift", 1))).inconsistencies() == {"sum(kicks) - 1": Q(-1, 2)}
    assert splitting((("kick", 1),)).inconsistencies() == {"sum(drifts) - 1": Q(-1)}
    nystrom = Nystrom("m", "m", 0, "", (Q(0), Q(1, 2)), ((0, 0), (tiny, 0)), (Q(1, 2), 0), (0, 1))
    assert nystrom.inconsistencies() == {"sum(a[1]) - c[1]**2/2": tiny - Q(1, 8)}
    # Collocation integrates constants exactly whatever its nodes: as its own tableau, it has rows that sum to c and 1.
    at = Collocation(**NAMED, node_polynomial=(Q(1, 8), Q(-3, 4), 1))
    a, b, c = at.tableau(64)
    assert (at.inconsistencies(), RungeKutta(**NAMED, a=a, b=b, c=c).inconsistencies()) == ({}, {})


@given(strategies.runge_kutta_methods())
def test_drawn_runge_kutta_methods_are_explicit_and_consistent(method: RungeKutta) -> None:
    assert method.explicit
    assert method.inconsistencies() == {}


@given(strategies.splittings())
def test_drawn_splittings_are_consistent(method: Splitting) -> None:
    assert method.inconsistencies() == {}
    assert dataclasses.replace(method, parts=method.parts[1:]).inconsistencies() != {} or method.parts[0][1] == 0


def test_step_takes_its_coefficients_through_lift_only() -> None:
    lifted: list[Q] = []

    def lift(c: Q) -> Q:
        lifted.append(c)
        return c

    step = stepper(runge_kutta(), lift)
    assert lifted == [Q(1, 2), Q(1, 2)]  # zeros and ones are dropped
    step(lambda q: -q, Q(1), Q(0), Q(1, 4))
    assert len(lifted) == 2
