"""The tolerance of one step: the any-order bound, which right programs keep and a wrong 13th digit does not."""

from contextlib import nullcontext
from fractions import Fraction
from math import inf, ldexp, nan

import numpy as np
import pytest
from flint import arb, ctx

from driftproof.blackbox.judging.agreement import agreement
from driftproof.blackbox.judging.specification import Allowance, Domain, Specification
from driftproof.blackbox.judging.tolerance import _BITS, Tolerance
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.steppers import float_stepper
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from driftproof.symbolic.runs import exact_matrix_at
from tests.witnesses.any_order import any_order

RK4, EULER, VERLET = METHODS["rk4"], METHODS["forward_euler"], METHODS["velocity_verlet"]
CASES = [(1.0, 0.0, 0.5), (0.3, -0.7, 0.1), (1e5, 1e-5, 1.75), (-3.0, 3.0, 1e-9)]


def ratios(method, answer, q, v, h, **allowance):
    return [x.ratio for x in Tolerance(method, allowance=Allowance(**allowance)).judge(q, v, h, answer)]


@pytest.mark.parametrize(("q", "v", "h"), CASES)
@pytest.mark.parametrize("key", ["rk4", "velocity_verlet", "dormand_prince54"])
def test_the_exact_step_is_the_matrix_times_the_state(key, q, v, h):
    qq, qv, vq, vv = exact_matrix_at(METHODS[key], Fraction(h))
    exact = qq * Fraction(q) + qv * Fraction(v), vq * Fraction(q) + vv * Fraction(v)
    with ctx.workprec(_BITS):
        for ball, x in zip(Tolerance(METHODS[key]).exact(q, v, h), exact, strict=True):
            assert ball.contains(arb(x.numerator) / x.denominator)


@pytest.mark.parametrize(("q", "v", "h"), CASES)
def test_the_bound_is_the_any_order_bound(q, v, h):
    bounds = any_order(RK4, multiplied_out=True).error_of(Fraction(h), Fraction(q), Fraction(v))
    exact = [float(x.mid()) for x in Tolerance(RK4).exact(q, v, h)]
    # An answer off by 10^6 bounds: what its own rounding adds to that is below 10^-5 of the ratio.
    off = [x + 1e6 * float(bound) for x, bound in zip(exact, bounds, strict=True)]
    assert ratios(RK4, tuple(off), q, v, h) == pytest.approx([1e6, 1e6], rel=1e-5)


def test_a_relative_error_of_1e_13_in_a_weight_is_seen():
    q1, v1 = float_stepper("rk4")(oscillator, 1.0, 0.0, 1.0)
    judged = Tolerance(RK4).judge(1.0, 0.0, 1.0, (q1, v1 * (1 + 1e-13)))
    assert [x.allowed for x in judged] == [True, False]


def test_nothing_that_is_not_finite_is_allowed():
    judged = Tolerance(EULER).judge(1.0, 1.0, 0.5, (nan, inf))
    assert [(x.allowed, x.ratio) for x in judged] == [(False, inf), (False, inf)]


JUDGED = {
    "rk4": (BINARY64, {}), "yoshida4": (BINARY32, {}), "ruth3": (BINARY32, {"flush_to_zero": True}),
    "midpoint2": (BINARY32, {"step_in_binary32": True}), "gauss2": (BINARY64, {"solver_tolerance": 1e-9}),
    "symplectic_euler": (BINARY32, {"velocity_from_positions": True}),
}  # fmt: skip


@pytest.mark.parametrize("key", JUDGED)
def test_an_error_is_what_it_was_in_units_of_its_bound_and_of_the_monomials(key, as_before):
    form, allowance = JUDGED[key]
    tolerance, said = Tolerance(METHODS[key], form, Allowance(**allowance)), []
    for q, v, h in ((0.75, -1.3, 0.3), (-2.5, 3e-4, -1.75), (2.0**-125, 2.0**-127, 0.1)):
        q1, v1 = (float(x.mid()) for x in tolerance.exact(q, v, h))
        said += [q1, v1, *tolerance.judge(q, v, h, (q1 + 1e-9, v1 * (1 - 1e-8)))]
    as_before(*(f"{x:.9g}" if isinstance(x, float) else f"{x.allowed} {x.ratio:.9g} {x.scaled:.9g}" for x in said))


def test_what_underflows_has_no_scaled_error():
    tiny = ldexp(1.0, -1070)
    assert [x.scaled for x in Tolerance(EULER).judge(tiny, tiny, 0.3, (tiny, tiny))] == [0.0, 0.0]


# Steps that one allowance allows and no other, and how far off they are without it, in bounds at least.
ROUNDED = float_stepper("rk4")(oscillator, 0.3, -0.7, float(np.float32(0.1)))
MOVED, _ = float_stepper("symplectic_euler")(oscillator, 1.0, 0.5, 1e-6)
SMALL = (ldexp(1.0, -1022), ldexp(1.0, -1023), 0.5)  # of which v, and the product h q, are subnormal
ALLOWED = {
    "step_in_binary32": (RK4, ROUNDED, (0.3, -0.7, 0.1), 1e3),
    "velocity_from_positions": (METHODS["symplectic_euler"], (MOVED, (MOVED - 1.0) / 1e-6), (1.0, 0.5, 1e-6), 1e3),
    "flush_to_zero": (EULER, (SMALL[0], 0.0), SMALL, 1),
}


@pytest.mark.parametrize("name", ALLOWED)
def test_what_codes_do_besides_is_allowed_only_where_it_is_asked_for(name):
    method, (q1, v1), at, least = ALLOWED[name]
    assert max(ratios(method, (q1, v1), *at)) > least
    assert max(ratios(method, (q1, v1), *at, **{name: True})) <= 1
    assert max(ratios(method, (q1, v1 * (1 + 1e-8) or 1e-300), *at, **{name: True})) > 1
    assert max(ratios(EULER, (1.0, 0.0), 1.0, 1.0, 0.5, **{name: True})) > 1


@pytest.mark.parametrize(
    ("method", "state", "h", "overflows"),
    [(EULER, 7e307, 0.25, False), (EULER, 8e307, 0.25, True), (RK4, 1e-300, 1e78, True), (RK4, 1e-300, 1e77, False)],
)
def test_sizes_have_room_where_no_sum_and_no_power_of_h_overflows(method, state, h, overflows):
    refused = pytest.raises(ValueError, match="where binary64 overflows; choose smaller sizes")
    with refused if overflows else nullcontext():
        Tolerance(method).require_no_overflow(state, h)


def test_a_tolerance_of_the_solver_is_for_implicit_methods_only():
    with pytest.raises(ValueError, match=r"backward_euler is implicit.*solver_tolerance=1e-10"):
        Tolerance(METHODS["backward_euler"])
    with pytest.raises(ValueError, match="rk4 is explicit"):
        Tolerance(RK4, allowance=Allowance(solver_tolerance=Fraction(1, 10)))


def test_an_implicit_step_passes_within_the_tolerance_of_its_solver_and_not_beyond():
    method, allowance = METHODS["backward_euler"], Allowance(solver_tolerance=Fraction(1, 10**10))
    q, v, h = 1.0, 0.5, 0.25
    q1, v1 = (q + h * v) / (1 + h * h), (v - h * q) / (1 + h * h)
    tolerance = Tolerance(method, allowance=allowance)
    assert all(x.allowed for x in tolerance.judge(q, v, h, (q1, v1)))
    assert not all(x.allowed for x in tolerance.judge(q, v, h, (q1, v1 + 1e-9)))


def test_the_tolerance_of_a_solver_is_relative_to_the_larger_component():
    """At this step the position is 111 times 1e-6, and an error of 1e-9 is 1e-11 of the velocity."""
    tolerance = Tolerance(METHODS["backward_euler"], allowance=Allowance(solver_tolerance=1e-10))
    (q, v), h = tolerance.exact(0.0, 111.0, 2.0**-20), 2.0**-20
    for off, allowed in ((1e-9, True), (2e-8, False)):
        position, velocity = tolerance.judge(0.0, 111.0, h, (float(q.mid()) + off, float(v.mid()) + off))
        assert (position.allowed, velocity.allowed) == (allowed, allowed)


def test_a_solver_that_stops_at_an_absolute_tolerance_passes_with_that_tolerance_as_a_float():
    def midpoint(q, v, h):
        q1, v1 = q, v
        while True:
            before, (q1, v1) = (q1, v1), (q + h * (v + v1) / 2, v - h * (q + q1) / 2)
            if max(abs(q1 - before[0]), abs(v1 - before[1])) <= 1e-9:
                return q1, v1

    subject, half = opened(midpoint), Domain(largest_step=0.5)
    for key, tolerance, holds in (
        ("implicit_midpoint", 1e-9, True), ("implicit_midpoint", 1e-13, False), ("backward_euler", 1e-9, False),
    ):  # fmt: skip
        wanted = Specification(METHODS[key], Allowance(solver_tolerance=tolerance), half)
        assert agreement(subject, wanted, 200).holds == holds


def test_binary32_steps_are_held_to_the_unit_of_binary32():
    q, v, h = (np.float32(x) for x in (0.3, -0.7, 0.1))
    answer = tuple(map(float, float_stepper("rk4")(oscillator, q, v, h)))
    args = tuple(map(float, (q, v, h)))
    assert all(x.allowed for x in Tolerance(RK4, BINARY32).judge(*args, answer))
    assert not all(x.allowed for x in Tolerance(RK4).judge(*args, answer))
