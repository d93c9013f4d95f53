"""Whether the powers of a matrix of floats stay bounded, as far as 2**48 of them tell, in decimals of 45 digits."""

from __future__ import annotations

from decimal import Decimal, Overflow, localcontext
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Matrix: TypeAlias = NDArray[np.float64]
Rows: TypeAlias = list[list[Decimal]]

# Powers 2**n, n up to SQUARINGS, are bounded if they stay below GROWTH. A radius ρ > 1 is seen from
# ρ - 1 = log(GROWTH)/2**SQUARINGS = 7e-14 on: more squarings would show how the entries of a float step were rounded,
# which moves ρ by some u. A Jordan block on the circle grows to 2**SQUARINGS.
# Rounding: entries of size up to GROWTH lose GROWTH² 10^-DIGITS = 1e-27 relatively in a squaring, and 2**48 of it at
# the end, 3e-13. Powers near a limit where two eigenvalues meet stay below GROWTH down to a distance of 1e-18.
SQUARINGS, GROWTH, DIGITS = 48, 1e9, 45
# Floats decide first, over 2**FEWER powers: what falls below 1/GROWTH stays there, what exceeds GROWTH has grown.
FEWER = 36


def powers_stay_bounded(matrix: Matrix) -> bool:
    """The powers 1, 2, 4, ..., 2**SQUARINGS of the matrix stay below GROWTH; False if an entry is not finite."""
    verdict = _by_floats(matrix)
    return _by_decimals(matrix) if verdict is None else verdict


def _by_floats(matrix: Matrix) -> bool | None:
    """The verdict where floats suffice: the powers have vanished, or have grown before rounding could have."""
    power = matrix
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for n in range(FEWER):
            largest = float(np.abs(power).max())
            if not largest < GROWTH:  # NaN is not
                return False if n < FEWER // 2 or largest != largest else None
            if largest < 1 / GROWTH:
                return True
            power = power @ power
    return None


def _by_decimals(matrix: Matrix) -> bool:
    with localcontext(prec=DIGITS) as context:
        context.traps[Overflow] = False
        power: Rows = [[Decimal(float(x)) for x in row] for row in matrix]
        for _ in range(SQUARINGS):
            if max(abs(x) for row in power for x in row) >= GROWTH:
                return False
            power = _square(power)
        return max(abs(x) for row in power for x in row) < GROWTH


def _square(a: Rows) -> Rows:
    columns: Any = list(zip(*a, strict=True))
    return [[sum((x * y for x, y in zip(row, column, strict=True)), Decimal(0)) for column in columns] for row in a]
