"""Runs of the oscillator, and steps taken one by one, with which they are compared."""

from __future__ import annotations

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.stepping import stepper
from driftproof.numeric.steps.engine import compiled_runner, runner

OSCILLATOR, PENDULUM = VectorField(("y1", "-y0")), VectorField(("y1", "-sin(y0)"))


def oscillator_run(method, *, compiled=False, compensated=False):
    """Return run(q, v, h, steps) of q' = v, v' = -q in floats, or on arrays."""
    run = (compiled_runner if compiled else runner)(method, OSCILLATOR, compensated=compensated)
    return lambda q, v, h, steps: run((q, v), h, 0, steps)


def step_by_step(method, force, q, v, h, steps, lift=float):
    step = stepper(method, lift)
    for _ in range(steps):
        q, v = step(force, q, v, h)
    return q, v
