"""Tasks timed side by side: interleaved turns, minimum, median and spread, and what each of them answered."""

from __future__ import annotations

import argparse
import contextlib
import gc
import io
import statistics
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any

from driftproof.numeric.work_precision.timing import collector_off, spread_of
from driftproof.support.plain_text import table

# How long one turn repeats a short task, and after how long a contestant gets no further turn, in seconds.
TURN, LIMIT = 0.02, 3.0
ROUNDS = 7
# A longer answer is compared, and not shown.
LONGEST_ANSWER = 24


@dataclass(frozen=True)
class Contestant:
    """A way to answer. `before` and `read` are not timed.

    `before` puts the caches into the state in which the task is timed; `read` turns what the task returns into the
    text by which answers are compared.
    """

    task: Callable[[], Any]
    read: Callable[[Any], str] = str
    before: Callable[[], object] = lambda: None


@dataclass(frozen=True)
class Subject:
    """One question and who answers it; `ours` comes first, the goal for its minimum is in ms."""

    name: str
    contestants: Mapping[str, Contestant]
    goal: float | None = None


@dataclass(frozen=True)
class Times:
    """The times of one contestant in ms."""

    samples: Sequence[float]

    @property
    def best(self) -> float:
        return min(self.samples)

    @property
    def median(self) -> float:
        return statistics.median(self.samples)

    @property
    def spread(self) -> float | None:
        """As `spread_of`."""
        return spread_of(self.samples)


@dataclass(frozen=True)
class Goal:
    """What was wanted of one number, and what it was."""

    what: str
    wanted: str
    found: str
    met: bool


@dataclass(frozen=True)
class Section:
    """A table that is not one of times, its header first, and the goals that its numbers are held to."""

    title: str
    rows: Sequence[Sequence[str]]
    goals: Sequence[Goal] = ()


@dataclass(frozen=True)
class Row:
    """A subject, measured: times and answers by contestant, `ours` first."""

    name: str
    times: Mapping[str, Times]
    answers: Mapping[str, str] = field(default_factory=dict)
    limit: float | None = None

    def goals(self) -> Iterator[Goal]:
        """That the minimum of ours is not above the limit, if there is one."""
        if self.limit is not None:
            best = self.times["ours"].best
            yield Goal(self.name, f"≤ {milliseconds(self.limit)}", milliseconds(best), best <= self.limit)

    def ratio(self, other: str) -> float:
        """The other's minimum over ours."""
        return self.times[other].best / self.times["ours"].best


def milliseconds(value: float) -> str:
    """Three digits, in s from 1000 ms on."""
    return f"{value / 1000:.3g} s" if value >= 1000 else f"{value:.3g} ms"


def percent(share: float | None) -> str:
    """A share in whole percents; nothing for None."""
    return "" if share is None else f"{100 * share:.0f} %"


def measure(subjects: Sequence[Subject], rounds: int, turn: float = TURN, limit: float = LIMIT) -> list[Row]:
    """Every contestant has one turn a round, in which a short task is repeated for about `turn` seconds.

    A busy moment of the machine meets all of them, because the turns interleave. A contestant that has spent `limit`
    seconds gets no further turn, so that one call of a slow one is enough.
    """
    samples = [{who: list[float]() for who in subject.contestants} for subject in subjects]
    answers = [dict[str, str]() for _ in subjects]
    for _ in range(rounds):
        for subject, taken, said in zip(subjects, samples, answers, strict=True):
            for who, contestant in subject.contestants.items():
                if sum(taken[who]) < 1000 * limit:
                    times, said[who] = _one_turn(contestant, turn)
                    taken[who] += times
    return [
        Row(subject.name, {who: Times(times) for who, times in taken.items()}, said, subject.goal)
        for subject, taken, said in zip(subjects, samples, answers, strict=True)
    ]


def _one_turn(contestant: Contestant, turn: float) -> tuple[list[float], str]:
    """At least one time in ms, and the answer."""
    taken: list[float] = []
    left = 1000 * turn
    gc.collect()
    with quiet(), collector_off():
        while not taken or left > 0:
            contestant.before()
            start = perf_counter()
            result = contestant.task()
            taken.append(1000 * (perf_counter() - start))
            left -= taken[-1]
        return taken, contestant.read(result)


def forget() -> None:
    """Empty every cache of a function in `symbolic` and `methods`: tables of trees, isolated roots, fields."""
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


def with_peers(subjects: Iterable[Subject], peers: Iterable[Mapping[str, Mapping[str, Contestant]]]) -> list[Subject]:
    """The subjects, each with those contestants that the peers have under its name. Raises KeyError for no subject."""
    found = {subject.name: subject for subject in subjects}
    for peer in peers:
        for name, contestants in peer.items():
            found[name] = replace(found[name], contestants={**found[name].contestants, **contestants})
    return list(found.values())


def times_rows(rows: Iterable[Row]) -> list[list[str]]:
    """Every contestant of every row: minimum, median, spread, number of samples, its minimum over ours, its answer."""
    lines = [["", "", "minimum", "median", "spread", "samples", "over ours", "answer"]]
    for row in rows:
        for who, times in row.times.items():
            ratio = "" if who == "ours" else f"{row.ratio(who):.3g}"
            shown = (
                milliseconds(times.best),
                milliseconds(times.median),
                percent(times.spread),
                str(len(times.samples)),
            )
            lines.append([row.name if who == "ours" else "", who, *shown, ratio, _verdict(row, who)])
    return lines


def _verdict(row: Row, who: str) -> str:
    answer, right = row.answers[who], row.answers["ours"]
    return (answer if len(answer) <= LONGEST_ANSWER else "") if who == "ours" else "same" if answer == right else answer


def goal_rows(goals: Iterable[Goal]) -> list[list[str]]:
    """Each goal in one line, with whether it is met."""
    lines = [[goal.what, goal.wanted, goal.found, "met" if goal.met else "**missed**"] for goal in goals]
    return [["goal", "wanted", "measured", ""], *lines]


def print_measured(arguments: Sequence[str] | None, about: str | None, rows: Callable[[int], list[Row]]) -> None:
    """The command line of a benchmark: measure, and print the goals and the times."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"turns of each contestant (default {ROUNDS})")
    measured = rows(parser.parse_args(arguments).rounds)
    print(table(times_rows(measured)), table(goal_rows(g for row in measured for g in row.goals())), sep="\n\n")
