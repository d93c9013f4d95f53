"""Certificates of float trajectories: the error that a formula gives, a line to assert it, and refusals by rule."""

from __future__ import annotations

import math
import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

from driftproof import Refused, assert_accurate, certify
from driftproof.enclosure import certify as module
from driftproof.support import progress
from tests.enclosure.right_hand_sides import pendulum, rk4
from tests.looping import exactly

TIMES = np.linspace(0.0, 2.0, 5)


def decay(t, y):
    return -0.1 * y


def classical(f, t, y, steps=20):
    """Rows of the classical fourth-order method, some steps from each time to the next."""
    rows = [np.asarray(y, dtype=float)]
    for begin, end in pairwise(t):
        h, y = (end - begin) / steps, rows[-1]
        for k in range(steps):
            y = rk4(f, begin + k * h, y, h)
        rows.append(y)
    return np.array(rows)


def test_errors_are_those_of_the_formula():
    y = classical(decay, TIMES, [1.0])
    found = certify(decay, TIMES, y)
    with ctx.workprec(256):
        for (error,), t, (value,) in zip(found.errors, TIMES, y, strict=True):
            wanted = arb(value) - (-arb(0.1) * arb(t)).exp()
            assert abs(error - wanted) < 2.0**-100
            assert error.overlaps(wanted)
    assert found.doubles == (-0.1,)
    assert found.digits >= 11
    assert 0 < found.largest_error < 1e-11


def test_solutions_of_libraries_are_taken_by_their_names():
    y = classical(decay, TIMES, [1.0, 2.0])
    alone = certify(decay, TIMES, y).errors
    for solution in (SimpleNamespace(t=TIMES, y=y.T), SimpleNamespace(ts=TIMES, ys=y)):
        for found in (certify(decay, solution), certify(solution, decay)):
            assert [str(x) for row in found.errors for x in row] == [str(x) for row in alone for x in row]


def test_model_with_a_state_of_its_own_is_a_function():
    class Model:
        t, y, ts, ys = 0.0, 1.0, None, None

        def __call__(self, t, y):
            return -0.1 * y

    y = classical(decay, TIMES, [1.0])
    for given in ((Model(), TIMES, y), (Model(), SimpleNamespace(t=TIMES, y=y.T))):
        assert certify(*given).largest_error < 1e-11


def test_text_stands_for_a_function_with_exact_numbers():
    y = classical(decay, TIMES, [1.0])
    found = certify("-0.1*y0", TIMES, y)
    assert found.doubles == ()
    with ctx.workprec(256):
        t = arb(TIMES[-1])
        assert found.errors[-1][0].overlaps(arb(y[-1, 0]) - (-t / 10).exp())
        assert not found.errors[-1][0].overlaps(arb(y[-1, 0]) - (-arb(0.1) * t).exp())


def test_the_run_of_a_solver_that_failed_is_not_asserted_and_its_certificate_says_so():
    integrate = pytest.importorskip("scipy.integrate")
    lost = integrate.solve_ivp(lambda t, y: -0.1 * y if t < 1 else [np.nan], (0, 2), [1.0], rtol=1e-9)
    said = r"the solver failed: Required step size is less than spacing between numbers; its run ends at t = (0\.9|1)"
    with pytest.raises(AssertionError, match=said):
        assert_accurate(lost, decay, 1e-6)
    assert_accurate((lost.t, lost.y), decay, 1e-6)
    for words in exactly(2, ((found := certify(decay, lost)).text(), found.record()["said"])):
        assert re.search(said, words)


def test_accuracy_is_asserted_with_the_worst_point():
    y = classical(decay, TIMES, [1.0])
    y[3] += 1e-6
    assert_accurate([TIMES, y], decay, 1.1e-6)
    with pytest.raises(AssertionError, match=r"off by 9\.99\d+e-7|off by 1\.0000\d+e-6") as caught:
        assert_accurate((TIMES, y), decay, 9e-7)
    assert "component 0 at t = 1.5, point 3 of 0 to 4 (proved)" in str(caught.value)
    with pytest.raises(
        AssertionError, match=r"rtol = 1e-07 and atol = 1e-08 allow an error of 9\.61e-08 per step there; .* 10\.4 t"
    ):
        assert_accurate((TIMES, y), decay, 9e-7, rtol=1e-7, atol=1e-8)
    with pytest.raises(AssertionError, match=r"rtol = 1e-07 allows an error of 8\.61e-08 per step there"):
        assert_accurate((TIMES, y), decay, 9e-7, rtol=1e-7)


REMOVABLE = {
    "exprel": (
        lambda t, y: [1 + y[0] / (1 - math.exp(-y[0]))],
        lambda t, y: [1 + 1 / pytest.importorskip("scipy.special").exprel(-y[0])],
        lambda y: y / (1 - mpmath.exp(-y)),
    ),
    "sinc": (
        lambda t, y: [1 + np.sin(np.pi * y[0]) / (np.pi * y[0])],
        lambda t, y: [1 + np.sinc(y[0])],
        lambda y: mpmath.sinc(mpmath.pi * y),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", REMOVABLE)
def test_a_removable_0_by_0_is_named_and_enclosed_if_it_is_written_as_a_function(name):
    """y crosses 0 smoothly, where Hodgkin's and Huxley's rates have such quotients."""
    quotient, written, wanted = REMOVABLE[name]
    run = [0.0, 0.5, 1.0], [[-1.0], [-0.1], [1.0]]
    said = rf"^f divides 0, or nearly 0, by 0 near t = 0\.[56]\d*; where that is no pole.*{name}"
    with pytest.raises(Refused, match=said):
        certify(quotient, *run)
    with pytest.raises(Refused, match=said), np.errstate(all="ignore"):
        certify(lambda t, y: [np.sin(t - 0.5) / np.subtract(t, 0.5)], *run)
    found = certify(written, *run)
    with mpmath.workdps(30), ctx.workprec(128):
        rate = lambda t, y: [1 + (wanted(y[0]) if y[0] else 1)]
        true = mpmath.odefun(rate, 0, [mpmath.mpf(-1)], tol=mpmath.mpf("1e-22"))(1)[0]
        assert abs(found.errors[2][0] - (1 - arb(mpmath.nstr(true, 28)))) < 1e-18


@pytest.mark.slow
def test_a_kink_is_named_and_how_to_cut_there_but_a_pole_is_none():
    kink = (
        r"^f compares numbers that are equal near t = 1;.* kink or jump .* follow it; certify the points before it and"
    )
    for f in (lambda t, y: -np.sign(y), lambda t, y: np.where(y > 0, -1.0, 1.0)):
        with pytest.raises(Refused, match=kink):
            certify(f, [0.0, 2.0], [[1.0], [0.0]])
    with pytest.raises(Refused, match=r"^f or the solution has a pole, or f is not smooth, near t = 1\.57"):
        certify(lambda t, y: 1 + y * y, [0.0, 2.0], [[0.0], [1.0]])


def test_components_of_different_size_have_digits_and_tolerances_of_their_own():
    """B of Robertson's kinetics is 1e-5 of A: 3 digits of the state are one of B. A component that is 0 has none."""
    rows = [[1.0, 1e-5, 0.0], [0.5001, 0.5e-5 + 1e-6, 1e-9]]
    fall = lambda t, y: [-y[0] * math.log(2), -y[1] * math.log(2), 0 * y[2]]
    found = certify(fall, [0.0, 1.0], rows)
    assert (found.digits, found.digits_of) == (3, (4, 1, None))
    line = "one by one, component 1 is the worst: 1 correct digit, relative to its own largest size; off by 1.00000"
    assert f"\n{line}" in found.text()
    assert found.record()["digits_of"] == [4, 1, None]
    even = certify(fall, [0.0, 1.0], [rows[0], [0.5001, 0.5e-5 + 1e-10, 0.0]])
    assert (even.digits, even.digits_of) == (3, (4, 4, None))
    assert "one by one" not in even.text()
    assert_accurate(([0.0, 1.0], rows), fall, 1e-3)
    assert_accurate(([0.0, 1.0], rows), fall, [1e-3, 2e-6, 1e-8])
    with pytest.raises(AssertionError, match=r"^off by 1.00\d+e-6, more than 1e-07: component 1 at t = 1, point 1 of"):
        assert_accurate(([0.0, 1.0], rows), fall, np.array([1e-3, 1e-7, 1e-8]))
    with pytest.raises(AssertionError, match=r"^off by 1.00\d+e-6, more than 1e-12: component 1"):
        assert_accurate(([0.0, 1.0], rows), fall, [1e-5, 1e-12, 1e-8])
    for wrong, words in (([1e-3, 1e-3], "one for each of the 3 comp"), ([1, 1, -1], "must be a number >= 0")):
        with pytest.raises(ValueError, match=words):
            assert_accurate(([0.0, 1.0], rows), fall, wrong)


def test_more_bits_are_taken_where_the_radius_is_not_small(monkeypatch):
    monkeypatch.setattr(module, "BITS_AT_FIRST", 32)
    found = certify(decay, TIMES, classical(decay, TIMES, [1.0]))
    assert found.bits in (64, 128)
    monkeypatch.setattr(module, "MOST_DOUBLINGS", 0)
    with pytest.raises(Refused, match="cannot be computed to twelve digits with 32 bits"):
        certify(decay, TIMES, classical(decay, TIMES, [1.0]))


# Where each attempt refused, and how many there are: a tenth of the way is too little, and the fifth is the last.
@pytest.mark.parametrize(
    ("refused_at", "tried"),
    [((None,), 1), ((10,), 1), ((11,), 1), ((12, 13), 2), ((12, 14, 15), 3), ((12, 14, 16, 18, 20), 5)],
)
def test_more_bits_are_taken_where_they_lead_further(refused_at, tried, monkeypatch):
    seen = []

    def enclose(f, start, times, bits):
        seen.append(bits)
        raise Refused("no further", refused_at[len(seen) - 1])

    monkeypatch.setattr(module, "enclose_solution", enclose)
    monkeypatch.setattr(module, "FURTHER", Fraction(1, 10))
    with pytest.raises(Refused, match="no further"):
        certify(decay, [10.0, 20.0], [[1.0], [0.4]])
    assert seen == [128 * 2**k for k in range(tried)]


def test_two_threads_at_once_have_the_answers_of_one_alone():
    """With 40 switches a millisecond; FLINT has one precision, and the first f is refused on the way to its jump."""
    rubbed = lambda t, y: [y[1], -y[0] - 0.1 * np.sign(y[1])]
    runs = [(rubbed, [0.0, 1.0], [[1.0, 0.0], [0.6, -0.8]]), (pendulum, [0.0, 5.0], [[2.0, 0.0], [-1.2, -1.2]])]
    answer = lambda run: certify(*run).text()
    before = sys.getswitchinterval()
    sys.setswitchinterval(25e-6)
    try:
        with ThreadPoolExecutor(2) as threads:
            assert [*threads.map(answer, runs * 5)] == [*map(answer, runs)] * 5
    finally:
        sys.setswitchinterval(before)


def test_trajectory_without_error_has_every_digit():
    found = certify(lambda t, y: 0 * y, [0.0, 1.0], [[1.0], [1.0]])
    assert (found.digits, float(found.largest_error)) == (17, 0.0)


class Thermostat:
    """A heater that goes on below 1 and off above 2: between them its rate depends on the past."""

    heats = False

    def __call__(self, t, y):
        self.heats = y[0] < 2 if self.heats else y[0] < 1
        return [3.0 - y[0] if self.heats else -y[0]]


def test_f_that_takes_the_time_last_is_refused_and_the_run_backwards_that_the_refusal_shows_is_enclosed():
    for f in (lambda y, t: -y, lambda x, time, k=1: -k * x):
        with pytest.raises(ValueError, match=r"f takes \(\w, t\w*\), .*: give lambda t, y: f\(y, t\)"):
            certify(f, [0, 1], [[1.0], [0.5]])
        assert certify(lambda t, y, f=f: f(y, t), [0, 1], [[1.0], [0.5]]).largest_error > 0.1
    t = np.array([1.0, 0.0])
    assert float(certify(lambda s, y: -decay(-s, y), -t, [[1.0], [2.0]]).largest_error) == pytest.approx(
        2 - np.exp(0.1)
    )


def smooth_in_floats_only(t, y):
    return np.asarray(y * 0.5) if isinstance(y[0], float) else y


def three_compartments(t, y):
    s, i, r = y
    return [-s * i, s * i - r, r]


REFUSED = {
    r"times must increase, but t\[2\] = 1.0 is not above t\[1\] = 1.0": (decay, [0, 1, 1], [[1], [1], [1]]),
    r"t\[1\] = 0\.0 is not above t\[0\] = 1\.0; of a run backwards give .*-f\(-s, y\)": (decay, [1, 0], [[1], [2]]),
    r"t has the shape \(1,\); it must be a row of at least two times": (decay, [0.0], [[1.0]]),
    r"y has the shape \(3, 1\); it must have a row for each of 2 times": (decay, [0, 1], [[1], [1], [1]]),
    r"y\[1, 0\] is nan": (decay, [0, 1], [[1.0], [np.nan]]),
    r"y has the type complex128; give floats of at most 64 bits": (decay, [0, 1], [[1j], [1.0]]),
    r"list has neither \.t and \.y nor \.ts and \.ys; give t and y as two arguments": (decay, [0, 1], None),
    r"f in floats is 0\.5 at t = 0\.0, component 0, but its enc": (smooth_in_floats_only, [0, 1], [[1.0], [1.5]]),
    r"y is not a table of numbers: its rows differ in length": (decay, [0, 1], [[1], [1, 2]]),
    r"f fails in floats at t = 0\.0, on 1 components: KeyError: 'k'": (lambda t, y: {}["k"], [0, 1], [[1.0], [1.0]]),
    r"f fails in floats at t = 0\.0, on 3 components: TypeError: .* takes 2 ": (
        lambda t, y: (lambda q, v: [v, -q])(*y), [0, 1], [[1.0, 2.0, 3.0]] * 2),
    r"f fails in floats at t = 0\.0, on 2 components: IndexError": (  # for a number in y, not for how many there are
        lambda t, y: [(0.0, 1.0)[int(x)] for x in y], [0, 1], [[1.0, 2.0]] * 2),
    r"f fails in floats at t = 0\.0, on 1 components: ZeroDivisionError": (
        lambda t, y: [1 / int(t)], [0, 1], [[1.0], [1.0]]),
    r"f compares numbers that are equal near t = 0; .*it may touch or follow it; as it starts there": (
        lambda t, y: np.abs(y), [0, 1], [[0.0], [0.0]]),
    r"has a pole, or .* near t = 1; if f jumps there, certify": (lambda t, y: y**2, [0.0, 1.5], [[1.0], [5.0]]),
    r"f is 1\.5 at t = 1\.0, component 0, but -1\.5 in a second call": (
        Thermostat(), [0, 1, 2], [[0.5], [1.5], [2.5]]),
    r"f or its derivative is not finite at t = 0": (lambda t, y: -np.arcsin(y), [0, 1], [[1.0], [0.5]]),
    r"201 components are too many; at most 200 can be enclosed": (lambda t, y: -y, [0, 1], np.ones((2, 201))),
}  # fmt: skip
BAD_INPUT = {
    r"f is not a right-hand side but a NoneType; give f\(t, y\) or its text": (None, [0, 1], [[1], [1]]),
    r"^t is text; give t and y as arrays of numbers, or in their place the path of one file$": (decay, "t", "y"),
    r"f fails on the 2 components that it is given, not on 3; ValueError: not enough values to unpack .*3, got 2": (
        three_compartments, [0, 1], [[0.9, 0.1]] * 2),
    r"f fails on the 4 components that it is given, not on 3; ValueError: too many": (
        three_compartments, [0, 1], np.ones((2, 4))),
    r"f fails on the 1 components that it is given, not on 2; IndexError": (
        lambda t, y: [y[1], -y[0]], [0, 1], [[1.0], [1.0]]),
    r"f has 2 components, but the trajectory has 3": ("y1; -y0", [0, 1], [[1.0, 2.0, 3.0]] * 2),
    r"f returns 2 numbers for 1 components": (lambda t, y: [1.0, 2.0], [0, 1], [[1.0], [1.0]]),
    r"f returns 3 numbers for 1 components": (
        lambda t, y: [1.0] * 3 if isinstance(y[0], float) else y, [0, 1], [[1.0], [1.0]]),
}  # fmt: skip


@pytest.mark.parametrize("said", REFUSED | BAD_INPUT)
def test_what_cannot_be_proved_is_refused_in_one_line_and_bad_input_as_such(said):
    with pytest.raises(Refused if said in REFUSED else ValueError, match=said) as caught:
        certify(*(REFUSED | BAD_INPUT)[said])
    assert "\n" not in str(caught.value)


def test_who_waits_at_a_terminal_is_told_that_something_is_done(monkeypatch):
    """f does not answer before there is a line: of a large system one step may take many seconds."""
    outer, inner = os.openpty()
    monkeypatch.setattr(progress, "SILENCE", 0.01)
    said = []
    with os.fdopen(inner, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        certify(lambda t, y: -y if said else said.append(os.read(outer, 1000)) or -y, [0.0, 1.0], [[1.0], [0.4]])
    assert said[0].startswith(b"certify: working, 0 s (Ctrl-C ends it)")


def test_tolerance_within_the_ball_of_the_error_is_refused():
    assert module.within(SimpleNamespace(largest_error=arb(1)), 1.0)
    assert module.within(SimpleNamespace(largest_error=arb(0.25)), Fraction(1, 3))
    assert module.within(SimpleNamespace(largest_error=arb(0.25)), np.float32(0.25))
    assert not module.within(SimpleNamespace(largest_error=arb(0.5)), Fraction(1, 3))
    with pytest.raises(Refused, match=r"the largest error is 1\.0+, too close to the tolerance 1\.0 to decide"):
        module.within(SimpleNamespace(largest_error=arb(1, 2.0**-40)), 1.0)


@pytest.mark.parametrize("tolerance", [-1.0, float("nan"), "1e-3", np.array([1e-3, 1e-3])], ids=str)
def test_tolerance_has_to_be_a_size(tolerance):
    with pytest.raises(ValueError, match="must be a number >= 0"):
        assert_accurate((TIMES, TIMES), decay, tolerance)


def test_pendulum_of_scipy_agrees_with_jacobi_functions():
    integrate = pytest.importorskip("scipy.integrate")
    solution = integrate.solve_ivp(pendulum, (0, 10), [2.0, 0.0], method="DOP853", rtol=1e-10, atol=1e-13)
    found = certify(pendulum, solution)
    with mpmath.workdps(40), ctx.workprec(128):
        k = mpmath.sin(1)
        true = 2 * mpmath.asin(k * mpmath.ellipfun("sn", mpmath.ellipk(k * k) + 10, m=k * k))
        error = arb(float(solution.y[0, -1])) - arb(mpmath.nstr(true, 38))
        assert abs(found.errors[-1][0] - error) < 1e-27
    # SciPy 1.17 is off by -2.75126169e-11 there, ten times its rtol being allowed at each step.
    assert 1e-13 < found.largest_error < 1e-9
    with pytest.raises(AssertionError, match="proved"):
        assert_accurate(solution, pendulum, 1e-13)


def test_a_rate_that_underflows_is_no_other_function():
    run = [0.0, 1.0], [[1e-200], [1e-200]]
    assert certify(lambda t, y: y * y, *run).largest_error < 1e-230  # y^2 is 0 in floats
    with pytest.raises(Refused, match=r"f in floats is 0\.0 at t = 0\.0, component 0, but its enclosure is 1\.0+e-300"):
        certify(lambda t, y: y * 1e-100 * (not isinstance(y[0], float)), *run)


def oscillator_with(t, y, w):
    """A function whose parameter has no default."""
    return [y[1], -w * y[0]]


def test_a_problem_with_a_function_is_certified_and_a_run_of_another_start_or_end_is_told_so():
    times = np.linspace(0, 1, 11)
    rows = np.array([np.cos(2 * times), -2 * np.sin(2 * times)]).T
    given = {"function": oscillator_with, "parameters": {"w": 4}, "start": [1, 0], "end": 1}
    by_rates = {"rates": ["y1", "-4 * y0"], "start": [1.00001, 0], "end": 1.0}
    for problem in (given, by_rates):
        assert certify(problem, times, rows).largest_error < 1e-14
        assert certify(problem, times, rows).said == ""
    said = lambda problem, t=times: certify({**given, **problem}, t, rows).said
    assert said({"start": [1.001, 0]}) == "the run starts from 1, 0, the problem from 1.001, 0"
    assert said({"start": [0, 1]}) == "the run starts from 1, 0, the problem from 0, 1: are columns exchanged?"
    assert said({"end": 2}) == "the run ends at t = 1, the problem at 2"
    assert said({}, times + 0.5) == "the run starts at t = 0.5, the problem at 0"
    assert certify({**given, "parameters": {"w": 4.5}}, times, rows).digits == 0
    with pytest.raises(ValueError, match="missing 1 required positional argument: 'w'"):
        certify({"function": oscillator_with}, times, rows)


def reset(t, y):
    v = y[0]
    if v >= 2:
        y[0] = -1.0
    return [v * v]


def test_f_that_writes_into_its_state_is_told_so():
    """y' = y² from 1 is 1/(1 - t), 2 at 1/2, and has its pole at 1."""
    told = "f writes into its y, from which a solver may go on; the solution that is enclosed does not"
    assert str(certify(reset, [0.0, 0.75], [[1.0], [4.0]])).endswith(told)
    assert told not in str(certify(reset, [0.0, 0.25], [[1.0], [1.5]]))
    with pytest.raises(Refused, match=f"has a pole.*; {told}$"):
        certify(reset, [0.0, 1.5], [[1.0], [1.5]])
