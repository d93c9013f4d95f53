"""Studies of error against work that are quickly measured: few steps, nothing compiled."""

from driftproof.methods.given_methods import methods_of
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.work_precision import curves, integrators
from driftproof.reports.work_precision import study as study_module
from driftproof.reports.work_precision.study import Study


def be_quick(monkeypatch):
    """Few steps, and nothing compiled."""
    monkeypatch.setattr(integrators, "has_numba", lambda: False)
    monkeypatch.setattr(curves, "MOST", 64)
    monkeypatch.setattr(curves, "MOST_IMPLICIT", 16)
    monkeypatch.setattr(study_module, "TOLERANCES", (1e-3, 1e-6))


def study(*keys, problem="harmonic_oscillator", limit=10.0, peers=()):
    return Study(problem_named(problem), methods_of(keys), peers, limit)


def unheard(line):
    raise AssertionError(line)


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}
