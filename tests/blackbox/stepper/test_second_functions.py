"""A stepper of two functions becomes one of one function, by place and by name, on arrays and on lists."""

import numpy as np
import pytest

from driftproof.blackbox.stepper.calling_conventions import IMPLICIT, JACOBIAN
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.second_functions import with_functions, with_own_jacobian, zeros


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


def test_of_a_step_of_f_alone_the_jacobian_is_that_of_the_function_that_is_handed_in():
    step = with_own_jacobian(lambda fun, y, t, jac, h: jac(y, t))
    seen = step(lambda y, t: [y[0] * y[1], t * y[1] ** 2], np.array([2.0, 3.0]), 0.5, h=0.25)
    assert np.allclose(seen, [[3.0, 2.0], [0.0, 3.0]], rtol=0, atol=2.0**-20)
    assert with_own_jacobian(by_name) is not by_name
    assert with_own_jacobian(zeros) is zeros


def test_a_second_right_hand_side_is_given():
    split = opened(lambda f_explicit, f_implicit, t, y, h: y + h * f_explicit(t, y) + 2 * h * f_implicit(t, y))
    assert with_functions(split, {IMPLICIT: lambda t, y: [4.0]}).step_field(zeros, 0.0, [1.0], 0.5) == [5.0]
