"""BlackJAX: one step of each integrator of its Hamiltonian samplers, with unit mass."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_jax import force_step, jax64, potential_of


def _integrator(name):
    def make(force):
        jax = jax64()
        from blackjax.mcmc import integrators

        log_density = potential_of(lambda q: -force(q))
        step_of = getattr(integrators, name)(log_density, lambda p, **kwargs: 0.5 * jax.numpy.sum(p**2))

        def step(q, v, h):
            state = integrators.new_integrator_state(log_density, q, v)
            stepped = step_of(state, h)
            return stepped.position, stepped.momentum

        return step

    return force_step(make)


TARGETS = targets(
    __name__,
    "blackjax",
    force={
        "velocity_verlet": (_integrator("velocity_verlet"), "velocity Verlet", 2, "velocity_verlet"),
        "mclachlan": (_integrator("mclachlan"), "McLachlan's two-stage minimal norm", 2),
        "yoshida": (_integrator("yoshida"), "Yoshida", 4, "yoshida4"),
        "omelyan": (_integrator("omelyan"), "Omelyan, eleven stages", 4),
        "implicit_midpoint": (_integrator("implicit_midpoint"), "implicit midpoint", 2, "implicit_midpoint"),
    },
)
