"""Floats of every format as bytes, to be compared bit for bit."""

from __future__ import annotations

from typing import Any

import numpy as np


def bits(*numbers: Any) -> bytes:
    """Floats and arrays as bytes: 0 and -0 differ. A long double, which is stored with padding, as two doubles."""
    parts = []
    for x in map(np.asarray, numbers):
        high = x.astype(float) if x.dtype == np.longdouble else x
        parts += [high, (x - high).astype(float)] if x.dtype == np.longdouble else [high]
    return b"".join(part.tobytes() for part in parts)
