"""Stages of implicit methods, proved: both ends of a ball, and no stages at all."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

from driftproof import METHODS, Refused, certify
from driftproof.enclosure.runs import implicit_runs
from driftproof.enclosure.runs.implicit_runs import coefficient_balls
from tests.enclosure.mutants import mutant
from tests.enclosure.right_hand_sides import kepler
from tests.looping import exactly


def test_table_of_a_collocation_method_is_that_of_its_formula():
    with ctx.workprec(128):
        a, b, c = coefficient_balls(METHODS["gauss4"])
        assert (sum(b) - 1).contains(0)
        for row, node in exactly(4, zip(a, c, strict=True)):
            assert (sum(row) - node).contains(0)
            assert (sum(x * d**3 for x, d in zip(row, c, strict=True)) - node**4 / 4).contains(0)


def midpoint(f, y, h, steps, tolerance):
    """Rows of the implicit midpoint rule in floats, its stage found by plain iteration."""
    rows = [np.array(y)]
    for i in range(steps):
        y, k = rows[-1], f(i * h, rows[-1])
        while True:
            before, k = k, f((i + 0.5) * h, y + h / 2 * k)
            if np.max(abs(k - before)) <= tolerance:
                break
        rows.append(y + h * k)
    return h * np.arange(steps + 1), rows


def test_run_of_the_midpoint_rule_is_split_and_keeps_quadratic_integrals():
    run = midpoint(kepler, [1.0, 0.0, 0.0, 1.0625], 1 / 16, 4, 1e-15)
    found = certify(kepler, *run, method="implicit_midpoint", invariants=["kepler_energy", "angular_momentum"])
    energy, momentum = found.drifts["kepler_energy"], found.drifts["angular_momentum"]
    assert all(x.contains(0) and x.rad() < 1e-60 for x in momentum.truncation)
    assert any(abs(x) > 1e-9 for x in energy.truncation)
    # What the iteration left open counts as rounding: 1e-15 h a step, and roundings of u.
    assert max(abs(x) for row in found.split.rounding for x in row) < 1e-14
    assert 1e-6 < max(abs(x) for row in found.split.truncation for x in row) < 1e-3


def test_stages_that_are_hardly_solved_are_noticed():
    run = midpoint(kepler, [1.0, 0.0, 0.0, 1.0625], 1 / 16, 4, 1e-3)
    with pytest.raises(Refused, match="is not one step of implicit_midpoint"):
        certify(kepler, *run, method="implicit_midpoint")


def backward_euler(module, y, h):
    """y' = y²: the stage solves K = (y + hK)², which has no real solution where 1 - 4hy < 0."""
    with ctx.workprec(128):
        return module.implicit_step(METHODS["backward_euler"], lambda t, y: [y[0] ** 2], 1)((y,), Fraction(0), h)[0]


def holds_both_ends(module):
    """From a ball, the formula's value at both ends and between, and no more than twice as wide."""
    h, radius = Fraction(1, 8), arb(2) ** -20
    found = backward_euler(module, arb(1, radius), h)
    with ctx.workprec(128):
        formula = lambda y: (1 - (1 - 4 * arb(0.125) * y).sqrt()) / arb(0.25)
        ends = [formula(1 + side * radius) for side in (-1, 0, 1)]
        return all(found.overlaps(x) for x in ends) and found.rad() < 2 * abs(ends[2] - ends[0])


def refuses_where_there_are_none(module):
    for y in exactly(3, (arb(3), arb(1.875, 0.25), arb(1.5, 0.5))):
        try:
            backward_euler(module, y, Fraction(1, 8))
        except Refused:
            continue
        return False
    return True


WRONG = {
    "the ball's middle only": (
        holds_both_ends,
        ("(y[k] - middle[k])", "(middle[k] - middle[k])"),
    ),
    "the box not checked": (refuses_where_there_are_none, ("r.contains_interior(x)", "r is not x")),
}  # fmt: skip


@pytest.mark.parametrize("check", [holds_both_ends, refuses_where_there_are_none])
def test_stages_are_proved(check):
    assert check(implicit_runs)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_proof_is_caught(name):
    check, *replaced = WRONG[name]
    assert not check(mutant("implicit_runs", *replaced))


def robertson(t, y):
    _, b, c = y
    made, spent = y[0] / 25 - 10**4 * b * c, 3 * 10**7 * b * b
    return [-made, made - spent, spent]


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("key", ["radau_iia2", "backward_euler", "tr_bdf2", "sdirk4"])
def test_of_two_solutions_stiff_stages_have_that_of_float_runs_and_balls_contract(key):
    """Newton's method from the slopes f(t, y) comes to negative concentrations, in balls 8 times as wide a step."""
    with ctx.workprec(128):
        step, y = implicit_runs.implicit_step(METHODS[key], robertson, 3), [arb(1), arb(0), arb(0)]
        for n in range(40):
            y = step(y, Fraction(n, 10), Fraction(1, 10))
        assert y[1] > 0
        assert abs(y[0] - 0.9055) < 0.002  # to three digits the solution at t = 4
        assert max(x.rad() for x in y) < 1e-30


def test_stages_beyond_whole_corrections_are_found_by_shorter_ones():
    """From slopes of 0 whole corrections of k = -500 atan(1 + k) run away."""
    with ctx.workprec(128):
        f = lambda t, y: [-y[0] / (1 + y[0] * y[0]).sqrt()]
        assert implicit_runs.implicit_step(METHODS["backward_euler"], f, 1)([arb(50)], Fraction(0), Fraction(100))
