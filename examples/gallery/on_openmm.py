"""OpenMM: one step of its integrators on one particle of mass 1, on the reference platform, friction zero."""

from __future__ import annotations

from driftproof.blackbox.stepper.states.objects import stepper_of
from examples.gallery.entry import targets


def _integrator(name, *arguments):
    def make(force):
        import numpy as np
        import openmm

        def push(state):
            position = state.getPositions(asNumpy=True)._value[0, 0]
            return 0.0, np.array([[force(float(position)), 0.0, 0.0]])

        system = openmm.System()
        system.addParticle(1.0)
        system.addForce(openmm.PythonForce(push))
        integrator = getattr(openmm, name)(*arguments)
        return openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))

    def advance(context, h):
        context.getIntegrator().setStepSize(h)
        context.getIntegrator().step(1)

    return stepper_of(make, position=POSITION, velocity=VELOCITY, advance=advance)


POSITION = (
    lambda context: context.getState(getPositions=True).getPositions()[0][0]._value,
    lambda context, q: context.setPositions([(q, 0.0, 0.0)]),
)
VELOCITY = (
    lambda context: context.getState(getVelocities=True).getVelocities()[0][0]._value,
    lambda context, v: context.setVelocities([(v, 0.0, 0.0)]),
)

TARGETS = targets(
    __name__,
    "openmm",
    force={
        "verlet": (_integrator("VerletIntegrator", 1.0), "leapfrog Verlet", 2),
        "langevin": (_integrator("LangevinIntegrator", 0.0, 0.0, 1.0), "Langevin, friction 0", 2),
        "langevin_middle": (_integrator("LangevinMiddleIntegrator", 0.0, 0.0, 1.0), "LFMiddle Langevin, friction 0", 2),
    },
)
