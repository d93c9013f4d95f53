"""Hypothesis strategies for tests of integrators: step sizes, states, exact numbers and random methods.

Impossible arguments raise ValueError when a strategy is built, rather than weaken a test unnoticed. No profile is
registered here: the test suite that draws the examples decides on their number.

>>> from hypothesis import given
>>> from driftproof import METHODS, stepper, strategies
>>> step = stepper(METHODS["velocity_verlet"], float)
>>> @given(strategies.states(-9, 9), strategies.steps())
... def test_step_of_size_zero_goes_nowhere(state, h):
...     assert h or step(lambda q: -q, *state, h) == state
>>> test_step_of_size_zero_goes_nowhere()
"""

from __future__ import annotations

import sys
from fractions import Fraction
from math import inf, isfinite, ldexp, nextafter

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from driftproof.methods.schemes import SUBSTEPS, RungeKutta, Splitting

# A normal binary64 number is m * 2**e, 1 <= m < 2, with e in this range; below it lie the subnormals and 0.
MIN_EXPONENT = sys.float_info.min_exp - 1
MAX_EXPONENT = sys.float_info.max_exp - 1
MANTISSA_BITS = sys.float_info.mant_dig

# The largest stable steps on the oscillator: 2 of symplectic Euler, and the double nearest to 2 sqrt 2 of RK4.
STABILITY_LIMITS = (2.0, 2 * 2**0.5)


def finite_floats(min_exponent: int = MIN_EXPONENT, max_exponent: int = MAX_EXPONENT) -> SearchStrategy[float]:
    """Finite doubles: 0.0, -0.0, and ±m·2^e with 1 <= m < 2 and any e in the range, so that most are tiny or huge.

    Subnormal numbers are included if min_exponent is the smallest exponent, which is the default. Raises ValueError for
    exponents that no double has.
    """
    if not MIN_EXPONENT <= min_exponent <= max_exponent <= MAX_EXPONENT:
        raise ValueError(
            f"exponents {min_exponent} to {max_exponent}: need {MIN_EXPONENT} <= min <= max <= {MAX_EXPONENT}"
        )
    sizes = [_sizes(min_exponent, max_exponent), _sizes(max_exponent, max_exponent)]
    if min_exponent == MIN_EXPONENT:
        sizes.append(st.integers(1, 1 << (MANTISSA_BITS - 1)).map(lambda m: m * 5e-324))
    signed = st.builds(lambda size, negative: -size if negative else size, st.one_of(sizes), st.booleans())
    return st.sampled_from((0.0, -0.0)) | signed


def _sizes(min_exponent: int, max_exponent: int) -> SearchStrategy[float]:
    """The normal doubles m·2^e > 0 with min_exponent <= e <= max_exponent, 1 <= m < 2."""
    top = 1 << (MANTISSA_BITS - 1)
    # Mantissas with few bits make exact products and ties, which random ones hardly ever do.
    mantissas = st.integers(top, 2 * top - 1) | st.sampled_from((top, top + 1, top + top // 2, 2 * top - 1))
    exponents = st.integers(min_exponent - MANTISSA_BITS + 1, max_exponent - MANTISSA_BITS + 1)
    return st.builds(lambda m, e: ldexp(float(m), e), mantissas, exponents)


def states(min_exponent: int = MIN_EXPONENT, max_exponent: int = MAX_EXPONENT) -> SearchStrategy[tuple[float, float]]:
    """States (q, v): independent pairs of `finite_floats`, and pairs of almost the same size, whose sums cancel."""
    floats = finite_floats(min_exponent, max_exponent)
    alike = st.builds(_nearby, floats, st.integers(-4, 4), st.booleans())
    return st.tuples(floats, floats) | alike


def _nearby(x: float, ulps: int, negative: bool) -> tuple[float, float]:
    y = step_by_ulps(x, ulps)
    y = y if isfinite(y) else x
    return x, -y if negative else y


def steps(min_value: float = -4.0, max_value: float = 4.0) -> SearchStrategy[float]:
    """Step sizes h in [min_value, max_value]: signed zeros, subnormals, ordinary ones, and both ends.

    Raises ValueError unless the ends are finite and in order.
    """
    if not (isfinite(min_value) and isfinite(max_value) and min_value <= max_value):
        raise ValueError(f"no step lies between {min_value} and {max_value}; give two finite ends, smaller first")
    within = st.floats(min_value, max_value, allow_nan=False)
    ends = st.sampled_from((min_value, max_value))
    special = [h for h in (0.0, -0.0, 5e-324, 0.25, 0.1, 0.5) if min_value <= h <= max_value]
    return st.one_of(within, ends, *([st.sampled_from(special)] if special else []))


def steps_near(centre: float, ulps: int = 4) -> SearchStrategy[float]:
    """Doubles at most `ulps` steps of nextafter from `centre`. Raises ValueError if one is not finite, or ulps < 0."""
    if ulps < 0 or not all(isfinite(step_by_ulps(centre, k)) for k in (-ulps, ulps)):
        raise ValueError(f"{ulps} ulps around {centre}: give a finite centre and ulps >= 0 that stay finite")
    return st.integers(-ulps, ulps).map(lambda k: step_by_ulps(centre, k))


def steps_near_stability_limits(ulps: int = 4) -> SearchStrategy[float]:
    """The doubles at most `ulps` steps of nextafter from 2 or 2 sqrt 2, the limits of symplectic Euler and RK4."""
    return st.one_of(*(steps_near(limit, ulps) for limit in STABILITY_LIMITS))


def step_by_ulps(x: float, ulps: int) -> float:
    """The double `ulps` steps of nextafter above x, or below x if `ulps` is negative."""
    for _ in range(abs(ulps)):
        x = nextafter(x, inf if ulps > 0 else -inf)
    return x


def rationals(max_size: int = 100, max_denominator: int = 1000) -> SearchStrategy[Fraction]:
    """Fractions in [-max_size, max_size]. Raises ValueError unless max_size >= 0 and max_denominator >= 1."""
    if max_size < 0 or max_denominator < 1:
        raise ValueError(f"max_size = {max_size}, max_denominator = {max_denominator}: need >= 0 and >= 1")
    return st.fractions(-max_size, max_size, max_denominator=max_denominator)


def rational_steps(max_size: int = 4, max_denominator: int = 1000) -> SearchStrategy[Fraction]:
    """Nonzero fractions h with |h| <= max_size. Raises ValueError if there is none."""
    if max_size * max_denominator < 1:
        raise ValueError(f"no nonzero step with |h| <= {max_size} and denominator <= {max_denominator}")
    return rationals(max_size, max_denominator).filter(bool)


def rational_states(max_size: int = 100, max_denominator: int = 1000) -> SearchStrategy[tuple[Fraction, Fraction]]:
    """States (q, v) of `rationals`, including the origin."""
    return st.tuples(*2 * [rationals(max_size, max_denominator)])


def runge_kutta_methods(min_stages: int = 1, max_stages: int = 4) -> SearchStrategy[RungeKutta]:
    """Explicit, consistent Runge-Kutta methods: A strictly lower triangular, c its row sums, weights that sum to 1.

    The claimed order is 1; a higher one is an accident. Raises ValueError unless 1 <= min_stages <= max_stages.
    """
    if not 1 <= min_stages <= max_stages:
        raise ValueError(f"{min_stages} to {max_stages} stages: need 1 <= min_stages <= max_stages")
    return st.integers(min_stages, max_stages).flatmap(_tableaux)


def _tableaux(stages: int) -> SearchStrategy[RungeKutta]:
    rows = st.tuples(*(st.tuples(*i * [_coefficients()]) for i in range(stages)))
    free_weights = st.tuples(*(stages - 1) * [_coefficients()])
    return st.builds(_consistent_tableau, rows, free_weights)


def _consistent_tableau(rows: tuple[tuple[Fraction, ...], ...], weights: tuple[Fraction, ...]) -> RungeKutta:
    stages = len(rows)
    return RungeKutta(
        key="drawn_runge_kutta",
        title="A drawn Runge-Kutta method",
        claimed_order=1,
        source="driftproof.strategies.runge_kutta_methods",
        a=tuple(row + (Fraction(0),) * (stages - len(row)) for row in rows),
        b=(*weights, 1 - sum(weights, Fraction(0))),
        c=tuple(sum(row, Fraction(0)) for row in rows),
    )


def splittings(max_pairs: int = 3) -> SearchStrategy[Splitting]:
    """Consistent splittings of up to `max_pairs` kicks and as many drifts, either first; each kind sums to 1.

    Raises ValueError unless max_pairs >= 1.
    """
    if max_pairs < 1:
        raise ValueError(f"max_pairs = {max_pairs}; a consistent splitting has at least one kick and one drift")
    return st.integers(1, max_pairs).flatmap(_splittings_of)


def _splittings_of(pairs: int) -> SearchStrategy[Splitting]:
    cuts = st.lists(_coefficients(), min_size=pairs - 1, max_size=pairs - 1)
    return st.builds(_consistent_splitting, cuts, cuts, st.booleans())


def _consistent_splitting(kick_cuts: list[Fraction], drift_cuts: list[Fraction], kick_first: bool) -> Splitting:
    kinds = SUBSTEPS if kick_first else SUBSTEPS[::-1]
    amounts = dict(zip(SUBSTEPS, (_differences(kick_cuts), _differences(drift_cuts)), strict=True))
    parts = [(kind, amounts[kind][i]) for i in range(len(kick_cuts) + 1) for kind in kinds]
    return Splitting(
        key="drawn_splitting",
        title="A drawn splitting",
        claimed_order=1,
        source="driftproof.strategies.splittings",
        parts=tuple(parts),
    )


def _differences(cuts: list[Fraction]) -> list[Fraction]:
    """The lengths of the pieces into which the cuts divide [0, 1]; unsorted cuts give negative lengths."""
    return [end - start for start, end in zip([Fraction(0), *cuts], [*cuts, Fraction(1)], strict=True)]


def _coefficients() -> SearchStrategy[Fraction]:
    """Small fractions such as tableaux have, zero often enough to matter."""
    return st.just(Fraction(0)) | st.fractions(-2, 2, max_denominator=12)
