"""Bounded powers of float matrices, and the limits bisected by them: those that are proved, to what rounding leaves."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import cache
from math import inf, log, nextafter

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import MethodError
from driftproof.numeric.advance import advance
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.stability import GROWTH, SQUARINGS, largest_bounded, powers_stay_bounded, step_matrix
from driftproof.symbolic.algebra.certified import endpoints
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.linear.stability_limits import Infinity
from driftproof.symbolic.linear.systems import SystemFacts, bounded_at

LINEAR = ("harmonic_oscillator", "stiff_oscillator", "dahlquist_1e3", "separated_oscillators")
CHOSEN = ("rk4", "kutta3", "dormand_prince54", "symplectic_euler", "velocity_verlet", "yoshida4", "ruth3", "nystrom4")


def diagonal(*entries: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.diag(np.array(entries))


def test_powers_of_numbers() -> None:
    assert powers_stay_bounded(diagonal(1.0, -1.0))
    assert powers_stay_bounded(diagonal(0.5))
    assert powers_stay_bounded(diagonal(nextafter(1.0, 0.0)))
    assert not powers_stay_bounded(diagonal(0.5, 1.0 + 1e-13))
    assert not powers_stay_bounded(diagonal(2.0))
    assert not powers_stay_bounded(diagonal(inf))
    assert not powers_stay_bounded(diagonal(float("nan")))


def test_growth_is_seen_from_its_resolution_on() -> None:
    resolution = log(GROWTH) / 2**SQUARINGS
    assert not powers_stay_bounded(diagonal(1 + 2 * resolution))
    assert powers_stay_bounded(diagonal(1 + resolution / 2))


def test_a_jordan_block_on_the_circle_grows_and_one_inside_does_not() -> None:
    assert not powers_stay_bounded(np.array([[1.0, 1.0], [0.0, 1.0]]))
    assert not powers_stay_bounded(np.array([[-1.0, 1e-3], [0.0, -1.0]]))
    assert powers_stay_bounded(np.array([[0.99, 1.0], [0.0, 0.99]]))


def test_a_transient_is_no_growth() -> None:
    assert powers_stay_bounded(np.array([[0.9, 1e6], [0.0, 0.9]]))
    assert powers_stay_bounded(np.array([[1.0, 1e8], [0.0, 0.5]]))


@cache
def bisected(key: str, name: str) -> tuple[SystemFacts, float] | None:
    """The facts, and the largest double below which the powers of the float step stay bounded; None if refused."""
    problem = PROBLEMS[name]
    assert problem.matrix is not None
    try:
        runs = advance(METHODS[key], problem)
    except MethodError:
        return None
    scale = 1 / float(max(sum(abs(x) for x in row) for row in problem.matrix))
    components = len(problem.start)
    low, _ = largest_bounded(lambda h: powers_stay_bounded(step_matrix(runs, components, h)), scale)
    return SystemFacts(METHODS[key], problem.matrix), low


NINE_DIGITS = Q(1, 10**9)


def turns(key: str, name: str) -> bool | None:
    """The exact verdict turns at the bisected h, to nine digits; None where powers are bounded always or never.

    What growth over 2^48 steps does not show, 1e-13 in the radius, is less than that in h wherever the radius changes
    with h by more than 1e-4 in all; for dormand_prince54 it is 2e-10.
    """
    found = bisected(key, name)
    if found is None or isinstance(found[0].step_limit.limit, Infinity) or found[0].step_limit.limit == ZERO_ROOT:
        return None
    facts, low = found
    return bounded_at(facts, Q(low) * (1 - NINE_DIGITS)) and not bounded_at(facts, Q(low) * (1 + NINE_DIGITS))


def is_the_limit(key: str, name: str) -> bool:
    facts, low = bisected(key, name) or pytest.fail("refused")
    limit = facts.step_limit.limit
    assert isinstance(limit, RealRoot)
    return all(abs(Q(low) / end - 1) < NINE_DIGITS for end in endpoints(limit.ball()))


@pytest.mark.parametrize("key", CHOSEN)
def test_bisected_limits_are_the_proved_ones(key: str) -> None:
    found = {name: turns(key, name) for name in LINEAR}
    assert False not in found.values()
    assert any(found.values())
    assert all(is_the_limit(key, name) for name, turn in found.items() if turn)


def test_bisection_passes_over_a_gap_that_lies_between_powers_of_two_and_ends_at_a_later_one() -> None:
    assert turns("pefrl", "harmonic_oscillator")
    assert not is_the_limit("pefrl", "harmonic_oscillator")


def test_another_method_does_not_have_the_limit() -> None:
    facts, _ = bisected("rk4", "dahlquist_1e3") or pytest.fail("refused")
    _, low = bisected("kutta3", "dahlquist_1e3") or pytest.fail("refused")
    assert bounded_at(facts, Q(low) * (1 + NINE_DIGITS))


@pytest.mark.long
@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if method.explicit])
def test_at_every_bisected_limit_the_exact_verdict_turns(key: str) -> None:
    # At h = 8.02 this one's step is bounded, but its sums are so much larger than their results that its floats grow.
    grows_by_rounding = key == "mclachlan_atela5"
    assert (False in [turns(key, name) for name in LINEAR]) is grows_by_rounding
