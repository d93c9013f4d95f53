"""Runs of probes on foreign code in an isolated process with limits: a crash is a finding, a hang is reported."""

from __future__ import annotations

import base64
import os
import pickle
import shutil
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any, Protocol

from driftproof.blackbox.findings import CRASHES, INSTRUMENT_FAILED, KILLED, NoAnswer, Outcome
from driftproof.blackbox.stepper.float_environment import FloatEnvironment
from driftproof.support.messages import MessageError, decode, encode
from driftproof.support.processes import START_UP, Limits, ProcessEnded, Session


class Examined(Protocol):
    """The subject of an examination, a stepper or a solver. What `open` returns is passed to the probes."""

    @property
    def name(self) -> str:
        """The name that reports use."""

    @property
    def by_name(self) -> bool:
        """True if another interpreter can import the whole subject."""

    def open(self, before: Callable[[str], None] = ..., after: Callable[[], None] = ...) -> Any:
        """Open the subject; `before` and `after` are called around each call. Raises ValueError or a `Misbehaviour`."""


Probe = Callable[[Any], Any]
# Seconds for all probes together. A step of a simulator takes milliseconds, and a report takes some thousand steps.
TIME_LIMIT = 120.0
# Bytes beyond what the process has at its start: no stepper of three numbers needs them, most machines have them.
MEMORY_LIMIT = 8 * 2**30
# One call may take this many times as long as the longest probe before it, and at least this many seconds: other work
# may hold the processors, or a step may be compiled anew for numbers of another type.
PATIENCE, LEAST_LIMIT = 4, 5.0
# One probe may use this part of the time left, and one call this part of the whole, so that the other probes also run.
# The first call, in which a step may be compiled, may use most of its probe's time.
_SHARE_OF_PROBE, _SHARE_OF_CALL, _SHARE_OF_FIRST_CALL = 1 / 2, 1 / 6, 3 / 4
# How often a probe is started again without the call that hung; each start costs the time of a call.
_MOST_HANGS = 3
# Packages that our own command loads.
_OURS = {"driftproof", "numpy", "flint", "cython_runtime"}
# Seconds between two looks at the call in progress.
_LOOK = 0.05
# Other step sizes are tried only at the ends of the floating-point range; a call that hangs there does so from every
# state.
_ORDINARY_STEPS = (2.0**-40, 2.0**8)


def opens(subject: Any) -> None:
    """Do nothing: this probe succeeds if the subject can be imported and answers a first call."""


@dataclass
class IsolatedRunner:
    """Runs probes on one subject, all of them together within `time_limit` seconds.

    A subject given by name runs in a fresh interpreter, for which its probes must be picklable; our own command uses a
    fork of itself as long as it has loaded nothing else. A subject given as a callable runs in a fork of this process.
    With `isolate` false, or on a system without fork, probes run in this process and nothing stops them. The start of
    processes is not counted. `hung` lists the calls that did not come back; none of them is made again. In a `with`
    statement, one process serves all runs as long as it lives, and all probes must be picklable.
    """

    target: Examined
    time_limit: float = TIME_LIMIT
    isolate: bool = True
    hung: list[str] = field(default_factory=list)
    spent: float = 0.0
    _longest: float = 0.0
    _kept: bool = False
    _process: tuple[ExitStack, Session, _CallLog] | None = None
    _here: Serving | None = None

    def __post_init__(self) -> None:
        """Raise ValueError for a time limit that leaves no time."""
        if not self.time_limit > 0:
            raise ValueError(f"a time limit of {self.time_limit:g} s leaves no time; write a number above 0")

    def __enter__(self) -> IsolatedRunner:
        """Keep one process for all runs until the `with` statement ends."""
        self._kept = True
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process[0].close()
            self._process = None

    def turn_to(self, target: Examined) -> None:
        """Examine another subject from now on, in the time that is left."""
        self.__exit__()
        self.target, self._here = target, None

    def run(self, probes: Sequence[Probe]) -> list[Outcome]:
        """Return the outcome of each probe. After a hang or a crash, a new process runs the remaining probes.

        A subject that cannot even be opened is tried once, and that outcome is returned for every probe. A probe whose
        call hangs is started again, and answers without that call.
        """
        asked, outcomes, hangs = [opens, *probes], list[Outcome](), Counter[int]()
        while len(outcomes) < len(asked):
            known = len(self.hung)
            for outcome in self._first_outcomes(asked[len(outcomes) :]):
                if len(self.hung) > known and outcomes and hangs[len(outcomes)] < _MOST_HANGS:
                    hangs[len(outcomes)] += 1
                    break
                outcomes.append(outcome)
            if outcomes and outcomes[0].failed:
                return [replace(outcomes[0], calls=0)] * len(probes)  # the calls of opening are none of theirs
        return outcomes[1:]

    def outcome_of(self, probe: Probe) -> Outcome:
        """The outcome of one probe."""
        (outcome,) = self.run([probe])
        return outcome

    def _first_outcomes(self, probes: Sequence[Probe]) -> Iterator[Outcome]:
        """Yield the outcomes of the first probes: of all of them, or up to and including a hang or a crash."""
        if not self.isolate or not hasattr(os, "fork"):
            if self._here is None or not self._kept:
                self._here = Serving(self.target, probes)
            self._here.probes = probes
            yield from map(self._here.outcome, range(len(probes)))
            return
        log = self._process[2] if self._process else _CallLog(Path(tempfile.mkdtemp()) / "last_call")
        try:
            session = self._started(probes, log)
            for i, probe in enumerate(probes):
                yield self._answer(session, i, log, opening=probe is opens)
        except ProcessEnded as ended:
            call = f" in step({log.call})" if log.call else " while the stepper was imported"
            self.__exit__()
            yield Outcome(kind=_ENDS.get(ended.cause, CRASHES), seen=f"{ended}{call}")
        finally:
            if not self._kept:
                self.__exit__()

    def _started(self, probes: Sequence[Probe], log: _CallLog) -> Session:
        """The process, which knows the probes it will run. Raises ProcessEnded."""
        if self._process is not None:
            self._process[1].ask(_packed(list(probes)), START_UP)
            return self._process[1]
        stack = ExitStack()
        stack.callback(shutil.rmtree, log.path.parent, ignore_errors=True)
        serving = Serving(self.target, probes, log.path, self.hung)
        limits = Limits(self.time_limit, memory=MEMORY_LIMIT)
        anew = self.target.by_name and not _is_command_alone()
        session = stack.enter_context(Session(f"{__name__}:answer_probe" if anew else serving, limits))
        self._process = stack, session, log
        session.ask(_packed(serving) if anew else None, START_UP)
        return session

    def _answer(self, session: Session, index: int, log: _CallLog, *, opening: bool) -> Outcome:
        """The outcome of one probe. Raises ProcessEnded, with the cause "time" if its time is over."""
        start, call, since = monotonic(), "", monotonic()
        limit = max(0.0, self.time_limit - self.spent) * _SHARE_OF_PROBE
        patience = max(LEAST_LIMIT, PATIENCE * self._longest)
        a_call = limit * _SHARE_OF_FIRST_CALL if opening else min(patience, self.time_limit * _SHARE_OF_CALL)
        ask: Callable[[float], str] = partial(session.ask, index)
        try:
            while True:
                try:
                    outcome: Outcome = decode(ask(min(_LOOK, limit)), "driftproof")
                    self._longest = max(self._longest, monotonic() - start)
                    return outcome
                except ProcessEnded as ended:
                    now, ask = monotonic(), session.wait
                    if ended.cause != "time":
                        raise
                except MessageError as error:
                    raise ProcessEnded("answer", f"{error}: something else wrote into our pipe") from None
                if (at := log.now()) != call:
                    call, since = at, now
                if call.startswith(_CALLING) and now - since >= a_call:
                    self.hung.append(_not_again(log.call))
                    raise ProcessEnded("time", f"no answer within {a_call:.3g} s")
                if now - start >= limit:
                    whole = f"the {self.time_limit:.3g} s for the whole run were not enough"
                    raise ProcessEnded("time", f"{whole}: stopped after {limit:.3g} s")
        finally:
            self.spent += monotonic() - start


def _is_command_alone() -> bool:
    """True in `driftproof COMMAND` while no foreign module is loaded: a fork then equals a fresh interpreter.

    Names with a leading underscore are those of files that run when any interpreter starts.
    """
    main = getattr(sys.modules["__main__"], "main", None)
    loaded = {name.partition(".")[0] for name in sys.modules} - sys.stdlib_module_names - _OURS
    return getattr(main, "__module__", "") == "driftproof.cli" and all(name.startswith("_") for name in loaded)


def _packed(plain: object) -> str:
    return base64.b64encode(pickle.dumps(plain)).decode()


# The kind of outcome for each cause of an end without an answer; any other cause is a crash of the subject.
_ENDS = {"time": NoAnswer.kind, "killed": KILLED, "raised": INSTRUMENT_FAILED}


def _not_again(call: str) -> str:
    """The text of calls to refuse from now on: the call that hung, or its h alone if that is not an ordinary one."""
    h = call.rpartition("h=")[2]
    try:
        ordinary = _ORDINARY_STEPS[0] <= abs(float(h)) <= _ORDINARY_STEPS[1]
    except ValueError:  # a number of another arithmetic
        ordinary = True
    return call if ordinary else f"h={h}"


_CALLING, _BACK = "calling", "back"


@dataclass(frozen=True)
class _CallLog:
    """A file in which the worker writes the call that it is about to make, with a number, and that it is back."""

    path: Path

    def __post_init__(self) -> None:
        self.path.touch()

    def now(self) -> str:
        return self.path.read_bytes().decode(errors="replace").partition("\n")[0]

    @property
    def call(self) -> str:
        """The last call, whether or not it is back."""
        return self.now().partition(": ")[2]


@dataclass
class Serving:
    """The worker's side: opens the subject at the first request, and answers each request by the outcome of one probe.

    The file `log`, if there is one, holds the call that is being made. Calls listed in `hung` are refused.
    """

    target: Examined
    probes: Sequence[Probe]
    log: Path | None = None
    hung: Sequence[str] = ()
    _opened: Any = field(default=None, init=False)
    _calls: int = field(default=0, init=False)
    _call: str = field(default="", init=False)

    def __call__(self, request: int | str | None) -> str:
        """The encoded outcome of one probe, by its number; "" for None and for a text, which replaces the probes."""
        if isinstance(request, str):
            self.probes = pickle.loads(base64.b64decode(request))
        return encode(self.outcome(request)) if isinstance(request, int) else ""

    def outcome(self, index: int) -> Outcome:
        """The outcome of one probe; warnings of the subject, as of overflow, are not shown."""
        before = self._calls
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if self._opened is None:
                self._environment = FloatEnvironment()
                self._file = None if self.log is None else os.open(self.log, os.O_WRONLY)
                try:
                    self._environment.enter()
                    self._opened = self.target.open(self._before, self._after)
                except (NoAnswer, Exception) as error:
                    self._opened = _failure(error)
            found = self._opened if isinstance(self._opened, Outcome) else _outcome(self.probes[index], self._opened)
            return replace(found, arithmetic=self._environment.change, calls=self._calls - before)

    def _before(self, call: str) -> None:
        if not self._calls:
            self._environment.leave("since the stepper was imported")
        self._calls, self._call = self._calls + 1, call
        for one in self.hung:
            if call == one or call.endswith(f", {one}"):
                raise NoAnswer(f"step({call}) did not return in time")
        self._note(_CALLING)
        self._environment.enter()

    def _after(self) -> None:
        self._environment.leave(f"since step({self._call})")
        self._note(_BACK)

    def _note(self, word: str) -> None:
        if self._file is not None:
            os.pwrite(self._file, f"{word} {self._calls}: {self._call}\n".encode(), 0)


_serving: list[Serving] = []


def answer_probe(request: str | int) -> str | None:
    """Serve a fresh interpreter: the first request is a pickled `Serving`, which then answers all others."""
    if not _serving:
        _serving.append(pickle.loads(base64.b64decode(str(request))))
        return None
    return _serving[0](request)


def _outcome(probe: Probe, subject: Any) -> Outcome:
    try:
        return Outcome(probe(subject))
    except (NoAnswer, Exception) as error:
        return _failure(error)


def _failure(error: BaseException) -> Outcome:
    if not hasattr(error, "kind"):  # a fault of ours: the subject's own exceptions come as Misbehaviour
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        return Outcome(kind=INSTRUMENT_FAILED, seen=f"{type(error).__name__} in {where}: {error}; please report this")
    limit = f" (an isolated process is given {MEMORY_LIMIT / 2**30:g} GiB)"
    seen = f"{error}".rstrip() + limit if isinstance(error.__cause__, MemoryError) else str(error)
    return Outcome(kind=error.kind, seen=seen, traits=getattr(error, "traits", ()))
