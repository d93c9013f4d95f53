"""Phase per step: its series against its closed form, enclosed, and against published coefficients."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy

from driftproof.symbolic.algebra.certified import enclose, is_less
from driftproof.symbolic.derivation.expression_balls import enclose_expression
from driftproof.symbolic.derivation.one_step import RING, H, at_rational, matrix, one_step_matrix
from driftproof.symbolic.derivation.phase import leading_term, phase_error_series, phase_per_step
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
    left = lambda: abs(enclose_expression(theta) - enclose(SMALL) - enclose(series))
    assert is_less(left, 2 * abs(following))
    assert not is_less(left, abs(following) / 2)


@pytest.mark.parametrize(
    "rows",
    [[[1, 0], [0, 1]], [[2, H], [-H, 2]], [[1, 2 * H], [-H, 1]], [[1, H], [H, 1]], [[1 + H, 0], [0, 1]]],
    ids=["still", "scaled", "too fast", "hyperbolic", "stretched"],
)
def test_phase_series_of_an_inconsistent_step_is_refused(rows: list[list[object]]) -> None:
    with pytest.raises(ValueError, match="does not turn by an angle h"):
        phase_error_series(matrix(rows), TERMS)


def test_leading_term_is_the_lowest_and_zero_has_none() -> None:
    assert leading_term(3 * H**5 - H**2) == (2, -1)
    assert leading_term(RING.one) == (0, 1)
    assert leading_term(RING.zero) is None
