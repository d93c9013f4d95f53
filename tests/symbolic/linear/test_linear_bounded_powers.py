"""How far powers stay bounded: published limits, every kind of contact built on purpose, a second derivation."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import ctx, fmpq_poly
from hypothesis import given

from driftproof import strategies
from driftproof.methods.schemes import Splitting
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import evaluate, polynomial, scalar, sign
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, sign_at
from driftproof.symbolic.derivation.one_step import one_step_matrix as polynomial_matrix
from driftproof.symbolic.derivation.stability import stability_limit
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.linear.stability_limits import INFINITY, boundary_of, bounded_limit, is_bounded
from driftproof.texts.writing.records import record
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import NIL, ROOT_3, Z, limit_text, triple_jump


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
    "a pole at 3": (((fraction(1 - Z, 3 - Z), fraction(Z * 0)), (fraction(Z * 0), fraction(Z * 0))), "2"),
}


@pytest.mark.parametrize("name", POWERS)
def test_bounded_powers_of(name: str) -> None:
    m, limit = POWERS[name]
    assert limit_text(bounded_limit(m)) == limit


def test_touch_through_the_identity_over_a_number_field() -> None:
    """The step s(h) = h(√3 - h) is 0 at √3, which is no limit; the same trace with a Jordan block there is one."""
    s = polynomial([0, ROOT_3, -1])
    through = sheared(s)
    limit = bounded_limit(through)
    assert isinstance(limit, RealRoot)
    assert limit.minimal == (4, 0, -7, 0, 1)  # (√3 + √11)/2, where s = -2
    jordan = companion(2 - s * s)
    assert limit_text(bounded_limit(jordan)) == "sqrt(3)"


@pytest.mark.parametrize("key", NINE)
def test_bounded_limit_agrees_with_the_derivation_over_polynomials(key: str) -> None:
    """The second implementation works on SymPy's Q[h] and algebraic fields."""
    ours, theirs = bounded_limit(oscillator_matrix(NINE[key])), stability_limit(polynomial_matrix(NINE[key]))
    if ours is INFINITY:
        assert str(theirs) == "oo"
    else:
        assert isinstance(ours, RealRoot)
        low, high = ours.interval()
        assert low <= theirs <= high


@given(strategies.splittings(max_pairs=3))
def test_powers_of_random_splittings_inside_and_beyond(method: Splitting) -> None:
    boundary = boundary_of(oscillator_matrix(method))
    limit = bounded_limit(oscillator_matrix(method))

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
    limit = bounded_limit(oscillator_matrix(triple_jump()))
    assert record(limit) == {
        "exact": None,
        "minpoly": "x**6 - 36*x**4 + 432*x**2 - 864",
        "interval": ["1", "2"],
        "decimal": "1.573401947434540056629579441963",
    }
