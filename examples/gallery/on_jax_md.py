"""JAX MD: one step of its simulations in flat space, of unit mass: NVE, and Langevin without friction."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_jax import force_step, jax64


def _simulation(name, **settings):
    def make(force):
        jax = jax64()
        from jax_md import simulate, space

        _, shift = space.free()

        def step(q, v, h):
            def forces(position, **kwargs):
                return force(position[0, 0]).reshape(1, 1)

            init, apply = getattr(simulate, name)(forces, shift, h, **settings)
            position = jax.numpy.reshape(q, (1, 1))
            state = init(jax.random.PRNGKey(0), position, kT=0.0)
            stepped = apply(state.set(momentum=jax.numpy.reshape(v, (1, 1))))
            return stepped.position[0, 0], stepped.momentum[0, 0]

        return step

    return force_step(make)


COLD = {"kT": 0.0, "gamma": 0.0}
TARGETS = targets(
    __name__,
    "jax-md",
    force={
        "nve": (_simulation("nve"), "velocity Verlet", 2, "velocity_verlet"),
        "langevin": (_simulation("nvt_langevin", **COLD), "BAOAB Langevin, friction 0", 2, "velocity_verlet"),
    },
)
