"""Comparison systems bound the solutions of what they stand for, and a wrong sign in them is caught."""

from __future__ import annotations

from itertools import product

import pytest
from flint import arb, arb_mat

from driftproof.enclosure.solution import comparison
from tests.enclosure.mutants import mutant

# e' = Ae + d with |d| <= δ: what turns, what is fast, and what grows.
SYSTEMS = {
    "turning": ([[-1, -3], [2, -1]], [0.5, 0.25]), "stiff": ([[-0.5, -1], [-40, -1000]], [0.01, 2]),
    "pushed": ([[-1, 0], [0, -2]], [1, 1]), "growing": ([[0.5, -1], [1, 0.25]], [0, 0]),
}  # fmt: skip
START = (0.5, 0.125)


def largest(A, d, s):
    """Sizes of e(s), each the largest of all starts at the corners and all constant d at theirs."""
    found = [arb(0)] * 2
    for signs in product((-1, 1), repeat=4):
        e, push = ([[x * sign] for x, sign in zip(m, s, strict=True)] for m, s in ((START, signs[:2]), (d, signs[2:])))
        rows = [[*row, p[0], 0] for row, p in zip(A, push, strict=True)] + [[0] * 4] * 2
        end = ((arb_mat(rows) * s).exp() * arb_mat([*e, [1], [0]])).entries()
        found = [x.max(abs(y)) for x, y in zip(found, end[:2], strict=True)]
    return found


def is_bounded(module, name):
    """By the bound at the end, and on the way by that of the whole step."""
    A, d = SYSTEMS[name]
    M, start, source, step = (
        module.quasi_monotone(arb_mat(A)), arb_mat([[x] for x in START]), arb_mat([[x] for x in d]), arb(1),
    )  # fmt: skip
    grown, added = module.at_the_end(M, source, step)
    at_end = (grown * start + added).entries()
    on_the_way = module.along_the_step(M, start, source, step).entries()
    # The balls of the exponentials are about 2^-45 wide.
    ends = all(x <= y + arb(2) ** -40 for x, y in zip(largest(A, d, arb(1)), at_end, strict=True))
    ways = [largest(A, d, arb(k) / 8) for k in range(9)]
    return ends and all(x <= y + arb(2) ** -40 for way in ways for x, y in zip(way, on_the_way, strict=True))


@pytest.mark.parametrize("name", SYSTEMS)
def test_comparison_system_bounds_the_errors(name):
    assert is_bounded(comparison, name)


WRONG = {
    "signs kept off the diagonal": ("turning", "x.upper() if i == j else x.abs_upper()", "x.upper()"),
    "couplings dropped": ("stiff", "x.upper() if i == j else x.abs_upper()", "x.upper() if i == j else 0"),
    "a diagonal that decays too fast": ("growing", "x.upper() if i == j else", "-abs(x) if i == j else"),
    "what is added dropped": ("pushed", "[row[n:] for row in found]", "[[0] * k for row in found]"),
    "growth on the way dropped": ("growing", "bound * arb(rate).exp()", "bound"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_comparison_is_caught(name):
    system, *replaced = WRONG[name]
    assert not is_bounded(mutant("comparison", tuple(replaced)), system)


def test_bound_on_the_way_that_is_none_is_refused():
    """Growth by e^100 is beyond the rates that are tried."""
    assert comparison.along_the_step(arb_mat([[100]]), arb_mat([[1]]), arb_mat([[0]]), arb(1)) is None
    assert comparison.along_the_step(arb_mat([[arb("nan")]]), arb_mat([[1]]), arb_mat([[0]]), arb(1)) is None


def test_fast_decay_costs_no_digits_and_no_time():
    M = comparison.quasi_monotone(arb_mat([[arb(-1e14), arb(0.5)], [arb(0.25, 0.01), arb(-1)]]))
    grown, added = comparison.at_the_end(M, arb_mat([[1], [1]]), arb(1))
    assert grown[0, 0] < 1e-10
    assert abs(grown[1, 1] - arb(-1).exp()) < 1e-9
    assert abs(added[1, 0] + arb(-1).expm1()) < 1e-9
