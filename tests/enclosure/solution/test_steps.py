"""One step: formulas lie within it, sharply enough that each wrong bound that is planted is caught."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, arb_mat, ctx

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.enclosure.fields.fields import decisions
from driftproof.enclosure.solution import steps
from driftproof.enclosure.solution.steps import balanced
from driftproof.symbolic.algebra.certified import enclose
from tests.enclosure.mutants import mutant


def made(module, f, start, spread, length=42, longest=Fraction(2), weights=None):
    decided = decisions(f, Fraction(0), start, set())
    weights = [arb(1)] * len(start) if weights is None else weights
    return module.Expansion(f, Fraction(0), start, length, decided, weights).step(longest, [spread] * len(start))


def dense_holds_growth(module):
    """y' = 2ty, a large defect allowed, which is all tail: exp(s²) is within the bound at the end of the step."""
    module.BITS_OF_A_STEP = Fraction(1, 8)
    with ctx.workprec(200):
        step = made(module, lambda t, y: 2 * t * y, [arb(1)], arb(0), length=9)
        (value,), near = step.at(step.h)
        distance = abs(value - (enclose(step.h) ** 2).exp())
        assert distance > arb(2) ** -60  # the polynomial alone is off, and the step says so
        return distance <= near


def dense_holds_neighbours(module):
    """y' = y: a solution that starts 2^-40 away is 2^-40 exp(s) away, which is the bound up to 2^-20."""
    with ctx.workprec(128):
        spread = arb(2) ** -40
        step = made(module, lambda t, y: y, [arb(1)], spread)
        distance, bound = spread * enclose(step.h).exp(), spread * step.tube.growth(enclose(step.h))
        return distance <= bound * (1 + arb(2) ** -60) and bound < 1.01 * distance


def tube_is_wide_enough(module, first=2, weight=1):
    """y' = y + 200 y^41 beside y = 0: a solution leaves the tube of twice its distance, and grows faster."""
    c, spread, module.FIRST_TUBE = 200.0, arb(2) ** -2, first
    with ctx.workprec(128):
        step = made(module, lambda t, y: y + c * y**41, [arb(0)], spread, weights=[arb(weight)])
        h = enclose(step.h)
        distance = (-((spread**-40 + c) * (-40 * h).exp() - c).log() / 40).exp()
        return distance <= spread * step.tube.growth(h)


def weighted_tube_is_wide_enough(module):
    """The same in units of 4: a tube that is not may be 4 times too narrow."""
    return tube_is_wide_enough(module, first=4, weight=4)


def flow_holds_growth(module):
    """y' = y: the derivative of the flow is exp(h), which its twelve coefficients alone miss."""
    module.VARIATIONAL_LENGTH = 12
    with ctx.workprec(128):
        step = made(module, lambda t, y: y, [arb(1)], arb(0))
        return bool(step.flow[0, 0].contains(enclose(step.h).exp().mid()))


def flow_holds_what_its_coefficients_leave_out(module):
    """y' = t^4 y: four coefficients see nothing of it; the derivative of the flow is exp(h^5/5)."""
    module.VARIATIONAL_LENGTH = 4
    with ctx.workprec(128):
        step = made(module, lambda t, y: y * t**4, [arb(1)], arb(0))
        return bool(step.flow[0, 0].contains((enclose(step.h) ** 5 / 5).exp().mid()))


def flow_holds_products_beyond_its_coefficients(module):
    """y' = 2ty in four coefficients: the derivative of the flow is exp(h²)."""
    module.VARIATIONAL_LENGTH = 4
    with ctx.workprec(128):
        step = made(module, lambda t, y: 2 * t * y, [arb(1)], arb(0))
        return bool(step.flow[0, 0].contains((enclose(step.h) ** 2).exp().mid()))


def distance_is_that_of_the_theorem(module):
    """e' = me + δ from 0, with m = 2^-30: nearly sδ, and no more than what is said."""
    m, defect, s = arb(2) ** -30, arb(2) ** -10, Fraction(3, 4)
    with ctx.workprec(128):
        tube = module.Tube(arb(1), m)
        step = module.EnclosedStep(Fraction(0), Fraction(1), [], arb(0), defect, tube, arb_mat(0, 0), [], [])
        return bool(defect * (m * enclose(s)).expm1() / m <= step.at(s)[1])


def no_branch_is_crossed(module):
    """y' = |y| + 1 from -1/1024 ± 1/8192 changes its formula at 7/8192 already for a neighbour."""
    with ctx.workprec(128):
        f, longest = lambda t, y: abs(y) + 1, Fraction(9, 10 * 1024)
        return made(module, f, [arb(-1) / 1024], arb(1) / 8192, longest=longest).h <= Fraction(7, 8192)


def spring_is_weighted(module):
    """q'' = -2^20 q, in units 1 and 2^10: Gronwall's constant is 2^10; a solution that starts 2^-40 off lies within."""
    with ctx.workprec(128):
        f, spread, weights = (lambda t, y: [y[1], -(2**20) * y[0]]), arb(2) ** -40, [arb(1), arb(2) ** 10]
        step = made(module, f, [arb(1), arb(0)], spread, longest=Fraction(1, 2**9), weights=weights)
        angle = 2**10 * enclose(step.h)
        distances = (spread * angle.sin(), 2**10 * spread * angle.cos())  # from (0, 2^10 2^-40)
        wide = [x.rad() for x in step.around(step.spread * step.tube.growth(enclose(step.h)))]
        held = all(abs(x) <= r for x, r in zip(distances, wide, strict=True))
        turned = [angle.cos(), angle.sin() / 2**10, -(2**10) * angle.sin(), angle.cos()]
        flow = all(x.contains(y.mid()) for x, y in zip(step.flow.entries(), turned, strict=True))
        return held and flow and step.tube.norm == 2**10 and step.next_weights == weights


CHECKS = (
    *(dense_holds_growth, dense_holds_neighbours, tube_is_wide_enough, flow_holds_growth, no_branch_is_crossed),
    *(weighted_tube_is_wide_enough, spring_is_weighted),
    *(flow_holds_what_its_coefficients_leave_out, flow_holds_products_beyond_its_coefficients),
    distance_is_that_of_the_theorem,
)
GROWTH = "return (self.norm * s).exp()"
DEFECT = "return self._size((rate.value - slope).norm for rate, slope in zip(rates, slopes, strict=True))"
FLOW = "(defect * tube.growth(step)).upper(), value"
BRANCH = ("Evaluation(span=(self.t, self.t + h), for", "Replay(outcomes=self.decided, span=(self.t, self.t + h), for")
WRONG = {
    "a radius halved": (dense_holds_neighbours, (GROWTH, "return (self.norm * s).exp() / 2")),
    "Gronwall's constant too small": (dense_holds_neighbours, (GROWTH, "return (self.norm * s / 2).exp()")),
    "the defect dropped": (dense_holds_growth, (DEFECT, "return arb(0)")),
    "the tail omitted": (dense_holds_growth, (DEFECT, DEFECT.replace(".norm", ".polynomial(1)"))),
    "the tube not checked": (tube_is_wide_enough, ("if tube.growth(step) * error < radius:", "if True:")),
    "the distance halved": (distance_is_that_of_the_theorem, ("ball * self.defect *", "ball / 2 * self.defect *")),
    "the tail of the Jacobian omitted": (
        flow_holds_what_its_coefficients_leave_out,
        (" + tail * norm_of(np.abs(P))", ""),
    ),
    "products beyond the coefficients omitted": (
        flow_holds_products_beyond_its_coefficients,
        (".less(derivative(P)).sizes()", ".less(derivative(P)).sizes()[: length - 1]"),
    ),
    "the flow's error omitted": (flow_holds_growth, (FLOW, "arb(0), value")),
    "branches on the tube not looked at": (no_branch_is_crossed, BRANCH),
    "the tube without weights": (weighted_tube_is_wide_enough, ("(radius * d).upper()", "radius")),
    "a radius without weights": (spring_is_weighted, ("(distance * d).upper()", "distance")),
    "weights the wrong way": (spring_is_weighted, ("(d[j] / d[i]) ** power", "(d[i] / d[j]) ** power")),
    "the flow left in other units": (spring_is_weighted, ("self._scaled(flow.tolist(), -1)", "flow.tolist()")),
}


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_step_holds(check):
    assert check(mutant("steps"))


@pytest.mark.parametrize("name", WRONG)
def test_wrong_step_is_caught(name):
    check, *replaced = WRONG[name]
    assert not check(mutant("steps", *replaced))


@pytest.mark.parametrize(
    ("rows", "weights"),
    [
        ([[5, 2.0**-8], [2.0**-2, 9]], [0.25, 4]),
        ([[5, 2.0**8], [2.0**2, 9]], [16, 4]),
        ([[5, 2.0**-8], [0, 9]], [2, 4]),
        ([[5, 0], [2.0**-2, 9]], [2, 4]),
        ([[5, arb("inf")], [2.0**-2, 9]], [2, 4]),
        ([[5, 2.0**-2], [arb("inf"), 9]], [2, 4]),
    ],
)
def test_what_is_coupled_both_ways_is_balanced(rows, weights):
    assert balanced([[arb(x) for x in row] for row in rows], [arb(2), arb(4)]) == weights


@pytest.mark.parametrize("length", [5, 9, 42])
def test_coefficients_are_those_of_the_solution(length):
    """Of y' = 1 + y² from 0, the tangent, which solves that coefficient by coefficient."""
    with ctx.workprec(128):
        (c,) = steps.Expansion(lambda t, y: [1 + y[0] ** 2], Fraction(0), [arb(0)], length, [], [arb(1)]).rows
        assert len(c) == length
        for k in range(length - 1):
            assert abs((k + 1) * c[k + 1] - sum((c[i] * c[k - i] for i in range(k + 1)), arb(k == 0))) < 2.0**-120


def test_coefficients_of_a_linear_field_take_two_runs(monkeypatch):
    """y0' = y1 + t², y1' = 2 y0 - y1: each coefficient by those before, and all but the first three at once."""
    run, lengths = steps.linearised, []
    monkeypatch.setattr(
        steps, "linearised", lambda f, t, y, slopes: lengths.append(ctx.cap) or run(f, t, y, slopes=slopes)
    )
    with ctx.workprec(128):
        f, start = lambda t, y: [y[1] + t * t, 2 * y[0] - y[1]], [arb(1), arb(-1)]
        x, y = steps.Expansion(f, Fraction(0), start, 42, [], [arb(1)] * 2).rows
        assert lengths == [2, 41]
        for k in range(41):
            assert abs((k + 1) * x[k + 1] - y[k] - (k == 2)) < 2.0**-120
            assert abs((k + 1) * y[k + 1] - 2 * x[k] + y[k]) < 2.0**-120


@pytest.mark.parametrize("components", [1, 4, 12])
@pytest.mark.parametrize("length", [9, 42])
def test_as_many_slopes_are_computed_as_pay(components, length, monkeypatch):
    """A run of f costs 1, and with gradients 1 + n: no other number of slopes costs less. All rates depend on all."""
    costs, spent, paying, run = {}, [], steps._slopes_that_pay(components, length), steps.linearised
    count = lambda f, t, y, slopes: spent.append(1 + components * slopes) or run(f, t, y, slopes=slopes)
    monkeypatch.setattr(steps, "linearised", count)
    for most in (0, 1, 3, 7, 15, 31, paying):
        monkeypatch.setattr(steps, "_slopes_that_pay", lambda n, length, most=most: most)
        steps.Expansion(lambda t, y: y * sum(y), Fraction(0), [arb(1)] * components, length, [], [arb(1)] * components)
        costs[most] = sum(spent) - sum(costs.values())
    assert costs[paying] == min(costs.values())


def test_more_bits_and_more_components_leave_fewer_steps():
    """As many at 128 bits and twelve components, half at 256 bits, a quarter at 24 components, and never more."""
    for bits, components, wanted in ((128, 12, 1000), (64, 6, 1000), (256, 12, 500), (128, 24, 250)):
        with ctx.workprec(bits):
            assert steps.fewer_steps(1000, components) == wanted


def test_size_keeps_what_is_not_a_number():
    assert (size([arb(-3), arb(2)]), size([])) == (3, 0)
    assert not size([arb(1), arb("nan"), arb(2)]).is_finite()
    assert not size([arb("nan"), arb(1)]).is_finite()


def test_step_that_is_not_found_is_refused(monkeypatch):
    for most, said in (
        (0, "f or the solution has a pole ahead, or f is not smooth there"),
        (90, "f divides by a number that may be 0"),
    ):
        monkeypatch.setattr(steps, "MOST_SHORTENINGS", most)
        with pytest.raises(Refused, match=f"no step from t = 0, however short, could be proved: .*{said}") as caught:
            made(steps, lambda t, y: 1 / y, [arb(1)], arb(2))
        assert caught.value.t == 0


@pytest.mark.parametrize(
    ("f", "start", "said"),
    [
        (lambda t, y: 1 / y, 0, "f is not finite|divides by"),
        (lambda t, y: y.sqrt() if False else y**0.5, -1, "not finite"),
        (lambda t, y: abs(y), 0, "whose enclosures overlap"),
    ],
)
def test_point_where_f_is_not_smooth_is_refused(f, start, said):
    with pytest.raises(Refused, match=said):
        made(steps, f, [arb(start)], arb(0))
