"""All public bugs that are replayed, and the page of what is said of them.

`python -m tests.campaigns.public_bugs > docs/public_bugs.md` examines all of them and their mended twins.
"""

from __future__ import annotations

import sys
from typing import NamedTuple

from tests.campaigns.public_family_bugs import FAMILIES
from tests.campaigns.public_solver_bugs import REPLAYS, Replay
from tests.campaigns.public_step_bugs import STEPS

ALL = (*REPLAYS, *STEPS, *FAMILIES)
HEAD = """# Public bugs, replayed

What driftproof says of mistakes that stood in public integrators: each is a small twin in our own words, with the
mistake and mended; the code of the threads is not used. This page is written by

    python -m tests.campaigns.public_bugs > docs/public_bugs.md

A bug is **caught** when a fault is found, or a remark on a solver, when `verify` says that it is not its method, or
when `identify` says that it is what it should not be; the cause is **named** when the report holds the words that a
maintainer needs, which that on the mended twin does not hold. An **alarm** is a fault that is found in a mended twin.
"""


class Outcome(NamedTuple):
    """What came of a replay."""

    caught: bool
    named: bool
    alarm: bool
    said: str


def outcome(replay: Replay) -> Outcome:
    """Both twins examined."""
    buggy, mended = replay.examine(replay.buggy), replay.examine(replay.mended)
    named = bool(replay.cause) and replay.cause in buggy.words and replay.cause not in mended.words
    told = next((fault for fault in buggy.faults if replay.cause in fault), next(iter(buggy.faults), ""))
    return Outcome(named or bool(buggy.faults), named, bool(mended.faults), told or replay.cause)


def link(reference: str) -> str:
    """The thread, where it is one."""
    repository, number, thread = reference.partition("#")
    return f"[{reference}](https://github.com/{repository}/issues/{thread})" if number else reference


def page(outcomes: list[Outcome]) -> str:
    """The page of docs."""
    counts = [sum(column) for column in zip(*(each[:3] for each in outcomes), strict=True)]
    summary = f"Of {len(ALL)} bugs, {counts[0]} are caught, {counts[1]} with the cause named; {counts[2]} alarms."
    without = sum(found.caught and found.said == replay.cause for replay, found in zip(ALL, outcomes, strict=True))
    summary += f" Of {without} no fault is told: what they are said to be is not what they should be."
    rows = [
        f"| {link(replay.reference)} | {replay.about} | {'yes' if found.caught else '**no**'} | "
        f"{'yes' if found.named else '**no**'} | {found.said.replace('|', ' ')[:160]} |"
        for replay, found in zip(ALL, outcomes, strict=True)
    ]
    table = ["| thread | mistake | caught | named | what is said |", "|---|---|---|---|---|", *rows]
    return "\n".join([HEAD, f"**{summary}**", "", *table]) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page([outcome(replay) for replay in ALL]))
