"""verify, from end to end: right steppers pass, wrong ones fail with the name of what they are and an example."""

import ast
import json
import re
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import driftproof
from driftproof.blackbox.identify import identify
from driftproof.blackbox.judging.agreement import Domain
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.verify import assert_verified, verify
from driftproof.cli import main
from driftproof.methods.catalogue import METHODS
from driftproof.support.processes import Session
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.extension_steppers import extension_step, first_and_last_exchanged
from tests.blackbox.handwritten_steppers import rk4 as rk4_in_a_field
from tests.blackbox.implicit_steppers import (
    G,
    all_at_once,
    broyden,
    fixed_point,
    newton,
    one_by_one,
    simplified,
    table,
    with_entry,
)
from tests.blackbox.pair_steppers import pair_step
from tests.blackbox.test_identify import rk4, rk38, velocity_verlet
from tests.blackbox.transcripts import checksum

FEW = 50


def replaced_weight(key, place, value):
    """The table of a method in floats, with another weight."""
    rows, weights, nodes = codes.floats(METHODS[key])
    return rows, [value if i == place else x for i, x in enumerate(weights)], nodes


def symplectic_euler(q, v, h):
    v = v - h * q
    return q + h * v, v


def backward_euler(q, v, h):
    v = (v - h * q) / (1 + h * h)
    return q + h * v, v


@pytest.mark.parametrize(
    ("step", "method"),
    [
        (rk4, "rk4"),
        (rk38, METHODS["rk38"]),
        (velocity_verlet, "velocity_verlet"),
        (symplectic_euler, "symplectic_euler"),
    ],
)
def test_right_steppers_pass(step, method):
    report = verify(step, method, examples=FEW)
    assert report.passed
    assert "to roundoff" in report.verdict


def in_fractions(f, t, y, h):
    """RK4 in exact arithmetic, which returns fractions."""
    exact = lambda at, z: np.array([Fraction(float(x)) for x in f(float(at), [float(x) for x in z])])
    return codes.rk4(exact, Fraction(t), np.array([Fraction(float(x)) for x in y]), Fraction(h))


def generated(f, t, y, h):
    """A generator of (t, y), the start first."""
    while True:
        yield t, y
        t, y = t + h, codes.rk4(f, t, y, h)


@pytest.mark.parametrize(
    ("step", "method"), [(in_fractions, "rk4"), (generated, "rk4"), (codes.velocity_verlet_in_time, "velocity_verlet")]
)
def test_unusual_right_code_is_no_false_alarm(step, method):
    report = verify(step, method, examples=FEW, isolate=False)
    assert report.passed, report.text()


def test_a_code_of_one_number_passes_as_that():
    report = verify(codes.rk4_of_one_number, "rk4", examples=FEW, isolate=False)
    assert report.passed
    assert report.verdict.startswith("is rk4 of one number: its coefficients are, and the method's own step on a")
    assert not verify(codes.rk4_of_one_number, "rk38", examples=FEW, isolate=False).passed


@pytest.mark.parametrize(
    ("step", "words"),
    [
        (lambda f, t, y, h: {"y": y}, "gives no answer: it returns dict"),
        (lambda f, t, y, h: f(t, 1j * y), "gives no answer: it asks for its right-hand side at ndarray with entries"),
    ],
)
def test_what_gives_no_answer_is_not_said_to_be_another_method(step, words):
    assert verify(step, "rk4", examples=FEW, isolate=False).verdict.startswith(words)


def test_memory_is_named_where_only_rounding_shows_it():
    def remembering(f, t, y, h, kept={}):  # noqa: B006
        moved = h * f(t, y) + (kept["left"] if np.shape(kept.get("left")) == np.shape(y) else 0)
        kept["left"] = moved - ((y + moved) - y)
        return y + moved

    report = verify(remembering, "forward_euler", examples=FEW, isolate=False)
    assert report.verdict == "is not forward_euler: its coefficients are, but the answer depends on the call before"


def test_what_becomes_of_arguments_and_answers_is_a_remark_where_every_step_is_right():
    kept = np.empty(2)

    def one_buffer(f, t, y, h):
        end = codes.rk4(f, t, y, h)
        if len(y) != 2:
            return end
        kept[:] = end
        return kept

    def in_place(f, t, y, h):
        y += codes.rk4(f, t, y, h) - y
        return y

    for step, words in ((in_place, "it changes its arguments"), (one_buffer, "an answer is overwritten by the next")):
        report = verify(step, "rk4", examples=FEW, isolate=False)
        assert report.passed
        assert f"of it; remark: {words}" in report.verdict


def test_sizes_that_overflow_are_refused_and_refute_nothing():
    for domain in (Domain(largest_state=1e308), Domain(largest_step=1e300)):
        with pytest.raises(ValueError, match=r"where binary64 overflows; choose smaller sizes"):
            verify(velocity_verlet, "velocity_verlet", examples=FEW, domain=domain)
    assert verify(velocity_verlet, "velocity_verlet", examples=FEW, domain=Domain(largest_state=1e300)).passed


def test_a_method_of_a_file_that_claims_no_order_is_held_to_the_order_that_is_derived(tmp_path):
    tableau = tmp_path / "mine.toml"
    tableau.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")

    def ralston(f, t, y, h):
        k1 = f(t, y)
        return y + h * (k1 / 4 + 3 * f(t + 2 * h / 3, y + 2 * h / 3 * k1) / 4)

    assert "mine has order 2" in str(verify(ralston, str(tableau), examples=FEW))


def test_a_method_of_ones_own_is_not_called_by_the_name_of_another(tmp_path):
    tableau = tmp_path / "rk4.toml"
    tableau.write_text('family = "runge_kutta"\nA = [[0]]\nb = [1]\n', encoding="utf-8")
    euler = verify(lambda f, t, y, h: y + h * f(t, y), tableau, examples=FEW, isolate=False)
    assert euler.passed
    assert euler.verdict.startswith("is own_rk4 to roundoff")
    named = verify(rk4_in_a_field, tableau, examples=FEW, isolate=False).verdict
    assert named.startswith("is not own_rk4; it is rk4")


def test_what_has_the_same_matrix_but_other_coefficients_fails():
    report = verify(rk38, "rk4", examples=FEW)
    assert not report.passed
    assert report.verdict == "is not rk4; it is rk38"
    assert report.section("Rounding: passed")
    assert report.section("Coefficients: FAILED")


def test_steps_back_are_tried_and_a_refusal_of_them_is_told():
    def of_any_sign(q, v, h):
        return symplectic_euler(q, v, abs(h))

    def refusing(q, v, h):
        if h < 0:
            raise ValueError("h has to be positive")
        return symplectic_euler(q, v, h)

    back = verify(symplectic_euler, "symplectic_euler", examples=FEW).section("Steps back: passed")
    assert back.lines == ("6 steps with h < 0 within the bound",)
    wrong = verify(of_any_sign, "symplectic_euler", examples=FEW)
    assert wrong.verdict.startswith(
        "is symplectic_euler for h > 0 only: h < 0 is no step back: step(q=1.0, v=0.0, h=-0.25)"
    )
    assert not wrong.passed
    refused = verify(refusing, "symplectic_euler", examples=FEW)
    assert refused.passed
    assert "raises ValueError: h has to be positive" in refused.section("Steps back: not asked").lines[0]


def test_a_row_of_an_array_that_is_left_out_fails_and_a_code_of_one_state_is_not_asked():
    def first_row_only(q, v, h):
        q1, v1 = symplectic_euler(q, v, h)
        return (q1, v1) if np.size(q) == 1 else (np.append(q1[:1], q[1:]), np.append(v1[:1], v[1:]))

    def of_one(q, v, h):
        return symplectic_euler(float(q), float(v), h)

    wrong = verify(first_row_only, "symplectic_euler", examples=FEW, isolate=False)
    assert wrong.verdict.startswith(
        "is symplectic_euler for one state at a time only: of 3 states in arrays, row 1 goes "
    )
    assert verify(symplectic_euler, "symplectic_euler", examples=FEW, isolate=False).section("Rows: passed")
    assert verify(of_one, "symplectic_euler", examples=FEW, isolate=False).section("Rows: not asked")


def test_the_fifth_order_row_of_fehlberg_has_a_key_of_its_own():
    pair = METHODS["fehlberg45"]
    rows, nodes = codes.floats(pair)[0], codes.floats(pair)[2]
    step = codes.tableau(rows, [float(x) for x in pair.b_embedded], nodes)
    assert verify(step, "fehlberg45_embedded", examples=FEW).passed
    refuted = verify(step, "fehlberg45", examples=FEW)
    row = "fehlberg45, with the embedded weights propagated: the row of order 5, not that of order 4"
    assert refuted.verdict == f"is not fehlberg45; it is {row}"
    assert "fehlberg45_embedded" in refuted.text()


def test_the_assertion_names_the_right_method_and_shows_an_example():
    named = r"is not velocity_verlet; it is, .*, velocity-first symplectic Euler \(symplectic_euler\)"
    with pytest.raises(AssertionError, match=named) as failure:
        assert_verified(symplectic_euler, method="velocity_verlet", examples=FEW)
    assert "the simplest step beyond the bound: step(q=" in str(failure.value)
    assert_verified(symplectic_euler, method="symplectic_euler", examples=FEW)


def test_an_implicit_stepper_is_held_to_the_tolerance_that_is_stated():
    with pytest.raises(ValueError, match="backward_euler is implicit"):
        verify(backward_euler, "backward_euler")
    stated = Allowance(solver_tolerance=Fraction(1, 10**10))
    assert verify(backward_euler, "backward_euler", allowance=stated, examples=FEW).passed
    assert not verify(backward_euler, "implicit_midpoint", allowance=stated, examples=FEW).passed


def test_a_domain_keeps_a_capped_stepper_to_what_is_asked():
    def capped(q, v, h):
        v = min(v - h * q, 100.0)
        return q + h * v, v

    assert verify(capped, "symplectic_euler", domain=Domain(largest_state=30.0), examples=FEW).passed
    failed = verify(capped, "symplectic_euler", examples=FEW)
    assert not failed.passed
    assert any("100" in line for line in failed.section("What it is: faults").lines)


def wrongly_timed(times):
    """RK4 whose two middle stages ask at times(t, h)."""

    def step(f, t, y, h):
        k1 = f(*times(t, h, 0), y)
        k2 = f(*times(t, h, h / 2), y + h / 2 * k1)
        k3 = f(*times(t, h, h / 2), y + h / 2 * k2)
        return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(*times(t, h, h), y + h * k3))

    return step


def unlike(part):
    """RK4 that leaves a number of y, from the place `part` on."""

    def step(f, t, y, h):
        y1 = rk4_in_a_field(f, t, y, h)
        y1[part:] = y[part:]
        return y1

    return step


def rk4_in_lists_of_three(f, t, y, h):
    """Right, but for the third number, which is put back."""
    stepped = rk4_in_a_field(f, t, np.array(y), h)
    return [*stepped[:2], *y[2:3], *stepped[3:]]


FALSE_PASSES = {
    "half a unit late": wrongly_timed(lambda t, h, part: (t + (0.5 if part == h / 2 else part),)),
    "h squared late": wrongly_timed(lambda t, h, part: (t + (h * h / 2 if part == h / 2 else part),)),
    "at time 0": wrongly_timed(lambda t, h, part: (0.0 * t,)),
    "a clock restarted": wrongly_timed(lambda t, h, part: (part,)),
    "a clock stopped": wrongly_timed(lambda t, h, part: (t,)),
    "the third number left": rk4_in_lists_of_three,
    "all but two left": unlike(2),
}


@pytest.mark.parametrize("step", FALSE_PASSES.values(), ids=FALSE_PASSES)
def test_wrong_times_and_numbers_left_out_fail_and_the_report_says_what_was_refused(step):
    report = verify(step, "rk4", examples=FEW, isolate=False)
    assert report.passed is False
    assert "to roundoff" not in report.verdict
    assert report.section("Nonlinear step: FAILED")
    assert report.section("Coefficients: passed") is None


def test_a_refusal_that_only_a_force_gets_round_is_in_the_verdict():
    report = verify(FALSE_PASSES["half a unit late"], "rk4", examples=FEW, isolate=False)
    assert "but not on y' = f(t, y): with h = 2, the time of call 1 is 0.5" in report.verdict
    assert any("there is no tableau: with h = 2" in line for line in report.section("Coefficients: undecided").lines)


def verlet_of_a_field(left=0, last=1.0):
    """Velocity Verlet of y = [q..., v...] that leaves so many of several positions, its last force at t + last h."""

    def step(f, t, y, h):
        y, n = np.array(y), len(y) // 2
        y[n:] += h / 2 * np.array(f(t, y))[n:]
        y[left * (n > 1) : n] += h * y[n + left * (n > 1) :]
        y[n:] += h / 2 * np.array(f(t + last * h, y))[n:]
        return y

    return step


class Stale:
    """Euler's method with the force of the step before."""

    kept = 0.0

    def step(self, force, q, v, h):
        old, self.kept = self.kept, force(q)
        return q + h * v, v + h * old


HEADLINES = {
    verlet_of_a_field(left=1): "is not velocity_verlet: its coefficients are, but on a nonlinear q'' = F(t, q) of 2 ",
    verlet_of_a_field(last=0.0): "is not velocity_verlet; it is velocity_verlet called at wrong times: in a step of 1 ",
    lambda q, v, h: (q + h * v, v - q): "is not forward_euler; it is forward_euler with one mistake: in the v, h is ",
    codes.tableau([[], [0.5], [0.5], [0.0, 0.0, 1.0]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0.0, 0.5, 0.5, 1.0]): (
        "is not rk4; it is rk4 with one mistake: Y[2] = y + h * (a[2][1] * k[0]) in place of Y[2] = "
    ),
    codes.composed([("kick", 1.001), ("drift", 1)]): "is not symplectic_euler; it is symplectic_euler but for kick 0: ",
    Stale().step: "is not forward_euler; it is no method that is known here: the same step of 1 call taken twice",
}


@pytest.mark.parametrize(("step", "headline"), HEADLINES.items())
def test_the_headline_carries_the_cause(step, headline):
    report = verify(step, re.findall(r"\w+", headline)[2], examples=FEW, isolate=False)
    assert report.verdict.startswith(headline)
    assert "off by 0.0e" not in report.text()


def test_a_failing_verification_takes_one_process(monkeypatch):
    started = []
    monkeypatch.setattr(
        "driftproof.blackbox.isolation.Session", lambda *how, **more: (started.append(how), Session(*how, **more))[1]
    )
    assert not verify(symplectic_euler, "velocity_verlet", examples=FEW).passed
    assert not verify("tests.blackbox.test_verify:symplectic_euler", "velocity_verlet", examples=FEW).passed
    assert len(started) == 2


IMPLICIT = {
    "backward_euler": all_at_once(table("backward_euler"), broyden),
    "implicit_midpoint": one_by_one(table("implicit_midpoint"), simplified),
    "trapezoid": one_by_one(table("trapezoid"), simplified),
    "sdirk2": one_by_one(table("sdirk2")),
    "radau_iia3": all_at_once(table("radau_iia3")),
}
# The claim, the step, and the place of the first entry that differs, or what is read besides.
TWINS = {
    "the midpoint rule": ("trapezoid", IMPLICIT["implicit_midpoint"], "trapezoid has 2 stages, 1 read"),
    "the trapezoidal rule": ("implicit_midpoint", IMPLICIT["trapezoid"], "implicit_midpoint has 1 stage, 2 read"),
    "f(t, y1)": ("backward_euler", all_at_once(([[1]], [1], [0])), "c[0] 1 0 -1"),
    "f(t + h/2, y1)": ("backward_euler", all_at_once(([[1]], [1], [0.5])), "c[0] 1 1/2 -0.5"),
    "another table": (
        "sdirk2",
        one_by_one(([[G, 0], [1 - 2 * G, G]], [0.5, 0.5], [G, 1 - G])),
        "a[1][0] 1/2*sqrt(2) 0.41421356237309515 -0.293",
    ),
}
SOLVED = Allowance(solver_tolerance=Fraction(1, 10**9))
SHORT = Domain(largest_state=10.0)


@pytest.mark.parametrize("key", IMPLICIT)
def test_an_implicit_step_of_a_right_hand_side_passes_by_its_coefficients_and_its_nonlinear_steps(key):
    report = verify(IMPLICIT[key], key, allowance=SOLVED, domain=SHORT, examples=FEW, isolate=False)
    assert report.passed, report
    assert report.section("Nonlinear step: passed")
    closeness, solved = report.section("Coefficients: passed").lines
    assert closeness.startswith(f"{key}: every coefficient ")
    assert solved.startswith("its stages are solved to ")
    assert identify(IMPLICIT[key], isolate=False).verdict == f"it is {key}"


@pytest.mark.parametrize(("key", "step", "entry"), TWINS.values(), ids=TWINS)
def test_what_only_a_nonlinear_problem_or_the_time_tells_apart_fails(key, step, entry):
    report = verify(step, key, allowance=SOLVED, domain=SHORT, examples=FEW, isolate=False)
    assert report.passed is False, report
    assert report.section("Rounding: passed")
    assert report.section("Nonlinear step: FAILED")
    lines = [" ".join(line.split()) for line in report.section("Coefficients: FAILED").lines]
    assert any(line.startswith(entry) for line in lines), lines
    assert not report.verdict.endswith(f"is not {key}; it is {key}")


def test_a_wrong_entry_of_implicit_stages_is_named():
    step = all_at_once(with_entry("radau_iia3", 0, 1, 0.06553542585019839))
    report = verify(step, "radau_iia3", allowance=SOLVED, domain=SHORT, examples=FEW, isolate=False)
    assert report.passed is False
    assert "it is radau_iia3 but for a[0][1]: 0.06553542585019839 instead of " in report.verdict
    assert (
        "row 0 of A sums to 0.28612187742207895, its time c is 0.1550510257216822"
        in report.section("Coefficients: FAILED").lines
    )


def test_a_solver_that_diverges_at_large_steps_is_told_apart_from_its_coefficients():
    step = one_by_one(table("implicit_midpoint"), fixed_point)
    report = verify(step, "implicit_midpoint", allowance=SOLVED, examples=FEW, isolate=False)
    assert "to the tolerance stated: its coefficients are, but a step is off by" in report.verdict
    small = replace(SHORT, largest_step=1.0)
    assert verify(step, "implicit_midpoint", allowance=SOLVED, domain=small, examples=FEW, isolate=False).passed


EARLY = {
    "one iteration": (
        partial(newton, most=1),
        "power 1 of the nonlinearity, as after one iteration of Newton's method",
    ),
    "two": (
        partial(newton, most=2),
        "power 3 of the nonlinearity, as after two iterations of Newton's method or 3 with",
    ),
    "a kept Jacobian": (partial(simplified, most=2), "power 2 of the nonlinearity, as after 2 with one Jacobian"),
}


@pytest.mark.parametrize(("solver", "seen"), EARLY.values(), ids=EARLY)
def test_a_solver_that_stops_early_fails_and_is_told_by_the_power_of_its_error(solver, seen):
    step = all_at_once(table("backward_euler"), solver)
    report = verify(step, "backward_euler", allowance=SOLVED, domain=SHORT, examples=FEW, isolate=False)
    assert report.passed is False
    assert report.verdict.startswith(
        "is not backward_euler to the tolerance stated: its coefficients are, but its solver"
    )
    assert seen in report.verdict
    assert report.section("Coefficients: FAILED")
    assert seen in identify(step, isolate=False).verdict


def test_a_solver_that_stops_early_within_the_tolerance_stated_leaves_the_coefficients_undecided():
    step, coarse = all_at_once(table("backward_euler"), partial(newton, most=2)), Allowance(solver_tolerance=1e-4)
    report = verify(step, "backward_euler", allowance=coarse, domain=SHORT, examples=FEW, isolate=False)
    assert report.passed
    assert report.section("Coefficients: undecided")


def test_implicit_stages_of_no_known_method_are_shown_with_their_order():
    step = one_by_one(([[0.25, 0], [0.5, 0.25]], [0.5, 0.5], [0.25, 0.75]))
    assert identify(step, isolate=False).verdict == "it is qin_zhang2"
    other = one_by_one(([[0.375, 0], [0.25, 0.375]], [0.5, 0.5], [0.375, 0.625]))
    found = identify(other, isolate=False)
    assert found.verdict == "it is no method that is known here, but one of 2 implicit stages and order 2"
    assert "a[1] = 1/4, 3/8" in found.section("Coefficients").lines


def gives_up_on_what_bends(f, t, y, h):
    """RK4 where f is linear in y and does not depend on t; else it takes more time than it has."""
    if np.max(np.abs(f(t, y) + f(t, -y))) > 1e-6 * np.max(np.abs(f(t, y))):
        while True:
            pass
    return rk4_in_a_field(f, t, y, h)


def test_what_was_not_seen_is_undecided_and_says_what_would_decide_it(monkeypatch, capsys):
    report = verify(gives_up_on_what_bends, "rk4", examples=FEW, time_limit=0.5)
    assert report.passed is None, report
    assert report.verdict.startswith("undecided whether it is rk4: ")
    assert "nonlinear step: a longer time limit" in report.section("What would decide it").lines
    assert json.loads(report.json())["passed"] is None
    monkeypatch.setattr(sys.modules["driftproof.blackbox.verify"], "verify", lambda *_, **__: report)
    with pytest.raises(AssertionError, match="What would decide it"):
        assert_verified(gives_up_on_what_bends, "rk4")
    assert_verified(gives_up_on_what_bends, "rk4", allow_undecided=True)
    assert main(["verify", "tests.blackbox.test_verify:gives_up_on_what_bends", "--method", "rk4"]) == 3
    assert "undecided whether it is rk4" in capsys.readouterr().out


def test_a_built_in_system_is_all_that_is_said_of_its_step():
    report = verify(velocity_verlet_of_the_oscillator, "velocity_verlet", examples=FEW)
    assert report.passed
    assert report.verdict.startswith("is velocity_verlet on q'' = -q to roundoff")
    assert verify(velocity_verlet, "velocity_verlet", examples=FEW).verdict.startswith("is velocity_verlet to roundoff")


def velocity_verlet_of_the_oscillator(q, v, h):
    v = v - h / 2 * q
    q = q + h * v
    return q, v - h / 2 * q


def first_of_two(f, t, y, h):
    """RK4 whose second number is stepped by Euler's method."""
    return np.array([rk4_in_a_field(f, t, y, h)[0], *(y + h * f(t, y))[1:]])


def later_by_half(f, t, y, h):
    return rk4_in_a_field(lambda s, z: f(t + 0.5 if s == t + h / 2 else s, z), t, y, h)


SHORT = Domain(largest_step=0.5, largest_state=1.0)
SOLVED = Allowance(solver_tolerance=1e-9)
EXPLAINED = {
    "right": (rk4_in_a_field, "rk4", {}),
    "with another key": (codes.rk38, "rk4", {}),
    "of its force": (codes.velocity_verlet, "velocity_verlet", {}),
    "half moved": (codes.half_moved, "symplectic_euler", {}),
    "in the other order": (codes.symplectic_euler, "symplectic_euler_position_first", {}),
    "of the oscillator": (velocity_verlet_of_the_oscillator, "velocity_verlet", {"domain": SHORT}),
    "solved at once": (backward_euler, "backward_euler", {"allowance": SOLVED}),
    "of another map": (symplectic_euler, "backward_euler", {"allowance": SOLVED}),
    "called too late": (later_by_half, "rk4", {}),
    "called at t only": (codes.rk4_on_a_stopped_clock, "rk4", {}),
    "in one number": (first_of_two, "rk4", {}),
    "without a time": (codes.rk4_without_time, "zonneveld43", {}),
    "with a weight off": (codes.tableau(*replaced_weight("rk4", 1, 0.25)), "rk4", {}),
    "with a weight off by 1e-9": (codes.tableau(*replaced_weight("rk38", 1, 0.375 + 1e-9)), "rk38", {}),
    "in narrow floats": (codes.in_precision(codes.rk4, np.float32), "rk4", {}),
    "with the other row": (pair_step("fehlberg45_embedded"), "fehlberg45", {}),
    "with twice its estimate": (pair_step("fehlberg45", lambda y1, error, h, y: (y1, 2 * error)), "fehlberg45", {}),
    "with a dense output": (extension_step("dormand_prince54_shampine"), "dormand_prince54", {}),
    "with a wrong one": (
        extension_step("dormand_prince54_shampine", weights=first_and_last_exchanged), "dormand_prince54", {},
    ),
    "without its last stage": (codes.tableau([[0, 0], [0.5, 0]], [0, 1], [0, 0.5]), "heun3", {}),
}  # fmt: skip


@pytest.mark.parametrize("name", EXPLAINED)
def test_all_that_is_reported_is_as_before(name, as_before):
    step, method, how = EXPLAINED[name]
    held = verify(step, method, examples=FEW, isolate=False, **how)
    named = identify(step, isolate=False)
    reports = [line for report in (held, named) for line in (report.text().partition("\n")[2], checksum(report.json()))]
    as_before(held.passed, *reports)


def test_no_verdict_hangs_on_assert_statements():
    here = "tests.blackbox.test_verify:symplectic_euler"
    words = ["-O", "-m", "driftproof", "verify", here, "--method", "forward_euler", "--examples", "50"]
    found = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    assert (found.returncode, "is not forward_euler" in found.stdout) == (1, True)


def with_estimate(f, t, y, h):
    y1 = rk4_in_a_field(f, t, y, h)
    return y1, y1 - y - h * f(t, y)


def with_estimate_of_small_states(f, t, y, h):
    return with_estimate(f, t, y, h) if max(map(abs, y)) < 2 else rk4_in_a_field(f, t, y, h)


def iterated_three_times(f, t, y, h):
    return y + h * f(t + h, y + h * f(t + h, y + h * f(t + h, y)))


@pytest.mark.parametrize(
    ("step", "key", "title", "words"),
    [
        (with_estimate, "rk4", "Error estimate: not asked", "rk4 has none"),
        (
            with_estimate_of_small_states,
            "rk4",
            "Error estimate: not asked",
            "it returns something beside y1 at some steps only",
        ),
        (iterated_three_times, "backward_euler", "Coefficients: undecided", "read as 3 explicit stages"),
    ],
)
def test_what_is_nobody_s_claim_is_said_and_is_no_verdict(step, key, title, words):
    allowance = Allowance(solver_tolerance=1e-9) if key == "backward_euler" else Allowance()
    report = verify(step, key, allowance=allowance, examples=20, isolate=False)
    assert report.section(title).lines[0].startswith(words)
    assert report.passed is (key == "rk4")


def test_a_code_runs_in_another_process_unless_told_otherwise():
    here = []

    def euler(q, v, h):
        here.append(h)
        return q + h * v, v - h * q

    verify(euler, "forward_euler", examples=2)
    assert_verified(euler, "forward_euler", examples=2)
    identify(euler)
    assert here == []
    verify(euler, "forward_euler", examples=2, isolate=False)
    assert len(here) > 2


def test_assert_statements_of_the_package_only_narrow_types():
    statements = [
        (path, node)
        for path in Path(driftproof.__file__).parent.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Assert)
    ]
    assert len(statements) > 5
    for path, node in statements:
        assert re.fullmatch(r".* is not None|(not )?isinstance\(.*\)", ast.unparse(node.test)), (path, node.lineno)


def test_on_the_command_line_the_status_tells(capsys):
    here = "tests.blackbox.test_verify:symplectic_euler"
    assert main(["verify", here, "--method", "symplectic_euler", "--examples", "5"]) == 0
    assert main(["verify", here, "--method", "forward_euler", "--examples", "5", "--format", "json"]) == 1
    data = json.loads(capsys.readouterr().out.split("\n{", 1)[-1].join(["{", ""]) or "{}")
    assert data["passed"] is False
    assert data["rounding"]["failing"]["q"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--method", "rk5"], "rk5"),
        (["--method", "rk4", "--solver-tolerance", "1e-10"], "takes no solver_tolerance"),
        (["--method", "rk4", "--largest-step", "0"], "write a number above 0"),
        (["--method", "rk4", "--examples", "none"], "number of examples"),
    ],
)
def test_a_question_without_sense_is_refused_in_one_line(arguments, message, capsys):
    try:
        status = main(["verify", "tests.blackbox.test_verify:symplectic_euler", *arguments])
    except SystemExit as end:
        status = end.code
    assert status == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
