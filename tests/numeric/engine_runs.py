"""Steps taken one by one, and arrays of states: what fast runs are compared with, and what they start from."""

from __future__ import annotations

import numpy as np

from driftproof.methods.stepping import stepper


def step_by_step(method, force, q, v, h, steps, lift=float):
    step = stepper(method, lift)
    for _ in range(steps):
        q, v = step(force, q, v, h)
    return q, v


def ensemble(length, dtype=np.float64):
    angles = np.linspace(0, 6, length)
    return np.cos(angles).astype(dtype), np.sin(3 * angles).astype(dtype)
