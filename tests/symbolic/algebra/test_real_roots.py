"""Real roots are those that SymPy isolates, in order, and what vanishes at them is decided exactly."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy
from flint import ctx, fmpq, fmpq_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.algebra.polynomials import polynomial, reflected, scalar, sign_changes
from driftproof.symbolic.algebra.real_roots import (
    ZERO_ROOT,
    RealRoot,
    positive_roots,
    rational_root,
    samples,
    sign_at,
    vanishes_at,
)

ROOT_3, ROOT_2 = square_root(3), square_root(2)
X = fmpq_poly([0, 1])


@pytest.mark.parametrize(
    ("root", "shown"),
    [
        (RealRoot((-8, 0, 1), 1), "2.8284271247461900976, a root of x**2 - 8"),
        (rational_root(Q(-1, 3)), "-1/3"),
        (RealRoot((1, -3, 0, 1), 0), "-1.8793852415718167681, a root of x**3 - 3*x + 1"),
    ],
)
def test_a_root_is_shown_as_people_write_it(root: RealRoot, shown: str) -> None:
    assert str(root) == repr(root) == shown


@settings(max_examples=40)
@given(st.lists(st.integers(-6, 6), min_size=2, max_size=6))
def test_positive_roots_are_those_that_sympy_isolates(c: list[int]) -> None:
    assume(any(c))
    p = polynomial(c)
    ours = positive_roots([p])
    x = sympy.Symbol("x")
    poly = sympy.Poly(list(reversed(c)), x)
    theirs = sorted({r for r in poly.real_roots(radicals=False) if r.is_positive}) if poly.degree() > 0 else []
    assert len(ours) == len(theirs) <= sign_changes(p)
    for mine, other in zip(ours, theirs, strict=True):
        low, high = mine.interval()
        assert low <= other <= high
        assert sympy.minimal_polynomial(other, x) == sympy.Poly(list(reversed(mine.minimal)), x).as_expr()
        assert sign_at(p, mine) == 0


def test_positive_roots_merge_repeated_ones_and_are_sampled_between() -> None:
    roots = positive_roots([(X - 1) ** 3 * (X**2 - 2), X**2 - 2, X * (X + 5), X - 3])
    assert [root.minimal for root in roots] == [(-1, 1), (-2, 0, 1), (-3, 1)]
    assert samples(roots) == [fmpq(1, 2), fmpq(5, 4), 2, 4]
    assert [RealRoot((-2, 0, 1), k).interval() for k in range(2)] == [(-2, -1), (1, 2)]
    assert positive_roots([X + 1]) == []
    assert samples([]) == [1]


def test_two_roots_that_differ_by_a_tiny_amount_are_told_apart() -> None:
    tiny = fmpq(1, 10**60)
    first, second = positive_roots([X - 1, X - 1 - tiny])
    (middle,) = samples([first, second])[1:2]
    assert 1 < middle < 1 + tiny
    assert samples([second]) == [fmpq(1, 2), 2]
    twins = positive_roots([(X**2 - 2) * 10**80 - 1, X**2 - 2])
    assert twins[0].minimal == (-2, 0, 1)
    assert len(twins) == 2


def test_ends_of_roots_that_nearly_coincide_lie_between_them() -> None:
    """(x - 1)² = 2⁻¹⁹⁹, which 64 bits do not tell from a double root."""
    size = 2**199
    low, high = (RealRoot((size - 1, -2 * size, size), k).interval() for k in (0, 1))
    assert low[0] < low[1] <= 1 <= high[0] < high[1]
    for left, right in (low, high):
        assert ((left - 1) ** 2 * size - 1) * ((right - 1) ** 2 * size - 1) < 0


def test_square_root_of_an_algebraic_number() -> None:
    golden = positive_roots([X**2 - X - 1])[0]
    assert golden.square_root().minimal == (-1, 0, -1, 0, 1)
    assert rational_root(Q(9, 4)).square_root() == rational_root(Q(3, 2))
    assert RealRoot((-3, -2, 1), 0) != rational_root(Q(3))
    assert (golden.negated(), rational_root(Q(2)).negated()) == (RealRoot((-1, 1, 1), 0), rational_root(Q(-2)))
    square = RealRoot((1, -3, 1), 1)  # golden ** 2
    assert square.square_root() == golden
    assert ZERO_ROOT.square_root() == ZERO_ROOT
    with pytest.raises(ValueError, match="negative"):
        rational_root(Q(-1)).square_root()


def test_zero_at_an_algebraic_number_is_decided_over_number_fields() -> None:
    root = RealRoot((-3, 0, 1), 1)
    p = polynomial([-ROOT_3, 1])
    assert vanishes_at(p, root)
    assert not vanishes_at(reflected(p), root)
    assert not vanishes_at(p, root.negated())
    assert not vanishes_at(p + Q(1, 10**50).numerator * scalar(Q(1, 10**50)), root)
    assert (sign_at(p, rational_root(Q(2))), sign_at(p, rational_root(Q(1)))) == (1, -1)
    assert vanishes_at(p * 0, root)


def test_zero_is_decided_between_conjugates_that_nearly_coincide() -> None:
    """1 ± 1e-30 sqrt(2): at 64 bits both look like roots of both factors of their minimal polynomial."""
    tiny = Q(1, 10**30)
    p = polynomial([-(1 + tiny * ROOT_2), 1])
    minimal = (10**60 - 2, -2 * 10**60, 10**60)
    divisor = 2
    lower, upper = (RealRoot(tuple(c // divisor for c in minimal), k) for k in range(2))
    assert positive_roots([p]) == [lower, upper]
    assert (vanishes_at(p, lower), vanishes_at(p, upper)) == (False, True)
    assert (sign_at(p, lower), sign_at(p, upper)) == (-1, 0)
    with ctx.workprec(300):
        assert lower.square_root().ball() ** 2 < upper.ball()
        assert upper.square_root().ball() ** 2 > lower.ball()
