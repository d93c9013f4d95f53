"""The law of step sizes comes out as it went in; a solver without one, and one with traces of rejections, say so."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.controller import bumps, read_controller
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver, taken_by
from driftproof.blackbox.solvers.steps import read_steps
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS
from tests.blackbox.solvers.planted_solvers import adaptive, fixed, of_scipy
from tests.blackbox.transcripts import Asked
from tests.looping import some


def read(solve):
    subject = ForeignSolver(solve, ARRAYS, *taken_by(solve))
    return read_controller(subject, read_steps(subject))


PI = {"key": "dormand_prince54", "safety": 0.9, "exponent": 0.17, "memory": 0.04, "least": 0.2, "most": 10.0}
PI_LAW = (0.9, Fraction(17, 100), Fraction(1, 25), 0.2, 10.0)
LAWS = {
    "as planted": ({}, (0.8, Fraction(1, 3), 0, 0.25, 4.0)),
    "PI": (PI, PI_LAW), "PI after a long step": ({**PI, "first_step": 0.21}, PI_LAW),
    "PI after no error": ({**PI, "first_error": 1e-4}, PI_LAW), "filtered": ({**PI, "filtered": 0.125}, PI_LAW),
    "of low order": ({"key": "heun_euler21", "exponent": 0.5}, (0.8, Fraction(1, 2), 0, 0.25, 4.0)),
    "per unit of time": ({"key": "fehlberg45", "exponent": 0.25, "safety": 0.84, "least": 0.1, "per_unit": True},
        (0.84, Fraction(1, 4), 0, 0.1, 4.0)),
    "per unit of time, with rtol alone": ({"key": "fehlberg45", "exponent": 0.25, "safety": 0.84, "least": 0.1,
        "per_unit": True, "tolerances": lambda rtol, atol: (0.0, rtol)}, (0.84, Fraction(1, 4), 0, 0.1, 4.0)),
    "of two stages and a first step of its own": (
        {"key": "heun_euler21", "exponent": 0.5, "chooses_first_step": True}, (0.8, Fraction(1, 2), 0, 0.25, 4.0)),
    "of step doubling": ({"key": "rk4_doubling54", "exponent": 0.2}, (0.8, Fraction(1, 5), 0, 0.25, 4.0)),
    "of another pair": ({"key": "cash_karp54", "exponent": 0.2}, (0.8, Fraction(1, 5), 0, 0.25, 4.0)),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", LAWS)
def test_the_law_comes_out_as_it_went_in(name, as_before):
    switches, (safety, exponent, memory, least, most) = LAWS[name]
    asked = Asked(adaptive(**switches))
    found = read(asked.code)
    as_before(*found.lines, *found.faults, asked)
    law = found.law
    estimate = switches.get("key", "bogacki_shampine32") + " per unit of time" * ("per_unit" in switches)
    assert (law.estimate, law.exponent, law.memory) == (estimate, exponent, memory)
    # The scale of errors is known to a part in 10^6, of which a cube root is taken or so, by a least squares fit.
    assert [law.safety, law.smallest, law.largest] == pytest.approx([safety, least, most], rel=1e-4)
    assert law.after_rejection
    assert found.faults == ()
    assert ("(PI)" if memory else "(not PI)") in found.lines[0]


RULES = {
    "right": (lambda factor, rejections: factor, ""),
    "lazy": (lambda factor, rejections: 1.0 if 1 < factor < 1.2 else factor, ""),
    "late": (lambda factor, n: 0.9 if n == 3 else factor, "after 3 or more rejections in a row differ"),
    "at the second": (lambda factor, rejections: factor / 2 if rejections == 2 else factor, "after 2 or more"),
    "at every rejection": (lambda factor, rejections: 0.5 if rejections else factor, "after 1 or more"),
}


def test_the_law_of_steps_after_a_rejection_is_read_as_well():
    """As in Hairer and Wanner's programs: PI control, but for rejected steps."""
    law = read(adaptive(safety=0.9, exponent=7 / 30, memory=2 / 15, plain_after_rejection=1 / 3)).law
    assert (law.exponent, law.memory, law.exception) == (
        Fraction(7, 30), Fraction(2, 15), "; after a rejection 0.9 r^(-1/3)",
    )  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("share", "faults"), [(1.0, 0), (0.01, 1)])
def test_a_first_step_size_that_is_chosen_hides_no_estimate_of_two_stages(share, faults):
    """As of a pair of two stages in SciPy: the slope for the first step size is asked where the second stage may be."""
    scaled = lambda weights: [share * x for x in weights]
    found = read(adaptive("heun_euler21", exponent=0.5, chooses_first_step=True, estimate=scaled))
    assert found.law.exponent == Fraction(1, 2)
    assert ["steps are accepted with" in fault for fault in found.faults] == [True] * faults


# The textbook's step size becomes too small at a jump, where an estimate per unit of time stays large, and it raises.
STOPPED = {"key": "fehlberg45", "safety": 0.84, "per_unit": True, "raises": True}
GSL = {"key": "dormand_prince54", "safety": 0.9, "exponent": 1 / 6, "least": 0.2, "most": 5.0}
EXPONENTS = {
    "stopped by a jump": ({**STOPPED, "exponent": 1 / 4}, "", ""),
    "smaller, stopped by a jump": ({**STOPPED, "exponent": 1 / 5}, "", "is 1/5, for an estimate O(h^4) it is 1/4: an"),
    "smaller": (GSL, "", "is 1/6, for an estimate O(h^5) it is 1/5: an error r leaves r^(1/6)"),
    "smaller after accepted steps": ({**GSL, "plain_after_rejection": 1 / 5}, "", "after accepted steps is 1/6"),
    "half": ({**GSL, "exponent": 1 / 10}, "", "an error r leaves r^(1/2) in the next step, and settles more slowly"),
    "below half": ({**GSL, "exponent": 1 / 11}, "an error r leaves r^(6/11) in the next step, and settles very", ""),
    "larger": ({**GSL, "exponent": 1 / 4}, "r^(-1/4) in the next step, so that a step after a small error is", ""),
    "hardly larger": ({**GSL, "exponent": 21 / 100}, "", "r^(-1/20) in the next step, which its largest factor keeps"),
    "twice": ({"key": "heun_euler21", "exponent": 1}, "r^(-1) in the next step, and never settles", ""),
}  # fmt: skip


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("name", EXPONENTS)
def test_another_exponent_is_a_fault_only_if_its_step_sizes_do_not_settle_at_half_the_pace(name):
    switches, *words = EXPONENTS[name]
    found = read(adaptive(**switches))
    assert found.law.exponent == pytest.approx(switches["exponent"], rel=1e-4)
    said = ["; ".join(each) for each in (found.faults, found.remarks)]
    assert [(bool(each), word in each) for each, word in zip(said, words, strict=True)] == [
        (bool(word), True) for word in words
    ], said


TEXTBOOK = {"key": "fehlberg45", "exponent": 1 / 4, "safety": 0.84, "least": 0.1, "per_unit": True, "raises": True,
            "grows_after_rejection": True, "norm": np.linalg.norm}  # fmt: skip


def at_another_state(by):
    return lambda stage, y, moved: moved + (moved - y) * by if stage == 5 else moved


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("longest", "limits"), [
    (10.0, (0.1, 4.0, None)), (0.25, (None, None, None)), (0.02, (None, None, 0.02)),
])  # fmt: skip
@pytest.mark.parametrize("by", [0.0, 1 / 250])  # 3554/2565 in place of 3544/2565 is as much
def test_the_textbooks_own_control_is_read_also_where_one_step_alone_is_cut_by_a_limit(longest, limits, by):
    """R = |e|/h and 0.84 (tol/R)^(1/4); the law over itself one step before, in which 0.84 cancels, is no law."""
    found = read(adaptive(**TEXTBOOK, first_step=longest, longest=longest, state=at_another_state(by)))
    law = found.law
    assert (law.safety, law.exponent, law.memory, law.exception) == (0.84, Fraction(1, 4), 0, "")
    assert [law.smallest, law.largest, law.longest] == [x and pytest.approx(x, rel=1e-4) for x in limits]
    assert ("no step above 0.02 (" in law.words) == (longest == 0.02)
    assert ["as if a stage of fehlberg45" in fault for fault in found.faults] == [True] * bool(by)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "exponent", "by", "faults"), [
    ("fehlberg45", 1 / 4, 0.0, 0), ("dormand_prince54", 1 / 5, 0.0, 0), ("bogacki_shampine32", 1 / 3, 0.0, 0),
    ("fehlberg45", 1 / 4, 1 / 2500, 1),
])  # fmt: skip
def test_an_estimate_of_too_low_an_order_is_told_where_no_law_is_seen(key, exponent, by, faults):
    lawless = lambda factor, rejections: factor * (1 + (1e4 * factor % 1) / 10)
    per_unit = exponent == 1 / 4
    found = read(adaptive(key, exponent=exponent, per_unit=per_unit, changed=lawless, state=at_another_state(by)))
    assert found.law is None
    assert ["calls of f at a tolerance of 1e-05" in fault for fault in found.faults] == [True] * faults


@pytest.mark.slow
def test_an_error_per_unit_of_time_of_low_order_is_read_and_is_not_said_never_to_end():
    found = read(adaptive("heun_euler21", exponent=1, safety=0.9, per_unit=True))
    assert (found.law.estimate, found.law.exponent) == ("heun_euler21 per unit of time", 1)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("name", "law"), [*((name, "PI") for name in RULES), ("at the second", "as planted")])
def test_steps_after_rejections_that_are_not_of_the_law_are_said_with_it(name, law, as_before):
    rule, words = RULES[name]
    reading = read(adaptive(**LAWS[law][0], changed=rule))
    found = reading.law
    as_before(*reading.lines, *reading.faults)
    assert (words in found.exception) if words else found.exception == ""
    assert found.words.endswith(f"PI){found.exception}")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("ratio", "is_law"), [(0.5, True), (0.97, False)])
def test_what_most_step_sizes_contradict_is_no_law(ratio, is_law):
    """After a rejection, the shorter next attempts become by a ratio of their own, the more of them there are."""
    law = read(adaptive(changed=lambda factor, rejections: ratio if rejections else factor)).law
    assert (law is not None) == is_law


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("switches", "limit", "faults"), [
    ({}, 1, 0), ({"safety": 0.4}, 1, 0), ({"accepted": 2.0}, 2, 0),
    ({"accepted": 8.0, "safety": 0.9}, 8, 1),  # after which the law gives 0.9/2
    ({"estimate": lambda e: [x / 2 for x in e]}, 2, 0), ({"estimate": lambda e: [x / 1000 for x in e]}, 1000, 1),
])  # fmt: skip
def test_errors_accepted_above_the_tolerance_are_said_and_many_times_it_are_a_fault(switches, limit, faults):
    found = read(adaptive(**switches))
    assert 0.8 * limit < found.law.accepted <= limit * 1.000001  # the scale is known to a part in 10^6
    said = f"accepting up to {found.law.accepted:.3g} times the tolerance"
    assert ((said if limit > 1 else "accepting") in found.law.words) == (limit > 1)
    assert [fault.partition(" with ")[0] for fault in found.faults] == ["steps are accepted"] * faults


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("by", "faults"), [(1e-9, 1), (8e-14, 1), (4e-14, 0)])
def test_a_step_that_ends_elsewhere_is_counted_unless_rounding_explains_it(by, faults):
    def solve(f, t_span, y0, rtol, atol):
        found = adaptive()(f, t_span, y0, rtol, atol)
        found.y[len(found.t) // 2 :] += by * (len(found.t) > 100)  # in the run of many steps alone
        return found

    words = [fault.partition(" of ")[::2] for fault in read(solve).faults]
    assert [(count, rest.partition(" ")[2]) for count, rest in words] == [
        ("1", "steps are not steps of this method: they do not end where its weights give")
    ] * faults


AT = {
    "its own": lambda stage, y, moved: moved,
    "the start": lambda stage, y, moved: y if stage == 5 else moved,
    "an eighth beyond": lambda stage, y, moved: moved + (moved - y) / 8 if stage == 5 else moved,
}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("state", AT)
def test_a_stage_of_the_estimate_alone_at_another_state_is_told(state):
    """Fehlberg's sixth stage: its weight in the row propagated is 0, and slopes of t alone do not show its state."""
    faults = read(adaptive("fehlberg45", exponent=0.2, state=AT[state])).faults
    words = "most step sizes do not follow this law, as if a stage of fehlberg45 had another state in the estimate"
    assert [words in fault for fault in faults] == [True] * (state != "its own")


def test_the_bumps_are_of_both_signs_and_bounded():
    values = [bumps(n / 64) for n in range(128)]
    assert min(some(values, 128)) == -1.5 == -max(values)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("method", "estimate", "exponent"), [
    ("RK23", "bogacki_shampine32", 3), ("RK45", "dormand_prince54", 5),
    ("DOP853", "dop853 blended with dop853_third", 8),
])  # fmt: skip
def test_scipy_has_the_law_that_its_source_says(method, estimate, exponent):
    found = read(of_scipy(method))
    law = found.law
    assert (law.estimate, law.exponent, law.memory, law.after_rejection) == (estimate, Fraction(1, exponent), 0, True)
    assert law.exception == ""
    assert (law.safety, law.largest) == pytest.approx((0.9, 10.0), rel=1e-4)
    assert found.faults == ()


OTHERS = {
    "cut at a half": adaptive(least=0.5, safety=0.9),
    "longer or shorter": adaptive(changed=lambda factor, rejections: 4.0 if factor > 1 else 0.25),
    "leaping": adaptive(changed=lambda factor, rejections: 4.0 if 2 < factor < 2.5 else factor),
    "of the other order": adaptive("fehlberg45", exponent=0.25),
    "of another order": adaptive("cash_karp54", exponent=0.25),
    "grows after a rejection": adaptive(grows_after_rejection=True, most=1.5),
    "doubles at 0": adaptive(growth_at_zero=2.0),
    "stale": adaptive("fehlberg45", stale=True, exponent=0.2),
    "stale at an end": adaptive(stale=True), "accepts large errors": adaptive(accepted=100.0),
    "deaf": adaptive(tolerances=lambda rtol, atol: (1e-5, 1e-8)),
    "deaf to its error": adaptive(estimate=lambda e: [0.0] * len(e)),
    "another scale": adaptive(estimate=lambda e: [1.5 * x for x in e]),
    "of one length": fixed(40),
    "of so many steps": lambda f, t_span, y0, n: fixed(n)(f, t_span, y0, 0, 0),
    "of few steps": fixed(2), "of four": fixed(4), "of five": fixed(5), "of ten lengths": fixed(10, ratio=1.1),
    "of eleven": fixed(11, ratio=1.1),
    "of one tolerance": lambda f, t_span, y0, tol: adaptive("cash_karp54", exponent=1 / 5)(f, t_span, y0, 0.0, tol),
    "silent": adaptive("fehlberg78", exponent=1 / 8),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", OTHERS)
def test_what_is_seen_of_step_sizes_is_said(name, as_before):
    asked = Asked(OTHERS[name])
    try:
        found = read(asked.code)
        said = [*found.lines, *found.faults]
        assert (found.law is None) == (not said[0].startswith("measured"))
    except NotReadable as refusal:
        said = [str(refusal)]
    assert ("a step after a rejected one does not grow" in said) == (
        said[0].startswith("measured") and name != "grows after a rejection"
    )
    as_before(*said, asked)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "exponent", "advances"), [
    ("cash_karp54_embedded", 0.2, "the estimate of cash_karp54, but advances its lower-order row, of order 4"),
    ("cash_karp54", 0.2, ""),
    ("heun_euler21_embedded", 0.5, "the estimate of heun_euler21, but advances its lower-order row, of order 1"),
])  # fmt: skip
def test_a_solver_that_advances_the_other_row_than_the_one_it_estimates_is_told_so(key, exponent, advances):
    subject = ForeignSolver(adaptive(key, exponent=exponent))
    found = read_controller(subject, read_steps(subject))
    assert (found.remarks, found.faults) == ((f"controlled by {advances}",) * bool(advances), ())
    assert found.law.exponent == pytest.approx(exponent)


@pytest.mark.parametrize(("key", "factor", "said"), [
    ("bogacki_shampine32", 1.0, ""), ("bogacki_shampine32", 0.5, "0.406 to 0.56 times that of bogacki_shampine32"),
    ("bogacki_shampine32", 3.0, "2.87 to 3.1 times that of bogacki_shampine32"),
    ("rk4_doubling54", 1.0, ""), ("rk4_doubling54", 0.5, " times that of rk4_doubling54"),
    ("rk4_doubling54", 15 / 31, "rk4_doubling54, as with y2 - y1 divided by 31 in place of 15"),
    ("rk4_doubling54", 15.0, "rk4_doubling54, as with y2 - y1 divided by 1 in place of 15"),
])  # fmt: skip
def test_a_factor_of_the_estimate_shows_in_which_steps_are_accepted(key, factor, said):
    found = read(adaptive(key, exponent=1 / 3 if "32" in key else 0.2, estimate=lambda e: [factor * x for x in e]))
    assert found.faults == ()
    assert len(found.remarks) == bool(said)
    assert all(each.endswith(said) for each in found.remarks)
