"""A tableau whose coefficients were typed in with a few decimals: of which method, and with how many."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from driftproof.blackbox.matching.candidates import Candidate
from driftproof.blackbox.matching.sketching import Array, Sketch
from driftproof.blackbox.probes.probing import Rounding

# From as many as a source may print, in double precision, down to where other methods are as near.
DECIMALS = range(14, 3, -1)
# Fewer are named one by one.
LEAST_OFF = 4
# How far numbers may be off, in units of their last decimal: rounded; or worked out by hand, as old tables are.
BY_HAND = 2.0
HOW_FAR = {0.5: "coefficients rounded to {} decimals", BY_HAND: "coefficients of {} decimals, the last up to 2 off"}


def typed_in(read: Sketch, methods: Iterable[Candidate], rounding: Rounding) -> Iterator[tuple[str, str]]:
    """The methods whose coefficients, to so many decimals, are those read: keys, and in words how they differ."""
    for candidate in methods:
        for most, words in HOW_FAR.items():
            decimals = _decimals(read, candidate.sketch, rounding, most)
            if decimals is not None:
                yield candidate.key, words.format(decimals)
                break


def _decimals(read: Sketch, exact: Sketch, rounding: Rounding, most: float) -> int | None:
    """The decimals of which each coefficient read is the exact one, or within `most` of the last; None if none."""
    if read.calls != exact.calls or read.weights.shape != exact.weights.shape:
        return None
    seen, true = _numbers(read), _numbers(exact)
    noise = rounding.of(1.0) * np.maximum(1.0, np.abs(true))
    off = np.abs(seen - true)
    if (off > noise).sum() < LEAST_OFF or not (off <= most * 10.0 ** -DECIMALS[-1]).all():
        return None
    for k in DECIMALS:
        near = (off <= most * 10.0**-k + noise) & (np.abs(seen - np.round(seen, k)) <= noise)
        if ((off <= noise) | near).all():
            return k
    return None


def _numbers(table: Sketch) -> Array:
    """All of A, of the weights and of the times."""
    return np.vstack([table.a, table.weights, table.nodes[-1]])
