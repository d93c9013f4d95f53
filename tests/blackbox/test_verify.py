"""verify, from end to end: right steppers pass, wrong ones fail with the name of what they are and an example."""

import json
import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.judging.specification import Allowance, Domain
from driftproof.blackbox.verify import assert_verified, verify
from driftproof.cli import main
from driftproof.methods.catalogue import METHODS
from driftproof.support.processes import Session
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.extension_steppers import extension_step, first_and_last_exchanged
from tests.blackbox.implicit_steppers import G, all_at_once, broyden, newton, one_by_one, simplified, table
from tests.blackbox.pair_steppers import pair_step
from tests.blackbox.transcripts import checksum, shortened, titles

FEW = 50
SOLVED = Allowance(solver_tolerance=Fraction(1, 10**9))
SHORT = Domain(largest_state=10.0)
HERE = "tests.blackbox.handwritten_steppers:symplectic_euler"


def held(step, method, **how):
    """The report of `verify` on few examples, in this process."""
    return verify(step, method, **{"examples": FEW, "isolate": False, **how})


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


def velocity_verlet_of_the_oscillator(q, v, h):
    v = v - h / 2 * q
    q = q + h * v
    return q, v - h / 2 * q


@pytest.mark.parametrize(("answer", "words"), [
    (lambda q, v: (q, v, q), r"it returns \(1.0, 0.75, 1.0\), not a pair \(q1, v1\); write: def wrapped\(q, v, h\): "),
    (lambda q, v: {"q": q, "rate": v, "old": q}, r"not a pair \(q1, v1\); write"),
    (lambda q, v: (q, "fast"), "it returns str"),
])  # fmt: skip
@pytest.mark.parametrize("ask", [held, lambda step, key: identify(step, isolate=False)])
def test_an_answer_that_is_not_understood_is_bad_input_and_no_answer_fails(answer, words, ask):
    with pytest.raises(ValueError, match=f"cannot be read: .*{words}"):
        ask(lambda q, v, h: answer(q, v), "forward_euler")
    assert held(lambda q, v, h: None, "forward_euler").verdict.startswith("gives no answer: it returns None")


@pytest.mark.parametrize(("kind", "near"), [(np.float32, "to roundoff in binary32: "), (float, "to roundoff: ")])
def test_a_verdict_names_the_narrow_format_that_it_holds_a_step_to(kind, near):
    step = lambda q, v, h: (kind(q + h * v), kind(v - h * q))
    assert held(step, "forward_euler").verdict.startswith(f"is forward_euler on q'' = -q {near}")
    leaks = lambda q, v, h: (q + kind(1) * h * v, v - kind(1) * h * q)  # what is left of h has 24 bits
    assert held(leaks, "forward_euler").passed is (kind is float)


def test_a_verdict_says_how_many_calls_were_looked_at():
    calls = []
    euler = lambda f, t, y, h: calls.append(t) or y + h * f(t, y)
    report = held(euler, "forward_euler")
    assert report.section("Calls made").lines == (f"{report.data['calls_made']} calls of the stepper",)
    before_any_question = len(calls) - report.data["calls_made"]
    assert 0 < before_any_question < 10 < report.data["calls_made"]
    assert held(codes.rk4, "rk38").section("Calls made") is None


def test_sizes_that_overflow_are_refused_and_refute_nothing():
    for domain in (Domain(largest_state=1e308), Domain(largest_step=1e300)):
        with pytest.raises(ValueError, match=r"where binary64 overflows; choose smaller sizes"):
            held(codes.velocity_verlet, "velocity_verlet", domain=domain)
    assert held(codes.velocity_verlet, "velocity_verlet", domain=Domain(largest_state=1e300)).passed


def test_a_method_of_a_file_that_claims_no_order_is_held_to_the_order_that_is_derived(tmp_path):
    tableau = tmp_path / "mine.toml"
    tableau.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")
    assert "mine has order 2" in str(held(codes.ralston, str(tableau)))


def test_a_method_of_a_file_that_claims_too_high_an_order_is_held_to_its_own_and_told_so():
    mine = replace(METHODS["ralston2"], key="mine", claimed_order=3)
    assert (report := held(codes.ralston, mine)).passed
    assert report.verdict.endswith("; remark: mine itself: claimed order 3, has 2")
    assert "mine has order 2, not 3 as its table claims" in report.text()
    assert "remark" not in held(codes.ralston, replace(mine, claimed_order=2)).verdict


def test_a_method_of_ones_own_is_not_called_by_the_name_of_another(tmp_path):
    tableau = tmp_path / "rk4.toml"
    tableau.write_text('family = "runge_kutta"\nA = [[0]]\nb = [1]\n', encoding="utf-8")
    euler = held(lambda f, t, y, h: y + h * f(t, y), tableau)
    assert euler.passed
    assert euler.verdict.startswith("is own_rk4 to roundoff")
    named = held(codes.rk4, tableau).verdict
    assert named.startswith("is not own_rk4; it is rk4")


def test_the_assertion_names_the_right_method_and_shows_an_example():
    named = r"is not velocity_verlet; judging by linear steps only, it is velocity-first .* \(symplectic_euler\)"
    with pytest.raises(AssertionError, match=named) as failure:
        assert_verified(symplectic_euler, method="velocity_verlet", examples=FEW)
    assert "the simplest step beyond the bound: step(q=" in str(failure.value)
    assert_verified(symplectic_euler, method="symplectic_euler", examples=FEW)


def test_an_implicit_stepper_needs_a_tolerance_that_is_stated():
    for ask in (verify, assert_verified):
        shell = "--solver-tolerance 1e-10, in Python " * (ask is verify)
        with pytest.raises(ValueError, match=rf"backward_euler is implicit: .* give {shell}allowance=Allowance\("):
            ask(backward_euler, "backward_euler")
    with pytest.raises(ValueError, match=r"does not fit any calling convention; write: "):
        assert_verified(lambda f, t_span, y0, rtol, atol: y0, "rk4")
    with pytest.raises(ValueError, match="examples=0: at least 1 step is tried"):
        verify(symplectic_euler, "symplectic_euler", examples=0)


@pytest.mark.slow
def test_a_failing_verification_takes_one_process(monkeypatch):
    started = []
    monkeypatch.setattr(
        "driftproof.blackbox.isolation.Session", lambda *how, **more: (started.append(how), Session(*how, **more))[1]
    )
    assert not verify(symplectic_euler, "velocity_verlet", examples=FEW).passed
    assert not verify(HERE, "velocity_verlet", examples=FEW).passed
    assert len(started) == 2


IMPLICIT = {
    "backward_euler": all_at_once(table("backward_euler"), broyden),
    "implicit_midpoint": one_by_one(table("implicit_midpoint"), simplified),
    "trapezoid": one_by_one(table("trapezoid"), simplified),
    "sdirk2": one_by_one(table("sdirk2")),
}
# The claim, the step, and the place of the first entry that differs, or what is read besides.
TWINS = {
    "the trapezoidal rule": ("implicit_midpoint", IMPLICIT["trapezoid"], "implicit_midpoint has 1 stage, 2 read"),
    "f(t, y1)": ("backward_euler", all_at_once(([[1]], [1], [0])), "c[0] 1 0 -1"),
    "f(t + h/2, y1)": ("backward_euler", all_at_once(([[1]], [1], [0.5])), "c[0] 1 1/2 -0.5"),
    "another table": ("sdirk2", one_by_one(([[G, 0], [1 - 2 * G, G]], [0.5, 0.5], [G, 1 - G])),
        "a[1][0] 1/2*sqrt(2) 0.41421356237309515 -0.293"),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", IMPLICIT)
def test_an_implicit_step_of_a_right_hand_side_passes_by_its_coefficients_and_its_nonlinear_steps(key, as_before):
    report = held(IMPLICIT[key], key, allowance=SOLVED, domain=SHORT)
    assert report.passed, report
    assert report.section("Nonlinear step: passed")
    closeness, solved = report.section("Coefficients: passed").lines
    assert closeness.startswith(f"{key}: every coefficient ")
    assert solved.startswith("its stages are solved to ")
    named = identify(IMPLICIT[key], isolate=False)
    assert named.verdict == f"it is {key}"
    as_before(*titles(report), *titles(named))


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "step", "entry"), TWINS.values(), ids=TWINS)
def test_what_only_a_nonlinear_problem_or_the_time_tells_apart_fails(key, step, entry, as_before):
    report = held(step, key, allowance=SOLVED, domain=SHORT)
    assert report.passed is False, report
    assert report.section("Rounding: passed")
    assert report.section("Nonlinear step: FAILED")
    lines = [" ".join(line.split()) for line in report.section("Coefficients: FAILED").lines]
    assert any(line.startswith(entry) for line in lines), lines
    assert not report.verdict.endswith(f"is not {key}; it is {key}")
    as_before(*titles(report))


def test_a_solver_that_stops_early_within_the_tolerance_stated_leaves_the_coefficients_undecided():
    step, coarse = all_at_once(table("backward_euler"), partial(newton, most=2)), Allowance(solver_tolerance=1e-4)
    report = held(step, "backward_euler", allowance=coarse, domain=SHORT)
    assert report.passed
    assert report.section("Coefficients: undecided")


def plainly_iterated(tolerance, start=lambda f, t, y, h: y):
    """Backward Euler by plain iteration until a change is below the tolerance, relative to the norm of the state."""

    def step(f, t, y, h):
        y1 = start(f, t, y, h)
        for _ in range(200):
            before, y1 = y1, y + h * f(t + h, y1)
            if np.linalg.norm(y1 - before) <= tolerance * (1 + np.linalg.norm(y1)):
                return y1
        raise RuntimeError("no convergence")

    return step


CONVERGING = {"allowance": SOLVED, "domain": Domain(largest_step=0.5)}


def test_a_right_step_that_converges_in_the_domain_passes_whatever_it_does_in_longer_steps():
    report = held(plainly_iterated(1e-10), "backward_euler", **CONVERGING)
    assert report.passed, report
    assert any("order 1 is observed" in line for line in report.section("Order: passed").lines)


def test_a_right_step_that_starts_where_the_last_one_ended_passes_and_keeps_no_number_of_ours():
    kept = {}

    def warm(f, t, y, h):
        y1 = plainly_iterated(1e-13, lambda f, t, y, h: y + h * kept.get(len(y), 0.0))(f, t, y, h)
        kept[len(y)] = (y1 - y) / h
        return y1

    assert held(warm, "backward_euler", allowance=SOLVED, domain=Domain(largest_step=0.125)).passed
    assert {x.dtype for x in kept.values()} == {np.dtype(float)}


def test_a_right_step_that_is_solved_less_well_than_stated_is_told_how_well():
    found = held(plainly_iterated(1e-8), "backward_euler", **CONVERGING)
    assert found.passed is False
    assert "its coefficients agree, but a step is off by" in found.verdict
    assert " times the bound, as if its stages were solved to " in found.verdict
    assert 1e-9 < float(found.verdict.partition(" solved to ")[2].split()[0]) < 1e-7


def test_weights_of_states_that_do_not_sum_to_1_are_told_by_what_h_of_0_does():
    """As those of convex combinations do that are printed in 15 digits; with exact ones it is the method."""

    def convex(rest):
        def step(f, t, y, h):
            u = y + h * f(t, y)
            return rest * y + 0.5 * (u + h * f(t + h, u))

        return step

    found = held(convex(0.500000000000002), "heun2")
    assert "; h = 0 returns the state except for rounding by 2e-15, as weights of states that do not" in found.verdict
    assert held(convex(0.5), "heun2").passed


@pytest.mark.slow
def test_a_step_that_ends_where_a_slope_is_0_is_not_the_method():
    step = all_at_once(table("gauss2"))
    ending = lambda f, t, y, h: step(f, t, y, h) if np.any(f(t + (0.5 + 3**0.5 / 6) * h, y)) else y
    found, why = held(ending, "gauss2", allowance=SOLVED, domain=SHORT), "where the slope of a stage is exactly 0"
    assert found.passed is False
    assert found.verdict.endswith(f"its coefficients agree, but {why}, its stages are not solved")
    assert identify(ending, isolate=False).verdict == f"it is gauss2, but {why}, its stages are not solved"


def backward(number, part=1.0):
    def step(f, t, y, h):
        before, y1 = np.inf, number(y)
        while abs(y1 - before) > 1e-13 * (1 + abs(y1)):
            before, y1 = y1, number(y) + h * f(t + h, y1 + (1 - part) * (number(y) - y1))
        return y1

    return step


def test_a_step_of_one_number_is_read_where_others_may_stand_for_it_and_else_undecided():
    found, wrong = (held(backward(lambda y: y, part), "backward_euler", **CONVERGING) for part in (1.0, 0.999))
    assert found.verdict.startswith("is backward_euler for a single component: its coefficients agree, and")
    assert wrong.verdict == "is not backward_euler; it is backward_euler except for a[0][0]: 999/1000 instead of 1"
    what = "one number shows the stability function only; a step that takes an array of them shows its stages"
    alone = held(backward(float), "backward_euler", **CONVERGING)
    assert alone.passed is None
    assert "Nonlinear step: passed" in alone.text()
    assert alone.verdict.endswith(what)
    other = held(backward(float), "implicit_midpoint", **CONVERGING).verdict
    assert other.startswith("is not implicit_midpoint: on a nonlinear problem of 1 component")
    seen = identify(backward(float), isolate=False)
    assert seen.verdict.startswith("undecided: the number of calls depends on the answers")
    assert seen.verdict.endswith(what)
    assert seen.section("Faults") is None


def test_a_step_of_one_number_is_tried_back_as_well():
    back = lambda f, t, y, h: float(y) + h * f(t, float(y)) * (1 if h > 0 else 1.01)
    found = held(back, "forward_euler")
    assert found.verdict.startswith("is forward_euler for h > 0 only: a step with h < 0 is wrong")
    assert "Steps back: passed" in held(lambda f, t, y, h: float(y) + h * f(t, float(y)), "forward_euler").text()


def theta_step(theta, late=1.0, most=50):
    """By Newton's method with the Jacobian that is handed in: backward Euler's for theta = 1."""

    def step(f, jac, y, t, h):
        known, y1 = y + h * (1 - theta) * f(y, t), y
        for _ in range(most):
            change = np.linalg.solve(
                np.eye(len(y)) - h * theta * jac(y1, t + late * h), y1 - known - h * theta * f(y1, t + late * h)
            )
            y1 = y1 - change
            if np.abs(change).max() <= 1e-13 * (1 + np.abs(y1).max()):
                break
        return y1

    return step


def of_one_with_its_derivative(f, dfdy, t, y, h):
    y1, change = y, np.inf
    while abs(change) > 1e-13 * (1 + abs(y1)):
        change = (y1 - y - h * f(t + h, y1)) / (1 - h * dfdy(t + h, y1))
        y1 = y1 - change
    return y1


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("step", "passed", "name"), [
    (theta_step(1.0), True, "backward_euler"), (of_one_with_its_derivative, True, "backward_euler"),
    (theta_step(1.0, late=0.5), False, "backward_euler except for c[0]: 1/2 instead of 1"),
    (theta_step(0.5), False, "trapezoid"), (theta_step(1.0, most=2), False, "backward_euler, but its solver stops"),
])  # fmt: skip
def test_a_step_that_solves_with_a_jacobian_is_handed_differences_of_f_and_the_verdict_says_so(step, passed, name):
    found, seen = held(step, "backward_euler", **CONVERGING), identify(step, isolate=False)
    assert found.passed is passed
    assert seen.verdict.startswith(f"it is {name}")
    assert [x.verdict.endswith("; as its Jacobian it was handed differences of f") for x in (found, seen)] == [True] * 2


@pytest.mark.slow
def test_implicit_stages_of_no_known_method_are_shown_with_their_order():
    other = one_by_one(([[0.375, 0], [0.25, 0.375]], [0.5, 0.5], [0.375, 0.625]))
    found = identify(other, isolate=False)
    assert found.verdict == "it is not a known method, but has 2 implicit stages and order 2"
    assert "a[1] = 1/4, 3/8" in found.section("Coefficients").lines


def gives_up_on_what_bends(f, t, y, h):
    """RK4 where f is linear in y and does not depend on t; else it takes more time than it has."""
    if np.max(np.abs(f(t, y) + f(t, -y))) > 1e-6 * np.max(np.abs(f(t, y))):
        while True:
            pass
    return codes.rk4(f, t, y, h)


@pytest.mark.slow
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


def scribbling(q, v, h):
    for number in range(3, 64):
        with suppress(OSError):
            os.write(number, b"[]\n")
    return codes.symplectic_euler(lambda x: -x, q, v, h)


SCRIBBLED = """
from driftproof import verify
print(verify("tests.blackbox.test_verify:scribbling", "symplectic_euler", examples=25).text())
"""


@pytest.mark.slow
def test_code_that_writes_into_the_pipe_to_us_is_undecided_and_told_what_to_leave_alone(fresh_python):
    """In a process of its own: it would write into the pipes of pytest's workers as well."""
    _, verdict, *lines = fresh_python(SCRIBBLED).splitlines()
    assert verdict.startswith("  undecided whether it is symplectic_euler: an invalid answer: the code wrote into the")
    assert "  rounding: a step that leaves its process, and the pipes of it, alone" in lines


def later_by_half(f, t, y, h):
    return codes.rk4(lambda s, z: f(t + 0.5 if s == t + h / 2 else s, z), t, y, h)


NEAR = Domain(largest_step=0.5, largest_state=1.0)
EXPLAINED = {
    "right": (codes.rk4, "rk4", {}),
    "of its force": (codes.velocity_verlet, "velocity_verlet", {}),
    "half moved": (codes.half_moved, "symplectic_euler", {}),
    "of the oscillator": (velocity_verlet_of_the_oscillator, "velocity_verlet", {"domain": NEAR}),
    "solved at once": (backward_euler, "backward_euler", {"allowance": SOLVED}),
    "of another map": (symplectic_euler, "backward_euler", {"allowance": SOLVED}),
    "called too late": (later_by_half, "rk4", {}),
    "called at t only": (codes.rk4_on_a_stopped_clock, "rk4", {}),
    "without a time": (codes.rk4_without_time, "zonneveld43", {}),
    "with a weight off": (codes.tableau(*replaced_weight("rk4", 1, 0.25)), "rk4", {}),
    "in narrow floats": (codes.in_precision(codes.rk4, np.float32), "rk4", {}),
    "with the other row": (pair_step("fehlberg45_embedded"), "fehlberg45", {}),
    "with twice its estimate": (pair_step("fehlberg45", lambda y1, error, h, y: (y1, 2 * error)), "fehlberg45", {}),
    "with a dense output": (extension_step("dormand_prince54_shampine"), "dormand_prince54", {}),
    "with a wrong one": (
        extension_step("dormand_prince54_shampine", weights=first_and_last_exchanged), "dormand_prince54", {},
    ),
}  # fmt: skip

IN_WORDS = ("right", "of its force", "of the oscillator", "of another map", "called too late", "called at t only")
IN_WORDS += ("with a weight off", "with the other row", "with a wrong one")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", EXPLAINED)
def test_all_that_is_reported_is_as_before(name, as_before):
    step, method, how = EXPLAINED[name]
    report, named = held(step, method, **how), identify(step, isolate=False)
    said = [report.passed]
    for each in (report, named):
        text = each.text().splitlines()[1:]
        said += [text[0], *shortened(text[1:], name in IN_WORDS), checksum(each.json())]
    as_before(*said)


@pytest.mark.slow
def test_no_verdict_hangs_on_assert_statements():
    words = ["-O", "-m", "driftproof", "verify", HERE, "--method", "forward_euler", "--examples", "50"]
    found = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    assert (found.returncode, "is not forward_euler" in found.stdout) == (1, True)


def test_a_code_runs_in_another_process_unless_told_otherwise():
    here = []
    euler = lambda q, v, h: here.append(h) or (q + h * v, v - h * q)
    verify(euler, "forward_euler", examples=2)
    assert_verified(euler, "forward_euler", examples=2)
    identify(euler)
    assert here == []
    verify(euler, "forward_euler", examples=2, isolate=False)
    assert len(here) > 2
