"""Which multistep method a stepper is, by key or by what is wrong; planted twins fail, right ones do not."""

from __future__ import annotations

import re
from math import pi
from unittest.mock import Mock

import numpy as np
import pytest

from driftproof.blackbox.families.multistep import read_start
from driftproof.blackbox.families.multistep_recurrence import read_recurrence
from driftproof.blackbox.families.multistep_runs import MarkedRuns
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.identify import identify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.multistep import Multistep
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Corrected, Displaced, Remembering, Stormer
from tests.blackbox.handwritten_steppers import euler, rk4
from tests.blackbox.transcripts import to_twelve_digits

EXPLICIT = [key for key, m in FURTHER_METHODS.items() if isinstance(m, Multistep) and m.explicit and m.derivative == 1]
IMPLICIT = ["adams_moulton4", "bdf2", "bdf6"]

AB2, AB3, AB4, AM3 = "adams_bashforth2", "adams_bashforth3", "adams_bashforth4", "adams_moulton3"
BY_EULER, BY_RK4 = "started by forward_euler", "started by rk4"
LATE = "its start is too inaccurate: first errors are like h^2, and whole runs have order 2, not 3"
NAMED = [
    (Remembering(AB2, euler).step, f"{AB2}, {BY_EULER}"),
    (planted.in_a_closure(), f"{AB2}, {BY_EULER}"),
    (planted.generated_adams_bashforth2, f"{AB2}, {BY_EULER}"),
    (planted.run_of_adams_bashforth2, f"{AB2}, {BY_EULER}"),
    (planted.run_of_adams_bashforth3, f"{AB3}, {BY_RK4}"),
    (planted.run_of_three_methods, f"{AB3}, {BY_EULER} and {AB2}; {LATE}"),
    (planted.run_of(lambda h: [[1.0]]), "forward_euler"),
    (Remembering("bdf2", planted.implicit_euler).step, "bdf2, started by backward_euler"),
    (Remembering("two_step_leapfrog", euler).step, f"two_step_leapfrog, {BY_EULER}"),
    (Corrected(AM3, rk4, planted.BASHFORTH4).step,
     f"{AM3}, corrected once from the prediction of {AB4} (PECE), {BY_RK4}"),
    (planted.without_times(Corrected("adams_moulton2", rk4, [1.0], times=2)),
     f"adams_moulton2, corrected 2 times from the prediction of forward_euler (PECECE), {BY_RK4}"),
    (planted.Predicted(1.5, -0.5).step, f"trapezoid, corrected once from the prediction of {AB2} (PECE)"),
    (planted.Predicted(1.5, 0.5).step, "trapezoid, but its right-hand side is not evaluated at the states that it "
     "returns; order 1 is observed in whole runs, not 2"),
    (Remembering(AB2, euler, sigma=[1 - pi / 2, pi / 2, 0.0]).step, f"a multistep method of 2 steps, {AB2} except for "
     f"sigma[0]: -0.570796326795 instead of -1/2; sigma[1]: 1.57079632679 instead of 3/2, {BY_EULER}"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", [*EXPLICIT, *IMPLICIT])
def test_a_method_that_is_started_well_enough_passes_as_itself(key):
    report = verify(Remembering(key, rk4).step, key, isolate=False)
    assert report.passed is (FURTHER_METHODS[key].claimed_order <= 5), report.text()
    assert report.passed or "its start is too inaccurate: first errors are like h^5" in report.verdict


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "words"), NAMED, ids=range(len(NAMED)))
def test_a_stepper_is_named_with_its_start_in_every_form(step, words):
    assert to_twelve_digits(identify(step, isolate=False).verdict) == f"it is {words}"


THIRDS = Remembering(AB2, euler, sigma=[-1 / 3, 3 / 2, 0.0])
BESIDE = "its right-hand side is not evaluated at the states that it returns"
ALONE = "each step depends on the previous state only"
WRONG = [
    (THIRDS.step, AB2, f"{AB2} except for sigma[0]: -1/3 instead of -1/2"),
    (Remembering(AB4, euler).step, AB4, f"{LATE[:-1]}4"),
    (Remembering(AB2, euler).step, AB3, f"it is {AB2}"),
    (Corrected(AM3, rk4, planted.BASHFORTH4).step, AM3, f"evaluated at the prediction of {AB4}"),
    (Corrected(AM3, rk4, planted.BASHFORTH4, times=2).step, "abm4", "it is adams_moulton3, corrected 2 times"),
    (planted.Predicted(1.5, 0.5).step, "abm2", BESIDE),
    (Remembering("bdf2", euler, most=1).step, "bdf2", "its equations are solved to"),
    (Displaced(AB2, euler).step, AB2, BESIDE),
    (lambda f, t, y, h: y + 0.875 * h * f(t, y), AB2, f"{ALONE}; it is not consistent: rho'(1) - sigma(1) = 1/8"),
    (lambda f, t, y, h: y + 0 * f(t, y), AB2, ALONE),
    (Stormer(right=False).step, "stormer2", "first errors are like h^2"),
    (rk4, AB4, "its steps satisfy no recurrence of up to 8 steps"),
]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "key", "words"), WRONG, ids=range(len(WRONG)))
def test_a_wrong_one_fails_with_its_cause(step, key, words):
    report = verify(step, key, isolate=False)
    assert report.passed is False, report.text()
    assert words in report.verdict


@pytest.mark.parametrize(
    ("step", "name", "key"),
    [
        (planted.Predicted(1.5, -0.5).step, "Adams-Bashforth-Moulton 2 (PECE)", "abm2"),
        (Corrected(AM3, rk4, planted.BASHFORTH4, times=2).step, "ABM4 PECECE", "abm4-PECECE"),
    ],
)
def test_one_that_is_corrected_passes_by_its_usual_names_and_is_told_the_short_one(step, name, key):
    report = verify(step, name, isolate=False)
    assert report.passed, report.text()
    assert identify(step, isolate=False).section("What to do").lines[0].endswith(f"--method {key}")


@pytest.mark.slow
def test_stormers_positions_are_told_from_velocity_verlets_velocities():
    seen = {None: (True, ": differences of positions"), 0.0: (None, ": those of half a step before"), 0.3: (False, "")}
    for kick, (passed, told) in seen.items():
        named, held = identify(Stormer(kick=kick).step, isolate=False), verify(Stormer(kick=kick).step, "stormer2")
        assert named.verdict == f"it is stormer2; order 1 is observed in its velocities{told}"
        assert held.passed is passed
        assert f"order 1 is observed in its velocities{told}" in held.verdict
    assert identify(Remembering(AB2, euler).step, isolate=False).verdict == f"it is {AB2}, started by forward_euler"


def test_a_right_hand_side_that_is_asked_beside_the_states_is_a_fault_that_is_said_once():
    for sigma, end in ((None, f"{AB2}, but {BESIDE}"), ([-1 / 3, 4 / 3, 0.0], f"instead of 3/2; {BESIDE}")):
        report = identify(Displaced(AB2, euler, sigma=sigma).step, isolate=False)
        assert report.section("Faults").lines == (BESIDE,)
        assert report.verdict.endswith(end)
        assert report.verdict.count(BESIDE) == 1


@pytest.mark.parametrize(
    ("step", "key", "words"),
    [
        (lambda f, y0, ts: planted.run_of_adams_bashforth2(f, y0, ts)[-1], AB2, "returns only its last state"),
        (lambda q, v, h: (q + h * v, v - h * q), "bdf2", "its system is built in"),
        *(
            (step, AB2, "\nWhat would decide it\n  start: a stepper that keeps its memory")
            for step in (planted.in_the_module, planted.in_a_default)
        ),
    ],
)
def test_what_cannot_be_seen_leaves_it_undecided(step, key, words):
    report = verify(step, key, isolate=False)
    assert report.passed is None
    assert words in (report.text() if "\n" in words else report.verdict)


def test_a_run_whose_later_steps_keep_no_recurrence_is_named_by_its_first_step_only():
    verdict = identify(planted.run_of_weights_that_change_with_h, isolate=False).verdict
    assert verdict.startswith("it is forward_euler; this holds for its first step only: with h = 0.5")
    assert "steps do not satisfy" in verdict


def test_a_run_whose_later_steps_were_not_seen_in_time_is_named_by_its_first_step_only(monkeypatch):
    late = type("Late", (Misbehaviour,), {"kind": "time_limit"})("the time is over")
    monkeypatch.setattr("driftproof.blackbox.identify.read_family", Mock(side_effect=late))
    verdict = identify(planted.run_of_adams_bashforth2, isolate=False).verdict
    assert verdict == "it is forward_euler; this holds for its first step only: the time is over"


def test_a_run_that_begins_as_another_method_is_not_that_one_and_one_of_its_steps_alone_is():
    report = verify(planted.run_of_adams_bashforth2, "forward_euler", isolate=False)
    assert report.verdict.startswith("is forward_euler for its first step only")
    assert report.passed is False
    assert verify(planted.run_of(lambda h: [[1.0]]), "forward_euler", isolate=False).passed


def test_a_recurrence_that_grows_is_said_to_be_unstable():
    step = Remembering("adams_bashforth2", euler)
    step.rho, step.sigma = [-5.0, 4.0, 1.0], [2.0, 4.0, 0.0]  # order 3, with a root at -5
    assert "it is not zero-stable" in identify(step.step, isolate=False).verdict


BASHFORTH2 = "satisfied to rounding in runs of 40 steps, after the start|rho = 0, -1, 1|sigma = -1/2, 3/2, 0|"
BASHFORTH2 += "the first step after a change of h has order 1"
ASKED, NOT = "F is evaluated at the states that it returns", "Recurrence: FAILED|not that of"
# What stands in the report, line by line, on a step that is held to a method.
CHECKS = [
    (Remembering(AB3, euler), AB3, f"Start: FAILED|{LATE}|step 1 is forward_euler|step 2"),
    (Remembering(AB3, euler), AB3, "has order 3; in whole runs order 2 is observed"),
    (Remembering(AB2, euler), AB2, f"Right-hand side: passed|{ASKED}||Start: passed|step 1"),
    (Remembering(AB2, euler), AB2, f"Order: passed|{AB2} has order 2; in whole runs order 2 is observed"),
    (Remembering(AB2, euler), AB2, f"Recurrence: passed|{AB2}: {BASHFORTH2}"),
    (Remembering(AB2, euler), AB3, f"{NOT} {AB3}|{AB2}: {BASHFORTH2}"),
    (Displaced(AB2, euler), AB2, f"Right-hand side: FAILED|{BESIDE}|"),
    (THIRDS, AB2, f"{NOT} {AB2}|sigma[0]: -1/3 instead of -1/2|no multistep method of the catalogue|nearest: adams_b"),
]


@pytest.mark.parametrize(("made", "passed", "said"), [
    (planted.OfLengths(), True, "started by heun2"), (planted.OfLengths(restarts=True), True, "started by heun2"),
    (Remembering(AB2, euler), True, "the first step after a change of h has order 1"),
    (planted.OfLengths(-1), None, "change of h has order 1, though it takes account of the change"),
])  # fmt: skip
def test_a_step_that_takes_account_of_a_change_of_h_has_to_keep_its_order_there(made, passed, said):
    report = verify(made.step, AB2, isolate=False)
    assert report.passed is passed
    assert report.verdict.endswith(said)
    with pytest.raises(ValueError, match=r"write: wrapped = OfLengths\(\).step$"):  # no run of equal steps
        verify(planted.OfLengths, AB2, isolate=False)


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize(("made", "key", "lines"), CHECKS, ids=range(len(CHECKS)))
def test_each_check_shows_its_evidence(made, key, lines):
    assert lines in verify(made.step, key, isolate=False).text().replace("\n  ", "|").replace("\n", "|")


def test_the_order_of_what_was_read_is_shown_and_order_1_is_consistent():
    report = identify(Remembering("adams_bashforth2", euler).step, isolate=False)
    assert report.section("Order").lines == ("order 2 of the recurrence: on y = t^3/3! it leaves the residual 5/12",)
    names = ("method", "rho", "sigma", "derivative", "order", "start", "measured_order")
    rows = (["0.0", "-1.0", "1.0"], ["-0.5", "1.5", "0.0"])
    assert [report.data[name] for name in names] == ["adams_bashforth2", *rows, 1, 2, ["forward_euler"], 2]
    of_order_1 = identify(Remembering("adams_bashforth2", euler, sigma=[-0.25, 1.25, 0.0]).step, isolate=False)
    assert of_order_1.data["faults"] == []
    assert identify(Stormer().step, isolate=False).data["derivative"] == 2
    assert identify(Displaced("adams_bashforth2", euler).step, isolate=False).data["method"] is None


def ramped(f, t, y, h):
    """A step of BDF3's start that is none known here: twice Euler's with half the length."""
    return euler(f, t + h / 2, euler(f, t, y, h / 2), h / 2)


# With how errors of the last first value and of the end of a run fall; nothing where another row tells.
STARTS = [
    (Remembering(AB2, euler).step, ("forward_euler",), 2, 2, "1.74, 1.89, 1.95, 1.97, 1.99, 1.99, 2.00",
     "1.82, 1.92, 1.97, 1.98, 1.99"),
    (Remembering("adams_bashforth4", rk4).step, ("rk4",) * 3, 5, 4, "", ""),
    (Remembering("bdf3", planted.implicit_euler).step, ("backward_euler",) * 2, 2, 2, "", ""),
    (Remembering(AB3, ramped).step, ("forward_euler, 2 steps of h/2",) * 2, 2, 2, "", ""),
    (planted.run_of_adams_bashforth3, ("rk4",) * 2, 5, 3, "3.84, 4.39, 4.61, 4.82, 4.92, 4.96, 4.98",
     "2.76, 2.90, 2.95, 2.97, 2.98"),
    (Stormer(right=False).step, ("",), 2, 1, "1.96, 1.98, 1.99, 2.00, 2.00, 2.00, 2.00",
     "0.99, 1.00, 1.00, 1.00, 1.00"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "methods", "power", "order", "first", "whole"), STARTS, ids=range(len(STARTS)))
def test_a_start_is_named_and_its_errors_measured(step, methods, power, order, first, whole):
    runs = MarkedRuns.of(opened(step))
    start = read_start(runs, read_recurrence(runs))
    assert (start.methods, start.power, start.order) == (methods, power, order)
    assert (len(start.slopes), len(start.order_slopes)) == (7, 5)
    *_, begun, ended = start.lines
    slopes = re.escape(first) or r"(-?\d+\.\d\d, )*-?\d+\.\d\d"
    assert re.search(rf"of its first values fall like h\^{power} \(slopes: {slopes}\)$", begun)
    assert ended.startswith(f"order {order} is observed in whole runs, the start included, on ")
    assert ended.endswith(f" (slopes: {whole})" if whole else ")")


def test_of_one_that_needs_no_start_the_first_step_is_looked_at():
    runs = MarkedRuns.of(opened(lambda f, t, y, h: y + 0.875 * h * f(t, y)))
    *_, begun, ended = read_start(runs, read_recurrence(runs)).lines
    assert begun.endswith(" (slopes: 1.47, 1.44, 1.32, 1.04, 0.97, 0.99, 0.99)")
    assert ended.endswith(" (slopes: -0.20, -0.11, -0.06, -0.03, -0.01)")


def late_bashforth(late=0.0):
    """Adams-Bashforth of two steps after one of Euler's; earlier states are asked at a time that is `late`."""

    def run(f, t, y, h, n):
        states = [np.asarray(y, float)]
        for i in range(n):
            at, here = t + i * h, f(t + i * h, states[-1])
            before = f(at - h + late * h, states[-2]) if i else here
            states.append(states[-1] + h / 2 * (3 * here - before))
        return np.array(states)

    return run


def late_bdf2(late=0.0):
    def run(f, t, y, h, n):
        states = [np.asarray(y, float)]
        for i in range(n):
            known, part = (4 * states[-1] - states[-2]) / 3 if i else states[-1], 2 * h / 3 if i else h
            z = states[-1]
            for _ in range(100):
                z = known + part * f(t + (i + 1 - late) * h, z)
            states.append(z)
        return np.array(states)

    return run


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("made", "key"), [(late_bashforth, "adams_bashforth2"), (late_bdf2, "bdf2")])
def test_a_method_that_is_called_at_wrong_times_is_told_by_its_steps_without_time(made, key):
    assert verify(made(), key, isolate=False).verdict.startswith(f"is {key} in steps of equal length")
    late = verify(made(1.0), key, isolate=False)
    assert late.passed is False
    assert f"it is {key} called at wrong times: it is that method only where F does not depend on t" in late.verdict
    assert "instead of" not in late.text()
