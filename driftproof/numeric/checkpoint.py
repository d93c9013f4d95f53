"""Answers of a sweep in a file of JSON lines, which survives whatever ends the sweep and says what it is of.

The first line says what is swept, each other one what a point of it found. Lines are written whole and synchronised, a
batch at a time: only the last one can be cut off, and then it is dropped. Floats are strings, to the last bit.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.numeric.scenes import Scene


class Checkpoint:
    """The file, and in `found` what it holds by index of the point."""

    def __init__(
        self, path: Path, scene: Scene, grid: Mapping[str, Sequence[Any]], points: Sequence[Mapping[str, Any]]
    ) -> None:
        """Read the file, or start one. Raises ValueError where there is another, or one whose lines are no answers."""
        self.path, self.points, self.readouts = path, points, scene.readouts
        self.head = _line(
            {
                "sweep": scene.name,
                **{name: strings(getattr(scene, name)) for name in ("selected", "h", "t", "start", "readouts")},
                "grid": [[name, strings(values)] for name, values in grid.items()],
            }
        )
        self.found: dict[int, Any] = {}
        self._open()

    def add(self, batch: Iterable[tuple[int, Any]]) -> None:
        """Append what the points of a batch found."""
        batch = list(batch)
        self._append(b"".join(self._of_point(i, found) for i, found in batch))
        self.found.update(batch)

    def finish(self) -> None:
        """Put the lines in the order of the grid, so that every run of the sweep leaves the same bytes."""
        draft = self.path.with_name(f"{self.path.name}.draft")
        draft.write_bytes(self.head + b"".join(self._of_point(i, self.found[i]) for i in sorted(self.found)))
        os.replace(draft, self.path)

    def _open(self) -> None:
        text = self.path.read_bytes() if self.path.exists() else b""
        lines = text.splitlines(keepends=True)
        cut = lines.pop() if lines and not lines[-1].endswith(b"\n") else b""
        if not (lines[0] == self.head if lines else self.head.startswith(cut)):
            raise ValueError(f"{self.path} is no file of this sweep; name another, or delete it")
        for number, line in enumerate(lines[1:], 2):
            self._read(number, line)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab") as file:
            file.truncate(len(text) - len(cut))
        if not lines:
            self._append(self.head)

    def _append(self, lines: bytes) -> None:
        with self.path.open("ab") as file:
            file.write(lines)
            file.flush()
            os.fsync(file.fileno())

    def _of_point(self, i: int, found: Any) -> bytes:
        kind = "message" if isinstance(found, str) else "readouts"
        return _line({"point": i, **{name: strings(x) for name, x in self.points[i].items()}, kind: strings(found)})

    def _read(self, number: int, line: bytes) -> None:
        """Keep what a line says. It has to be the very line that is written for it."""
        try:
            entry = json.loads(line)
            i, found = entry["point"], entry.get("message")
            if found is None:
                found = {name: _read_out(entry["readouts"][name]) for name in self.readouts}
            right = i not in self.found and self._of_point(i, found) == line
        except (ValueError, LookupError, TypeError, AttributeError):
            right = False
        if not right:
            raise ValueError(f"{self.path}, line {number}: not an answer of this sweep, or one for the second time")
        self.found[i] = found


def _line(entry: dict[str, Any]) -> bytes:
    return f"{json.dumps(entry, ensure_ascii=False)}\n".encode()


def strings(value: Any) -> Any:
    """The value with Fractions and floats as strings, floats to the last bit, arrays as lists; the rest as it is."""
    if isinstance(value, Mapping):
        return {name: strings(x) for name, x in value.items()}
    if isinstance(value, tuple | list):
        return [strings(x) for x in value]
    if hasattr(value, "tolist"):
        return strings(value.tolist())
    return str(value) if isinstance(value, float | Fraction) else value


def _read_out(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_read_out(x) for x in value)
    return float(value) if isinstance(value, str) else value
