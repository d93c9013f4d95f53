"""A method's exact run on a float run's steps: truncation and rounding apart, and points that are no steps refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

from driftproof import METHODS, Facts, OscillatorRun, Refused, certify
from driftproof.enclosure.fields.fields import enclosable
from driftproof.enclosure.runs import exact_runs
from driftproof.enclosure.runs.exact_runs import SCIPY_SOLVERS, exact_step, named_method, plan_of
from driftproof.enclosure.runs.implicit_runs import rational_nodes
from driftproof.enclosure.trajectories import read_trajectory, trajectory_of
from driftproof.symbolic.algebra.certified import enclose, endpoints
from tests.enclosure.mutants import mutant
from tests.enclosure.right_hand_sides import kepler, pendulum, rk4
from tests.enclosure.truncations import slope_of_truncation
from tests.looping import exactly, some
from tests.methods.tables.entries import IMPLICIT

RUNS = Path(__file__).parents[2] / "examples" / "trajectories"


def oscillator(t, y):
    return np.array([y[1], -y[0]])


def classical(f, start, h, steps, number=np.float64):
    """Times and rows of classical RK4 in the numbers of one format."""
    h, rows = number(h), [np.array(start, dtype=number)]
    times = np.array([h * number(i) for i in range(steps + 1)])
    for t in times[:-1]:
        rows.append(rk4(f, t, rows[-1], h))
    return times, np.array(rows)


@pytest.mark.slow
def test_pendulum_of_classical_rk4_to_eight():
    """4096 steps of 1/512, of which the ends are given: binary64, NumPy's sine."""
    end = [float.fromhex(x) for x in ("0x1.f1b40ccdb6f88p+0", "0x1.4854851809a22p-2")]
    found = certify(pendulum, [0.0, 8.0], [[2.0, 0.0], end], method="rk4", h=1 / 512)
    total, parts = found.errors[1][1], (found.split.truncation[1][1], found.split.rounding[1][1])
    assert [x.str(9, radius=False) for x in (total, *parts)] == ["3.79165425e-13", "3.81997297e-13", "-2.83187151e-15"]
    assert (total - sum(parts)).contains(0)
    assert found.split.steps == 4096
    assert "there 3.791654253e-13 = truncation 3.819972968e-13 + rounding -2.831871512e-15 (rk4, st" in found.text()


def mpmath_run(method, times, start):
    """The tableau's steps in 50 digits: nothing of ours but the numbers in the table."""
    with mpmath.workdps(50):
        y, rows = [mpmath.mpf(x) for x in start], []
        for t0, t1 in zip(times, [*times[1:], None], strict=True):
            rows.append(y)
            if t1 is None:
                return rows
            h, slopes = mpmath.mpf(t1) - mpmath.mpf(t0), []
            for row in method.a:
                moved = [sum(mpmath.mpf(float(a)) * k[j] for a, k in zip(row, slopes, strict=False)) for j in (0, 1)]
                q, v = (x + h * m for x, m in zip(y, moved, strict=True))
                slopes.append((v, -mpmath.sin(q)))
            weights = [mpmath.mpf(float(b)) for b in method.b]
            y = [y[j] + h * sum(b * k[j] for b, k in zip(weights, slopes, strict=True)) for j in (0, 1)]


@pytest.mark.parametrize("solver", SCIPY_SOLVERS)
def test_scipy_run_is_split_on_its_own_steps(solver):
    run = read_trajectory(RUNS / f"pendulum_{solver}.csv")
    found = certify(pendulum, run.times, run.states, method=solver)
    witness = mpmath_run(METHODS[SCIPY_SOLVERS[solver]], run.times, run.states[0])
    for i, row in some(enumerate(witness), 20):
        with mpmath.workdps(50), ctx.workprec(200):
            rounding = [arb(x) - arb(mpmath.nstr(z, 45)) for x, z in zip(run.states[i], row, strict=True)]
        for j, wanted in exactly(2, enumerate(rounding)):
            assert abs(found.split.rounding[i][j] - wanted) < 1e-40
            total = found.split.truncation[i][j] + found.split.rounding[i][j]
            assert total.overlaps(found.errors[i][j])
    assert found.split.steps == len(run.times) - 1
    # Twenty to thirty steps, each rounding some u = 1.1e-16 of |y| <= 2.4; the errors are 1e-11 to 1e-4.
    largest = max(abs(x) for row in found.split.rounding for x in row)
    assert 0 < largest < 1e-14 < 1e-3 * found.largest_error


def test_tables_are_those_of_scipy_itself():
    rk = pytest.importorskip("scipy.integrate._ivp.rk")
    for solver in exactly(3, SCIPY_SOLVERS):
        theirs, ours = getattr(rk, solver), named_method(solver)
        n = theirs.n_stages
        assert [float(x) for x in ours.b[:n]] == theirs.B.tolist()
        assert [float(x) for x in ours.c[:n]] == theirs.C[:n].tolist()
        width = min(n, theirs.A.shape[1])  # RK45's table leaves the last column, of zeros, out
        assert [[float(x) for x in row[:width]] for row in ours.a[:n]] == theirs.A[:n, :width].tolist()
        assert all(Fraction(float(x)) == x for row in ours.a for x in row)


def test_scipy_is_split_as_it_comes():
    integrate = pytest.importorskip("scipy.integrate")
    for solver in exactly(3, SCIPY_SOLVERS):
        solution = integrate.solve_ivp(pendulum, (0, 2), [2.0, 0.0], method=solver)
        assert 0 < max(abs(x) for x in certify(solution, pendulum, method=solver).split.rounding[-1]) < 1e-14
        thinned = integrate.solve_ivp(pendulum, (0, 2), [2.0, 0.0], method=solver, t_eval=[0.0, 0.7, 2.0])
        with pytest.raises(Refused, match="or SciPy's t_eval"):
            certify(thinned, pendulum, method=solver)


def test_large_coefficients_that_cancel_in_a_long_step_are_no_other_method():
    """Weights of DOP853 add up to 13 in size, rows of A to 96: balls of 53 bits widen to 1e-12 in a step of 3/4."""
    integrate = pytest.importorskip("scipy.integrate")
    solution = integrate.solve_ivp(kepler, (0, 6), [1.0, 0.0, 0.0, 1.0], rtol=1e-9, method="DOP853")
    assert max(np.diff(solution.t)) > 0.75
    assert abs(certify(solution, kepler, method="DOP853").split.rounding[-1][0]) < 1e-13


def test_binary32_run_is_split():
    found = certify(oscillator, *classical(oscillator, [1, 0], 1 / 8, 40, np.float32), method="rk4")
    # u = 6e-8 a step, 40 of them; the truncation at t = 5 is t h^4/120 = 1e-5.
    assert 1e-8 < max(abs(x) for x in found.split.rounding[-1]) < 40 * 6e-8
    assert 0.9e-5 < max(abs(x) for x in found.split.truncation[-1]) < 1.1e-5


EXPLICIT = ["rk4", "gill4", "velocity_verlet", "yoshida4", "dormand_elmikkawy_prince4", "rk38"]


@pytest.mark.parametrize("method", [*(METHODS[key] for key in EXPLICIT), *IMPLICIT], ids=lambda m: m.key)
def test_exact_step_on_the_oscillator_is_that_of_its_matrix(method):
    h, start = Fraction(1, 8), (Fraction(3, 4), Fraction(-1, 3))
    wanted = OscillatorRun(method, h, h, start).final_state
    with ctx.workprec(256):
        found = exact_step(method, enclosable(oscillator), 2)(tuple(map(enclose, start)), Fraction(7), h)
        for x, y in exactly(2, zip(found, map(enclose, wanted), strict=True)):
            assert x.overlaps(y)
            assert x.rad() < 1e-70


# Rounded tables have their order only down to the residuals.
EXACT_METHODS = [m for m in METHODS.values() if m.explicit and not m.decimal]


@pytest.mark.slow(keep=8)
@pytest.mark.parametrize("method", EXACT_METHODS + IMPLICIT, ids=lambda m: m.key)
def test_order_is_seen_against_the_enclosure(method):
    """The next power of h, 1/64 or, for implicit methods, 1/16, moves the slope; half way to an order would be 0.5."""
    assert abs(slope_of_truncation(method, 32 if method.explicit else 8) - Facts(method).order) < 0.45


@pytest.mark.parametrize(
    ("key", "f", "power"),
    [("rk4", lambda t, y: [3 * t**2], 3), ("RK45", lambda t, y: [5 * t**4], 5), ("DOP853", lambda t, y: [8 * t**7], 8)],
)
def test_stages_know_their_times(key, f, power):
    """y' = p t^(p-1) from 0: a quadrature that order p makes exact, but for u in each of the doubles b, 2^-53 of y."""
    with ctx.workprec(100):
        (y,) = exact_step(named_method(key), f, 1)((arb(0),), Fraction(0), Fraction(1, 2))
        assert abs(y - arb(2) ** -power) < 2.0**-53


def test_kicks_know_their_times():
    """q'' = t from rest: velocity Verlet has v(h) = h²/2 exactly, kicking at t and t + h."""
    with ctx.workprec(100):
        step = exact_step(METHODS["velocity_verlet"], lambda t, y: [y[1], t], 2)
        (_, v) = step((arb(0), arb(0)), Fraction(1), Fraction(1, 2))
        assert v == arb(0.625)


def test_times_that_are_rounded_are_counted_as_rounding():
    """y' = 1 from 0 in ten steps of the double 0.1: rk4 is exact, and so is y = 10 h; t is labelled 1."""
    h = Fraction(0.1)
    found = certify(lambda t, y: [1.0 + 0 * y[0]], [0.0, 1.0], [[0.0], [1.0]], method="rk4", h=0.1)
    assert found.split.truncation[-1][0].contains(0)
    assert not found.errors[-1][0].rad() > 1e-30
    assert abs(found.split.rounding[-1][0]) < 1e-30
    plan = plan_of(lambda t, y: [1.0 + 0 * y[0]], trajectory_of([0.0, 1.0], [[0.0], [1.0]]), "rk4", 0.1)
    assert plan.starts[-1] == 10 * h != 1
    with ctx.workprec(200):
        low, high = endpoints(plan.states([0.0], 200)[-1][0])
        assert low <= 10 * h <= high


def slow(t, y):
    return np.array([y[1], -0.1 * y[1] - y[0]])


TIMES, STATES = classical(pendulum, [2.0, 0.0], 1 / 8, 6)
OFF = STATES.copy()
OFF[4, 0] += 1e-9
AT_AN_EVENT = STATES.copy()
AT_AN_EVENT[-1, 0] += 1e-9
LONG = classical(oscillator, [1.0, 0.0], 1 / 64, 256)
# The sixth of two hundred steps, which is not among the 64 that are looked at first, from a state that is spoilt.
SPOILT = [*LONG[1][:6], *classical(oscillator, [0.99, -0.08], 1 / 64, 194)[1]]
REFUSED = {
    r"y\[1\] is not one step of gauss3 from y\[0\]: off by 1\.8e-07, where 6\.3e-08 is allowed for": (
        pendulum, TIMES, STATES, "gauss3"),
    r"y\[1\] is not one step of rk38 from y\[0\]: off by 8e-08, where 4\.8e-13 is .*: 6 of 6 looked at\): another m": (
        pendulum, TIMES, STATES, "rk38"),
    r"y\[4\] is not one step of rk4 from y\[3\]: off by 1e-09.* 2 of 6 .* fit, as if y\[4\] alone were changed; larg": (
        pendulum, TIMES, OFF, "rk4"),
    r"y\[131\] is not one step of rk4 from y\[130\].* 2 of 256 looked at.* as if y\[131\] alone were changed": (
        oscillator, LONG[0], [*LONG[1][:131], LONG[1][131] + 1e-9, *LONG[1][132:]], "rk4"),
    r"y\[131\] is not one step of rk4 from y\[130\].* 1 of 255 looked at\): 2 steps fit there, as if rows were": (
        oscillator, np.delete(LONG[0], 131), np.delete(LONG[1], 131, axis=0), "rk4"),
    r"y\[3\] is not one step of rk4 from y\[2\]: off by 1e-12.* 1 of 6 looked at\): another method": (
        lambda t, y: 0 * y, [0, 1, 2, 9, 10, 11, 12], [[1.0]] * 3 + [[1 + 1e-12]] * 4, "rk4"),
    r"y\[6\] is not one step of rk4 from y\[5\]: off by 1e-09.* the others fit: if an event ended the run": (
        pendulum, TIMES, AT_AN_EVENT, "rk4"),
    r"velocity_verlet needs y = \(q, v\) with q' = v and v' independent": (slow, TIMES, STATES, "velocity_verlet"),
    r"y\[1\] is not 2 steps of rk38 from y\[0\]: off by 1\.6e-07, where 1e-12 is allowed for": (
        pendulum, TIMES[::2], STATES[::2], "rk38", 1 / 8),
    r"y\[1\] is not 100 steps of forward_euler from y\[0\]: off by 0\.0042, where 3\.\de-11 is allowed": (
        oscillator, LONG[0][::64], LONG[1][::64], "forward_euler", "1/100"),
    r"y\[6\] is not one step of rk4 from y\[5\]: off by 0\.0": (
        oscillator, LONG[0][:201], SPOILT, "rk4"),
    r"t\[1\] = 0\.125 is not the first time plus a multiple of h = 0\.09": (pendulum, TIMES, STATES, "rk4", 0.09),
    r"two of the times are the same multiple of h = 1\.0": (pendulum, [0, 1e-5], STATES[:2], "rk4", 1),
    r"h is nan; it must be positive and finite": (pendulum, TIMES, STATES, "rk4", float("nan")),
}  # fmt: skip


@pytest.mark.parametrize("said", REFUSED)
def test_what_is_no_run_of_the_method_is_refused_in_one_line(said):
    f, times, states, method, *h = REFUSED[said]
    with pytest.raises(Refused, match=said) as caught:
        certify(f, times, states, method=method, h=h[0] if h else None)
    assert "\n" not in str(caught.value)
    other = isinstance(caught.value, exact_runs.NotItsSteps)
    assert other == ("looked at" in said or " off by " in said)
    assert not other or caught.value.total.record()["unsplit"] in str(caught.value)


def test_steps_in_which_rounding_may_have_grown_too_much_to_be_told_from_others_are_said_not_to_be_checked():
    """y'' = y from (1, -1) is e^-t, and rounding grows as e^t: in 30 by 1e13, and its bound as well."""
    saddle = lambda t, y: np.array([3 * y[1], y[0] / 3])
    ends = [each[::1920] for each in classical(saddle, [1, -1 / 3], 1 / 64, 1920)]
    found = certify(saddle, *ends, method="rk4", h=1 / 64)
    assert found.record()["split"]["unchecked"] == [0]
    assert "not checked to be its steps, as rounding may have grown too much: 1 of 1 interval, t" in found.text()


def test_steps_in_binary32_are_not_taken_for_those_of_an_implicit_method_of_the_same_order():
    """Stages that a code solves for may be off by much in binary32; what is off so far is told from nothing."""
    states = [np.float32(1)]
    for _ in range(16):
        states.append(states[-1] - states[-1] / np.float32(8))
    found = [
        certify(lambda t, y: -y, np.arange(17.0) / 8, np.array(states)[:, None], method=key) for key in BOTH_EULERS
    ]
    assert [len(each.record()["split"].get("unchecked", ())) for each in found] == [0, 16]


BOTH_EULERS = ("forward_euler", "backward_euler")


def test_method_that_is_none_is_bad_input():
    with pytest.raises(ValueError, match="unknown method 'rk5'; did you mean"):
        certify(pendulum, TIMES, STATES, method="rk5")
    with pytest.raises(ValueError, match="SciPy's BDF changes its formula between steps"):
        certify(pendulum, TIMES, STATES, method="BDF")


def test_as_many_steps_as_are_too_many_are_refused(monkeypatch):
    monkeypatch.setattr("driftproof.enclosure.runs.exact_runs.MOST_STEPS_EXACTLY", 6)
    assert certify(pendulum, TIMES, STATES, method="rk4", h=1 / 8).split.steps == 6
    monkeypatch.setattr("driftproof.enclosure.runs.exact_runs.MOST_STEPS_EXACTLY", 5)
    with pytest.raises(Refused, match=r"^6 steps are too many to run exactly; at most 5$"):
        certify(pendulum, TIMES, STATES, method="rk4", h=1 / 8)


def test_exact_run_that_is_not_finite_or_lost_in_its_balls_is_made_again_with_more_bits_or_refused(monkeypatch):
    """Of y' = sqrt(y - 1) from 1 + 2^-20, a ball of 16 bits holds 1."""
    for each in ("BITS_OF_EXACT_RUN", "MOST_BITS_OF_EXACT_RUN"):
        monkeypatch.setattr(f"driftproof.enclosure.certify.{each}", 53)
    with pytest.raises(Refused, match="the exact run of rk4 cannot be found to twelve digits with 53 bits"):
        certify(pendulum, TIMES, STATES, method="rk4")
    monkeypatch.setattr("driftproof.enclosure.certify.MOST_BITS_OF_EXACT_RUN", 128)
    f = lambda t, y: np.sqrt(y - 1)
    times, states = classical(f, [1 + 2.0**-20], 1 / 64, 2)
    monkeypatch.setattr("driftproof.enclosure.certify.BITS_OF_EXACT_RUN", 16)
    assert certify(f, times, states, method="rk4").split.bits == 128
    monkeypatch.setattr("driftproof.enclosure.certify.MOST_BITS_OF_EXACT_RUN", 16)
    with pytest.raises(Refused, match="with 16 bits: the exact run of rk4 is not finite after t = "):
        certify(f, times, states, method="rk4")


@pytest.mark.slow
def test_long_run_gets_as_many_bits_as_its_balls_widen(monkeypatch):
    """Of y' = -20y with h = 1/8 a ball widens by 2.72 bits a step, log2(R(5/2)): 400 steps need over 1024 bits."""
    monkeypatch.setattr("driftproof.enclosure.certify.BITS_OF_EXACT_RUN", 16)
    made, step = [], exact_runs.exact_step
    counted = lambda *given: lambda *where: made.append(ctx.prec) or step(*given)(*where)
    monkeypatch.setattr(exact_runs, "exact_step", counted)
    found = certify(lambda t, y: -20 * y, *classical(lambda t, y: -20 * y, [1.0], 0.125, 400), method="rk4")
    assert found.split.bits == 2048
    assert made.count(16) < 16  # given up when the balls are as wide as the solution
    # R(-5/2) = 1 - 5/2 + 25/8 - 125/48 + 625/384 = 249/384, to the 400th power; the solution is e^-1000.
    assert abs(found.split.truncation[-1][0] / (arb(83) / 128) ** 400 - 1) < 1e-12


def same_as_rk4(module):
    """Truncation of seven steps is that of the module as it is: its rounding is below 1e-14."""
    plan = module.plan_of(pendulum, trajectory_of(TIMES, STATES), "rk4")
    return all(abs(x - float(z)) < 1e-14 for row, rows in zip(STATES, plan.states(STATES[0].tolist(), 128), strict=True)
               for x, z in zip(row, rows, strict=True))  # fmt: skip


WRONG = {
    "the state is not carried on": ("y = step(y, t + k * h, h)", "y = step(tuple(arb(x) for x in start), t, h)"),
    "half the step": ("y = step(y, t + k * h, h)", "y = step(y, t + k * h, h / 2)"),
}


@pytest.mark.parametrize("name", ["right", *WRONG])
def test_wrong_exact_run_is_caught(name):
    assert same_as_rk4(mutant("exact_runs", *([WRONG[name]] if name in WRONG else []))) == (name == "right")


def test_a_run_of_radau_at_a_loose_tolerance_has_its_cause_named_and_another_method_has_not():
    """SciPy stops Newton's method at min(0.03, sqrt(rtol)) of the tolerance: y is off its exact step by as much."""
    integrate = pytest.importorskip("scipy.integrate")
    prey = lambda t, y: [1.1 * y[0] - 0.4 * y[0] * y[1], 0.1 * y[0] * y[1] - 0.4 * y[1]]
    runs = {name: integrate.solve_ivp(prey, (0, 5), [10, 10], method=name) for name in ("Radau", "RK45")}
    with pytest.raises(
        Refused, match="or SciPy's Radau stopped Newton's method early, as with rtol = 3e-05: take 1e-6"
    ):
        certify(prey, runs["Radau"], method="Radau")
    with pytest.raises(Refused, match=r"is not one step of radau_iia3.*t_eval; largest error"):
        certify(prey, runs["RK45"], method="Radau")
    fine = integrate.solve_ivp(prey, (0, 5), [10, 10], method="Radau", rtol=1e-6, atol=1e-6)
    assert certify(prey, fine, method="Radau").split is not None


SWITCHED = {
    "rk4": Fraction(9, 10) + Fraction(1, 60) * (1 + 2 + 2 + 3) + 3,  # the last stage before t = 1 is at 1
    "radau_iia2": Fraction(9, 10) + Fraction(1, 10) * (Fraction(3, 4) + Fraction(1, 4) * 3) + 3,
    "implicit_midpoint": Fraction(1) + 3,
}


@pytest.mark.parametrize("key", SWITCHED)
def test_a_stage_at_a_jump_is_told_from_one_beside_it_where_times_are_no_doubles(key):
    y, h = (arb(0),), Fraction(1, 10)
    with ctx.workprec(128):
        step = exact_step(METHODS[key], lambda t, y: [1 if t < 1 else 3], 1)
        for k in range(20):
            y = step(y, k * h, h)
        assert abs(y[0] - enclose(SWITCHED[key])) < 1e-30


def test_nodes_are_known_where_all_are_rational():
    assert sorted(rational_nodes(METHODS["rk4"])) == [0, Fraction(1, 2), 1]
    assert sorted(rational_nodes(METHODS["velocity_verlet"])) == [0, 1]
    assert rational_nodes(METHODS["nystrom4"])
    assert [rational_nodes(METHODS[key]) for key in ("gauss2", "yoshida4")] == [[], []]
