"""The states of what a run or a generator returns: rows or columns, with or without its times."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from driftproof.blackbox.findings import NotANumber, WrongShape
from driftproof.blackbox.stepper.array_adapters import as_array

ROWS, COLUMNS, END = "rows", "columns", "end"
# The start comes back rounded to the format of the run, at worst that of 11 bits.
_SAME = 2.0**-10


def is_generator(answer: Any) -> bool:
    """True of what is iterated over once."""
    return hasattr(answer, "__next__")


def states_of_run(answer: Any, start: Sequence[Any], layout: str | None, steps: int) -> tuple[Any, str]:
    """The states of a run, the start among them, and where they stand; told where that is not yet known.

    The states are rows, or columns, the first of them the start; or the last one comes alone. Raises WrongShape.
    """
    size, table = len(start), _table(answer, len(start))
    if table.size == size:
        return [table.ravel()], END
    if table.shape == (steps + 1, size) and (layout == ROWS or (layout is None and _is(start, table[0]))):
        return table, ROWS
    if table.shape == (size, steps + 1) and (layout == COLUMNS or _is(start, table[:, 0])):
        return table.T, COLUMNS
    made = "one step" if steps == 1 else f"{steps} steps"
    wanted = "two" if steps == 1 else steps + 1
    raise WrongShape(f"of {made} from {list(start)!r} it returns an array of shape {table.shape}, not {wanted} states")


def states_of_generator(
    generator: Any, start: Sequence[Any], layout: str | None, steps: int
) -> tuple[Sequence[Any], str]:
    """The states that a generator yields, the start first, if it yields that.

    Raises NotANumber where there is none.
    """
    states = [_numbers_of(state)[-len(start) :] for state in islice(generator, steps + 1)]
    if not states:
        raise NotANumber("the generator ends before it yields a state")
    if len(states) == len(start) and all(state.size == 1 for state in states):  # one state, number by number
        return [np.concatenate(states)], END
    found = layout or (ROWS if _is(start, states[0]) else END)
    return (states if found == ROWS else [np.array(start), *states[:steps]]), found


def _numbers_of(state: Any) -> np.ndarray[Any, Any]:
    """All numbers of a state, in which parts it may come: of (t, y) and (q, v) those of the state are the last."""
    parts = state if isinstance(state, tuple) else (state,)
    return np.concatenate([as_array(part).ravel() for part in parts])


def _is(start: Sequence[Any], state: np.ndarray[Any, Any]) -> bool:
    return state.shape == (len(start),) and bool(np.allclose(state, start, rtol=_SAME))


def _table(answer: Any, size: int) -> np.ndarray[Any, Any]:
    """The states as one array, without the times that stand before them: (ts, ys), (ts, qs, vs), (qs, vs)."""
    parts = list(answer) if isinstance(answer, tuple) else []
    if len(parts) > 1 and np.ndim(parts[0]) == 1 and (len(parts) == size + 1 or np.ndim(parts[1]) == 2):
        answer = parts[1:] if len(parts) > 2 else parts[1]
    return as_array(answer)
