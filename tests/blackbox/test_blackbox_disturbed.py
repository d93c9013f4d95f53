"""Steppers that hide their method: behind a limit, a rule of rest, noise in the last bit, or an iteration."""

from __future__ import annotations

import random
from time import sleep

import numpy as np
import pytest

from driftproof.blackbox.checks.step_size import sub_steps
from driftproof.blackbox.checks.suite import BRIEF, CHECKS, checks_of
from driftproof.blackbox.findings import Outcome
from driftproof.blackbox.identify import identify
from driftproof.blackbox.isolation import LEAST_LIMIT, IsolatedRunner
from driftproof.blackbox.matching.linear_match import linear_fit
from driftproof.blackbox.matching.match import matched
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import Target, opened
from tests.blackbox import rogues


def speed_limited(force, q, v, h):
    v = max(-8.0, min(8.0, v + h * force(q)))
    return q + h * v, v


def at_rest_below_a_speed(q, v, h):
    v = v - h * q
    v = v if abs(v) > 1e-3 else 0.0
    return q + h * v, v


def forwards_only(force, q, v, h):
    if h <= 0:
        return q, v
    v = v + h * force(q)
    return q + h * v, v


def test_a_method_behind_a_limit_is_named_with_the_size_at_which_it_holds():
    report = identify(speed_limited)
    assert report.verdict == "it is symplectic_euler, at states of size 3.1e-02, not of all sizes"
    assert "|v| is capped at 8" in report.section("Faults").lines
    assert "every error within the derived bound" in report.section("Rounding").lines[0]


def test_a_method_behind_a_rule_of_rest_is_read_at_large_states():
    found = linear_fit(opened(at_rest_below_a_speed))
    assert (found.best.methods, found.amplitude) == (("symplectic_euler",), 2.0**20)


def test_a_step_that_does_nothing_backwards_is_its_method_forwards():
    found = linear_fit(opened(forwards_only))
    assert found.best.methods == ("symplectic_euler",)
    assert found.best.restriction == "but only at h > 0"
    assert found.amplitude == 1.0


def test_no_limit_makes_a_method_of_what_is_none():
    def other(q, v, h):
        v = max(-8.0, min(8.0, v - 1.1 * h * q * (1 + h)))
        return q + h * v, v

    assert linear_fit(opened(other)).best is None


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


def _faults(report):
    return report.section("Faults").lines


RALSTON = (0.4, 0.45573725), (0.29697761, 0.15875964), (0.21810040, -3.05096516, 3.83286476)
WEIGHTS = (0.17476028, -0.55148066, 1.20553560, 0.17118478)


def ralston(nodes, second, third, weights):
    def step(f, t, y, h):
        k = [f(t, y)]
        k.append(f(t + nodes[0] * h, y + h * nodes[0] * k[0]))
        k.append(f(t + nodes[1] * h, y + h * (second[0] * k[0] + second[1] * k[1])))
        k.append(f(t + h, y + h * (third[0] * k[0] + third[1] * k[1] + third[2] * k[2])))
        return y + h * sum(b * slope for b, slope in zip(weights, k, strict=True))

    return step


def test_a_tableau_of_eight_decimals_is_named_with_them():
    near = matched(read_tableau(opened(ralston(*RALSTON, WEIGHTS)))).near
    assert [(n.key, n.differences) for n in near] == [
        ("ralston4", ("coefficients of 8 decimals, the last up to 2 off",))
    ]


def test_a_tableau_of_many_wrong_digits_is_not_said_to_be_rounded():
    changed = tuple(b + 3e-7 * (-1) ** i for i, b in enumerate(WEIGHTS))
    assert matched(read_tableau(opened(ralston(*RALSTON, changed)))).near == ()


def gauss2(f, t, y, h):
    """Its two stages by iteration, until they stand."""
    d = 3**0.5 / 6
    a, k = np.array([[0.25, 0.25 - d], [0.25 + d, 0.25]]), np.array([f(t, y)] * 2)
    for _ in range(100):
        before = k
        k = np.array([f(t + (0.5 - d) * h, y + h * (a[0] @ k)), f(t + (0.5 + d) * h, y + h * (a[1] @ k))])
        if abs(k - before).max() < 1e-14:
            break
    return y + h * (k[0] + k[1]) / 2


def verlet_in_sub_steps(force, q, v, h):
    """The last force of a sub-step is the first of the next."""
    count = max(1, int(-(-abs(h) // 0.1)))
    d, a = h / count, force(q)
    for _ in range(count):
        v = v + d / 2 * a
        q, a = q + d * v, force(q + d * v)
        v = v + d / 2 * a
    return q, v


def adaptive(force, q, v, h):
    done, d = 0.0, h
    while done < h:
        d = min(d, h - done)
        a = force(q)
        if d * d * abs(a) > 1e-3:
            d /= 3
            continue
        v = v + d * a
        q, done = q + d * v, done + d
    return q, v


@pytest.mark.parametrize(
    ("step", "holds", "words"),
    [
        (gauss2, None, "times from there on: it iterates"),
        (verlet_in_sub_steps, False, "above h = 0.1 it takes sub-steps: 2 of its force calls become 3"),
        (adaptive, None, "it iterates, or adapts a step of its own"),
    ],
)
def test_an_iteration_is_told_from_sub_steps(step, holds, words):
    (check,) = sub_steps(opened(step))
    assert check.holds is holds
    assert words in check.words


def first(subject):
    return subject.step(1.0, 0.75, 0.25)


def second(subject):
    sleep(0.4)


def test_a_brief_experiment_that_hangs_is_given_up_before_the_time_limit(monkeypatch):
    monkeypatch.setattr("driftproof.blackbox.isolation.LEAST_LIMIT", 0.2)
    runner = IsolatedRunner(Target(rogues.hangs_at_nan), 60.0)
    outcomes = runner.run([first, CHECKS["not_a_number_step"], second], BRIEF)
    assert [outcome.kind for outcome in outcomes] == [None, "hangs", None]
    assert "60 s" not in outcomes[1].seen
    assert LEAST_LIMIT < runner.time_limit
    assert checks_of([outcomes[1]] * len(CHECKS))[0].is_fault


def many(subject):
    for n in range(10**6):
        subject.step(1.0, 0.75, n / 10**6)


def test_a_slow_stepper_does_not_hang():
    slow, after = IsolatedRunner(Target(rogues.dawdles), 0.4).run([many, first])
    assert (slow.kind, after.kind) == ("slow", None)
    of_one = [slow, *[Outcome(result=()) for _ in range(len(CHECKS) - 1)]]
    assert [check.holds for check in checks_of(of_one)] == [None]
