"""Rounding over N steps: the norm is found, the theorem holds for actual runs, each hypothesis can fail and be met."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest
import sympy
from flint import ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import stepper
from driftproof.numeric.leapfrog import leapfrog
from driftproof.numeric.steppers import HAND_WRITTEN, forward_euler, rk4, symplectic_euler
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.derivation.energy import StateDependentEnergy, energy_multiplier, invariant_quadratic
from driftproof.symbolic.derivation.one_step import RING, determinant, entries, matrix, matrix_at, one_step_matrix
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from driftproof.symbolic.rounding.n_steps import HypothesisFails, RunBound, run_bound
from driftproof.symbolic.rounding.overflow import largest_safe_state
from driftproof.symbolic.rounding.own_norm import NoOwnNorm, OwnNorm, own_norm, root_above, swept_area
from driftproof.symbolic.rounding.sharp import sharp_bound
from driftproof.symbolic.rounding.step import LinearBound, step_bound
from driftproof.symbolic.runs import apply, power
from tests.nine import NINE

ONE_ZERO = (Q(1), Q(0))
PROGRAMS = {f"generic {key}": method for key, method in NINE.items()} | {**HAND_WRITTEN, "leapfrog": leapfrog}
U = BINARY64.u


def plain_bound(step, h: Q, steps: int, start=ONE_ZERO, fmt=BINARY64) -> RunBound:
    return run_bound(step, h, steps, start, fmt, local=step_bound(step, fmt).at(h))


def float_run(subject, h: float, steps: int, start: tuple[float, float], dtype=np.float64):
    step = subject if callable(subject) else stepper(subject, float)
    (q, v), size = (dtype(x) for x in start), dtype(h)
    for _ in range(steps):
        q, v = step(oscillator, q, v, size)
    return Q(float(q)), Q(float(v))


def test_any_matrix_is_a_similarity_in_the_area_that_it_sweeps():
    """MᵀSM = det(M) S for the form S of z ∧ Mz, as an identity in the four entries of M."""
    a, b, c, d = sympy.symbols("a b c d")
    m, s = sympy.Matrix([[a, b], [c, d]]), sympy.Matrix([[c, (d - a) / 2], [(d - a) / 2, -b]])
    assert sympy.expand(m.T * s * m - m.det() * s) == sympy.zeros(2)
    at = matrix([[RING.one, RING.gens[0]], [-RING.gens[0], RING.one]])
    assert tuple(swept_area(at)) == (-RING.gens[0], 0, -RING.gens[0])


@pytest.mark.parametrize("key", NINE)
def test_the_norm_is_the_energy_or_the_invariant_that_the_exact_side_finds(key):
    m = one_step_matrix(NINE[key])
    area = swept_area(m)
    try:
        expected, rho_squared = (RING.one, RING.zero, RING.one), energy_multiplier(m)
    except StateDependentEnergy:
        expected, rho_squared = invariant_quadratic(m), RING.one
    assert rho_squared == determinant(m)
    for i, j in ((0, 1), (0, 2), (1, 2)):  # proportional
        assert area[i] * expected[j] == area[j] * expected[i]


@pytest.mark.parametrize("key", NINE)
def test_a_step_is_rho_times_an_isometry_of_its_norm(key):
    h = Q(3, 4)
    m = matrix_at(one_step_matrix(NINE[key]), h)
    norm = own_norm(m)
    form = lambda q, v: norm.qq * q * q + norm.qv * q * v + norm.vv * v * v
    for z in ((Q(1), Q(0)), (Q(0), Q(1)), (Q(2), Q(-3))):
        assert form(*apply(m, *z)) == norm.rho_squared * form(*z) > 0
    assert max(norm.qq, norm.vv) == 1


def test_there_is_no_norm_where_the_step_has_a_real_direction_and_one_just_before():
    step = one_step_matrix(NINE["symplectic_euler"])
    for h in (Q(2), Q(5, 2)):
        with pytest.raises(NoOwnNorm):
            own_norm(matrix_at(step, h))
    assert own_norm(matrix_at(step, Q(2) - Q(1, 2**50))).rho == 1
    assert own_norm((Q(3), Q(0), Q(0), Q(3))) == OwnNorm(Q(1), Q(0), Q(1), Q(9))


@settings(max_examples=200)
@given(x=st.fractions(min_value=0, max_denominator=10**6), scale=st.integers(-400, 400))
def test_a_root_is_rounded_up_by_less_than_its_last_bits(x, scale):
    x *= Q(2) ** scale
    root = root_above(x)
    assert root**2 >= x
    assert (root * (1 - Q(1, 2**190))) ** 2 <= x
    assert root_above(x * x) >= x
    assert root_above(Q(25, 4)) == Q(5, 2)


@pytest.mark.parametrize("key", ["symplectic_euler", "velocity_verlet", "position_verlet"])
@settings(max_examples=60)
@given(
    h=st.fractions(Q(-19, 10), Q(19, 10), max_denominator=64).filter(bool),
    e=st.lists(st.fractions(0, 4, max_denominator=16), min_size=4, max_size=4),
    z=st.tuples(st.integers(-9, 9), st.integers(-9, 9)),
    signs=st.tuples(*[st.sampled_from([1, -1])] * 2),
)
def test_the_gain_bounds_every_error_and_the_other_constants_every_state(key, h, e, z, signs):
    norm = own_norm(matrix_at(one_step_matrix(NINE[key]), h))
    error = ((e[0], e[1]), (e[2], e[3]))
    dq, dv = LinearBound(error, (Q(0), Q(0))).of(Q(z[0]), Q(z[1]))
    length = norm.length(Q(z[0]), Q(z[1]))
    assert norm.length(signs[0] * dq, signs[1] * dv) <= norm.gain(error) * length * (1 + Q(1, 2**100))
    assert norm.length(signs[0] * dq, signs[1] * dv) <= norm.largest_of_signs(dq, dv)
    assert Q(z[0] ** 2 + z[1] ** 2) <= (norm.euclidean_per_unit * length) ** 2
    assert max(abs(z[0]), abs(z[1])) <= norm.component_per_unit * length


def test_the_gain_is_attained():
    """Not only an upper bound: for the Euclidean norm and E = ((1, 2h), (2h, 1)) it is 1 + 2h, at z = (1, 1)."""
    norm = own_norm(matrix_at(one_step_matrix(NINE["forward_euler"]), Q(1, 4)))
    gain = norm.gain(((Q(1), Q(1, 2)), (Q(1, 2), Q(1))))
    assert Q(3, 2) <= gain <= Q(3, 2) * (1 + Q(1, 2**100))


@pytest.mark.parametrize(
    ("step", "target", "reached"), [(forward_euler, 200, 164), (symplectic_euler, 90, 67), (rk4, 115, 96)]
)
def test_forty_steps_of_a_quarter_are_bounded_as_promised(step, target, reached):
    """In units of u, in the Euclidean distance, from (1, 0); the sharper one-step bound does better than the plain."""
    h = Q(1, 4)
    plain, sharp = plain_bound(step, h, 40), run_bound(step, h, 40, ONE_ZERO)
    assert sharp.euclidean <= reached * U
    assert sharp.euclidean < plain.euclidean <= target * U
    final = float_run(step, 0.25, 40, (1.0, 0.0))
    exact = apply(power(matrix_at(step_bound(step).matrix, h), 40), *ONE_ZERO)
    squared = sum((x - y) ** 2 for x, y in zip(final, exact, strict=True))
    assert 0 < squared <= sharp.euclidean**2


@pytest.mark.parametrize("key", PROGRAMS)
@settings(max_examples=10)
@given(
    h=st.floats(-1.5, 1.5).filter(lambda h: abs(h) > 1e-3),
    start=st.tuples(*[st.floats(-4, 4, width=16)] * 2),
    steps=st.integers(0, 12),
    dtype=st.sampled_from([np.float64, np.float32, np.float16]),
)
def test_no_run_leaves_its_bound(key, h, start, steps, dtype):
    fmt = {np.float64: BINARY64, np.float32: BINARY32, np.float16: BINARY16}[dtype]
    size = Q(float(dtype(h)))
    z = tuple(Q(x) for x in start)
    bound = run_bound(PROGRAMS[key], size, steps, z, fmt)
    final = float_run(PROGRAMS[key], float(size), steps, start, dtype)
    exact = apply(power(matrix_at(step_bound(PROGRAMS[key], fmt).matrix, size), steps), *z)
    errors = [x - y for x, y in zip(final, exact, strict=True)]
    assert sum(e * e for e in errors) <= bound.euclidean**2
    assert max(abs(e) for e in errors) <= bound.component
    assert bound.norm.length(*errors) <= bound.own * (1 + Q(1, 2**100))


def test_underflow_is_inside_the_theorem_and_would_break_it_outside():
    """Forward Euler from the smallest subnormal: h v rounds to nothing, step after step, and r N eta pays for it."""
    h, steps = Q(1, 4), 40
    start = (BINARY64.eta, Q(0))
    bound = run_bound(forward_euler, h, steps, start)
    final = float_run(forward_euler, 0.25, steps, (float(BINARY64.eta), 0.0))
    exact = apply(power(matrix_at(one_step_matrix(NINE["forward_euler"]), h), steps), *start)
    squared = sum((x - y) ** 2 for x, y in zip(final, exact, strict=True))
    assert final == start
    error, _ = step_bound(forward_euler).at(h)
    without = run_bound(forward_euler, h, steps, start, local=LinearBound(error, (Q(0), Q(0))))
    assert without.euclidean**2 < squared <= bound.euclidean**2


def test_ten_million_steps_are_bounded_at_once():
    bound = run_bound(symplectic_euler, Q(1, 4), 10**7, ONE_ZERO)
    assert bound.norm.rho == 1
    assert 0 < bound.euclidean < 2 * 10**7 * U
    assert run_bound(rk4, Q(1, 4), 10**7, ONE_ZERO).euclidean < Q(1, 10**8)


def test_nothing_happens_in_no_steps_or_from_the_origin_but_underflow():
    assert run_bound(rk4, Q(1, 4), 0, ONE_ZERO).own == 0
    origin = run_bound(rk4, Q(1, 4), 10, (Q(0), Q(0)))
    assert 0 < origin.own < 100 * BINARY64.eta
    assert run_bound(lambda force, q, v, h: (-v, q), Q(1), 10, ONE_ZERO).own == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"h": Q(1, 10)}, "h = 1/10 is not a binary64 number; the nearest is 3602879701896397/36028797018963968"),
        ({"start": (Q(1), Q(1, 3))}, "the start's v = 1/3 is not a binary64 number"),
        ({"start": (Q(2) ** 1024, Q(0))}, "the start's q is beyond the largest binary64 number"),
        ({"h": Q(2)}, "at h = 2: the step has real eigenvectors"),
        ({"h": Q(5, 2)}, "at h = 5/2: the step has real eigenvectors"),
        ({"steps": -1}, "N = -1"),
        ({"start": (BINARY64.largest, Q(0))}, "overflow of binary64 cannot be excluded within 40 steps"),
        ({"subject": forward_euler, "steps": 10**12}, r"states might reach 2\*\*43731420\d{3}, and a step is safe"),
    ],
)
def test_each_hypothesis_that_fails_is_named(arguments, message):
    witness = {"subject": symplectic_euler, "h": Q(1, 4), "steps": 40, "start": ONE_ZERO}
    assert run_bound(**witness).own > 0
    with pytest.raises(HypothesisFails, match=message):
        run_bound(**(witness | arguments))


def test_a_run_that_the_theorem_admits_does_not_overflow_and_one_just_beyond_may():
    h, fmt = Q(3, 2), BINARY16
    safe = largest_safe_state(rk4, h, fmt)
    inside = fmt.nearest(safe * Q(9, 10))
    assert run_bound(rk4, h, 50, (inside, Q(0)), fmt).own > 0
    assert all(abs(x) <= safe for x in float_run(rk4, 1.5, 50, (float(inside), 0.0), np.float16))
    with pytest.raises(HypothesisFails, match="overflow of binary16"):
        run_bound(rk4, h, 50, (fmt.nearest(safe * Q(11, 10)), Q(0)), fmt)


def test_the_closed_form_is_the_recursion_solved():
    """b(n+1) = (rho + c) b(n) + c rho^n |z0| + r, stepped in balls, ends where the formula does."""
    steps, h = 40, Q(1, 4)
    bound = run_bound(forward_euler, h, steps, ONE_ZERO)
    with ctx.workprec(600):
        rho, b = enclose(bound.norm.rho), enclose(Q(0))
        for n in range(steps):
            b = (rho + enclose(bound.growth)) * b + enclose(bound.growth) * rho**n + enclose(bound.underflow)
        low, high = endpoints(b)
    assert low <= bound.own <= high * (1 + Q(1, 2**39))


def test_the_growth_of_a_step_is_its_bound_seen_in_the_norm():
    h = Q(1, 4)
    bound = run_bound(leapfrog, h, 1, ONE_ZERO)
    error, underflow = sharp_bound(leapfrog, h).linear
    assert bound.growth == bound.norm.gain(error)
    assert bound.underflow == bound.norm.largest_of_signs(*underflow)
    qq, qv, vq, vv = entries(step_bound(leapfrog).matrix)
    assert qq == vv != qv != vq
