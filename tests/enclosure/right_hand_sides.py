"""Right-hand sides that several files enclose, as users write them."""

from __future__ import annotations

import numpy as np


def pendulum(t, y):
    return np.array([y[1], -np.sin(y[0])])


def kepler(t, y):
    cubed = (y[0] ** 2 + y[1] ** 2) ** 1.5
    return np.array([y[2], y[3], -y[0] / cubed, -y[1] / cubed])
