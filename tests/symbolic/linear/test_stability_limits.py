"""Stability limits and bounded powers: published values, contacts of every kind, balls on both sides."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import acb, arb, ctx, fmpq, fmpq_poly
from hypothesis import given

from driftproof import strategies
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import evaluate, polynomial, scalar, sign
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, positive_roots, rational_root, sign_at
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import (
    ALWAYS,
    INFINITY,
    NEVER,
    boundary_of,
    bounded_powers,
    first_bound,
    imaginary_limit,
    is_bounded,
    real_limit,
    smallest,
)
from driftproof.texts.writing.records import number_record, record
from tests.symbolic.linear.linear_examples import NIL, ROOT_3, Z, chebyshev, limit_text, modulus, sdirk, triple_jump


def ssp_second_order(stages: int) -> Any:
    """R of the SSP method of order 2 with s stages: 1/s + (1 - 1/s)(1 + z/(s - 1))**s."""
    return (1 + Z / (stages - 1)) ** stages * fmpq(stages - 1, stages) + fmpq(1, stages)


def exponential(order: int) -> Any:
    """The Taylor polynomial of exp."""
    total, term = fmpq_poly([1]), fmpq_poly([1])
    for k in range(1, order + 1):
        term = term * Z / k
        total = total + term
    return total


# R as a polynomial or (num, den): the real limit, the imaginary limit.
KNOWN: dict[str, tuple[Any, str, str]] = {
    "forward Euler": (1 + Z, "2", "0"), "order 2": (exponential(2), "2", "0"),
    "order 3": (exponential(3), "x**3 - 3*x**2 + 6*x - 12", "sqrt(3)"),
    "order 4": (exponential(4), "x**3 - 4*x**2 + 12*x - 24", "2*sqrt(2)"),
    "backward Euler": ((1, 1 - Z), "oo", "oo"), "trapezoid": ((1 + Z / 2, 1 - Z / 2), "oo", "oo"),
    "theta method below 1/2": ((1 + Z * 2 / 3, 1 - Z / 3), "6", "0"),
    "Chebyshev, 10 stages": (chebyshev(10, 1 + Z / 100), "200", "0"),
    "SSP order 2, 40 stages": (ssp_second_order(40), "78", "0"),
    "SSP order 2, 3 stages": (ssp_second_order(3), "x**3 - 6*x**2 + 12*x - 24", "0"),
}  # fmt: skip


def rational(r: Any) -> RationalFunction:
    return fraction(fmpq_poly([1]) * r[0], r[1]) if isinstance(r, tuple) else fraction(r)


@pytest.mark.parametrize("name", KNOWN)
def test_limits_of_known_methods(name: str) -> None:
    r, on_real, on_imaginary = KNOWN[name]
    assert (limit_text(real_limit(rational(r))), limit_text(imaginary_limit(rational(r)))) == (on_real, on_imaginary)


ON_REAL: dict[str, tuple[Any, str]] = {
    "touches 1 at 1 and returns, leaves at 3": (1 + Z * (1 + Z) ** 2 * (3 + Z) / 10, "3"),
    "leaves at 1, is back from 2 to 3": (1 + Z * (1 + Z) * (2 + Z) * (3 + Z) / 10, "1"),
    "touches -1 at 1 and returns": (-1 + (1 + Z) ** 2 * (2 + Z) * (4 - Z) / 4, "2"),
    "is 1 for ever": (1 + 0 * Z, "oo"), "is -1 for ever": (-1 + 0 * Z, "oo"), "grows at once": ((1, 1 + Z), "0"),
    "has a pole at -2, and leaves before it": ((1 + Z, 1 + Z / 2), "4/3"),
    "has a removable pole at -2": ((1 + Z / 2, (1 + Z / 2) * (1 - Z)), "oo"),
    "tends to 1 from below": ((1 - 2 * Z, 1 - 3 * Z), "oo"),
    "tends to 2": ((1 - 2 * Z, 1 - Z), "0"),
}  # fmt: skip


@pytest.mark.parametrize("name", ON_REAL)
def test_real_limit_where_it(name: str) -> None:
    r, limit = ON_REAL[name]
    assert limit_text(real_limit(rational(r))) == limit


BOUNDED = 1 + Z**2 + Z**4  # at z = iy: s = 1 - y² + y⁴, which is 1 at y = 0 and y = 1
ON_IMAGINARY: dict[str, tuple[Any, str]] = {
    "touches 1 and -1 on the way to 2": (chebyshev(3, 1 + Z**2 / 2), "2"), "has a pole at i": ((1, 1 + Z**2), "0"),
    "touches 1 at y = 1 and stays below it for ever": ((2 * BOUNDED, 1 + BOUNDED**2), "oo"),
    "is 1 for ever": ((1 - Z / 2 + Z**2 / 9, 1 + Z / 2 + Z**2 / 9), "oo"),
    "has a pole at 2i, far beyond where it leaves": ((1 + Z**2 / 2, 1 + Z**2 / 4), "2*sqrt(6)/3"),
    "has a removable pole at i": (((1 + Z**2), (1 + Z**2) * (1 - Z)), "oo"),
}  # fmt: skip


@pytest.mark.parametrize("name", ON_IMAGINARY)
def test_imaginary_limit_where_it(name: str) -> None:
    r, limit = ON_IMAGINARY[name]
    assert limit_text(imaginary_limit(rational(r))) == limit


TINY = fmpq(1, 10**30)


def test_a_touch_that_becomes_a_crossing_is_noticed_and_so_is_a_weight_off_by_ten_to_the_minus_thirty() -> None:
    """The twins: a perturbation of 1e-30 turns the first touch into a crossing, and the limit moves; RK4's, too."""
    touching = chebyshev(10, 1 + Z / 100)
    crossing = real_limit(fraction(touching + Z**2 * TINY))
    assert isinstance(crossing, RealRoot)
    assert Q(19) < crossing.interval()[1] < Q(21)  # T₁₀ touches 1 first where 1 - x/100 = cos(π/5)
    below = real_limit(fraction(touching * (1 + TINY) - TINY))
    assert isinstance(below, RealRoot)
    assert Q(4) < below.interval()[1] <= Q(5)  # and -1 first where 1 - x/100 = cos(π/10)
    above = fraction(2 * BOUNDED * (1 + TINY), 1 + BOUNDED**2)
    assert imaginary_limit(above) == ZERO_ROOT
    assert imaginary_limit(fraction(exponential(4) - TINY * Z**2)) == ZERO_ROOT
    assert limit_text(imaginary_limit(fraction(exponential(4) + TINY * Z**2))) not in ("0", "2*sqrt(2)")


def test_limits_over_a_number_field() -> None:
    stable, unstable = (stability_function(sdirk(Q(1, 2) + s * ROOT_3 / 6)) for s in (1, -1))
    assert (real_limit(stable), imaginary_limit(stable)) == (INFINITY, INFINITY)
    assert limit_text(real_limit(unstable)) == "6 + 4*sqrt(3)"
    assert imaginary_limit(unstable) == ZERO_ROOT


def test_limit_over_a_number_field_is_not_one_of_a_conjugate() -> None:
    """1 - x + a x²/2 with a = √3 - 1 reaches 1 at 2/a = 1 + √3; the conjugate a = -√3 - 1 takes it to -1 before 1."""
    r = fraction(polynomial([1, 1, (ROOT_3 - 1) / 2]))
    assert limit_text(real_limit(r)) == "1 + sqrt(3)"
    conjugate = real_limit(fraction(polynomial([1, 1, (-ROOT_3 - 1) / 2])))
    assert number_record(conjugate, 6)["decimal"] == "0.898125"


@given(strategies.runge_kutta_methods(max_stages=3))
def test_limits_of_random_methods_in_balls(method: RungeKutta) -> None:
    """|R| is at most 1 a relative 1e-12 before the limit, and above 1 by 2**-60 beyond it; a polynomial grows."""
    r, small = stability_function(method), arb(2) ** -60
    for limit, direction in ((real_limit(r), acb(-1)), (imaginary_limit(r), acb(0, 1))):
        if r.num.degree() > 0:
            assert isinstance(limit, RealRoot)
            with ctx.workprec(2000):
                end = limit.ball()
                assert limit == ZERO_ROOT or modulus(r, direction * end * fmpq(10**12 - 1, 10**12)) <= 1
                assert modulus(r, direction * (small if limit == ZERO_ROOT else end * (1 + small))) > 1


def test_smallest_of_some_limits() -> None:
    two, root = rational_root(Q(2)), RealRoot((-3, 0, 1), 1)
    assert smallest([INFINITY, two, root]) == root
    assert smallest([INFINITY]) is INFINITY
    assert smallest([two, ZERO_ROOT]) == ZERO_ROOT
    assert smallest([]) is INFINITY


def test_first_bound_is_the_left_end_of_the_first_interval_that_fails_or_a_root_that_does() -> None:
    p, one, two = (Z - 1) ** 2 * (Z - 2) * (Z - 3), rational_root(Q(1)), rational_root(Q(2))
    roots = positive_roots([p])
    assert first_bound(roots, lambda x: p(x) >= 0) == (two, True)
    assert first_bound(roots, lambda x: p(x) >= 0, lambda root: root != two) == (two, False)
    assert first_bound(roots, lambda x: p(x) >= 0, lambda root: False) == (one, False)
    assert first_bound(roots, lambda x: True) is ALWAYS
    assert first_bound(roots, lambda x: False) is NEVER


def step_matrix(*entries: Any, over: int = 1) -> StepMatrix:
    qq, qv, vq, vv = (fraction((Z * 0 + entry) / over) for entry in entries)
    return (qq, qv), (vq, vv)


def companion(trace: Any, determinant: Any = 1) -> StepMatrix:
    """A matrix with this trace and determinant that is never a multiple of the identity."""
    return step_matrix(trace, -determinant, 1, 0)


def sheared(s: Any, factor: int = 1) -> StepMatrix:
    """± symplectic Euler with step s(h): the identity where s = 0, a Jordan block where |s| = 2."""
    return step_matrix((1 - s * s) * factor, s * factor, -s * factor, factor)


POWERS: dict[str, tuple[StepMatrix, str]] = {
    "the identity": (step_matrix(1, 0, 0, 1), "oo"),
    "a rotation by a right angle": (step_matrix(0, 1, -1, 0), "oo"),
    "free flight, a Jordan block at every h": (step_matrix(1, Z, 0, 1), "0"),
    "a Jordan block at every h, inside the circle": (step_matrix(Z * 0 + 1, Z * 3, 0, 1, over=3), "oo"),
    "a pole at 3 in a nilpotent matrix": (((NIL, fraction(fmpq_poly([1]), Z - 3)), (NIL, NIL)), "3"),
    "a Jordan block at every h but h = 1": (step_matrix(1, Z * (Z - 1), 0, 1), "0"),
    "growth at once": (step_matrix(1 + Z, 0, 0, 1), "0"),
    "eigenvalue 1 for ever, the other leaves at 2": (step_matrix(1, 0, 0, 1 - Z), "2"),
    "eigenvalues 1 and -1": (step_matrix(1, Z, 0, -1), "oo"),
    "trace touches 2 and returns, with a Jordan block": (companion(2 - (Z - 1) ** 2 * Z / 4), "1"),
    "trace touches -2 and returns, with a Jordan block": (companion(-2 + (Z - 1) ** 2 * Z / 4), "1"),
    "trace touches 2 and returns, through the identity": (sheared(Z * (1 - Z)), "2"),
    "trace touches -2 and returns, through minus the identity": (sheared(Z * (1 - Z), -1), "2"),
    "an irrational boundary": (step_matrix(0, 0, 0, (Z**2 - 2) / 3), "sqrt(5)"),
    "a boundary without radicals": (step_matrix(0, 0, 0, (Z**5 - Z) / 3), "x**5 - x - 3"),
    "a trace without terms in between": (companion(Z**3), "2**(1/3)"),
    "a pole at 3": (((fraction(1 - Z, 3 - Z), fraction(Z * 0)), (fraction(Z * 0), fraction(Z * 0))), "2"),
}


@pytest.mark.parametrize("name", POWERS)
def test_bounded_powers_of(name: str) -> None:
    m, limit = POWERS[name]
    assert limit_text(bounded_powers(m).limit) == limit


def test_touch_through_the_identity_over_a_number_field() -> None:
    """The step s(h) = h(√3 - h) is 0 at √3, which is no limit; the same trace with a Jordan block there is one."""
    s = polynomial([0, ROOT_3, -1])
    through = sheared(s)
    limit = bounded_powers(through).limit
    assert isinstance(limit, RealRoot)
    assert limit.minimal == (4, 0, -7, 0, 1)  # (√3 + √11)/2, where s = -2
    jordan = companion(2 - s * s)
    assert limit_text(bounded_powers(jordan).limit) == "sqrt(3)"


@given(strategies.splittings(max_pairs=3))
def test_powers_of_random_splittings_inside_and_beyond(method: Splitting) -> None:
    boundary = boundary_of(oscillator_matrix(method))
    limit = bounded_powers(oscillator_matrix(method)).limit

    def bounded_at(x: Q) -> bool:
        return is_bounded(boundary, lambda p: sign(evaluate(p, scalar(x))))

    if limit is INFINITY:
        assert bounded_at(Q(10**6, 7))
    elif limit == ZERO_ROOT:
        assert not bounded_at(Q(1, 10**40))
    else:
        assert isinstance(limit, RealRoot)
        with ctx.workprec(256):
            point = limit.ball().mid() * 2**200
        near = Q(int(point.unique_fmpz() or point.floor().unique_fmpz() or 0), 2**200)
        assert bounded_at(near * Q(10**12 - 1, 10**12))
        at_limit = is_bounded(boundary, lambda p: sign_at(p, limit))
        assert not (at_limit and bounded_at(near * Q(10**12 + 1, 10**12)))


def test_limit_of_a_splitting_over_a_cubic_field() -> None:
    limit = bounded_powers(oscillator_matrix(triple_jump())).limit
    assert record(limit) == {
        "exact": None, "minpoly": "x**6 - 36*x**4 + 432*x**2 - 864", "interval": ["1", "2"],
        "decimal": "1.573401947434540056629579441963",
    }  # fmt: skip
