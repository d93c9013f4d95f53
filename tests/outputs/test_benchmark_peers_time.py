"""The benchmark of times to an error compares runs that reach it; times depend on the machine and are not tested."""

from __future__ import annotations

from math import cos, sin

import pytest

from benchmarks import peers_time
from benchmarks.peers_time import POWERS, STEPS, at_its_best, by_powers, by_steps, error_at, goals
from benchmarks.timing import Row, Times
from driftproof.reports.work_precision.peers import Peer


def test_ours_reach_their_errors_with_as_few_steps_as_will_do():
    pytest.importorskip("numba")
    steps = by_steps(10.0, 1e-6)
    assert error_at(10.0, steps.task()) <= 1e-6
    assert steps.read(steps.task()).endswith(", 10 steps")
    powers = by_powers(1000.0, 1e-10)
    assert error_at(1000.0, powers.task()) <= 1e-10
    assert powers.read(powers.task()).endswith(", 2048 steps")


def test_a_peer_is_measured_with_the_fastest_tolerance_that_reaches_the_error(monkeypatch):
    """Of a peer whose error is a tenth of its tolerance, and whose time grows as that falls."""
    solver = lambda *_: type("Solver", (), {"solve": lambda _, x, t: (cos(t) + x / 10, -sin(t))})()
    taken = iter([9.0, 3.0, 5.0] * 100)
    monkeypatch.setattr(peers_time, "_seconds", lambda task: next(taken))
    monkeypatch.setattr(peers_time, "TOLERANCES", (1e-3, 1e-4, 1e-5, 1e-6))
    peer = Peer("scipy", ("any",), "", solver)
    found = at_its_best(peer, "any", 10.0, 1.5e-5)
    assert found is not None
    assert found.read(found.task()) == "1.0e-06, tol 1e-05"
    assert at_its_best(peer, "any", 10.0, 1e-9) is None


def test_goals_are_ratios_of_minima_in_one_run():
    times = {"ours": Times([2.0, 3.0]), "heyoka, Taylor": Times([19.0, 30.0])}
    (steps,), (powers,) = (list(goals([Row(name, times)])) for name in (STEPS, POWERS))
    assert (steps.found, steps.met, powers.found, powers.met) == ("9.5", True, "9.5", False)
