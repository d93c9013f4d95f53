"""Functions of data, of the time and of the solution: their integrals are those of the exact lines and splines."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import arb, ctx
from numpy import digitize
from scipy import interpolate
from scipy.interpolate import (
    Akima1DInterpolator,
    CubicSpline,
    PchipInterpolator,
    PPoly,
    UnivariateSpline,
    interp1d,
    make_interp_spline,
    splev,
)

from driftproof.enclosure.arithmetic import data
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.solution.solutions import enclose_solution
from tests.enclosure.integrals import END, integral, off

KNOTS, DATA = [0.5, 1.0, 2.25, 4.0], [1.0, -0.75, 2.0, 0.3]
CUBIC, PCHIP = CubicSpline(KNOTS, DATA), PchipInterpolator(KNOTS, DATA)
PERIODIC = CubicSpline(KNOTS, [1.0, -0.75, 2.0, 1.0], bc_type="periodic")
AKIMA = Akima1DInterpolator(KNOTS, DATA, extrapolate=True)
B_SPLINES, PARABOLAS = make_interp_spline([0, *KNOTS[1:-1], 5], DATA), make_interp_spline([0.0, 1.0, 3.0, 5.0], DATA, 2)
LINES, CURVED = interp1d(KNOTS, DATA, fill_value="extrapolate"), interp1d([0, *KNOTS[1:-1], 5], DATA, "cubic")
ENDING = interp1d(KNOTS, DATA, bounds_error=False, fill_value=(7.0, 2.0))
FIRST_AND_LAST = {"bounds_error": False, "fill_value": (DATA[0], DATA[-1])}
KINDS = ("previous", "next", "nearest", "nearest-up")
PREVIOUS, NEXT, NEAREST, NEAREST_ABOVE = (interp1d(KNOTS, DATA, kind, **FIRST_AND_LAST) for kind in KINDS)
HALVES, LEFT = [0.75, 1.625, 3.125], [*map(Fraction, DATA), Fraction(9)]


def lines(t):
    """What numpy.interp gives, from the points themselves."""
    for (a, b), (u, v) in zip(pairwise(map(Fraction, KNOTS)), pairwise(map(Fraction, DATA)), strict=True):
        if a <= t <= b:
            return u + (v - u) * (t - a) / (b - a)
    return Fraction(DATA[0] if t < KNOTS[0] else DATA[-1])


def polynomial(spline, t):
    inside = min(max(sum(t >= Fraction(x) for x in KNOTS) - 1, 0), len(KNOTS) - 2)
    powers = [(t - Fraction(KNOTS[inside])) ** k for k in reversed(range(len(spline.c)))]
    return sum(Fraction(float(c)) * x for c, x in zip(spline.c[:, inside], powers, strict=True))


def basis(t, k, i, x):
    """The B-spline of degree k that begins at the knot i, by its definition."""
    if k == 0:
        return int(t[i] <= x < t[i + 1])
    parts = ((i, x - t[i], t[i + k] - t[i]), (i + 1, t[i + k + 1] - x, t[i + k + 1] - t[i + 1]))
    return sum(up / width * basis(t, k - 1, j, x) for j, up, width in parts if width)


def basis_sum(of, x):
    knots, coefficients, degree = of
    t = [*map(Fraction, knots)]
    count = len(t) - degree - 1
    return sum(Fraction(coefficients[i]) * basis(t, degree, i, x) for i in range(count))


def lines_on(t):
    """The lines, of which the first and the last go on."""
    i = 0 if t < Fraction(KNOTS[1]) else 2 if t > Fraction(KNOTS[2]) else 1
    (a, b), (u, v) = map(Fraction, KNOTS[i : i + 2]), map(Fraction, DATA[i : i + 2])
    return u + (v - u) * (t - a) / (b - a)


def point(i):
    return Fraction(DATA[min(max(i, 0), 3)])


HELD = {"all": [CUBIC, PCHIP]}


def held(t):
    return 2 * polynomial(CUBIC, t) - polynomial(PCHIP, t)


class Holder:
    """An object that is called by another name."""

    def __init__(self, splines):
        self.splines = splines

    def rate(self, t):
        return 2 * self.splines["a"](t) - self.splines["b"][0](t)


class Driven:
    """Data that belong to an object."""

    def __init__(self):
        self.spline, self.gain = CUBIC, 1

    def __call__(self, t, y):
        return [self.gain * self.spline(t)]

    def rates(self, t, y):
        return self(t, y)


def folded(t):
    return Fraction(1, 2) + (t - Fraction(1, 2)) % Fraction(7, 2)


DATA_OF = {
    "interp": (lambda t: np.interp(t, KNOTS, DATA), KNOTS, lines),
    "interp with ends": (
        lambda t: np.interp(t, KNOTS, DATA, left=7.0, right=2.0),
        KNOTS,
        lambda t: 7 if t < KNOTS[0] else 2 if t > KNOTS[-1] else lines(t),
    ),
    "cubic": (lambda t: CUBIC(t), KNOTS, lambda t: polynomial(CUBIC, t)),
    "pchip": (lambda t: PCHIP(t), KNOTS, lambda t: polynomial(PCHIP, t)),
    "an object's": (Driven(), KNOTS, lambda t: polynomial(CUBIC, t)),
    "a method's": (Driven().rates, KNOTS, lambda t: polynomial(CUBIC, t)),
    "in a list": (lambda t: sum(w * s(t) for w, s in zip((2, -1), HELD["all"], strict=True)), KNOTS, held),
    "by default": (lambda t, s=CUBIC, *, more=(PCHIP,): float(2 * s(t)) - more[0](t), KNOTS, held),
    "in an object's dict": (Holder({"a": CUBIC, "b": [PCHIP]}).rate, KNOTS, held),
    "of its parts": (lambda t: splev(t, PARABOLAS.tck), [2.0], lambda t: basis_sum(PARABOLAS.tck, t)),
    "made in f": (lambda t: CubicSpline(KNOTS, DATA)(t), KNOTS, lambda t: polynomial(CUBIC, t)),
    "of a module": (
        lambda t: interpolate.PchipInterpolator(KNOTS, DATA)(t).item(),
        KNOTS,
        lambda t: polynomial(PCHIP, t),
    ),
    "derivative": (lambda t: CUBIC.derivative()(t), KNOTS, lambda t: polynomial(CUBIC.derivative(), t)),
    "akima": (lambda t: AKIMA(t), KNOTS, lambda t: polynomial(AKIMA, t)),
    "cubic B-splines": (lambda t: B_SPLINES(t), [], lambda t: basis_sum(B_SPLINES.tck, t)),
    "parabolas": (lambda t: PARABOLAS(t), [2.0], lambda t: basis_sum(PARABOLAS.tck, t)),
    "interp1d": (lambda t: LINES(t), KNOTS[1:-1], lines_on),
    "with ends": (lambda t: ENDING(t), KNOTS, lambda t: 7 if t < KNOTS[0] else 2 if t > KNOTS[-1] else lines(t)),
    "interp1d, cubic": (lambda t: CURVED(t), [], lambda t: basis_sum((CURVED._spline.t, CURVED._spline.c[:, 0], 3), t)),
    "previous": (lambda t: PREVIOUS(t), KNOTS, lambda t: point(sum(t >= Fraction(x) for x in KNOTS) - 1)),
    "next": (lambda t: NEXT(t), KNOTS, lambda t: point(sum(t > Fraction(x) for x in KNOTS))),
    "nearest": (lambda t: NEAREST(t), HALVES, lambda t: point(sum(t > Fraction(x) for x in HALVES))),
    "periodic": (lambda t: PERIODIC(t), [*KNOTS, 4.5], lambda t: polynomial(PERIODIC, folded(t))),
}


@pytest.mark.parametrize("name", DATA_OF)
def test_integral_of_measured_data_is_enclosed(name):
    f, cuts, exact = DATA_OF[name]
    rates = f if isinstance(getattr(f, "__self__", f), Driven) else lambda t, y: [f(t)]
    found = enclose_solution(rates, [Fraction(0)], [Fraction(0), END])
    assert off(found, integral(exact, cuts)) < 1e-28
    assert found.doubles == ()


BINS = {
    "bins": (lambda t: DATA[np.digitize(t, KNOTS[1:])], KNOTS[1:], lambda t: point(sum(t >= x for x in KNOTS[1:]))),
    "falling bins": (lambda t: DATA[digitize(t, KNOTS[:0:-1])], KNOTS, lambda t: point(sum(t < x for x in KNOTS[1:]))),
    "places": (lambda t: LEFT[np.searchsorted(KNOTS, t, "right")], KNOTS, lambda t: LEFT[sum(t >= x for x in KNOTS)]),
}


@pytest.mark.parametrize("name", BINS)
def test_integral_of_what_a_bin_chooses_is_enclosed(name):
    f, cuts, exact = BINS[name]
    assert off(enclose_solution(lambda t, y: [f(t)], [Fraction(0)], [Fraction(0), END]), integral(exact, cuts)) < 1e-28


def test_derivative_of_a_spline_is_that_of_its_pieces():
    found = enclose_solution(lambda t, y: [CUBIC(t, 1)], [Fraction(0)], [Fraction(1), Fraction(4)])
    whole = Fraction(0)
    for i in (1, 2):
        c, width = [Fraction(float(x)) for x in CUBIC.c[:, i]], Fraction(KNOTS[i + 1]) - Fraction(KNOTS[i])
        whole += ((c[0] * width + c[1]) * width + c[2]) * width
    assert off(found, whole) < 1e-30


def test_of_many_data_only_those_near_the_number_are_read(monkeypatch):
    """Bisection looks at 12 of 4,000 knots, and lines and splines at two of them and their values."""
    read, many = [], np.arange(4000.0)
    monkeypatch.setattr(data, "Fraction", lambda x: read.append(x) or Fraction(x))
    x = Enclosed(Evaluation(), arb("1234.5"), exact=Fraction("1234.5"))
    assert data.interpolated(x, many, many).value == arb("1234.5")
    assert 12 <= len(read) <= 2 * 12 + 6
    read.clear()
    data.spline_of(CubicSpline(many, many))(x)
    assert 12 <= len(read) <= 2 * 12 + 6


class Positive(CubicSpline):
    def __call__(self, x, *more):
        return np.maximum(super().__call__(x, *more), 0.0)


def test_splines_of_other_rules_are_refused():
    wrong = PPoly(np.array([[1.0, -1.0], [0.0, 1.0]]), [2.0, 1.0, 0.0])
    of_complex, positive = PPoly(np.array([[1j], [1.0]]), [0.0, 5.0]), Positive(KNOTS, DATA)
    for said, f in (
        ("converts a number to a float", lambda t, y: [positive(t)]),
        ("f uses complex data", lambda t, y: [abs(np.interp(t, [0, 5], [1j, 1]))]),
        ("f uses complex data", lambda t, y: [abs(of_complex(t))]),
        ("whose knots decrease", lambda t, y: [wrong(t)]),
        ("an integral of a spline", lambda t, y: [CUBIC(t, -1)]),
    ):
        with pytest.raises(Refused, match=said):
            enclose_solution(f, [Fraction(0)], [Fraction(1), END])


def test_a_bin_of_the_solution_changes_where_the_solution_comes_to_its_edge():
    """From 1/10 with rates 1/2, 1 and 3/4 through 1 and 2: y(4) = 2 + 3/4 (4 - 9/5 - 1)."""
    bins = lambda t, y: [[0.5, 1.0, 0.75][np.digitize(y[0], [1.0, 2.0])]]
    found = enclose_solution(bins, [Fraction(1, 10)], [Fraction(0), Fraction(4)])
    assert off(found, 2 + Fraction(3, 4) * Fraction(6, 5)) < 1e-25


@pytest.mark.slow
def test_angle_of_a_point_on_a_circle_jumps_on_one_side_only():
    """The integral of the angle of (cos t, sin t), which is t up to pi and then t - 2 pi, is (9 - 2 pi)^2/2 at 9."""
    turning = lambda t, y: np.array([-y[1], y[0], np.arctan2(y[1], y[0])])
    found = enclose_solution(turning, [Fraction(1), Fraction(0), Fraction(0)], [Fraction(0), Fraction(9)])
    with ctx.workprec(160):
        assert found.states[-1][2].overlaps((9 - 2 * arb.pi()) ** 2 / 2)
    assert found.states[-1][2].rad() < 1e-20


CHOSEN = {
    "bins": lambda x: np.digitize(x, KNOTS), "bins on the left": lambda x: np.digitize(x, KNOTS, right=True),
    "falling": lambda x: np.digitize(x, KNOTS[::-1]), "falling, left": lambda x: np.digitize(x, KNOTS[::-1], True),
    "left": lambda x: np.searchsorted(KNOTS, x), "right": lambda x: np.searchsorted(KNOTS, x, "right"),
    "previous": lambda x: PREVIOUS(x), "next": lambda x: NEXT(x), "nearest": lambda x: NEAREST(x),
    "nearest above": lambda x: NEAREST_ABOVE(x), "angle": lambda x: np.arctan2(x - 1, -1.0),
}  # fmt: skip


@pytest.mark.parametrize("name", CHOSEN)
def test_at_an_edge_that_is_chosen_which_floats_choose(name):
    given = CHOSEN[name]
    choose = enclosable(lambda t, y: [given(y[0])])
    for x in (0.0, *KNOTS, *HALVES, 5.0):
        (found,) = choose(0, [Enclosed(Evaluation(), arb(x), exact=Fraction(x))])
        assert abs(float(getattr(found, "value", found)) - given(x)) < 1e-15, x


def test_data_are_refused_beyond_their_ends_and_by_another_order():
    ending, lines = UnivariateSpline(KNOTS, DATA, k=1, s=0, ext=1), interp1d(KNOTS, DATA)
    inside = CubicSpline(KNOTS, DATA, extrapolate=False)
    within = lambda t, y: [inside(t)]
    assert enclose_solution(within, [Fraction(0)], [Fraction(1, 2), Fraction(4)]).steps >= 3
    for said, f in (
        ("f converts a number to a float in .*, by SciPy's UnivariateSpline.__call__;", lambda t, y: [ending(t)]),
        ("a spline beyond its ends", within),
        ("data beyond their ends", lambda t, y: [lines(t)]),
    ):
        with pytest.raises(Refused, match=said):
            enclose_solution(f, [Fraction(0)], [Fraction(1), END])
