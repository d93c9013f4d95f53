"""Every float step of the house is held to its derived bound: all formats, all exponents, searches for the worst."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tqdm import tqdm

from driftproof.methods.catalogue import METHODS
from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import stepper
from driftproof.numeric.leapfrog import leapfrog
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.numeric.worst_case import Envelope, every_finite, exhaust
from driftproof.numeric.worst_case_search import random_floats, search
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.derivation.one_step import matrix_at
from driftproof.symbolic.rounding.formats import BFLOAT16, BINARY16, BINARY32, BINARY64, FloatFormat, power_of_two
from driftproof.symbolic.rounding.soft_float import soft_lift
from driftproof.symbolic.rounding.step import StepBound, step_bound
from driftproof.symbolic.runs import apply
from tests.changes import coefficients
from tests.nine import NINE

WRITTEN_OUT = {**HAND_WRITTEN, "leapfrog": leapfrog}
# What is run on floats, and what its bound is derived from: a step function for both, or a method for both.
PROGRAMS = {f"generic {key}": (stepper(m, float), m) for key, m in NINE.items()}
PROGRAMS |= {key: (step, step) for key, step in WRITTEN_OUT.items()}
IRRATIONAL = [key for key, m in METHODS.items() if m.explicit and getattr(m, "field", None)]
NATIVE = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}
BOUNDS: dict[tuple[str, FloatFormat], StepBound] = {}


def bound_of(key: str, fmt: FloatFormat) -> StepBound:
    if (key, fmt) not in BOUNDS:
        BOUNDS[key, fmt] = step_bound(PROGRAMS[key][1], fmt)
    return BOUNDS[key, fmt]


def envelope_of(key: str, fmt: FloatFormat) -> Envelope:
    return Envelope(*bound_of(key, fmt).coefficients)


def numbers_of(fmt: FloatFormat) -> st.SearchStrategy[Q]:
    """Finite numbers of the format, at every exponent, the subnormals included."""
    significands = st.integers(-(2**fmt.precision) + 1, 2**fmt.precision - 1)
    scale = fmt.precision - 1
    exponents = st.integers(fmt.emin - scale, fmt.emax - scale) | st.integers(-scale - 4, -scale + 4)
    return st.builds(lambda n, e: n * power_of_two(e), significands, exponents) | st.sampled_from(
        [Q(0), fmt.eta, -fmt.eta, power_of_two(fmt.emin), fmt.largest, Q(1), 1 + 2 * fmt.u, 1 - fmt.u]
    )


def on_the_machine(key: str, fmt: FloatFormat, h: Q, q: Q, v: Q) -> list[Q]:
    """The results of one float step, or none after an overflow."""
    dtype = NATIVE[fmt]
    with np.errstate(all="ignore"):
        results = PROGRAMS[key][0](oscillator, dtype(float(q)), dtype(float(v)), dtype(float(h)))
    assert all(type(x) is dtype for x in results)
    return [Q(float(x)) for x in results] if all(np.isfinite(x) for x in results) else []


def emulated(key: str, fmt: FloatFormat, h: Q, q: Q, v: Q) -> list[Q]:
    """The same for a format that the machine does not have."""
    subject, lift = PROGRAMS[key][1], soft_lift(fmt)
    step = subject if callable(subject) else stepper(subject, lift)
    try:
        return [x.value for x in step(oscillator, lift(q), lift(v), lift(h))]
    except OverflowError:
        return []


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16, BFLOAT16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", PROGRAMS)
@given(data=st.data())
def test_a_float_step_is_within_its_bound_at_every_scale(key, fmt, data):
    """Exactly, in fractions; on the machine's own floats where it has the format, else on emulated ones."""
    h, q, v = (data.draw(numbers_of(fmt), label=name) for name in "hqv")
    bound = bound_of(key, fmt)
    floats = (on_the_machine if fmt in NATIVE else emulated)(key, fmt, h, q, v)
    assert floats or not bound.is_safe(h, q, v)
    assume(floats)
    exact = apply(matrix_at(bound.matrix, h), q, v)
    errors = [abs(x - y) for x, y in zip(floats, exact, strict=True)]
    assert all(e <= most for e, most in zip(errors, bound.error_of(h, q, v), strict=True))


@pytest.mark.parametrize("fmt", NATIVE, ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", [*NINE, *IRRATIONAL])
def test_the_machine_lifts_each_coefficient_to_the_float_that_the_bound_assumes(key, fmt):
    """Exact -> float -> float16 rounds twice, which might differ from once; for our coefficients it does not."""
    seen = coefficients(METHODS[key]).values()
    assert seen
    assert all(Q(float(NATIVE[fmt](float(c)))) == decide_by_enclosure(c, fmt.nearest) for c in seen)


@pytest.mark.parametrize("fmt", NATIVE, ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", PROGRAMS)
def test_no_step_of_a_search_that_climbs_exceeds_the_bound(key, fmt):
    """About 8 million steps in all, over all exponents and the subnormals, |h| up to 4."""
    found = search(PROGRAMS[key][0], envelope_of(key, fmt), NATIVE[fmt], (0.0, 4.0), seed=3, generations=12)
    assert found.violations == 0
    assert found.checked - found.overflowed > 200_000
    assert 1 / 2 < found.ratio <= 1


@pytest.mark.parametrize("fmt", NATIVE, ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("h_range", [(0.0, 1 / 4), (1 / 4, 1 / 4)], ids=["up to 1/4", "at 1/4"])
@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_the_bound_is_within_a_factor_2_of_the_worst_error_found(key, h_range, fmt):
    found = search(PROGRAMS[key][0], envelope_of(key, fmt), NATIVE[fmt], h_range, seed=5, generations=8)
    assert found.violations == 0
    assert found.ratio >= 1 / 2


@pytest.mark.parametrize("key", PROGRAMS)
def test_every_finite_binary16_step_size_is_within_the_bound(key):
    """Exhaustive in h, 63488 of them, for states of all scales, the subnormals and zero included."""
    states = [
        (1.0, 0.0),
        (0.0, 1.0),
        (0.0, 0.0),
        (6e-8, 0.0),
        (0.0, 6e-8),
        (6e-5, -6e-5),
        (1.0009765625, 0.99951171875),
    ]
    rng = np.random.default_rng(7)
    q, v = (random_floats(rng, np.dtype(np.float16), 9) for _ in range(2))
    states += [(float(a), float(b)) for a, b in zip(q, v, strict=True)]
    states = [(float(np.float16(a)), float(np.float16(b))) for a, b in states]
    found = exhaust(PROGRAMS[key][0], envelope_of(key, BINARY16), every_finite(np.float16), states)
    assert found.checked == len(states) * 63488
    assert found.violations == 0
    assert found.ratio > 1 / 2


@pytest.mark.long
@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_every_finite_binary32_step_size_is_within_the_bound(key):
    """Exhaustive in h, 4278190080 of them, from a state with full significands: ten minutes each; -s shows how far."""
    state = (0.7071067690849304, -0.9999999403953552)
    chunks = tqdm(every_finite(np.float32), total=2**32 >> 14, desc=key, mininterval=10)
    found = exhaust(PROGRAMS[key][0], envelope_of(key, BINARY32), chunks, [state])
    assert found.checked == 4278190080
    assert found.violations == 0
