"""What the errors of a scene cost in seconds: measured when asked for, and never twice alike."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.scenes import Scene
from driftproof.numeric.work_precision.curves import Curve
from driftproof.numeric.work_precision.integrators import PYTHON, integrator
from driftproof.numeric.work_precision.timing import Timing, started, take_turns
from driftproof.reports.page.work import Cost, problem_of
from driftproof.support.machine import machine

# A call that has spent so many seconds gets no further turn.
LIMIT = 1.0


def seconds(scene: Scene, found: Sequence[Curve]) -> Cost:
    """The least seconds of one trajectory in plain Python, for every point that has an error; turns interleave."""
    problem, calls, timings = problem_of(scene), {}, dict[str, Timing]()
    for curve in found:
        if curve.refused:
            continue
        call = integrator(METHODS[curve.key], problem).calls[PYTHON]
        for point in curve.points:
            if point.steps and isfinite(point.error):
                name = _name(curve, point.steps)
                calls[name] = call(point.steps)
                timings[name], _ = started(calls[name])
    for _ in take_turns(calls, timings, limit=LIMIT):
        pass

    def least(curve: Curve, steps: int | None) -> float | None:
        timing = timings.get(_name(curve, steps))
        return timing.best if timing and timing.samples else None

    return Cost(
        name="times",
        title="Error against time",
        axis="seconds in plain Python",
        note=f"The least of several rounds, on {machine()}.",
        of=lambda curve, point: least(curve, point.steps),
        shown=lambda spent: f"{spent:.2e} s",
    )


def _name(curve: Curve, steps: int | None) -> str:
    return f"{curve.key} {steps}"
