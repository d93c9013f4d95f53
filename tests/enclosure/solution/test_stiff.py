"""Stiff solutions lie within their enclosures, sharply enough that each wrong bound that is planted is caught."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest
from flint import arb, arb_mat, arb_poly, ctx
from mpmath import cos, exp, findroot, mpf, nstr, sin, workdps
from tqdm import tqdm

from driftproof import certify
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.solution import stiff
from tests.enclosure.mutants import mutant
from tests.looping import exactly
from tests.witnesses.closed_solutions import relaxed


def enclosed(f, start, times, bits, module=stiff):
    """States at the times, by implicit steps from the first."""
    with ctx.workprec(bits):
        path = module.StiffPath(enclosable(f), [arb(x) for x in start], times[0], times[-1])
        return [path.states_at(t) for t in times]


def violations(problem, random, bits):
    """How many components do not hold the formula's value, at four times after the start; half of the bits hold."""
    inner = sorted(random.uniform(problem.t0, problem.end) for _ in range(3))
    times = [Fraction(t) for t in (problem.t0, *inner, problem.end)]
    found = enclosed(problem.f, problem.start, times, bits)
    assert max(float(x.rad()) for row in found for x in row) < 2.0 ** (-0.45 * bits)
    with ctx.workprec(256):
        wanted = [problem.solution(arb(float(t))) for t in times]
        pairs = [(x, y) for row, true in zip(found, wanted, strict=True) for x, y in zip(row, true, strict=True)]
        return sum(not x.overlaps(y) for x, y in exactly(10, pairs))


@pytest.mark.slow
def test_random_stiff_problems_lie_within():
    random = Random(5)
    assert [violations(relaxed(random), random, 64) for _ in range(8)] == [0] * 8


@pytest.mark.long
def test_a_thousand_random_stiff_problems_lie_within():
    random = Random(6)
    found = [violations(relaxed(random), random, random.choice((64, 96, 128))) for _ in tqdm(range(1000))]
    assert found == [0] * 1000


def robertson(t, y):
    return [-0.04 * y[0] + 1e4 * y[1] * y[2], 0.04 * y[0] - 1e4 * y[1] * y[2] - 3e7 * y[1] ** 2, 3e7 * y[1] ** 2]


@pytest.mark.slow
def test_certificate_of_a_stiff_trajectory_from_anywhere():
    """Stored points: SciPy 1.17.1, Radau, rtol 1e-6, atol 1e-10; at 0.4 and 4 the digits in print are as good."""
    t = [0.0, 0.4, 4.0]
    y = [[1.0, 0.0, 0.0], [0.98517211, 3.3863954e-05, 0.014794022], [0.90551868, 2.2404757e-05, 0.094458917]]
    found = certify(robertson, t, y)
    assert 1e-9 < found.largest_error < 1e-7
    assert max(float(x.rad()) for row in found.errors for x in row) < 1e-20
    assert found.digits == 8


def holds_solution(module):
    """In few bits, so that the defect shows over rounding."""
    random = Random(1)
    for _ in range(3):
        problem = relaxed(random)
        times = [Fraction(0), Fraction(problem.end)]
        (*_, found) = enclosed(problem.f, problem.start, times, 64, module)
        with ctx.workprec(256):
            wanted = problem.solution(arb(problem.end))
            if not all(x.contains(y.mid()) for x, y in zip(found, wanted, strict=True)):
                return False
    return True


def holds_neighbours(module):
    """y0' = -y0 + y1²/10, y1' = -1000 y1 from (1 ± r, ± r): the ends' solutions lie within, by less than 1 %."""
    r, t, times = arb(2) ** -30, arb(2), [Fraction(0), Fraction(2)]
    start = [arb(1, r), arb(0, r)]
    (*_, (x, y)) = enclosed(lambda t, y: [-y[0] + y[1] ** 2 / 10, -1000 * y[1]], start, times, 96, module)
    with ctx.workprec(128):
        grown = r * (-t).exp()
        return abs(x.mid() - (-t).exp()) + grown <= x.rad() <= 1.01 * grown and abs(y) < 1e-20


def holds_what_decays(module):
    """y' = -1000 y from ± r: on the way, too, the ends' solutions lie within."""
    r, times = arb(2) ** -30, [Fraction(k, 2000) for k in range(8)]
    found = enclosed(lambda t, y: -1000 * y, [arb(0, r)], times, 96, module)
    return all(
        x.rad() >= r * (-1000 * arb(t.numerator) / t.denominator).exp() for t, (x,) in zip(times, found, strict=True)
    )


def holds_what_leaves(module):
    """y' = y + 200 y^41 from ± 1/4, which grows by more than e^t from 3/4 on: refused before, or within."""
    c, r, t, module.SHORTEST_STIFF_PART = 200, arb(2) ** -2, Fraction(5, 4), Fraction(1, 2**8)
    try:
        (_, (x,)) = enclosed(lambda t, y: y + c * y**41, [arb(0, r)], [Fraction(0), t], 64, module)
    except Refused:
        return True
    return x.rad() > (-((r**-40 + c) * arb(-50).exp() - c).log() / 40).exp()


def holds_what_bends(module):
    """y' = -y² from 1 ± r: both ends are off the linear flow to the same side, and a wide set stays about as wide."""
    for k, t, wider in ((12, Fraction(1), 1.01), (4, Fraction(1, 2), 1.6)):
        r, last = arb(2) ** -k, arb(float(t))
        (_, (x,)) = enclosed(lambda t, y: -(y**2), [arb(1, r)], [Fraction(0), t], 64, module)
        low, high = (1 / (last + 1 / (1 + side * r)) for side in (-1, 1))
        if not x.contains(low.mid()) or not x.contains(high.mid()) or x.rad() > wider * (high - low) / 2:
            return False
    return True


def jacobian_is_bounded(module):
    """y' = t^60 y on [0, 1]: M is no less than the Jacobian at 1, which the first twenty coefficients miss."""
    one = arb_mat([[1]])
    with ctx.workprec(64):
        path = module.StiffPath(lambda t, y: y * t**60, [arb(1)], Fraction(0), Fraction(1))
        M, _ = path._comparison(arb(1), [arb_poly([1])], (one, one), [one], arb_mat([[0]]))
        return M[0, 0] >= 1


CHECKS = (holds_solution, holds_neighbours, holds_what_decays, holds_what_leaves, holds_what_bends, jacobian_is_bounded)
DEFECT = "return bounds(self.method.chebyshev, [T * c for c in coefficients]) + sizes_of(T) * tails"
BOX = "if all(x < y for x, y in zip(needed.entries(), box.entries(), strict=True)):"
CARRIED, FAST = "sizes_of(back * image) * step.widths", "value_at(flow, arb(-1)))) * widths"
WRONG = {
    "the defect dropped": (holds_solution, DEFECT, "return arb_mat(self.n, 1)"),
    "a radius halved": (holds_neighbours, "arb(0, r.upper())", "arb(0, r.upper() / 2)"),
    "carried errors halved": (holds_neighbours, CARRIED, f"{CARRIED} / 2"),
    "a step's own errors dropped": (holds_solution, "last = own + old", "last = old"),
    "the fast part of the errors dropped": (holds_what_decays, FAST, f"{FAST} * 0"),
    "the box not checked": (holds_what_leaves, BOX, "if True:"),
    "the Jacobian on v alone": (holds_what_leaves, "arb(0, b.upper()) for p, b", "arb(0) for p, b"),
    "the Jacobian's tail omitted": (
        jacobian_is_bounded, "quasi_monotone(J + _around", "quasi_monotone(J + 0 * _around",
    ),
    "what follows the flow of v alone": (holds_what_bends, "return M, source +", "return M, 0 * source +"),
    "steps too long for a wide set": (holds_what_bends, "_relative(lost, allowed) > 1:", "False:"),
}  # fmt: skip


def test_first_guess_goes_on_along_the_step_before():
    """On y' = 2t, whose solution t² is a polynomial."""
    with ctx.workprec(64):
        path, h = stiff.StiffPath(lambda t, y: [2 * t], [arb(0)], Fraction(0), Fraction(8)), arb(0.125)
        path.advance()
        times = [float(path.t) + h * (1 + arb(s)) / 2 for s in (-1, *path.method.stages)]
        assert all(abs(x - t**2) < 1e-12 for (x,), t in zip(path._guess(h), times, strict=True))


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_stiff_solution_holds(check):
    assert check(mutant("stiff"))


@pytest.mark.parametrize("name", WRONG)
def test_wrong_stiff_solution_is_caught(name):
    check, *replaced = WRONG[name]
    assert not check(mutant("stiff", tuple(replaced)))


def test_start_is_as_it_was_given():
    (first, _) = enclosed(lambda t, y: -1000 * y, [0.1], [Fraction(0), Fraction(1)], 64)
    assert first == (arb(0.1),)


def test_a_branch_is_crossed_and_one_along_which_the_solution_slides_is_refused():
    """The solution above 0.6 is (10^6 cos t + 1000 sin t + e^(-1000t))/(10^6 + 1); below it decays as e^(-t)."""
    f, slides = (
        lambda t, y, below=below: [-1000 * (y[0] - np.cos(t)) if y[0] > 0.6 else below * y[0]] for below in (-1, 1)
    )
    (_, (y,)) = enclosed(f, [1.0], [Fraction(0), Fraction(2)], 64)
    with workdps(30):
        at = findroot(lambda t: (10**6 * cos(t) + 1000 * sin(t) + exp(-1000 * t)) / (10**6 + 1) - mpf(0.6), 0.93)
        assert y.overlaps(arb(nstr(0.6 * exp(at - 2), 30)))
    assert y.rad() < 1e-11
    with pytest.raises(Refused, match=r"near t = 0\.92|no implicit step from t = 0\.92"):
        enclosed(slides, [1.0], [Fraction(0), Fraction(2)], 64)


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        ("MOST_STEPS", "3 implicit steps, the limit, reach only t = "),
        ("MOST_TRIES", "no implicit step from t = .* could be proved"),
    ],
)
def test_too_many_steps_or_tries_are_refused(monkeypatch, limit, said):
    monkeypatch.setattr(stiff, limit, 3)
    with pytest.raises(Refused, match=said):
        enclosed(lambda t, y: -1000 * (y - np.cos(t)), [1.0], [Fraction(0), Fraction(2000)], 64)


NOT_FINITE = arb_mat([[arb("nan")]])
REASONS = {
    "no tube around the step could be proved to hold the solution": ("TUBES", ()),
    "Newton's iteration does not converge": ("solved_stages", lambda *_: None),
    "the bounds of f around the step do not bound the errors": ("along_the_step", lambda *_: None),
    "the error bound is not finite": ("at_the_end", lambda *_: (NOT_FINITE, arb_mat([[1, arb("nan")]]))),
}


@pytest.mark.parametrize("said", REASONS)
def test_step_that_is_not_found_is_refused_with_the_last_reason(said, monkeypatch):
    monkeypatch.setattr(stiff, *REASONS[said])
    with pytest.raises(Refused, match=f"no implicit step from t = 0 could be proved: {said}"):
        enclosed(lambda t, y: -1000 * (y - np.cos(t)), [1.0], [Fraction(0), Fraction(1)], 64)


def test_stiff_pole_is_refused(monkeypatch):
    monkeypatch.setattr(stiff, "SHORTEST_STIFF_PART", Fraction(1, 2**8))
    with pytest.raises(Refused, match=r"has a pole, .* near t = -1\.0"):
        enclosed(lambda t, y: [-1000 * y[0], y[1] ** 2], [1.0, 1.0], [Fraction(-2), Fraction(1)], 64)
