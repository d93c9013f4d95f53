"""The loops of Newton's method: the same bits compiled, rows exchanged, damped where they would fail, floors."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.advance import field_rate, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps import field_loops, loops
from driftproof.numeric.steps.elimination import FULL, Band
from driftproof.numeric.steps.implicit import (
    StageEquationsUnsolved,
    compiled_implicit_ensemble_runner,
    implicit_runner,
)
from driftproof.numeric.steps.loops import FieldWriters
from driftproof.numeric.steps.newton import MOST_ITERATIONS, Equations, residual
from tests.numeric.implicit_runs import implicit_stepper


@pytest.mark.long  # compiling takes ten seconds
def test_compiled_steps_have_the_same_bits_and_count_the_same_evaluations():
    """Fully implicit, stage by stage, with explicit stages, by a singular A, from the moves; and where both refuse."""
    pytest.importorskip("numba")
    problem = PROBLEMS["oregonator"]
    start = float_start(problem)
    for key in ("radau_iia3", "sdirk2", "lobatto_iiia4", "lobatto_iiib4", "trapezoid", "gauss2", "rk4"):
        plain, compiled = (implicit_runner(METHODS[key], problem.field, compiled=x) for x in (False, True))
        assert plain(start, 0.01, 3, 40) == compiled(start, 0.01, 3, 40)
        assert plain.calls == compiled.calls > 37
    errors = []
    for compiled in (False, True):
        with pytest.raises(StageEquationsUnsolved) as caught:
            implicit_runner(METHODS["radau_iia3"], problem.field, compiled=compiled)(start, 45.0, 0, 8)
        errors.append(str(caught.value))
    assert errors[0] == errors[1]


@pytest.mark.long  # compiling takes ten seconds
def test_each_system_of_an_ensemble_takes_the_steps_that_it_takes_alone():
    pytest.importorskip("numba")
    method, field = METHODS["radau_iia2"], VectorField(("y1", "y0 * y0 * y0 - y1"))
    starts = np.array([[0.5, 0.25], [-1.0, 0.5], [0.125, 2.0], [0.75, 0.0], [-0.5, 0.5]]).T.copy()
    alone = [implicit_runner(method, field)(tuple(start), 0.125, 2, 9) for start in starts.T.tolist()]
    compiled_implicit_ensemble_runner(method, field)(starts, 0.125, 2, 9)
    assert starts.T.tolist() == list(map(list, alone))


def test_what_is_compiled_has_the_same_bits_on_arrays_before_that(monkeypatch):
    """One system and an ensemble, its failing system named; the field is of this test alone, as is what is kept."""
    monkeypatch.setattr(loops, "compiled_function", lambda function: function)
    method, field = METHODS["radau_iia2"], VectorField(("y1 + t / 8", "y0 * y0 * y0 - y1"))
    starts, run = np.array([[0.5, 0.25], [-1.0, 0.5], [0.125, 2.0]]).T.copy(), implicit_runner(method, field)
    alone = [run(tuple(start), 0.125, 2, 9) for start in starts.T.tolist()]
    run, on_arrays = implicit_runner(method, field), implicit_runner(method, field, compiled=True)
    assert run((0.5, 0.25), 0.125, 2, 9) == alone[0]
    assert on_arrays((0.5, 0.25), 0.125, 2, 9) == alone[0]
    assert run.calls == on_arrays.calls > 2 * 7
    for key in ("gauss2", "lobatto_iiia3", "tr_bdf2"):
        plain, compiled = (implicit_runner(METHODS[key], field, compiled=x) for x in (False, True))
        assert plain((0.5, 0.25), 0.125, 2, 9) == compiled((0.5, 0.25), 0.125, 2, 9)
    found, run_systems = starts.copy(), compiled_implicit_ensemble_runner(method, field)
    run_systems(found, 0.125, 2, 9)
    assert found.T.tolist() == list(map(list, alone))
    starts[0, 1] = 1e200
    with pytest.raises(StageEquationsUnsolved, match=r"radau_iia2: system 1: the step "), np.errstate(all="ignore"):
        run_systems(starts, 0.125, 2, 9)
    assert starts.T.tolist()[0] == list(alone[0])
    with pytest.raises(ValueError, match="an ensemble is a C-contiguous float64 array with 2 rows"):
        run_systems(starts[:1], 0.125, 2, 9)


@pytest.mark.parametrize("key", ["radau_iia3", "sdirk2", "trapezoid"])
def test_in_a_band_stages_are_those_of_full_matrices_up_to_rounding(key, monkeypatch):
    """A line of 30 numbers that diffuse and react, each with its neighbours."""
    y = lambda i: f"y{i}" if 0 <= i < 30 else "1"
    field = VectorField(tuple(f"900 * ({y(i - 1)} - 2 * {y(i)} + {y(i + 1)}) - y{i} * y{i}" for i in range(30)))
    start, runs = tuple(i / 32 for i in range(30)), []
    for band in (field_loops.band_of, lambda reads: FULL):
        monkeypatch.setattr(field_loops, "band_of", band)
        field_loops.field_writers.cache_clear()
        run = implicit_runner(METHODS[key], field)
        runs.append((run(start, 0.01, 0, 3), run.calls))
    (found, calls), (wanted, calls_of_full) = runs
    assert found != start
    assert (found, calls) == (pytest.approx(wanted, rel=1e-13), calls_of_full)


def test_evaluations_are_the_calls_of_the_rate():
    problem, calls = PROBLEMS["robertson"], []
    rate = field_rate(problem.field)

    def jacobian(t, y):
        back, fast = 1e4 * y[2], 6e7 * y[1]
        return [[-0.04, back, 1e4 * y[1]], [0.04, -back - fast, -1e4 * y[1]], [0, fast, 0]]

    for key in ("radau_iia3", "trapezoid", "lobatto_iiib4"):
        calls.clear()
        step = implicit_stepper(METHODS[key], lambda t, y: calls.append(t) or rate(t, y), jacobian)
        run, start = implicit_runner(METHODS[key], problem.field), float_start(problem)
        found = step(0.0, start, 1 / 64).y
        assert run(start, 1 / 64, 0, 1) == pytest.approx(found, rel=1e-12)
        assert run.calls == len(calls)


@pytest.mark.parametrize(
    ("key", "start"), [("sdirk2", 2e-4), ("alexander3", 2e-4), ("sdirk4", 0.0), ("esdirk43", 0.0), ("radau_iia3", 0.0)]
)
def test_stiff_stages_are_not_those_of_another_solution(key, start):
    """y' = 1 - 10^8 y^2: beyond its repeller, -10^-4, lies Z = w, from which Newton's method would end there."""
    run = implicit_runner(METHODS[key], VectorField(("1 - 100000000 * y0 * y0",)))
    assert run((start,), 1.0, 0, 1) > (0,)


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_root_behind_a_singular_matrix_is_told(compiled):
    """y' = y - y^3 by backward Euler: for h > 1 Newton's method ends at the root near 0, where G' = 1 - h + 3h z^2 < 0.

    As h grows from 0, the root that begins at 1/10 goes on to 0.86 for h = 3, where G' > 0; y' = y has one root only.
    """
    for h, roots, found, past in ((0.5, 1, 0, 0.0), (3.0, 3, 1, 3.0), (0.25, 1, 0, 0.0)):
        exact = sorted(x.real for x in np.roots([h, 0, 1 - h, -0.1]) if abs(x.imag) < 1e-9)
        run = implicit_runner(METHODS["backward_euler"], VectorField(("y0 - y0 * y0 * y0",)), compiled=compiled)
        assert run((0.1,), h, 0, 1) == (pytest.approx(exact[found]),)
        assert (run.past, len(exact)) == (past, roots)


def test_rows_are_exchanged_where_the_diagonal_is_zero():
    """y' = (y0 + y1, y0), h = 1: M = [[0, -1], [-1, 1]], and backward Euler leads from (3, 5) to (-8, -3)."""
    run = implicit_runner(METHODS["backward_euler"], VectorField(("y0 + y1", "y0")))
    assert run((3.0, 5.0), 1.0, 0, 1) == (-8.0, -3.0)


@pytest.mark.slow
def test_damping_solves_what_newtons_method_alone_does_not():
    """HIRES by Radau IIA with seven stages, h = t/64: more than 128 iterations, of which some in part, lead there."""
    problem = PROBLEMS["hires"]
    run = implicit_runner(METHODS["radau_iia7"], problem.field)
    found = run(float_start(problem), 321.8122 / 64, 0, 1)
    assert run.calls == 1036 > 7 * MOST_ITERATIONS  # counted: rates of + - * are the same bits everywhere
    assert 0 < min(found) < max(found) < 1
    for name, key, h, steps, calls in (("robertson", "radau_iia3", 1 / 64, 5, 153), ("kaps", "sdirk4", 1 / 8, 4, 107)):
        run = implicit_runner(METHODS[key], PROBLEMS[name].field)
        run(float_start(PROBLEMS[name]), h, 0, steps)
        assert run.calls == calls


def test_a_correction_that_is_twice_too_long_is_halved():
    """y' = -y by backward Euler with J = 0: 128 iterations from side to side, then one, its half, and nothing."""
    step = implicit_stepper(METHODS["backward_euler"], lambda t, y: -y, lambda t, y: [[0.0]])
    found = step(0.0, [1.0], 1.0)
    assert (found.y.tolist(), found.residual, found.iterations) == ([0.5], 0, 128 + 3)


def test_a_correction_that_is_longer_in_any_part_is_tried_in_22_parts_down_to_2_to_the_minus_21():
    """y' = -y by backward Euler with J = 3: each part makes it longer, 128 times, and then in 6 rounds of 22 parts."""
    calls = []
    step = implicit_stepper(METHODS["backward_euler"], lambda t, y: calls.append(t) or -y, lambda t, y: [[3.0]])
    with pytest.raises(StageEquationsUnsolved):
        step(0.0, [1.0], 1.0)
    assert len(calls) == 1 + 128 + 1 + 6 * 22


@pytest.mark.parametrize("band", [FULL, Band(1, 0), Band(0, 1)])
def test_floor_of_several_stages_is_8e_plus_4r_by_its_formula(band):
    """Of two stages and three components, written out in loops; of what is 0, whole numbers of eta are left."""
    a, y, h, u = [[0.25, -0.5], [1.5, 0.75]], [3.0, -2.0, 0.5], -0.75, 2.0**-53
    moves, known, slopes = (np.arange(6.0).reshape(2, 3) * x + 1 for x in (0.3, -0.7, 1.1))
    lower, upper = (min(x, 2) for x in band)
    jacobians = np.triu(np.tril(np.arange(18.0).reshape(2, 3, 3) - 7, upper), -lower)
    rows = [[row[max(0, k - lower) : k + upper + 1].tolist() for k, row in enumerate(matrix)] for matrix in jacobians]
    largest = 0.0
    for i in range(2):
        for k in range(3):
            flow = sum(abs(h * a[i][j] * slopes[j, k]) for j in range(2))
            at_places, at_moves = (
                sum(abs(h * a[i][j] * jacobians[j, k, n] * x[j, n]) for j in range(2) for n in range(3))
                for x in (y + moves, moves)
            )
            e = u * (2 * abs(moves[i, k]) + 2 * abs(known[i, k]) + (2 + 4 + 16) * flow + 17 * at_places)
            r = u * (abs(moves[i, k]) + at_moves)
            left = moves[i, k] - known[i, k] - h * sum(a[i][j] * slopes[j, k] for j in range(2))
            largest = max(largest, abs(left) / (8 * e + 4 * r))
    given, rest = iter(slopes.tolist()), np.zeros((2, 3))
    system = FieldWriters(lambda t, y, f: f.__setitem__(slice(None), next(given)), None, band)
    found = residual(system, Equations(0.0, y, h, a, [0.0, 0.0], known.tolist()), moves.tolist(), rows, rest)
    assert found == pytest.approx(largest, rel=1e-14, abs=0)
    assert rest[1, 2] == pytest.approx(left, rel=1e-14, abs=0)
    still, one = [[0.0], [0.0]], [[5e-324], [0.0]]  # of what is 0, whole numbers of eta are left
    nothing, eye = FieldWriters(lambda t, y, f: None, None), [[1.0, 0.0], [0.0, 1.0]]
    units, equations = [[[1.0]], [[1.0]]], Equations(0.0, [0.0], 2.0, eye, [0.0, 0.0], one)
    assert residual(nothing, equations, still, units, [[0.0], [0.0]]) == 1 / (8 * 3 * 3 + 4 * (1 + 2))
