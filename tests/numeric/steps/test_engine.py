"""Runs of many steps: the bits of single steps, in Python and compiled."""

from __future__ import annotations

import sys
from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import field_source
from driftproof.methods.programs.stepping import oscillator
from driftproof.methods.schemes import MethodError
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.steps import engine
from driftproof.numeric.steps.engine import BLOCK, array_runner, compiled_ensemble_runner, compiled_runner, runner
from tests.float_bits import bits
from tests.looping import exactly, some
from tests.methods.tables.entries import EXPLICIT
from tests.numeric.engine_runs import OSCILLATOR, oscillator_run, step_by_step

# One of each family, and one with irrational coefficients: each takes numba half a second.
COMPILED = [METHODS[key] for key in ("rk4", "velocity_verlet", "yoshida4", "nystrom5")]
STARTS = [(1.0, 0.0, 0.25), (0.3, -0.7, -0.1), (-2.5, 1e-3, 1.3), (0.0, -0.0, 0.5)]
STARTS += [(1e-308, -1e-310, 0.75), (5e-324, 2e-322, 0.75)]  # subnormal: not flushed


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_a_run_has_the_bits_of_its_steps(method):
    for q, v, h in STARTS:
        alone = step_by_step(method, oscillator, q, v, h, 7)
        assert bits(*oscillator_run(method)(q, v, h, 7)) == bits(*alone)


def test_no_step_returns_the_start_and_a_negative_step_runs_back():
    verlet = oscillator_run(METHODS["velocity_verlet"])
    assert verlet(0.3, -0.0, 0.1, 0) == (0.3, -0.0)
    there = verlet(0.3, -0.7, 0.125, 40)
    back = verlet(*there, -0.125, 40)
    assert max(abs(back[0] - 0.3), abs(back[1] + 0.7)) < 40 * 8 * 2.0**-53  # 40 steps there and back, 4 roundings each


@pytest.mark.parametrize("method", COMPILED, ids=lambda m: m.key)
def test_a_compiled_run_has_the_same_bits(method):
    pytest.importorskip("numba")
    for q, v, h in STARTS:
        assert bits(*oscillator_run(method, compiled=True)(q, v, h, 500)) == bits(*oscillator_run(method)(q, v, h, 500))
    assert oscillator_run(method, compiled=True)(0.3, -0.7, 0.1, 0) == (0.3, -0.7)


def test_a_run_that_fuses_products_into_sums_has_other_bits():
    """What a compiler would do if it were let: the test of equal bits above would see it."""
    numba = pytest.importorskip("numba")
    plain = runner(METHODS["rk4"], OSCILLATOR)
    fused = numba.njit(fastmath=True)(plain)
    assert fused((0.3, -0.7), 0.1, 0, 500) != plain((0.3, -0.7), 0.1, 0, 500)


def test_without_numba_a_compiled_run_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(ImportError, match=r"driftproof\[fast\]"):
        compiled_runner.__wrapped__(METHODS["forward_euler"], OSCILLATOR)


def test_an_implicit_method_has_no_run():
    with pytest.raises(MethodError, match="is implicit"):
        runner(METHODS["gauss2"], OSCILLATOR)


def test_the_loop_that_is_compiled_is_the_text_of_the_step():
    """Nothing stands in the loop but the lines of the step, and reading and writing of one state."""
    for method in some(EXPLICIT, 80):
        source = field_source(method, OSCILLATOR)
        text = [line.strip() for line in engine._blocks_text(source).splitlines()]
        at = text.index("y1 = y1_block[member_]") + 1
        assert tuple(text[at : at + len(source.lines)]) == source.lines
        assert text[at + len(source.lines) :] == [
            *(f"{y}_block[member_] = {y}_new" for y in ("y0", "y1")),
            "return run",
        ]


@pytest.mark.parametrize("method", [METHODS["rk4"], METHODS["yoshida4"]], ids=lambda m: m.key)
def test_a_compiled_compensated_run_has_the_same_bits(method):
    """A compiler that may reassociate would find that nothing is lost, and drop what keeps it."""
    pytest.importorskip("numba")
    kept = oscillator_run(method, compensated=True)(0.3, -0.7, 0.01, 500)
    assert bits(*oscillator_run(method, compiled=True, compensated=True)(0.3, -0.7, 0.01, 500)) == bits(*kept)
    assert kept != oscillator_run(method)(0.3, -0.7, 0.01, 500)


KEPLER = problem_named("kepler").field


def test_an_ensemble_of_systems_has_the_bits_of_each_system():
    """Two blocks and a part of one; on arrays of NumPy, too. In steps from the third: rates read t."""
    pytest.importorskip("numba")
    forced = VectorField(("y1", "sin(t) - mass * y0"), (("mass", Q(1, 3)),))
    start = np.array([np.linspace(0.4 + k, 1.1, 2 * BLOCK + 17) for k in range(2)])
    alone, found = runner(METHODS["rk4"], forced), start.copy()
    compiled_ensemble_runner(METHODS["rk4"], forced)(found, 0.01, 3, 23)
    for member in (0, BLOCK - 1, BLOCK, 2 * BLOCK + 16):
        assert tuple(found[:, member]) == alone(tuple(map(float, start[:, member])), 0.01, 3, 23)
    arrays = array_runner(METHODS["rk4"], KEPLER)(tuple(np.ones((4, 9)) / 3), 0.01, 0, 20)
    assert tuple(x[4] for x in arrays) == runner(METHODS["rk4"], KEPLER)((1 / 3,) * 4, 0.01, 0, 20)


CHOSEN = VectorField(
    ("y1", "(-y0 if y0 > 0 else 2 * y0 - (1 if y1 >= 0 else -1)) + floor(8 * t) * (t if y1 < y0 else 1)")
)


def test_arrays_choose_for_each_member_as_floats_do():
    start, run = np.random.default_rng(3).uniform(-1, 1, (2, 40)), runner(METHODS["rk4"], CHOSEN)
    arrays = array_runner(METHODS["rk4"], CHOSEN)(tuple(start), 0.1, 3, 9)
    assert len({tuple(column > 0) for column in start.T}) == 4
    for q, v, *ends in exactly(40, zip(*start.tolist(), *arrays, strict=True)):
        assert bits(*ends) == bits(*run((q, v), 0.1, 3, 9))


@pytest.mark.long  # numba compiles
def test_compiled_choices_have_the_same_bits():
    pytest.importorskip("numba")
    for start in ((0.5, 0.25), (-0.5, 0.25)):
        assert bits(*compiled_runner(METHODS["rk4"], CHOSEN)(start, 0.1, 0, 9)) == bits(
            *runner(METHODS["rk4"], CHOSEN)(start, 0.1, 0, 9)
        )


def test_an_ensemble_of_systems_is_rows_of_doubles():
    run = compiled_ensemble_runner(METHODS["rk4"], KEPLER)
    for wrong in (np.ones(4), np.ones((3, 8)), np.ones((4, 8), np.float32), np.ones((8, 4)).T):
        with pytest.raises(ValueError, match=r"an ensemble is a C-contiguous float64 array with 4 rows"):
            run(wrong, 0.01, 0, 1)
