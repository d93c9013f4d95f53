"""Published reference solutions beside ours; run as a program, this writes docs/reference_digits.md."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.numeric.problems.catalogue import PROBLEMS

DOCS = Path(__file__).parents[3] / "docs"
HEAD = """# Digits in print of stiff reference solutions

Ours are enclosed in balls, to 20 digits; `make long` encloses them anew. A published number has so many right digits as
it has when it is within half a unit of the last of them. This page is written by
`python -m tests.witnesses.references.literature`.

| problem | t | component | published | ours | right digits | source |
|---|---|---|---|---|---|---|
"""


def published() -> list[dict[str, Any]]:
    text = (DOCS / "published_digits.toml").read_text(encoding="utf-8")
    return list(tomllib.loads(text)["published"])


def right_digits(text: str, ours: Fraction) -> int:
    """How many of the digits after 0. are right; `text` is like 0.1706E+01."""
    mantissa, _, exponent = text.partition("E")
    places = len(mantissa.partition(".")[2])
    error = abs(Fraction(text) - ours)
    return max((d for d in range(1, places + 1) if error <= Fraction(10) ** (int(exponent) - d) / 2), default=0)


def rows() -> Iterator[tuple[str, str, str, str, str, int, str]]:
    """Problem, time, component, both texts, right digits, source."""
    for entry in published():
        reference = PROBLEMS[entry["problem"]].reference
        state = reference.states[reference.times.index(Fraction(entry["t"]))]
        for i, (text, ours) in enumerate(zip(entry["y"], state, strict=True)):
            yield entry["problem"], entry["t"], f"y{i}", text, ours, right_digits(text, Fraction(ours)), entry["source"]


def page() -> str:
    return HEAD + "".join(f"| {' | '.join(map(str, row))} |\n" for row in rows())


if __name__ == "__main__":
    (DOCS / "reference_digits.md").write_text(page(), encoding="utf-8")
