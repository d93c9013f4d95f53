"""Which multistep method a stepper is, by key or by what is wrong; planted twins fail, right ones do not."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import FACTS_ONLY
from driftproof.methods.multistep import Multistep
from tests.blackbox.families import remembering_steppers as planted
from tests.blackbox.families.remembering_steppers import Corrected, Displaced, Remembering, Stormer, euler, rk4_step
from tests.blackbox.transcripts import to_twelve_digits

EXPLICIT = [key for key, m in FACTS_ONLY.items() if isinstance(m, Multistep) and m.explicit and m.derivative == 1]
IMPLICIT = ["adams_moulton2", "adams_moulton4", "bdf2", "bdf3", "bdf6", "milne_simpson"]

NAMED = {
    "adams_bashforth2, started by forward_euler": lambda: Remembering("adams_bashforth2", euler).step,
    "adams_bashforth3, started by rk4": lambda: planted.run_of_adams_bashforth3,
    "bdf2, started by backward_euler": lambda: Remembering("bdf2", planted.implicit_euler).step,
    "two_step_leapfrog, started by forward_euler": lambda: Remembering("two_step_leapfrog", euler).step,
    "adams_moulton3, corrected once from what adams_bashforth4 predicts (PECE), started by rk4": (
        lambda: Corrected("adams_moulton3", rk4_step, planted.BASHFORTH4).step
    ),
    "adams_moulton2, corrected 2 times from what forward_euler predicts (PECECE), started by rk4": (
        lambda: planted.without_times(Corrected("adams_moulton2", rk4_step, [1.0], times=2))
    ),
}


@pytest.mark.parametrize("key", [*EXPLICIT, *IMPLICIT])
def test_a_method_that_is_started_well_enough_passes_as_itself(key):
    report = verify(Remembering(key, rk4_step).step, key, isolate=False)
    assert report.passed is (FACTS_ONLY[key].claimed_order <= 5), report.text()
    assert report.passed or "its start is not good enough: first values are off like h^5" in report.verdict


@pytest.mark.parametrize(("words", "make"), NAMED.items())
def test_a_stepper_is_named_with_its_start(words, make):
    assert identify(make(), isolate=False).verdict == f"it is {words}"


@pytest.mark.parametrize(
    "step", [planted.in_a_closure(), planted.generated_adams_bashforth2, planted.run_of_adams_bashforth2]
)
def test_what_remembers_is_read_in_every_form(step):
    assert identify(step, isolate=False).verdict == "it is adams_bashforth2, started by forward_euler"


@pytest.mark.parametrize(
    ("step", "key", "words"),
    [
        (
            Remembering("adams_bashforth2", euler, sigma=[-1 / 3, 3 / 2, 0.0]).step,
            "adams_bashforth2",
            "adams_bashforth2 but for sigma[0]: -1/3 instead of -1/2",
        ),
        (
            Remembering("adams_bashforth4", euler).step,
            "adams_bashforth4",
            "its start is not good enough: first values are off like h^2, and whole runs have order 2, not 4",
        ),
        (Remembering("adams_bashforth2", euler).step, "adams_bashforth3", "it is adams_bashforth2"),
        (
            Corrected("adams_moulton3", rk4_step, planted.BASHFORTH4).step,
            "adams_moulton3",
            "asked at what adams_bashforth4 predicts",
        ),
        (Remembering("bdf2", euler, most=1).step, "bdf2", "its equations are solved to"),
        (
            Displaced("adams_bashforth2", euler).step,
            "adams_bashforth2",
            "its right-hand side is not asked at the states that it returns",
        ),
        (
            lambda f, t, y, h: y + 0.875 * h * f(t, y),
            "adams_bashforth2",
            "each step is made of the state before alone; it is not consistent: rho'(1) - sigma(1) = 1/8",
        ),
        (lambda f, t, y, h: y + 0 * f(t, y), "adams_bashforth2", "each step is made of the state before alone"),
        (Stormer(right=False).step, "stormer2", "first values are off like h^2"),
        (rk4_step, "adams_bashforth4", "its steps keep no recurrence of up to 8 steps"),
    ],
)
def test_a_wrong_one_fails_with_its_cause(step, key, words):
    report = verify(step, key, isolate=False)
    assert report.passed is False, report.text()
    assert words in report.verdict


def test_stormers_positions_are_told_from_velocity_verlets_velocities():
    assert verify(Stormer().step, "stormer2", isolate=False).passed
    assert "it is stormer2" in identify(Stormer().step, isolate=False).verdict


def test_a_right_hand_side_that_is_asked_beside_the_states_is_a_fault_that_is_said_once():
    beside = "its right-hand side is not asked at the states that it returns"
    for sigma, end in ((None, f"adams_bashforth2, but {beside}"), ([-1 / 3, 4 / 3, 0.0], f"instead of 3/2; {beside}")):
        report = identify(Displaced("adams_bashforth2", euler, sigma=sigma).step, isolate=False)
        assert report.section("Faults").lines == (beside,)
        assert report.verdict.endswith(end)
        assert report.verdict.count(beside) == 1


def test_a_recurrence_of_no_fractions_is_told_by_its_digits():
    step = Remembering("adams_bashforth2", euler, sigma=[1 - pi / 2, pi / 2, 0.0]).step
    assert to_twelve_digits(identify(step, isolate=False).verdict) == (
        "it is a multistep method of 2 steps, adams_bashforth2 but for sigma[0]: -0.570796326795 instead of -1/2; "
        "sigma[1]: 1.57079632679 instead of 3/2, started by forward_euler"
    )


def test_a_start_by_several_methods_is_told_step_by_step():
    assert identify(planted.run_of_three_methods, isolate=False).verdict == (
        "it is adams_bashforth3, started by forward_euler and adams_bashforth2; its start is not good enough: first "
        "values are off like h^2, and whole runs have order 2, not 3"
    )


def test_a_run_that_returns_its_last_state_alone_leaves_it_undecided():
    report = verify(lambda f, y0, ts: planted.run_of_adams_bashforth2(f, y0, ts)[-1], "adams_bashforth2", isolate=False)
    assert report.passed is None
    assert "a run returns no state but its last one" in report.verdict


def test_a_run_whose_later_steps_keep_no_recurrence_is_named_by_its_first_step_only():
    verdict = identify(planted.run_of_weights_that_change_with_h, isolate=False).verdict
    assert verdict.startswith("it is forward_euler; that is its first step only: with h = 0.5")
    assert "steps do not keep" in verdict


def test_a_start_that_cannot_be_seen_leaves_it_undecided():
    report = verify(planted.in_the_module, "adams_bashforth2", isolate=False)
    assert report.passed is None
    assert report.section("What would decide it").lines[0].startswith("start: a stepper that keeps what it remembers")


def test_a_run_that_begins_as_another_method_is_not_that_one():
    report = verify(planted.run_of_adams_bashforth2, "forward_euler", isolate=False)
    assert report.verdict.startswith("is forward_euler for its first step only")
    assert report.passed is False


def test_a_run_of_a_one_step_method_stays_one():
    def run(f, y0, ts):
        states = [y0]
        for t, after in pairwise(ts):
            states.append(euler(f, t, states[-1], after - t))
        return states

    assert identify(run, isolate=False).verdict == "it is forward_euler"
    assert verify(run, "forward_euler", isolate=False).passed


def test_a_recurrence_that_grows_is_said_to_be_unstable():
    step = Remembering("adams_bashforth2", euler)
    step.rho, step.sigma = [-5.0, 4.0, 1.0], [2.0, 4.0, 0.0]  # order 3, with a root at -5
    assert "it is not zero-stable" in identify(step.step, isolate=False).verdict


def test_a_stepper_with_its_system_built_in_leaves_it_undecided():
    report = verify(lambda q, v, h: (q + h * v, v - h * q), "bdf2", isolate=False)
    assert report.passed is None
    assert "its system is built in" in report.verdict


LATE = "its start is not good enough: first values are off like h^2, and whole runs have order 2, not 3"
BASHFORTH2 = (
    "kept to rounding in runs of 40 steps, after the start|rho = 0, -1, 1|sigma = -1/2, 3/2, 0|steps of one length"
)
AB2, NOT = "adams_bashforth2", "Recurrence: FAILED|not that of"
# What stands in the report, line by line, on a step that is held to a method.
CHECKS = [
    (
        Remembering("adams_bashforth3", euler),
        "adams_bashforth3",
        f"Start: FAILED|{LATE}|step 1 is forward_euler|step 2",
    ),
    (Remembering("adams_bashforth3", euler), "adams_bashforth3", "has order 3; in whole runs order 2 is seen"),
    (
        Remembering(AB2, euler),
        AB2,
        "Right-hand side: passed|F is asked at the states that it returns||Start: passed|step 1",
    ),
    (Remembering(AB2, euler), AB2, "Order: passed|adams_bashforth2 has order 2; in whole runs order 2 is seen"),
    (Remembering(AB2, euler), AB2, f"Recurrence: passed|adams_bashforth2: {BASHFORTH2}"),
    (Remembering(AB2, euler), "adams_bashforth3", f"{NOT} adams_bashforth3|adams_bashforth2: {BASHFORTH2}"),
    (
        Displaced(AB2, euler),
        AB2,
        "Right-hand side: FAILED|its right-hand side is not asked at the states that it returns|",
    ),
    (
        Remembering(AB2, euler, sigma=[-1 / 3, 3 / 2, 0.0]),
        AB2,
        f"{NOT} adams_bashforth2|sigma[0]: -1/3 instead of -1/2|no multistep method of the catalogue|nearest: adams_b",
    ),
]


@pytest.mark.parametrize(("made", "key", "lines"), CHECKS, ids=range(len(CHECKS)))
def test_each_check_shows_its_evidence(made, key, lines):
    assert lines in verify(made.step, key, isolate=False).text().replace("\n  ", "|").replace("\n", "|")


def test_the_order_of_what_was_read_is_shown_and_order_1_is_consistent():
    report = identify(Remembering("adams_bashforth2", euler).step, isolate=False)
    assert report.section("Order").lines == ("order 2 of the recurrence: on y = t^3/3! it leaves 5/12",)
    names = ("method", "rho", "sigma", "derivative", "order", "start", "measured_order")
    rows = (["0.0", "-1.0", "1.0"], ["-0.5", "1.5", "0.0"])
    assert [report.data[name] for name in names] == ["adams_bashforth2", *rows, 1, 2, ["forward_euler"], 2]
    of_order_1 = identify(Remembering("adams_bashforth2", euler, sigma=[-0.25, 1.25, 0.0]).step, isolate=False)
    assert of_order_1.data["faults"] == []
    assert identify(Stormer().step, isolate=False).data["derivative"] == 2
    assert identify(Displaced("adams_bashforth2", euler).step, isolate=False).data["method"] is None
