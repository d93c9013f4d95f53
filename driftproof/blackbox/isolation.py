"""Probes of foreign code in an isolated process with limits: a crash there is a finding, a hang is told."""

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

from driftproof.blackbox.findings import Misbehaviour, NoAnswer, Outcome
from driftproof.blackbox.stepper.float_environment import FloatEnvironment
from driftproof.support.messages import MessageError, decode, encode
from driftproof.support.processes import START_UP, Limits, ProcessEnded, Session


class Examined(Protocol):
    """What is examined, a stepper or a solver: its name, whether another interpreter can import it, and how to open it.

    What `open` gives is what the probes take.
    """

    @property
    def name(self) -> str:
        """What a report calls it."""

    @property
    def by_name(self) -> bool:
        """True when another interpreter can import all of it."""

    def open(self, before: Callable[[str], None] = ..., after: Callable[[], None] = ...) -> Any:
        """It, ready; `before` and `after` are told of each call. Raises ValueError or a `Misbehaviour`."""


Probe = Callable[[Any], Any]
# Seconds for all probes together: a step of a simulator takes milliseconds, and a report some thousand steps.
TIME_LIMIT = 120.0
# In bytes, beyond what the process has at its start: no stepper of three numbers needs it, and most machines have it.
MEMORY_LIMIT = 8 * 2**30
# One call may take as many times as long as the longest probe before it, and at least so many seconds: with the time in
# which other work holds the processors, or in which a step is compiled anew for numbers of another type.
PATIENCE, LEAST_LIMIT = 4, 5.0
# One probe has this part of the time that is left, a call this part of the whole, so that the others are asked, too;
# and the first call, in which a step may be compiled, most of its probe's.
_SHARE_OF_PROBE, _SHARE_OF_CALL, _SHARE_OF_FIRST_CALL = 1 / 2, 1 / 6, 3 / 4
# A probe is begun anew without the call that hung, so often: each costs the time of a call.
_MOST_HANGS = 3
# What our command loads.
_OURS = {"driftproof", "numpy", "flint", "cython_runtime"}
# Seconds between two looks at the call that is being made.
_LOOK = 0.05
# Steps of other sizes are asked for at the ends of what floats are: what hangs there does so from every state.
_ORDINARY_STEPS = (2.0**-40, 2.0**8)


def opens(subject: Any) -> None:
    """The probe that asks for nothing: it succeeds if the stepper can be imported and answers a first call."""


@dataclass
class IsolatedRunner:
    """Runs probes on one stepper, all of them within `time_limit` seconds, however often it is asked.

    A stepper given by name runs in a fresh interpreter, its probes being picklable, or in a fork of our own command,
    which has loaded nothing else; one given as a callable in a fork of this process. With `isolate` false, or where a
    system cannot fork, it runs here and nothing stops it. The start of processes is not counted. `hung` are the calls
    that did not come back: none of them is made again. In a `with` statement later questions go to the process of the
    first, as long as it lives; they have to be picklable.
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
        """Refuse a time limit that leaves no time: ValueError."""
        if not self.time_limit > 0:
            raise ValueError(f"a time limit of {self.time_limit:g} s leaves no time; write a number above 0")

    def __enter__(self) -> IsolatedRunner:
        """From now on one process is kept."""
        self._kept = True
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        if self._process is not None:
            self._process[0].close()
            self._process = None

    def run(self, probes: Sequence[Probe]) -> list[Outcome]:
        """The outcome of each; after a hang or a crash the rest go on in a new process.

        A stepper that cannot even be opened is tried once: that outcome is the outcome of all. A probe whose call hangs
        is begun anew, and answers without it.
        """
        asked, outcomes, hangs = [opens, *probes], list[Outcome](), Counter[int]()
        while len(outcomes) < len(asked):
            known = len(self.hung)
            for outcome in self._some(asked[len(outcomes) :]):
                if len(self.hung) > known and outcomes and hangs[len(outcomes)] < _MOST_HANGS:
                    hangs[len(outcomes)] += 1
                    break
                outcomes.append(outcome)
            if outcomes and outcomes[0].failed:
                return outcomes[:1] * len(probes)
        return outcomes[1:]

    def outcome_of(self, probe: Probe) -> Outcome:
        """That of one."""
        (outcome,) = self.run([probe])
        return outcome

    def _some(self, probes: Sequence[Probe]) -> Iterator[Outcome]:
        """The outcomes of the first few, at least of one: of all, or up to a hang or a crash."""
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
            outcome = _of_end(ended, log)
            self.__exit__()
            yield outcome
        finally:
            if not self._kept:
                self.__exit__()

    def _started(self, probes: Sequence[Probe], log: _CallLog) -> Session:
        """The process, told what it will be asked. Raises ProcessEnded."""
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
        """The outcome of one probe. Raises ProcessEnded, with the cause "time" when its time is over."""
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
    """True in `driftproof COMMAND` as long as nobody else's modules are loaded: then a fork is a fresh interpreter.

    Names that begin with an underscore are those of files that run when any interpreter starts.
    """
    main = getattr(sys.modules["__main__"], "main", None)
    loaded = {name.partition(".")[0] for name in sys.modules} - sys.stdlib_module_names - _OURS
    return getattr(main, "__module__", "") == "driftproof.cli" and all(name.startswith("_") for name in loaded)


def _packed(plain: object) -> str:
    return base64.b64encode(pickle.dumps(plain)).decode()


# What an end without an answer is; any other is the stepper's own.
_ENDS = {"time": "time_limit", "killed": "killed", "raised": "instrument_failed"}


def _of_end(ended: ProcessEnded, log: _CallLog) -> Outcome:
    """What came of a probe whose process gave no answer."""
    text = log.call
    call = f" in step({text})" if text else " while the stepper was imported"
    return Outcome(kind=_ENDS.get(ended.cause, "crashes"), seen=f"{ended}{call}")


def _not_again(call: str) -> str:
    """What must not stand in a call that is made: the call that hung, or its h where that is no ordinary one."""
    h = call.rpartition("h=")[2]
    try:
        ordinary = _ORDINARY_STEPS[0] <= abs(float(h)) <= _ORDINARY_STEPS[1]
    except ValueError:  # of another arithmetic
        ordinary = True
    return call if ordinary else f"h={h}"


_CALLING, _BACK = "calling", "back"


@dataclass(frozen=True)
class _CallLog:
    """A file in which the far side writes the call that it is about to make, with a number, and that it is back."""

    path: Path

    def __post_init__(self) -> None:
        """Make the file."""
        self.path.touch()

    def now(self) -> str:
        """The last entry."""
        return self.path.read_bytes().decode(errors="replace").partition("\n")[0]

    @property
    def call(self) -> str:
        """The last call, whether it is back or not."""
        return self.now().partition(": ")[2]


@dataclass
class Serving:
    """The far side: opens the stepper at the first request and answers each by the outcome of one probe, as text.

    The call about to be made stands in the file `log`, if there is one. Those that `hung` are refused.
    """

    target: Examined
    probes: Sequence[Probe]
    log: Path | None = None
    hung: Sequence[str] = ()
    _opened: Any = field(default=None, init=False)
    _calls: int = field(default=0, init=False)
    _call: str = field(default="", init=False)

    def __call__(self, request: int | str | None) -> str:
        """The outcome of one probe, encoded; nothing for no probe, or for others that are to be served from now on."""
        if isinstance(request, str):
            self.probes = pickle.loads(base64.b64decode(request))
        return encode(self.outcome(request)) if isinstance(request, int) else ""

    def outcome(self, index: int) -> Outcome:
        """The outcome of one probe; warnings of the stepper's, as of overflow, are not shown."""
        before = self._calls
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if self._opened is None:
                self._environment = FloatEnvironment()
                self._file = None if self.log is None else os.open(self.log, os.O_WRONLY)
                try:
                    self._environment.enter()
                    self._opened = self.target.open(self._before, self._after)
                except (Misbehaviour, NoAnswer, ValueError) as error:
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
    """In a fresh interpreter: what is to be served, as `IsolatedRunner` pickled it, then the probes by their number."""
    if not _serving:
        _serving.append(pickle.loads(base64.b64decode(str(request))))
        return None
    return _serving[0](request)


def _outcome(probe: Probe, subject: Any) -> Outcome:
    try:
        return Outcome(probe(subject))
    except (Misbehaviour, NoAnswer, ValueError) as error:
        return _failure(error)
    except Exception as error:  # ours: the stepper's own exceptions come as Misbehaviour
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        return Outcome(kind="instrument_failed", seen=f"{type(error).__name__} in {where}: {error}; please report this")


def _failure(error: BaseException) -> Outcome:
    limit = f"(an isolated process is given {MEMORY_LIMIT / 2**30:g} GiB)"
    seen = f"{error}{limit}" if isinstance(error.__cause__, MemoryError) else str(error)
    return Outcome(kind=getattr(error, "kind", "bad_input"), seen=seen)
