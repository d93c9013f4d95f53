"""Right-hand sides that several files enclose, as users write them, and a step of RK4 as users write it."""

from __future__ import annotations

import numpy as np


def pendulum(t, y):
    return np.array([y[1], -np.sin(y[0])])


def kepler(t, y):
    cubed = (y[0] ** 2 + y[1] ** 2) ** 1.5
    return np.array([y[2], y[3], -y[0] / cubed, -y[1] / cubed])


def rk4(f, t, y, h):
    a = f(t, y)
    b = f(t + h / 2, y + h / 2 * a)
    c = f(t + h / 2, y + h / 2 * b)
    return y + h / 6 * (a + 2 * b + 2 * c + f(t + h, y + h * c))
