"""Long runs in few points that draw the same picture: extremes by column, and one point for neighbours in one place."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

# Indices into the samples, rising.
Kept: TypeAlias = Any


def extremes_by_column(values: Any, columns: int) -> Kept:
    """Of each of `columns` equal parts of the samples, the first, the least, the largest and the last.

    Joined by segments they cover in each column of pixels what all samples cover, if the columns are as wide as those
    (jugel-et-al-2014, the aggregation M4). All samples, where there are not more than that.
    """
    if len(values) <= 4 * columns:
        return np.arange(len(values))
    ends = np.linspace(0, len(values), columns + 1).astype(int)
    kept = set()
    for start, end in pairwise(ends):
        part = values[start:end]
        kept |= {start, start + int(part.argmin()), start + int(part.argmax()), end - 1}
    return np.array(sorted(kept))


def moved(states: Any, distance: float) -> Kept:
    """The first sample, each that has left the square of side `distance` its predecessor is in, and the last."""
    cells = np.floor(states / distance)
    left = np.any(cells[1:] != cells[:-1], axis=1)
    return np.unique(np.concatenate([[0], np.flatnonzero(left) + 1, [len(states) - 1]]))


def spread(count: int, most: int) -> Kept:
    """At most `most` + 1 of `count` indices, equally far apart, the last one with them."""
    apart = -(-count // most)
    return np.unique(np.append(np.arange(0, count, apart), count - 1))
