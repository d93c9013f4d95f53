"""Writes numeric/problems/digits.json anew: `python -m tests.witnesses.references.write [KEY...]`, minutes a key.

The times stand in the file; those of a new problem are written there by hand first, with any states.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from driftproof.numeric.problems.catalogue import PROBLEMS
from tests.witnesses.references.solutions import computed

DIGITS = Path(__file__).parents[3] / "driftproof/numeric/problems/digits.json"


def written(found: dict[str, dict[str, list[str]]]) -> str:
    """The file, one line a state."""
    blocks = []
    for key in sorted(found):
        lines = ",\n".join(f"  {json.dumps(t)}: {json.dumps(state)}" for t, state in found[key].items())
        blocks.append(f" {json.dumps(key)}: {{\n{lines}\n }}")
    return "{\n" + ",\n".join(blocks) + "\n}\n"


def main(keys: Sequence[str]) -> None:
    found = json.loads(DIGITS.read_text(encoding="utf-8"))
    for key in keys or PROBLEMS:
        times = PROBLEMS[key].reference.times
        found[key] = dict(zip(map(str, times), computed(PROBLEMS[key], times), strict=True))
        print(key, flush=True)
    DIGITS.write_text(written(found), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
