"""Other people's integrators beside ours: counted, timed, and told apart where they fail or are absent."""

from __future__ import annotations

from dataclasses import replace

import pytest

from driftproof.methods.vector_fields import VectorField
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.reports.work_precision.peers import PEERS, Peer, peers_named
from driftproof.reports.work_precision.report import study_text, times_json
from driftproof.reports.work_precision.study import measure, solver_point
from tests.looping import some
from tests.reports.studies import study, unheard

# y0 is infinite at t = 1, before the end.
POLE = replace(HARMONIC, field=VectorField(("y0 * y0", "0")), second_order=False, energy=None, matrix=None)


class FakeSolver:
    once = 10**6

    """Exact at every tolerance but the last, where it fails; counts three evaluations."""

    def __init__(self, problem: object, solver: str) -> None:
        self.exact = dict(zip(HARMONIC.reference.times, HARMONIC.reference.states, strict=True))

    def solve(self, tolerance: float, t: float) -> tuple[float, ...]:
        if tolerance < 1e-4:
            raise ArithmeticError("step too\nsmall")
        return tuple(float(x) + tolerance for x in self.exact[next(x for x in self.exact if float(x) == t)])

    def counted(self, tolerance: float, t: float, limit: float = 0) -> int:
        return 3


def test_a_peer_stands_beside_ours_and_its_failure_is_a_remark(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Peer, "installed", True)
    asked = study("rk4", peers=(Peer("fake", ("solver",), "python", FakeSolver),))
    found = measure(asked, None, unheard)
    curve = found.curves["fake solver"]
    assert [point.evaluations for point in curve.points] == [3, None]
    assert curve.points[1].remark == "step too small"
    assert curve.points[0].error == pytest.approx(1e-3 * 2**0.5)
    assert len(found.timed(curve, "python")) == 1
    assert "fake solver at tolerance 1e-06: step too small" in study_text(asked, found)


class Willing(FakeSolver):
    """Exact at every tolerance; keeps those that it is asked for."""

    def solve(self, tolerance: float, t: float) -> tuple[float, ...]:
        asked.append(tolerance)
        return super().solve(1e-3, t)


asked: list[float] = []


def test_a_solver_is_first_called_twice_at_the_first_point_to_let_it_compile(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Peer, "installed", True)
    asked.clear()
    found = measure(study("rk4", peers=(Peer("willing", ("solver",), "python", Willing),)), None, unheard)
    errors = 2 * len(HARMONIC.reference.times)
    assert asked[errors : errors + 2] == [1e-3, 1e-3]
    assert set(found.warm_up) == {"rk4 | python", "rk4 | ensemble", "willing solver | python"}


def test_peers_that_are_absent_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Peer, "installed", False)
    asked = study("rk4", peers=tuple(peers_named(["heyoka", "scipy"])))
    found = measure(asked, None, unheard)
    assert "peer heyoka: not installed; pip install 'driftproof[peers]'" in study_text(asked, found)
    assert set(times_json(asked, found)["absent"]) >= {"heyoka", "scipy"}


@pytest.mark.parametrize("name", PEERS)
def test_peers_that_are_installed_solve_the_oscillator_and_refuse_what_they_cannot(name: str) -> None:
    pytest.importorskip(name)
    peer = PEERS[name]
    for key in some(peer.solvers):
        solver = peer.on(HARMONIC, key)
        point = solver_point(solver, 1e-6, study(limit=1))
        assert point.error < 1e-2
        assert point.evaluations is None if name == "heyoka" else 20 < (point.evaluations or 0) < 2000
        assert solver_point(peer.on(POLE, key), 1e-3, study(limit=1)).remark
