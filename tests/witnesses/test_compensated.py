"""What the rounding of N steps adds up to: its laws in N, and what compensated additions take out of it."""

from __future__ import annotations

from fractions import Fraction as Q
from math import sqrt

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.runs import exact_matrix_at
from tests.numeric.engine_runs import oscillator_run, step_by_step
from tests.witnesses.compensated import compensated_bound, plain_bound

RK4, VERLET, SYMPLECTIC = METHODS["rk4"], METHODS["velocity_verlet"], METHODS["symplectic_euler"]
U = Q(1, 2**53)


@pytest.mark.parametrize(("dtype", "u"), [(np.float32, 2.0**-24), (np.float64, 2.0**-53)])
def test_the_rounding_of_a_run_is_of_the_size_of_the_unit_of_its_format(dtype, u):
    """Against the same run in the next wider format; after 1000 steps between √N/10 and 10 √N units."""
    wide = {np.float32: np.float64, np.float64: np.longdouble}[dtype]
    if np.finfo(wide).nmant == np.finfo(dtype).nmant:
        pytest.skip("here a long double is a double")
    differences = _rounding(SYMPLECTIC, oscillator, 0.125, [1000], 64, dtype, wide)[0]
    assert sqrt(1000) / 10 < np.hypot(*differences) / u < 10 * sqrt(1000)


def pendulum(q):
    return -np.sin(q)


def _stepped(method, force, state, h, steps):
    """The arrays q and v after so many steps, with h and the coefficients in their format."""
    number = state[0].dtype.type
    return step_by_step(method, force, *state, number(h), steps, lambda c: number(c.numerator) / number(c.denominator))


def _rounding(method, force, h, counts, members, dtype, wide):
    """Root mean squares over an ensemble, by number of steps: rounding of the energy, and in the direction of motion.

    Both runs are of one text from one start; what they differ by is the rounding of the narrower one.
    """
    narrow = np.random.default_rng(1).uniform(-1, 1, (2, members)).astype(dtype)
    exact, at, found = narrow.astype(wide), 0, []
    for count in counts:
        narrow, exact = (_stepped(method, force, state, h, count - at) for state in (narrow, exact))
        at = count
        dq, dv = ((x.astype(wide) - y).astype(float) for x, y in zip(narrow, exact, strict=True))
        q, v = (x.astype(float) for x in exact)
        slope = -force(q)
        energy, time = slope * dq + v * dv, (v * dq - slope * dv) / (v * v + slope * slope)
        found.append([float(np.sqrt((x * x).mean())) for x in (energy, time)])
    return found


# Growth of rounding with the number of steps

LONG_DOUBLES = pytest.mark.skipif(np.finfo(np.longdouble).nmant <= 52, reason="here a long double is a double")
SIZES = [pytest.param(512, 2**10, id="short"), pytest.param(4096, 2**12, id="long", marks=pytest.mark.long)]


def _exponents(method, force, members, first):
    """Of N in the growth of energy and time from `first` steps to four times as many."""
    before, after = _rounding(method, force, 0.1, [first, 4 * first], members, np.float64, np.longdouble)
    return [np.log2(y / x) / 2 for x, y in zip(before, after, strict=True)]


@LONG_DOUBLES
@pytest.mark.parametrize(("members", "first"), SIZES)
def test_rounding_of_the_energy_of_the_oscillator_grows_like_the_root_of_n(members, first):
    """A random walk. Verlet's coefficients 1/2 and 1 are floats, so nothing pulls to one side."""
    assert abs(_exponents(VERLET, oscillator, members, first)[0] - 1 / 2) < 0.1


@LONG_DOUBLES
@pytest.mark.parametrize(("members", "first"), SIZES)
def test_rounding_of_the_time_of_the_pendulum_grows_like_n_to_the_three_halves(members, first):
    """Its period depends on the energy, and the sum of a random walk grows so (hairer-mclachlan-razakarivony-2008)."""
    energy, time = _exponents(VERLET, pendulum, members, first)
    assert abs(energy - 1 / 2) < 0.1
    assert abs(time - 3 / 2) < 0.15


@LONG_DOUBLES
@pytest.mark.parametrize(("members", "first"), SIZES)
def test_rounded_weights_of_rk4_pull_its_time_to_one_side_and_that_grows_like_n(members, first):
    """fl(1/6) + 2 fl(1/3) + ... is 1 - u/2: each step is short by u h/2, whatever the state."""
    assert sum(Q(float(b)) for b in RK4.b) == 1 - U / 2
    assert abs(_exponents(RK4, oscillator, members, first)[1] - 1) < 0.05


# Compensated additions


def _compensated_by_hand(q, v, h, steps):
    """Forward Euler, its additions by the definition, with exact fractions for what they lose; and the moves."""
    z, lost, moves = [q, v], [Q(0), Q(0)], [[], []]
    for _ in range(steps):
        for i, move in enumerate((h * z[1], h * -z[0])):
            moves[i].append(move)
        old = list(z)
        for i in (0, 1):
            y = float(lost[i] + Q(moves[i][-1]))
            z[i] = float(Q(old[i]) + Q(y))
            lost[i] = Q(old[i]) + Q(y) - Q(z[i])
    return z, moves


def test_a_compensated_run_keeps_exactly_what_its_additions_round_off():
    for h in (0.1, -0.3, 1e-4):
        assert oscillator_run(METHODS["forward_euler"], compensated=True)(0.6, -0.8, h, 50) == tuple(
            _compensated_by_hand(0.6, -0.8, h, 50)[0]
        )


def test_compensated_additions_are_within_their_bound_and_plain_ones_are_not():
    h, steps = 2.0**-13 / 3, 4000
    state, moves = _compensated_by_hand(0.6, -0.8, h, steps)
    q, path = Q(0.6), [Q(0.6)]
    plain = 0.6
    for move in moves[0]:
        q += Q(move)
        path.append(q)
        plain = plain + move
    largest, moved = max(map(abs, path)) * (1 + steps * U), sum(abs(Q(m)) for m in moves[0])
    bound = compensated_bound(steps, largest, moved, U)
    assert abs(Q(state[0]) - q) <= bound
    assert bound < 2 * U
    assert bound < abs(Q(plain) - q) <= plain_bound(steps, largest, U)


def _rounding_of_rk4(steps, *, compensated):
    """In units of u, worst of three starts, t = 32: against the exact map with the weights that the program has."""
    a, b = tuple(tuple(Q(float(x)) for x in row) for row in RK4.a), tuple(Q(float(x)) for x in RK4.b)
    method = RungeKutta("rk4_in_floats", "", 0, "a test", a, b, RK4.c)
    h, found = 32 / steps, []
    for start in ((1.0, 0.0), (0.6, -0.8), (0.3, 0.7)):
        final = tuple(map(Q, oscillator_run(method, compensated=compensated)(*start, h, steps)))
        error = ErrorOfRun(exact_matrix_at(method, Q(h)), Q(h), steps, tuple(map(Q, start)), final)
        found.append(float(significant(error.rounding, 3)) / float(U))
    return max(found)


def test_compensation_takes_the_root_of_n_out_of_the_rounding_of_rk4():
    """Plainly a walk of N roundings of up to u, about √N u/3; compensated a unit or two, whatever N: the factor is
    of the order of √N, and doubles as N is four times as large.
    """
    few, many = 2**12, 2**16
    plain, kept = ([_rounding_of_rk4(n, compensated=c) for n in (few, many)] for c in (False, True))
    assert max(kept) < 2
    for n, error in zip((few, many), plain, strict=True):
        assert sqrt(n) / 6 < error < sqrt(n)
        assert error / max(kept) > sqrt(n) / 12


def test_compensation_does_not_mend_the_weights():
    """Against the map of RK4 itself the clock is short by u/2 a unit of time, compensated or not: 16u at t = 32."""
    q, v = oscillator_run(RK4, compensated=True)(1.0, 0.0, 2.0**-9, 2**14)
    error = ErrorOfRun(exact_matrix_at(RK4, Q(1, 2**9)), Q(1, 2**9), 2**14, (Q(1), Q(0)), (Q(q), Q(v)))
    assert 14 < float(significant(error.rounding, 4)) / float(U) < 18
