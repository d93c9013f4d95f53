"""identify, from end to end: what a stepper is comes out in words, as text, Markdown and JSON, and what to do first."""

from __future__ import annotations

import json
import random
import re

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from tests.blackbox import broken_steppers
from tests.blackbox.handwritten_steppers import rk38
from tests.blackbox.transcripts import summed


def with_drag(q, v, h):
    v = v + h * (-4 * q - 0.04 * v)
    return q + h * v, v


def half_moved(q, v, h):
    return q + h * v / 2, v - h * q


def two_half_steps(q, v, h):
    for _ in range(2):
        v = v - h / 2 * q
        q = q + h / 2 * v
    return q, v


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("step", [rk38, with_drag, half_moved, two_half_steps])
def test_a_stepper_is_named(step, as_before):
    as_before(*summed(identify(step)))


@pytest.mark.parametrize(("step", "seen"), [
    (broken_steppers.hangs, "no answer within"), (broken_steppers.crashes, "SIGSEGV"),
    (broken_steppers.returns_nan, "nan"),
])  # fmt: skip
def test_a_rogue_is_a_finding(step, seen):
    text = identify(step, time_limit=1.0 if step is broken_steppers.hangs else 60.0).text()
    assert seen in text
    assert "--all" not in text
    assert ("give it more time: --time-limit" in text) == (step is broken_steppers.hangs)
    _, _, unanswered = text.partition("Not answered\n")
    lines = unanswered.splitlines()
    assert len(lines) == len(set(lines)) < 4


def test_an_iteration_to_a_loose_tolerance_is_named_with_what_it_leaves():
    def midpoint(force, q, v, h):  # to an absolute tolerance, so that tiny states are stepped with fewer iterations
        middle, before = (q, v), (float("inf"), 0.0)
        while max(abs(x - y) for x, y in zip(middle, before, strict=True)) > 1e-6:
            before = middle
            middle = q + h / 2 * before[1], v + h / 2 * force(before[0])
        return q + h * middle[1], v + h * force(middle[0])

    report = identify(midpoint)
    assert report.verdict.startswith("it is implicit_midpoint")
    assert "--method implicit_midpoint --solver-tolerance 1e-10, or" in report.section("What to do").lines[-1]
    assert re.search(r"its stages are solved to \d.\de-0[78]", "".join(report.section("Coefficients").lines))


def test_an_iteration_that_keeps_its_first_guess_is_asked_for_its_order_in_floats():
    kept = {}

    def midpoint(f, t, y, h):
        slope = kept.get(len(y), 0 * y)
        for _ in range(100):
            before, slope = slope, np.asarray(f(t + h / 2, y + h / 2 * slope))
            if max(abs(slope - before)) <= 1e-15:
                break
        kept[len(y)] = slope if all(abs(slope) < 1e3) else 0 * y
        return y + h * slope

    report = identify(midpoint)
    assert report.verdict == "it is implicit_midpoint"
    assert report.section("Not answered") is None
    assert report.section("Order").lines[1].startswith("order 2 is observed on a nonlinear problem of 4 components")


def speed_limited(force, q, v, h):
    v = max(-8.0, min(8.0, v + h * force(q)))
    return q + h * v, v


def test_a_method_behind_a_limit_is_named_with_the_size_at_which_it_holds():
    report = identify(speed_limited)
    assert report.verdict == "it is symplectic_euler, at states of size 3.1e-02, not at every size"
    assert "|v| is capped at 8" in report.section("Faults").lines
    assert "every error within the derived bound" in report.section("Rounding").lines[0]


def noisy(part):
    draw = random.Random(1)

    def heun(f, t, y, h):
        k = f(t, y)
        return (y + h / 2 * (k + f(t + h, y + h * k))) * (1 + part * draw.choice((0, 1)))

    return heun


def test_a_step_that_varies_in_its_last_bit_is_named_and_said_to_vary():
    report = identify(noisy(2.0**-52))
    assert report.verdict.startswith("it is heun2")
    assert any("answers up to 1 ulp apart" in line or "answers up to 2 ulp apart" in line for line in _faults(report))
    assert not any("depends on t" in line for line in _faults(report))
    assert report.section("Not answered") is None


def test_a_step_that_varies_by_more_is_not_named():
    report = identify(noisy(2.0**-30))
    assert "heun2" not in report.verdict
    assert not any("ulp" in line for line in _faults(report))


def test_an_end_from_outside_asks_for_no_more_time():
    lines = identify(broken_steppers.is_killed).section("What to do").lines
    assert lines == ("try again where nothing kills its process; running out of memory also kills processes",)


def test_the_report_is_json_markdown_and_text():
    report = identify(rk38)
    data = json.loads(report.json())
    assert (data["method"], data["order"], data["calls"]) == ("rk38", 4, "field")
    assert report.markdown().startswith("### `")
    assert str(report) == report.text()
    assert [section.title for section in report.sections[:2]] == ["What to do", "Coefficients"]
    assert "driftproof verify" in report.section("What to do").lines[0]
    brief = r"^  \d\d passed, \d on traits such as areas; --all \(in Python, \.text\(True\)\) shows each$"
    assert re.search(brief, report.text(), re.MULTILINE)
    assert "h = 0 returns the state unchanged" in report.text(everything=True)


def test_what_to_do_with_a_lambda_is_no_command_that_cannot_work():
    (first, *_) = identify(lambda q, v, h: (q + h * v, v - h * (q + h * v))).section("What to do").lines
    assert f"give it a NAME in its module, then driftproof verify {__name__}:NAME --method" in first


def _faults(report):
    return report.section("Faults").lines


TABLE = 'family = "runge_kutta"\nclaimed_order = 3\nA = [[0], ["1/2", 0], [0, "3/4", 0]]\nb = ["2/9", "1/3", "4/9"]\n'


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("change", "verdict", "answered"), [
    (("4/9", "4/9"), "it is ralston3", True),
    (("4/9", "1/3"), "it is ralston3 except for b[2]: 1/3 instead of 4/9", True),
    (("3/4", "4/5"), "it is ralston3 except for a[2][1]: 4/5 instead of 3/4", True),
    (('[0, "3/4", 0]]\nb = ["2/9", "1/3", "4/9"]', '["1/2", "1/2", 0]]\nb = ["1/4", "3/8", "3/8"]'),
     "it is not a known method", False),
])  # fmt: skip
def test_a_table_is_compared_exactly(tmp_path, change, verdict, answered):
    path = tmp_path / "mine.toml"
    path.write_text(TABLE.replace(*change))
    found = identify(path)
    assert (found.verdict, found.answered, found.passed) == (verdict, answered, None)
    assert found.data["method"] == ("ralston3" if change[0] == change[1] else None)
    assert bool(found.section("Catalogue")) == answered
    assert identify(str(path)).verdict == verdict
    assert any("claimed order 3, has" in line for line in found.section("Order").lines) == (change[0] != change[1])


def test_what_no_table_is(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(TABLE)
    with pytest.raises(ValueError, match="is a table, which nothing calls"):
        identify(path, calls="field")
    path.write_text('family = "runge_kutta"\nparameter = "x"\nA = [[0], ["x", 0]]\nb = [0, 1]\n')
    with pytest.raises(ValueError, match="is a family; one method is needed, such as"):
        identify(path)
    assert identify(f"{path} at 1/2").verdict == "it is midpoint2"
