"""A user's solver, solve(f, t_span, y0, ...), called with right-hand sides that record every call."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.findings import BadInput, Misbehaviour, NoAnswer, NotANumber, WrongShape
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_code import guarded_call
from driftproof.blackbox.stepper.opening import NamedCode, imported
from driftproof.blackbox.stepper.second_functions import with_own_jacobian
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, LISTS, ArrayAdapter, as_array, type_of
from driftproof.blackbox.stepper.wrappers.function_wrappers import run_of_class
from driftproof.blackbox.stepper.wrappers.made_wrappers import owner_of
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64, FloatFormat

# A solver that makes more calls on these short problems is said not to end, or to be too slow.
MOST_CALLS_OF_A_RUN = 30_000
# What a solver takes after f, t_span and y0: rtol and atol, one tolerance, a step size, a number of steps, nothing.
TOLERANCES, TOLERANCE, LENGTH, COUNT, NOTHING = "tolerances", "tolerance", "length", "count", "nothing"
# The names that these settings go by, in the order in which a solver is asked whether it has them.
_SETTINGS = {
    TOLERANCES: calling.TOLERANCE_NAMES,
    TOLERANCE: (("tol", "tolerance", "eps", "epsilon", "accuracy", *calling.TOLERANCE_NAMES[0]),),
    LENGTH: (calling.ROLES[calling.STEP],),
    COUNT: (calling.COUNTS,),
}
# The default number of steps for solvers that take a step size or a number.
USUAL = 128
# The names under which an answer may hold its times, its states and its dense output.
_TIMES = ("t", "ts", "times", "time")
_STATES = ("y", "ys", "u", "x", "states")
_DENSE = ("sol", "dense", "interpolation")
# No attempt of a step in use makes more calls.
_OF_ATTEMPTS = 32


class DoesNotEnd(Misbehaviour):
    """The solver went on calling its right-hand side after MOST_CALLS_OF_A_RUN calls."""


class TooSlow(NoAnswer):
    """It would end after more calls: the last quarter of them led it on by more than a hundredth of its share."""


class Call(NamedTuple):
    """One call of the right-hand side: its time and its state."""

    t: float
    y: tuple[float, ...]


class Solution(NamedTuple):
    """What a solver returned: times, a state at each, its dense output; and the calls of f that it made.

    `complaint` is the message of a solver that reports failure, "" if it reports success or nothing.
    """

    t: tuple[float, ...]
    y: tuple[tuple[float, ...], ...]
    calls: tuple[Call, ...]
    complaint: str = ""
    dense: Callable[..., Any] | None = None
    format: FloatFormat = BINARY64


# Our right-hand side: from the number of the call, t and y to the slopes.
RunSlopes = Callable[[int, float, tuple[float, ...]], Sequence[float]]


@dataclass(eq=False)
class ForeignSolver:
    """A solver with the hooks of an isolated process: `before` gets the text of each call, `after` runs at its end."""

    function: Callable[..., Any]
    adapter: ArrayAdapter = ARRAYS
    takes: str = TOLERANCES
    names: tuple[str, ...] = ()  # of the parameters that take the settings; without them the settings go by position
    before: Callable[[str], None] = lambda call: None
    after: Callable[[], None] = lambda: None
    state_first: bool = False  # whether it calls f(y, t), or f(y, p, t)
    runs: list[tuple[int, int]] = field(default_factory=list)  # of each, how many numbers its state has, and its steps

    @property
    def adaptive(self) -> bool:
        """True if it takes tolerances, so that its step sizes should follow the error."""
        return self.takes in (TOLERANCES, TOLERANCE)

    def solve(
        self,
        rate: RunSlopes,
        t_span: tuple[float, float],
        y0: Sequence[float],
        rtol: float = 1e-6,
        atol: float = 1e-9,
        steps: float = USUAL,
    ) -> Solution:
        """Return one run: with `steps` steps if the solver takes their size or number, else to the tolerances it takes.

        They are no whole number where a size does not divide the span.
        Raises a `Misbehaviour` if there is no usable answer.
        """
        calls: list[Call] = []

        def slopes(t: Any, y: Any, *further: Any) -> Any:
            _require_end(calls, t_span)
            if len(y0) > 1 and not calls:
                self.state_first = as_array(t).size > 1
            t, y = ((further or [y])[-1], t) if self.state_first else (t, y)
            (at,) = self.adapter.read(t, 1)
            asked = Call(at, tuple(self.adapter.read(y, len(y0))))
            calls.append(asked)
            return self.adapter.write(rate(len(calls) - 1, *asked))

        length = (t_span[1] - t_span[0]) / steps
        settings: dict[str, dict[str, float]] = {
            TOLERANCES: {"rtol": rtol, "atol": atol},
            TOLERANCE: {"tol": max(rtol, atol)},  # at numbers of size 1
            LENGTH: {"h": length},
            COUNT: {"n": int(steps)},
            NOTHING: {},
        }
        given = settings[self.takes]
        words = ", ".join([f"f, t_span={t_span!r}, y0={list(y0)!r}", *(f"{name}={x!r}" for name, x in given.items())])
        self.before(words)
        by_name = dict(zip(self.names, given.values(), strict=False))
        by_position = () if self.names else given.values()
        run = lambda: _listed(self.function(slopes, t_span, self.adapter.write(y0), *by_position, **by_name))
        found = _solution(guarded_call(f"solve({words})", run, self.after), tuple(y0), tuple(calls))
        self.runs.append((len(y0), len(found.t) - 1))
        return found


def _require_end(calls: Sequence[Call], t_span: tuple[float, float]) -> None:
    """Raise DoesNotEnd after MOST_CALLS_OF_A_RUN calls, or TooSlow if the last of them led on at about the usual pace.

    An error per unit of time asks a method of low order for a million steps at the tolerances in use.
    """
    if len(calls) >= MOST_CALLS_OF_A_RUN:
        parts = (calls[n - _OF_ATTEMPTS : n] for n in (len(calls), 3 * len(calls) // 4))
        at, before = (max((call.t for call in part), key=lambda t: abs(t - t_span[0])) for part in parts)
        slow = 400 * abs(at - before) > abs(at - t_span[0]) and min(t_span) <= at <= max(t_span)
        words = f"after {len(calls)} calls of f it is at t = {at:.6g} of {t_span}"
        raise TooSlow(words) if slow else DoesNotEnd(words)


def in_usual_order(solve: Callable[..., Any]) -> Callable[..., Any]:
    """The solver with the parameters f, t_span, y0 and then its others; itself if their names do not tell them apart.

    >>> in_usual_order(lambda y0, t0, t1, h, rhs: (rhs, t0, t1, y0, h))("f", (0, 1), "y", h=2)
    ('f', 0, 1, 'y', 2)
    """
    parameters = calling.parameters_of(solve) or {}
    words = {calling.word_of(name): name for name, p in parameters.items() if p.kind is not p.POSITIONAL_ONLY}
    all_known = (calling.ROLES[calling.FUNCTION], calling.STARTS, calling.SPANS, *calling.RUN_ENDS)
    f, y0, span, *ends = (next((words.pop(x) for x in known if x in words), "") for known in all_known)
    ends[0] = ends[0] or words.pop("x0", "")  # of y' = f(x, y), as books write it
    h, count = (next((words[x] for x in known if x in words), "") for known in (_SETTINGS[LENGTH][0], calling.COUNTS))
    if all((f, y0, ends[0], h, count)) and not (span or ends[1]):  # its end is start + count h

        def counted(f_: Any, t_span_: Any, y0_: Any, n: int) -> Any:
            length = (t_span_[1] - t_span_[0]) / n
            return solve(**{f: f_, ends[0]: t_span_[0], y0: y0_, h: length, count: n})

        return counted
    if not (f and y0 and (span or all(ends))) or [*parameters][:3] == [f, span, y0]:
        return solve
    taken = [f, y0, *([span] if span else ends)]

    others = [p for name, p in parameters.items() if name not in taken]
    others.sort(key=lambda p: (p.kind, p.default is not p.empty))

    def arranged(f_: Any, t_span_: Any, y0_: Any, *settings: Any, **options: Any) -> Any:
        given = [f_, y0_, *([t_span_] if span else t_span_), *settings]
        return solve(**dict(zip([*taken, *(p.name for p in others)], given, strict=False)), **options)

    first = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in ("f_", "t_span_", "y0_")]
    arranged.__signature__ = inspect.Signature([*first, *others])  # type: ignore[attr-defined]
    return arranged


def taken_by(solve: Callable[..., Any]) -> tuple[str, tuple[str, ...]]:
    """What a solver takes after f, t_span and y0, and the names of these parameters; without names, by position.

    >>> taken_by(lambda f, t_span, y0, steps, method="rk4": None)
    ('count', ('steps',))
    >>> taken_by(lambda f, t_span, y0, method="RK45", **options: None)
    ('tolerances', ('rtol', 'atol'))
    """
    parameters = calling.parameters_of(solve)
    if parameters is None or any(p.kind is p.VAR_POSITIONAL for p in parameters.values()):
        return TOLERANCES, ()
    open_ended = any(p.kind is p.VAR_KEYWORD for p in parameters.values())
    further = {calling.word_of(name): name for name, p in parameters.items() if p.kind is not p.VAR_KEYWORD}
    further = dict(list(further.items())[3:])
    required = _required(solve)
    known = {
        taken: tuple(next((further[word] for word in words if word in further), "") for words in roles)
        for taken, roles in _SETTINGS.items()
    }
    named = [(taken, names) for taken, names in known.items() if all(names)]
    if named:
        taken, names = max(named, key=lambda each: set(required) <= set(each[1]))  # the first that leaves nothing out
        by_position = any(parameters[name].kind is inspect.Parameter.POSITIONAL_ONLY for name in names)
        return taken, () if by_position else names
    if not required:
        return (TOLERANCES, ("rtol", "atol")) if open_ended and further else (NOTHING, ())
    return TOLERANCES if len(required) > 1 else TOLERANCE, ()


def _required(solve: Callable[..., Any]) -> list[str]:
    """The parameters after f, t_span and y0 that have no default."""
    further = list((calling.parameters_of(solve) or {}).values())[3:]
    return [p.name for p in further if p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]


def _listed(answer: Any) -> Any:
    """The times and the states of a generator, or of a list, of pairs (t, y); any other answer as it is."""
    pairs = [*answer] if hasattr(answer, "__next__") else answer
    told = isinstance(pairs, list) and all(isinstance(x, tuple) and len(x) == 2 and not np.ndim(x[0]) for x in pairs)
    return tuple(zip(*pairs, strict=True)) if told else pairs


def _solution(answer: Any, y0: tuple[float, ...], calls: tuple[Call, ...]) -> Solution:
    """The solution in an answer: a pair (t, y), a mapping, or an object with the usual names."""
    if isinstance(answer, tuple | list) and len(answer) >= 2:
        times, states, *further = answer
        dense = next(filter(callable, further), None)
    else:
        times, states, dense = (_part(answer, names) for names in (_TIMES, _STATES, _DENSE))
        dense = dense if callable(dense) else None  # a list of what interpolates each step
        if times is None or states is None:
            raise WrongShape(f"it returns {type(answer).__name__}, not (t, y) nor an object with t and y")
    t, y = as_array(times).astype(float).ravel(), as_array(states)
    if not t.size:
        raise WrongShape("it returns no time and no state")
    kind = BINARY32 if "float32" in type_of(states) or "float32" in type_of(times) else BINARY64
    return Solution(tuple(t.tolist()), _rows(y.astype(float), t.size, y0), calls, _complaint(answer), dense, kind)


def _part(answer: Any, names: Sequence[str]) -> Any:
    """The first of these that a mapping or an object has; None if it has none of them."""
    if isinstance(answer, Mapping):
        return next((answer[name] for name in names if name in answer), None)
    return next((getattr(answer, name) for name in names if hasattr(answer, name)), None)


def _rows(y: np.ndarray[Any, Any], times: int, y0: tuple[float, ...]) -> tuple[tuple[float, ...], ...]:
    """The states by time, whichever axis that is; of a square array, the orientation that begins with y0."""
    size = len(y0)
    if y.size != times * size:
        raise WrongShape(f"{times} times were returned with {y.size} numbers, for states of {size}")
    by_time = y.reshape(times, size)
    if y.shape == (size, times) and (size != times or tuple(y[:, 0]) == y0):
        by_time = y.T
    return tuple(map(tuple, by_time.tolist()))


def _complaint(answer: Any) -> str:
    """The message of an answer with a false `success` or a negative `status`; "" if it reports no failure."""
    success, status, message = (_part(answer, (name,)) for name in ("success", "status", "message"))
    failed = success is not None and not success
    if not failed and (success is not None or not isinstance(status, int) or status >= 0):
        return ""
    return str(message or "") or ("no success" if status is None else f"status {status}")


def in_binary32(times: Sequence[float]) -> bool:
    """True if all times are numbers of binary32; of numbers in binary64 one in 2^29 is, by chance."""
    return all(float(np.float32(t)) == t for t in times)


class SolverTarget(NamedCode):
    """The solver to examine, or its `package.module:name`: the counterpart of `stepper.opening.Target`."""

    def open(
        self, before: Callable[[str], None] = lambda call: None, after: Callable[[], None] = lambda: None
    ) -> ForeignSolver:
        """The solver after a first run of y' = 0, on arrays or on lists. Raises ValueError or a `Misbehaviour`."""
        failures: list[Misbehaviour] = []
        given = imported(self.step, "solver")
        if [*(calling.parameters_of(given) or ())][:1] == ["self"]:
            given = owner_of(given)
        given = given if inspect.isclass(given) else with_own_jacobian(given)
        if inspect.isclass(given) and (run := run_of_class(given)):
            given = run
        elif inspect.isclass(given) and any(hasattr(given, each) for each in ("step", "solve", "run", "integrate")):
            write = f"write: def wrapped(f, t_span, y0): made = {given.__name__}(...); ...; return times, states"
            raise BadInput(f"{given.__name__} is a class, and making one is no run; {write}")
        solve = in_usual_order(given)
        takes, names = taken_by(solve)
        if names and solve is not given and (missing := [name for name in _required(solve) if name not in names]):
            values = ", ".join(f"{name}=..." for name in missing)
            called = f"functools.partial({getattr(given, '__name__', 'solve')}, {values})"
            raise BadInput(f"it needs {', '.join(missing)} as well; write: wrapped = {called}, with values of your own")
        for adapter in (ARRAYS, LISTS):
            subject = ForeignSolver(solve, adapter, takes, names, before, after)
            try:
                found = subject.solve(lambda n, t, y: [0.0 * x for x in y], (0.0, 1.0), (1.0, 0.5))
            except Misbehaviour as failure:
                failures.append(failure)
                continue
            if not all(isfinite(x) for x in found.y[-1]):
                raise NotANumber(f"of y' = 0 from 1 it returns {found.y[-1][0]!r} at the end")
            return subject
        raise failures[0]
