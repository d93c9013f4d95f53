"""Each question of the runs has a solver that it catches; the right solver is at fault in none."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.solvers.foreign_solver import ForeignSolver
from driftproof.blackbox.solvers.identify_solver import identify_solver
from driftproof.blackbox.solvers.runs import read_runs
from tests.blackbox.solvers.planted_solvers import adaptive, fixed
from tests.blackbox.transcripts import Asked
from tests.looping import some


def read(solve):
    return read_runs(ForeignSolver(solve))


@pytest.mark.parametrize("key", ["bogacki_shampine32", "fehlberg45", "dormand_prince54"])
def test_a_right_solver_is_at_fault_in_nothing(key, as_before):
    found = read(adaptive(key, exponent=0.2))
    assert found.faults == ()
    assert list(found.seen) == ["Constant slopes", "Clock", "Backward", "NaN", "A jump", "Tolerance", "Stiffness"]
    assert len(found.seen["Stiffness"]) == 1
    assert found.seen["Clock"] == ("the last step ends at the end, to the last bit",)
    assert found.seen["NaN"][0].endswith("says: the error is not finite")
    as_before(*found.seen.items())


WRONG = {
    "u' = 1": (adaptive(estimate=lambda e: [*e[:-1], 0.0]), "it cannot integrate u' = 1: after 30000 calls"),
    "binary32": (fixed(clock=np.float32), "time is accumulated, t += h in binary32, which gives these times exactly"),
    "one too many": (fixed(extra=1), "one step too many, or a last one that is not cut: it ends 0.017 beyond"),
    "one too few": (fixed(extra=-1), "one step too few: it ends 0.017 before"),
    "not cut": (adaptive(ending="beyond"), "a last one that is not cut"),
    "a tiny one": (adaptive(ending="tiny"), "one step too many: the last one is 1e-12 long"),
    "another clock": (adaptive(stepped=lambda h: h * (1 + 1e-6)), "drift apart"),
    "silent at NaN": (adaptive(on_nan="silent"), "where f becomes NaN it ends at t = 0.94"),
    "endless at NaN": (adaptive(on_nan="retry"), "where f is NaN it does not end"),
    "over a jump": (adaptive(estimate=lambda e: [0.0] * 4), "the jump is stepped over"),
    "deaf": (adaptive(tolerances=lambda rtol, atol: (1e-5, 1e-8)), "rtol is ignored"),
    "hard of hearing": (
        adaptive(tolerances=lambda rtol, atol: (1e-4 + rtol / 1e3, 1e-7)),
        "a tolerance 1000 times smaller does not make the error 10 times smaller",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_said(name, as_before):
    solve, fault = WRONG[name]
    asked = Asked(solve)
    found = read(asked.code)
    assert any(fault in words for words in some(found.faults, 1))
    as_before(*found.seen.items(), *found.faults, asked)


@pytest.mark.parametrize("method", ["Radau", "BDF", "LSODA"])
def test_what_solves_for_its_steps_is_told_from_what_does_not(method):
    solve_ivp = pytest.importorskip("scipy.integrate").solve_ivp

    def solve(f, t_span, y0, rtol, atol):
        return solve_ivp(f, t_span, y0, method=method, rtol=rtol, atol=atol)

    found = read(solve)
    assert found.seen["Stiffness"][1].startswith("it solves for its steps")
    assert "differences of f in y" in found.seen["Stiffness"][2]
    assert "it solves for its steps" in identify_solver(solve, isolate=False).verdict


def test_a_clock_that_accumulates_is_told_and_is_no_fault():
    found = read(fixed())
    assert found.seen["Clock"][0].endswith("time is accumulated, t += h in binary64, which gives these times exactly")
    assert not any("clock" in fault or "last step" in fault for fault in some(found.faults, 1))


def test_backward_in_time_is_looked_at():
    def forward_only(f, t_span, y0, rtol, atol):
        return adaptive()(f, (t_span[0], max(t_span[0] + 1e-3, t_span[1])), y0, rtol, atol)

    assert read(adaptive()).seen["Backward"] == ("it integrates backward in time",)
    assert any("backward in time" in fault for fault in some(read(forward_only).faults, 1))


def refuses_backward(f, t_span, y0, rtol, atol):
    if t_span[1] < t_span[0]:
        raise ValueError("the end lies before the start")
    return adaptive()(f, t_span, y0, rtol, atol)


def raises_at_nan(f, t_span, y0, rtol, atol):
    def checked(t, y):
        slopes = f(t, y)
        if not np.all(np.isfinite(slopes)):
            raise FloatingPointError("not finite")
        return slopes

    return adaptive()(checked, t_span, y0, rtol, atol)


def gives_up_at_a_jump(f, t_span, y0, rtol, atol):
    times, states, *_ = adaptive()(f, t_span, y0, rtol, atol)
    ok = len(times) < 40
    return {"t": times, "y": states, "success": ok, "message": "too many steps" * (not ok)}


def not_sorted(f, t_span, y0, rtol, atol):
    times, states = fixed(20)(f, t_span, y0, rtol, atol)
    return [*times[:5], times[4], *times[5:]], [*states[:5], states[4], *states[5:]]


def nan_at_the_end(f, t_span, y0, rtol, atol):
    times, states = fixed(20)(f, t_span, y0, rtol, atol)
    return times, [*states[:-1], states[-1] * float("nan")]


def loses_a_state(f, t_span, y0, rtol, atol):
    times, states = fixed(20)(f, t_span, y0, rtol, atol)
    return times, states[1:]


def always_raises(f, t_span, y0, rtol, atol):
    raise RuntimeError("no")


OTHERS = {
    **{each.__name__: each for each in (refuses_backward, raises_at_nan, gives_up_at_a_jump, not_sorted)},
    **{each.__name__: each for each in (nan_at_the_end, loses_a_state, always_raises)},
    "Euler": fixed(50, order="euler"),
    "few steps": fixed(3),
    "binary32 and one too many": fixed(60, extra=1, clock=np.float32),
    "asks beyond": adaptive("fehlberg45", ending="beyond"),
    "coarse": adaptive(tolerances=lambda rtol, atol: (max(rtol, 1e-3), atol)),
    "retries": adaptive(on_nan="accept"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_all_that_runs_show_is_what_it_was(name, as_before):
    asked = Asked(OTHERS[name])
    found = read(asked.code)
    as_before(*found.seen.items(), *found.faults, asked)


def test_an_explicit_solver_that_is_deaf_to_its_error_is_not_taken_for_an_implicit_one():
    found = read(adaptive(growth_at_zero=4.0, estimate=lambda e: [0.0] * 4))
    assert len(found.seen["Stiffness"]) == 1
