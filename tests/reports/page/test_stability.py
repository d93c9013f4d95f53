"""The panel of stability: verdicts on both sides of the limit, held to another derivation and to eigenvalues."""

import re
from dataclasses import replace
from fractions import Fraction as Q

import numpy as np
import pytest
import sympy

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.scenes import PRESETS
from driftproof.reports.page.stability import beside, growth_figure, line_style, verdict, verdicts_table
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.derivation.one_step import one_step_matrix
from driftproof.symbolic.derivation.stability import AtStep
from driftproof.symbolic.linear.stability_limits import spectral_radius
from driftproof.symbolic.runs import exact_matrix_at

VERDICTS = [
    ("forward_euler", Q(1, 4), False, "above"), ("symplectic_euler", Q(1, 4), True, "below"),
    ("symplectic_euler", Q(2), False, "at the limit"), ("symplectic_euler", Q(5, 2), False, "above"),
    ("rk4", Q(2828427124, 10**9), True, "below"), ("rk4", Q(2828427125, 10**9), False, "above"),
    ("implicit_midpoint", Q(10**6), True, "below"), ("backward_euler", Q(1), True, "below"),
    ("symplectic_euler", Q(-1), True, "negative"),
]  # fmt: skip


def test_twelve_curves_are_told_apart():
    assert [line_style(i) for i in (0, 7, 8)] == ["m0", "m7", "m0 again"]
    assert len({line_style(i) for i in range(12)}) == 12


@pytest.mark.parametrize(("key", "h", "bounded", "where"), VERDICTS)
def test_verdict_and_place_beside_the_limit(key, h, bounded, where):
    found = verdict(key, h)
    assert (found.bounded, beside(found.limit, h)) == (bounded, where)


@pytest.mark.parametrize("key", ["forward_euler", "symplectic_euler", "rk4", "velocity_verlet", "heun2"])
@pytest.mark.parametrize("h", [Q(1, 10), Q(1), Q(2), Q(5, 2), Q(3)])
def test_verdict_agrees_with_the_other_derivation(key, h):
    """The witness works over Q[h] with SymPy's number fields, and with NumPy's eigenvalues; neither is used here."""
    found = verdict(key, h)
    assert found.bounded == AtStep(one_step_matrix(METHODS[key]), sympy.Rational(h.numerator, h.denominator)).bounded
    a, b, c, d = map(float, exact_matrix_at(METHODS[key], h))
    seen = max(abs(np.linalg.eigvals([[a, b], [c, d]])))
    # A double eigenvalue is found to the square root of rounding only.
    assert abs(float(enclose(found.growth)) + 1 - seen) < 1e-6


def test_radius_of_one_is_known_to_be_one():
    """Where M keeps area and its powers are bounded, also with coefficients in a number field: no enclosure decides."""
    for key in ("symplectic_euler", "velocity_verlet", "yoshida4", "implicit_midpoint", "gauss2"):
        assert verdict(key, Q(1, 2)).growth == 0
    assert verdict("symplectic_euler", Q(2)).growth == 0
    assert spectral_radius((Q(1), Q(0), Q(0), Q(3))) == 3
    assert spectral_radius((Q(-5), Q(0), Q(0), Q(3))) == 5
    assert spectral_radius((Q(0), Q(4), Q(-4), Q(0))) == 4


def test_growth_is_the_norm_of_the_powers():
    """Of forward Euler at h = 1, whose step turns and grows by sqrt 2, n log10(2)/2."""
    scene = replace(PRESETS["compare"], h=Q(1), t=Q(2))
    data = growth_figure(scene, [verdict("forward_euler", Q(1))], "id").data
    assert [row[1] for row in data[1:4]] == ["0.0000", "0.1505", "0.3010"]
    rows = growth_figure(replace(scene, t=Q(200)), [verdict("rk4", Q(1))], "id").data[1:]
    assert [row[0] for row in rows] == [str(100 * i) for i in range(21)], "of 200 places in ten times the steps"
    long = growth_figure(replace(scene, t=Q(5)), [verdict(key, Q(1)) for key in ("forward_euler", "rk4")], "id")
    assert "n from 0 to 50, logarithmic axis from 10⁻¹ to 10⁸. At the end: Forward Euler 3.36e+07, " in long.description
    assert (long.plot.x.ticks, long.plot.y.ticks) == ([0, 20, 40], [0, 2, 4, 6, 8])
    assert re.findall(r'(path m\d)" d="M52 ([\d.]+)L[^"]*L398 ([\d.]+)"', "".join(long.plot.drawn)) == [
        ("path m0", "228.67", "38.01"),
        ("path m1", "228.67", "232.03"),
    ]
    assert [long.data[i] for i in (1, 2, -1)] == [
        ["0", "0.0000", "0.0000"],
        ["2", "0.3010", "-0.0053"],
        ["50", "7.5257", "-0.1328"],
    ]


def test_growth_that_stays_near_1_stands_in_the_middle_of_two_decades():
    shown = growth_figure(PRESETS["compare"], [verdict("implicit_midpoint", Q(1, 2))], "id")
    scale = shown.plot.y.scale
    assert (scale.low, scale.high) == (-1, 1)


def test_growth_of_a_step_that_vanishes_is_minus_infinity_from_the_first_step_on(tmp_path):
    """The step has R(z) = 1 + z + z² + z³, which is 0 at z = i."""
    own = tmp_path / "own.toml"
    own.write_text('family = "runge_kutta"\nA = [[], [1], [0, 1]]\nb = [0, 0, 1]\n', encoding="utf-8")
    verdicts = [verdict(key, Q(1)) for key in (str(own), "forward_euler")]
    shown = growth_figure(replace(PRESETS["compare"], h=Q(1), t=Q(2)), verdicts, "id")
    assert [row[1:] for row in shown.data[1:4]] == [["0.0000", "0.0000"], ["-inf", "0.1505"], ["-inf", "0.3010"]]
    assert ["L" in path for path in shown.plot.drawn] == [False, True]
    assert "logarithmic axis from 1 to 10⁴. At the end: own 0, " in shown.description


def test_table_of_verdicts_says_each_limit_exactly_and_in_decimals():
    keys = ("forward_euler", "rk4", "symplectic_euler", "implicit_midpoint", "dormand_prince54")
    shown = verdicts_table(replace(PRESETS["compare"], h=Q(1)), [verdict(key, Q(1)) for key in keys])
    assert [re.findall(r"<td>(.*?)</td>", row) for row in shown.split("</tr>")[1:-1]] == [
        ["none", "–", "above", "unbounded", "0.414"],
        ["2√2", "2.828427125", "below", "bounded", "-0.00609"],
        ["2", "2", "below", "bounded", "0"],
        ["all h", "–", "below", "bounded", "0"],
        ["a root of degree 6", "0.9971890086", "above", "unbounded", "1.39e-6"],
    ]
