"""A vector field as the loops over numbers read it: f and its derivatives, written into rows, in Python or compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from driftproof.methods.program_text import indented, maker, maker_text
from driftproof.methods.vector_fields import VectorField, jacobian_matrix
from driftproof.numeric.elimination import FULL, PYTHON_FLOATS, Band, NumberKind
from driftproof.numeric.engine import OF_FLOATS, compiled_function, lifted
from driftproof.numeric.newton import RateWriter


class FieldWriters(NamedTuple):
    """What loops are made of."""

    rate: RateWriter
    jacobian: RateWriter
    band: Band
    kind: NumberKind


def number_kind(*, compiled: bool) -> NumberKind:
    """Lists of Python floats, or what numba compiles, on arrays; needs the extra `fast`."""
    if not compiled:
        return PYTHON_FLOATS
    return NumberKind(
        compiled_function,
        compiled_function(lambda n, m: np.zeros((n, m))),
        compiled_function(lambda k, n, m: np.zeros((k, n, m))),
        compiled_function(lambda k, n: np.zeros((k, n), np.int64)),
    )


def field_writers(field: VectorField, *, compiled: bool) -> FieldWriters:
    """f and its derivatives, by exact formulas, as functions that write into what they are given."""
    kind = number_kind(compiled=compiled)
    rows = jacobian_matrix(field)
    bodies = (
        [f"last[{i}] = {rate}" for i, rate in enumerate(field.rates)],
        [f"last[{i}][{j}] = {entry}" for i, row in enumerate(rows) for j, entry in enumerate(row)],
    )
    rate, jacobian = (kind.compiled(_writer(field, body)) for body in bodies)
    return FieldWriters(rate, jacobian, FULL, kind)


def _writer(field: VectorField, body: list[str]) -> RateWriter:
    """The function of this body, whose names of its own are those that no parameter may have."""
    state = [f"{name} = y[{i}]" for i, name in enumerate(field.components)]
    names, values = [name for name, _ in field.parameters], [lifted(c, np.float64) for _, c in field.parameters]
    text = maker_text(names, "run", ["def run(t, y, last):", *indented([*state, *body])])
    made: RateWriter = maker(text, "field", OF_FLOATS)(*values)
    return made
