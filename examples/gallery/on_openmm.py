"""OpenMM: one step of its integrators on one particle of mass 1, on the reference platform, friction zero."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _context(name, arguments):
    """A particle and the place of its force."""
    import openmm

    place = [None]

    def push(state):
        import numpy as np

        position = state.getPositions(asNumpy=True)._value[0, 0]
        return 0.0, np.array([[place[0](float(position)), 0.0, 0.0]])

    system = openmm.System()
    system.addParticle(1.0)
    system.addForce(openmm.PythonForce(push))
    integrator = getattr(openmm, name)(*arguments)
    return openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference")), place


def _integrator(name, *arguments):
    def step(force, q, v, h):
        context, place = _context(name, arguments)
        place[0] = force
        context.getIntegrator().setStepSize(h)
        context.setPositions([(q, 0.0, 0.0)])
        context.setVelocities([(v, 0.0, 0.0)])
        context.getIntegrator().step(1)
        state = context.getState(getPositions=True, getVelocities=True)
        return state.getPositions()[0][0]._value, state.getVelocities()[0][0]._value

    return step


verlet = _integrator("VerletIntegrator", 1.0)
langevin = _integrator("LangevinIntegrator", 0.0, 0.0, 1.0)
langevin_middle = _integrator("LangevinMiddleIntegrator", 0.0, 0.0, 1.0)

TARGETS = targets(
    __name__,
    "openmm",
    "force",
    {
        "verlet": ("leapfrog Verlet", 2),
        "langevin": ("Langevin, friction 0", 2),
        "langevin_middle": ("LFMiddle Langevin, friction 0", 2),
    },
)
