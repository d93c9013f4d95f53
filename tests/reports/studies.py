"""Studies of error against work that are quickly measured: few steps, nothing compiled."""

from __future__ import annotations

from pathlib import Path

import pytest

from driftproof.methods.tableau_file import methods_of
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.work_precision import curves, integrators
from driftproof.reports.work_precision import study as study_module
from driftproof.reports.work_precision.peers import Peer
from driftproof.reports.work_precision.study import Study


def be_quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few steps, and nothing compiled."""
    monkeypatch.setattr(integrators, "has_numba", lambda: False)
    monkeypatch.setattr(curves, "MOST", 64)
    monkeypatch.setattr(curves, "MOST_IMPLICIT", 16)
    monkeypatch.setattr(study_module, "TOLERANCES", (1e-3, 1e-6))


def study(*keys: str, problem: str = "harmonic_oscillator", limit: float = 10.0, peers: tuple[Peer, ...] = ()) -> Study:
    return Study(problem_named(problem), methods_of(keys), peers, limit)


def unheard(line: str) -> None:
    raise AssertionError(line)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}
