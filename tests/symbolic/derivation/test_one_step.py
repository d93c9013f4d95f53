"""The exact one-step matrix: what it accepts, what it refuses, and that it is the step."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given

from driftproof import strategies
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.symbolic.derivation.one_step import (
    RING,
    H,
    at_rational,
    determinant,
    entries,
    expression,
    matrix,
    matrix_at,
    matrix_of,
    one_step_matrix,
    rational,
    trace,
)
from driftproof.symbolic.runs import apply
from tests.nine import NINE


@pytest.mark.parametrize("value", [0.1, np.float64(0.5), np.int64(1), True, "1", None, sympy.Rational(1, 2)], ids=repr)
def test_inexact_number_never_enters_exact_arithmetic(value: Any) -> None:
    with pytest.raises(TypeError, match="exact arithmetic takes int or Fraction"):
        rational(value)


def test_the_ring_itself_would_guess_a_float_back() -> None:
    """Why `rational` is the only way in: SymPy turns 0.1 into 1/10, which the double is not."""
    assert 0.1 * H == H / 10
    assert at_rational(H, Q(0.1)) != Q(1, 10)


METHODS = strategies.runge_kutta_methods() | strategies.splittings()


@given(METHODS, strategies.rational_steps(), strategies.rational_states())
def test_matrix_times_state_is_the_step_of_a_method(method: Any, h: Q, state: tuple[Q, Q]) -> None:
    step = stepper(method, lambda c: c)
    assert apply(matrix_at(one_step_matrix(method), h), *state) == step(oscillator, *state, h)


def test_step_that_is_not_linear_in_the_state_is_refused() -> None:
    with pytest.raises(ValueError, match=r"not linear in the state: its q has the term q\*\*2 \* v\*\*0"):
        matrix_of(lambda force, q, v, h: (q * q, v))
    with pytest.raises(ValueError, match="its v has the term"):
        matrix_of(lambda force, q, v, h: (q, v + h))
    with pytest.raises(ValueError, match="not linear"):
        matrix_of(stepper(NINE["rk4"], lambda c: rational(c)), force=lambda q: -(q**3))


def test_matrix_of_a_step_with_another_force() -> None:
    assert matrix_of(lambda force, q, v, h: (q, v + h * force(q)), lambda q: 2 * q) == matrix([[1, 0], [2 * H, 1]])


def test_entries_trace_and_determinant_are_read_in_order() -> None:
    m = matrix([[1, H], [Q(1, 2), H**2]])
    assert entries(m) == (1, H, RING.one / 2, H**2)
    assert (trace(m), determinant(m)) == (1 + H**2, H**2 - H / 2)
    assert at_rational(determinant(m), Q(1, 3)) == Q(1, 9) - Q(1, 6)
    assert expression(H**2 / 2) == sympy.Symbol("h") ** 2 / 2
    with pytest.raises(TypeError, match="exact"):
        at_rational(H, 0.5)  # type: ignore[arg-type]
