"""Work is counted on the program that runs, and what is timed reaches the state whose error is measured."""

from __future__ import annotations

from fractions import Fraction as Q
from math import pi, sin

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import field_source
from driftproof.numeric.advance import advance, field_rate
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.reference_errors import errors
from driftproof.numeric.steps.engine import program_function
from driftproof.numeric.work_precision import integrators
from driftproof.numeric.work_precision.curves import curve_of
from driftproof.numeric.work_precision.integrators import COMPILED, KINDS, PYTHON, integrator
from driftproof.reports.user_problem import problem_given

T = Q(10)


@pytest.mark.parametrize(
    ("key", "a_step"), [("forward_euler", 1), ("velocity_verlet", 2), ("rk4", 4), ("nystrom5", 4), ("dop853", 12)]
)
def test_evaluations_are_counted_on_the_program_that_runs(key: str, a_step: int) -> None:
    source, calls = field_source(METHODS[key], VectorField(("y1", "sin(y0)"))), list[float]()
    run = program_function(source.run(), key, source.coefficients, {"sin": lambda x: calls.append(x) or x})
    run((1.0, 0.0), 0.25, 0, 3)
    assert len(calls) == 3 * a_step
    assert curve_of(METHODS[key], HARMONIC, [16]).points[0].evaluations == 16 * a_step
    assert curve_of(METHODS[key], problem_named("kepler"), [20]).points[0].evaluations == 20 * a_step


def test_evaluations_of_an_implicit_method_are_the_calls_that_it_makes() -> None:
    few, more = curve_of(METHODS["implicit_midpoint"], HARMONIC, [64, 128]).points
    assert few.evaluations is not None
    assert more.evaluations is not None
    assert 64 < few.evaluations < more.evaluations


def test_timed_calls_reach_the_state_whose_error_is_measured() -> None:
    for key in ("rk4", "velocity_verlet", "gauss2"):
        runs = integrator(METHODS[key], HARMONIC)
        assert runs.calls[PYTHON](16)() == runs.run(16).states[T]
        assert {*runs.calls, *runs.absent} <= set(KINDS)


def test_the_largest_error_is_that_over_all_steps_where_the_solution_is_known_at_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The forced solution sin 2πt is 0 at the reference's ten times, and 487 steps land on the last of them only."""
    forced = {"rates": "-3*(y - sin(2*pi*t)) + 2*pi*cos(2*pi*t)", "start": 0, "end": 20}
    problem = problem_given(forced)
    run = advance(METHODS["rk4"], problem)
    for steps, looks, looked in ((80, 2**16, 80), (487, 2**16, 487), (487, 100, 98)):
        monkeypatch.setattr(integrators, "MOST_LOOKS", looks)
        runs, h, reached = integrator(METHODS["rk4"], problem).run(steps), 20 / steps, [(0.0,)]
        seen, of_few = (errors(problem, runs.states, way)["state"] for way in (runs.way, None))
        for n in range(steps):
            reached.append(run(reached[-1], h, n, n + 1))
        off = [abs(y - sin(2 * pi * n * h)) for n, (y,) in enumerate(reached)]
        assert seen.looks == looked
        assert seen.largest == pytest.approx(max(off[:: -(-steps // looked)]), abs=1e-14)
        assert seen.largest > 1.1 * of_few.largest


def test_what_numba_would_compile_is_absent_without_it_and_only_where_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def absent(compiled: bool) -> str | None:
        runs = integrator(METHODS["rk4"], HARMONIC, compiled=compiled)
        assert (COMPILED in runs.calls) is (compiled and integrators.has_numba())
        return runs.absent.get(COMPILED)

    assert (absent(False), absent(True)) == (None, None)
    monkeypatch.setattr(integrators, "has_numba", lambda: False)
    assert absent(False) is None
    assert "pip install 'driftproof[fast]'" in str(absent(True))


def test_an_ensemble_reaches_the_same_bits_and_is_refused_where_there_is_none() -> None:
    runs = integrator(METHODS["rk4"], HARMONIC)
    call = runs.calls["ensemble"](16)
    assert call() == call() == runs.run(16).states[T]
    kepler = integrator(METHODS["velocity_verlet"], problem_named("kepler"))
    assert kepler.calls["ensemble"](16)() == kepler.run(16).states[problem_named("kepler").t]
    assert integrator(METHODS["gauss2"], HARMONIC).absent["ensemble"] == "implicit methods are only timed compiled"


def test_rate_of_a_field_is_the_field_whatever_its_parameters_are_called() -> None:
    rate = field_rate(VectorField(("rate * y1 + t", "sin(y0)"), (("rate", Q(1, 2)),)))
    assert rate(3.0, [0.5, 4.0]) == [5.0, sin(0.5)]
    doubling = field_rate(VectorField(("sin(y0)",)), {"sin": lambda x: 2 * x})
    assert doubling(0.0, [4]) == [8]
