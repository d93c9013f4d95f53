"""Enclosures hold the solutions that formulas give, from points and from balls, to any time asked for."""

from __future__ import annotations

from contextlib import nullcontext
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from flint import arb, ctx
from tqdm import tqdm

from driftproof.enclosure import solutions, steps
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.solution.solutions import enclose_solution
from tests.enclosure.integrals import widest
from tests.enclosure.mutants import mutant
from tests.witnesses.closed_solutions import FAMILIES, drawn


def violations(problem, random, bits=64):
    """How many components of the enclosure, at three random times and the end, do not hold the formula's value."""
    inner = sorted(random.uniform(problem.t0, problem.end) for _ in range(3))
    times = [Fraction(t) for t in (problem.t0, *inner, problem.end)]
    found = enclose_solution(problem.f, [Fraction(x) for x in problem.start], times, bits)
    assert widest(found) < 1e-9
    with ctx.workprec(256):
        wanted = [problem.solution(arb(float(t))) for t in times]
        rows = zip(found.states, wanted, strict=True)
        return sum(not x.overlaps(y) for row, true in rows for x, y in zip(row, true, strict=True))


@pytest.mark.slow
def test_three_hundred_random_problems_lie_within():
    random, seen = Random(20), set()
    for _ in range(300):
        name, problem = drawn(random)
        seen.add(name)
        assert violations(problem, random) == 0, problem
    assert len(seen) == len(FAMILIES)


@pytest.mark.long
def test_ten_thousand_random_problems_lie_within():
    random = Random(21)
    found = [violations(drawn(random)[1], random, random.choice((64, 128, 192))) for _ in tqdm(range(10_000))]
    assert found == [0] * 10_000


def test_tangent_near_its_pole():
    t = Fraction(157, 100)
    found = enclose_solution(lambda t, y: 1 + y**2, [Fraction(0)], [Fraction(0), t])
    with ctx.workprec(256):
        assert found.states[-1][0].contains((arb(157) / 100).tan())
    assert widest(found) < 1e-24


def test_pole_is_refused_and_its_place_said():
    with pytest.raises(Refused, match=r"has a pole, .* near t = 1\.5707963"):
        enclose_solution(lambda t, y: 1 + y**2, [Fraction(0)], [Fraction(0), Fraction(2)])


def test_a_start_is_its_own_enclosure_even_where_no_step_begins():
    pole = lambda t, y: 1 / (t + 0 * y)
    assert enclose_solution(pole, [Fraction(3)], [Fraction(0)]).states == ((3,),)
    with pytest.raises(Refused):
        enclose_solution(pole, [Fraction(3)], [Fraction(0), Fraction(1)])


def test_branch_that_is_reached_and_not_crossed_is_refused():
    with pytest.raises(Refused, match=r"near t = 0\.693147"):
        enclose_solution(lambda t, y: 1 - y if y < 0 else 0 * y - 1, [Fraction(-1)], [Fraction(0), Fraction(2)], 64)


def test_root_of_what_comes_to_0_is_refused_and_its_place_said():
    with pytest.raises(Refused, match="has a pole, or f is not smooth, near t = 2; if f jumps there, certify the"):
        enclose_solution(lambda t, y: -np.sqrt(y), [Fraction(1)], [Fraction(0), Fraction(3)])


def test_stiff_problem_is_done_by_implicit_steps():
    """Prothero's and Robinson's: explicit steps would be nine millions; and one of a thousand."""
    times = [Fraction(0), Fraction(10)]
    found = enclose_solution(lambda t, y: -1e6 * (y - np.cos(t)) - np.sin(t), [Fraction(1)], times, 64)
    assert found.steps < 100
    assert abs(found.states[-1][0] - arb(10).cos()) < 1e-9
    assert found.doubles == ()
    linear = lambda t, y: [998 * y[0] + 1998 * y[1], -999 * y[0] - 1999 * y[1]]
    assert enclose_solution(linear, [Fraction(1), Fraction(0)], [Fraction(0), Fraction(2)]).steps < 50


@pytest.mark.parametrize("rate", [200, 10**6])
def test_stiff_problem_with_a_kink_of_the_solution_is_done_by_implicit_steps_on_both_sides(rate, monkeypatch):
    """From y = -1 with y' = 1 it comes to 0 at 1, and z lags by 1/rate; explicit steps would be a million or two."""
    monkeypatch.setattr(solutions, "MOST_STIFF_STEPS", 20)
    kinked = lambda t, y: [0 * t + 1, -rate * (y[1] - np.maximum(y[0], 0))]
    found = enclose_solution(kinked, [Fraction(-1), Fraction(0)], [Fraction(0), Fraction(5, 2)], 64)
    assert found.states[-1][1].overlaps(arb(1.5) - (1 - arb(-1.5 * rate).exp()) / rate)
    assert found.states[-1][1].rad() < 1e-12
    assert found.steps < 200


@pytest.mark.parametrize(("end", "looked_at"), [(20_000, 300), (10**300, 30)], ids=str)
def test_fast_oscillation_for_long_is_refused_and_for_far_too_long_at_once(end, looked_at, monkeypatch):
    monkeypatch.setattr(solutions, "MOST_STEPS", 6000)
    with pytest.raises(Refused, match=rf"too long: {looked_at} steps reach t = .*; at most 6000 are taken"):
        enclose_solution(lambda t, y: [y[1], -y[0]], [Fraction(1), Fraction(0)], [Fraction(0), Fraction(end)], 64)


@pytest.mark.parametrize(("f", "end"), [(lambda t, y: [y[1], -y[0]], 60), (lambda t, y: [-1000 * y[0], 0 * t], 30)])
def test_less_effort_is_refused_where_all_of_it_is_enough(f, end):
    times = [Fraction(0), Fraction(end)]
    with (
        steps.with_effort(1e-3),
        pytest.raises(Refused, match=r"too long: .* at most 20 |20 implicit steps|5 implicit"),
    ):
        enclose_solution(f, [Fraction(1), Fraction(0)], times)
    assert enclose_solution(f, [Fraction(1), Fraction(0)], times).steps > 20


def test_times_that_decrease_are_refused():
    with pytest.raises(Refused, match="times must not decrease"):
        enclose_solution(lambda t, y: y, [Fraction(1)], [Fraction(0), Fraction(1), Fraction(-1)], 64)


def test_sizes_beyond_doubles_are_refused():
    with pytest.raises(Refused, match="f or the solution is outside the range of doubles"):
        enclose_solution(
            lambda t, y: [10**200 * y[1] - 1000 * y[0], -(10**-200) * y[0] - 1000 * y[1]],
            [Fraction(1), Fraction(1, 10**200)],
            [Fraction(0), Fraction(100)],
        )


def test_start_of_more_bits_than_are_worked_with_is_enclosed():
    with ctx.workprec(400):
        start = [arb(1).exp()]
    found = enclose_solution(lambda t, y: -y, start, [Fraction(0), Fraction(1)], 64)
    with ctx.workprec(400):
        assert found.states[-1][0].contains(1)


def test_part_that_is_done_is_that_of_the_time(monkeypatch):
    said = []
    progress = type("Progress", (), {"part": property(None, lambda self, part: said.append(part))})()
    monkeypatch.setattr(solutions, "stage", lambda words: nullcontext(progress))
    for times in ((1, 2, 5), (1,)):
        enclose_solution(lambda t, y: -y, [Fraction(1)], [Fraction(t) for t in times], 64)
    assert said == [0, 0.25, 1, 0]


def test_rational_start_is_no_double():
    third = Fraction(1, 3)
    found = enclose_solution(lambda t, y: y, [third], [third, Fraction(4, 3)])
    with ctx.workprec(256):
        assert all(x[0].contains(y) for x, y in zip(found.states, [arb(1) / 3, arb(1).exp() / 3], strict=True))
    assert 0 < widest(found) < 1e-33


def holds_neighbours(module):
    """y' = y from [1 - r, 1 + r]: both ends' solutions lie within, and the radius is theirs up to 1 %."""
    r, times = arb(2) ** -40, [Fraction(k, 3) for k in range(15)]
    with ctx.workprec(128):
        found = module.enclose_solution(lambda t, y: y, [arb(1, r)], times)
        for t, (x,) in zip(times, found.states, strict=True):
            grown = (arb(t.numerator) / t.denominator).exp()
            held = all(abs((1 + side * r) * grown - x.mid()) <= x.rad() * (1 + r) for side in (-1, 1))
            if not held or x.rad() > 1.01 * r * grown:
                return False
    return found.steps > 2


def holds_growth(module):
    """y' = y from 1 in few coefficients, so that the steps' own errors show over the rounding."""
    module.BITS_PER_COEFFICIENT = 6
    with pytest.MonkeyPatch.context() as loose:
        loose.setattr(steps, "BITS_OF_A_STEP", Fraction(1, 3))
        # Just past the end of a step, so that what it carries is seen and not what it adds.
        found = module.enclose_solution(lambda t, y: y, [Fraction(1)], [Fraction(0), 8 + Fraction(1, 2**40)], 64)
    with ctx.workprec(256):
        return bool(found.states[-1][0].contains((8 + arb(2) ** -40).exp()))


STATE = "return self.step.state_at(t)"
HALVED = (STATE, "return tuple((x + x.mid()) / 2 for x in self.step.state_at(t))")
WRONG = {
    "a radius halved": (holds_neighbours, HALVED),
    "carried errors halved": (
        holds_neighbours,
        ("self.box = (inverse * image) * self.box", "self.box = inverse * image * self.box / 2"),
    ),
    "errors carried without the flow": (holds_neighbours, ("image = step.flow * self.basis", "image = self.basis")),
    "a step's own error dropped": (holds_growth, ("step.around(near)", "step.around(near * 0)")),
}  # fmt: skip


@pytest.mark.parametrize("check", [holds_neighbours, holds_growth])
def test_solution_holds(check):
    assert check(mutant("solutions"))


@pytest.mark.parametrize("name", WRONG)
def test_wrong_solution_is_caught(name):
    check, *replaced = WRONG[name]
    assert not check(mutant("solutions", *replaced))
