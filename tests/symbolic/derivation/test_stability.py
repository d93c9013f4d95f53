"""Stability limits: the published ones, touching boundaries built on purpose, and a second opinion in floats."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import mpmath
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st
from sympy.polys.matrices import DomainMatrix

from driftproof import strategies
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.algebra.real_roots import RealRoot
from driftproof.symbolic.derivation.expression_balls import enclose_expression, integer_coefficients
from driftproof.symbolic.derivation.one_step import (
    FRACTION_FIELD,
    RING,
    H,
    determinant,
    expression,
    matrix,
    matrix_at,
    one_step_matrix,
    rational,
    trace,
)
from driftproof.symbolic.derivation.stability import LAMBDA, AtStep, minimal_polynomial_of, multipliers, stability_limit
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.linear.stability_limits import bounded_limit
from driftproof.symbolic.runs import apply
from tests.nine import NINE
from tests.symbolic.linear.test_stability_limits import POWERS

SYMPLECTIC = one_step_matrix(NINE["symplectic_euler"])
RK4 = one_step_matrix(NINE["rk4"])
ENDPOINT = 2 * sympy.sqrt(2)


def bounded_at(m: DomainMatrix, x: float) -> bool:
    """Whether the powers are bounded at the exact value of a double."""
    return AtStep(m, sympy.Rational(*x.as_integer_ratio())).bounded


def test_symplectic_euler_has_a_jordan_block_at_two_and_grows() -> None:
    at = AtStep(SYMPLECTIC, sympy.Integer(2))
    assert (at.trace, at.determinant, at.jordan_block, at.bounded) == (-2, 1, True, False)
    assert at.matrix == sympy.ImmutableMatrix([[-3, 2], [-2, 1]])
    state, visited = (Q(1), Q(0)), []
    for _ in range(5):
        state = apply(matrix_at(SYMPLECTIC, Q(2)), *state)
        visited.append(state)
    assert visited == [(-3, -2), (5, 4), (-7, -6), (9, 8), (-11, -10)]


def test_rk4_is_bounded_below_the_double_next_to_two_root_two_and_not_above() -> None:
    double = strategies.STABILITY_LIMITS[1]
    verdicts = [bounded_at(RK4, strategies.step_by_ulps(double, k)) for k in range(-2, 3)]
    assert verdicts == sorted(verdicts, reverse=True)
    assert len(set(verdicts)) == 2
    assert Q(double) ** 2 != 8


@pytest.mark.parametrize("ulps", range(-3, 4))
def test_symplectic_euler_is_bounded_at_doubles_below_two_only(ulps: int) -> None:
    assert bounded_at(SYMPLECTIC, strategies.step_by_ulps(2.0, ulps)) == (ulps < 0)


def over_sympy(m: StepMatrix) -> DomainMatrix:
    """The same matrix over SymPy's Q(h)."""

    def entry(p: Any) -> Any:
        return FRACTION_FIELD.convert(sum((rational(c) * H**k for k, c in enumerate(coefficients(p))), RING.zero))

    return matrix([[entry(x.num) / entry(x.den) for x in row] for row in m])


@pytest.mark.parametrize("name", POWERS)
def test_limit_of_a_matrix_built_on_purpose(name: str) -> None:
    m, limit = POWERS[name]
    found = str(stability_limit(over_sympy(m)))
    assert found == (f"CRootOf({limit}, 0)".replace("x", "h") if "x" in limit else limit)


THIRD = rational(Q(1, 3))
TOUCHING = matrix([[0, 1 - H * (H - 1) ** 2 / 4], [-1, 0]])  # its determinant touches 1 and returns
S = H * (1 - H) * (2 - H) / 4
TOUCHING_TWICE = matrix([[1 - S**2, S], [-S, 1]])  # the identity where S = 0


def test_determinant_that_touches_one_is_no_limit() -> None:
    limit = stability_limit(TOUCHING)
    assert AtStep(TOUCHING, sympy.Integer(1)).determinant == 1
    assert expression(determinant(TOUCHING)).subs(sympy.Symbol("h"), limit).equals(-1)


def test_limit_without_radicals_is_a_root_of_its_polynomial() -> None:
    limit = stability_limit(over_sympy(POWERS["a boundary without radicals"][0]))
    assert isinstance(limit, sympy.CRootOf)
    assert sympy.minimal_polynomial(limit, LAMBDA) == LAMBDA**5 - LAMBDA - 3


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["yoshida8", "suzuki_umeno8", "kahan_li8"])
def test_limit_with_long_coefficients_is_found_without_a_list_of_all_roots(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sympy.CRootOf, "_get_reals", None)  # it takes minutes, and was asked for
    m = one_step_matrix(METHODS[key])
    limit, expected = stability_limit(m), bounded_limit(oscillator_matrix(METHODS[key]))
    assert isinstance(expected, RealRoot)
    assert enclose_expression(limit).overlaps(expected.ball())
    assert integer_coefficients(minimal_polynomial_of(m, limit)) in (
        expected.minimal,
        tuple(-c for c in expected.minimal),
    )


def test_limit_passes_each_touch_in_turn() -> None:
    assert stability_limit(TOUCHING_TWICE).evalf() > 2
    assert all(AtStep(TOUCHING_TWICE, sympy.Integer(touch)).matrix == sympy.eye(2) for touch in (1, 2))


@pytest.mark.slow
@given(strategies.runge_kutta_methods(max_stages=3) | strategies.splittings(max_pairs=2))
def test_powers_are_bounded_inside_the_limit_and_not_just_beyond(method: Any) -> None:
    m = one_step_matrix(method)
    limit = stability_limit(m)
    tiny = sympy.Rational(1, 2**100)
    if limit == 0 or limit == sympy.oo:
        sample = tiny if limit == 0 else sympy.Integer(10**6)
        assert AtStep(m, sample).bounded == (limit == sympy.oo)
    else:
        inside = sympy.Rational(sympy.floor(limit * 2**60), 2**60) - sympy.Rational(1, 2**60)
        assert AtStep(m, inside).bounded
        assert not (AtStep(m, limit).bounded and AtStep(m, inside + sympy.Rational(1, 2**58)).bounded)


ENTRY = st.fractions(-2, 2, max_denominator=20)


@given(st.tuples(*4 * [ENTRY]))
def test_bounded_agrees_with_the_spectral_radius_in_floats(rows: tuple[Q, Q, Q, Q]) -> None:
    a, b, c, d = rows
    half_trace, det = mpmath.mpf(float(a + d)) / 2, float(a * d - b * c)
    root = mpmath.sqrt(half_trace**2 - det)
    radius = max(abs(half_trace + root), abs(half_trace - root))
    # Entries of size 2 round by 2^-53 at most; a double root turns that into its square root, below 1e-6.
    assume(abs(radius - 1) > 1e-6)
    assert AtStep(matrix([[a, b], [c, d]]), sympy.Integer(1)).bounded == (radius < 1)


JORDAN = [
    (matrix([[1, 1], [0, 1]]), True, False), (matrix([[-1, 0], [5, -1]]), True, False),
    (matrix([[1, 0], [0, 1]]), False, True), (matrix([[-1, 0], [0, -1]]), False, True),
    (matrix([[THIRD, 1], [0, THIRD]]), True, True),  # a Jordan block inside the circle does no harm
    (matrix([[2, 0], [0, 2]]), False, False), (matrix([[1, 0], [0, -1]]), False, True),
    (matrix([[2, 0], [0, rational(Q(1, 2))]]), False, False),  # determinant 1, and a root outside
    (matrix([[-2, 0], [0, rational(Q(1, 2))]]), False, False),
]  # fmt: skip


@pytest.mark.parametrize(("m", "jordan", "bounded"), JORDAN, ids=range(len(JORDAN)))
def test_jordan_blocks_matter_on_the_unit_circle_only(m: DomainMatrix, jordan: bool, bounded: bool) -> None:
    at = AtStep(m, sympy.Integer(1))
    assert (at.jordan_block, at.bounded) == (jordan, bounded)


@pytest.mark.parametrize("key", NINE)
def test_multipliers_are_the_two_roots(key: str) -> None:
    m = one_step_matrix(NINE[key])
    first, second = multipliers(m)
    assert sympy.expand(first + second - expression(trace(m))) == 0
    assert sympy.expand(first * second - expression(determinant(m))) == 0
    assert sympy.expand(first - second) != 0
