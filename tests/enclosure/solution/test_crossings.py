"""Crossing a kink or a jump of f: solutions in closed form lie in their enclosures, and wrong windows exclude them."""

from __future__ import annotations

import math
from fractions import Fraction
from random import Random

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

from driftproof import certify
from driftproof.enclosure import branches, crossings
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.models import TaylorModel
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.solution.crossings import crossed, first_change
from driftproof.enclosure.solution.solutions import enclose_solution
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.symbolic.algebra.certified import enclose
from tests.enclosure.integrals import widest
from tests.enclosure.mutants import mutant
from tests.looping import exactly

BITS = 192


def cosh(x):
    return (x.exp() + (-x).exp()) / 2


def fallen(t, speed):
    """Height and speed after a throw upwards against the drag v|v|/10, with g = 10: its terminal speed is 10."""
    rise = (arb(speed) / 10).atan()
    top = 5 * (1 + (arb(speed) / 10) ** 2).log()
    return top - 10 * cosh(t - rise).log(), -10 * (1 - cosh(t - rise) ** -2).sqrt()


def swung(t):
    """q'' = -sign q from 1: parabolas from zero to zero, each in the time 2 sqrt 2."""
    half, root = int((float(t) - 2**0.5) // 8**0.5), arb(2).sqrt()
    r, side = t - root - 2 * root * half, (-1) ** (half + 1)
    return side * r * (root - r / 2), side * (root - r)


def rectified(t):
    """y' = max(sin t, 0): (1 - cos t), then 2, then on from 2 pi."""
    return 4 if t > 3 * arb.pi() else 2 + 1 - arb(t).cos()


DOUBLE_PI = arb(math.pi)
drag = lambda t, y: [y[1], -10 - y[1] * abs(y[1]) / 10]
CROSSING = {
    "a jump at a double": (lambda t, y: [1.0 if y[0] < 0.5 else 2.0], [0], 1, lambda t: [arb(1.5)]),
    "a jump by 1000": (lambda t, y: [1.0 if y[0] < 0.5 else 1000.0], [0], 1, lambda t: [arb(500.5)]),
    "the modulus": (lambda t, y: [abs(y[0]) + 1], [-1], 2, lambda t: [t.exp() / 2 - 1]),
    "the maximum": (lambda t, y: [np.maximum(y[0], 0) + 1], [-1], 2, lambda t: [(t - 1).exp() - 1]),
    "arrays": (lambda t, y: np.where(y > 0, y + 1, 1.0), [-1], 2, lambda t: [(t - 1).exp() - 1]),
    "drag from rest": (drag, [0, 0], 4, lambda t: fallen(t, 0)),
    "from rest beside what is large": (
        lambda t, y: [y[1], 1 + 4 * y[0] ** 2 - y[1] ** 3 * abs(y[1]), 0 * y[2]], [0, 0, 10**4], 1,
        lambda t: [t * t / 2, t, arb(10**4)],
    ),
    "a relay, seven times": (lambda t, y: [y[1], -np.sign(y[0])], [1, 0], 20, swung),
    "a rectifier": (lambda t, y: [np.maximum(np.sin(t), 0)], [0], 8, lambda t: [rectified(t)]),
    "what moves the same way": (
        lambda t, y: [1.0, 0.5, 1.0 if y[0] > y[1] else 0.0], [0, 1, 0], 4, lambda t: [arb(4), arb(3), arb(2)],
    ),
    "the time itself": (lambda t, y: [0.5, 1.0 if y[0] > t else 0.0], [1, 0], 4, lambda t: [arb(3), arb(2)]),
    "opposite comparisons": (lambda t, y: [(y[0] < 1) * 1.0 + (y[0] >= 1) * 0.25], [0], 3, lambda t: [arb(1.5)]),
    "a table": (lambda t, y: [[1.0, 2.0, 4.0][int(y[0])]], [0.5], 1, lambda t: [arb(2)]),
    "a floor": (lambda t, y: [1.0 + np.floor(y[0]), 1.0], [0.5, 0], 1, lambda t: [arb(2), arb(1)]),
    "a falling floor": (lambda t, y: [-1.0 - math.floor(y[0])], [2.5], 0.5, lambda t: [arb(4) / 3]),
    "a wrapped angle": (
        lambda t, y: [1.0, y[0] % (2 * np.pi)], [0, 0], 8,
        lambda t: [t, 2 * DOUBLE_PI**2 + (t - 2 * DOUBLE_PI) ** 2 / 2],
    ),
    "the nearest image": (lambda t, y: [1.0, y[0] - 2 * np.round(y[0] / 2)], [0, 0], 2, lambda t: [t, arb(0)]),
    "an irrational period": (
        field_function(field_of_text("heaviside(1/2 - mod(t, sqrt(2)))")), [0], 1.75,
        lambda t: [arb(2.25) - arb(2).sqrt()],
    ),
    "a jump at a known time at once": (
        lambda t, y: [-1.0 if t < 1 else 1.0, abs(y[0])], [1, 0], 2, lambda t: [arb(1), arb(1)],
    ),
    "from rest on a kink": (
        lambda t, y: [y[1], 1 - 2 * max(0, y[0])], [0, 0], 2,
        lambda t: [(1 - (arb(2).sqrt() * t).cos()) / 2, (arb(2).sqrt() * t).sin() / arb(2).sqrt()],
    ),
    "two at once": (
        lambda t, y: [1.0 if y[0] < 1 else 2.0, 1.0 if y[1] < 1 else 3.0], [0, 0], 2, lambda t: [arb(3), arb(4)],
    ),
}  # fmt: skip
# Steps grow from, and shrink to, a window by 5/4 each.
ROOTS = {
    "a root behind an if": (
        lambda t, y: [1.0, math.sqrt(2 * y[0] - 1) if y[0] > 0.5 else 0.0], [0, 0], 1, lambda t: [t, arb(1) / 3],
    ),
    "a root as text": (
        field_function(field_of_text("1; max(0, y0 - 1/2)^1.5 * 10")), [0, 0], 1.5, lambda t: [t, arb(4)],
    ),
    "roots from the border on": (
        lambda t, y: [1.0, 1 + np.sqrt(max(y[0], 0))], [0, 0], 1, lambda t: [t, t + 2 * t.sqrt() ** 3 / 3],
    ),
    "a root that becomes real": (
        lambda t, y: [1.0, np.sqrt(max(y[0], 0))], [-1, 0], 2, lambda t: [arb(1), arb(2) / 3],
    ),
    "a root that becomes zero": (
        lambda t, y: [-1.0, max(0, y[0]) ** 1.5], [1, 0], 2, lambda t: [arb(-1), arb(2) / 5],
    ),
}  # fmt: skip


@pytest.mark.slow(keep=5)
@pytest.mark.parametrize("name", CROSSING)
def test_solution_that_crosses_is_enclosed(name):
    holds_its_solution(*CROSSING[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", ROOTS)
def test_solution_whose_root_becomes_zero_is_enclosed(name):
    holds_its_solution(*ROOTS[name])


def holds_its_solution(f, start, end, exact):
    found = enclose_solution(f, [Fraction(x) for x in start], [Fraction(0), Fraction(end)], BITS)
    with ctx.workprec(2 * BITS):
        for ball, true in exactly(len(start), zip(found.states[-1], exact(arb(end)), strict=True)):
            assert ball.contains(true.mid() if true.rad() < ball.rad() / 100 else true)
            assert ball.rad() < 1e-30


def slivers(t, y):
    """1e40 nearer to y1 = 1 than 1e-32, so that y0 has grown by some 2e8 behind it."""
    try:
        root = math.sqrt((y[1] - 1) ** 2 - 1e-64)
    except ValueError:
        root = 1e40
    return [root + (1 if y[1] > 1 else 0), 1.0]


def by_truth(t, y):
    root = np.sqrt((y[1] - 1) ** 2 - 1e-64)
    return [1e40 if np.isnan(root) else root + (1 if y[1] > 1 else 0), 1.0]


@pytest.mark.parametrize("f", [slivers, by_truth])
def test_root_that_has_no_value_in_a_window_is_refused(f):
    with pytest.raises(Refused, match=r"touch or follow|isnan of a number that may have no value"):
        enclose_solution(f, [Fraction(0)] * 2, [Fraction(0), Fraction(2)])


@pytest.mark.parametrize("above", [True, False])
def test_what_is_said_of_a_number_is_known_of_what_it_makes_with_constants(above):
    side = crossings._SomeSides([above])
    y = Enclosed(side, TaylorModel([arb(1), arb(0, 1)], 4))
    asked = (y > 1, y - 1 > 0, 1 - y < 0, 2 * y > 2, -y / 2 < -0.5, 3 - 2 * (y + 1) < -1)
    assert [bool(each) for each in asked] == [above] * 6
    assert len(side.known) == 1
    assert bool(y * y > 1)
    assert bool(y + y > 2)
    assert len(side.known) == 3, "what is not linear in it is asked anew"


def test_numbers_of_a_run_are_told_apart_also_where_another_takes_the_place_of_one_that_is_gone():
    side = crossings._SomeSides([])
    for k in range(50):
        assert side.undecided(arb(k, 1), arb(k), at_zero=False)
    assert len(side.known) == 50


@pytest.mark.parametrize(
    ("f", "start", "times"),
    [
        (lambda t, y: [1.0 if t < 1 else 2.0, -1.0 if y[0] > 2 else 1.0], [0, 0], [1, 1.5]),
        (lambda t, y: [y[1], abs(y[1]) + 1], [0, 0], []),
        (lambda t, y: [-100000 * (y[0] - (t % 0.5)), 0], [0, 0], [0.5, 1, 1.5]),
    ],
    ids=["known and crossed", "at the start only", "stiff"],
)
def test_times_where_f_changes_are_told(f, start, times):
    found = enclose_solution(f, [Fraction(x) for x in start], [Fraction(0), Fraction(2)])
    assert [round(float(t), 12) for t in found.changes] == times


def drawn(random):
    """y' = a + b y with other a > 0 and b in each of up to four ranges of y, from -3: f, the end, and y there."""
    limits = sorted(random.sample(range(-30, 31), random.randint(1, 3)))
    lines = [(random.randint(8, 40) / 8, random.randint(-8, 8) / 16) for _ in range(len(limits) + 1)]
    end, y = random.randint(4, 40) / 8, mpmath.mpf(-3)

    def f(t, y):
        a, b = lines[sum(y[0] >= x / 16 for x in limits)]
        return [a + b * y[0]]

    left = mpmath.mpf(end)
    for (a, b), limit in zip(lines, [*limits, None], strict=True):
        b, rate = mpmath.mpf(b), a + b * y
        gain = None if limit is None else mpmath.mpf(limit) / 16 - y
        if rate < 0.1 or (gain and rate + b * gain < 0.1):
            return drawn(random)  # which would end before the next limit
        reached = left if gain is None else mpmath.log1p(b * gain / rate) / b if b else gain / rate
        y += rate * (mpmath.expm1(b * min(reached, left)) / b if b else min(reached, left))
        left -= reached
        if left <= 0:
            break
    return f, Fraction(end), y


@pytest.mark.parametrize(
    ("first", "count"),
    [(0, 4), pytest.param(4, 8, marks=pytest.mark.slow), pytest.param(12, 500, marks=pytest.mark.long)],
)
def test_random_solutions_that_cross_are_enclosed(first, count):
    random = Random(first)
    with mpmath.workdps(60):
        for f, end, true in exactly(count, (drawn(random) for _ in range(count))):
            found = enclose_solution(f, [Fraction(-3)], [Fraction(0), end])
            with ctx.workprec(200):
                assert abs(found.states[-1][0] - arb(mpmath.nstr(true, 55))).contains(0)
                assert widest(found) < 1e-28


def test_time_of_a_crossing_that_is_asked_for_is_in_its_window():
    """The top of a throw is at t = 1 exactly, and 1 is asked for."""
    found = enclose_solution(
        lambda t, y: [y[1], -4.0 if y[1] > 0 else -2.0],
        [Fraction(0), Fraction(4)],
        [Fraction(x) for x in (0, 1, 2)],
        BITS,
    )
    with ctx.workprec(2 * BITS):
        for state, true in exactly(2, zip(found.states[1:], ([2, 0], [1, -2]), strict=True)):
            assert all(abs(x - y) < 1e-45 for x, y in exactly(2, zip(state, true, strict=True)))


WRONG = {
    "one side only": ("[x.union(y) for x, y in pairs]", "[x for x, y in pairs]"),
    "no time of the window": ("return Window(t, end - t,", "return Window(t, (end - t) / 2,"),
    "the box of the beginning": ("[x + end * length for x, end in", "[x + 0 * end for x, end in"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_window_excludes_the_solution(name, monkeypatch):
    monkeypatch.setattr("driftproof.enclosure.solution.crossings.crossed", mutant("crossings", WRONG[name]).crossed)
    monkeypatch.setattr("driftproof.enclosure.solution.solutions.MOST_STEPS", 60)
    for f, start, end, exact in (CROSSING["a jump at a double"], CROSSING["a jump by 1000"]):
        try:
            found = enclose_solution(f, [Fraction(x) for x in start], [Fraction(0), Fraction(end)], BITS)
        except Refused:
            continue
        with ctx.workprec(2 * BITS):
            assert not found.states[-1][0].contains(exact(arb(end))[0])


def test_box_that_solutions_leave_is_no_window():
    """y' = y² from 1 has its pole at 1; windows of half that length hold, and a box that is not checked is none."""
    with ctx.workprec(BITS):
        grows, box = (lambda t, y: [y[0] ** 2]), [arb(1)]
        assert crossed(grows, Fraction(0), Fraction(1), box) is None
        held = crossed(grows, Fraction(0), Fraction(1, 16), box)
        assert held.after[0].contains(1 / (1 - enclose(held.h)))
        assert held.state_at(Fraction(1, 32))[0].contains(1 / (1 - enclose(Fraction(1, 32))))
        unchecked = mutant(
            "crossings", ("if all(big.contains_interior(rate)", "if any([True]) or all(big.contains(rate)")
        )
        assert unchecked.crossed(grows, Fraction(0), Fraction(1), box) is not None


def test_window_ends_where_f_is_certain_on_a_wider_set():
    jump = lambda t, y: [1.0 if y[0] < 0 else 2.0]
    with ctx.workprec(BITS):
        found = crossed(jump, Fraction(0), Fraction(1), [arb(-0.5)])
        (after,) = found.after
        assert after.contains(2 * (enclose(found.h) - 0.5))
        assert after.lower() > (crossings.CERTAIN - 2) * after.rad()
        assert crossed(lambda t, y: [-np.sign(y[0])], Fraction(0), Fraction(1), [arb(0.5)]) is None


@pytest.mark.parametrize(
    ("rows", "said"),
    [([[0, 1]], Fraction(1, 4)), ([[1, -4, 4]], None), ([[1, 0]], None), ([[0, 0, 1]], Fraction(1, 2))],
    ids=["rises", "touches from above", "stays", "bends"],
)
def test_first_change_is_found_along_the_polynomials(rows, said):
    above = lambda t, y: [1.0 if y[0] > 0.25 else 0.0]
    with ctx.workprec(BITS):
        decided = [rows[0][0] > 0.25]
        found = first_change(above, Fraction(0), [[arb(c) for c in row] for row in rows], decided, Fraction(1))
    if said is None:
        assert found is None or rows[0][2:]  # what dips below 1/4 around 1/2 changes there
    else:
        assert 0 <= found - said < Fraction(1, 2**100)


@pytest.mark.parametrize(
    ("f", "decided", "square"),
    [
        (lambda t, y: [1.0 if y[0] > 0.25 else 0.0], [False], 0.25), (lambda t, y: [y[0] // 0.25], [0], 0.25),
        (lambda t, y: [-y[0] // 0.25], [-1], 0.25),
        (lambda t, y: [y[0] // 0.3 if y[0] < 0.5 else 0], [True, 0], 0.3),
        (lambda t, y: [1.0 if (y[0] - 0.25) ** 9 > 0 else 0.0], [False], 0.25),
    ],
    ids=["a sign", "a floor", "a falling floor", "the first of two", "a root of order nine"],
)  # fmt: skip
def test_a_change_is_found_to_the_last_bits_in_fewer_runs_than_halves_take(f, decided, square):
    asked = list[object]()
    counted = lambda t, y: asked.append(t) or f(t, y)
    with ctx.workprec(BITS):
        found = first_change(counted, Fraction(0), [[arb(0), arb(0), arb(1)]], decided, Fraction(1))
        assert abs(enclose(found) - arb(square).sqrt()) < arb(2) ** -180
    assert len(asked) < BITS / 3


@pytest.mark.slow
def test_elastic_contact_keeps_its_energy():
    """Hertz's law, v' = -9.81 + 1000 d^(3/2) at the depth d, over two impacts: v²/2 + 9.81 x + 400 d^(5/2) is kept."""
    contact = lambda t, y: [y[1], 1000 * max(0, -y[0]) ** 1.5 - 9.81]
    found = enclose_solution(contact, [Fraction(1, 10), Fraction(0)], [Fraction(0), Fraction(1, 4), Fraction(1, 2)])
    assert widest(found) < 1e-25
    with ctx.workprec(BITS):
        for (x, v), below in exactly(2, zip(found.states[1:], (True, False), strict=True)):
            energy = v**2 / 2 + arb(9.81) * x + (400 * (-x).sqrt() ** 5 if below else 0)
            assert abs(energy - arb(9.81) / 10) < 1e-24


@pytest.mark.parametrize(
    ("f", "start", "near"),
    [
        (lambda t, y: [-np.sign(y[0])], 1, r"1;"),
        (lambda t, y: [2 * (t - 1) + (0.0 if y[0] > 0 else 5.0)], 1, r"1;|1\.0|0\.99"),
        (lambda t, y: [abs(y[0])], 0, r"0;"),
        (lambda t, y: [y[1], -max(0, y[0])], (0, 0), r"0;"),
        (lambda t, y: [y[1], 1.0 if y[0] >= 0 else -1.0], (0, 0), r"0;.* as it starts there, write f as it is"),
    ],
    ids=["slides", "touches", "stays", "rests", "may leave to either side"],
)
def test_solution_that_does_not_cross_is_refused(f, start, near):
    with pytest.raises(Refused, match=rf"compares numbers that are equal near t = (?=.*touch or follow)({near})"):
        enclose_solution(f, [Fraction(int(x)) for x in np.ravel(start)], [Fraction(0), Fraction(2)])


@pytest.mark.parametrize("mean", [False, True])
def test_wrong_mean_of_the_rates_excludes_the_solution(mean, monkeypatch):
    """x'' = 1 from rest, where x is not t² but t²/2."""
    f = CROSSING["from rest on a kink"][0]
    if mean:
        monkeypatch.setattr(TaylorModel, "mean", lambda self: sum((self.coefficient(k) for k in range(4)), arb(0)))
    with ctx.workprec(BITS):
        found = crossed(f, Fraction(0), Fraction(1, 2**70), [arb(0), arb(0)], arb(2) ** -BITS)
        t = arb(2).sqrt() * enclose(found.h)
        assert found.after[0].contains((1 - t.cos()) / 2) is not mean
        assert found.after[1].contains(t.sin() / arb(2).sqrt())


def test_pole_behind_a_comparison_is_told_as_a_pole():
    """y' = y² from 1, which is 2 at 1/2 and has its pole at 1."""
    with pytest.raises(Refused, match=r"has a pole, or f is not smooth, near t = (1|0\.99)"):
        enclose_solution(
            lambda t, y: [y[0] ** 2 * (1.0 if y[0] >= 2 else 1)], [Fraction(1)], [Fraction(0), Fraction(2)]
        )


def test_many_relays_at_once_are_refused(monkeypatch):
    monkeypatch.setattr(branches, "MOST_OUTCOMES", 3)
    f, start, end, _ = CROSSING["two at once"]
    with pytest.raises(Refused, match="touch or follow"):
        enclose_solution(f, [Fraction(x) for x in start], [Fraction(0), Fraction(end)])


def test_float_run_over_a_crossing_is_certified():
    """Steps of 1/4 by forward Euler, exact but for that from 1/2, where the jump has not come yet."""
    speeds = lambda t, y: np.array([1.0 if y[0] <= 0.5 else 2.0])
    t, y = [k / 4 for k in range(5)], [0.0, 0.25, 0.5, 0.75, 1.25]
    found = certify(speeds, t, [[x] for x in y], method="forward_euler")
    true = [0.0, 0.25, 0.5, 1.0, 1.5]
    for (error,), (of_method,), x, exact in zip(found.errors, found.split.truncation, y, true, strict=True):
        assert abs(error - (x - exact)) < 1e-30
        assert abs(of_method - (x - exact)) < 1e-30
