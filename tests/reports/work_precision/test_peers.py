"""Other people's integrators beside ours: counted, timed, and told apart where they fail or are absent."""

import re
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from driftproof.methods.formulas.field_text import field_of_text
from driftproof.methods.formulas.vector_fields import FUNCTIONS, SMOOTH_FUNCTIONS, VectorField
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.reports.user_problem import problem_given
from driftproof.reports.work_precision import peers
from driftproof.reports.work_precision.peers import PEERS, Peer, peers_named
from driftproof.reports.work_precision.report import study_text
from driftproof.reports.work_precision.study import measure, solver_point
from driftproof.reports.work_precision.study_files import times_json
from tests.looping import some
from tests.reports.studies import study, unheard

# y0 is infinite at t = 1, before the end.
POLE = replace(HARMONIC, field=VectorField(("y0 * y0", "0")), second_order=False, energy=None, matrix=None)


class FakeSolver:
    once = 10**6

    """Exact at every tolerance but the last, where it fails; counts three evaluations."""

    def __init__(self, problem, solver):
        self.exact = dict(zip(HARMONIC.reference.times, HARMONIC.reference.states, strict=True))

    def solve(self, tolerance, t):
        if tolerance < 1e-4:
            raise ArithmeticError("step too\nsmall")
        return tuple(float(x) + tolerance for x in self.exact[next(x for x in self.exact if float(x) == t)])

    def counted(self, tolerance, t, limit=0):
        return 3


def test_the_largest_error_of_a_peer_is_that_at_its_own_steps():
    problem = problem_given({"rates": "-y", "start": 1, "end": 3})
    point = solver_point(PEERS["scipy"].on(problem, "RK45"), 1e-3, replace(study("rk4", limit=1), problem=problem))
    found = solve_ivp(lambda t, y: -y, (0, 3), [1], rtol=1e-3, atol=1e-3)
    off = np.abs(found.y[0] - np.exp(-found.t))[1:]
    assert point.errors["state"] == (pytest.approx(off[-1]), pytest.approx(off.max()), len(off))
    assert point.errors["state"].largest > 1.1 * max(off[-1], off[len(off) // 2])


def test_where_plain_python_raises_scipy_gets_what_numpy_has():
    problem = replace(HARMONIC, field=field_of_text("exp(y0); log(y1)"), second_order=False)
    rate = PEERS["scipy"].on(problem, "RK45").rate
    assert [*map(str, rate(0.0, [1000.0, -1.0]))] == ["inf", "nan"]
    assert rate(0.0, [0.0, 1.0]) == [1.0, 0.0]


def test_as_many_calls_as_are_allowed_are_made_and_no_more():
    rate = peers._CountedRate(lambda t, y: [y, t], 2)
    assert [rate(1.0, 3.0), rate(2.0, 4.0)] == [[3.0, 1.0], [4.0, 2.0]]
    with pytest.raises(ArithmeticError, match="given up after 2 evaluations"):
        rate(1.0, 3.0)


def test_a_peer_stands_beside_ours_and_its_failure_is_a_remark(monkeypatch):
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

    def solve(self, tolerance, t):
        asked.append(tolerance)
        return super().solve(1e-3, t)


asked = []


def test_a_solver_is_first_called_twice_at_the_first_point_to_let_it_compile(monkeypatch):
    monkeypatch.setattr(Peer, "installed", True)
    asked.clear()
    found = measure(study("rk4", peers=(Peer("willing", ("solver",), "python", Willing),)), None, unheard)
    errors = 2 * len(HARMONIC.reference.times)
    assert asked[errors : errors + 2] == [1e-3, 1e-3]
    assert set(found.warm_up) == {"rk4 | python", "rk4 | ensemble", "willing solver | python"}


def test_peers_that_are_absent_are_named(monkeypatch):
    monkeypatch.setattr(Peer, "installed", False)
    asked = study("rk4", peers=tuple(peers_named(["heyoka", "scipy"])))
    found = measure(asked, None, unheard)
    assert "peer heyoka: not installed; pip install 'driftproof[peers]'" in study_text(asked, found)
    assert set(times_json(asked, found)["absent"]) >= {"heyoka", "scipy"}
    for name, said in (("scipi", "; did you mean scipy?"), ("x" * 61, f"choose from {', '.join(PEERS)}")):
        with pytest.raises(ValueError, match=f"unknown peer '{name[:57]}.*{re.escape(said)}"):
            peers_named(["scipy", name])


solved = []


def solve(rate, y, span, tolerance):
    """SciPy's solution for a package that is not installed; it counts the evaluations by itself."""
    solved.append(solve_ivp(rate, span, y, rtol=tolerance, atol=tolerance))
    return solved[-1]


class Taylor:
    """heyoka's integrator, which goes on from where it is."""

    def __init__(self, system, start, tol):
        self.state, self.time, self.tolerance = np.array(start), 0.0, tol
        variables, rates = zip(*system, strict=True)
        self.rate = sympy.lambdify([TIME, variables], rates)

    def propagate_until(self, t, max_steps):
        found = solve(self.rate, self.state, (self.time, t), self.tolerance)
        self.state[:], self.time = found.y[:, -1], t
        return ("time_limit" if found.success and max_steps == 10**5 else "failed",)


def diffeqsolve(term, solver, t0, t1, dt0, y0, **settings):
    tolerances = settings.pop("stepsize_controller").values()
    found = solve(lambda t, y: term(t, y, None), y0, (t0, t1), max(tolerances))
    usual = (solver in PEERS["diffrax"].solvers, settings) == (
        True, {"saveat": {"t1": True}, "max_steps": 10**5, "throw": False},
    )  # fmt: skip
    return SimpleNamespace(ys=[found.y[:, -1]], result="successful" if found.success and usual else "other")


TIME, double = sympy.Symbol("t"), []
of_sympy = {name: getattr(sympy, name, None) for name in FUNCTIONS}
# What we call of packages that are not installed here.
FAKES = {
    "heyoka": SimpleNamespace(
        expression=sympy.Symbol, time=TIME, taylor_adaptive=Taylor,
        taylor_outcome=SimpleNamespace(time_limit="time_limit"), **{name: of_sympy[name] for name in SMOOTH_FUNCTIONS},
    ),
    "jax": SimpleNamespace(
        numpy=np, jit=lambda f: f, effects_barrier=lambda: None, debug=SimpleNamespace(callback=lambda f: f()),
        enable_x64=lambda on: double.append(on) or nullcontext(),
    ),
    "diffrax": SimpleNamespace(
        PIDController=dict, SaveAt=dict, ODETerm=lambda f: f, diffeqsolve=diffeqsolve,
        RESULTS=SimpleNamespace(successful="successful"), Dopri8=lambda: "Dopri8", Tsit5=lambda: "Tsit5",
    ),
}  # fmt: skip
REFUSED = {
    "heyoka": "stopped within 100000 steps: failed",
    "diffrax": "the end is not reached within 100000 steps",
}


@pytest.mark.parametrize("name", PEERS)
def test_peers_solve_the_oscillator_and_refuse_what_they_cannot(name, monkeypatch):
    peer, faked = PEERS[name], not PEERS[name].installed
    if faked:
        monkeypatch.setattr(peers, "import_module", FAKES.__getitem__)
    assert [f"{x:.0e}" for x in peers.TOLERANCES] == [f"1e-{digits:02}" for digits in range(3, 14)]
    for key in some(peer.solvers):
        solver = peer.on(HARMONIC, key)
        point = solver_point(solver, 1e-6, study(limit=1))
        assert point.error < 1e-2
        assert point.evaluations is None if name == "heyoka" else 20 < (point.evaluations or 0) < 2000
        assert solver.solve(1e-6, 1.0) == solver.solve(1e-6, 1.0)
        refused = solver_point(peer.on(POLE, key), 1e-3, study(limit=1)).remark
        if faked:
            assert refused == REFUSED[name]
            assert name == "heyoka" or solver.counted(1e-6, 1.0) == solved[-1].nfev
            assert name != "diffrax" or set(double) == {True}
        assert refused
