"""REBOUND: one step of its symplectic integrators on a single particle, with a force of ours and no gravity."""

from __future__ import annotations

from driftproof.blackbox.stepper.states.objects import stepper_of
from examples.gallery.entry import targets


def _simulation(integrator, **settings):
    def make(force):
        import rebound

        simulation = rebound.Simulation()
        simulation.gravity = "none"
        simulation.integrator = integrator
        for name, value in settings.items():
            setattr(simulation.integrator, name, value)
        simulation.add(m=1.0)

        def push(pointer):
            particle = pointer.contents.particles[0]
            particle.ax += force(particle.x)

        simulation.additional_forces = push
        return simulation

    # Janus goes on from whole numbers of its own.
    return stepper_of(make, position=_place("x"), velocity=_place("vx"), advance=_advance, anew=True)


def _place(name):
    return lambda its: getattr(its.particles[0], name), lambda its, x: setattr(its.particles[0], name, x)


def _advance(simulation, h):
    simulation.dt = h
    simulation.steps(1)
    simulation.synchronize()


TARGETS = targets(
    __name__,
    "rebound",
    force={
        "leapfrog": (_simulation("leapfrog"), "leapfrog", 2, "position_verlet"),
        "leapfrog4": (_simulation("leapfrog", order=4), "leapfrog, order 4: Yoshida", 4, "forest_ruth"),
        "leapfrog6": (_simulation("leapfrog", order=6), "leapfrog, order 6", 6),
        "leapfrog8": (_simulation("leapfrog", order=8), "leapfrog, order 8: Blanes and Casas", 8),
        "janus2": (_simulation("janus", order=2), "Janus, order 2", 2),
        "janus4": (_simulation("janus", order=4), "Janus, order 4", 4),
        "janus6": (_simulation("janus", order=6), "Janus, order 6", 6),
        "janus8": (_simulation("janus", order=8), "Janus, order 8", 8),
        "janus10": (_simulation("janus", order=10), "Janus, order 10", 10),
    },
)
