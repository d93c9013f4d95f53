"""Mici: one step of each integrator of its Hamiltonian samplers, with unit metric."""

from __future__ import annotations

from examples.gallery.entry import targets


def _integrator(name):
    def step(force, q, v, h):
        import numpy as np
        from mici import integrators, states, systems

        def gradient(position):
            return np.array([-force(position[0])])

        system = systems.EuclideanMetricSystem(lambda position: 0.0, grad_neg_log_dens=gradient)
        state = states.ChainState(pos=np.array([float(q)]), mom=np.array([float(v)]), dir=1)
        stepped = getattr(integrators, name)(system, h).step(state)
        return stepped.pos[0], stepped.mom[0]

    return step


TARGETS = targets(
    __name__,
    "mici",
    force={
        "leapfrog": (_integrator("LeapfrogIntegrator"), "position Störmer-Verlet, kicks outside", 2, "velocity_verlet"),
        "implicit_leapfrog": (_integrator("ImplicitLeapfrogIntegrator"), "implicit leapfrog", 2, "velocity_verlet"),
        "implicit_midpoint": (_integrator("ImplicitMidpointIntegrator"), "implicit midpoint", 2, "implicit_midpoint"),
        "bcss2": (_integrator("BCSSTwoStageIntegrator"), "Blanes-Casas-Sanz-Serna, two stages", 2),
        "bcss3": (_integrator("BCSSThreeStageIntegrator"), "Blanes-Casas-Sanz-Serna, three stages", 2),
        "bcss4": (_integrator("BCSSFourStageIntegrator"), "Blanes-Casas-Sanz-Serna, four stages", 2),
    },
)
