"""Solvers are called as they are, and what they return is read in whichever form it comes."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.findings import BadInput, Misbehaviour, StepRaised
from driftproof.blackbox.solvers.foreign_solver import (
    DoesNotEnd,
    ForeignSolver,
    SolverTarget,
    TooSlow,
    taken_by,
)
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from tests.blackbox.solvers.planted_solvers import adaptive, fixed
from tests.looping import exactly

T, Y = [0.0, 0.5, 1.0], [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
FORMS = {
    "a pair": lambda: (T, Y),
    "arrays": lambda: (np.array(T), np.array(Y)),
    "states in columns": lambda: SimpleNamespace(t=np.array(T), y=np.array(Y).T),
    "other names": lambda: {"ts": T, "ys": np.array(Y)},
    "more behind": lambda: (T, Y, "done", {"calls": 7}),
    "narrow": lambda: (T, np.array(Y, dtype=np.float32)),
}


@pytest.mark.parametrize("form", FORMS)
def test_times_and_states_are_found(form):
    found = ForeignSolver(lambda f, t_span, y0, rtol, atol: FORMS[form]()).solve(lambda n, t, y: y, (0, 1), (1.0, 2.0))
    assert found.t == tuple(T)
    assert found.y == tuple(map(tuple, Y))
    assert found.format == (BINARY32 if form == "narrow" else BINARY64)


def test_as_many_times_as_numbers_are_told_apart_by_the_start():
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    for answer in exactly(2, [([0.0, 1.0], rows), ([0.0, 1.0], rows.T)]):
        found = ForeignSolver(lambda *_, answer=answer: answer).solve(lambda n, t, y: y, (0, 1), (1.0, 2.0))
        assert found.y == ((1.0, 2.0), (3.0, 4.0))


def test_every_call_is_kept_with_its_number():
    found = ForeignSolver(fixed(3)).solve(lambda n, t, y: [float(n)], (0.0, 3.0), (0.0,))
    assert [call.t for call in found.calls] == [0.0, 1.0, 1.0, 2.0, 2.0, 3.0]
    assert found.y == ((0.0,), (0.5,), (3.0,), (7.5,))


@pytest.mark.slow
def test_what_comes_instead_of_an_answer_is_named():
    def fails(f, t_span, y0, rtol, atol):
        raise RuntimeError("two\nlines")

    with pytest.raises(StepRaised, match="raises RuntimeError: two lines"):
        ForeignSolver(fails).solve(lambda n, t, y: y, (0, 1), (1.0,))
    with pytest.raises(Misbehaviour, match="returns int, not"):
        ForeignSolver(lambda *_: 7).solve(lambda n, t, y: y, (0, 1), (1.0,))
    with pytest.raises(Misbehaviour, match="3 times were returned with 4 numbers, for states of 1"):
        ForeignSolver(lambda *_: (T, [1.0] * 4)).solve(lambda n, t, y: y, (0, 1), (1.0,))
    endless = adaptive(estimate=lambda e: [1.0, 0.0, 0.0, 0.0])
    with pytest.raises(DoesNotEnd, match="after 30000 calls"):
        ForeignSolver(lambda f, *_: [*iter(lambda: f(0.5, np.ones(1)), None)]).solve(lambda n, t, y: y, (0, 1), (1.0,))
    with pytest.raises(TooSlow, match="after 30000 calls"):  # it would end after some million
        ForeignSolver(endless).solve(lambda n, t, y: [1.0], (0.0, 1.0), (1.0,))


SOLVED = (T, [[1.0], [2.0], [3.0]])
# A solver that keeps what it is given; what it takes; and with which values.
TAKEN = {
    "both": (lambda f, t_span, y0, rtol, atol: (rtol, atol), "tolerances", (0.25, 0.5)),
    "by keyword": (lambda f, t_span, y0, *, atol=1, rtol=1: (rtol, atol), "tolerances", (0.25, 0.5)),
    "after others": (lambda f, t_span, y0, how="RK", abstol=1, reltol=1: (reltol, abstol), "tolerances", (0.25, 0.5)),
    "as options": (lambda f, t_span, y0, method="RK", **o: (o["rtol"], o["atol"]), "tolerances", (0.25, 0.5)),
    "by position": (lambda f, t_span, y0, rtol, atol, /: (rtol, atol), "tolerances", (0.25, 0.5)),
    "unnamed": (lambda f, t_span, y0, first, second: (first, second), "tolerances", (0.25, 0.5)),
    "any": (lambda *given: given[3:], "tolerances", (0.25, 0.5)),
    "one": (lambda f, t_span, y0, tol, **options: (tol,), "tolerance", (0.5,)),
    "one of two": (lambda f, t_span, y0, h=None, eps=1: (h, eps), "tolerance", (None, 0.5)),
    "one, unnamed": (lambda f, t_span, y0, small: (small,), "tolerance", (0.5,)),
    "length": (lambda f, t_span, y0, _DT, more=2: (_DT, more), "length", (0.375, 2)),
    "length after others": (lambda f, t_span, y0, args=(), dt=1: (args, dt), "length", ((), 0.375)),
    "count": (lambda f, t_span, y0, N: (N,), "count", (8,)),
    "nothing": (lambda f, t_span, y0, method="RK": (method,), "nothing", ("RK",)),
    "only options": (lambda f, t_span, y0, **options: (options,), "nothing", ({},)),
}


@pytest.mark.parametrize("form", TAKEN)
def test_a_solver_is_given_what_it_takes_by_the_names_of_its_parameters(form):
    solve, takes, values = TAKEN[form]
    told, taken = [], []

    def noting(*given, **named):
        taken.append(solve(*given, **named))
        return SOLVED

    subject = ForeignSolver(noting, ARRAYS, *taken_by(solve), told.append, lambda: told.append("over"))
    assert (subject.takes, subject.adaptive) == (takes, takes.startswith("tolerance"))
    assert subject.solve(lambda n, t, y: y, (1.0, 4.0), (1.0,), 0.25, 0.5, 8).y == ((1.0,), (2.0,), (3.0,))
    assert taken == [values]
    words = {"tolerances": "rtol=0.25, atol=0.5", "tolerance": "tol=0.5", "length": "h=0.375", "count": "n=8"}
    assert told == [", ".join(filter(None, ["f, t_span=(1.0, 4.0), y0=[1.0]", words.get(takes, "")])), "over"]


def test_a_setting_that_is_not_known_is_named_by_the_error():
    with pytest.raises(StepRaised, match="missing 1 required positional argument: 'h'"):
        SolverTarget(lambda f, t_span, y0, h, tol: SOLVED).open()


class EulerRuns:
    """Forward Euler in a hundred steps."""

    def __init__(self, f, n=100):
        self.f, self.n = f, n

    def run(self, t0, y0, t1):
        h, times, states = (t1 - t0) / self.n, [t0], [np.array(y0, float)]
        for i in range(self.n):
            states.append(states[-1] + h * self.f(times[-1], states[-1]))
            times.append(t0 + (i + 1) * h)
        return times, np.array(states)


@pytest.mark.parametrize("given", [EulerRuns, EulerRuns.run])
def test_a_run_of_a_class_is_opened_by_the_class_and_by_its_method(given):
    solution = SolverTarget(given).open().solve(lambda n, t, y: [-x for x in y], (0.0, 1.0), (1.0,))
    assert solution.y[-1] == pytest.approx((0.99**100,), rel=0.01)  # in as many steps as it chooses


def test_a_class_of_solvers_is_refused_with_what_to_hand_over():
    class Stepping:
        def __init__(self, f, t_span, y0):
            self.t, self.y = [0.0, 1.0], y0

        def step(self): ...

    with pytest.raises(BadInput, match=r"is a class, and making one is no run; write: def wrapped\(f, t_span, y0\): "):
        SolverTarget(Stepping).open()


def test_a_solver_of_lists_is_opened_with_lists():
    def euler(f, t_span, y0, rtol, atol):
        (start, end), steps = t_span, 10
        times, states, h = [start], [y0.copy()], (end - start) / steps
        for n in range(steps):
            slope = f(times[-1], states[-1])
            slope.append(0.0)  # which an array has not
            states.append([y + h * k for y, k in zip(states[-1], slope, strict=False)])
            times.append(start + (n + 1) * h)
        return times, states

    assert SolverTarget(euler).open().adapter.name == "lists"


ANSWERS = {
    "nothing": None, "a string": "done", "text inside": ("a", "b"), "one time": ([0.0], [[1.0, 2.0]]),
    "a longer start": ([0.0, 1.0], [[1.0, 2.0, 3.0], [3.0, 4.0, 5.0]]),
    "another start": ([0.0, 0.5, 1.0], [[9.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
    "NaN": ([0.0, 1.0], [[1.0, 2.0], [float("nan"), 4.0]]),
    "flat": (T, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), "one alone": ([0.0, 1.0],),
    "a good status": {"t": T, "y": Y, "status": 0, "message": "the end"},
    "a status alone": {"t": T, "y": Y, "status": -1},
    "a success in spite of its status": {"t": T, "y": Y, "status": -1, "success": True, "message": "no"},
    "a status": {"t": T, "y": Y, "status": 1, "message": "an event"},
    "a failure": {"t": T, "y": Y, "status": -1, "message": "step size"},
    "no message": {"t": T, "y": Y, "success": False},
    "a return code": SimpleNamespace(t=T, u=Y, retcode="MaxIters"),
    "times behind": {"states": Y, "times": T}, "complex": (T, [[1j, 2.0], [3.0, 4.0], [5.0, 6.0]]),
}  # fmt: skip


@pytest.mark.parametrize("name", ANSWERS)
def test_what_is_made_of_an_answer_is_what_it_was(name, as_before):
    for span in ((0.0, 1.0), (1.0, 0.0)):
        try:
            found = ForeignSolver(lambda *_: ANSWERS[name]).solve(lambda n, t, y: y, span, (1.0, 2.0))
            said = found.t, found.y, found.complaint, found.format.name
        except Misbehaviour as refusal:
            said = type(refusal).__name__, str(refusal)
        assert said
    as_before(*said)


def stubborn(f, t_span, y0, rtol, atol):
    raise TypeError(f"no {type(y0).__name__}")


def not_finite(f, t_span, y0, rtol, atol):
    return [*t_span], [y0, y0 * float("inf")]


class Made:
    def __call__(self, f, t_span, y0, rtol, atol):
        return adaptive()(f, t_span, y0, rtol, atol)


def test_targets_are_named_and_opened_as_before(as_before):
    said = []
    for solver in (stubborn, not_finite, Made(), "tests.blackbox.solvers.planted_solvers:no", "math:sqrt", adaptive()):
        target = SolverTarget(solver)
        try:
            said.append((target.name, target.by_name, target.open().adapter.name))
        except (Misbehaviour, ValueError) as refusal:
            said.append((target.name, target.by_name, type(refusal).__name__, str(refusal)))
    as_before(*said)


def test_a_solver_that_needs_more_shows_how_to_give_it():
    def rkf(f, a, b, alpha, tol, hmax, hmin):
        return fixed(20)(f, (a, b), alpha, tol, tol)

    words = r"it needs hmax, hmin as well; write: wrapped = functools.partial\(rkf, hmax=\.\.\."
    with pytest.raises(BadInput, match=words):
        SolverTarget(rkf).open()
    found = SolverTarget(partial(rkf, hmax=1.0, hmin=1e-6)).open()
    assert (found.takes, found.names) == ("tolerance", ("tol",))
