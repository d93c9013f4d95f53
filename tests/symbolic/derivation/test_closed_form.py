"""M to the N in closed form against squaring: the same numbers, and one step too few is noticed."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy
from flint import arb, ctx

from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.derivation.closed_form import STEPS, closed_form
from driftproof.symbolic.derivation.one_step import matrix_at, one_step_matrix
from driftproof.symbolic.runs import power
from tests.nine import NINE


@pytest.mark.parametrize("key", NINE)
@pytest.mark.parametrize("n", [0, 1, 7, 100])
def test_closed_form_is_the_power(key: str, n: int) -> None:
    m, h = one_step_matrix(NINE[key]), Q(1, 2)
    exact = power(matrix_at(m, h), n)
    assert all(_encloses(form, x) for form, x in zip(_closed(key, n), exact, strict=True))


def test_closed_form_notices_one_step_too_few() -> None:
    exact = power(matrix_at(one_step_matrix(NINE["rk4"]), Q(1, 2)), 7)
    assert not all(_encloses(form, x) for form, x in zip(_closed("rk4", 6), exact, strict=True))


def _closed(key: str, n: int) -> list[sympy.Expr]:
    form = closed_form(one_step_matrix(NINE[key]))
    return list(form.subs({STEPS: n, sympy.Symbol("h"): sympy.Rational(1, 2)}))


def _encloses(form: sympy.Expr, x: Q) -> bool:
    """The two agree to 10^-40, certified. A tie of both cannot be decided by balls, so a distance is."""
    with ctx.workprec(300):
        return bool(abs(enclose(form) - enclose(Q(x))) < arb(10) ** -40)
