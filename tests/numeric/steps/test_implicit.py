"""Implicit steps: solved to rounding or refused in one line, on the oscillator, stiff problems and invariants."""

from __future__ import annotations

import pickle
from fractions import Fraction as Q
from math import isqrt

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.steps.implicit import StageEquationsUnsolved, _groups, implicit_runner
from driftproof.numeric.steps.tableaux import float_tableau
from driftproof.symbolic.runs import exact_matrix_at
from tests.methods.tables.entries import IMPLICIT
from tests.numeric.implicit_runs import U, implicit_stepper, oscillator, rounding_of_a_step

BACKWARD_EULER, MIDPOINT = METHODS["backward_euler"], METHODS["implicit_midpoint"]


@pytest.mark.slow(keep=12)
@pytest.mark.parametrize("method", IMPLICIT, ids=lambda m: m.key)
def test_a_step_of_the_oscillator_is_that_of_the_exact_matrix_up_to_rounding(method):
    for h in (0.25, -0.5):
        found = implicit_stepper(method, oscillator)(0.0, [0.6, -0.8], h)
        assert found.over_floor <= 1
        a, b, c, d = map(float, exact_matrix_at(method, Q(h)))
        exact = np.array([a * 0.6 - b * 0.8, c * 0.6 - d * 0.8])
        assert np.abs(found.y - exact).max() <= rounding_of_a_step(method, abs(h))


def test_an_entry_of_the_tableau_wrong_by_1e_11_leaves_that_bound():
    """Its own share of a step is about h²/2 times it."""
    good = METHODS["radau_iia2"]
    a = ((good.a[0][0] + Q(1, 10**11), good.a[0][1]), good.a[1])
    wrong = RungeKutta("wrong", "wrong", 0, "a test", a, good.b, good.c)
    found = implicit_stepper(wrong, oscillator)(0.0, [0.6, -0.8], 0.25)
    x, y, z, w = map(float, exact_matrix_at(good, Q(1, 4)))
    assert np.abs(found.y - [x * 0.6 - y * 0.8, z * 0.6 - w * 0.8]).max() > rounding_of_a_step(wrong, 0.25)


def root_near_start(a: Q, b: Q, c: Q) -> Q:
    """The root of ax² + bx + c that tends to -c/b, b = 1 - a, as a tends to 0; to 100 bits."""
    root = Q(isqrt(int((b * b - 4 * a * c) * 2**200)), 2**100)
    return (-b + root) / (2 * a)


@pytest.mark.parametrize("h", [0.5, -0.25, 2.0])
def test_backward_euler_for_the_logistic_equation_finds_the_root_of_its_quadratic(h):
    """y₁ = y + h y₁(1 - y₁), so h y₁² + (1 - h) y₁ - y = 0. G' = 1 - h(1 - 2y₁) carries the residual into y₁."""
    found = implicit_stepper(BACKWARD_EULER, lambda t, y: y * (1 - y))(0.0, [0.75], h)
    s, y = Q(h), Q(3, 4)
    exact = root_near_start(s, 1 - s, -y)
    slope = abs(1 - s * (1 - 2 * exact))
    floor = 8 * U * (4 + 21 * abs(s) + 17 * abs(s) * 3) + 4 * U * (1 + 3 * abs(s))
    assert abs(Q(float(found.y[0])) - exact) <= floor / slope + 2 * U
    assert found.residual <= float(floor)
    assert found.over_floor == 0 or found.residual / found.over_floor <= float(floor)


def test_residual_is_what_is_left_in_the_equation_and_is_measured_by_its_floor():
    """From y = 0 the step is the stage itself: g = y₁ - h(1 - 3y₁) in the same roundings, 8E + 4R by its formula."""
    step = implicit_stepper(BACKWARD_EULER, lambda t, y: 1 - 3 * y, lambda t, y: [[-3.0]])
    left = 0
    for h in (0.1, 0.3, 0.7, 0.9, 1.1, 1.3):
        found = step(0.0, [0.0], h)
        y, u = float(found.y[0]), float(U)
        assert found.residual == abs(y - h * (1.0 - 3.0 * y))
        e = u * (2 * y + 21 * h * abs(1 - 3 * y) + 17 * 3 * h * y)
        floor = 8 * e + 4 * u * (y + 3 * h * y)
        assert abs(found.over_floor * floor - found.residual) < 1e-12 * floor
        left += found.residual > 0
    assert left
    two = implicit_stepper(METHODS["sdirk2"], lambda t, y: 1 - 3 * y)(0.0, [0.0], 0.7)
    assert 0 < two.residual < 1e-15
    assert 0 < two.over_floor <= 1


def test_stages_are_solved_one_by_one_where_none_waits_for_a_later_one():
    cut = {"sdirk2": [1, 1], "tr_bdf2": [1, 1, 1], "lobatto_iiia4": [1, 3], "gauss2": [2], "rk4": [1, 1, 1, 1]}
    for key, sizes in cut.items():
        groups = _groups(float_tableau(METHODS[key]))
        assert [last - first for first, last in groups] == sizes
        assert [first for first, _ in groups] == [sum(sizes[:i]) for i in range(len(sizes))]


# y' = -y by backward Euler with h = 1, where an iteration with a wrong J leaves |1 - 2/(1 - J)| of the residual.
@pytest.mark.parametrize(("left", "goes_on", "made_anew"), [(0.1, True, False), (0.2, True, True), (0.55, False, True)])
def test_iterations_go_on_while_they_halve_and_make_the_matrix_anew_unless_they_leave_an_eighth(
    left, goes_on, made_anew
):
    made = []
    jacobian = lambda t, y: made.append(t) or [[1 - 2 / (1 - left)]]
    found = implicit_stepper(BACKWARD_EULER, lambda t, y: -y, jacobian)(0.0, [1.0], 1.0)
    assert (found.over_floor < 0.1) is goes_on
    assert ((len(made) > 3) is made_anew, set(made)) == (True, {1.0})


def test_an_explicit_method_has_no_equations_and_leaves_nothing():
    assert implicit_stepper(METHODS["rk4"], oscillator)(0.0, [1.0, 0.0], 0.5)[1:] == (0, 0, 0)


def test_a_step_that_overflows_after_its_stages_is_refused():
    """The stage is at 1.775e308, and the step leads to 1.85e308."""
    with pytest.raises(StageEquationsUnsolved) as caught:
        implicit_stepper(MIDPOINT, lambda t, y: [0.15e308])(2.0, [1.7e308], 1.0)
    assert str(caught.value) == "implicit_midpoint: the step from t = 2 by h = 1 overflows binary64"
    assert caught.value.reason == "overflows binary64"
    run = implicit_runner(MIDPOINT, VectorField(("push",), (("push", Q(15 * 10**306)),)))
    with pytest.raises(StageEquationsUnsolved, match="the step from t = 4 by h = 1 overflows binary64"):
        run((1.55e308,), 1.0, 3, 9)


def test_stages_that_do_not_exist_are_an_error_in_one_line():
    """y₁ = y + h y₁² has a real root for 4hy <= 1 only."""
    step = implicit_stepper(BACKWARD_EULER, lambda t, y: y * y)
    assert step(0.0, [1.0], 0.24).over_floor <= 1
    with pytest.raises(StageEquationsUnsolved, match=r"backward_euler.*not solved after 128") as caught:
        step(0.0, [1.0], 0.26)
    assert "\n" not in str(caught.value)
    assert caught.value.reason == "not solved after 128 iterations"
    with pytest.raises(StageEquationsUnsolved, match=r"radau_iia3: the step by h = 5 to t = 7 is .* residual \d"):
        implicit_stepper(METHODS["radau_iia3"], lambda t, y: y * y)(2.0, [1.0], 5.0)
    copied = pickle.loads(pickle.dumps(caught.value))  # as between processes
    assert (str(copied), copied.reason) == (str(caught.value), caught.value.reason)


def test_a_rate_that_is_not_finite_is_an_error_and_no_result():
    with pytest.raises(StageEquationsUnsolved):
        implicit_stepper(MIDPOINT, lambda t, y: y if t == 0 else [np.nan])(0.0, [1.0], 0.5)
    with pytest.raises(StageEquationsUnsolved):
        implicit_stepper(MIDPOINT, lambda t, y: y)(0.0, [np.inf], 0.5)
    seen = []  # finite at the start alone, so that corrections are shortened to 2⁻²¹ and no further
    rate = lambda t, y: seen.append(t) or (y if y == 1 else [np.nan])
    with pytest.raises(StageEquationsUnsolved):
        implicit_stepper(BACKWARD_EULER, rate, lambda t, y: [[1.0]])(0.0, [1.0], 0.5)
    assert len(seen) == 2 + 1 + 22


def test_singular_newton_matrices_are_an_error():
    """y' = y/h: 1 - h J is zero, and y₁ = y + y₁ has no solution."""
    with pytest.raises(StageEquationsUnsolved):
        implicit_stepper(BACKWARD_EULER, lambda t, y: 2 * y, lambda t, y: [[2.0]])(0.0, [1.0], 0.5)


def test_a_jacobian_changes_the_iterations_and_not_the_result():
    def slopes(t, y):
        return [y[1], 20 * (1 - y[0] * y[0]) * y[1] - y[0]]

    def jacobian(t, y):
        return [[0, 1], [-40 * y[0] * y[1] - 1, 20 * (1 - y[0] * y[0])]]

    wrong = lambda t, y: [[0, 1], [-1, -50]]
    runs = [
        implicit_stepper(METHODS["gauss3"], slopes, given)(0.0, [2.0, 0.0], 1 / 64, 20) for given in (jacobian, wrong)
    ]
    assert np.abs(runs[1].y - runs[0].y).max() < 20 * 1000 * float(U)
    assert runs[1].iterations > 1.5 * runs[0].iterations


def test_a_jacobian_that_is_far_off_converges_slowly_or_is_refused():
    """y' = -y by backward Euler with h = 1: each iteration leaves |1 - 2/(1 - J)| of the residual, 2/3 or 14/15."""
    found = implicit_stepper(BACKWARD_EULER, lambda t, y: -y, lambda t, y: [[-5.0]])(0.0, [1.0], 1.0)
    assert abs(found.y[0] - 0.5) < 8 * 100 * float(U)
    assert 53 < found.iterations < 128
    with pytest.raises(StageEquationsUnsolved):
        implicit_stepper(BACKWARD_EULER, lambda t, y: -y, lambda t, y: [[-29.0]])(0.0, [1.0], 1.0)


@pytest.mark.parametrize("key", ["trapezoid", "lobatto_iiia4", "tr_bdf2", "radau_iia3", "gauss2"])
def test_a_stiff_slope_is_not_evaluated_again_where_that_would_magnify_rounding(key):
    """y' = -2^40 y with h = 1: |R| <= 1, and what is off in a stage by u would be off by 2^40 u in h f."""
    found = implicit_stepper(METHODS[key], lambda t, y: -(2.0**40) * y, lambda t, y: [[-(2.0**40)]])(0.0, [1.0], 1.0)
    limit = {"trapezoid": -1, "lobatto_iiia4": -1, "gauss2": 1}.get(key, 0)
    assert abs(found.y[0] - limit) < 2.0**-34  # R differs from its limit at infinity by less than 32/2^40


def test_time_is_a_multiple_of_h_and_not_a_sum():
    """f = f(t): with one node at h the run reads the times (i h) + h, which differ from those of a running sum."""
    read = []

    def rate(t, y):
        read.append(t)
        return np.array([t])

    implicit_stepper(BACKWARD_EULER, rate, lambda t, y: [[0.0]])(0.0, [0.0], 0.1, 20)
    assert set(read) == {i * 0.1 + 0.1 for i in range(20)}
    summed = np.cumsum(np.full(20, 0.1))
    assert set(read) != set(summed.tolist())
