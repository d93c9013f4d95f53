"""Phase and damping per step: series against closed form, against published coefficients, against mpmath."""

from __future__ import annotations

from fractions import Fraction as Q
from math import factorial

import mpmath
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.certified import enclose, is_less
from driftproof.symbolic.derivation.one_step import (
    RING,
    H,
    at_rational,
    determinant,
    matrix,
    matrix_at,
    one_step_matrix,
    rational,
)
from driftproof.symbolic.derivation.phase import (
    cosine_series,
    damping_series,
    leading_term,
    phase_error_series,
    phase_per_step,
    sine_series,
)
from tests.nine import NINE

TERMS = 9
SMALL = Q(1, 100)


@pytest.mark.parametrize("key", NINE)
def test_phase_series_is_the_closed_form_to_its_last_term(key: str) -> None:
    """What is left beyond h**TERMS is about the next nonzero term; twice that is a certified bound at h = 1/100."""
    m = one_step_matrix(NINE[key])
    theta = phase_per_step(m).subs(sympy.Symbol("h"), sympy.Rational(1, 100))
    series = at_rational(phase_error_series(m, TERMS), SMALL)
    longer = phase_error_series(m, TERMS + 4)
    following = at_rational(longer - phase_error_series(m, TERMS), SMALL)
    assert following != 0
    left = lambda: abs(enclose(theta) - enclose(SMALL) - enclose(series))
    assert is_less(left, 2 * abs(following))
    assert not is_less(left, abs(following) / 2)


@pytest.mark.parametrize("key", NINE)
def test_damping_series_is_the_logarithm_to_its_last_term(key: str) -> None:
    m = one_step_matrix(NINE[key])
    area = at_rational(determinant(m), SMALL)
    series = at_rational(damping_series(m, 20), SMALL)
    # The first omitted term is below h^20, whose coefficients here are below 1; the rest adds less than as much again.
    with mpmath.workdps(60):
        exact = mpmath.log(mpmath.mpf(area.numerator) / area.denominator) / 2
        left = abs(exact - mpmath.mpf(series.numerator) / series.denominator)
        assert left < 2 * mpmath.mpf(10) ** -40
    assert (damping_series(m, 20) == 0) == (determinant(m) == 1)


LEADING = {
    "forward_euler": ((3, Q(-1, 3)), (2, Q(1, 2))),
    "symplectic_euler": ((3, Q(1, 24)), None),
    "velocity_verlet": ((3, Q(1, 24)), None),
    "midpoint2": ((3, Q(1, 6)), (4, Q(1, 8))),
    "rk4": ((5, Q(-1, 120)), (6, Q(-1, 144))),
}


@pytest.mark.parametrize("key", LEADING)
def test_leading_terms_are_the_published_ones(key: str) -> None:
    m = one_step_matrix(NINE[key])
    phase, damping = leading_term(phase_error_series(m, TERMS)), leading_term(damping_series(m, TERMS))
    assert [phase, damping] == [term and (term[0], rational(term[1])) for term in LEADING[key]]


def test_forward_euler_turns_by_the_arctangent() -> None:
    series = phase_error_series(one_step_matrix(NINE["forward_euler"]), 8) + H
    assert series == H - H**3 / 3 + H**5 / 5 - H**7 / 7


@given(st.fractions(Q(1, 100), Q(5, 2), max_denominator=100))
def test_closed_form_angle_is_the_argument_of_the_eigenvalue(h: Q) -> None:
    m = one_step_matrix(NINE["rk4"])
    theta = phase_per_step(m).subs(sympy.Symbol("h"), sympy.Rational(h.numerator, h.denominator))
    with mpmath.workdps(50):
        values = [mpmath.mpf(x.numerator) / x.denominator for x in matrix_at(m, h)]
        eigenvalues, _ = mpmath.eig(mpmath.matrix([values[:2], values[2:]]))
        angle = max(mpmath.arg(z) for z in eigenvalues)
        # mpmath works in 50 digits and says nothing of its error; half of them are ample for eigenvalues 0.02 apart.
        assert abs(angle - mpmath.mpf(str(sympy.N(theta, 50)))) < mpmath.mpf(10) ** -25


@pytest.mark.parametrize(
    "rows",
    [[[1, 0], [0, 1]], [[2, H], [-H, 2]], [[1, 2 * H], [-H, 1]], [[1, H], [H, 1]], [[1 + H, 0], [0, 1]]],
    ids=["still", "scaled", "too fast", "hyperbolic", "stretched"],
)
def test_phase_series_of_an_inconsistent_step_is_refused(rows: list[list[object]]) -> None:
    with pytest.raises(ValueError, match="not a consistent rotation"):
        phase_error_series(matrix(rows), TERMS)


@given(st.integers(1, 20))
def test_sine_and_cosine_series_have_their_factorials_and_stop_in_time(terms: int) -> None:
    s, c = sine_series(terms), cosine_series(terms)
    for power in range(terms):
        sign, series = (-1) ** (power // 2), (s if power % 2 else c)
        assert series.coeff(H**power) == rational(Q(sign, factorial(power)))
    assert max(s.degree(), c.degree()) <= max(terms - 1, 0)


def test_leading_term_is_the_lowest_and_zero_has_none() -> None:
    assert leading_term(3 * H**5 - H**2) == (2, -1)
    assert leading_term(RING.one) == (0, 1)
    assert leading_term(RING.zero) is None
