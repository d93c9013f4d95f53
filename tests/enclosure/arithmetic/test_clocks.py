"""Jumps and kinks at known times: steps end there, and what lies between is as exact as without them."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

from driftproof import certify
from driftproof.enclosure import solutions, stiff
from driftproof.enclosure.arithmetic.clocks import Clock, TimeCut, exact_time
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.solution.solutions import enclose_solution
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.symbolic.algebra.certified import enclose
from tests.enclosure.integrals import END, integral, off, widest
from tests.enclosure.mutants import mutant
from tests.enclosure.right_hand_sides import rk4

# y' = f(t); the times where f or a derivative jumps; f(t) between two of them, in Fractions.
JUMPS = {
    "if": (lambda t: 1.0 if t < 2 else 3.0, [2], lambda t: 1 if t < 2 else 3),
    "reversed": (lambda t: 1.0 if 2.5 >= t else t, [Fraction(5, 2)], lambda t: 1 if t < 2.5 else t),
    "scaled": (lambda t: 1.0 if 3 * t - 1 > 2 + t / 2 else 0.0, [Fraction(6, 5)], lambda t: int(5 * t > 6)),
    "falling": (lambda t: -t if -t > -2.0 else t, [2], lambda t: -t if t < 2 else t),
    "dose": (lambda t: 5.0 if 1 <= t < 1.25 else 0.0, [1, Fraction(5, 4)], lambda t: 5 * int(1 <= t < 1.25)),
    "where": (lambda t: np.where(t > 2.5, t * t, 1.0), [Fraction(5, 2)], lambda t: t * t if t > 2.5 else 1),
    "sign": (lambda t: np.sign(t - 2), [2], lambda t: 1 if t > 2 else -1),
    "heaviside": (lambda t: np.heaviside(t - 2, 0.5), [2], lambda t: int(t > 2)),
    "of a floor": ("mod(floor(2 * t), 2)", [Fraction(k, 2) for k in range(1, 10)], lambda t: math.floor(2 * t) % 2),
    "text": (
        "mod(2 * t, 3) + floor(t/2 + 1/4) + 3/(2 + heaviside(t - 1))",
        [1, Fraction(3, 2), 3, Fraction(7, 2), Fraction(9, 2)],
        lambda t: 2 * t % 3 + math.floor(t / 2 + Fraction(1, 4)) + Fraction(3, 2 + (t >= 1)),
    ),
    "abs": (lambda t: abs(t - 2), [2], lambda t: abs(t - 2)),
    "max": (lambda t: max(0.0, 2 - t), [2], lambda t: max(0, 2 - t)),
    "np.maximum": (lambda t: np.maximum(0.0, 2 - t), [2], lambda t: max(0, 2 - t)),
    "remainder": (lambda t: t % 1.5, [Fraction(3, 2), 3, Fraction(9, 2)], lambda t: t % Fraction(3, 2)),
    "falling remainder": (lambda t: np.mod(1 - t, 2), [1, 3], lambda t: (1 - t) % 2),
    "pulses": (lambda t: 1.0 if t % 2 < 0.5 else 0.0, [Fraction(k, 2) for k in (1, 4, 5, 8, 9)], lambda t: t % 2 < 0.5),
    "whole periods": (lambda t: t // 2, [2, 4], lambda t: t // 2),
    "divmod": (lambda t: divmod(t, 2)[0] * divmod(t, 2)[1], [2, 4], lambda t: t // 2 * (t % 2)),
    "int": (lambda t: [3, 1, 4, 1, 5][int(t)], [1, 2, 3, 4], lambda t: [3, 1, 4, 1, 5][int(t)]),
    "int of both signs": (lambda t: int(t - 2), [1, 2, 3, 4], lambda t: int(t - 2)),
    "math.floor": (lambda t: math.floor(t) * t, [1, 2, 3, 4], lambda t: math.floor(t) * t),
    "round": (lambda t: round(t), [Fraction(k, 2) for k in (1, 3, 5, 7, 9)], round),
    "math.fmod": (
        lambda t: math.fmod(t - 1, 1.5),
        [1, Fraction(5, 2), 4],
        lambda t: t - 1 if t < 1 else (t - 1) % Fraction(3, 2),
    ),
    "math.trunc": (lambda t: math.trunc(t - 2), [1, 2, 3, 4], lambda t: math.trunc(t - 2)),
    "np.ceil": (lambda t: np.ceil(t), [1, 2, 3, 4], math.ceil),
}


@pytest.mark.parametrize("name", JUMPS)
def test_integral_of_what_jumps_is_enclosed(name):
    f, cuts, exact = JUMPS[name]
    rates = field_function(field_of_text([f"{f} + 0*y0"])) if isinstance(f, str) else lambda t, y: [f(t) + 0 * y[0]]
    found = enclose_solution(rates, [Fraction(0)], [Fraction(0), END])
    assert widest(found) < 1e-30
    # The ends of the pieces are taken 1e-30 of their lengths inside, where slopes are below 10.
    assert off(found, integral(exact, cuts)) < 1e-28


def switched(t, y):
    return [-y[0] + (1.0 if t < 2 else 0.0)]


def of_switched():
    """y(5), from 0: it tends to 1 until t = 2, and then to 0."""
    return (1 - arb(-2).exp()) * arb(-3).exp()


def test_solution_with_a_jump_is_enclosed_and_steps_are_as_long_as_without():
    found = enclose_solution(switched, [Fraction(0)], [Fraction(0), END])
    with ctx.workprec(160):
        assert found.states[-1][0].contains(of_switched())
    assert found.states[-1][0].rad() < 1e-35
    assert found.steps <= enclose_solution(lambda t, y: -y, [Fraction(1)], [Fraction(0), END]).steps + 2


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("steps do not end at the jump", ("crossing < last:", "crossing < first:")),
        ("the piece before for the one after", ("return crossing > first", "return crossing >= first")),
        ("the remainder of another period", ("self - floor(self / of) * of", "self - (floor(self / of) + 1) * of")),
        ("a line that forgets its rate", ("operation(self.rate, other[1])", "self.rate")),
    ],
)
def test_wrong_decisions_exclude_the_solution(name, wrong, monkeypatch):
    clocks = mutant("clocks", wrong)
    for module in ("steps", "solutions", "fields"):
        monkeypatch.setattr(f"driftproof.enclosure.{module}.Clock", clocks.Clock)
    monkeypatch.setattr("driftproof.enclosure.solution.steps.TimeCut", clocks.TimeCut)
    f = lambda t, y: [-y[0] + (1.0 if (t % 4) * 2 < 4 else 0.0) * (t < 3)]
    try:
        found = enclose_solution(f, [Fraction(0)], [Fraction(0), Fraction(2), END])
    except Refused:
        return
    with ctx.workprec(160):
        assert not found.states[-1][0].contains(of_switched())


@pytest.mark.slow
def test_stiff_solution_with_jumps_is_enclosed():
    """y' = -k (y - s): 1e-5 after each jump of s by 1, exp(-k 1e-5) of the jump is left."""
    k, after = 10**6, Fraction(1, 10**6)
    f = lambda t, y: [-1e6 * (y[0] - (1 if t < 2 else 2 if t % 2 < 1 else 3))]
    times = [Fraction(0), Fraction(2) + after, Fraction(3) + after, END]
    found = enclose_solution(f, [Fraction(1)], times)
    assert found.steps < 300
    with ctx.workprec(160):
        left = (-k * enclose(after)).exp()
        for state, true in zip(found.states[1:], (2 - left, 3 - left, arb(2)), strict=True):
            assert abs(state[0] - true) < 1e-18


def test_stiff_steps_that_do_not_end_at_jumps_are_noticed(monkeypatch):
    wrong = mutant("clocks", ("crossing < last:", "crossing < first:"))
    for module in ("stiff", "collocation"):
        monkeypatch.setattr(f"driftproof.enclosure.{module}.Clock", wrong.Clock)
    f = enclosable(lambda t, y: [-1e6 * (y[0] - (1 if t < 2 else 2))])
    with ctx.workprec(128):
        path = lambda: stiff.StiffPath(f, [arb(1)], Fraction(1), Fraction(3))
        assert not abs(path().states_at(Fraction(3))[0] - 2) < 1e-18
        monkeypatch.undo()
        assert abs(path().states_at(Fraction(3))[0] - 2) < 1e-18


def at(t, *, span=None):
    return Clock(Evaluation(span=span), arb(t))


def test_at_a_single_time_comparisons_are_those_of_the_numbers():
    two = at(2)
    assert (two < 2, two <= 2, two > 2, two >= 2, two == 2) == (False, True, False, True, True)
    assert (int(at(3) / 1.5), at(3) // 1.5, (at(3) % 1.5).sign()) == (2, 2, 0)
    assert (int(at(-2.5)), math.floor(at(-2.5)), math.ceil(at(-2.5))) == (-2, -3, -2)


def test_time_that_is_a_wide_ball_is_decided_where_it_can_be():
    near = Clock(Evaluation(), arb(2, 0.25))
    assert near > 1
    assert not near > 3
    assert math.floor(near / 4) == 0
    for undecided in (lambda: near > 2, lambda: math.floor(near)):
        with pytest.raises(Refused):
            undecided()


def test_on_a_step_the_ends_do_not_count_and_what_is_inside_is_where_to_end():
    t = at(arb(1.5, 0.5), span=(Fraction(1), Fraction(2)))
    assert t > 1
    assert t < 2
    assert t != 2
    assert not t == 1  # noqa: SIM201
    assert (math.floor(t), int(-t), math.ceil(t), t // 1, math.floor(1 - t)) == (1, -1, 2, 1, -1)
    assert 0 * t == 0
    for inside in (lambda: t > 1.5, lambda: t == 1.5, lambda: 4 * t % 6, lambda: math.floor(t + 0.5)):
        with pytest.raises(TimeCut) as cut:
            inside()
        assert cut.value.at == Fraction(3, 2)


def test_products_with_other_numbers_are_no_clocks():
    t = at(arb(1.5, 0.5), span=(Fraction(1), Fraction(2)))
    for made in (t * t, 1 / t, np.sin(t), t**2):
        assert not isinstance(made, Clock)


def test_zero_of_another_function_of_time_is_crossed():
    found = enclose_solution(lambda t, y: [1.0 if np.sin(t) > 0 else 0.0], [Fraction(0)], [Fraction(1), END])
    with ctx.workprec(160):
        assert found.states[-1][0].contains(arb.pi() - 1)


def test_jumps_one_rounding_apart_are_two_steps():
    f = lambda t, y: [1.0 if t < 0.3 else 100.0 if t < 0.1 + 0.2 else 0.0]
    found = enclose_solution(f, [Fraction(0)], [Fraction(0), Fraction(1)])
    whole = Fraction(0.3) + 100 * (Fraction(0.1 + 0.2) - Fraction(0.3))
    assert off(found, whole) < 1e-30


def test_jumps_without_end_are_refused_early(monkeypatch):
    monkeypatch.setattr(solutions, "MOST_STEPS", 2000)
    with pytest.raises(Refused, match="too long: 20 steps"):
        enclose_solution(lambda t, y: [t % 1e-6], [Fraction(0)], [Fraction(0), END])


def rk4_run(f, n):
    h, rows = 5 / n, [np.zeros(1)]
    for i in range(n):
        rows.append(rk4(lambda t, y: np.array(f(t, y)), i * h, rows[-1], h))
    return [i * h for i in range(n + 1)], [row.tolist() for row in rows]


def test_points_on_an_edge_that_floats_see_a_rounding_aside_are_no_other_f():
    """0.015 * 1000 is 15 in floats, and a little less exactly; 0.5 / 0.1 is 5, and a little less."""
    for f, at in (
        (lambda t, y: [1.0 if t * 1000 % 1 < 0.4 else 0.0], 0.015),
        (lambda t, y: [int(t / 0.1) % 2 + 0.0 * y[0]], 0.5),
    ):
        exact = enclose_solution(f, [Fraction(0)], [Fraction(0), Fraction(at)]).states[-1][0]
        assert certify(f, [0.0, at], [[0.0], [float(exact)]]).largest_error < 1e-16
    with pytest.raises(Refused, match="but its enclosure is"):
        certify(lambda t, y: [1.0 if isinstance(y[0], float) and t == 0.5 else 0.0], [0.0, 0.5], [[0.0], [0.0]])


def test_float_run_over_jumps_is_split_into_truncation_and_rounding():
    t, y = rk4_run(switched, 40)
    found = certify(switched, t, y, method="rk4")
    exact = rk4_run(lambda t, y: [-y[0] + (1 if t < 2 else 0)], 40)[1]
    # The step that ends at the jump takes its last slope from after it, which is off by 1: by h/6 in the end.
    assert abs(found.split.truncation[16][0] + enclose(Fraction(1, 48))) < 1e-6
    assert max(abs(x) for (x,) in found.split.rounding) < 1e-15
    assert y == exact


def test_a_time_in_a_ball_is_exactly_the_one_known_time_that_it_may_be():
    third, ball = Fraction(1, 3), enclose(Fraction(1, 3))
    found = exact_time(Evaluation(), ball, [(x, enclose(x)) for x in (third, Fraction(1, 2))])
    assert (found.offset, found.rate) == (third, 0)
    assert not third < found <= Fraction(1, 3) - Fraction(1, 10**40)
    for known in ([], [third, third + Fraction(1, 10**40)]):  # none, and two that are too near
        unknown = exact_time(Evaluation(), ball, [(x, enclose(x)) for x in known])
        assert unknown.rate == 1
        with pytest.raises(Refused, match="compares numbers"):
            _ = unknown > third
