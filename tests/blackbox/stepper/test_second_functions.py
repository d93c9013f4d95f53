"""A stepper of two functions becomes one of one function, by place and by name, on arrays and on lists."""

import numpy as np
import pytest

from driftproof.blackbox.stepper.calling_conventions import IMPLICIT, JACOBIAN
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.second_functions import with_functions, zeros


def by_name(y, t, *, fun, jac, h):
    return y + h * np.linalg.solve(np.eye(len(y)) - h * jac(t, y), fun(t, y))


def on_lists(f, jac, t, y, h):
    rows, slope = jac(t, y), f(t, y)
    assert rows.index(rows[0]) == 0  # as lists alone can
    pushed = [sum(x * z for x, z in zip(row, slope, strict=True)) for row in rows]
    return [a + h * (s + h * p) for a, s, p in zip(y, slope, pushed, strict=True)]


@pytest.mark.parametrize("step", [by_name, on_lists])
def test_a_jacobian_is_given_as_a_matrix_of_the_stepper_s_own_kind(step):
    field = with_functions(opened(step), {JACOBIAN: lambda t, y: [[0.0, 0.0], [1.0, 0.0]]})
    assert field.step_field(lambda t, y: [1.0, 0.0], 0.0, [0.0, 0.0], 0.5) == [0.5, 0.25]


def test_a_second_right_hand_side_is_given():
    split = opened(lambda f_explicit, f_implicit, t, y, h: y + h * f_explicit(t, y) + 2 * h * f_implicit(t, y))
    assert with_functions(split, {IMPLICIT: lambda t, y: [4.0]}).step_field(zeros, 0.0, [1.0], 0.5) == [5.0]
