"""Controlled runs: nearer for smaller tolerances, their calls counted, given up in one line, the same bits compiled."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import partial
from math import exp, inf

import pytest

from driftproof.methods.catalogue import METHODS, entry_named
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import MethodError
from driftproof.numeric.advance import float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.reference_errors import distance_from_digits
from driftproof.numeric.steps.controlled import _pair_step, controlled_runner
from driftproof.numeric.steps.field_loops import field_writers
from driftproof.numeric.steps.rosenbrock import rosenbrock_attempt
from driftproof.numeric.steps.simplified_newton import collocation_attempt
from driftproof.numeric.steps.step_control import StepControl, Tolerances, controlled_steps
from tests.looping import exactly

EXPONENTIAL = VectorField(("y0",))


@pytest.mark.parametrize(
    "key", ["radau_iia3", "gauss2", "radau_iia4", "dormand_prince54", "bogacki_shampine32", "grk4t", "rodas4"]
)
def test_a_smaller_tolerance_takes_more_steps_and_errs_less(key):
    """The oscillator neither magnifies nor damps errors of steps, and so of two components they add up at most."""
    problem, last = PROBLEMS["harmonic_oscillator"], 0
    run = controlled_runner(entry_named(key), problem.field)
    for tolerance in (1e-3, 1e-5, 1e-7):
        found = run(float_start(problem), float(problem.t), 0.0, tolerance)
        assert distance_from_digits(found, problem.reference.states[-1]) < 2 * run.steps * tolerance
        assert last < run.steps < 2000
        last = run.steps


POWERS = [
    ("dormand_prince54", 5, 1), ("merson45", 4, 1), ("heun_euler21", 2, 1), ("radau_iia3", 4, 1.2),
    ("gauss2", 3, 1.2), ("rodas4", 4, 1), ("ode23s", 3, 1),
]  # fmt: skip


@pytest.mark.parametrize(("key", "power", "steady"), POWERS)
def test_the_controller_is_told_the_power_of_h_and_which_growths_to_leave(key, power, steady):
    """Of a pair every growth is taken; the matrices of an implicit method are worth a fifth."""
    run, seen = controlled_runner(entry_named(key), EXPONENTIAL), []
    run.loop = lambda y, end, control: seen.append((end, control.given))
    assert run((1.0,), 2.0, 1e-3, 1e-4, 50) == (1.0,)
    assert seen == [(2.0, Tolerances(1e-3, 1e-4, power, steady, 50))]


@pytest.mark.parametrize("key", ["robertson", "hires", "van_der_pol_1e3"])
def test_stiff_problems_are_followed_with_few_matrices(key):
    """To t = 10¹¹, say, in some hundred steps; J is made anew in a part of them."""
    problem, made = PROBLEMS[key], []
    run = controlled_runner(METHODS["radau_iia3"], problem.field)
    system = field_writers(problem.field, compiled=False)
    counting = system._replace(jacobian=lambda *place: made.append(place[0]) or system.jacobian(*place))
    run.loop = partial(controlled_steps, counting, collocation_attempt)
    found = run(float_start(problem), float(problem.t), 1e-6, 1e-10)
    assert distance_from_digits(found, problem.reference.states[-1]) < 2e-8
    assert len(made) < run.steps < 1000


def test_calls_are_those_that_are_made():
    """Of a pair, f of the state when it has moved, but where the last stage is that; two for the first step."""
    start = float_start(PROBLEMS["kepler"])
    for key, others, keeps in (("dormand_prince54", 6, True), ("merson45", 4, False)):
        run = controlled_runner(METHODS[key], PROBLEMS["kepler"].field)
        run(start, 1.0, 1e-6, 1e-6)
        assert run.calls == 2 + others * (run.steps + run.rejected) + (1 if keeps else run.steps)
    calls, system = [], field_writers(PROBLEMS["kepler"].field, compiled=False)
    counting = system._replace(rate=lambda t, y, f: calls.append(t) or system.rate(t, y, f))
    for key, attempt, least in (("radau_iia3", collocation_attempt, 4), ("rodas4", rosenbrock_attempt, 6)):
        calls.clear()
        run = controlled_runner(entry_named(key), PROBLEMS["kepler"].field)
        run.loop = partial(controlled_steps, counting, attempt)
        run(start, 1.0, 1e-6, 1e-6)
        assert run.calls == len(calls) >= least * run.steps


def test_a_step_of_a_pair_is_that_of_its_weights_and_its_error_their_difference():
    """Heun and Euler on y' = y: a step from y by h leads to y (1 + h + h²/2), Euler h²/2 y beside it."""
    step, new, off = _pair_step(METHODS["heun_euler21"], EXPONENTIAL, compiled=False), [0.0], [0.0]
    step(0.0, [8.0], 0.25, [8.0], [0.0], new, off)
    assert (new, off) == ([10.25], [0.25])


def test_a_solution_that_ends_is_refused_near_its_end_and_a_long_run_after_its_calls():
    """y' = y², y = 1/(1 - t): steps get shorter until there are none."""
    for key in ("backward_euler", "fehlberg45"):
        run = controlled_runner(METHODS[key], VectorField(("y0 * y0",)))
        with pytest.raises(ArithmeticError, match=rf"{key}: no step size meets the tolerance from t = (0\.9|1)"):
            run((1.0,), 2.0, 1e-2, 0.0)
        with pytest.raises(ArithmeticError, match=rf"{key}: given up after 20 evaluations$"):
            run((1.0,), 2.0, 1e-6, 0.0, 20)


def test_a_component_that_starts_at_zero_may_have_no_tolerance_there():
    """y' = 1 from 0: every step of a pair is right; a correction of what is 0 is never small beside it."""
    field = VectorField(("1 + 0 * y0",))
    assert controlled_runner(METHODS["bogacki_shampine32"], field)((0.0,), 2.0, 1e-3, 0.0) == pytest.approx((2.0,))
    with pytest.raises(ArithmeticError, match=r"radau_iia2: no step size meets the tolerance from t = 0$"):
        controlled_runner(METHODS["radau_iia2"], field)((0.0,), 2.0, 1e-3, 0.0)


def test_a_rosenbrock_step_that_is_not_accepted_takes_neither_f_nor_its_derivatives_again():
    """Van der Pol's oscillator, whose jumps come after long steps: J is made once for each step that was taken."""
    made, problem = [], PROBLEMS["van_der_pol_1e3"]
    run, system = controlled_runner(entry_named("rodas3"), problem.field), field_writers(problem.field, compiled=False)
    counting = system._replace(jacobian=lambda *place: made.append(place[0]) or system.jacobian(*place))
    run.loop = partial(controlled_steps, counting, rosenbrock_attempt)
    run(float_start(problem), float(problem.t), 1e-4, 1e-7)
    assert len(made) == run.steps > run.rejected > 0
    assert run.calls == 2 + 2 * (run.steps + run.rejected) + run.steps


def test_a_singular_matrix_only_shortens_the_step():
    """Linearly implicit Euler and its embedded half of it on y' = 2y: no step of 1/2, but shorter ones."""
    pair = Rosenbrock("pair", "", 1, "", ((0,),), ((1,),), (1,), (Q(1, 2),), 0)
    field, new = VectorField(("2 * y0",)), [0.0]
    run, writers = controlled_runner(pair, field), field_writers(field, compiled=False)
    control = StepControl(Tolerances(0.0, 4.0, 1.0), run.table, run.work(1), [0.0] * 5)
    assert rosenbrock_attempt(writers, 0.0, [1.0], 0.5, True, new, control) == inf
    # k = 2 / (1 - 1/2), and h k / 2 = 1/2, over 4
    assert rosenbrock_attempt(writers, 0.0, [1.0], 0.25, False, new, control) == 0.125
    assert (new, control.report[0]) == ([2.0], 1)


def test_methods_without_an_estimate_are_refused():
    single = Rosenbrock("single", "", 1, "", ((0,),), ((1,),), (1,))
    for method in (*map(entry_named, ("rk4", "velocity_verlet", "trapezoid")), single):
        with pytest.raises(MethodError, match="no error estimate"):
            controlled_runner(method, EXPONENTIAL)


def test_time_is_read_where_the_field_reads_it():
    """y' = -2ty, y = exp(-t²)."""
    for key in ("dormand_prince54", "gauss3", "rodas4"):
        (found,) = controlled_runner(entry_named(key), VectorField(("-2 * t * y0",)))((1.0,), 1.5, 0.0, 1e-9)
        assert found == pytest.approx(exp(-2.25), abs=1e-8)


@pytest.mark.long  # compiling takes ten seconds a field
@pytest.mark.parametrize("key", ["radau_iia3", "gauss2", "dormand_prince54", "merson45", "rodas4"])
def test_compiled_runs_have_the_same_bits_and_take_the_same_steps(key):
    pytest.importorskip("numba")
    problem = PROBLEMS["oregonator"]
    plain, compiled = (controlled_runner(entry_named(key), problem.field, compiled=fast) for fast in (False, True))
    for tolerance in (1e-4, 1e-7):
        assert plain(float_start(problem), 2.0, tolerance, tolerance) == compiled(
            float_start(problem), 2.0, tolerance, tolerance
        )
        assert (plain.steps, plain.rejected, plain.calls) == (compiled.steps, compiled.rejected, compiled.calls)
    ways = [run.way(float_start(problem), 2.0, 1e-7, 1e-7, 10) for run in (plain, compiled)]
    assert [[*map(float, row)] for row in ways[1]] == ways[0]
    assert plain.steps > 20


@pytest.mark.parametrize("key", ["dormand_prince54", "radau_iia3", "rodas4"])
def test_the_way_of_a_run_is_told_at_its_own_steps(key):
    """Each step of y' = -2 t y errs by the tolerance at most, and errors decay; of many steps each k-th is told."""
    run = controlled_runner(entry_named(key), VectorField(("-2 * t * y0",)))
    (*_, (end, last)) = rows = run.way((1.0,), 1.5, 0.0, 1e-6, 1000)
    assert (end, last, len(rows)) == (1.5, run((1.0,), 1.5, 0.0, 1e-6)[0], run.steps)
    for t, y in exactly(run.steps, rows):
        assert y == pytest.approx(exp(-t * t), abs=1e-6 * run.steps)
    apart = -(-run.steps // 10)
    assert run.way((1.0,), 1.5, 0.0, 1e-6, 10) == rows[apart - 1 :: apart]
