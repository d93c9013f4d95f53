"""Stability limits held against growth evaluated in balls: none just inside a limit, some just outside."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeAlias

from flint import acb, arb, ctx, fmpq

from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit
from tests.symbolic.linear.linear_examples import at, modulus

Growth: TypeAlias = Callable[[arb], arb]

EPSILON = fmpq(1, 10**12)
# Eigenvalues on the unit circle are computed, so that they are only nearly there.
SLACK = arb(2) ** -2000


def limits_with_growth(method: Method) -> Iterator[tuple[Limit, Growth]]:
    """Each limit of the method, and what one step multiplies by: |R(-x)| and |R(ix)|, or the spectral radius of M."""
    facts = LinearFacts(method)
    r, m = stability_function_of(method), facts.one_step_matrix
    if r is None:
        yield facts.imaginary_limit, lambda x: spectral_radius(m, x)
        return
    assert facts.real_limit is not None
    yield facts.real_limit, lambda x: modulus(r, acb(-x))
    yield facts.imaginary_limit, lambda x: modulus(r, acb(0, x))


def is_where_growth_begins(limit: Limit, growth: Growth, moved: fmpq | int = 1) -> bool:
    """True for the limit itself; false for one that is `moved` by a factor."""
    with ctx.workprec(8000):
        if limit is INFINITY:
            return not any(growth(arb(size)) > 1 for size in (1, 10, 10**6))
        assert isinstance(limit, RealRoot)
        if limit == ZERO_ROOT:
            return bool(growth(arb(2) ** -200) > 1)
        inside, outside = (limit.ball() * moved * (1 + side * EPSILON) for side in (-1, 1))
        return not growth(inside) > 1 + SLACK and bool(growth(outside) > 1)


def spectral_radius(m: StepMatrix, h: arb) -> arb:
    (qq, qv), (vq, vv) = [[at(f, h) for f in row] for row in m]
    half, area = acb((qq + vv) / 2), acb(qq * vv - qv * vq)
    root = (half * half - area).sqrt()
    return abs(half + root).max(abs(half - root))
