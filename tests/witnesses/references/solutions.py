"""The decimals of every reference, computed anew: closed forms in balls, and solutions that are enclosed."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from flint import arb, ctx

from driftproof.numeric.problems.problem import EXACT, Problem
from driftproof.reports.user_problem import enclosed_reference
from driftproof.symbolic.algebra.certified import CertifiableReal, significant
from tests.witnesses.references.closed_forms import CLOSED_FORMS

PLACES = 20
LEAST_EXPONENT = 400
Row = list[str]


def computed(problem: Problem, times: Sequence[Fraction]) -> list[Row]:
    """The states at the times as decimals, by the evidence that the reference of the problem claims."""
    if problem.reference.evidence == EXACT:
        return [closed_form(problem.key, t) for t in times]
    return list(map(list, enclosed_reference(problem.field, problem.start, times).states))


def closed_form(key: str, t: Fraction) -> Row:
    state = cache(lambda _bits: CLOSED_FORMS[key](t))
    return [_decimal(lambda i=i: state(ctx.prec)[i]) for i in range(len(state(ctx.prec)))]


def _decimal(value: CertifiableReal) -> str:
    """Correctly rounded to PLACES digits; what is far below any format that runs here is 0e-400."""
    with ctx.workprec(64):
        if callable(value) and value().abs_upper() < arb(10) ** -LEAST_EXPONENT / 2:
            return f"0e-{LEAST_EXPONENT}"
    return significant(value, PLACES)
