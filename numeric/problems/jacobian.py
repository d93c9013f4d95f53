"""The derivatives of a field as a function of floats, for Newton's method in `numeric.implicit`."""

from __future__ import annotations

import math

import numpy as np

from methods.fields import FUNCTIONS, Field
from methods.jacobian import jacobian
from methods.program_text import indented, maker, maker_text
from numeric.engine import lifted
from numeric.implicit import Jacobian

_FUNCTIONS = {name: getattr(math, name) for name in FUNCTIONS}


def field_jacobian(field: Field) -> Jacobian:
    """(t, y) -> the n x n matrix with ∂fᵢ/∂yⱼ in row i and column j, of expressions formed exactly, in binary64.

    Overflow and division by zero raise as they do in Python.
    """
    names = [name for name, _ in field.parameters]
    rows = ", ".join(f"[{', '.join(row)}]" for row in jacobian(field))
    lines = [f"{''.join(f'{y}, ' for y in field.components)}= map(float, y)", f"return [{rows}]"]
    text = maker_text(names, "jacobian", ["def jacobian(t, y):", *indented(lines)])
    found: Jacobian = maker(text, "jacobian", _FUNCTIONS)(*[lifted(c, np.float64) for _, c in field.parameters])
    return found
