"""First integrals of float runs: drifts that are known exactly, and refusals."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

from driftproof import METHODS, OscillatorRun, Refused, certify, stepper
from driftproof.enclosure.invariants import FIRST_INTEGRALS
from driftproof.symbolic.algebra.certified import enclose
from tests.enclosure.right_hand_sides import kepler, pendulum
from tests.looping import exactly


def henon_heiles(t, y):
    return np.array([y[2], y[3], -y[0] - 2 * y[0] * y[1], -y[1] - y[0] ** 2 + y[1] ** 2])


def verlet(f, y, h, steps):
    """Times and rows of velocity Verlet, kick, drift, kick, in floats."""
    half, rows = len(y) // 2, [np.array(y, dtype=float)]
    for i in range(steps):
        q, v = rows[-1][:half], rows[-1][half:]
        v = v + h / 2 * f(i * h, rows[-1])[half:]
        q = q + h * v
        v = v + h / 2 * f((i + 1) * h, np.concatenate([q, v]))[half:]
        rows.append(np.concatenate([q, v]))
    return h * np.arange(steps + 1), rows


def test_drift_of_symplectic_euler_is_that_of_its_exact_run():
    """The truncation is known exactly, by powers of the one-step matrix; what floats add is the rest."""
    h, rows = Fraction(1, 8), [(1.0, 0.0)]
    step = stepper(METHODS["symplectic_euler"], float)
    for _ in range(24):
        rows.append(step(lambda q: -q, *rows[-1], float(h)))
    found = certify("y1; -y0", [i / 8 for i in range(25)], rows, method="symplectic_euler",
                    invariants="oscillator_energy")  # fmt: skip
    drift = found.drifts["oscillator_energy"]
    for i in exactly(24, range(1, 25)):
        wanted = OscillatorRun(METHODS["symplectic_euler"], h, i * h, (Fraction(1), Fraction(0))).energy_change
        total = sum(Fraction(x) ** 2 for x in rows[i]) / 2 - Fraction(1, 2)
        with ctx.workprec(200):
            assert abs(drift.truncation[i] - enclose(wanted)) < 1e-50
            assert abs(drift.total[i] - enclose(total)) < 1e-50
            assert abs(drift.rounding[i] - enclose(total - wanted)) < 1e-50
    # Some roundings of u = 1.1e-16 of |y|² = 1 a step; q² + v² - h q v = 1 is kept, so
    # the energy moves by h q v/2 <= h/(4 - 2h) = 1/30.
    assert 0 < max(abs(x) for x in drift.rounding) < 1e-14 < 1e-2 < max(abs(x) for x in drift.truncation) < 1 / 30


CASES = {
    "kepler": (kepler, [1.0, 0.0, 0.0, 1.0625], ["kepler_energy", "angular_momentum"], {"angular_momentum"}),
    "henon_heiles": (henon_heiles, [0.0, 0.1, 0.375, 0.25], ["henon_heiles_energy"], set()),
    "pendulum": (pendulum, [2.0, 0.0], {"energy": lambda y: y[1] ** 2 / 2 - np.cos(y[0])}, set()),
}


@pytest.mark.parametrize("name", CASES)
def test_energy_drifts_and_what_the_method_keeps_is_kept_by_its_exact_run(name):
    f, start, integrals, kept = CASES[name]
    found = certify(f, *verlet(f, start, 1 / 16, 4), method="velocity_verlet", invariants=integrals)
    for integral, drift in exactly(len(integrals), found.drifts.items()):
        assert all(
            (a + b - c).contains(0) for a, b, c in zip(drift.truncation, drift.rounding, drift.total, strict=True)
        )
        assert all(abs(x) < 1e-14 for x in drift.rounding)
        if integral in kept:
            assert all(x.contains(0) and x.rad() < 1e-50 for x in drift.truncation)
        else:
            # Verlet's energy error is of the order of h² = 4e-3 of the forces there.
            assert 1e-7 < max(abs(x) for x in drift.truncation) < 1e-1


def test_total_drift_is_formed_of_the_floats_as_they_are():
    times, rows = verlet(kepler, [1.0, 0.0, 0.0, 1.0625], 1 / 16, 2)
    drift = certify(kepler, times, rows, invariants="kepler_energy").drifts["kepler_energy"]
    assert (drift.truncation, drift.rounding) == (None, None)
    with mpmath.workdps(40):
        energies = []
        for row in (rows[0], rows[-1]):
            x, y, u, v = map(mpmath.mpf, map(float, row))
            energies.append((u * u + v * v) / 2 - 1 / mpmath.sqrt(x * x + y * y))
        with ctx.workprec(128):
            assert abs(drift.total[-1] - arb(mpmath.nstr(energies[1] - energies[0], 35))) < 1e-33


@pytest.mark.parametrize("name", FIRST_INTEGRALS)
def test_known_integral_is_text_of_our_language(name):
    rows = [[0.5, 0.25, 1.0, 0.75], [0.5, 0.25, 1.0, 0.75]]
    with pytest.raises(Refused, match=f"{name} is not conserved: at point 1 the solution has changed it by"):
        certify(lambda t, y: y, [0.0, 0.25], rows, invariants=[name])


TIMES, ROWS = verlet(pendulum, [2.0, 0.0], 1 / 16, 2)
WRONG = {
    r"unknown first integral 'energy'; choose from oscillator_energy": "energy",
    r"first integral e: '.*' is not allowed": {"e": "y7"},
    r"first integral e: 'gamma\(y0\)', column 1: the functions are": {"e": "gamma(y0)"},
    r"first integral e fails on enclosed numbers: IndexError": {"e": lambda y: y[7]},
    r"first integral e returns 2 numbers; it must return one": {"e": lambda y: y},
    r"first integral e is not finite": {"e": "1/y1"},
    r"f converts a number to a float": {"e": lambda y: complex(y[0])},
}


@pytest.mark.parametrize("said", WRONG)
def test_what_is_no_first_integral_is_refused_in_one_line(said):
    with pytest.raises((ValueError, Refused), match=said) as caught:
        certify(pendulum, TIMES, ROWS, invariants=WRONG[said])
    assert "\n" not in str(caught.value)
