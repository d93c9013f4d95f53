"""The certified error of actual float runs, truncation and rounding apart, and the run that VerifiedLeapfrog bounds."""

from __future__ import annotations

from fractions import Fraction as Q

import mpmath
import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import HAND_WRITTEN, symplectic_euler
from driftproof.symbolic.algebra.certified import decide_by_enclosure, enclose, fixed, is_less, significant
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from driftproof.symbolic.rounding.n_steps_bound import run_bound
from driftproof.symbolic.runs import exact_matrix_at
from tests.nine import NINE
from tests.symbolic.rounding.programs import float_run
from tests.witnesses.leapfrog import leapfrog

VERLET = METHODS["velocity_verlet"]
# Proved in Coq by VerifiedLeapfrog for this run: 0.0308. Twenty times better is 0.00154.
PROVED_ELSEWHERE = Q(308, 10**4)


def error_of(step, method, h, steps, start, dtype) -> ErrorOfRun:
    size = Q(float(dtype(h)))
    exact_start = tuple(Q(float(dtype(x))) for x in start)
    final = float_run(step, h, steps, start, dtype)
    return ErrorOfRun(exact_matrix_at(method, size), size, steps, exact_start, final)


def anchor(step=leapfrog, start=(1.0, 0.0)) -> ErrorOfRun:
    """VerifiedLeapfrog's run: binary32, h = 1/32, N = 1000, from momentum 0 and position 1."""
    return error_of(step, VERLET, 1 / 32, 1000, start, np.float32)


def test_the_anchor_is_reproduced_to_every_digit():
    """Coq's state is (momentum, position), so its start (0, 1) is q = 1, v = 0 here."""
    assert fixed(anchor().total, 14) == "0.00129161684270"
    assert fixed(anchor().truncation, 14) == "0.00129144685115"
    assert significant(anchor().rounding, 12) == "4.26306063163e-7"


def test_our_proved_bound_for_the_anchor_is_more_than_twenty_times_better():
    bound = run_bound(leapfrog, Q(1, 32), 1000, (Q(1), Q(0)), BINARY32)
    proved = lambda: enclose(anchor().truncation) + enclose(bound.euclidean)
    assert is_less(anchor().rounding, bound.euclidean)
    assert is_less(anchor().total, proved)
    assert is_less(proved, PROVED_ELSEWHERE / 20)
    assert fixed(proved, 5) == "0.00141"


@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_the_error_of_a_run_splits_into_truncation_and_rounding(key):
    found = error_of(HAND_WRITTEN[key], NINE[key], 0.25, 40, (1.0, 0.0), np.float64)
    total, truncation, rounding = (settle_to(x) for x in (found.total, found.truncation, found.rounding))
    assert abs(total - truncation) <= rounding
    assert 0 < rounding < 200 * BINARY64.u
    # The lesson's state errors, as the truncation of the real run.
    assert (
        fixed(found.truncation, 6)
        == {"forward_euler": "2.390297", "symplectic_euler": "0.089779", "rk4": "0.000325"}[key]
    )


def settle_to(value) -> Q:
    """`value` to forty digits, as a fraction."""
    return decide_by_enclosure(value, lambda x: Q(round(x * 10**40), 10**40)) if callable(value) else value


def test_ten_million_steps_are_certified_by_squaring():
    """Not by running them: of any state it can be said how far from M^N z0 it is, to any number of digits."""
    matrix, steps = exact_matrix_at(NINE["symplectic_euler"], Q(1, 4)), 10**7
    origin = ErrorOfRun(matrix, Q(1, 4), steps, (Q(1), Q(0)), (Q(0), Q(0)))
    with mpmath.workdps(60):
        angle = mpmath.acos(1 - mpmath.mpf(1) / 32)  # 2 cos = 2 - h²
        s0, s1 = (mpmath.sin((steps - i) * angle) / mpmath.sin(angle) for i in (0, 1))
        q, v = s0 * 15 / 16 - s1, -s0 / 4  # M^N z = (sin N Mz - sin(N-1) z) / sin, M z = (15/16, -1/4)
        t = mpmath.mpf(steps) / 4
        numerical, truncation = mpmath.hypot(q, v), mpmath.hypot(q - mpmath.cos(t), v + mpmath.sin(t))
        assert significant(origin.rounding, 40) == mpmath.nstr(numerical, 40)
        assert significant(origin.truncation, 40) == mpmath.nstr(truncation, 40)
    assert significant(origin.total, 30) == "1." + "0" * 29


def test_a_run_without_rounding_has_rounding_error_zero_and_not_undecided():
    """h = 1, symplectic Euler: M**6 = 1, integers throughout."""
    found = error_of(symplectic_euler, NINE["symplectic_euler"], 1.0, 600, (1.0, 0.0), np.float64)
    assert found.rounding == Q(0)
    assert found.final == (1, 0)
    assert significant(found.total, 10) == significant(found.truncation, 10)
