"""Ensembles run the text of a step as operations of whole arrays: the same bits, in every format."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import SUBSTEPS, Splitting
from driftproof.methods.stepping import oscillator, step_source
from driftproof.numeric.array_text import array_run
from driftproof.numeric.engine import ARRAY_BLOCK, compiled_ensemble_runner, ensemble_runner, lifted, runner
from tests.float_bits import bits
from tests.numeric.engine_runs import ensemble, step_by_step

EXPLICIT = [method for method in METHODS.values() if method.explicit]
EXPLICIT += [Splitting(kind, "it leaves the other one as it is", 0, "", ((kind, 1),)) for kind in SUBSTEPS]
SYMPLECTIC = METHODS["symplectic_euler"]
FORMATS = (np.float16, np.float32, np.float64, np.longdouble)


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_an_ensemble_has_the_bits_of_its_members(method):
    q, v = ensemble(5)
    alone = [runner(method)(float(x), float(y), 0.3, 6) for x, y in zip(q, v, strict=True)]
    ensemble_runner(method)(q, v, 0.3, 6)
    assert bits(q, v) == bits(*map(np.array, zip(*alone, strict=True)))


@pytest.mark.parametrize("length", [0, 1, ARRAY_BLOCK - 1, ARRAY_BLOCK, ARRAY_BLOCK + 1, 2 * ARRAY_BLOCK + 17])
def test_blocks_of_any_length_are_stepped(length):
    q, v = ensemble(length)
    whole = step_by_step(METHODS["rk4"], oscillator, q, v, 0.3, 5)
    ensemble_runner(METHODS["rk4"])(q, v, 0.3, 5)
    assert bits(q, v) == bits(*whole)


def test_buffers_are_as_few_as_can_be_and_no_array_is_copied():
    wanted = {"forward_euler": 2, "symplectic_euler": 1, "velocity_verlet": 2, "yoshida4": 3, "nystrom5": 7, "rk4": 9}
    found = {key: array_run(step_source(METHODS[key])) for key in wanted}
    assert {key: count for key, (_, count) in found.items()} == wanted
    assert not any("copyto" in text for text, _ in found.values())


def test_a_compensated_ensemble_has_the_bits_of_its_members():
    for method in (METHODS[key] for key in ("rk4", "velocity_verlet", "yoshida4", "nystrom5")):
        q, v = ensemble(ARRAY_BLOCK + 3)
        chosen = [0, 1, ARRAY_BLOCK - 1, ARRAY_BLOCK + 2]
        starts = [(float(q[i]), float(v[i])) for i in chosen]
        alone = [runner(method, compensated=True)(*start, 0.01, 40) for start in starts]
        ensemble_runner(method, compensated=True)(q, v, 0.01, 40)
        assert bits(q[chosen], v[chosen]) == bits(*map(np.array, zip(*alone, strict=True)))
        assert alone != [runner(method)(*start, 0.01, 40) for start in starts]


@pytest.mark.parametrize("force", ["{}", "2", "(-{} / (1 + {} * {}))", "(-sqrt({} * {}))"])
def test_an_ensemble_takes_any_force_that_is_a_formula(force):
    for method in (METHODS[key] for key in ("rk4", "velocity_verlet", "nystrom5")):
        q, v = ensemble(7)
        spelled = force.replace("{}", "{0}")
        alone = [runner(method, spelled)(float(x), float(y), 0.1, 9) for x, y in zip(q, v, strict=True)]
        ensemble_runner(method, spelled)(q, v, 0.1, 9)
        assert bits(q, v) == bits(*map(np.array, zip(*alone, strict=True)))


@pytest.mark.parametrize("dtype", FORMATS)
def test_an_ensemble_is_computed_in_the_format_of_its_arrays(dtype):
    for key in ("rk4", "yoshida4", "nystrom5"):
        q, v = ensemble(9, dtype)
        lift = lambda c: lifted(c, dtype)
        alone = [step_by_step(METHODS[key], oscillator, *z, dtype(0.3), 6, lift) for z in zip(q, v, strict=True)]
        assert all(type(x) is dtype for z in alone for x in z)
        ensemble_runner(METHODS[key])(q, v, 0.3, 6)
        assert q.dtype == v.dtype == dtype
        assert bits(q, v) == bits(*(np.array(x, dtype) for x in zip(*alone, strict=True)))


def test_formats_are_really_four():
    finals = []
    for dtype in FORMATS:
        q, v = ensemble(9, dtype)
        ensemble_runner(METHODS["rk4"])(q, v, 0.3, 6)
        finals.append(q.astype(np.longdouble))
    differences = [float(np.abs(x - finals[-1]).max()) for x in finals[:-1]]
    assert differences[0] > 2**9 * differences[1] > 2**9 * 2**25 * differences[2] > 0


def test_overflow_of_an_ensemble_is_infinite_and_silent():
    q, v = np.array([1e308, 1.0]), np.array([1e308, 0.0])
    ensemble_runner(METHODS["forward_euler"])(q, v, 1.0, 1)
    assert bits(q) == bits(np.array([np.inf, 1.0]))


def test_dividing_by_zero_raises_in_python_and_goes_on_in_arrays():
    force = "(-1 / {})"
    with pytest.raises(ZeroDivisionError):
        runner(SYMPLECTIC, force)(0.0, 1.0, 0.5, 1)
    q, v = np.array([0.0, 1.0]), np.array([1.0, 1.0])
    ensemble_runner(SYMPLECTIC, force)(q, v, 0.5, 1)
    assert (v[0], v[1]) == (-np.inf, 0.5)


@pytest.mark.parametrize(
    ("q", "v"),
    [
        (np.ones(3), np.ones(4)), (np.ones((2, 2)), np.ones((2, 2))), (np.ones(3), np.ones(3, np.float32)),
        (np.ones(3, int), np.ones(3, int)),
    ],
)  # fmt: skip
def test_arrays_that_are_no_ensemble_are_refused_in_one_line(q, v):
    for build in (ensemble_runner, compiled_ensemble_runner):
        with pytest.raises(ValueError, match="both must be float vectors") as caught:
            build(METHODS["rk4"])(q, v, 0.1, 1)
        assert "\n" not in str(caught.value)
        assert str(caught.value).startswith(f"q and v are {q.dtype}{list(q.shape)} and {v.dtype}{list(v.shape)}; both")
