"""Reading float trajectories of any solver: objects with .t and .y, arrays, files of text and .npz files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.columns import ReadColumns, column_names, named_columns, unnamed_columns
from driftproof.support.files import read_bytes, read_utf8

# The unit roundoffs of the two formats that the numbers of a trajectory may have.
BINARY64_UNIT, BINARY32_UNIT = Fraction(1, 2**53), Fraction(1, 2**24)
# chosen: a trajectory in a file of more bytes than this could not be enclosed in a session.
LARGEST_RUN = 2**28
# Numbers in a file, which names may not be: whole ones may, as those of the columns of a data frame.
_HEXADECIMAL = re.compile(r"[-+]?0x([\da-f]*\.?[\da-f]+)")
_SEPARATOR, _WHOLE = re.compile(r"[,;\s]+"), re.compile(r"\d+")
# A comma between digits, in a line where other signs separate numbers.
_DECIMAL_COMMA = re.compile(r"(?=.*\d,\d).*[^,;\s](\s*;\s*|\s+)[^,;\s]")


@dataclass(frozen=True)
class Trajectory:
    """Increasing times, and a row of floats at each; `unit` is 2⁻²⁴ if all numbers are binary32 numbers, else 2⁻⁵³.

    `said` tells how the columns of a file were read, where that is not plain from their names, or that a solver failed.
    """

    times: list[float]
    states: list[list[float]]
    unit: Fraction
    said: str = ""

    @property
    def exact_times(self) -> list[Fraction]:
        """The times as exact fractions."""
        return [Fraction(t) for t in self.times]


def has_trajectory(solution: object) -> bool:
    """True if the object has .t and .y, like SciPy's solutions, or .ts and .ys, like diffrax's."""
    return any(all(hasattr(solution, name) for name in pair) for pair in (("t", "y"), ("ts", "ys")))


def failure_of(solution: object) -> str:
    """What a result of SciPy says of a run that its solver could not finish; an empty string of any other."""
    finished = getattr(solution, "success", True)
    if finished or not isinstance(finished, bool | np.bool_):
        return ""
    why = " ".join(str(getattr(solution, "message", "")).split()).rstrip(".") or "it gives no reason"
    return f"the solver failed: {why}; its run ends at t = {np.ravel(getattr(solution, 't', np.nan))[-1]:.9g}"


def trajectory_of(t: Any, y: Any = None) -> Trajectory:
    """The trajectory of times and rows or, without y, of a solver's result. Raises Refused if it is no trajectory.

    If rows do not fit, y may have a column for each time. Trailing times of inf, with which diffrax pads, are dropped.
    """
    said = failure_of(t) if y is None else ""
    if y is None:
        if not has_trajectory(t):
            raise Refused(f"{type(t).__name__} has neither .t and .y nor .ts and .ys; give t and y as two arguments")
        t, y = (t.t, np.asarray(t.y).T) if hasattr(t, "y") else _unfilled(t.ts, t.ys)
    times, states = _floats("t", t), _floats("y", y)
    if times.ndim != 1 or len(times) < 2:
        raise Refused(f"t has the shape {times.shape}; it must be a row of at least two times")
    if states.ndim == 1:
        states = states[:, None]
    if states.ndim == 2 and states.shape[0] != len(times) == states.shape[1]:
        states = states.T
    if states.ndim != 2 or len(states) != len(times) or not states.shape[1]:
        raise Refused(f"y has the shape {states.shape}; it must have a row for each of {len(times)} times")
    for i, (before, after) in enumerate(pairwise(times), 1):
        if not before < after:
            how = "; of a run backwards give lambda s, y: -f(-s, y) and -t" if (np.diff(times) < 0).all() else ""
            again = "; after an event or a restart begins a new run: certify each piece by itself"
            how = again if before == after else how
            raise Refused(f"times must increase, but t[{i}] = {after} is not above t[{i - 1}] = {before}{how}")
    with np.errstate(over="ignore"):
        narrow = (states.astype(np.float32) == states).all() and (times.astype(np.float32) == times).all()
    return Trajectory(times.tolist(), states.tolist(), BINARY32_UNIT if narrow else BINARY64_UNIT, said)


def _unfilled(ts: Any, ys: Any) -> tuple[Any, Any]:
    times = np.asarray(ts)
    kept = len(times) if times.ndim != 1 or times.dtype.kind != "f" else int(np.sum(times < np.inf))
    return times[:kept], np.asarray(ys)[:kept]


def _floats(name: str, values: Any) -> Any:
    try:
        found = np.asarray(values)
    except ValueError:
        raise Refused(f"{name} is not a table of numbers: its rows differ in length") from None
    if found.dtype.kind == "U":
        raise ValueError(f"{name} is text; give t and y as arrays of numbers, or in their place the path of one file")
    if found.dtype.kind not in "fiu" or found.dtype.itemsize > 8:
        raise Refused(f"{name} has the type {found.dtype}; give floats of at most 64 bits")
    if not np.isfinite(found).all():
        where = np.argwhere(~np.isfinite(found))[0].tolist()
        raise Refused(f"{name}{where} is {found[tuple(where)]}, not a finite number")
    made = found.astype(float)
    with np.errstate(invalid="ignore"):  # of 2^63 as an integer
        off = np.argwhere(made.astype(found.dtype) != found)
    if off.size:
        raise Refused(f"{name}{off[0].tolist()} is {found[tuple(off[0])]}, which is no double")
    return made


def read_trajectory(path: Path, unknowns: Sequence[str] = ()) -> Trajectory:
    """The trajectory in a file of text or of arrays. Raises ValueError, in one line, if it cannot be read or is none.

    .csv, .txt, .dat: a line for each time, with t and then the components, separated by commas, semicolons or blanks,
    or in the order that a first line of names tells, those of `unknowns` if f has names. Other lines that begin with #
    are ignored. Numbers are decimal, such as 1.5, 1.5e0 or 1.5d0, or hexadecimal, such as 0x1.8p+0, and then exact.
    .npz: the arrays t and y, or ts and ys, with a row for each time. .npy: an array with a row for each time, t first.
    """
    if (suffix := path.suffix.lower()) not in (".csv", ".txt", ".dat", ".npz", ".npy"):
        raise ValueError(f"{path}: a trajectory must be a .csv, .txt, .dat, .npz or .npy file")
    by_place = suffix != ".npz"
    try:
        if suffix in (".npz", ".npy"):
            return trajectory_of(*_arrays(path))
        columns, rows = _columns(path, unknowns)
        by_place = columns.time == 0
        found = trajectory_of(
            [row[columns.time] for row in rows], [[row[i] for i in columns.components] for row in rows]
        )
        return replace(found, said=columns.said)
    except Refused as reason:
        first = "; the first column was read as the time" if by_place and str(reason).startswith("times must") else ""
        raise ValueError(f"{path}: {reason}{first}") from None


def _columns(path: Path, unknowns: Sequence[str]) -> tuple[ReadColumns, list[list[float]]]:
    """What the columns of a .csv file are, and its rows."""
    read = [(i, line) for i, line in enumerate(read_utf8(path, LARGEST_RUN).splitlines(), 1) if line.strip()]
    lines, rows = [(i, line) for i, line in read if not line.startswith("#")], list[list[float]]()
    names = column_names(lines[0][1]) if lines else []
    headed = not any(_is_number(name) and (not at or not _WHOLE.fullmatch(name)) for at, name in enumerate(names))
    for number, line in lines[headed:]:
        if _DECIMAL_COMMA.match(line):
            raise ValueError(f"{path}:{number}: decimal commas; write 0.5, with a point")
        try:
            row = [float_of_text(word) for word in _SEPARATOR.split(line.strip()) if word]
        except ValueError as error:
            raise ValueError(f"{path}:{number}: {error}") from None
        if len(row) < 2 or (rows and len(row) != len(rows[0])):
            wanted = f"{len(rows[0])} numbers" if rows else "t and at least one component"
            raise ValueError(f"{path}:{number}: {len(row)} numbers; expected {wanted}")
        rows.append(row)
    if not rows:
        raise ValueError(f"{path}: it has no numbers; write a line for each time: t and the components")
    # As numpy.savetxt writes names.
    remarks = [column_names(line.lstrip("# ")) for i, line in read if i < lines[0][0]][-1:]
    if not headed and remarks and len(remarks[0]) == len(rows[0]) and {"t", "time"} & {*remarks[0]}:
        headed, names = True, remarks[0]
    if not headed:
        return unnamed_columns(len(rows[0]), unknowns), rows
    if len(names) != len(rows[0]):
        raise ValueError(f"{path}: the first line has {len(names)} names, and a row {len(rows[0])} numbers")
    try:
        return named_columns(names, unknowns, [row[0] for row in rows] == [*range(len(rows))]), rows
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def float_of_text(word: str) -> float:
    """The double nearest to a decimal, or the one with these hexadecimal digits. Raises ValueError."""
    digits = _HEXADECIMAL.match(word.lower())
    try:
        found = float.fromhex(word) if digits else float(re.sub(r"(?<=[\d.])[dD](?=[-+]?\d)", "e", word))
    except (ValueError, OverflowError):
        raise ValueError(f"{word[:40]!r} is not a number") from None
    if digits and len(f"{int(digits[1].replace('.', ''), 16):b}".strip("0")) > 53:
        raise ValueError(f"{word[:40]!r} has more digits than a double")
    return found


def _is_number(word: str) -> bool:
    try:
        float_of_text(word)
    except ValueError:
        return False
    return True


def _arrays(path: Path) -> tuple[Any, Any]:
    import zipfile

    content, zipped = BytesIO(read_bytes(path, LARGEST_RUN)), path.suffix.lower() == ".npz"
    try:
        if zipped != zipfile.is_zipfile(content):
            raise ValueError(f"it is no {path.suffix} file, as numpy.{'savez' if zipped else 'save'} writes it")
        content.seek(0)
        held: Any = np.load(content, allow_pickle=False)
        if not zipped:
            if held.ndim != 2 or held.shape[1] < 2:
                raise ValueError(f"its array has the shape {held.shape}; it must have a row for each time: t, y0, ...")
            return held[:, 0], held[:, 1:]
        for names in (("t", "y"), ("ts", "ys")):
            if all(name in held for name in names):
                return held[names[0]], held[names[1]]
        raise ValueError(f"it has {', '.join(held) or 'no arrays'}; it must have the arrays t and y")
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from None
