"""Which column of a file of text is the time and which is which component: by the names in its first line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

# Names of the time, the likeliest first; only t is told from T, which may be a temperature.
_TIME = re.compile("t"), re.compile("time", re.I), re.compile("(times?|ts?|zeit|temps|tiempo|tempo)([_/ ].*)?", re.I)
# Names that pandas and R give, or do not give, to a column that counts the rows.
_COUNTING = ("", "index", "unnamed: 0")
_BLANKS = re.compile(r"\s+")


class ReadColumns(NamedTuple):
    """The places of the time and of the components, in the order of f's unknowns, and what a user should know of it."""

    time: int
    components: tuple[int, ...]
    said: str = ""


def column_names(line: str) -> list[str]:
    """The names in a line, without quotes and units; y[0] and y(0) as y0."""
    words = re.split(r"[,;\t]", line) if re.search(r"[,;\t]", line) else _BLANKS.split(line.strip())
    plain = [re.sub(r"[\[(](\d+)[\])]", r"\1", word.strip().strip("\"'").strip()) for word in words]
    return [re.sub(r"(?<=\w)\s*[\[(].*", "", word) for word in plain]


def unnamed_columns(count: int, unknowns: Sequence[str]) -> ReadColumns:
    """The columns of a file without names: the time comes first."""
    components = ", ".join(unknowns or [f"y{i}" for i in range(count - 1)])
    return ReadColumns(0, tuple(range(1, count)), f"the file names no columns: read as t, {components}")


def named_columns(names: Sequence[str], unknowns: Sequence[str], counts: bool) -> ReadColumns:
    """The columns with these names, for an f with `unknowns` or, without them, any f. Raises ValueError.

    `counts` is true if the first column holds 0, 1, 2, ..., as the index of a data frame does.

    >>> named_columns(["t", "v", "x"], ["x", "v"], counts=False)
    ReadColumns(time=0, components=(2, 1), said='columns read by their names: t, x, v')
    """
    shown = ", ".join(name or '""' for name in names)
    if repeated := next((name for name in names if names.count(name) > 1), ""):
        raise ValueError(f"two columns are named {repeated}")
    times = next((at for each in _TIME if (at := _places(each, names, unknowns))), [])
    if len(times) > 1:
        raise ValueError(f"the columns {', '.join(names[i] for i in times)} may each be the time; name one of them t")
    rest = [i for i in range(len(names)) if i not in times]
    index = [0] if names[0].casefold() in _COUNTING and 0 in rest else []
    rest = [i for i in rest if i not in index]
    if not times and index and not counts:  # the times may be the index of a data frame
        times = index
    found = _in_order(names, rest, unknowns) if times or not unknowns else None
    if not times and unknowns and not index:
        others = [i for i in rest if not any(_is_called(names[i], each) for each in unknowns)]
        if len(others) == 1 < len(names) == len(unknowns) + 1:  # what is no unknown is the time
            times, found = others, _in_order(names, [i for i in rest if i not in others], unknowns)
    if not times:
        why = "; the first counts the rows, as an index does" if index else ""
        raise ValueError(
            f"no column of {shown} is named t or time{why}: name the time t, or leave out the first line and any index"
        )
    if not found:
        raise ValueError(
            f"its columns are {shown}, but f has {', '.join(unknowns)}: name them alike, or leave out the first line "
            f"and give t, {', '.join(unknowns)}"
            if unknowns
            else f"its columns are {shown}; there must be t and at least one component"
        )
    moved = [times[0], *found] != list(range(len(names)))
    read = ", ".join(names[i] or "the index" for i in (times[0], *found))
    return ReadColumns(times[0], tuple(found), f"columns read by their names: {read}" if moved else "")


def _places(time: re.Pattern[str], names: Sequence[str], unknowns: Sequence[str]) -> list[int]:
    return [i for i, name in enumerate(names) if time.fullmatch(name) and name not in unknowns]


def _is_called(name: str, unknown: str) -> bool:
    """True if the name is the unknown's or, for the velocity dx that belongs to x'' = ..., one of such velocities."""
    x = unknown[1:]
    velocities = (f"v{x}", f"v_{x}", f"{x}dot", f"{x}_dot", f"{x}'", f"d{x}/dt", f"d{x}dt") if unknown[0] == "d" else ()
    return name.casefold() == unknown.casefold() or name in velocities


def _in_order(names: Sequence[str], rest: Sequence[int], unknowns: Sequence[str]) -> list[int] | None:
    """The places of the unknowns; None if the names do not tell. Without unknowns, y0, y1, ... stand in their order."""
    if not unknowns:
        parts = [re.fullmatch(r"(.*?)(\d+)", names[i]) for i in rest]
        numbers = {i: int(part[2]) for i, part in zip(rest, parts, strict=True) if part}
        numbered = len(numbers) == len(rest) and len({part[1] for part in parts if part}) == 1
        return sorted(rest, key=numbers.__getitem__) if numbered else list(rest)
    found = {each: next((i for i in rest if names[i] == each), None) for each in unknowns}
    for each in unknowns:
        free = [i for i in rest if i not in found.values()]
        if found[each] is None:
            found[each] = next((i for i in free if _is_called(names[i], each)), None)
    missing, free = [each for each in unknowns if found[each] is None], [i for i in rest if i not in found.values()]
    if len(missing) == len(free) == 1:
        found[missing[0]] = free[0]
    places = [i for i in found.values() if i is not None]
    return places if len(places) == len(unknowns) else None
