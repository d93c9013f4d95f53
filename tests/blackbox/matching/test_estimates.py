"""An error estimate is named where it is a pair's own, and what is wrong with another one is said; twins are not."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.matching.estimates import judged_estimate
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox.pair_steppers import but_one, pair_step
from tests.blackbox.probes.test_estimate import FORMS, relative
from tests.blackbox.transcripts import Asked

PAIRS = [key for key, m in METHODS.items() if getattr(m, "b_embedded", None) is not None and m.explicit]


RELATIVE = ("the error estimate is already relative: it is divided by the size of y before any tolerance",)


def judged(step):
    return judged_estimate(opened(step, "field"))


# The order of a decimal table is read from floats, in which its residuals do not show.
@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("key", [*PAIRS, *(f"{key}_embedded" for key in PAIRS)])
def test_every_pair_of_the_catalogue_is_named_with_both_its_rows(key):
    found, pair = judged(pair_step(key)), METHODS[key]
    assert (found.pair, found.faults) == (key, ())
    assert {found.propagated_order, found.other_order} == {pair.claimed_order, pair.embedded_order}
    assert found.propagated_order == pair.claimed_order
    assert found.order == min(pair.claimed_order, pair.embedded_order)


# The first weight of the one is above 0, of the other below: no absolute value tells.
@pytest.mark.parametrize(("key", "order"), [("dormand_prince54", 4), ("bogacki_shampine32", 2)])
@pytest.mark.parametrize("name", FORMS)
def test_no_form_of_a_right_estimate_is_at_fault(name, key, order, as_before):
    found = judged(pair_step(key, FORMS[name][0]))
    as_before(*found.lines)
    assert (found.pair, found.faults, found.order, found.other_order) == (key, (), order, order)


def second(factor):
    """A change of the second number alone."""
    return lambda y1, error, h, y: (y1, np.array([x * (factor if i == 1 else 1) for i, x in enumerate(error)]))


WRONG = {
    "always 0": {"answer": lambda y1, error, h, y: (y1, 0 * y)},
    "twice": {"answer": lambda y1, error, h, y: (y1, 2 * error)},
    "per unit step": {"answer": lambda y1, error, h, y: (y1, error / h)},
    "relative": {"answer": relative}, "another sign": {"estimate": but_one(2, 71 / 16695)},
    # The weights of the other row in place of the difference, of the kind of OrdinaryDiffEq.jl#4403.
    "a row": {"estimate": lambda e: [5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40]},
    "the last sign": {"estimate": but_one(6, 1 / 40)}, "0 in one number": {"answer": second(0)},
    "twice in one number": {"answer": second(2)},
    "of one number": {"answer": lambda y1, error, h, y: (y1, abs(error[0]))},
    "half in short steps": {"answer": lambda y1, error, h, y: (y1, error if h > 0.3 else error / 2)},
    "another one back": {"answer": lambda y1, error, h, y: (y1, error if h > 0 else -2 * error)},
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_estimate_says_what_is_wrong(name, as_before):
    asked = Asked(pair_step("dormand_prince54", **WRONG[name]))
    found = judged(asked.code)
    assert found.faults
    as_before(found.data, asked)


@pytest.mark.parametrize("key", ["dormand_prince54", "bogacki_shampine32"])
def test_an_estimate_in_units_of_tolerances_that_the_step_takes_is_judged_without_them(key):
    step = pair_step(key)

    def scaled(f, t, y, h, rtol=1e-6, atol=1e-9):
        y1, error = step(f, t, y, h)
        return y1, np.sqrt(np.mean((error / (atol + rtol * np.maximum(abs(y), abs(y1)))) ** 2))

    assert (judged(scaled).pair, judged(scaled).faults) == (key, ())
    assert judged(lambda f, t, y, h, atol=1.0: relative(*step(f, t, y, h), h, y)).faults == RELATIVE
    assert judged(lambda f, t, y, h, rtol=1.0: relative(*step(f, t, y, h), h, y)).faults == RELATIVE


@pytest.mark.parametrize("key", ["dop853", "dop853_third"])
def test_of_two_pairs_with_one_tableau_the_estimate_names_its_own(key):
    found = judged(pair_step(key, estimate=lambda e: [2 * x for x in e]))
    assert (found.pair, found.faults) == (key, (f"the error estimate is 2 times that of {key}",))


def test_a_call_beyond_the_stages_does_not_enter_an_estimate():
    def asking_again(f, t, y, h):
        y1, error = pair_step("fehlberg45")(f, t, y, h)
        return y1 + 0 * np.array(f(t + h, y1)), error

    found = judged(asking_again)
    assert (found.pair, found.faults, found.order) == ("fehlberg45", (), 4)


@pytest.mark.slow
def test_reports_name_both_rows_and_the_fault_and_a_pair_is_held_to_both():
    named = identify(pair_step("dormand_prince54_embedded"), isolate=False)
    assert named.verdict == (
        "it is dormand_prince54, with the embedded weights propagated: the row of order 4, not that of order 5"
    )
    assert "the row of order 4 is propagated, the other one has order 5" in named.section("Error estimate").lines
    zero = pair_step("cash_karp54", lambda y1, error, h, y: (y1, 0 * y))
    assert identify(zero, isolate=False).verdict == "it is cash_karp54; the error estimate is always 0"
    right = verify(pair_step("bogacki_shampine32"), "bogacki_shampine32", examples=20, isolate=False)
    assert right.passed
    assert right.data["error_estimate"]["passed"]


def test_a_time_beside_the_state_is_no_estimate():
    timed = lambda f, t, y, h: (pair_step("bogacki_shampine32")(f, t, y, h)[0], t + h)
    with pytest.raises(UnsupportedCall):
        judged(timed)


# As of a code that has more digits than the 15 decimals of the source.
TSITOURAS = (
    -0.00178001105222577714,
    -0.0008164344596567469,
    0.007880878010261995,
    -0.1447110071732629,
    0.5823571654525552,
    -0.45808210592918697,
    1 / 66,
)


@pytest.mark.parametrize(("off", "right"), [(0.0, True), (1e-13, False)])
def test_an_estimate_is_that_of_a_rounded_source_to_its_digits(off, right):
    step = pair_step("tsitouras54", estimate=lambda e: [TSITOURAS[0] + off, *TSITOURAS[1:]])
    found = judged_estimate(opened(step, "field"), METHODS["tsitouras54"])
    assert (found.pair, not found.faults) == ("tsitouras54" if right else None, right)


def cut(y1, error, h, y):
    return y1, np.minimum(error, 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("key", ["verner65", "verner76"])
def test_an_estimate_of_stages_called_in_another_order_is_held_to_the_stages_that_they_are(key):
    stages = [*range(METHODS[key].stages)]
    late = max(i for i in stages if METHODS[key].a[i][i - 1] == 0)
    order = [*stages[: late - 1], late, *stages[late - 1 : late], *stages[late + 1 :]]
    assert verify(pair_step(key, order=order), key, examples=20, isolate=False).passed
    spoiled = pair_step(key, order=order, estimate=but_one(late, 1 / 7))
    said = verify(spoiled, key, examples=20, isolate=False).verdict
    assert said.startswith(f"is {key}, but the error estimate is not that of {key}; it differs in e[{late - 1}]: 1/7")


@pytest.mark.parametrize(("key", "passed"), [("bogacki_shampine32", None), ("ralston3", True)])
def test_an_estimate_that_is_not_read_leaves_a_pair_undecided_and_no_other_method(key, passed):
    report = verify(pair_step("bogacki_shampine32", cut), key, examples=20, isolate=False)
    assert report.passed is passed
    seen = "with other answers, what it returns besides y1 is 0.001 where"
    assert f"error estimate{' is not judged' * bool(passed)}: {seen}" in report.verdict
    decides = report.section("What would decide it")
    assert passed or decides.lines[0].startswith("error estimate: an estimate that is a sum of the slopes")


SPOILED = {
    "two other weights": but_one(1, 1 / 7),
    "another row": lambda e: [1 / 3, -1 / 3, *[0.0] * (len(e) - 2)],
    "a third": lambda e: [x / 3 for x in e],
    "pi times": lambda e: [3.14159 * x for x in e],
    "backwards": lambda e: [-x for x in e],
    "two weights off": lambda e: [e[0] + 0.1, e[1], e[2] - 0.1, *e[3:]],
    "three weights off": lambda e: [e[0] + 0.1, e[1], e[2] + 0.1, e[3] - 0.1, *e[4:6], e[6] - 0.1],
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("name", SPOILED)
@pytest.mark.parametrize("form", ["a difference", "absolute"])
def test_all_that_is_said_of_an_estimate_is_what_it_was(name, form, as_before):
    step = pair_step("dormand_prince54", FORMS[form][0], estimate=SPOILED[name])
    found = [judged_estimate(opened(step, "field"), held) for held in (None, METHODS["fehlberg45"])]
    assert all(each.lines for each in found)
    as_before(*(each.data for each in found))


# A third of the weights may be off, of four one, but no more than three.
OFF = [("heun_euler21", 1, 1), ("bogacki_shampine32", 1, 1), ("bogacki_shampine32", 2, 0)]
OFF += [("fehlberg78", 3, 3), ("fehlberg78", 4, 0)]


@pytest.mark.parametrize(("key", "off", "named"), OFF)
def test_the_weights_that_are_off_are_named_where_they_are_few(key, off, named):
    step = pair_step(key, estimate=lambda e: [x + 0.1 * (i < off) for i, x in enumerate(e)])
    (words,) = (each for each in judged(step).faults if each.startswith(f"the error estimate is not that of {key}"))
    assert words.count(" instead of ") == named


def test_the_other_row_is_found_of_either_sign_of_an_estimate_that_is_of_no_known_pair():
    step = pair_step("dormand_prince54_embedded", estimate=SPOILED["backwards"])
    found = judged_estimate(opened(step, "field"), METHODS["fehlberg45"])
    assert (found.pair, found.propagated_order, found.other_order) == (None, 4, 5)
