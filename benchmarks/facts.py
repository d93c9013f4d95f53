"""Every fact of a method and of the whole catalogue, after the imports: python benchmarks/facts.py"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

from benchmarks.timing import Row, Subject, cold_and_warm, measure, print_measured
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.facts import FACTS
from driftproof.texts.writing.records import facts_of

CATALOGUE = "every fact of the whole catalogue"


def asked(*keys: str) -> int:
    """Ask everything of these methods; how many facts that were."""
    return sum(len(facts_of(METHODS[key])) for key in keys)


def subjects() -> list[Subject]:
    """Two methods and all; goals in ms."""
    return [
        Subject("every fact of rk4", cold_and_warm(lambda: asked("rk4")), 50),
        Subject("every fact of dop853", cold_and_warm(lambda: asked("dop853")), 2000),
        Subject(CATALOGUE, cold_and_warm(lambda: asked(*METHODS)), 60_000),
    ]


def rows(rounds: int) -> list[Row]:
    """All of them, measured; the catalogue in three rounds at most, for it takes seconds."""
    *single, catalogue = subjects()
    return [*measure(single, rounds), *measure([catalogue], min(rounds, 3), limit=60)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    print_measured(arguments, __doc__, rows)
    print(f"\n{len(FACTS)} facts a method")


if __name__ == "__main__":
    main()
