"""Matrices in doubles hold what they stand for, rounding and underflows included, and each planted slip is caught."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from driftproof.enclosure.arithmetic import double_balls
from driftproof.enclosure.solution.collocation import collocation
from tests.enclosure.mutants import mutant
from tests.looping import exactly

N, LENGTH = 3, 5


def drawn(exponent, radius, terms=LENGTH):
    """Polynomials of matrices of balls with numbers about 2^exponent, of so many terms."""
    random = Random(2)
    ball = lambda: arb(random.uniform(-1, 1), radius * random.random()) * arb(2) ** exponent / 3
    return [arb_mat([[ball() for _ in range(N)] for _ in range(N)]) for _ in range(terms)]


def ends(matrices, sign):
    """The largest or the smallest matrices in the balls."""
    return [arb_mat([[x.mid() + sign * x.rad() for x in row] for row in m.tolist()]) for m in matrices]


def all_hold(found, wanted, wide=0.0):
    """True if all entries of exact matrices are within, and none is much wider than it has to be."""
    pairs = [
        (arb(mid), arb(rad), x)
        for m, r, exact in zip(found.mid, found.rad, wanted, strict=True)
        for mid, rad, x in zip(m.ravel().tolist(), r.ravel().tolist(), exact.entries(), strict=True)
    ]
    return all(abs(x - mid) <= rad for mid, rad, x in pairs) and all(rad <= wide for _, rad, _ in pairs)


def in_doubles(matrices):
    return np.array([[[float(x) for x in row] for row in m.tolist()] for m in matrices])


def products_hold(module, exponent=0, wide=2.0**-45):
    """Of doubles, about 2^exponent."""
    a = in_doubles(drawn(exponent, 0))
    found, wanted = module.convolved(module.DoubleBalls(a, 0 * a), a), [arb_mat(N, N) for _ in range(2 * LENGTH - 1)]
    for i, x in enumerate(a):
        for j, y in enumerate(a):
            wanted[i + j] += arb_mat(x.tolist()) * arb_mat(y.tolist())
    return all_hold(found, wanted, wide)


def balls_hold(module):
    """Also those of numbers below all doubles, and above."""
    for exponent, wide in ((0, 2.0**-9), (-1100, 2.0**-1000)):
        a = drawn(exponent, 2.0**-10)
        if not all(all_hold(module.coefficients_in_doubles(a), ends(a, sign), wide) for sign in (-1, 1)):
            return False
    return all_hold(module.coefficients_in_doubles(drawn(0, 0)), drawn(0, 0), 2.0**-45)


def wide_products_hold(module):
    """Where all numbers are positive, their ends are reached."""
    a = [arb_mat([[arb(1, 2.0**-10)] * N] * N)] * 2
    found = module.convolved(module.coefficients_in_doubles(a), np.ones((2, N, N)))
    return all(rad >= count * N * 2.0**-10 for count, rad in zip((1, 2, 1), found.rad.min(axis=(1, 2)), strict=True))


def underflows_hold(module):
    """Products about 2^-1100 are 0 in doubles."""
    return products_hold(module, -550, 2.0**-1000)


def ranges_hold(module):
    with ctx.workprec(128):
        chebyshev = collocation(4, 64, LENGTH - 1).chebyshev  # one coefficient is beyond them
        a = [m * (1 << 20) for m in drawn(0, 2.0**-30)]
        found = module.ranges(chebyshev, a)
        most = module.bounds(chebyshev, a)
        for sigma in exactly(9, np.linspace(-1, 1, 9).tolist()):
            for sign in (-1, 1):
                value = sum((m * arb(sigma) ** k for k, m in enumerate(ends(a, sign))), arb_mat(N, N))
                if not all_hold(found, [value], 2.0**23):
                    return False
                if not all(abs(x) <= y for x, y in zip(value.entries(), most.entries(), strict=True)):
                    return False
    return True


def range_is_that_of_chebyshev(module):
    """8σ⁴ - 8σ² + 1 is in [-1, 1], which the powers do not show."""
    coefficients = [arb_mat([[c]]) for c in (1, 0, -8, 0, 8)]
    with ctx.workprec(128):
        (found,) = module.bounds(collocation(4, 64, 10).chebyshev, coefficients).entries()
    return 1 <= found < 1 + 2.0**-40


def difference_and_sums_hold(module):
    """The slopes less what they are rounded to; the norm of a polynomial is that of the sizes of its coefficients."""
    thin = in_doubles(drawn(0, 0))
    exact = [arb_mat(m.tolist()) for m in thin]
    slopes, total = module.derivative(thin), module.value_at_one(thin)
    wanted = [m * k for k, m in enumerate(exact)][1:]
    left = module.DoubleBalls(slopes.mid, 0 * slopes.mid).less(slopes)
    differences = [arb_mat(x.tolist()) - y for x, y in zip(slopes.mid, wanted, strict=True)]
    of_rows = [sum(abs(x) for m in exact for x in m.tolist()[i]) for i in range(N)]
    norm = module.norm_of(np.abs(thin))
    return (
        all_hold(slopes, wanted, 2.0**-45)
        and all_hold(left, differences, 2.0**-45)
        and all(x.contains(y) for x, y in zip(total.entries(), sum(exact[1:], exact[0]).entries(), strict=True))
        and all(x.rad() < 2.0**-45 for x in total.entries())
        and all(row <= norm for row in of_rows)
        and norm < max(of_rows, key=float) * (1 + 2.0**-40)
    )


CHECKS = (
    *(products_hold, balls_hold, wide_products_hold, underflows_hold, ranges_hold),
    *(range_is_that_of_chebyshev, difference_and_sums_hold),
)
WRONG = {
    "the rounding of products dropped": (products_hold, ("a.rad + c * np.abs(a.mid)", "a.rad")),
    "the radii of balls dropped": (balls_hold, ("(rad + 4 * _U", "(0 * rad + 4 * _U")),
    "the balls' radii dropped": (wide_products_hold, ("a.rad + c * np.abs(a.mid)", "c * np.abs(a.mid)")),
    "the rounding of balls dropped": (balls_hold, ("(rad + 4 * _U * np.abs(mid))", "rad")),
    "underflows dropped": (underflows_hold, ("(1 + c) + terms * _TINY", "(1 + c)")),
    "underflows of balls dropped": (balls_hold, ("_U) + _TINY)\n\n    def sizes", "_U))\n\n    def sizes")),
    "what is beyond Chebyshev's dropped": (ranges_hold, ("sizes[len(rows) :]", "0 * sizes[len(rows) :]")),
    "the oscillations dropped": (ranges_hold, ("found.sizes()[1:]", "0 * found.sizes()[1:]")),
    "the other's radii dropped": (difference_and_sums_hold, ("rad[:k] += other.rad", "rad[:k] += 0")),
    "the rounding of a sum dropped": (difference_and_sums_hold, ("c * np.abs(b).sum", "0 * np.abs(b).sum")),
}  # fmt: skip


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_doubles_hold(check):
    with ctx.workprec(300):
        assert check(double_balls)


@pytest.mark.parametrize("name", WRONG)
def test_a_slip_is_caught(name):
    check, *replaced = WRONG[name]
    with ctx.workprec(300):
        assert not check(mutant("double_balls", *replaced))


def test_what_is_beyond_the_doubles_is_not_finite():
    found = double_balls.coefficients_in_doubles([arb_mat([[arb(2) ** 1100]])])
    assert not np.isfinite(double_balls.convolved(found, np.ones((1, 1, 1))).sizes()).all()
