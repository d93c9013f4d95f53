"""The decimals of every reference, computed: closed forms, enclosures, or two independent programs that must agree."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from flint import arb, ctx

from driftproof.numeric.problems.problem import CERTIFIED, EXACT, Problem
from driftproof.symbolic.algebra.certified import CertifiableReal, endpoints, significant
from tests.witnesses.references.chebyshev import Chebyshev
from tests.witnesses.references.closed_forms import CLOSED_FORMS, ball
from tests.witnesses.references.collocation import Collocation
from tests.witnesses.references.taylor import Taylor

PLACES, FEWEST = 20, 12
LEAST_EXPONENT = 400
# Terms of a series, bits and steps to a unit of time: what leaves more than PLACES digits at the end.
CERTIFYING = {"henon_heiles": (70, 600, 8)}
# All of the problems that are computed twice change over longer times than that at first.
FIRST_STEP = "1e-8"
Row = list[str]


class Disagreement(ArithmeticError):
    """Two programs agree on fewer digits than a reference needs."""


def computed(problem: Problem, times: Sequence[Fraction]) -> list[Row]:
    """The states at the times as decimals, by the evidence that the reference of the problem claims."""
    if problem.reference.evidence == EXACT:
        return [closed_form(problem.key, t) for t in times]
    if problem.reference.evidence == CERTIFIED:
        return enclosed(problem, times)
    first, second = by_collocation(problem, times), by_chebyshev(problem, times)
    return [[common(a, b) for a, b in zip(x, y, strict=True)] for x, y in zip(first, second, strict=True)]


def closed_form(key: str, t: Fraction) -> Row:
    state = cache(lambda _bits: CLOSED_FORMS[key](t))
    return [_decimal(lambda i=i: state(ctx.prec)[i]) for i in range(len(state(ctx.prec)))]


def enclosed(problem: Problem, times: Sequence[Fraction]) -> list[Row]:
    order, bits, density = CERTIFYING[problem.key]
    rows, before = [], Fraction(0)
    with ctx.workprec(bits):
        taylor, y = Taylor(problem.field, order), [ball(x) for x in problem.start]
        for t in times:
            y = taylor.flow(y, before, t, int((t - before) * density))
            rows.append([_of_ball(x) for x in y])
            before = t
    return rows


def by_collocation(problem: Problem, times: Sequence[Fraction]) -> list[list[Fraction]]:
    program = Collocation(problem.field)
    with ctx.workprec(program.bits):
        start = [ball(x).mid() for x in problem.start]
    found = program.integrate(start, times, float(FIRST_STEP))
    return [[endpoints(x)[0] for x in y] for y in found]


def by_chebyshev(problem: Problem, times: Sequence[Fraction]) -> list[list[Fraction]]:
    found = Chebyshev(problem.field).integrate(problem.start, times, FIRST_STEP)
    return [[Fraction(x) for x in y] for y in found]


def common(a: Fraction, b: Fraction) -> str:
    """Both rounded to as many digits as make them one text, at most PLACES. Raises Disagreement below FEWEST."""
    for digits in range(PLACES, FEWEST - 1, -1):
        if (text := significant(a, digits)) == significant(b, digits):
            return text
    raise Disagreement(f"{significant(a, PLACES)} and {significant(b, PLACES)}")


def _decimal(value: CertifiableReal) -> str:
    """Correctly rounded to PLACES digits; what is far below any format that runs here is 0e-400."""
    with ctx.workprec(64):
        if callable(value) and value().abs_upper() < arb(10) ** -LEAST_EXPONENT / 2:
            return f"0e-{LEAST_EXPONENT}"
    return significant(value, PLACES)


def _of_ball(x: arb) -> str:
    low, high = (significant(end, PLACES) for end in endpoints(x))
    if low != high:
        raise Disagreement(f"the ball {x} is too wide for {PLACES} digits")
    return low
