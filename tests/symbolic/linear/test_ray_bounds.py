"""Bounds along rays: pairs of conjugates, Jordan blocks of three, and what is not decided."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import acb_poly, arb, ctx, fmpq, fmpq_poly

import driftproof
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.expressions import parse_system
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import rational_root
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError, pair_polynomial, ray_bound
from driftproof.symbolic.linear.stability_limits import ALWAYS, Bound
from driftproof.symbolic.linear.systems import SystemFacts
from tests.symbolic.linear.linear_examples import STUCK, Z


def test_what_is_not_decided_is_refused_with_a_reason() -> None:
    stuck = driftproof.facts("nystrom4", system=STUCK, only=("eigenvalues", "step_limit", "step_limit_attained")).data
    assert stuck["step_limit"]["refused"].startswith("no procedure decides this: a Jordan block")
    assert stuck["eigenvalues"][0]["limit"] == stuck["step_limit"]
    assert stuck["step_limit_attained"] is None
    pushed = Splitting("push", "Push", 0, "x", (("kick", Q(1)),))
    assert "without kicks or drifts" in str(driftproof.facts(pushed, system="0 1; 0 0", only=("step_limit",)).data)
    blocks = "0 1 0 1 0 0; 0 0 1 0 1 0; -1 -1 -1/2 0 0 1; 0 0 0 0 1 0; 0 0 0 0 0 1; 0 0 0 -1 -1 -1/2"
    refused = driftproof.facts("rk4", system=blocks, only=("eigenvalues",)).data["eigenvalues"]
    assert any("with a Jordan block" in str(e["limit"]) for e in refused)
    wide = "; ".join(
        " ".join("1" if j == i + 1 else "-1" if i == 9 and j in (0, 1) else "0" for j in range(10)) for i in range(10)
    )
    answer = driftproof.facts("dormand_prince54", system=wide, only=("eigenvalues",)).data["eigenvalues"]
    assert any("has degree 540 > 300" in str(e["limit"]) for e in answer), "R of degree 6, 45 pairs of 10 eigenvalues"
    idle = RungeKutta("idle", "Idle", 0, "x", ((Q(0),),), (Q(0),), (Q(0),))
    found = SystemFacts(idle, parse_system("0 1 0; 0 0 1; -5 -1 -1/2"))  # R = 1
    with pytest.raises(UndecidedLimitError, match="= 1 for every h"):
        _ = found.step_limit
    with pytest.raises(UndecidedLimitError, match=r"\d+ bits do not tell whether .* at h = 1/2"):
        found.bounded_at(Q(1, 2))


def test_a_contact_is_passed_by_blocks_whose_derivatives_vanish_there() -> None:
    """R = 1 + z(1 + z)²/(1 - z)³ is 1 at z = -1, where R' = 0 and R'' is not."""
    r = fraction((1 - Z) ** 3 + Z * (1 + Z) ** 2, (1 - Z) ** 3)
    bounds = [ray_bound(r, fmpq(-2), fmpq(1), block) for block in (1, 2, 3)]
    assert bounds == [ALWAYS, ALWAYS, Bound(rational_root(Q(1)), False)]


@pytest.mark.parametrize("minimal", [(250, 35, 251, 15, 50), (2, 2, 1, 2), (2, 0, 2, 0, 1)])
@pytest.mark.parametrize("key", ["heun2", "sdirk2", "gauss2"])
def test_polynomial_of_pairs_is_the_product_over_pairs(key: str, minimal: tuple[int, ...]) -> None:
    """At a rational h, up to a constant, against the product of Q(hλ)Q(hμ) - P(hλ)P(hμ) over computed roots."""
    r = stability_function_of(METHODS[key])
    assert r is not None
    found = pair_polynomial(r, minimal)
    quotients = []
    with ctx.workprec(300):
        roots = [root for root, _ in fmpq_poly(list(minimal)).numer().complex_roots()]
        for h in (fmpq(1, 3), fmpq(5, 7)):
            value = arb(found(h))
            for conjugate in conjugates(r):
                for i, x in enumerate(roots):
                    for y in roots[:i]:
                        if not (x + y).contains(0):
                            p, q = (acb_poly(c)(x * h) * acb_poly(c)(y * h) for c in conjugate)
                            value = value / (q - p)
            quotients.append(value)
        assert (quotients[0] - quotients[1]).contains(0)
        assert abs(quotients[0]) > 0


def conjugates(r: Any) -> list[tuple[list[Any], list[Any]]]:
    """(num, den) as balls, under each embedding of the field: Q, or Q(√n) with both roots."""

    def embedded(p: Any, sign: int) -> list[Any]:
        balls = []
        for c in (exact(c) for c in p.coeffs()):
            if isinstance(c, Algebraic):
                a, b = (*c.coefficients, Q(0))[:2]
                balls.append(
                    arb(fmpq(*a.as_integer_ratio()))
                    + sign * arb(fmpq(*b.as_integer_ratio())) * enclose(c.field.generator)
                )
            else:
                balls.append(arb(fmpq(*c.as_integer_ratio())))
        return balls

    signs = (1, -1) if any(isinstance(exact(c), Algebraic) for p in (r.num, r.den) for c in p.coeffs()) else (1,)
    return [(embedded(r.num, sign), embedded(r.den, sign)) for sign in signs]
