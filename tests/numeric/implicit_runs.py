"""Many implicit steps in a row, and the worst that was left in a stage equation."""

from __future__ import annotations

from typing import Any

from driftproof.numeric.implicit import ImplicitStep, ImplicitStepper


def implicit_run(step: ImplicitStepper, y: Any, h: float, steps: int) -> ImplicitStep:
    """So many steps from t = 0; the i-th from i h. Residuals are the worst of a step, iterations those of all."""
    found = []
    for i in range(steps):
        found.append(step(i * h, y, h))
        y = found[-1].y
    worst = (max((x.residual for x in found), default=0.0), max((x.over_floor for x in found), default=0.0))
    return ImplicitStep(y, *worst, sum(x.iterations for x in found))
