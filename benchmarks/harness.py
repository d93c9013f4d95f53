"""Tasks timed side by side: interleaved turns, minimum, median and spread, what each answered, and goals."""

from __future__ import annotations

import contextlib
import gc
import io
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

from driftproof.numeric.work_precision.timing import TimeSource, Timing, collector_off

# How long one turn repeats a short task, and after how long a contestant gets no further turn, in seconds.
TURN, LIMIT = 0.02, 3.0
ROUNDS = 7
# A longer answer is compared, and not shown.
LONGEST_ANSWER = 24


@dataclass(frozen=True)
class Contestant:
    """A way to answer. `before` and `read` are not timed.

    `before` puts the caches into the state in which the task is timed; `read` turns what the task returns into the
    text by which answers are compared; with `our_bits` it is a goal that they are the same.
    """

    task: Callable[[], Any]
    read: Callable[[Any], str] = str
    before: Callable[[], object] = lambda: None
    our_bits: bool = False


@dataclass(frozen=True)
class Subject:
    """One question and who answers it; `ours` comes first.

    `goal` is the most that its minimum may be, in ms. `shares` are the most that the minimum of one contestant may be
    of another's, by both their names.
    """

    name: str
    contestants: Mapping[str, Contestant]
    goal: float | None = None
    shares: Mapping[tuple[str, str], float] = field(default_factory=dict)


@dataclass(frozen=True)
class Goal:
    """What was wanted of one number, and what it was."""

    what: str
    wanted: str
    found: str
    met: bool


@dataclass(frozen=True)
class Section:
    """A table, its header first, and the goals that its numbers are held to."""

    title: str
    rows: Sequence[Sequence[str]]
    goals: Sequence[Goal] = ()


@dataclass(frozen=True)
class Row:
    """A subject, measured: times and answers by contestant, `ours` first."""

    subject: Subject
    times: Mapping[str, Timing]
    answers: Mapping[str, str]

    def goals(self) -> Iterator[Goal]:
        """What is wanted of our minimum, of shares of minima in this run, and of bits."""
        name, limit = self.subject.name, self.subject.goal
        if limit is not None:
            best = 1000 * self.times["ours"].best
            yield Goal(name, f"≤ {milliseconds(limit)}", milliseconds(best), best <= limit)
        for (one, other), most in self.subject.shares.items():
            if {one, other} <= self.times.keys():
                share = self.times[one].best / self.times[other].best
                what, wanted, found = f"{one} over {other}", f"≤ {most:g}", f"{share:.3g}"
                if most < 1:
                    what, wanted, found = f"{other} over {one}", f"≥ {1 / most:g}", f"{1 / share:.3g}"
                yield Goal(f"{name}: {what}", wanted, found, share <= most)
        for who, contestant in self.subject.contestants.items():
            if contestant.our_bits:
                alike = self.answers[who] == self.answers["ours"]
                yield Goal(f"{name}: {who}", "our bits", "our bits" if alike else "others", alike)

    def lines(self) -> Iterator[list[str]]:
        """A line for each contestant, as the header of `timed` says."""
        right = self.answers["ours"]
        for who, times in self.times.items():
            if who == "ours":
                name, ratio, answer = self.subject.name, "", right if len(right) <= LONGEST_ANSWER else ""
            else:
                name, ratio = "", f"{times.best / self.times['ours'].best:.3g}"
                answer = "same" if self.answers[who] == right else self.answers[who]
            yield [name, who, *spread_shown(times), ratio, answer]


def milliseconds(value: float) -> str:
    """Three digits, in s from 1000 ms on."""
    return f"{value / 1000:.3g} s" if value >= 1000 else f"{value:.3g} ms"


def spread_shown(times: Timing) -> list[str]:
    """Minimum, median, spread and number of samples."""
    spread = "" if times.spread is None else f"{100 * times.spread:.0f} %"
    return [milliseconds(1000 * times.best), milliseconds(1000 * times.median), spread, str(len(times.samples))]


def timed(title: str, subjects: Iterable[Subject], rounds: int, clock: TimeSource | None = None) -> Section:
    """The subjects, measured: who took how long, who was how many times slower than ours, who answers otherwise."""
    rows = measure(list(subjects), rounds, clock=clock)
    header = ["", "", "minimum", "median", "spread", "samples", "over ours", "answer"]
    return Section(
        title, [header, *(line for row in rows for line in row.lines())], [g for r in rows for g in r.goals()]
    )


def measure(
    subjects: Sequence[Subject],
    rounds: int,
    turn: float = TURN,
    limit: float = LIMIT,
    clock: TimeSource | None = None,
) -> list[Row]:
    """Every contestant has one turn a round, in which a short task is repeated for about `turn` seconds.

    A busy moment of the machine meets all of them, because the turns interleave. A contestant that has spent `limit`
    seconds gets no further turn, so that one call of a slow one is enough. Seconds are the clock's, or of another
    `clock`, such as `time.process_time`.
    """
    rows = [Row(subject, {who: Timing() for who in subject.contestants}, dict[str, str]()) for subject in subjects]
    for _ in range(rounds):
        for row in rows:
            for who, contestant in row.subject.contestants.items():
                if sum(row.times[who].samples) < limit:
                    taken, answer = one_turn(contestant, turn, clock or perf_counter)
                    row.times[who].samples.extend(taken)
                    row.answers[who] = answer  # type: ignore[index]
    return rows


def one_turn(contestant: Contestant, turn: float, clock: TimeSource) -> tuple[list[float], str]:
    """At least one time in seconds, and the answer."""
    taken, spent = list[float](), 0.0
    gc.collect()
    with quiet(), collector_off():
        while not taken or spent < turn:
            contestant.before()
            start = clock()
            result = contestant.task()
            taken.append(clock() - start)
            spent += taken[-1]
        return taken, contestant.read(result)


def forget() -> None:
    """Empty every cache of a function on the exact side: tables of trees, isolated roots, fields."""
    for name, module in list(sys.modules.items()):
        if name.startswith(("driftproof.symbolic", "driftproof.methods")):
            for value in vars(module).values():
                clear = getattr(value, "cache_clear", None)
                if clear is not None:
                    clear()


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Nothing is printed and nothing is warned of: peers do both."""
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def cold_and_warm(task: Callable[[], Any], read: Callable[[Any], str] = str) -> dict[str, Contestant]:
    """Ours twice: with every cache emptied before each call, and with what the calls before have left."""
    return {"ours": Contestant(task, read, forget), "ours, warm": Contestant(task, read)}


def with_largest_tolerance(
    solver: Callable[[float], Callable[[], Any]],
    tolerances: Sequence[float],
    error: Callable[[Any], float],
    most: float,
) -> Contestant:
    """The solver with the largest tolerance with which it reaches the error; with the smallest if none does.

    What it finds is the last state and the number of steps.
    """
    tasks = (solver(tolerance) for tolerance in tolerances)
    task = next((task for task in tasks if error(task()[0]) <= most), solver(tolerances[-1]))
    return Contestant(task, lambda found: f"{error(found[0]):.1e}, {found[1]} steps")


def by_scipy(rate: Callable[..., Any], start: Sequence[float], end: float, name: str, **given: Any) -> tuple[Any, int]:
    """The last state and the number of steps of a solver of SciPy."""
    from scipy.integrate import solve_ivp

    found = solve_ivp(rate, (0.0, end), start, name, **given)
    return found.y[:, -1], len(found.t) - 1


def goal_rows(goals: Iterable[Goal]) -> list[list[str]]:
    """Each goal in one line, with whether it is met."""
    lines = [[goal.what, goal.wanted, goal.found, "met" if goal.met else "**missed**"] for goal in goals]
    return [["goal", "wanted", "measured", ""], *lines]
