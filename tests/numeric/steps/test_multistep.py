"""Runs of multistep methods satisfy their recurrence to rounding, from first values of the method that is named."""

from fractions import Fraction as Q
from itertools import pairwise

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import MethodError
from driftproof.methods.tables.multistep import ENTRIES
from driftproof.numeric.advance import advance, evaluations_of
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps.implicit import StageEquationsUnsolved
from driftproof.numeric.steps.multistep import start_of
from driftproof.numeric.work_precision.integrators import has_numba
from tests.looping import exactly
from tests.numeric.implicit_runs import made_problem

FIRST_ORDER = [method for method in ENTRIES if method.derivative == 1]
U, H = Q(1, 2**53), 0.125
START = (0.75, -0.5)
# f is exact in Fractions, reads t, and couples both components.
RATES = ("t * y1 - 2 * y0", "y0 * y1 - y1 - t")


def f(t, y):
    return [t * y[1] - 2 * y[0], y[0] * y[1] - y[1] - t]


def states(run, count):
    found = [START]
    for i in range(count):
        found.append(run(found[-1], H, i, i + 1))
    return found


@pytest.mark.parametrize("method", FIRST_ORDER, ids=lambda m: m.key)
def test_states_satisfy_the_recurrence_up_to_rounding(method):
    """Each of 2k products, as many sums and f itself, ten operations of numbers below 2, is off by 2u at most; what
    Newton's iteration leaves is at most 8 times as much. With a coefficient off by 1e-12 it is not within that.
    """
    run = advance(method, made_problem(RATES, START))
    found = [[Q(x) for x in y] for y in states(run, 24)]
    slopes = [f(i * Q(H), y) for i, y in enumerate(found)]
    size = sum(map(abs, method.rho)) + sum(map(abs, method.sigma))
    allowed = 8 * 2 * U * (4 * method.steps + 10) * size
    for off, holds in ((Q(0), True), (Q(1, 10**12), False)):
        left = [
            abs(sum((r + off) * y[c] - Q(H) * s * g[c] for r, s, y, g in zip(*rows, strict=True)))
            for i in range(25 - method.steps)
            for c in (0, 1)
            for rows in [(method.rho, method.sigma, found[i : i + len(method.rho)], slopes[i : i + len(method.rho)])]
        ]
        assert (max(left) <= allowed) is holds


@pytest.mark.parametrize("method", FIRST_ORDER, ids=lambda m: m.key)
def test_first_values_are_those_of_the_named_method_and_runs_may_be_cut_anywhere(method):
    problem = made_problem(RATES, START)
    run, starter = advance(method, problem), advance(start_of(method), problem)
    found = states(run, 20)
    for i, (before, after) in exactly(method.steps - 1, [*enumerate(pairwise(found))][: method.steps - 1]):
        assert tuple(after) == starter(tuple(before), H, i, i + 1)
    assert run(START, H, 0, 20) == found[20]
    assert run(found[7], H, 7, 20) == found[20]  # and what was held of step 7 is still what it was
    assert found[7] != tuple(found[7])  # from which another run begins


def test_starts_are_exact_enough_and_those_with_none_are_refused():
    order = {key: METHODS[key].claimed_order for key in ("rk4", "dormand_prince54", "prince_dormand87")}
    for method in FIRST_ORDER:
        start = start_of(method)
        assert start.claimed_order >= method.claimed_order - 1
        assert start.explicit is method.explicit
    long = Multistep("long", "", 0, "", rho=(-1, *[0] * 9, 1), sigma=(1, *[0] * 10))
    with pytest.raises(MethodError, match="long: no method here gives the first values of 10 steps"):
        start_of(long)
    nine = Multistep("nine", "", 0, "", rho=(-1, *[0] * 8, 1), sigma=(1, *[0] * 9))
    assert order[start_of(nine).key] == 8
    with pytest.raises(MethodError, match="stormer2 is for y'' = F\\(y\\) and gives positions only"):
        advance(next(m for m in ENTRIES if m.key == "stormer2"), PROBLEMS["harmonic_oscillator"])


def test_evaluations_are_those_of_the_start_and_one_for_each_step_that_needs_it():
    problem = made_problem(RATES, START)
    for key, count in (
        ("adams_bashforth4", 3 * 4 + 20),
        ("two_step_leapfrog", 4 + 20 - 1),
        ("adams_bashforth2", 4 + 20),
    ):
        method = next(m for m in FIRST_ORDER if m.key == key)
        run = advance(method, problem)
        run(START, H, 0, 20)
        assert evaluations_of(run, method, 20) == count, key


def test_a_run_that_overflows_or_has_no_new_value_says_at_which_step():
    square = made_problem(("y0 * y0", "0 * y0"), (1.0, 0.0))
    by_key = {method.key: method for method in FIRST_ORDER}
    run = advance(by_key["adams_bashforth2"], square)
    assert run((1.0, 0.0), 1.0, 0, 9)[0] < 1e308
    with pytest.raises(StageEquationsUnsolved, match=r"adams_bashforth2: the step from t = 9 by h = 1 overflows"):
        run((1.0, 0.0), 1.0, 0, 40)
    late = made_problem(("y0 * y0 * floor(t)",), (1.0,))  # y = base + 2/3 y² has no root
    with pytest.raises(StageEquationsUnsolved, match=r"bdf2: the step by h = 0\.5 to t = 1 is not solved"):
        advance(by_key["bdf2"], late)((1.0,), 0.5, 0, 40)


@pytest.mark.slow(keep=0)
@pytest.mark.skipif(not has_numba(), reason="numba is not installed")
@pytest.mark.parametrize("key", ["adams_bashforth4", "bdf3", "adams_moulton2"])
def test_compiled_runs_have_the_same_bits(key):
    method, problem = next(m for m in FIRST_ORDER if m.key == key), made_problem(RATES, START)
    plain, fast = advance(method, problem), advance(method, problem, compiled=True)
    assert plain(START, H, 0, 20) == fast(START, H, 0, 20)
    assert evaluations_of(plain, method, 20) == evaluations_of(fast, method, 20)
